//! Groups of angles whose sines and cosines are computed together.
//!
//! A group fills a register. In the array of angles its angles are followed by their sines, then by their
//! cosines. All groups but the last one have [`WIDEST`] angles.

use super::{MemoryLocation, Place, Planner, Residence, Step, WIDEST};
use linkwork_compiler::expr::Function;
use linkwork_compiler::lower::{Angles, Op, Operand};

/// Number of registers that have no values when the angles of a group are joined.
const JOINING: usize = 2;

/// Angles that fill a register of one, two or four lanes.
#[derive(Clone, Debug, Default)]
pub struct AngleGroup {
    /// Numbers that fill the lanes, with their count: one, two or four lanes of a register, or adjacent
    /// numbers in memory.
    pub sources: Vec<(Place, usize)>,
}

impl AngleGroup {
    /// Returns the number of lanes.
    pub fn width(&self) -> usize {
        self.sources.iter().map(|(_, count)| count).sum()
    }

    /// Returns the place of the angle in each lane, for programs whose values have one lane.
    #[cfg(any(test, target_arch = "aarch64"))]
    pub fn lane_places(&self) -> impl Iterator<Item = Place> {
        self.sources.iter().flat_map(|(first, count)| (0..*count).map(|k| first.offset_place(k)))
    }

    /// Adds a number to the lanes; adjacent inputs become one source.
    fn push(&mut self, from: Place, width: usize) {
        self.sources.push((from, width));
        while let [.., (first, count), (second, more)] = self.sources[..]
            && count == more
            && is_next_input(first, count, second)
            && (self.width() - 2 * count).is_multiple_of(2 * count)
        {
            self.sources.pop();
            self.sources.pop();
            self.sources.push((first, 2 * count));
        }
    }
}

/// Whether an input follows `count` other inputs in memory.
fn is_next_input(first: Place, count: usize, second: Place) -> bool {
    match (first, second) {
        (
            Place::Memory(MemoryLocation::Input(slot, index)),
            Place::Memory(MemoryLocation::Input(other, next)),
        ) => slot == other && next == index + count,
        _ => false,
    }
}

/// Returns the number of angles, including padding, whose sines and cosines are computed for `count` angles:
/// three angles in the last group become four.
fn padded(count: usize) -> usize {
    count + usize::from(count % WIDEST == WIDEST - 1)
}

/// Returns the index of the first number of a group in the array of angles, where the group contains angle
/// `at`.
fn group_start_in_array(at: usize) -> usize {
    at / WIDEST * 3 * WIDEST
}

impl Planner<'_> {
    fn width_of_angle(&self, angle: Operand) -> usize {
        match angle {
            Operand::Value(k) => self.widths[k],
            Operand::Gather(k) => self.program.gathers[k].len(),
            Operand::Tuple(k) => self.program.tuples[k].len(),
            Operand::Const(_) | Operand::Symbol(_) => 1,
        }
    }

    /// Returns the angles that fill the groups, in order, with their numbers of lanes.
    fn angles_with_padding(&self, angles: &Angles) -> Vec<(Operand, usize)> {
        let list = angles.angles_by_descending_width(self.program, |angle| self.width_of_angle(angle));
        let mut all: Vec<_> =
            list.iter().map(|angle| (angle.angle, self.width_of_angle(angle.angle))).collect();
        let count: usize = all.iter().map(|(_, width)| width).sum();
        if padded(count) > count {
            // The last four of more angles can be adjacent inputs. Padding repeats an angle, so that no
            // exceptional value slows the others down.
            match all[..] {
                [.., previous @ (_, 1), (_, 1), (_, 1), (_, 1)] => all.insert(all.len() - 3, previous),
                _ => all.extend(all.last().map(|(angle, _)| (*angle, 1))),
            }
        }
        all
    }

    /// Plans the computation of the angles, their sines and cosines.
    pub(super) fn plan_angles(&mut self, angles: &Angles) -> Result<(), String> {
        let all = self.angles_with_padding(angles);
        if all.is_empty() {
            return Ok(());
        }
        let count: usize = all.iter().map(|(_, width)| width).sum();
        let end = self.program.instructions.len();
        for (angle, _) in &all {
            if let Operand::Value(k) = *angle {
                self.uses[k] = vec![end];
            }
        }
        let registers = self.values.len();
        self.values.truncate(registers - JOINING);
        self.plan_instructions(&angles.before, &vec![Vec::new(); end])?;
        self.values.resize(registers, None);
        // Index of each angle among all.
        let mut places: Vec<(Operand, usize)> = Vec::with_capacity(all.len());
        let mut at = 0_usize;
        for (angle, width) in &all {
            let from = self.place_of_angle(*angle)?;
            if at.is_multiple_of(WIDEST) {
                self.plan.angles.push(AngleGroup::default());
            }
            self.plan.angles.last_mut().ok_or("a group is missing")?.push(from, *width);
            places.push((*angle, at));
            at += width;
        }
        for (angle, _) in all {
            if let Operand::Value(k) = angle {
                self.release_angle(k);
            }
        }
        self.plan.steps.push(Step::Sines);
        self.locate_sines(angles, &places, count)
    }

    /// Notes the positions of sines and cosines in the array. `places` are the indices of the angles among
    /// `count` angles.
    fn locate_sines(
        &mut self,
        angles: &Angles,
        places: &[(Operand, usize)],
        count: usize,
    ) -> Result<(), String> {
        for k in 0..self.program.instructions.len() {
            match self.program.instructions[k] {
                Op::Call(f, operand) if angles.covered[k] => {
                    let known = places.iter().find(|(angle, _)| *angle == operand);
                    let (_, at) = *known.ok_or("an angle is missing")?;
                    let group = group_start_in_array(at);
                    let width = (count - at / WIDEST * WIDEST).min(WIDEST);
                    let offset = if f == Function::Sin { width } else { 2 * width };
                    self.sines.insert(k, group + offset + at % WIDEST);
                }
                Op::Lane(lane @ 1.., Operand::Value(whole)) => {
                    if let Some(at) = self.sines.get(&whole) {
                        self.sines.insert(k, at + lane);
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Returns the place of an angle before the sines are computed.
    fn place_of_angle(&mut self, angle: Operand) -> Result<Place, String> {
        match angle {
            Operand::Value(k) => match self.places[k] {
                Some(Residence { register: Some(register), .. }) => Ok(Place::Register(register)),
                Some(Residence { memory: Some(memory), .. }) => Ok(Place::Memory(memory)),
                _ => Err("an angle is nowhere".to_string()),
            },
            other => self.memory_of_leaf_operand(other).map(Place::Memory),
        }
    }

    /// Releases the register and the memory of an angle.
    fn release_angle(&mut self, k: usize) {
        self.uses[k].clear();
        if let Some((width, entry)) = self.release_dead_value(k) {
            self.free.entry(width).or_default().push(entry);
        }
    }
}

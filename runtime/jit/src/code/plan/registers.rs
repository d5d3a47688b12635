//! Allocation of registers and of the work space.

use super::{LaneStore, MemoryLocation, Place, Planner, Residence, Step, needs_function_call};
use linkwork_compiler::expr::Symbol;
use linkwork_compiler::lower::{Op, Operand};

/// Maximum distance between two uses of a value in memory for which it is loaded into a register.
const SOON: usize = 12;

impl Planner<'_> {
    pub(super) fn plan_instruction(&mut self, k: usize, stores: &[LaneStore]) -> Result<(), String> {
        let op = self.program.instructions[k];
        let operands = self.values_used_by_instruction(k);
        if needs_function_call(&op) {
            (0..self.values.len()).for_each(|register| self.evict_value(register));
        } else {
            for j in &operands {
                self.load_if_needed_soon(*j, k);
            }
        }
        if let Op::Table(lookup, ..) = op {
            self.plan.tables = self.plan.tables.max(lookup.table_index() + 1);
        }
        let places = self.places_of_operands(op)?;
        // Their memory is not overwritten before the operation.
        let mut ended = Vec::new();
        for j in operands {
            self.uses[j].pop();
            if self.uses[j].is_empty() {
                ended.extend(self.release_dead_value(j));
            }
        }
        // The result replaces an operand that is not used again, preferably an addend.
        let dying = places.iter().rev().find_map(|place| match place {
            Place::Register(register) if self.values[usize::from(*register)].is_none() => Some(*register),
            _ => None,
        });
        let to = dying.unwrap_or_else(|| self.take_register());
        self.plan.steps.push(Step::Operation(op, to, places, self.widths[k]));
        for (width, entry) in ended {
            self.free.entry(width).or_default().push(entry);
        }
        let mut residence = Residence { register: Some(to), memory: None };
        for target in stores {
            match *target {
                LaneStore::First(memory, width) => {
                    self.plan.steps.push(Step::Store(to, memory, width));
                    if width == self.widths[k] {
                        residence.memory.get_or_insert(memory);
                    }
                }
                LaneStore::Second(memory) => self.plan.steps.push(Step::StoreSecond(to, memory)),
            }
        }
        if !self.uses[k].is_empty() {
            self.values[usize::from(to)] = Some(k);
            self.places[k] = Some(residence);
        }
        Ok(())
    }

    /// Returns the places of the operands; one that does not exist repeats the first.
    fn places_of_operands(&mut self, op: Op) -> Result<[Place; 3], String> {
        let mut list = Vec::with_capacity(3);
        op.visit_operands(|operand| list.push(operand));
        let mut places = Vec::with_capacity(3);
        for operand in list {
            places.push(match operand {
                Operand::Value(k) if !self.sines.contains_key(&k) => {
                    let Residence { register, memory } =
                        self.places[k].ok_or("a value is used before it is computed")?;
                    match register {
                        Some(register) => Place::Register(register),
                        None => Place::Memory(memory.ok_or("a value is nowhere")?),
                    }
                }
                other => Place::Memory(self.memory_of_leaf_operand(other)?),
            });
        }
        let first = *places.first().ok_or("an operand is missing")?;
        Ok(std::array::from_fn(|k| places.get(k).copied().unwrap_or(first)))
    }

    /// Returns the position of an operand that is not the value of an instruction of the body.
    pub(super) fn memory_of_leaf_operand(&mut self, operand: Operand) -> Result<MemoryLocation, String> {
        match operand {
            Operand::Const(c) => Ok(MemoryLocation::Constant(self.find_or_add_constants(&[c]))),
            Operand::Symbol(symbol) => self.input_location(symbol),
            Operand::Tuple(k) => {
                Ok(MemoryLocation::Constant(self.find_or_add_constants(&self.program.tuples[k])))
            }
            // The inputs are adjacent.
            Operand::Gather(k) => {
                let symbols = &self.program.gathers[k];
                symbols.iter().rev().map(|symbol| self.input_location(*symbol)).last().ok_or("no input")?
            }
            Operand::Value(k) => match self.sines.get(&k) {
                Some(at) => Ok(MemoryLocation::Angle(*at)),
                None => Err("a value is used before it is computed".to_string()),
            },
        }
    }

    /// Returns the index of constants in adjacent memory.
    pub(super) fn find_or_add_constants(&mut self, lanes: &[f64]) -> usize {
        let constants = &mut self.plan.constants;
        *self.known.entry(lanes.iter().map(|c| c.to_bits()).collect()).or_insert_with(|| {
            // Lanes do not cross lines of the cache.
            constants.resize(constants.len().next_multiple_of(lanes.len()), 0.0);
            constants.extend(lanes);
            constants.len() - lanes.len()
        })
    }

    fn input_location(&mut self, symbol: Symbol) -> Result<MemoryLocation, String> {
        let (slot, index) =
            self.layout.locate_symbol(symbol).ok_or("a program reads what it is not given")?;
        self.plan.lengths[slot] = self.plan.lengths[slot].max(index + 1);
        Ok(MemoryLocation::Input(slot, index))
    }

    /// Loads a value in memory into a register if an instruction soon after instruction `now` uses it again.
    fn load_if_needed_soon(&mut self, k: usize, now: usize) {
        let next = self.uses[k].iter().rev().nth(1);
        let Some(Residence { register: None, memory: Some(memory) }) = self.places[k] else { return };
        if next.is_some_and(|next| *next <= now + SOON) {
            let register = self.take_register();
            self.plan.steps.push(Step::Load(register, memory, self.widths[k]));
            self.values[usize::from(register)] = Some(k);
            self.places[k] = Some(Residence { register: Some(register), memory: Some(memory) });
        }
    }

    /// Returns a register without a value. If all have values, the one whose next use is last goes to memory.
    fn take_register(&mut self) -> u8 {
        let next_use_of_value = |value: Option<usize>| value.and_then(|k| self.uses[k].last().copied());
        let free = self.values.iter().position(Option::is_none);
        let register = free.unwrap_or_else(|| {
            (0..self.values.len())
                .max_by_key(|register| next_use_of_value(self.values[*register]))
                .unwrap_or(0)
        });
        self.evict_value(register);
        register as u8
    }

    /// Takes the value out of a register.
    fn evict_value(&mut self, register: usize) {
        let Some(k) = self.values[register].take() else { return };
        let Some(residence) = &mut self.places[k] else { return };
        residence.register = None;
        if residence.memory.is_none() {
            let width = self.widths[k];
            let free = self.free.get_mut(&width).and_then(Vec::pop);
            let memory = MemoryLocation::Work(free.unwrap_or_else(|| {
                let at = self.plan.work.next_multiple_of(width);
                let gap = self.plan.work..at;
                self.free.entry(1).or_default().extend(gap);
                self.plan.work = at + width;
                at
            }));
            residence.memory = Some(memory);
            self.plan.steps.push(Step::Store(register as u8, memory, width));
        }
    }

    /// Releases the register of a value that is not used again. Returns its number of lanes and its first
    /// entry of the work space.
    pub(super) fn release_dead_value(&mut self, k: usize) -> Option<(usize, usize)> {
        let Residence { register, memory } = self.places[k].take()?;
        if let Some(register) = register {
            self.values[usize::from(register)] = None;
        }
        match memory {
            Some(MemoryLocation::Work(at)) => Some((self.widths[k], at)),
            _ => None,
        }
    }
}

//! Evaluation of separate contacts where bodies are near each other: gaps, velocities and Jacobians from the
//! placements, velocities and Jacobians of the bodies.

use super::PairParameter;
use crate::error::Error;
use crate::internal::InternalFunction;
use crate::robot::{Robot, State};
use linkwork::contact::Law;
use linkwork::nalgebra::{Matrix3, Rotation3};
use linkwork::rotation::quaternion_of_rotation;
use std::collections::HashMap;

/// Gap up to which surfaces touch, m.
pub(crate) const TOUCHING: f64 = 1e-8;
/// Numbers of configuration coordinates and velocities of a floating body.
const FLOATING: [usize; 2] = [7, 6];

/// Functions of a frame that place a surface and give its velocity, and the velocities that move the frame.
struct BodyFunctions {
    placement: usize,
    velocity: usize,
    jacobian: usize,
    columns: Vec<usize>,
}

/// Pair of surfaces with its parameters.
struct EvaluatedPair {
    robot: Robot,
    bodies: [Option<usize>; 2],
    radii: [f64; 2],
    first_contact: usize,
}

impl EvaluatedPair {
    /// Returns the number of contacts of the pair.
    fn contact_count(&self) -> usize {
        self.robot.shared.contacts.len()
    }

    /// Evaluates a function of the pair in a configuration of its mechanism; after an error the results are
    /// NaN.
    fn call(&self, function: InternalFunction, q: &[f64], out: &mut [f64]) {
        self.robot.call_internal_function(function, State { q, ..State::default() }, out);
    }
}

/// Placement of a body in the ground.
#[derive(Clone, Copy)]
pub(crate) struct BodyPlacement {
    /// Rotation matrix from the axes of the body to those of the ground, column by column.
    pub(super) rotation: [f64; 9],
    pub(super) position: [f64; 3],
}

impl BodyPlacement {
    /// Returns the configuration of a floating body in this placement: its position, and its orientation as a
    /// unit quaternion.
    pub(super) fn floating_configuration(&self) -> [f64; FLOATING[0]] {
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&self.rotation));
        let [a, b, c, d] = quaternion_of_rotation(&rotation).coords.into();
        let [x, y, z] = self.position;
        [x, y, z, a, b, c, d]
    }

    /// Returns the largest displacement of the points within a sphere about the origin of the body between
    /// two placements, m.
    fn largest_displacement(&self, other: &BodyPlacement, radius: f64) -> f64 {
        let distance =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let turned = distance(&self.rotation, &other.rotation);
        let displacement = distance(&self.position, &other.position);
        if turned == 0.0 { displacement } else { displacement + radius * turned }
    }
}

/// Separate contacts of a robot with its values of the parameters.
pub(crate) struct EvaluatedContacts {
    pairs: Vec<EvaluatedPair>,
    bodies: Vec<BodyFunctions>,
    /// Radius of a sphere about the origin of each body that contains its bounded surfaces, m.
    radii: Vec<f64>,
    laws: Vec<Law<f64>>,
}

impl std::fmt::Debug for EvaluatedContacts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "EvaluatedContacts({} pairs of surfaces)", self.pairs.len())
    }
}

/// Contacts that take part in a step, numbered among themselves.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearContacts {
    /// Index in the mechanism of each contact, in increasing order.
    pub contacts: Vec<usize>,
    /// First row and number of rows of each contact among the near ones.
    pub rows: Vec<[usize; 2]>,
    /// Index among the near contacts of the contact whose normal force bounds the friction.
    pub pressed_by: Vec<usize>,
    /// First velocity, and behind the last, on which its contact velocities depend.
    pub columns: Vec<(usize, usize)>,
    pub row_count: usize,
    /// Pairs with near contacts, each with its range of near contacts.
    pairs: Vec<(usize, std::ops::Range<usize>)>,
}

impl EvaluatedContacts {
    /// Prepares the separate contacts of a robot; `None` if it has none.
    ///
    /// # Errors
    ///
    /// A parameter of a pair has a value that no surfaces can have.
    pub fn of_robot(robot: &Robot) -> Result<Option<EvaluatedContacts>, Error> {
        let shared = &robot.shared;
        if shared.separate.is_empty() {
            return Ok(None);
        }
        let mut found =
            EvaluatedContacts { pairs: Vec::new(), bodies: Vec::new(), radii: Vec::new(), laws: Vec::new() };
        let mut known: HashMap<usize, usize> = HashMap::new();
        for pair in &shared.separate.pairs {
            let mut bodies = [None; 2];
            for ((body, frame), radius) in bodies.iter_mut().zip(pair.frames).zip(pair.radii) {
                let Some(frame) = frame else { continue };
                let index = match known.get(&frame) {
                    Some(index) => *index,
                    None => {
                        found.bodies.push(BodyFunctions::of_frame(robot, frame)?);
                        found.radii.push(0.0);
                        known.insert(frame, found.bodies.len() - 1);
                        found.bodies.len() - 1
                    }
                };
                *body = Some(index);
                found.radii[index] = found.radii[index].max(if radius.is_finite() { radius } else { 1.0 });
            }
            let values: Vec<f64> = pair
                .parameters
                .iter()
                .map(|parameter| match parameter {
                    PairParameter::Number(value) => *value,
                    PairParameter::Parameter(index) => robot.parameter_values()[*index],
                })
                .collect();
            let mut own = shared.separate.kinds[pair.kind].clone();
            own.set_parameters(&values)?;
            own.validate()?;
            let pair =
                EvaluatedPair { robot: own, bodies, radii: pair.radii, first_contact: pair.first_contact };
            found.laws.extend(pair.robot.contact_laws());
            found.pairs.push(pair);
        }
        Ok(Some(found))
    }

    /// Returns the coefficients of a contact.
    pub fn contact_law(&self, contact: usize) -> Option<Law<f64>> {
        self.laws.get(contact).copied()
    }

    /// Returns the placements of all bodies with surfaces.
    fn body_placements(&self, robot: &Robot, state: State<'_>) -> Vec<BodyPlacement> {
        let placement_of_body = |body: &BodyFunctions| {
            let mut values = [f64::NAN; 12];
            let _ = robot.call_with_state_into(body.placement, state, &mut values);
            BodyPlacement {
                rotation: std::array::from_fn(|k| values[k]),
                position: std::array::from_fn(|k| values[9 + k]),
            }
        };
        self.bodies.iter().map(placement_of_body).collect()
    }

    /// Returns the configuration of the mechanism of a pair, and the number of its coordinates.
    fn pair_configuration(
        &self,
        pair: &EvaluatedPair,
        placements: &[BodyPlacement],
    ) -> ([f64; 2 * FLOATING[0]], usize) {
        let (mut q, mut count) = ([0.0; 2 * FLOATING[0]], 0);
        for body in pair.bodies.into_iter().flatten() {
            q[count..count + FLOATING[0]].copy_from_slice(&placements[body].floating_configuration());
            count += FLOATING[0];
        }
        (q, count)
    }

    /// Returns a lower bound of the gaps of a pair from the spheres around its surfaces, m.
    fn least_gap(pair: &EvaluatedPair, placements: &[BodyPlacement]) -> f64 {
        let [Some(first), Some(second)] = pair.bodies else { return f64::NEG_INFINITY };
        let offset = |k: usize| placements[first].position[k] - placements[second].position[k];
        let distance = (0..3).map(|k| offset(k).powi(2)).sum::<f64>().sqrt();
        // NaN as well is no bound.
        let bound = distance - pair.radii[0] - pair.radii[1];
        if bound.is_nan() { f64::NEG_INFINITY } else { bound }
    }

    /// Returns all contacts with a gap of at most `reach` in one of the states, or of at most twice the
    /// distance that their bodies move between the states. If these are more than `most` contacts or
    /// `most_rows` contact velocities, the most distant ones are omitted; an omitted contact that touches is
    /// an error, with the contact.
    pub fn near_contacts(
        &self,
        robot: &Robot,
        states: &[State<'_>],
        reach: f64,
        [most, most_rows]: [usize; 2],
    ) -> Result<NearContacts, usize> {
        let placements: Vec<Vec<BodyPlacement>> =
            states.iter().map(|state| self.body_placements(robot, *state)).collect();
        let displacements: Vec<f64> = match placements.as_slice() {
            [start, end] => start
                .iter()
                .zip(end)
                .zip(&self.radii)
                .map(|((start, end), radius)| start.largest_displacement(end, *radius))
                .collect(),
            _ => vec![0.0; self.bodies.len()],
        };
        let mut near: Vec<(f64, usize, usize)> = Vec::new();
        let mut gaps = Vec::new();
        for (index, pair) in self.pairs.iter().enumerate() {
            // Impulses may stop and reverse the motion of both bodies.
            let motion: f64 = pair.bodies.iter().flatten().map(|body| displacements[*body]).sum();
            let reach = reach + 2.0 * motion;
            gaps.clear();
            gaps.resize(pair.contact_count(), f64::INFINITY);
            for placements in &placements {
                if Self::least_gap(pair, placements) > reach {
                    continue;
                }
                let mut own = vec![f64::NAN; pair.contact_count()];
                let (q, count) = self.pair_configuration(pair, placements);
                pair.call(InternalFunction::ContactGaps, &q[..count], &mut own);
                gaps.iter_mut().zip(own).for_each(|(gap, own)| {
                    // What is not finite is near, so that it is reported.
                    *gap = if own.is_finite() { gap.min(own) } else { f64::NEG_INFINITY };
                });
            }
            let contacts = pair.robot.shared.contacts.iter().zip(&gaps).enumerate();
            near.extend(
                contacts
                    .filter(|(k, (contact, gap))| contact.pressed_by == *k && **gap <= reach)
                    .map(|(k, (_, gap))| (*gap, index, k)),
            );
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut chosen: Vec<(usize, usize)> = Vec::new();
        let mut rows = 0;
        for (gap, index, point) in near {
            let pair = &self.pairs[index];
            let contacts = &pair.robot.shared.contacts;
            let own: Vec<usize> = (0..contacts.len()).filter(|k| contacts[*k].pressed_by == point).collect();
            let own_rows: usize = own.iter().map(|k| contacts[*k].rows[1]).sum();
            if chosen.len() + own.len() > most || rows + own_rows > most_rows {
                match gap <= TOUCHING {
                    true => return Err(pair.first_contact + point),
                    false => break,
                }
            }
            rows += own_rows;
            chosen.extend(own.into_iter().map(|k| (index, k)));
        }
        chosen.sort_unstable();
        Ok(self.number_contacts(&chosen))
    }

    /// Numbers chosen contacts, each given by its pair and its index in the pair.
    fn number_contacts(&self, chosen: &[(usize, usize)]) -> NearContacts {
        let mut near = NearContacts::default();
        for (position, (index, k)) in chosen.iter().enumerate() {
            let pair = &self.pairs[*index];
            let contact = &pair.robot.shared.contacts[*k];
            match near.pairs.last_mut() {
                Some((last, range)) if last == index => range.end = position + 1,
                _ => near.pairs.push((*index, position..position + 1)),
            }
            let bounding = (*index, contact.pressed_by);
            near.contacts.push(pair.first_contact + k);
            near.rows.push([near.row_count, contact.rows[1]]);
            near.pressed_by.push(chosen.binary_search(&bounding).unwrap_or(position));
            let columns = || pair.bodies.iter().flatten().flat_map(|body| &self.bodies[*body].columns);
            let ends = columns().min().zip(columns().max());
            near.columns.push(ends.map_or((0, 0), |(first, last)| (*first, last + 1)));
            near.row_count += contact.rows[1];
        }
        near
    }

    /// Returns all contacts of the mechanism, as if they were near each other.
    pub(super) fn all_contacts(&self) -> NearContacts {
        let pairs = self.pairs.iter().enumerate();
        let all = pairs.flat_map(|(index, pair)| (0..pair.contact_count()).map(move |k| (index, k)));
        self.number_contacts(&all.collect::<Vec<_>>())
    }

    /// Returns the gap of every contact of the mechanism, and infinity for contacts of distant bodies.
    pub fn all_gaps(&self, robot: &Robot, state: State<'_>) -> Vec<f64> {
        let placements = self.body_placements(robot, state);
        let mut gaps = vec![f64::INFINITY; self.laws.len()];
        for pair in &self.pairs {
            if Self::least_gap(pair, &placements) <= 0.0 {
                let (q, count) = self.pair_configuration(pair, &placements);
                let own = &mut gaps[pair.first_contact..pair.first_contact + pair.contact_count()];
                pair.call(InternalFunction::ContactGaps, &q[..count], own);
            }
        }
        gaps
    }

    /// Writes the gaps of near contacts.
    pub fn write_gaps(&self, robot: &Robot, near: &NearContacts, state: State<'_>, out: &mut [f64]) {
        let placements = self.body_placements(robot, state);
        let mut gaps = Vec::new();
        for (index, range) in &near.pairs {
            let pair = &self.pairs[*index];
            gaps.clear();
            gaps.resize(pair.contact_count(), f64::NAN);
            let (q, count) = self.pair_configuration(pair, &placements);
            pair.call(InternalFunction::ContactGaps, &q[..count], &mut gaps);
            for k in range.clone() {
                out[k] = gaps[near.contacts[k] - pair.first_contact];
            }
        }
    }

    /// Calls a function with the contact Jacobian of each pair with near contacts: the pair, its near
    /// contacts, the placements of its bodies, and the Jacobian with respect to their velocities in ground
    /// axes, column by column.
    fn for_each_pair_jacobian(
        &self,
        near: &NearContacts,
        placements: &[BodyPlacement],
        mut visit: impl FnMut(&EvaluatedPair, std::ops::Range<usize>, &[f64], usize),
    ) {
        let (mut local, mut in_ground_axes) = (Vec::new(), Vec::new());
        for (index, range) in &near.pairs {
            let pair = &self.pairs[*index];
            let rows = pair.robot.shared.contact_rates;
            let columns = pair.robot.nv();
            local.clear();
            local.resize(rows * columns, f64::NAN);
            let (q, count) = self.pair_configuration(pair, placements);
            pair.call(InternalFunction::ContactJacobian, &q[..count], &mut local);
            in_ground_axes.clear();
            in_ground_axes.resize(rows * columns, 0.0);
            for (side, body) in pair.bodies.iter().flatten().enumerate() {
                let rotation = &placements[*body].rotation;
                for first in [FLOATING[1] * side, FLOATING[1] * side + 3] {
                    for axis in 0..3 {
                        let to = (first + axis) * rows;
                        for component in 0..3 {
                            let (from, factor) = ((first + component) * rows, rotation[3 * component + axis]);
                            for row in 0..rows {
                                in_ground_axes[to + row] += local[from + row] * factor;
                            }
                        }
                    }
                }
            }
            visit(pair, range.clone(), &in_ground_axes, rows);
        }
    }

    /// Writes the Jacobian of near contacts, column by column with `stride` rows. `out` is zero before.
    pub fn write_jacobian(
        &self,
        robot: &Robot,
        near: &NearContacts,
        state: State<'_>,
        (out, stride): (&mut [f64], usize),
    ) {
        let placements = self.body_placements(robot, state);
        let mut jacobians: Vec<Option<Vec<f64>>> = vec![None; self.bodies.len()];
        let twist = FLOATING[1];
        self.for_each_pair_jacobian(near, &placements, |pair, range, local, rows| {
            for (side, body) in pair.bodies.iter().flatten().enumerate() {
                let functions = &self.bodies[*body];
                let jacobian = jacobians[*body].get_or_insert_with(|| {
                    let mut values = vec![f64::NAN; twist * robot.nv()];
                    let _ = robot.call_with_state_into(functions.jacobian, state, &mut values);
                    values
                });
                for column in &functions.columns {
                    let of_body = &jacobian[twist * column..twist * (column + 1)];
                    let to = &mut out[stride * column..stride * (column + 1)];
                    for k in range.clone() {
                        let [first, count] = near.rows[k];
                        let [own, _] = pair.robot.shared.contacts[near.contacts[k] - pair.first_contact].rows;
                        for i in 0..count {
                            let entries = local[own + i..].iter().step_by(rows).skip(twist * side);
                            to[first + i] += entries.zip(of_body).map(|(a, b)| a * b).sum::<f64>();
                        }
                    }
                }
            }
        });
    }

    /// Writes the contact velocities of near contacts.
    pub fn write_rates(&self, robot: &Robot, near: &NearContacts, state: State<'_>, out: &mut [f64]) {
        let placements = self.body_placements(robot, state);
        let mut velocities: Vec<Option<[f64; FLOATING[1]]>> = vec![None; self.bodies.len()];
        let twist = FLOATING[1];
        self.for_each_pair_jacobian(near, &placements, |pair, range, local, rows| {
            for (side, body) in pair.bodies.iter().flatten().enumerate() {
                let velocity = velocities[*body].get_or_insert_with(|| {
                    let mut values = [f64::NAN; FLOATING[1]];
                    let _ = robot.call_with_state_into(self.bodies[*body].velocity, state, &mut values);
                    values
                });
                for k in range.clone() {
                    let [first, count] = near.rows[k];
                    let [own, _] = pair.robot.shared.contacts[near.contacts[k] - pair.first_contact].rows;
                    for i in 0..count {
                        let entries = local[own + i..].iter().step_by(rows).skip(twist * side);
                        out[first + i] += entries.zip(&*velocity).map(|(a, b)| a * b).sum::<f64>();
                    }
                }
            }
        });
    }
}

impl BodyFunctions {
    fn of_frame(robot: &Robot, frame: usize) -> Result<BodyFunctions, Error> {
        let name = &robot.shared.frames.names[frame];
        let function = |kind: &str| {
            let index = robot.shared.index.get(&format!("{kind}({name})")).copied();
            index.ok_or_else(|| Error::Internal(format!("no `{kind}` of the frame `{name}`")))
        };
        Ok(BodyFunctions {
            placement: function("frame_placement")?,
            velocity: function("frame_velocity")?,
            jacobian: function("frame_jacobian")?,
            columns: robot.shared.frames.velocities_of_frame(frame),
        })
    }
}

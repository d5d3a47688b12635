//! Numbering of coordinates and velocities, in the order of declaration.

use super::closed_form::ClosedFormLoop;
use super::holders;
use super::joint::{charts_of_joint, full_name, unscaled_coordinate};
use super::reaction::RELEASED;
use super::scope::{JointCoordinates, NamedCoordinate};
use crate::diag::{Diagnostics, Place};
use crate::mechanism::{Chart, Coordinate, InQ, InV};
use crate::syntax::Description;

/// Entries of `q` and `v`, with the joints and coordinates to which they belong.
#[derive(Default)]
pub struct CoordinateNumbering {
    /// Names of the entries of `q`.
    pub configuration: Vec<String>,
    /// Entries of `q` at which the robot file places a joint, with the coordinates of the joint.
    pub initial: Vec<(InQ, Vec<f64>)>,
    /// Names of the entries of `v`, with the declarations to which they belong.
    pub velocities: Vec<(String, Place)>,
    /// Charts of the configuration space.
    pub charts: Vec<Chart>,
    /// Plain coordinates of joints, and declared coordinates.
    pub coordinates: Vec<NamedCoordinate>,
    /// Coordinates of each joint.
    pub joints: Vec<JointCoordinates>,
}

impl CoordinateNumbering {
    /// Numbers the entries of `q` and `v` in the order of declaration. Joints that close loops have no
    /// coordinates. Joints that follow another joint (`mimic`) are numbered last, because their leaders may
    /// be declared later.
    pub fn number_description_coordinates(
        description: &Description,
        (closing, solved_loops): (&[bool], &[ClosedFormLoop]),
        cx: &mut Diagnostics,
    ) -> CoordinateNumbering {
        let mut all = CoordinateNumbering::default();
        let is_solved_by_loop = |j: usize| solved_loops.iter().any(|solved| solved.sides.contains(&j));
        for (j, joint) in description.joints.iter().enumerate() {
            all.assign_free_coordinate_indices(description, j);
            let (q, v) = all.next_coordinate_indices();
            let mut plain = Vec::new();
            if joint.mimic.is_none() && !closing[j] && !is_solved_by_loop(j) {
                all.charts.extend(charts_of_joint(joint.kind, (q, v), joint.along.len()));
                if !joint.initial.is_empty() {
                    all.initial.push((q, joint.initial.clone()));
                }
                let (names_q, names_v) = joint.kind.configuration_and_velocity_names(joint.along.len());
                for name in &names_q {
                    all.configuration.push(full_name(&joint.name.text, name));
                }
                for (k, name) in names_v.iter().enumerate() {
                    let full = full_name(&joint.name.text, name);
                    if names_q == names_v {
                        plain.push((
                            full.clone(),
                            unscaled_coordinate(q + k, v + k),
                            joint.kind.is_angle(name),
                        ));
                    }
                    all.velocities.push((full, joint.name.place.clone()));
                }
            }
            all.coordinates.extend(plain.iter().cloned());
            all.joints.push(JointCoordinates { q, v, plain });
        }
        all.assign_free_coordinate_indices(description, description.joints.len());
        for (k, joint) in description.joints.iter().enumerate() {
            let Some(mimic) = &joint.mimic else { continue };
            let master = description.joints.iter().position(|j| j.name.text == mimic.joint.text);
            match master.map(|m| all.joints[m].plain.as_slice()) {
                Some([(_, c, _)]) => {
                    let coordinate = Coordinate {
                        ratio: mimic.multiplier * c.ratio,
                        offset: mimic.multiplier * c.offset + mimic.offset,
                        ..*c
                    };
                    let angle = joint.kind.is_angle("");
                    all.coordinates.push((joint.name.text.clone(), coordinate, angle));
                    all.joints[k].plain.push((joint.name.text.clone(), coordinate, angle));
                }
                _ => {
                    cx.report_error(
                        mimic.joint.place.clone(),
                        format!("`{}` cannot be followed", mimic.joint.text),
                    )
                    .add_help("a joint that others follow has one coordinate");
                }
            }
        }
        all
    }

    /// Returns the indices in `q` and `v` of the next coordinate that is added.
    pub fn next_coordinate_indices(&self) -> (InQ, InV) {
        (InQ(self.configuration.len()), InV(self.velocities.len()))
    }

    /// Numbers the free coordinates that are declared after the given number of joints.
    fn assign_free_coordinate_indices(&mut self, description: &Description, joints: usize) {
        for free in description.coordinates.iter().filter(|c| c.joints_before == joints) {
            let (q, v) = self.next_coordinate_indices();
            self.configuration.push(free.name.text.clone());
            self.velocities.push((free.name.text.clone(), free.name.place.clone()));
            self.charts.push(Chart::Plain(q, v));
            self.coordinates.push((free.name.text.clone(), unscaled_coordinate(q, v), false));
        }
    }

    /// Adds the coordinates of released joints after all others.
    pub fn add_released_coordinates(&mut self, description: &Description, joints: &[usize]) {
        for j in joints {
            let Some(name) = holders::name_of_connection(description, *j) else { continue };
            for k in 0..RELEASED {
                let (q, v) = self.next_coordinate_indices();
                self.charts.push(Chart::Plain(q, v));
                self.configuration.push(format!("{}.open{k}", name.text));
                self.velocities.push((format!("{}.open{k}", name.text), name.place.clone()));
            }
        }
    }
}

//! Numbering of coordinates and velocities, in the order of declaration.

use super::builder::{Builder, JointCoordinates};
use super::holders;
use super::joint::{charts_of_joint, full_name, own_coordinate};
use super::reaction::RELEASED;
use super::{closed_form, tree};
use crate::diag::Diagnostics;
use crate::mechanism::{Chart, Coordinate};

impl<'g> Builder<'_, 'g> {
    /// Numbers the entries of `q` and `v` in the order of declaration. Joints that close loops have no
    /// coordinates. Joints that follow another joint (`mimic`) are numbered last, because their leaders may
    /// be declared later.
    pub fn number_coordinates(&mut self, cx: &mut Diagnostics) {
        let closing = tree::loop_closing_joints(self.description);
        self.solved_loops = closed_form::find_solved_loops(self.description, &closing, cx);
        for (j, joint) in self.description.joints.iter().enumerate() {
            self.number_free_coordinates(j);
            let (q, v) = self.model.next_coordinate();
            let mut plain = Vec::new();
            if joint.mimic.is_none() && !closing[j] && self.solving_loop(j).is_none() {
                self.model.charts.extend(charts_of_joint(joint.kind, (q, v), joint.along.len()));
                let (names_q, names_v) = joint.kind.coordinate_names(joint.along.len());
                for name in &names_q {
                    self.model.configuration.push(full_name(&joint.name.text, name));
                }
                for (k, name) in names_v.iter().enumerate() {
                    let full = full_name(&joint.name.text, name);
                    if names_q == names_v {
                        plain.push((full.clone(), own_coordinate(q + k, v + k), joint.kind.is_angle(name)));
                    }
                    self.model.velocities.push((full, joint.name.place.clone()));
                }
            }
            self.scope.kinematics.coordinates.extend(plain.iter().cloned());
            self.coordinates.push(JointCoordinates { q, v, plain });
        }
        self.number_free_coordinates(self.description.joints.len());
        for (k, joint) in self.description.joints.iter().enumerate() {
            let Some(mimic) = &joint.mimic else { continue };
            let master = self.description.joints.iter().position(|j| j.name.text == mimic.joint.text);
            match master.map(|m| self.coordinates[m].plain.as_slice()) {
                Some([(_, c, _)]) => {
                    let coordinate = Coordinate {
                        ratio: mimic.multiplier * c.ratio,
                        offset: mimic.multiplier * c.offset + mimic.offset,
                        ..*c
                    };
                    let angle = joint.kind.is_angle("");
                    self.scope.kinematics.coordinates.push((joint.name.text.clone(), coordinate, angle));
                    self.coordinates[k].plain.push((joint.name.text.clone(), coordinate, angle));
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
    }

    /// Numbers the free coordinates that are declared after the given number of joints.
    fn number_free_coordinates(&mut self, joints: usize) {
        for free in self.description.coordinates.iter().filter(|c| c.joints_before == joints) {
            let (q, v) = self.model.next_coordinate();
            self.model.configuration.push(free.name.text.clone());
            self.model.velocities.push((free.name.text.clone(), free.name.place.clone()));
            self.model.charts.push(Chart::Plain(q, v));
            let kinematics = &mut self.scope.kinematics;
            kinematics.coordinates.push((free.name.text.clone(), own_coordinate(q, v), false));
        }
    }

    /// Adds the coordinates of joints that are released for reactions, after all others.
    pub fn number_released_coordinates(&mut self, joints: &[usize]) {
        for j in joints {
            let Some(name) = holders::name_of(self.description, *j) else { continue };
            for k in 0..RELEASED {
                let (q, v) = self.model.next_coordinate();
                self.model.charts.push(Chart::Plain(q, v));
                self.model.configuration.push(format!("{}.open{k}", name.text));
                self.model.velocities.push((format!("{}.open{k}", name.text), name.place.clone()));
            }
        }
    }
}

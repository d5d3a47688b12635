//! Additions to the model: the parts that resolved elements return.

use super::builder::{Builder, ComputedMotionsProof};
use super::chain::report_joint_argument_errors;
use super::closed_form::joints_solved_in_closed_form;
use super::closure::{loop_closure_rows, planar_loop_rows};
use super::constraint::{report_constraint_errors, resolve_constraint};
use super::contact::{resolve_contact, resolve_stops};
use super::drive::{file_element_quantities, resolve_file_element_forces, weighted_coordinates};
use super::element_forces::ElementForces;
use super::forces::{forces_of_element, report_unused_input};
use super::free_body::{forces_on_released_joints, resolve_free_body_diagram};
use super::freedom::remove_redundancy_and_check_mobility;
use super::masses::{body_mass_properties, resolve_particle_mass};
use super::output::resolve_output;
use super::power::{is_power_used, power_of_element, slipping_powers};
use super::rows::ConstraintRows;
use super::scope::MassProperties;
use super::speeds::resolve_speeds;
use super::terms::{report_definition_errors, resolve_dissipation, resolve_potential_energy};
use crate::diag::Diagnostics;
use crate::expr::{Rotation, Sym3, Vec3};
use crate::language::Key;
use crate::mechanism::{DegreeOfFreedomCounts, Inertia, InputEffect, NamedFrame, Pose};
use crate::syntax::contact::MAX_CONTACT_POINTS;
use crate::syntax::{FileForceLaw, Formulation, GROUND, Rank};
use std::rc::Rc;

/// Maximum number of scalar constraints of a mechanism: twice the maximum number of velocities, because half
/// of the constraints may be redundant.
const MAX_CONSTRAINTS: usize = 256;

/// Proof that the joints for which loops are solved are recorded. Created only by
/// [`Builder::record_loops_with_closed_form`].
pub struct LoopsSolved(());

/// Proof that all constraints have been added. Created only by [`Builder::add_constraints`].
#[derive(Clone, Copy)]
pub struct ConstraintsAdded(());

impl<'g> Builder<'_, 'g> {
    /// Adds the masses of all bodies and particles to their links.
    pub fn add_masses(&mut self, cx: &mut Diagnostics) {
        for body in &self.scope.description.bodies {
            // Inertial parameters of a body that a file fixes to the ground enter no equation.
            let placed = self.scope.kinematics.places.get(&body.name.text);
            let is_fixed = placed.is_some_and(|placed| placed.link.is_none());
            let from_file = body.name.place.file.is_some();
            let mut silent = Diagnostics::new();
            let cx = if is_fixed && from_file { &mut silent } else { &mut *cx };
            if let Some(masses) = body_mass_properties(&self.scope, body, cx) {
                self.scope.kinematics.masses.insert(body.name.text.clone(), masses);
                self.attach_mass(&body.name.text, masses);
            }
        }
        for particle in &self.scope.description.particles {
            let name = &particle.name.text;
            let placed = self.scope.kinematics.places.get(name);
            let is_moving = placed.is_some_and(|placed| placed.link.is_some());
            if let Some(mass) = resolve_particle_mass(&self.scope, particle, cx).filter(|_| is_moving) {
                let masses = (mass, Vec3::zero(self.scope.graph), Sym3::zero(self.scope.graph));
                self.scope.kinematics.masses.insert(name.clone(), masses);
                self.attach_mass(name, masses);
            }
        }
    }

    /// Adds the mass of an element to that of the link that carries it.
    fn attach_mass(&mut self, name: &str, (mass, com, central): MassProperties<'g>) {
        let Some(placed) = self.scope.kinematics.places.get(name) else { return };
        let Some(link) = placed.link else { return };
        let (com, central) =
            (placed.pose.transform_point(com), placed.pose.rotation.symmetric_tensor_in_parent_axes(central));
        let sum = &mut self.model.links[link.0].inertia;
        *sum = sum.plus(&Inertia::of_body(mass, com, central));
    }

    /// Adds all force elements and inputs of a file.
    pub fn add_file_force_elements(&mut self, _: ComputedMotionsProof, cx: &mut Diagnostics) {
        for drive in &self.scope.description.drives {
            let terms = weighted_coordinates(&self.scope, drive, cx);
            let on = (self.model.inputs.len(), terms.as_slice());
            for (quantity, value) in file_element_quantities(&self.scope, drive, on, cx) {
                let name = quantity.file_force_quantity_name(&drive.name.text);
                self.scope.kinematics.file_element_quantities.insert(name, value);
            }
            if let Some(forces) = resolve_file_element_forces(&self.scope, drive, on, cx) {
                forces.add_forces_to_model(&mut self.model);
            }
            if let FileForceLaw::Input(unit) = drive.law {
                self.model.inputs.push((drive.name.text.clone(), InputEffect::Sum(terms, unit)));
            }
        }
    }

    /// Adds the forces of all force elements and inputs to the model.
    pub fn add_actions(&mut self, _: ComputedMotionsProof, cx: &mut Diagnostics) {
        // Inputs without an element of their own appear in expressions. The others are filled in by their
        // elements.
        for input in &self.scope.description.inputs {
            self.model.inputs.push((input.text.clone(), InputEffect::Named));
        }
        for action in &self.scope.description.actions {
            let name = &action.name.text;
            let mut forces = forces_of_element(&self.scope, action, cx).unwrap_or_default();
            // An element without an effect may be zero by its values. An input has an entry of `u` in any
            // case.
            if cx.is_empty() && action.is_input() && forces.is_empty() {
                report_unused_input(&action.name, cx);
            }
            if let Some(input) = forces.input.take()
                && let Some((_, slot)) = self.model.inputs.iter_mut().find(|(known, _)| known == name)
            {
                *slot = input;
            }
            if is_power_used(self.scope.description, &action.name) {
                let power = power_of_element(&self.scope, &self.model, &forces, name);
                self.scope.kinematics.powers.insert(name.clone(), power);
            }
            self.add_element_forces(name, forces);
        }
    }

    /// Adds the forces of an element, and records them for free-body diagrams.
    fn add_element_forces(&mut self, name: &str, forces: ElementForces<'g>) {
        if let Some(release) = &mut self.release
            && self.scope.description.outputs.iter().any(|output| output.rank == Rank::FreeBody)
        {
            let on_released = forces_on_released_joints(&self.scope, &self.model, (release, &forces), name);
            release.forces.push((name.to_string(), on_released));
        }
        forces.add_forces_to_model(&mut self.model);
    }

    /// Records the joints for which loops are solved in closed form, with their axes.
    pub fn record_loops_with_closed_form(&mut self, cx: &mut Diagnostics) -> LoopsSolved {
        self.model.solved = joints_solved_in_closed_form(&self.scope, &self.solved_loops, cx);
        LoopsSolved(())
    }

    /// Adds all constraints: first those of loop-closing joints, then the declared ones.
    pub fn add_constraints(
        &mut self,
        closing: &[usize],
        _: (ComputedMotionsProof, LoopsSolved),
        cx: &mut Diagnostics,
    ) -> ConstraintsAdded {
        let d = self.scope.description;
        let ground_axes = Rotation::identity(self.scope.graph);
        if !cx.is_empty() {
            for j in closing {
                report_joint_argument_errors(&self.scope, &d.joints[*j], cx);
                self.record_joint_for_reactions(*j, None, &ground_axes);
            }
            for constraint in &d.constraints {
                report_constraint_errors(&self.scope, &self.model, constraint, cx);
            }
            return ConstraintsAdded(());
        }
        let solved: Vec<usize> = self.solved_loops.iter().map(|e| e.closing).collect();
        for j in closing.iter().filter(|j| !solved.contains(j)) {
            if let Some(rows) = loop_closure_rows(&self.scope, &self.model, *j, cx) {
                self.record_joint_for_reactions(*j, None, &ground_axes);
                self.add_constraint_rows(&d.joints[*j].name.text, rows);
            }
        }
        for (index, constraint) in d.constraints.iter().enumerate() {
            let rows = resolve_constraint(&self.scope, &self.model, (index, constraint), cx);
            self.add_constraint_rows(&constraint.name.text, rows.unwrap_or_default());
        }
        self.model.constraints.sort_by_key(|c| c.residual.is_none());
        self.model.freedom =
            DegreeOfFreedomCounts { coordinates: self.model.nv(), velocities: self.model.nv() };
        if !self.check_number_of_constraints(cx) {
            return ConstraintsAdded(());
        }
        for j in &solved {
            self.record_joint_for_reactions(*j, None, &ground_axes);
        }
        if let Some(release) = &self.release {
            let retained = release.retained;
            self.model.constraints.retain(|c| retained.iter().any(|k| k.name == c.name));
            for j in &solved {
                let rows = planar_loop_rows(&self.scope, &self.model, *j, cx);
                self.add_constraint_rows(&d.joints[*j].name.text, rows.unwrap_or_default());
            }
        } else if cx.is_empty() && !self.model.constraints.is_empty() {
            let mut found = Diagnostics::new();
            remove_redundancy_and_check_mobility(&mut self.model, &d.formulation, &mut found);
            self.mobility = found;
        }
        ConstraintsAdded(())
    }

    /// Reports independent speeds without constraints, and too many constraints. Returns false for the
    /// latter.
    fn check_number_of_constraints(&self, cx: &mut Diagnostics) -> bool {
        let d = self.scope.description;
        let count = self.model.constraints.len();
        if let (Formulation::Speeds(_, place), 0) = (&d.formulation, count) {
            cx.report_error(place.clone(), "all speeds are independent: this mechanism has no constraint")
                .add_help("remove this argument");
        }
        if count > MAX_CONSTRAINTS {
            let message = format!("{count} scalar constraints, more than {MAX_CONSTRAINTS}");
            cx.report_error(d.name.place.clone(), message).add_help(
                "each loop adds up to five of them: connect the bodies as a tree where possible, or divide \
                 the mechanism",
            );
        }
        count <= MAX_CONSTRAINTS
    }

    /// Adds the rows of a constraint, in groups of their own.
    fn add_constraint_rows(&mut self, name: &str, rows: ConstraintRows<'g>) {
        let first = self.group + 1;
        self.group = first;
        for mut row in rows.rows {
            row.group += first;
            self.group = self.group.max(row.group);
            self.model.constraints.push(row);
        }
        self.model.redundant.extend(rows.redundant);
        self.surfaces.extend(rows.surfaces.into_iter().map(|surface| (name.to_string(), surface)));
        if let Some((release, point)) = self.release.as_mut().zip(rows.contact_point) {
            release.contact_points.insert(name.to_string(), point);
        }
    }

    /// Records the power of slipping contacts for outputs.
    pub fn record_slipping_power(&mut self) {
        self.scope.kinematics.powers.extend(slipping_powers(&self.model));
    }

    /// Adds all contacts to the model: declared contacts in their order, then the stops of limits.
    pub fn add_contacts(&mut self, _: ComputedMotionsProof, cx: &mut Diagnostics) {
        let d = self.scope.description;
        let surfaces_of_pairs = std::mem::take(&mut self.surfaces);
        for contact in &d.contacts {
            let Some(parts) = resolve_contact(&self.scope, &self.model, contact, cx) else { continue };
            let name = &contact.name.text;
            self.surfaces.extend(parts.surfaces.into_iter().map(|surface| (name.clone(), surface)));
            self.model.contacts.extend(parts.contacts);
            self.model.polytopes.extend(parts.polytopes);
            parts.forces.add_forces_to_model(&mut self.model);
            let kinematics = &mut self.scope.kinematics;
            kinematics.powers.extend(parts.power.map(|power| (name.clone(), power)));
            // Surfaces that cannot move relative to each other exert no forces.
            if !parts.loads.forces.is_empty() {
                kinematics.contact_loads.insert(name.clone(), parts.loads);
            }
            if let Some(release) = &mut self.release {
                release.contact_points.extend(parts.points);
            }
        }
        self.surfaces.extend(surfaces_of_pairs);
        for limit in
            d.limits.iter().filter(|limit| limit.arguments.expression_of_key(Key::Restitution).is_some())
        {
            self.model.contacts.extend(resolve_stops(&self.scope, limit, cx));
        }
        let count = self.model.contacts.len();
        if count > MAX_CONTACT_POINTS {
            let place = d.contacts.first().map_or(&d.name.place, |c| &c.name.place);
            cx.report_error(
                place.clone(),
                format!("{count} points of contact, more than {MAX_CONTACT_POINTS}"),
            )
            .add_help("each adds code: use fewer contact points, or divide the mechanism")
            .add_help(
                "mechanisms that are loaded at run time (the command, Python, `linkwork-jit`) may have more, \
                 between surfaces of bodies, without `derivatives` and without stops that have restitution",
            );
        }
    }

    /// Adds potential energies and dissipation functions given as expressions, followed by the outputs.
    pub fn add_energies_and_outputs(&mut self, _: ConstraintsAdded, cx: &mut Diagnostics) {
        let d = self.scope.description;
        for (name, e) in &d.energies {
            let forces = resolve_potential_energy(&self.scope, e, cx);
            self.add_element_forces(&name.text, forces);
        }
        for (name, e) in &d.dissipations {
            let forces = resolve_dissipation(&self.scope, e, cx);
            self.add_element_forces(&name.text, forces);
        }
        for output in &d.outputs {
            let found = match output.rank {
                Rank::FreeBody => {
                    let connections = (self.release.as_ref(), self.moving_placements.as_slice());
                    resolve_free_body_diagram(&self.scope, &self.model, connections, output, cx)
                }
                _ => resolve_output(&self.scope, output, cx),
            };
            self.model.outputs.extend(found);
        }
        report_definition_errors(&self.scope, cx);
    }

    /// Adds the declared generalized speeds, and replaces the velocities that they contain.
    pub fn add_speeds(&mut self, _: ConstraintsAdded, cx: &mut Diagnostics) {
        if self.scope.description.speeds.is_empty() || self.release.is_some() || !cx.is_empty() {
            return;
        }
        if let Some((speeds, velocities)) = resolve_speeds(&self.scope, &self.model, cx) {
            self.model.velocities = velocities;
            self.model.speeds = Some(Rc::new(speeds));
        }
    }

    /// Adds the named frames of all placed elements.
    pub fn add_frames(&mut self) {
        let d = self.scope.description;
        if d.ground_frame {
            let (name, pose) = (GROUND.to_string(), Pose::identity(self.scope.graph));
            self.model.frames.push(NamedFrame { name, massive: false, link: None, pose });
        }
        let massive = d.bodies.iter().map(|b| &b.name).chain(d.particles.iter().map(|p| &p.name));
        let points = d.points.iter().map(|p| (&p.name, false));
        for (name, massive) in massive.map(|name| (name, true)).chain(points) {
            if let Some(p) = self.scope.kinematics.places.get(&name.text) {
                let (name, link, pose) = (name.text.clone(), p.link, p.pose.clone());
                self.model.frames.push(NamedFrame { name, massive, link, pose });
            }
        }
    }
}

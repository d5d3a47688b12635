//! Diagnostics for singular mass matrices: a lack of inertia is a user error, reported with its cause.

use crate::diag::{Diagnostics, join_names_with_and};
use crate::expr::{Graph, Sym3, Vec3};
use crate::kinematics::Joint;
use crate::mechanics::{added_mass, crba, massless, regularity};
use crate::mechanism::{Inertia, LinkId, Model, Motion};
use crate::syntax::ROOT_JOINT;

/// Help text for a mechanism without inertia.
const LEAVE_OUT: &str = "or omit the dynamics with `inertia = none`: frames, their Jacobians, constraints \
                         and outputs remain";

/// Returns true if the mass matrix is regular; otherwise reports the cause.
pub fn check_mass_matrix<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &crba::Matrix<'g>,
    cx: &mut Diagnostics,
) -> bool {
    let loaded = massless::mass_with_weighted_constraints(model, joints, mass.clone());
    let mut singular = regularity::velocities_with_singular_mass(model, joints, &loaded);
    if singular.is_empty() {
        return true;
    }
    if model.inertances.is_empty()
        && model.links.iter().all(|link| link.inertia == Inertia::zero(model.graph))
    {
        report_no_inertia(model, singular[0], cx);
        return false;
    }
    if let Some((bare, rest)) = massless_base(model, joints, &singular) {
        // An error that a base with mass would not remove is reported separately.
        report_massless_base(model, bare, cx);
        singular = rest;
    }
    if !singular.is_empty() {
        report_massless_velocities(model, &singular, cx);
    }
    false
}

/// Returns true if the effective mass matrix is regular; otherwise reports that forces linear in
/// accelerations cancel the inertia.
pub fn check_effective_mass<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &crba::Matrix<'g>,
    cx: &mut Diagnostics,
) -> bool {
    let [force, ..] = model.acceleration_forces.as_slice() else { return true };
    let singular = regularity::velocities_with_singular_mass(
        model,
        joints,
        &added_mass::effective_mass_matrix(model, mass),
    );
    let names: Vec<String> = singular.iter().map(|k| format!("`{}`", model.velocities[*k].0)).collect();
    if names.is_empty() {
        return true;
    }
    cx.report_error(
        force.place.clone(),
        format!("forces that depend on accelerations cancel the inertia of {}", join_names_with_and(&names)),
    )
    .add_help("an added mass of water or air opposes the acceleration, as in `value = -added * a(…)`");
    false
}

/// Returns mass properties with unit mass and unit inertia.
fn unit_mass_properties(graph: &Graph) -> Inertia<'_> {
    Inertia::of_body(graph.one(), Vec3::zero(graph), Sym3::multiple_of_identity(graph.one()))
}

/// Returns a free link without mass, or without a moment of inertia about some axis, if more inertia of this
/// link would leave fewer singular velocities. The remaining singular velocities are returned as well.
fn massless_base<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    singular: &[usize],
) -> Option<(usize, Vec<usize>)> {
    let is_free_link = |link: &usize| matches!(model.links[*link].motion, Motion::Free { .. });
    (0..model.links.len()).filter(is_free_link).find_map(|bare| {
        let mut with_mass = model.clone();
        with_mass.links[bare].inertia = unit_mass_properties(model.graph);
        let mass = crba::mass_matrix(&with_mass, joints);
        let loaded = massless::mass_with_weighted_constraints(&with_mass, joints, mass);
        let rest = regularity::velocities_with_singular_mass(&with_mass, joints, &loaded);
        (rest.len() < singular.len()).then_some((bare, rest))
    })
}

/// Reports that a mechanism has no inertia at all.
fn report_no_inertia(model: &Model<'_>, velocity: usize, cx: &mut Diagnostics) {
    let place = &model.velocities[velocity].1;
    let (what, mend) = match place.file {
        Some(_) => ("no moving link has inertia", "add `<inertial>` elements to the file"),
        None => ("no moving body has inertia", "give mass or inertia to the bodies"),
    };
    cx.report_error(place.clone(), what).add_help(mend).add_help(LEAVE_OUT);
}

/// Reports a free base link without mass or without moments of inertia.
fn report_massless_base(model: &Model<'_>, link: usize, cx: &mut Diagnostics) {
    let Motion::Free { v, .. } = model.links[link].motion else { return };
    let place = &model.velocities[v.0].1;
    let body = model.frames.iter().find(|frame| frame.massive && frame.link == Some(LinkId(link)));
    let name = body.map_or("the base", |body| body.name.as_str());
    let what = match model.links[link].inertia.mass.is_zero() {
        true => "no mass of its own",
        false => "no moment of inertia about some axis",
    };
    let diagnostic = cx.report_error(place.clone(), format!("`{name}` moves freely and has {what}"));
    diagnostic.add_help(format!("a free base needs a mass and an inertia of its own: give them to `{name}`"));
    if place.file.is_some() {
        diagnostic.add_help("or fix it: remove `base = free`");
    }
}

/// Reports all velocities that move no inertia in one error, since a file may have many.
fn report_massless_velocities(model: &Model<'_>, singular: &[usize], cx: &mut Diagnostics) {
    const MAX_REPORTED: usize = 8;
    let place = &model.velocities[singular[0]].1;
    let names: Vec<&str> = singular.iter().map(|k| model.velocities[*k].0.as_str()).collect();
    let mut list: Vec<String> = names.iter().take(MAX_REPORTED).map(|name| format!("`{name}`")).collect();
    if names.len() > MAX_REPORTED {
        list.push(format!("{} more", names.len() - MAX_REPORTED));
    }
    let (subject, verb, joints) = match names.len() {
        1 => ("coordinate", "moves", "the joint carries"),
        _ => ("coordinates", "move", "the joints carry"),
    };
    let message = format!("the {subject} {} {verb} no body with inertia", join_names_with_and(&list));
    let diagnostic = cx.report_error(place.clone(), message);
    diagnostic
        .add_help(format!("the mass matrix is singular: give mass or inertia to the bodies that {joints}"));
    if place.file.is_some() {
        let mut joints: Vec<&str> = singular.iter().map(|k| joint_name_of_velocity(model, *k)).collect();
        joints.dedup();
        // The root joint is not defined in the file.
        joints.retain(|joint| !joint.starts_with(ROOT_JOINT));
        match joints.as_slice() {
            [] => {}
            _ if singular.len() == model.nv() => {}
            [joint] => _ = diagnostic.add_help(format!("or freeze the joint: `lock = [\"{joint}\"]`")),
            all => _ = diagnostic.add_help(format!("or freeze the joints: `lock = {all:?}`")),
        }
        diagnostic.add_help(LEAVE_OUT);
    }
}

/// Returns the name of a velocity's joint. The velocities of a joint with several degrees of freedom have the
/// same place and different suffixes.
fn joint_name_of_velocity<'a>(model: &'a Model<'_>, velocity: usize) -> &'a str {
    let (name, place) = &model.velocities[velocity];
    let alone = model.velocities.iter().filter(|(_, other)| other.file == place.file).count() == 1;
    name.rsplit_once('.').filter(|_| !alone).map_or(name, |(joint, _)| joint)
}

//! Topology: the joint of each body in the spanning tree, the joints that close loops, and the order in which
//! links are built.

use super::scope::Scope;
use crate::diag::{Diagnostics, Place};
pub use crate::syntax::GROUND;
use crate::syntax::{Description, Expr, ExprKind, Name, words};
use std::collections::BTreeMap;

/// Index into the list of bodies and jointed particles.
pub type BodyIndex = usize;

/// Tree joints in an order in which every parent is placed before its children, with the bodies that they
/// place, and the joints that close loops.
pub struct PlacementOrder {
    /// Index of the joint and of its child body, for each tree joint.
    pub joints: Vec<(usize, BodyIndex)>,
    /// Indices of the joints that close loops, since their child is already placed.
    pub closing: Vec<usize>,
}

/// Returns for each joint whether it closes a loop: its child is placed by an earlier joint or has a position
/// of its own, or is an ancestor of the parent. All other joints form the spanning tree.
pub fn loop_closing_flags(description: &Description) -> Vec<bool> {
    let mut parents: BTreeMap<&str, &str> = BTreeMap::new();
    for point in &description.points {
        if let Some(base) = point.on.as_ref().and_then(body_name_of_position) {
            parents.insert(&point.name.text, base);
        }
    }
    for particle in &description.particles {
        if let Some(at) = &particle.at {
            parents.insert(&particle.name.text, body_name_of_position(at).unwrap_or(GROUND));
        }
    }
    let mut closing = Vec::with_capacity(description.joints.len());
    for joint in &description.joints {
        let (parent, child) = (joint.parent.body.text.as_str(), joint.child.body.text.as_str());
        let known = child == GROUND
            || parents.contains_key(child)
            || description.points.iter().any(|p| p.name.text == child);
        let closes = known || (parent != child && is_descendant(&parents, child, parent));
        if !closes {
            parents.insert(child, parent);
        }
        closing.push(closes);
    }
    closing
}

/// Returns whether an element is a descendant of another element, or is that element.
fn is_descendant(parents: &BTreeMap<&str, &str>, carrier: &str, carried: &str) -> bool {
    let mut current = Some(carried);
    (0..=parents.len()).any(|_| {
        let here = current;
        current = here.and_then(|name| parents.get(name).copied());
        here == Some(carrier)
    })
}

/// Returns the body's name at the beginning of `body.at(vector)`.
pub fn body_name_of_position(e: &Expr) -> Option<&str> {
    match &e.kind {
        ExprKind::Name(name) => Some(name),
        ExprKind::Method(base, ..) => body_name_of_position(base),
        _ => None,
    }
}

/// Finds the spanning tree of the joints.
pub fn find_spanning_tree(
    description: &Description,
    jointed: &[&Name],
    scope: &Scope<'_, '_>,
    cx: &mut Diagnostics,
) -> Option<PlacementOrder> {
    let index_of_body = |name: &Name, cx: &mut Diagnostics| -> Result<Option<BodyIndex>, ()> {
        let is_point = description.points.iter().any(|p| p.name.text == name.text)
            || description.particles.iter().any(|p| p.at.is_some() && p.name.text == name.text);
        if name.text == GROUND || is_point {
            return Ok(None);
        }
        match jointed.iter().position(|h| h.text == name.text) {
            Some(k) => Ok(Some(k)),
            None => {
                report_unknown_body(name, jointed, scope, cx);
                Err(())
            }
        }
    };
    let mut is_attached = vec![false; jointed.len()];
    let (mut ends, mut loops) = (Vec::new(), Vec::new());
    let mut is_valid = true;
    let closing = loop_closing_flags(description);
    for (j, joint) in description.joints.iter().enumerate() {
        let (parent, child) = (index_of_body(&joint.parent.body, cx), index_of_body(&joint.child.body, cx));
        let (Ok(parent), Ok(child)) = (parent, child) else {
            is_valid = false;
            continue;
        };
        let name = &joint.child.body;
        if joint.parent.body.text == name.text {
            is_valid = false;
            // A body called `ground` has already been reported.
            if jointed.iter().any(|h| h.text == GROUND) {
                continue;
            }
            cx.report_error(name.place.clone(), format!("`{}` is joined to itself", name.text))
                .add_help("a joint is between two bodies, or the ground and a body");
            continue;
        }
        match child {
            Some(child) if !closing[j] => {
                is_attached[child] = true;
                ends.push((j, parent, child));
            }
            _ => loops.push(j),
        }
    }
    if !is_valid {
        return None;
    }
    let has_own_placement =
        |k: usize| description.bodies.get(k).is_some_and(|b| b.at.is_some() || b.frame.is_some());
    for (k, body) in jointed.iter().enumerate() {
        if !is_attached[k] && !has_own_placement(k) {
            if !description.partial {
                report_unattached(description, body, &loops, cx);
            }
            is_valid = false;
        }
    }
    let roots: Vec<BodyIndex> = (0..jointed.len()).filter(|k| has_own_placement(*k)).collect();
    let order = sort_joints_depth_first(&ends, jointed.len(), &roots);
    is_valid.then_some(PlacementOrder { joints: order, closing: loops })
}

/// Reports a body that is not the child of a tree joint: the joint may have the wrong direction, or the body
/// may be its own ancestor.
fn report_unattached(description: &Description, body: &Name, loops: &[usize], cx: &mut Diagnostics) {
    let name = &body.text;
    let joints_closing_loops = || loops.iter().map(|j| &description.joints[*j]);
    if let Some(joint) = joints_closing_loops().find(|j| j.child.body.text == *name) {
        cx.report_error(
            joint.name.place.clone(),
            format!("the joints of `{name}` form a cycle without the ground"),
        )
        .add_help(format!("start one of them at the ground, as in `ground -> {name}`"));
    } else if let Some(joint) =
        joints_closing_loops().find(|j| j.parent.body.text == *name && j.child.body.text == GROUND)
    {
        cx.report_error(joint.child.body.place.clone(), "the ground cannot be the child of a joint")
            .add_help(format!("reverse the joint, `ground -> {name}`, or connect `{name}` by another one"));
    } else {
        cx.report_error(body.place.clone(), format!("no joint connects `{name}` to the ground"))
            .add_help(format!("add a joint `ground -> {name}`, a Free one if it moves freely"));
    }
}

/// Sorts joints with their parents (`None` for the ground) and children, depth first from the ground,
/// siblings in declaration order. Unreachable joints are omitted.
fn sort_joints_depth_first(
    ends: &[(usize, Option<BodyIndex>, BodyIndex)],
    bodies: usize,
    roots: &[BodyIndex],
) -> Vec<(usize, BodyIndex)> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); bodies + 1];
    for (k, (_, parent, _)) in ends.iter().enumerate() {
        children[parent.map_or(bodies, |p| p)].push(k);
    }
    let mut order = Vec::new();
    let mut todo: Vec<usize> = roots.iter().rev().flat_map(|r| children[*r].iter().rev()).copied().collect();
    todo.extend(children[bodies].iter().rev());
    while let Some(k) = todo.pop() {
        let (joint, _, child) = ends[k];
        order.push((joint, child));
        todo.extend(children[child].iter().rev());
    }
    order
}

fn report_unknown_body(name: &Name, jointed: &[&Name], scope: &Scope<'_, '_>, cx: &mut Diagnostics) {
    let place: Place = name.place.clone();
    if let Some(what) = scope.kind_of_name(&name.text).filter(|_| !scope.bodies.contains(&name.text)) {
        cx.report_error(place, format!("`{}` is {what}, not a body", name.text))
            .add_help("a joint connects bodies: `parent -> child`, with `ground` for the fixed reference");
        return;
    }
    if scope.description.frames.iter().any(|frame| frame.name.text == name.text) {
        cx.report_error(place, format!("`{}` is a frame, which has axes but no position", name.text))
            .add_help("join a body: `#[body(frame = …)]` makes one with the axes of a frame");
        return;
    }
    if scope.bodies.contains(&name.text) {
        cx.report_error(place, format!("`{}` is fixed at a point of a body and cannot be joined", name.text))
            .add_help("remove its `at`, or use the body");
        return;
    }
    let known: Vec<&str> = jointed.iter().map(|h| h.text.as_str()).chain([GROUND]).collect();
    if !scope.record_first_report(&name.text, cx) {
        return;
    }
    let error = cx.report_error(place, format!("unknown body `{}`", name.text));
    match crate::diag::nearest_candidate(&name.text, &known) {
        Some(_) => drop(error.suggest_name(&name.text, known)),
        None => words::suggest_meaning_or_known_word(error, words::BODIES, &name.text, &known),
    }
    if error.has_no_help() {
        error.add_help(format!("declare it: `#[body(mass = m)] {}: Body`", name.text));
    }
}

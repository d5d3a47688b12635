//! Topology: which joint holds which body, and the order in which links are built.

use super::resolve::Scope;
use crate::diag::{Diagnostics, Place};
use crate::syntax::{Description, Name};

/// The name of what does not move.
pub const GROUND: &str = "ground";

/// Index into bodies and jointed particles together.
pub type BodyIndex = usize;

/// What a joint can hold: a body, or a particle without a place of its own.
pub struct Held<'a> {
    /// Its name.
    pub name: &'a Name,
}

/// The joints in an order in which every parent is placed before its children, with the bodies they join
/// (`None` for the ground). `None` after a mistake.
pub struct Order {
    /// Joint, parent, child.
    pub joints: Vec<(usize, Option<BodyIndex>, BodyIndex)>,
}

/// Finds the tree of the joints.
pub fn find_tree(
    description: &Description,
    held: &[Held<'_>],
    scope: &Scope<'_, '_>,
    cx: &mut Diagnostics,
) -> Option<Order> {
    let index = |name: &Name, cx: &mut Diagnostics| -> Result<Option<BodyIndex>, ()> {
        let is_point = description.points.iter().any(|p| p.name.text == name.text)
            || description.particles.iter().any(|p| p.at.is_some() && p.name.text == name.text);
        if name.text == GROUND || is_point {
            return Ok(None);
        }
        match held.iter().position(|h| h.name.text == name.text) {
            Some(k) => Ok(Some(k)),
            None => {
                unknown_body(name, held, scope, cx);
                Err(())
            }
        }
    };
    let mut parents: Vec<Option<usize>> = vec![None; held.len()];
    let mut ends = Vec::new();
    let mut sound = true;
    for (j, joint) in description.joints.iter().enumerate() {
        let (parent, child) = (index(&joint.parent.body, cx), index(&joint.child.body, cx));
        let (Ok(parent), Ok(child)) = (parent, child) else {
            sound = false;
            continue;
        };
        let Some(child) = child else {
            sound = false;
            // A body of this name was reported.
            if held.iter().any(|h| h.name.text == GROUND) {
                continue;
            }
            let name = &joint.child.body;
            if name.text == GROUND {
                cx.error(name.place.clone(), "the ground cannot be the child of a joint")
                    .help("turn the joint around: `ground -> body`");
            } else {
                cx.error(name.place.clone(), format!("`{}` already has a place", name.text))
                    .help("leave its `at` out to hold it by a joint");
            }
            continue;
        };
        if parent == Some(child) {
            cx.error(
                joint.child.body.place.clone(),
                format!("`{}` is joined to itself", held[child].name.text),
            );
            sound = false;
            continue;
        }
        if let Some(first) = parents[child] {
            let name = &description.joints[first].name;
            cx.error(
                joint.child.body.place.clone(),
                format!(
                    "`{}` is already held by `{}`: a closed loop is not yet supported",
                    held[child].name.text, name.text
                ),
            );
            cx.error(name.place.clone(), format!("`{}` is first held here", held[child].name.text));
            sound = false;
            continue;
        }
        parents[child] = Some(j);
        ends.push((j, parent, child));
    }
    if !sound {
        return None;
    }
    let is_placed = |k: usize| description.bodies.get(k).is_some_and(|b| b.at.is_some() || b.frame.is_some());
    for (k, body) in held.iter().enumerate() {
        if parents[k].is_none() && !is_placed(k) {
            cx.error(body.name.place.clone(), format!("nothing holds `{}`", body.name.text))
                .help(format!("add a joint `ground -> {}`, a Free one if it moves freely", body.name.text));
            sound = false;
        }
    }
    let roots: Vec<BodyIndex> = (0..held.len()).filter(|k| is_placed(*k)).collect();
    let order = sort(&ends, held.len(), &roots);
    if sound && order.len() < ends.len() {
        report_cycles(description, &ends, held, cx);
        sound = false;
    }
    sound.then_some(Order { joints: order })
}

/// Depth first from the ground, siblings in declaration order; what is not reached is left out.
fn sort(
    ends: &[(usize, Option<BodyIndex>, BodyIndex)],
    bodies: usize,
    roots: &[BodyIndex],
) -> Vec<(usize, Option<BodyIndex>, BodyIndex)> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); bodies + 1];
    for (k, (_, parent, _)) in ends.iter().enumerate() {
        children[parent.map_or(bodies, |p| p)].push(k);
    }
    let mut order = Vec::new();
    let mut todo: Vec<usize> = roots.iter().rev().flat_map(|r| children[*r].iter().rev()).copied().collect();
    todo.extend(children[bodies].iter().rev());
    while let Some(k) = todo.pop() {
        order.push(ends[k]);
        todo.extend(children[ends[k].2].iter().rev());
    }
    order
}

/// Reports every cycle once: from each body that is not reached, the joints are followed up until one is met again.
fn report_cycles(
    description: &Description,
    ends: &[(usize, Option<BodyIndex>, BodyIndex)],
    held: &[Held<'_>],
    cx: &mut Diagnostics,
) {
    let mut above: Vec<Option<(usize, BodyIndex)>> = vec![None; held.len()];
    for (joint, parent, child) in ends {
        above[*child] = parent.map(|parent| (*joint, parent));
    }
    let mut walks: Vec<Option<usize>> = vec![None; held.len()];
    for start in 0..held.len() {
        let mut body = start;
        while let (None, Some((_, parent))) = (walks[body], above[body]) {
            walks[body] = Some(start);
            body = parent;
        }
        if let (Some((joint, _)), true) = (above[body], walks[body] == Some(start)) {
            let (joint, name) = (&description.joints[joint].name, &held[body].name.text);
            cx.error(
                joint.place.clone(),
                format!("`{name}` hangs from itself: its joints form a cycle that the ground is not part of"),
            )
            .help(format!("let one of them begin at the ground, as in `ground -> {name}`"));
        }
        walks[body].get_or_insert(start);
    }
}

fn unknown_body(name: &Name, held: &[Held<'_>], scope: &Scope<'_, '_>, cx: &mut Diagnostics) {
    let place: Place = name.place.clone();
    if let Some(what) = scope.what(&name.text).filter(|_| !scope.bodies.contains(&name.text)) {
        cx.error(place, format!("`{}` is {what}, not a body", name.text))
            .help("a joint joins bodies: `parent -> child`, with `ground` for what does not move");
        return;
    }
    if scope.frames.contains(&name.text) {
        cx.error(place, format!("`{}` is a frame, which has axes but no place", name.text))
            .help("join a body: `#[body(frame = …)]` makes one with the axes of a frame");
        return;
    }
    if scope.bodies.contains(&name.text) {
        cx.error(place, format!("`{}` is fixed at a point of a body and cannot be joined", name.text))
            .help("leave its `at` out, or join the body");
        return;
    }
    let known: Vec<&str> = held.iter().map(|h| h.name.text.as_str()).chain([GROUND]).collect();
    cx.error(place, format!("unknown body `{}`", name.text)).suggest(&name.text, known);
}

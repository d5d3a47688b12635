//! Releasable connections of bodies, for free-body diagrams: joints of the tree, and placements by `at` and
//! `frame`.

use super::scope::Scope;
use super::tree;
use crate::mechanism::LinkId;
use crate::syntax::{self, Description, GROUND, Rank};

/// Returns the index of a body's placement among the releasable connections: joints are first, then bodies,
/// then particles.
pub fn body_connection_index(d: &Description, body: usize) -> usize {
    d.joints.len() + body
}

/// Returns the index of a particle's placement among the releasable connections.
pub fn particle_connection_index(d: &Description, particle: usize) -> usize {
    d.joints.len() + d.bodies.len() + particle
}

/// Returns the name of a releasable connection: that of a joint, a body or a particle.
pub fn name_of_connection(d: &Description, number: usize) -> Option<&syntax::Name> {
    let joints = d.joints.iter().map(|joint| &joint.name);
    let bodies = d.bodies.iter().map(|body| &body.name);
    joints.chain(bodies).chain(d.particles.iter().map(|particle| &particle.name)).nth(number)
}

/// Placement of a body or a particle by a moving `at` or `frame`: index among the releasable connections, and
/// the link that carries the body.
pub type MovingPlacement = (usize, Option<LinkId>);

/// Whether a body or a particle is fixed in a frame, neither on a body nor at a point, in a mechanism
/// with free-body diagrams.
pub fn is_fixed_in_frame(d: &Description, number: usize) -> bool {
    let is_placed_on_body = |e: &syntax::Expr| {
        let base = tree::body_name_of_position(e);
        base.is_some_and(|base| base != GROUND && d.frames.iter().all(|frame| frame.name.text != base))
    };
    let body = number.checked_sub(d.joints.len()).and_then(|k| d.bodies.get(k));
    let particle = number.checked_sub(d.joints.len() + d.bodies.len()).and_then(|k| d.particles.get(k));
    let places = [
        body.and_then(|body| body.frame.as_ref()),
        body.and_then(|body| body.at.as_ref()),
        particle.and_then(|particle| particle.at.as_ref()),
    ];
    d.outputs.iter().any(|output| output.rank == Rank::FreeBody)
        && !places.into_iter().flatten().any(is_placed_on_body)
}

/// Returns the body that carries a point or a particle fixed on it; for a body, the body itself.
fn body_carrying_point<'b>(d: &'b Description, placements: &[MovingPlacement], name: &'b str) -> &'b str {
    let has_moving_placement = |name: &str| {
        let numbers = placements.iter().map(|(number, _)| *number);
        numbers.filter_map(|number| name_of_connection(d, number)).any(|moved| moved.text == name)
    };
    let carrier_name = |name: &str| {
        let point = d.points.iter().find(|p| p.name.text == name).and_then(|p| p.on.as_ref());
        let particle = d.particles.iter().find(|p| p.name.text == name).and_then(|p| p.at.as_ref());
        tree::body_name_of_position(point.or(particle.filter(|_| !has_moving_placement(name)))?)
    };
    (0..=d.points.len() + d.particles.len()).fold(name, |current, _| carrier_name(current).unwrap_or(current))
}

/// Returns the connections of a body: joints of the tree and placements. The flag is true if the body is
/// the child.
pub fn connections_of_body(
    scope: &Scope<'_, '_>,
    placements: &[MovingPlacement],
    body: &str,
) -> Vec<(usize, bool)> {
    let d = scope.description;
    let closing = tree::loop_closing_flags(d);
    let joints = d.joints.iter().enumerate().filter_map(|(j, joint)| {
        let holds = joint.child.body.text == body;
        let joins = holds || body_carrying_point(d, placements, &joint.parent.body.text) == body;
        (joins && closing.get(j) == Some(&false)).then_some((j, holds))
    });
    let own = scope.kinematics.places.get(body).and_then(|placed| placed.link);
    let places = placements.iter().filter_map(|(number, carrier)| {
        let holds = name_of_connection(d, *number).is_some_and(|name| name.text == body);
        (holds || (carrier.is_some() && *carrier == own)).then_some((*number, holds))
    });
    joints.chain(places).collect()
}

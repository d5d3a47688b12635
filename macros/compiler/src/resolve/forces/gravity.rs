//! Force elements of central gravity and of inverse-square attraction.

use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::resolve::element_forces::ElementForces;
use crate::resolve::scope::Scope;
use crate::resolve::terms::{ForceElementCoordinate, StretchWithRate, distance_between_points};
use crate::syntax::{self, Action, ExprKind, Key, Target};

/// Returns the inverse-square force of an attraction between two points.
pub fn attraction_force<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    on: ForceElementCoordinate<'g>,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let stretch = on.stretch(scope)?;
    let strength = scope.resolve_scalar(action.expression_of_key(Key::Strength)?, cx)?;
    Some(ElementForces::forces_of_potentials([attraction_energy(&stretch, strength)]))
}

/// Returns central gravity: between two bodies with a gravitational constant, or towards a point with a
/// gravitational parameter. Gravity also exerts a torque on a body with inertia.
pub fn central_gravity_force<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let Target::Between(first, second) = &action.on else {
        cx.report_error(
            action.on.source_position_of_target().clone(),
            "gravity acts between two bodies, or a point and a body",
        )
        .add_help(
            "write `between = (sun, planet), constant = G` or `between = (ground, satellite), mu = mu`",
        );
        return None;
    };
    let stretch = distance_between_points(scope, first, second, cx);
    // An unresolved position has already been reported.
    let is_placed = stretch.is_some();
    let mut mass = |e: &syntax::Expr| if is_placed { mass_of_named_body(scope, e, cx) } else { None };
    match (action.expression_of_key(Key::Constant), action.expression_of_key(Key::Mu)) {
        (Some(constant), None) => {
            let masses = [mass(first), mass(second)];
            let g = scope.resolve_scalar(constant, cx)?;
            let ([Some(m1), Some(m2)], Some(stretch)) = (masses, stretch) else { return None };
            let own = attraction_energy(&stretch, g * m1 * m2);
            let torques = [(first, second, g * m1), (second, first, g * m2)];
            let torques =
                torques.map(|(center, body, mu)| central_gravity_torque_energy(scope, center, body, mu, cx));
            Some(ElementForces::forces_of_potentials([own].into_iter().chain(torques.into_iter().flatten())))
        }
        (None, Some(mu)) => {
            let m = mass(second);
            let mu = scope.resolve_scalar(mu, cx)?;
            let own = attraction_energy(&stretch?, mu * m?);
            let torque = central_gravity_torque_energy(scope, first, second, mu, cx);
            Some(ElementForces::forces_of_potentials([own].into_iter().chain(torque)))
        }
        _ => {
            cx.report_error(action.name.place.clone(), "gravity has a `constant` or a `mu`").add_help(
                "`constant` is the gravitational constant of two masses, `mu` the gravitational parameter of the first point",
            );
            None
        }
    }
}

/// Returns the mass of a body or particle. Its origin must be its centre of mass.
fn mass_of_named_body<'g>(scope: &Scope<'_, 'g>, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
    if let ExprKind::Name(name) = &e.kind {
        if let Some(p) = scope.description.particles.iter().find(|p| p.name.text == *name) {
            return scope.resolve_scalar(&p.mass, cx);
        }
        if scope.description.bodies.iter().any(|body| body.name.text == *name) {
            let (mass, com, _) = *scope.kinematics.masses.get(name)?;
            if !com.is_zero() {
                cx.report_error(
                    e.place.clone(),
                    format!("gravity acts at the origin of `{name}`, which is not its centre of mass"),
                )
                .add_help("put the body's origin at its centre of mass");
                return None;
            }
            return Some(mass);
        }
    }
    cx.report_error(e.place.clone(), "expected a body or a particle, which has mass").add_help(
        "name one; for a point without mass, such as `ground`, give the gravitational parameter `mu`",
    );
    None
}

/// Returns the potential energy `−strength / distance` of an attraction `strength / distance²`. The energy is
/// infinite if the points coincide; it has no limit there.
fn attraction_energy<'g>(stretch: &StretchWithRate<'g>, strength: Expr<'g>) -> Expr<'g> {
    -(strength / stretch.square.sqrt())
}

/// Returns the energy of the torque of central gravity on a body with inertia, to second order in size over
/// distance (MacCullagh): `U = −μ m / r − μ (tr I − 3 n · I n) / (2 r³)`.
fn central_gravity_torque_energy<'g>(
    scope: &Scope<'_, 'g>,
    center: &syntax::Expr,
    body: &syntax::Expr,
    mu: Expr<'g>,
    cx: &mut Diagnostics,
) -> Option<Expr<'g>> {
    let name = body.as_name()?;
    scope.description.bodies.iter().find(|body| body.name.text == name)?;
    let (center, body) = (scope.resolve_placement(center, cx), scope.resolve_placement(body, cx));
    let (center, body) = (center?, body?);
    let (_, _, central) = *scope.kinematics.masses.get(name)?;
    let tensor = body.pose.rotation.symmetric_tensor_in_parent_axes(central);
    let kinematics = &scope.kinematics;
    let terms = kinematics.position_between(&body, &center);
    let r = kinematics.components_in_link_axes(&terms, body.link, Vec3::zero(scope.graph));
    let length = r.norm();
    let n = r.map(|c| c / length);
    let trace = tensor.diagonal[0] + tensor.diagonal[1] + tensor.diagonal[2];
    let shape = trace - n.dot(tensor * n) * 3.0;
    (!shape.is_zero()).then(|| -(mu * shape * 0.5 / (length * length * length)))
}

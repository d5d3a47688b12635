//! Central gravity, and inverse-square attraction.

use super::ActedOn;
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::resolve::builder::Builder;
use crate::resolve::scope::Placed;
use crate::resolve::terms::Stretch;
use crate::syntax::{self, Action, ExprKind, Key, Target};

impl<'g> Builder<'_, 'g> {
    /// Adds an attraction between two points.
    pub(super) fn add_attraction(&mut self, action: &Action, on: ActedOn<'g>, cx: &mut Diagnostics) {
        let Some(stretch) = self.stretch_on(on) else { return };
        let strength = action.get(Key::Strength).and_then(|e| self.scope.scalar(e, cx));
        if let Some(strength) = strength {
            self.push_attraction(&stretch, strength);
        }
    }

    /// Adds central gravity: between two bodies with a gravitational constant, or towards a point with a
    /// gravitational parameter. Gravity also exerts a torque on a body with inertia.
    pub(super) fn add_gravity(&mut self, action: &Action, cx: &mut Diagnostics) {
        let (constant, mu) = (action.get(Key::Constant), action.get(Key::Mu));
        let Target::Between(a, b) = &action.on else {
            cx.error(action.on.place().clone(), "gravity acts between two bodies, or a point and a body").help(
                "write `between = (sun, planet), constant = G` or `between = (ground, satellite), mu = mu`",
            );
            return;
        };
        let stretch = self.distance(a, b, cx);
        // An unresolved position has already been reported.
        let is_placed = stretch.is_some();
        let mut mass_of = |e: &syntax::Expr| if is_placed { self.mass_of(e, cx) } else { None };
        match (constant, mu) {
            (Some(constant), None) => {
                let masses = [mass_of(a), mass_of(b)];
                let constant = self.scope.scalar(constant, cx);
                if let (Some(g), [Some(m1), Some(m2)], Some(stretch)) = (constant, masses, stretch) {
                    self.push_attraction(&stretch, g * m1 * m2);
                    self.add_gravity_torque(a, b, g * m1, cx);
                    self.add_gravity_torque(b, a, g * m2, cx);
                }
            }
            (None, Some(mu)) => {
                let mass = mass_of(b);
                let mu = self.scope.scalar(mu, cx);
                if let (Some(mu), Some(m), Some(stretch)) = (mu, mass, stretch) {
                    self.push_attraction(&stretch, mu * m);
                    self.add_gravity_torque(a, b, mu, cx);
                }
            }
            _ => {
                cx.error(action.name.place.clone(), "gravity has a `constant` or a `mu`").help(
                    "`constant` is that of two masses, `mu` the gravitational parameter of the first place",
                );
            }
        }
    }

    fn add_gravity_torque(&mut self, a: &syntax::Expr, b: &syntax::Expr, mu: Expr<'g>, cx: &mut Diagnostics) {
        let ExprKind::Name(name) = &b.kind else { return };
        let Some(index) = self.jointed_index(name).filter(|k| *k < self.description.bodies.len()) else {
            return;
        };
        if let (Some(center), Some(body)) = (self.scope.place(a, cx), self.scope.place(b, cx)) {
            self.add_gravity_gradient(&body, &center, mu, index);
        }
    }

    /// Returns the mass of a body or particle. Its origin must be its centre of mass.
    fn mass_of(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        if let ExprKind::Name(name) = &e.kind {
            if let Some(p) = self.description.particles.iter().find(|p| p.name.text == *name) {
                return self.scope.scalar(&p.mass, cx);
            }
            if let Some(k) = self.description.bodies.iter().position(|b| b.name.text == *name) {
                let (mass, com, _) = self.masses.get(k).copied().flatten()?;
                if !com.is_zero() {
                    cx.error(
                        e.place.clone(),
                        format!("gravity acts at the origin of `{name}`, which is not its centre of mass"),
                    )
                    .help("put the body's origin at its centre of mass");
                    return None;
                }
                return Some(mass);
            }
        }
        cx.error(e.place.clone(), "expected a body or a particle, which has mass")
            .help("name one; of a point without mass, such as `ground`, `mu` says what it attracts with");
        None
    }

    /// Adds an attraction `strength / distance²` with the potential energy `−strength / distance`. The energy
    /// is infinite if the points coincide; it has no limit there.
    fn push_attraction(&mut self, stretch: &Stretch<'g>, strength: Expr<'g>) {
        let distance = stretch.square.sqrt();
        self.model.potentials.push(-(strength / distance));
    }

    /// Adds the torque of central gravity on a body with inertia, to second order in size over distance
    /// (MacCullagh): `U = −μ m / r − μ (tr I − 3 n · I n) / (2 r³)`.
    fn add_gravity_gradient(&mut self, body: &Placed<'g>, center: &Placed<'g>, mu: Expr<'g>, index: usize) {
        let Some((_, _, central)) = self.masses.get(index).cloned().flatten() else { return };
        let tensor = body.pose.rotation.sym_to_parent(central);
        let zero = Vec3::zero(self.scope.graph);
        let kinematics = &self.scope.kinematics;
        let terms = kinematics.position_between(body, center);
        let r = kinematics.resolve(&terms, body.link, zero);
        let length = r.norm();
        let n = r.map(|c| c / length);
        let trace = tensor.diagonal[0] + tensor.diagonal[1] + tensor.diagonal[2];
        let shape = trace - n.dot(tensor * n) * 3.0;
        if !shape.is_zero() {
            self.model.potentials.push(-(mu * shape * 0.5 / (length * length * length)));
        }
    }
}

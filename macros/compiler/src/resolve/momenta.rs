//! Momentum, kinetic energy and inertia of single bodies and particles: `momentum(body)`, `angular_momentum(body / point)`,
//! `kinetic_energy(body)`, `moment_of_inertia(body / point, direction)`; of several they are sums.

use super::quantities::{flatten, vector};
use super::scope::{Allowed, MassProperties, Placed, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::Vec3;
use crate::mechanism::Pose;
use crate::syntax::{self, ExprKind, Name, words};

impl<'g> Scope<'_, 'g> {
    /// What a body has by its motion with respect to the ground. With the velocity `v` of its centre of mass, the vector `r` there
    /// from a point, and the central inertia `I`: `m v`, `I ω + r × m v`, `(m v·v + ω·I ω) / 2`.
    pub fn momentum(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let text = function.text.as_str();
        let parts = if let [one] = arguments { flatten(one) } else { Vec::new() };
        let (count, form) = match text {
            "angular_momentum" => (2, "a body and a point: write `angular_momentum(body / point)`"),
            "momentum" => (1, "a body: write `momentum(body)`"),
            _ => (1, "a body: write `kinetic_energy(body)`"),
        };
        if parts.len() != count {
            let (what, help) = form.split_once(": ").unwrap_or((form, ""));
            cx.error(function.place.clone(), format!("`{text}` takes {what}")).help(help);
            return None;
        }
        if !self.check_allowed(Allowed::Motion, &format!("`{text}(…)`"), &function.place, cx) {
            return None;
        }
        let (placed, (mass, com, central)) = self.heavy(parts[0], cx)?;
        let about = parts.get(1).map(|e| self.place(e, cx));
        let kinematics = self.kinematics.borrow();
        let zero = Vec3::zero(self.graph);
        let link = placed.link;
        let twist = link.and_then(|link| kinematics.twists.get(link.0));
        let (linear, w) = twist.map_or((zero, zero), |twist| (twist.linear, twist.angular));
        let center = placed.pose.point(com);
        let v = linear + w.cross(center);
        let spin = placed.pose.rotation.sym_to_parent(central) * w;
        if text == "kinetic_energy" {
            return Some(Value::Scalar((v.dot(v) * mass + w.dot(spin)) * 0.5));
        }
        let Some(about) = about else { return Some(vector(vec![(link, v * mass)])) };
        let pose = Pose { translation: center, rotation: placed.pose.rotation.clone() };
        let between = kinematics.between(&Placed { pose, ..placed.clone() }, &about?);
        let r = kinematics.resolve(&between, link, zero);
        Some(vector(vec![(link, spin + r.cross(v * mass))]))
    }

    /// A moment or product of inertia about a point: `a·J b`, with one direction `a·J a`, of the physical inertia matrix
    /// `J = I + m (r·r 1 − r rᵀ)` about a point from which the centre of mass is at `r` (the parallel-axis theorem).
    pub fn moment_of_inertia(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let text = function.text.as_str();
        let (parts, directions) = match arguments {
            [of, directions @ ..] => (flatten(of), directions),
            [] => (Vec::new(), arguments),
        };
        let ([body, about], [a, others @ ..]) = (parts.as_slice(), directions) else {
            cx.error(function.place.clone(), format!("`{text}` takes a body, a point and a direction"))
                .help("write `moment_of_inertia(body / point, direction)`, with a second direction for a product of inertia");
            return None;
        };
        if others.len() > 1 {
            cx.error(others[1].place.clone(), format!("`{text}` takes one direction or two"))
                .help("with two it is a product of inertia");
            return None;
        }
        if !self.check_allowed(Allowed::Placement, &format!("`{text}(…)`"), &function.place, cx) {
            return None;
        }
        let (placed, (mass, com, central)) = self.heavy(body, cx)?;
        let about = self.place(about, cx)?;
        let a = self.terms(a, cx)?;
        let b = others.first().map_or_else(|| Some(a.clone()), |b| self.terms(b, cx))?;
        let kinematics = self.kinematics.borrow();
        let (link, zero) = (placed.link, Vec3::zero(self.graph));
        let pose = Pose { translation: placed.pose.point(com), rotation: placed.pose.rotation.clone() };
        let between = kinematics.between(&Placed { pose, ..placed.clone() }, &about);
        let [a, b, r] = [&a, &b, &between].map(|parts| kinematics.resolve(parts, link, zero));
        let central = placed.pose.rotation.sym_to_parent(central);
        let moved = (r.dot(r) * a.dot(b) - a.dot(r) * r.dot(b)) * mass;
        Some(Value::Scalar(a.dot(central * b) + moved))
    }

    /// A body or particle with its mass, centre of mass and central inertia.
    fn heavy(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<(Placed<'g>, MassProperties<'g>)> {
        let ExprKind::Name(name) = &e.kind else {
            cx.error(e.place.clone(), "expected a body").help("name a body or a particle");
            return None;
        };
        let kinematics = self.kinematics.borrow();
        match (kinematics.places.get(name), kinematics.masses.get(name)) {
            (Some(placed), Some(masses)) => Some((placed.clone(), *masses)),
            // Its figures could not be read, and that was told.
            (Some(_), None) if !cx.is_empty() && self.bodies.contains(name) => None,
            (Some(_), None) => {
                cx.error(e.place.clone(), format!("`{name}` has no mass")).help("name a body or a particle");
                None
            }
            (None, _) => {
                if self.is_news(name, cx) {
                    let known: Vec<&str> = kinematics.masses.keys().map(String::as_str).collect();
                    let error = cx.error(e.place.clone(), format!("unknown body `{name}`"));
                    words::point(error, words::BODIES, name, &known);
                    if error.is_bare() {
                        error.help("name a body or a particle");
                    }
                }
                None
            }
        }
    }
}

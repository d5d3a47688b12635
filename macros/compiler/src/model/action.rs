//! Force elements and inputs: what they act on, and with which parameters.

use super::build::Builder;
use super::resolve::Axes;
use super::tree::GROUND;
use super::{Coordinate, Dashpot, Direction, Input, Spring};
use crate::diag::{Diagnostics, Place, one_of};
use crate::expr::Vec3;
use crate::syntax::{Action, ActionKind, Expr, ExprKind};

/// What an element acts on.
enum Target<'g> {
    /// A coordinate; true if it is an angle.
    Coordinate(Coordinate, bool),
    /// A point of a body (by index), in body axes.
    Body(usize, Vec3<'g>),
}

impl<'g> Builder<'_, 'g> {
    /// Adds one force element or input to the model.
    pub fn add_action(&mut self, action: &Action, cx: &mut Diagnostics) {
        let target = self.target(&action.on, cx);
        match &action.kind {
            ActionKind::Spring { stiffness, free: given } => {
                let stiffness = self.scope.scalar(stiffness, cx);
                let free = match given {
                    Some((free, _)) => self.scope.scalar(free, cx),
                    None => Some(self.scope.graph.zero()),
                };
                if let (Some((free, is_angle)), Some(Target::Coordinate(_, angle))) = (given, &target)
                    && is_angle != angle
                {
                    let (is, key) =
                        if *angle { ("an angle", "free_angle") } else { ("a length", "free_length") };
                    cx.error(free.place.clone(), format!("the coordinate of this spring is {is}"))
                        .help(format!("write `{key} = …`"));
                }
                let on = self.coordinate_of(target, "Spring", &action.on.place, cx);
                if let (Some(on), Some(stiffness), Some(free)) = (on, stiffness, free) {
                    self.model.springs.push(Spring { on, stiffness, free });
                }
            }
            ActionKind::Dashpot { damping } => {
                let written = damping;
                let damping = self.scope.scalar(written, cx);
                let on = self.coordinate_of(target, "Dashpot", &action.on.place, cx);
                if let Some(d) = damping.and_then(|d| d.value()).filter(|d| *d < 0.0) {
                    cx.error(written.place.clone(), format!("a damping cannot be negative, but it is {d}"));
                }
                if let (Some(on), Some(damping)) = (on, damping) {
                    self.model.dashpots.push(Dashpot { on, damping });
                }
            }
            ActionKind::Force { along } => self.add_input(action, target, along.as_ref(), false, cx),
            ActionKind::Torque { about } => self.add_input(action, target, about.as_ref(), true, cx),
        }
    }

    fn coordinate_of(
        &self,
        target: Option<Target<'g>>,
        what: &str,
        place: &Place,
        cx: &mut Diagnostics,
    ) -> Option<Coordinate> {
        match target? {
            Target::Coordinate(c, _) => Some(c),
            Target::Body(..) => {
                cx.error(
                    place.clone(),
                    format!("a {what} acts on the coordinate of a joint, but this is a body"),
                )
                .help("name a joint, as in `on = hinge`; between two bodies it is not yet supported");
                None
            }
        }
    }

    fn add_input(
        &mut self,
        action: &Action,
        target: Option<Target<'g>>,
        direction: Option<&Expr>,
        torque: bool,
        cx: &mut Diagnostics,
    ) {
        let Some(target) = target else { return };
        let place = &action.on.place;
        let input = match target {
            Target::Coordinate(_, angle) if angle != torque => {
                let (is, other) = if angle { ("an angle", "Torque") } else { ("a length", "Force") };
                cx.error(place.clone(), format!("this coordinate is {is}"))
                    .help(format!("what acts on it is a {other}"));
                return;
            }
            Target::Coordinate(c, _) => {
                if let Some(direction) = direction {
                    cx.error(direction.place.clone(), "the joint itself gives the direction")
                        .help("remove this argument, or let it act on a body");
                }
                Input::Coordinate(c)
            }
            Target::Body(body, at) => match self.body_input(action, body, at, direction, torque, cx) {
                Some(input) => input,
                None => return,
            },
        };
        self.model.inputs.push((action.name.text.clone(), input));
    }

    fn body_input(
        &mut self,
        action: &Action,
        body: usize,
        at: Vec3<'g>,
        direction: Option<&Expr>,
        torque: bool,
        cx: &mut Diagnostics,
    ) -> Option<Input<'g>> {
        let Some(direction) = direction else {
            let key = if torque { "about" } else { "along" };
            cx.error(action.name.place.clone(), format!("missing `{key}`"))
                .help(format!("on a body it needs a direction: `{key} = x`, `{key} = ground.z`"));
            return None;
        };
        let terms = self.scope.vector(direction, cx)?;
        let (link, pose) = self.placed(body)?;
        let Some(link) = link else {
            cx.error(
                action.on.place.clone(),
                "this body is fixed to the ground: nothing that acts on it has an effect",
            );
            return None;
        };
        let mut sum: Direction<'g> = Vec::new();
        for (axes, v) in terms {
            let (link, v) = match &axes {
                Axes::Own => (Some(link), pose.rotation.to_parent(v)),
                Axes::Of(name) if name == GROUND => (None, v),
                Axes::Of(name) => {
                    let other = self.held_index(name)?;
                    let (link, pose) = self.placed(other)?;
                    (link, pose.rotation.to_parent(v))
                }
            };
            sum.push((link, v));
        }
        if sum.iter().all(|(_, v)| v.is_zero()) {
            cx.error(direction.place.clone(), "this direction is zero");
            return None;
        }
        Some(match torque {
            true => Input::Torque { link, about: sum },
            false => Input::Force { link, point: pose.point(at), along: sum },
        })
    }

    /// `joint`, `joint.coordinate`, `body`, `body.at(vector)`.
    fn target(&self, on: &Expr, cx: &mut Diagnostics) -> Option<Target<'g>> {
        match &on.kind {
            ExprKind::Name(name) => {
                if let Some(joint) = self.joint_coordinates(name) {
                    return match joint.as_slice() {
                        [(_, c, angle)] => Some(Target::Coordinate(*c, *angle)),
                        _ => {
                            let own: Vec<&str> = joint.iter().map(|(n, ..)| n.as_str()).collect();
                            let list: Vec<String> = own.iter().map(|c| format!("`on = {c}`")).collect();
                            if list.is_empty() {
                                cx.error(on.place.clone(), format!("`{name}` has no coordinate to act on"))
                                    .help("a force or a torque can act on a body that it joins, with a direction");
                            } else {
                                cx.error(
                                    on.place.clone(),
                                    format!("`{name}` has {} coordinates", list.len()),
                                )
                                .help(format!("write {}", one_of(&list)));
                            }
                            None
                        }
                    };
                }
                let body = self.body(name, &on.place, cx)?;
                Some(Target::Body(body, Vec3::zero(self.scope.graph)))
            }
            ExprKind::Field(inner, member) => {
                let ExprKind::Name(joint) = &inner.kind else {
                    cx.error(on.place.clone(), "expected a joint, a coordinate of a joint, or a body");
                    return None;
                };
                let Some(coordinates) = self.joint_coordinates(joint) else {
                    if self.held_index(joint).is_some() {
                        cx.error(member.place.clone(), format!("`{joint}` is a body and has no coordinates"))
                            .help(format!("write `on = {joint}` and give a direction, or name a joint"));
                        return None;
                    }
                    let known = self.joint_names();
                    cx.error(inner.place.clone(), format!("unknown joint `{joint}`"))
                        .suggest(joint, known.iter().map(String::as_str));
                    return None;
                };
                let full = format!("{joint}.{}", member.text);
                if let Some((_, c, angle)) = coordinates.iter().find(|(n, ..)| *n == full) {
                    return Some(Target::Coordinate(*c, *angle));
                }
                let own: Vec<&str> = coordinates.iter().map(|(n, ..)| n.as_str()).collect();
                cx.error(
                    member.place.clone(),
                    format!("`{joint}` has no coordinate `{}` to act on", member.text),
                )
                .suggest(&full, own);
                None
            }
            ExprKind::Method(inner, method, arguments) if method.text == "at" && arguments.len() == 1 => {
                let ExprKind::Name(name) = &inner.kind else {
                    cx.error(on.place.clone(), "expected a body");
                    return None;
                };
                let at = self.scope.own_vector(&arguments[0], cx);
                Some(Target::Body(self.body(name, &inner.place, cx)?, at?))
            }
            _ => {
                cx.error(on.place.clone(), "expected a joint, a coordinate of a joint, or a body")
                    .help("write `on = hinge`, `on = slot.slide`, `on = arm` or `on = arm.at(length * x)`");
                None
            }
        }
    }

    fn body(&self, name: &str, place: &Place, cx: &mut Diagnostics) -> Option<usize> {
        let found = self.held_index(name);
        if name == GROUND {
            cx.error(place.clone(), "nothing that acts on the ground has an effect");
        } else if found.is_none() && self.scope.what(name) == Some("a joint") {
            cx.error(place.clone(), format!("`{name}` is a joint and has no points"))
                .help(format!("write `on = {name}`, or name a point of a body"));
        } else if found.is_none()
            && let Some(what) = self.scope.what(name)
        {
            cx.error(place.clone(), format!("`{name}` is {what}: nothing can act on it"))
                .help("write `on = hinge`, `on = slot.slide`, `on = arm` or `on = arm.at(length * x)`");
        } else if found.is_none() {
            let mut known = self.joint_names();
            known.extend(self.held_names());
            cx.error(place.clone(), format!("unknown joint or body `{name}`"))
                .suggest(name, known.iter().map(String::as_str));
        }
        found
    }
}

//! Placement of joints, bodies, particles, points and frames. The order is such that every element is placed
//! relative to elements placed before. A placement that depends on time or on coordinates of its own becomes
//! a link.

use super::builder::Builder;
use super::carriers::are_particle_axes_used;
use super::chain::report_joint_argument_errors;
use super::holders;
use super::scope::{AllowedQuantities, Context, PlacedElement, PlacedElementKind};
use super::tree::PlacementOrder;
use crate::diag::{Diagnostics, join_names_with_and};
use crate::expr::{Rotation, Vec3};
use crate::language::{BodyOrInertiaMethod, Callable};
use crate::mechanism::{LinkId, Pose};
use crate::syntax::{Expr, ExprKind, GROUND, Name, words};

/// Element that is to be placed, by its index in its list.
#[derive(Clone, Copy)]
enum UnplacedElement {
    /// Joint, by its index in the [`PlacementOrder`].
    Joint(usize),
    Frame(usize),
    Point(usize),
    Body(usize),
    Particle(usize),
}

impl<'a, 'g> Builder<'a, 'g> {
    /// Places all elements. An element waits until the elements on which it depends are placed; if no
    /// progress is possible, definitions are circular.
    pub fn place_all_elements(&mut self, order: &PlacementOrder, cx: &mut Diagnostics) {
        let d = self.scope.description;
        for (j, child) in &order.joints {
            if let Some(body) = d.bodies.get(*child).filter(|b| b.at.is_some() || b.frame.is_some()) {
                let (name, joint) = (&body.name, &d.joints[*j].name);
                cx.report_error(name.place.clone(), format!("`{}` is placed twice", name.text))
                    .add_note(format!("the joint `{}` places it as well", joint.text))
                    .add_help("a body is placed by a joint, or by `at` and `frame`");
            }
        }
        let mut waiting: Vec<UnplacedElement> = (0..order.joints.len()).map(UnplacedElement::Joint).collect();
        waiting.extend((0..d.frames.len()).map(UnplacedElement::Frame));
        waiting.extend((0..d.points.len()).map(UnplacedElement::Point));
        let has_own_placement = |k: &usize| d.bodies[*k].at.is_some() || d.bodies[*k].frame.is_some();
        waiting.extend((0..d.bodies.len()).filter(has_own_placement).map(UnplacedElement::Body));
        waiting.extend(
            (0..d.particles.len()).filter(|k| d.particles[*k].at.is_some()).map(UnplacedElement::Particle),
        );
        while !waiting.is_empty() {
            let before = waiting.len();
            let mut rest = Vec::new();
            for item in waiting {
                if self.are_dependencies_placed(item, order) {
                    self.place_element(item, order, cx);
                } else {
                    rest.push(item);
                }
            }
            if rest.len() == before {
                self.report_unplaced_elements(&rest, order, cx);
                self.place_at_substitute_poses(&rest, order);
                return;
            }
            waiting = rest;
        }
    }

    /// Returns the names on which the placement of an element depends.
    fn placement_dependencies(&self, item: UnplacedElement, order: &PlacementOrder) -> Vec<String> {
        let d = self.scope.description;
        let mut names = Vec::new();
        let mut expression =
            |e: &Option<Expr>| e.iter().for_each(|e| collect_names_in_expression(e, &mut names));
        match item {
            UnplacedElement::Joint(k) => {
                let j = order.joints[k].0;
                // A joint that is solved for needs the other side of its loop as well.
                let sides = self.loop_that_solves_joint(j).map_or(vec![j], |loop_| loop_.sides.to_vec());
                names.extend(sides.iter().map(|j| d.joints[*j].parent.body.text.clone()));
            }
            UnplacedElement::Frame(k) => {
                let f = &d.frames[k];
                collect_names_in_expression(&f.start, &mut names);
                f.rotations.iter().for_each(|e| collect_names_in_expression(e, &mut names));
            }
            UnplacedElement::Point(k) => {
                expression(&d.points[k].on);
                expression(&d.points[k].at);
            }
            UnplacedElement::Body(k) => {
                expression(&d.bodies[k].at);
                expression(&d.bodies[k].frame);
            }
            UnplacedElement::Particle(k) => expression(&d.particles[k].at),
        }
        names
    }

    fn are_dependencies_placed(&self, item: UnplacedElement, order: &PlacementOrder) -> bool {
        let kinematics = &self.scope.kinematics;
        self.placement_dependencies(item, order)
            .iter()
            .all(|name| !self.scope.is_placeable(name) || kinematics.places.contains_key(name))
    }

    fn unplaced_element_name(&self, item: UnplacedElement, order: &PlacementOrder) -> &'a Name {
        let d = self.scope.description;
        match item {
            UnplacedElement::Joint(k) => &d.joints[order.joints[k].0].name,
            UnplacedElement::Frame(k) => &d.frames[k].name,
            UnplacedElement::Point(k) => &d.points[k].name,
            UnplacedElement::Body(k) => &d.bodies[k].name,
            UnplacedElement::Particle(k) => &d.particles[k].name,
        }
    }

    fn report_unplaced_elements(
        &self,
        waiting: &[UnplacedElement],
        order: &PlacementOrder,
        cx: &mut Diagnostics,
    ) {
        // After another error, elements may wait for one that failed, which has been reported. Joints are
        // still resolved, to report their own errors at once.
        if !cx.is_empty() {
            for item in waiting {
                if let UnplacedElement::Joint(k) = item {
                    report_joint_argument_errors(
                        &self.scope,
                        &self.scope.description.joints[order.joints[*k].0],
                        cx,
                    );
                }
            }
            return;
        }
        // From an element to one for which it waits, until the path is a cycle.
        let next_waiting_dependency = |index: usize| {
            let needs = self.placement_dependencies(waiting[index], order);
            (0..waiting.len()).find(|k| needs.contains(&self.name_of_element_to_place(waiting[*k], order)))
        };
        let mut path: Vec<usize> = vec![0];
        while let Some(k) = path.last().and_then(|index| next_waiting_dependency(*index)) {
            if let Some(begin) = path.iter().position(|seen| *seen == k) {
                path.drain(..begin);
                break;
            }
            path.push(k);
        }
        path.sort_unstable();
        let names: Vec<&Name> = path.iter().map(|k| self.unplaced_element_name(waiting[*k], order)).collect();
        let Some((first, others)) = names.split_first() else { return };
        let error = cx.report_error(
            first.place.clone(),
            format!("the placement of `{}` depends on itself", first.text),
        );
        if !others.is_empty() {
            let list: Vec<String> = others.iter().map(|name| format!("`{}`", name.text)).collect();
            error.add_note(format!("the cycle passes through {}", join_names_with_and(&list)));
        }
        error.add_help("its definition is circular: start from the ground or from a body with a joint");
    }

    /// Returns the name of the element that an item places.
    fn name_of_element_to_place(&self, item: UnplacedElement, order: &PlacementOrder) -> String {
        match item {
            UnplacedElement::Joint(k) => {
                self.scope.description.joints[order.joints[k].0].child.body.text.clone()
            }
            _ => self.unplaced_element_name(item, order).text.clone(),
        }
    }

    /// Places the remaining elements at substitute poses, so that their dependents are resolved as well.
    fn place_at_substitute_poses(&mut self, waiting: &[UnplacedElement], order: &PlacementOrder) {
        for item in waiting {
            let name = self.name_of_element_to_place(*item, order);
            let (link, pose) = self.add_link_if_moving(None, self.scope.placeholder_pose(true));
            let kind = match item {
                UnplacedElement::Joint(_) | UnplacedElement::Body(_) => PlacedElementKind::Body,
                UnplacedElement::Frame(_) => PlacedElementKind::Frame,
                UnplacedElement::Point(_) | UnplacedElement::Particle(_) => PlacedElementKind::Point,
            };
            self.register_placement(&name, link, pose, kind);
        }
    }

    fn place_element(&mut self, item: UnplacedElement, order: &PlacementOrder, cx: &mut Diagnostics) {
        let d = self.scope.description;
        match item {
            UnplacedElement::Joint(k) => {
                let (j, child) = order.joints[k];
                self.place_joint_child(j, child, cx);
            }
            UnplacedElement::Frame(k) => {
                let (link, pose) = self
                    .frame_axes_at_start_origin(k, cx)
                    .unwrap_or_else(|| (None, self.scope.placeholder_pose(true)));
                let (start, (link, pose)) = (link, self.add_link_if_moving(link, pose));
                self.frame_links.extend(link.filter(|_| link != start));
                self.register_placement(&d.frames[k].name.text, link, pose, PlacedElementKind::Frame);
            }
            UnplacedElement::Point(k) => {
                let p = &d.points[k];
                let frame = match &p.on {
                    Some(on) => self.scope.resolve_placement(on, cx),
                    None => Some(self.ground_placement()),
                };
                let place = frame.and_then(|frame| match &p.at {
                    Some(at) => self.placement_at_offset(frame, at, false, cx),
                    None => Some((frame.link, frame.pose)),
                });
                let (link, pose) = place.unwrap_or_else(|| (None, self.scope.placeholder_pose(true)));
                let (link, pose) = self.add_link_if_moving(link, pose);
                self.register_placement(&p.name.text, link, pose, PlacedElementKind::Point);
            }
            UnplacedElement::Body(k) => self.place_body(k, cx),
            UnplacedElement::Particle(k) => {
                let p = &d.particles[k];
                let Some(at) = &p.at else { return };
                let free = !are_particle_axes_used(d, &p.name.text);
                let (link, pose) = self
                    .placement_of_position(at, free, cx)
                    .unwrap_or_else(|| (None, self.scope.placeholder_pose(true)));
                let (link, pose) =
                    self.add_links_of_placed_element(holders::particle_connection_index(d, k), link, pose);
                self.register_placement(&p.name.text, link, pose, PlacedElementKind::Point);
            }
        }
    }

    fn ground_placement(&self) -> PlacedElement<'g> {
        PlacedElement { link: None, pose: Pose::identity(self.scope.graph), kind: PlacedElementKind::Body }
    }

    /// Returns the axes of a frame, at the origin of its start frame.
    fn frame_axes_at_start_origin(
        &self,
        k: usize,
        cx: &mut Diagnostics,
    ) -> Option<(Option<LinkId>, Pose<'g>)> {
        let frame = &self.scope.description.frames[k];
        let start = self.placement_of_named_axes(&frame.start, cx);
        // Axes defined by a vector or a curve precede further rotations.
        let natural = match frame.rotations.first().map(|first| &first.kind) {
            Some(ExprKind::Call(word, arguments)) => match word.id {
                Some(Callable::Rotation(rotation)) if rotation.row().natural => {
                    Some(((rotation, word), arguments))
                }
                _ => None,
            },
            _ => None,
        };
        let steps = &frame.rotations[usize::from(natural.is_some())..];
        let first = match (natural, &start) {
            (Some((rotation, arguments)), Some(start)) => {
                self.scope.resolve_curvilinear_axes(rotation, arguments, start, cx)
            }
            _ => Some(Rotation::identity(self.scope.graph)),
        };
        let context = Context::new(AllowedQuantities::Placement, None);
        let rotation = self.scope.call_in_context(context, |scope| scope.resolve_rotation(steps, cx));
        let (start, rotation) = (start?, first?.compose_with(&rotation?));
        let pose = Pose {
            rotation: start.pose.rotation.compose_with(&rotation),
            translation: start.pose.translation,
        };
        Some((start.link, pose))
    }

    /// Returns the placement of the body or frame with this name.
    fn placement_of_named_axes(&self, e: &Expr, cx: &mut Diagnostics) -> Option<PlacedElement<'g>> {
        let ExprKind::Name(name) = &e.kind else {
            cx.report_error(e.place.clone(), "expected a body or a frame")
                .add_help("write `#[frame(ground, z(angle))]`");
            return None;
        };
        if name == GROUND {
            return Some(self.ground_placement());
        }
        let kinematics = &self.scope.kinematics;
        match kinematics.places.get(name) {
            Some(p) if p.kind != PlacedElementKind::Point => Some(p.clone()),
            Some(_) => {
                cx.report_error(e.place.clone(), format!("`{name}` is a point, which has no axes"))
                    .add_help("name a body or a frame");
                None
            }
            None => {
                if !self.scope.record_first_report(name, cx) {
                    return None;
                }
                let known: Vec<&str> = kinematics.places.keys().map(String::as_str).chain([GROUND]).collect();
                let error = cx.report_error(e.place.clone(), format!("unknown body or frame `{name}`"));
                words::suggest_meaning_or_known_word(error, words::BODIES, name, &known);
                if error.has_no_help() {
                    error.add_help(
                        "a frame starts with the axes of a body or another frame: `#[frame(ground, \
                         z(angle))]`",
                    );
                }
                None
            }
        }
    }

    fn place_body(&mut self, k: usize, cx: &mut Diagnostics) {
        let body = &self.scope.description.bodies[k];
        let axes = match &body.frame {
            Some(frame) => self.placement_of_named_axes(frame, cx),
            None => Some(self.ground_placement()),
        };
        let origin = match &body.at {
            Some(at) => self.placement_of_position(at, true, cx),
            None => axes.as_ref().map(|a| (a.link, a.pose.clone())),
        };
        let (link, pose) = match (axes, origin) {
            (Some(axes), Some((link, mut pose))) => {
                // The axes are relative to the link in which the origin is given.
                pose.rotation =
                    self.rotation_between_links(link, axes.link).compose_with(&axes.pose.rotation);
                (link, pose)
            }
            _ => (None, self.scope.placeholder_pose(true)),
        };
        let (link, pose) = self.add_links_of_placed_element(
            holders::body_connection_index(self.scope.description, k),
            link,
            pose,
        );
        self.register_placement(&body.name.text, link, pose, PlacedElementKind::Body);
    }

    /// Returns the orientation of link `link` in link `base`.
    fn rotation_between_links(&self, base: Option<LinkId>, link: Option<LinkId>) -> Rotation<'g> {
        let kinematics = &self.scope.kinematics;
        let rotation_to_ground = |mut current: Option<LinkId>| {
            let mut steps = Vec::new();
            while let Some(l) = current {
                steps.push(kinematics.joints[l.0].rotation.clone());
                current = kinematics.joints[l.0].parent;
            }
            steps.iter().rev().fold(Rotation::identity(self.scope.graph), |r, step| r.compose_with(step))
        };
        if base == link {
            return Rotation::identity(self.scope.graph);
        }
        rotation_to_ground(base).inverse().compose_with(&rotation_to_ground(link))
    }

    /// Returns a placement by its name, by `place.at(vector)`, or by a vector from the ground's origin. See
    /// `offset` for `free`.
    fn placement_of_position(
        &self,
        e: &Expr,
        free: bool,
        cx: &mut Diagnostics,
    ) -> Option<(Option<LinkId>, Pose<'g>)> {
        let is_placeable = |name: &String| name == GROUND || self.scope.is_placeable(name);
        match &e.kind {
            ExprKind::Name(name) if is_placeable(name) => {
                let place = self.scope.resolve_placement(e, cx)?;
                Some((place.link, place.pose))
            }
            ExprKind::Method(base, method, arguments)
                if method.id == Some(BodyOrInertiaMethod::At) && arguments.len() == 1 =>
            {
                let frame = self.scope.resolve_placement(base, cx)?;
                self.placement_at_offset(frame, &arguments[0], free, cx)
            }
            ExprKind::Method(_, method, _) => {
                cx.report_error(
                    method.place.clone(),
                    format!("unknown method `.{}(…)` of a point", method.text),
                )
                .suggest_name(&method.text, ["at"]);
                None
            }
            _ => self.placement_at_offset(self.ground_placement(), e, free, cx),
        }
    }

    /// Returns the placement at a vector from another one, with the same axes. If `free` is set, the axes are
    /// irrelevant and may differ.
    fn placement_at_offset(
        &self,
        frame: PlacedElement<'g>,
        at: &Expr,
        free: bool,
        cx: &mut Diagnostics,
    ) -> Option<(Option<LinkId>, Pose<'g>)> {
        let context = Context::new(AllowedQuantities::Placement, Some((frame.link, frame.pose.clone())));
        let terms = self.scope.call_in_context(context, |scope| scope.resolve_vector_terms(at, cx))?;
        let kinematics = &self.scope.kinematics;
        let zero = Vec3::zero(self.scope.graph);
        // A constant vector in the axes of a frame that rotates about the base point is placed in that frame.
        if let [(axes, v)] = terms.as_slice()
            && free
            && frame.pose.translation.is_zero()
            && *axes != frame.link
            && self.origins_always_coincide(*axes, frame.link)
        {
            return Some((*axes, Pose { rotation: Rotation::identity(self.scope.graph), translation: *v }));
        }
        let translation =
            frame.pose.translation + kinematics.components_in_link_axes(&terms, frame.link, zero);
        Some((frame.link, Pose { rotation: frame.pose.rotation, translation }))
    }

    /// Returns whether the origin of a link always coincides with the origin of one of its ancestors.
    fn origins_always_coincide(&self, link: Option<LinkId>, ancestor: Option<LinkId>) -> bool {
        let kinematics = &self.scope.kinematics;
        let mut current = link;
        while current != ancestor {
            let Some(l) = current else { return false };
            if !kinematics.joints[l.0].translation.is_zero() {
                return false;
            }
            current = kinematics.joints[l.0].parent;
        }
        true
    }
}

/// Collects all names in an expression, including the bases of members and methods.
fn collect_names_in_expression(e: &Expr, names: &mut Vec<String>) {
    names.extend(e.all_subexpressions().into_iter().filter_map(Expr::as_name).map(str::to_string));
}

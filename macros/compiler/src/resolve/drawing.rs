//! Pieces of the drawing, added by the option `drawing`. They show the declared elements in the axes of named
//! frames, so that a viewer needs no traversal of the links.

use super::contact::{Surface, surface_pieces};
use super::joint::joint_drawing_symbol;
use super::scope::{AllowedQuantities, Context, PlacedElement, PlacedElementKind, Scope};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Rotation, Vec3};
use crate::kinematics::symbols_in;
use crate::language::{BodyOrInertiaMethod, Callable, Solid};
use crate::mechanism::drawing::{
    PoseInFrame, entries_by_row, entries_of_vectors, pose_relative_to_named_frame,
};
use crate::mechanism::{InputEffect, LinkId, Model, Piece, PieceShape, Pose, Quantity, ShownObjectKind};
use crate::syntax::{
    self, Action, BinaryOp, Callee, Endpoint, ExprKind, FileForceLaw, GROUND, Shape, Target, VisualShape,
};
use std::collections::BTreeSet;

/// Returns the pieces of the drawing, and the heights of terrains. `model` is complete but for the drawing;
/// `surfaces` are those of contacts and pairs, with their names.
pub fn mechanism_drawing_pieces<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    surfaces: &[(String, Surface<'g>)],
) -> (Vec<Piece<'g>>, Vec<Expr<'g>>) {
    // The second reading of expressions adds no requirements.
    let required = scope.records.borrow().requirements.clone();
    let drawing = DrawnElements { scope, model, surfaces };
    let (mut pieces, heights) =
        scope.call_in_context(Context::new(AllowedQuantities::Constant, None), |_| drawing.all_pieces());
    scope.records.borrow_mut().requirements = required;
    let depends_only_on_parameters = |e: &[Expr<'g>]| {
        symbols_in(e).into_iter().all(|s| matches!(Quantity::from_symbol(s), Quantity::Parameter(_)))
    };
    pieces.retain(|piece| depends_only_on_parameters(&piece.numbers));
    (pieces, heights)
}

/// Elements that are drawn, and the frames in which they are drawn.
struct DrawnElements<'s, 'a, 'g> {
    scope: &'s Scope<'a, 'g>,
    model: &'s Model<'g>,
    surfaces: &'s [(String, Surface<'g>)],
}

impl<'g> DrawnElements<'_, '_, 'g> {
    fn all_pieces(&self) -> (Vec<Piece<'g>>, Vec<Expr<'g>>) {
        let mut pieces = Vec::new();
        let shown = self.add_visual_pieces(&mut pieces);
        if !self.model.gravity.is_zero() {
            let numbers = entries_of_vectors(&[Vec3::zero(self.scope.graph), self.model.gravity]);
            let (name, frames) = ("gravity".to_string(), [None, None]);
            pieces.push(Piece {
                name,
                role: ShownObjectKind::Gravity,
                kind: PieceShape::Gravity,
                frames,
                numbers,
            });
        }
        self.add_body_pieces(&shown, &mut pieces);
        self.add_joint_pieces(&shown, &mut pieces);
        let (surfaces, heights) = surface_pieces(self.surfaces, &self.model.frames);
        pieces.extend(surfaces);
        self.add_action_pieces(&mut pieces);
        (pieces, heights)
    }

    fn pose_relative_to_named_frame(&self, link: Option<LinkId>, pose: &Pose<'g>) -> Option<PoseInFrame<'g>> {
        pose_relative_to_named_frame(&self.model.frames, link, pose)
    }

    /// Returns the index of a body's own frame.
    fn body_frame_index(&self, name: &str) -> Option<usize> {
        self.model.frames.iter().position(|frame| frame.name == name)
    }

    /// Returns the link and the pose of the end of a joint.
    fn anchor_of_joint_end(&self, end: &Endpoint) -> Option<PoseInFrame<'g>> {
        let mut silent = Diagnostics::silent_diagnostics();
        let on_body = self.scope.frame_of_endpoint(end, &mut silent)?;
        if end.body.text == GROUND {
            return Some((None, on_body));
        }
        if let Some(frame) = self.body_frame_index(&end.body.text) {
            return Some((Some(frame), on_body));
        }
        let (link, pose) = self.scope.placement_of_joint_parent(&end.body, &mut silent)?;
        self.pose_relative_to_named_frame(link, &pose.compose_with(&on_body))
    }

    /// Adds the visual geometry of a file. Returns the bodies that have visual geometry without meshes.
    /// Bodies with meshes are also drawn by their mass properties, which are visible if a mesh cannot be
    /// read.
    fn add_visual_pieces(&self, pieces: &mut Vec<Piece<'g>>) -> BTreeSet<String> {
        let g = self.scope.graph;
        for VisualShape { on, shape, mesh } in &self.scope.description.visuals {
            let Some((frame, pose)) = self.anchor_of_joint_end(on) else { continue };
            let z = pose.rotation.vector_in_parent_axes(Vec3::coordinate_axis(g, 2));
            let number_expression = |x: f64| g.num(x);
            let entries_of_round_solid = |numbers: &[f64]| {
                let axis = entries_of_vectors(&[pose.translation, z]);
                axis.into_iter().chain(numbers.iter().map(|x| g.num(*x))).collect()
            };
            let numbers_of_oriented_shape = |lengths: [f64; 3]| {
                let axes = entries_by_row(&pose.rotation.rotation_matrix());
                entries_of_vectors(&[pose.translation])
                    .into_iter()
                    .chain(axes)
                    .chain(lengths.map(number_expression))
                    .collect()
            };
            let (kind, numbers) = match (shape, mesh) {
                (Shape::Sphere(radius), _) => {
                    let mut numbers = entries_of_vectors(&[pose.translation]);
                    numbers.push(number_expression(*radius));
                    (PieceShape::Sphere, numbers)
                }
                (Shape::Cuboid(edges), _) => (PieceShape::Cuboid, numbers_of_oriented_shape(*edges)),
                (Shape::Ellipsoid(halves), _) => (PieceShape::Ellipsoid, numbers_of_oriented_shape(*halves)),
                (Shape::Cylinder(radius, height), _) => {
                    (PieceShape::Cylinder, entries_of_round_solid(&[*radius, *height]))
                }
                (Shape::Capsule(radius, height), _) => {
                    (PieceShape::Capsule, entries_of_round_solid(&[*radius, *height]))
                }
                (Shape::Mesh, Some(mesh)) => {
                    (PieceShape::Mesh(mesh.path.clone()), numbers_of_oriented_shape(mesh.scale))
                }
                (Shape::Mesh, None) => continue,
            };
            let name = on.body.text.clone();
            pieces.push(Piece { name, role: ShownObjectKind::Visual, kind, frames: [frame, None], numbers });
        }
        let is_mesh = |piece: &&Piece<'g>| matches!(piece.kind, PieceShape::Mesh(_));
        let meshes: BTreeSet<&String> = pieces.iter().filter(is_mesh).map(|piece| &piece.name).collect();
        pieces.iter().map(|piece| &piece.name).filter(|name| !meshes.contains(name)).cloned().collect()
    }

    /// Adds solids and particles, except for the bodies in `shown`.
    fn add_body_pieces(&self, shown: &BTreeSet<String>, pieces: &mut Vec<Piece<'g>>) {
        let g = self.scope.graph;
        for body in &self.scope.description.bodies {
            let name = &body.name.text;
            let (Some(frame), Some((mass, com, inertia))) =
                (self.body_frame_index(name), self.scope.kinematics.masses.get(name).copied())
            else {
                continue;
            };
            if mass.is_zero() && inertia.diagonal.iter().all(|i| i.is_zero()) || shown.contains(name) {
                continue;
            }
            let mut solids = Vec::new();
            let complete = match &body.inertia {
                Some(e) if body.about.is_none() => {
                    self.collect_solids(e, &Rotation::identity(g), com, &mut solids)
                }
                _ => false,
            };
            if !complete {
                let tensor = inertia.diagonal.into_iter().chain(inertia.off);
                let is_point = inertia.diagonal.iter().all(|i| i.is_zero());
                let kind = if is_point { PieceShape::Point } else { PieceShape::Inertia };
                let inertial_parameters = std::iter::once(mass).chain(tensor);
                let inertial_parameters: Vec<Expr<'g>> =
                    if is_point { Vec::new() } else { inertial_parameters.collect() };
                solids =
                    vec![(kind, entries_of_vectors(&[com]).into_iter().chain(inertial_parameters).collect())];
            }
            pieces.extend(solids.into_iter().map(|(kind, numbers)| Piece {
                name: name.clone(),
                role: ShownObjectKind::Body,
                kind,
                frames: [Some(frame), None],
                numbers,
            }));
        }
        for particle in &self.scope.description.particles {
            let name = particle.name.text.clone();
            let frames = [self.body_frame_index(&name), None];
            let numbers = entries_of_vectors(&[Vec3::zero(g)]);
            if frames[0].is_some() {
                pieces.push(Piece {
                    name,
                    role: ShownObjectKind::Body,
                    kind: PieceShape::Point,
                    frames,
                    numbers,
                });
            }
        }
    }

    /// Collects the solids of an inertia about a point; returns false if a term of the inertia is not a
    /// solid.
    fn collect_solids(
        &self,
        e: &syntax::Expr,
        orientation: &Rotation<'g>,
        com: Vec3<'g>,
        found: &mut Vec<(PieceShape, Vec<Expr<'g>>)>,
    ) -> bool {
        let mut silent = Diagnostics::silent_diagnostics();
        match &e.kind {
            ExprKind::Binary(BinaryOp::Add, a, b, _) => {
                self.collect_solids(a, orientation, com, found)
                    && self.collect_solids(b, orientation, com, found)
            }
            ExprKind::Method(inner, method, steps) if method.id == Some(BodyOrInertiaMethod::Rotated) => {
                let Some(rotation) = self.scope.resolve_rotation(steps, &mut silent) else { return false };
                self.collect_solids(inner, &orientation.clone().compose_with(&rotation), com, found)
            }
            ExprKind::Call(Callee { id: Some(Callable::Solid(solid)), .. }, arguments) => {
                let Some(kind) = solid.row().piece.clone() else { return false };
                let mut numbers = entries_of_vectors(&[com]);
                let (axis, sizes) = match arguments.split_last() {
                    Some((axis, sizes)) if solid.has_axis() => (Some(axis), sizes),
                    _ => (None, arguments.as_slice()),
                };
                match axis {
                    Some(axis) => match self.scope.resolve_unit_vector(axis, false, &mut silent) {
                        Some(axis) => {
                            numbers.extend(entries_of_vectors(&[orientation.vector_in_parent_axes(axis)]))
                        }
                        None => return false,
                    },
                    None if kind == PieceShape::Sphere => {}
                    None => numbers.extend(entries_by_row(&orientation.rotation_matrix())),
                }
                // The first argument is the mass.
                for size in sizes.iter().skip(1) {
                    match self.scope.resolve_scalar(size, &mut silent) {
                        Some(size) => numbers.push(size),
                        None => return false,
                    }
                }
                if *solid == Solid::Plate {
                    numbers.push(self.scope.graph.zero());
                }
                found.push((kind, numbers));
                true
            }
            _ => false,
        }
    }

    /// Adds joints, and bars from a body's first joint to its other joints and to its centre of mass.
    fn add_joint_pieces(&self, shown: &BTreeSet<String>, pieces: &mut Vec<Piece<'g>>) {
        let mut joint_positions: Vec<(&str, Vec3<'g>)> = Vec::new();
        for joint in &self.scope.description.joints {
            let (Some((parent, on_parent)), Some((_, on_child))) =
                (self.anchor_of_joint_end(&joint.parent), self.anchor_of_joint_end(&joint.child))
            else {
                continue;
            };
            for (body, place) in
                [(&joint.parent.body, on_parent.translation), (&joint.child.body, on_child.translation)]
            {
                joint_positions.push((&body.text, place));
            }
            let Some((kind, axis)) = self.joint_symbol(joint) else { continue };
            let mut numbers = entries_of_vectors(&[on_parent.translation]);
            numbers.extend(
                axis.iter()
                    .flat_map(|axis| entries_of_vectors(&[on_parent.rotation.vector_in_parent_axes(*axis)])),
            );
            let name = joint.name.text.clone();
            pieces.push(Piece { name, role: ShownObjectKind::Joint, kind, frames: [parent, None], numbers });
        }
        for body in &self.scope.description.bodies {
            let name = &body.name.text;
            let Some(frame) = self.body_frame_index(name).filter(|_| !shown.contains(name)) else { continue };
            let mut places = joint_positions.iter().filter(|(of, _)| of == name).map(|(_, place)| *place);
            let Some(first) = places.next() else { continue };
            let com = self.scope.kinematics.masses.get(name).map(|(_, com, _)| *com);
            for other in places.chain(com).filter(|other| !(*other - first).is_zero()) {
                pieces.push(Piece {
                    name: name.clone(),
                    role: ShownObjectKind::Link,
                    kind: PieceShape::Bar,
                    frames: [Some(frame), Some(frame)],
                    numbers: entries_of_vectors(&[first, other]),
                });
            }
        }
    }

    /// Returns the symbol of a joint, with its axis on the parent.
    fn joint_symbol(&self, joint: &syntax::Joint) -> Option<(PieceShape, Option<Vec3<'g>>)> {
        let (kind, axes) = joint_drawing_symbol(joint)?;
        let unit_axis = |axes: &[syntax::Expr]| {
            self.scope.resolve_unit_vector(
                axes.first()?,
                joint.normalise_axis,
                &mut Diagnostics::silent_diagnostics(),
            )
        };
        Some((kind, axes.map_or(Some(None), |axes| unit_axis(axes).map(Some))?))
    }

    /// Adds the drawing of springs, dashpots and inputs.
    fn add_action_pieces(&self, pieces: &mut Vec<Piece<'g>>) {
        for action in &self.scope.description.actions {
            let row = action.kind.row();
            if let Some([long, round]) = &row.pieces
                && (!row.drawn_between || matches!(action.on, Target::Between(..)))
            {
                self.add_element_pieces(action, long.clone(), round.clone(), pieces);
            }
        }
        for (k, (name, input)) in self.model.inputs.iter().enumerate() {
            let Some((kind, frames, numbers)) = self.input_arrow(k, name, input) else { continue };
            pieces.push(Piece { name: name.clone(), role: ShownObjectKind::Input, kind, frames, numbers });
        }
    }

    /// Adds an element between two points or on a joint: `long` if it spans a length, `round` if it acts on a
    /// rotation.
    fn add_element_pieces(
        &self,
        action: &Action,
        long: PieceShape,
        round: PieceShape,
        pieces: &mut Vec<Piece<'g>>,
    ) {
        let found = match &action.on {
            Target::Between(a, b) => {
                let mut silent = Diagnostics::silent_diagnostics();
                let mut anchor_of_placement = |e| {
                    self.scope
                        .resolve_placement(e, &mut silent)
                        .and_then(|p| self.pose_relative_to_named_frame(p.link, &p.pose))
                };
                anchor_of_placement(a)
                    .zip(anchor_of_placement(b))
                    .map(|(a, b)| (long, [a.0, b.0], [a.1.translation, b.1.translation]))
            }
            Target::On(on) => {
                self.single_coordinate_joint_data(on).map(|(turns, frames, ends, axis)| match turns {
                    true => (round, frames, [ends[0], axis]),
                    false => (long, frames, ends),
                })
            }
        };
        if let Some((kind, frames, vectors)) = found {
            let (name, numbers) = (action.name.text.clone(), entries_of_vectors(&vectors));
            pieces.push(Piece { name, role: ShownObjectKind::Element, kind, frames, numbers });
        }
    }

    /// Returns the data of a joint with one coordinate: whether it is revolute, the frames and positions of
    /// its ends, and its axis on the parent.
    #[expect(clippy::type_complexity, reason = "it is taken apart where it is made")]
    fn single_coordinate_joint_data(
        &self,
        on: &syntax::Expr,
    ) -> Option<(bool, [Option<usize>; 2], [Vec3<'g>; 2], Vec3<'g>)> {
        let name = on.as_name()?;
        let joint = self.scope.description.joints.iter().find(|joint| joint.name.text == name)?;
        let ((a, on_a), (b, on_b)) =
            self.anchor_of_joint_end(&joint.parent).zip(self.anchor_of_joint_end(&joint.child))?;
        let (kind, axis) = self.joint_symbol(joint)?;
        let axis = on_a.rotation.vector_in_parent_axes(axis?);
        Some((kind == PieceShape::Hinge, [a, b], [on_a.translation, on_b.translation], axis))
    }

    /// Returns the joint that an input of a file drives.
    fn joint_driven_by_input(&self, input: &str) -> Option<&str> {
        let drives = &self.scope.description.drives;
        let found = drives
            .iter()
            .find(|drive| matches!(&drive.law, FileForceLaw::Input(_)) && drive.name.text == input);
        found.and_then(|drive| drive.on.weighted_joints().first()).map(|(joint, _)| joint.text.as_str())
    }

    /// Returns an arrow for an input, if the input has one direction.
    fn input_arrow(
        &self,
        k: usize,
        name: &str,
        input: &InputEffect<'g>,
    ) -> Option<(PieceShape, [Option<usize>; 2], Vec<Expr<'g>>)> {
        let g = self.scope.graph;
        let (link, point, direction, torque) = match input {
            InputEffect::Named | InputEffect::Sum(..) => return None,
            InputEffect::Coordinate(_) => {
                let on = self.scope.description.actions.iter().find(|action| action.name.text == name);
                let joint = match on.map(|action| &action.on) {
                    Some(Target::On(on)) => self.single_coordinate_joint_data(on),
                    Some(Target::Between(..)) => None,
                    None => {
                        let joint = self.joint_driven_by_input(name).unwrap_or(name).to_string();
                        let place = self.scope.description.name.place.clone();
                        self.single_coordinate_joint_data(&syntax::Expr {
                            kind: ExprKind::Name(joint),
                            place,
                        })
                    }
                };
                let (turns, [a, _], [position, _], axis) = joint?;
                let kind = if turns { PieceShape::Torque(k) } else { PieceShape::Force(k) };
                return Some((kind, [a, a], entries_of_vectors(&[position, axis])));
            }
            InputEffect::Force { link, point, along } => (*link, *point, along, false),
            InputEffect::Torque { link, about } => (*link, Vec3::zero(g), about, true),
        };
        let [(axes, direction)] = direction.as_slice() else { return None };
        let place = PlacedElement {
            link: Some(link),
            pose: Pose { rotation: Rotation::identity(g), translation: point },
            kind: PlacedElementKind::Point,
        };
        let (frame, pose) = self.pose_relative_to_named_frame(place.link, &place.pose)?;
        let (axes_frame, axes) = self.pose_relative_to_named_frame(*axes, &Pose::identity(g))?;
        let kind = if torque { PieceShape::Torque(k) } else { PieceShape::Force(k) };
        let numbers =
            entries_of_vectors(&[pose.translation, axes.rotation.vector_in_parent_axes(*direction)]);
        Some((kind, [frame, axes_frame], numbers))
    }
}

//! The oracle: numeric Kane's equations of a random mechanism. Positions are composed joint by joint in
//! ground axes as Taylor series in time. Inertial forces follow from Newton's and Euler's equations of each
//! body. Generalized forces are dot products with partial velocities, which are the velocities for a unit
//! value of one generalized speed (Kane and Levinson, *Dynamics: Theory and Applications*, 1985, ch. 4 and
//! 5). The oracle uses no code of the compiler.

use crate::jet::{
    C, Jet, Matrix, Vector, complex_from_real, constant_vector, cross, difference_of_vectors, dot,
    identity_matrix, matrix_product, rotated_vector, rotation_about_axis, scaled_vector, sum_of_vectors,
};
use crate::motion::{
    MovingBody, Pose, angular_motion, complex_dot, compose_poses, inverse_pose,
    position_moving_with_velocity, rotating_orientation, rotation_of_quaternion, velocity_of_position,
};
use crate::spec::{
    AttachmentPoint, Body, ForceElement, ForceLaw, ForcePath, MechanismSpec, Placement, TestJointKind,
};
use std::array::from_fn;

/// State with accelerations. Complex, so that an imaginary step gives derivatives.
#[derive(Clone, Debug)]
pub struct State {
    pub q: Vec<C>,
    pub v: Vec<C>,
    pub a: Vec<C>,
}

impl State {
    /// Creates a state from real configuration, velocities and accelerations.
    pub fn new(q: &[f64], v: &[f64], a: &[f64]) -> State {
        let complex_vector = |x: &[f64]| x.iter().map(|x| complex_from_real(*x)).collect();
        State { q: complex_vector(q), v: complex_vector(v), a: complex_vector(a) }
    }
}

/// Poses, masses and joint coordinates of all bodies at one state, as Taylor series in time.
struct BodyMotions {
    poses: Vec<Pose>,
    pieces: Vec<MovingBody>,
    /// For each body, the joint coordinates that force elements can act on.
    coordinates: Vec<Vec<Jet>>,
}

fn rotation_from_turns(list: &[(usize, f64)]) -> Matrix {
    list.iter().fold(identity_matrix(), |r, (axis, angle)| {
        let mut unit = [0.0; 3];
        unit[*axis] = 1.0;
        matrix_product(&r, &rotation_about_axis(unit, Jet::constant_series(*angle)))
    })
}

fn pose_of_place(place: &Placement) -> Pose {
    Pose { r: rotation_from_turns(&place.turns), p: constant_vector(place.at) }
}

/// Returns the pose of a joint, and its coordinates that elements can act on.
fn joint_pose_and_coordinates(body: &Body, q: &[C], v: &[C], a: &[C]) -> (Pose, Vec<Jet>) {
    let [one, two] = body.axes;
    let rotation_pose = |r: Matrix| Pose { r, p: constant_vector([0.0; 3]) };
    let translation_pose = |p: Vector| Pose { r: identity_matrix(), p };
    let three_entries_from = |list: &[C], k: usize| [list[k], list[k + 1], list[k + 2]];
    if body.kind == TestJointKind::Ball {
        return (
            rotation_pose(rotating_orientation(q, three_entries_from(v, 0), three_entries_from(a, 0))),
            Vec::new(),
        );
    }
    if body.kind == TestJointKind::Free {
        let (w, rate) = (three_entries_from(v, 3), three_entries_from(a, 3));
        let r = rotating_orientation(&q[3..], w, rate);
        return (
            Pose {
                r,
                p: position_moving_with_velocity(
                    q,
                    &r,
                    three_entries_from(v, 0),
                    w,
                    three_entries_from(a, 0),
                ),
            },
            Vec::new(),
        );
    }
    let s: Vec<Jet> = (0..q.len()).map(|k| Jet([q[k], v[k], a[k] * 0.5])).collect();
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let pose = match body.kind {
        TestJointKind::Pin => rotation_pose(rotation_about_axis(one, s[0])),
        TestJointKind::Sleeve => translation_pose(scaled_vector(s[0], one)),
        TestJointKind::Screw => Pose {
            r: rotation_about_axis(one, s[0]),
            p: scaled_vector(s[0] * Jet::constant_series(body.pitch), one),
        },
        TestJointKind::Collar => Pose { r: rotation_about_axis(one, s[1]), p: scaled_vector(s[0], one) },
        TestJointKind::Slot => Pose { r: rotation_about_axis(two, s[1]), p: scaled_vector(s[0], one) },
        TestJointKind::Universal => {
            rotation_pose(matrix_product(&rotation_about_axis(x, s[0]), &rotation_about_axis(y, s[1])))
        }
        TestJointKind::Planar => Pose {
            r: rotation_about_axis(z, s[2]),
            p: sum_of_vectors(scaled_vector(s[0], x), scaled_vector(s[1], y)),
        },
        TestJointKind::Stage => translation_pose([s[0], s[1], s[2]]),
        TestJointKind::Ball | TestJointKind::Free | TestJointKind::Weld => rotation_pose(identity_matrix()),
    };
    (pose, s)
}

/// Returns the numbers of configuration coordinates and of velocities.
pub fn coordinate_and_velocity_counts(spec: &MechanismSpec) -> (usize, usize) {
    spec.bodies.iter().fold((0, 0), |(nq, nv), body| {
        let (q, v) = body.kind.coordinate_and_velocity_counts();
        let own = usize::from(body.slider.is_some());
        (nq + q + own, nv + v + own)
    })
}

fn world_of_state(spec: &MechanismSpec, state: &State) -> BodyMotions {
    let mut world = BodyMotions { poses: Vec::new(), pieces: Vec::new(), coordinates: Vec::new() };
    let (mut q0, mut v0) = (0, 0);
    for body in &spec.bodies {
        let (nq, nv) = body.kind.coordinate_and_velocity_counts();
        let (motion, coordinates) = joint_pose_and_coordinates(
            body,
            &state.q[q0..q0 + nq],
            &state.v[v0..v0 + nv],
            &state.a[v0..v0 + nv],
        );
        (q0, v0) = (q0 + nq, v0 + nv);
        let parent = body.parent.map_or(Pose::identity_pose(), |k| world.poses[k]);
        let carried = compose_poses(&compose_poses(&parent, &pose_of_place(&body.on_parent)), &motion);
        let pose = compose_poses(&carried, &inverse_pose(&pose_of_place(&body.on_child)));
        world.pieces.push(MovingBody {
            mass: body.mass,
            inertia: inertia_in_body_axes(body),
            r: pose.r,
            p: sum_of_vectors(pose.p, rotated_vector(&pose.r, constant_vector(body.com))),
        });
        let mut add_particle = |mass: f64, p: Vector| {
            world.pieces.push(MovingBody { mass, inertia: [[0.0; 3]; 3], r: identity_matrix(), p });
        };
        if let Some((mass, at)) = body.particle {
            add_particle(mass, sum_of_vectors(pose.p, rotated_vector(&pose.r, constant_vector(at))));
        }
        if let Some(slider) = &body.slider {
            let s = Jet([state.q[q0], state.v[v0], state.a[v0] * 0.5]);
            (q0, v0) = (q0 + 1, v0 + 1);
            let [x, y, z] = slider.offset;
            let mut p = sum_of_vectors(pose.p, rotated_vector(&pose.r, constant_vector([y, z, 0.0])));
            p[0] = p[0] + s;
            p[1] = p[1] + Jet::constant_series(x);
            add_particle(slider.mass, p);
        }
        world.poses.push(pose);
        world.coordinates.push(coordinates);
    }
    world
}

/// Returns the inertia matrix `R diag(moments) Rᵀ` of a body, from its principal moments and axes.
fn inertia_in_body_axes(body: &Body) -> [[f64; 3]; 3] {
    let r = rotation_from_turns(&body.inertia_turns);
    from_fn(|i| from_fn(|j| (0..3).map(|k| r[i][k].0[0].re * body.moments[k] * r[j][k].0[0].re).sum()))
}

fn position_of_end(world: &BodyMotions, end: &AttachmentPoint) -> Vector {
    match end.body {
        None => constant_vector(end.at),
        Some(k) => {
            sum_of_vectors(world.poses[k].p, rotated_vector(&world.poses[k].r, constant_vector(end.at)))
        }
    }
}

fn distance_between_ends(world: &BodyMotions, a: &AttachmentPoint, b: &AttachmentPoint) -> Jet {
    let d = difference_of_vectors(position_of_end(world, a), position_of_end(world, b));
    dot(d, d).sqrt()
}

fn length_of_path(world: &BodyMotions, path: &ForcePath) -> Jet {
    match path {
        ForcePath::Rope([a, b, c]) => distance_between_ends(world, a, b) + distance_between_ends(world, b, c),
        ForcePath::Cable { ends, around, radius, axis } => cable_length(world, ends, around, *radius, *axis),
    }
}

/// Returns the ends of a cable relative to the centre of its obstacle, projected on the plane normal to the
/// axis, and the distance between the ends along the axis.
fn cable_ends_in_obstacle_plane(
    world: &BodyMotions,
    ends: &[AttachmentPoint; 2],
    around: &AttachmentPoint,
    axis: Option<[f64; 3]>,
) -> ([Vector; 2], Jet, Option<Vector>) {
    let middle = position_of_end(world, around);
    let from = ends.each_ref().map(|end| difference_of_vectors(position_of_end(world, end), middle));
    let Some(axis) = axis else { return (from, Jet::constant_series(0.0), None) };
    let n = around
        .body
        .map_or(constant_vector(axis), |k| rotated_vector(&world.poses[k].r, constant_vector(axis)));
    let heights = from.map(|p| dot(p, n));
    let in_plane_component_of_end = |k: usize| difference_of_vectors(from[k], n.map(|x| x * heights[k]));
    ([in_plane_component_of_end(0), in_plane_component_of_end(1)], heights[1] - heights[0], Some(n))
}

/// Returns the length of a taut cable. In the plane normal to the axis, or in the plane of the ends and the
/// centre of a ball, the cable is straight on the unrolled surface.
fn cable_length(
    world: &BodyMotions,
    ends: &[AttachmentPoint; 2],
    around: &AttachmentPoint,
    radius: f64,
    axis: Option<[f64; 3]>,
) -> Jet {
    let ([a, b], rise, n) = cable_ends_in_obstacle_plane(world, ends, around, axis);
    let normal = cross(a, b);
    let angle = match n {
        None => Jet::atan2(dot(normal, normal).sqrt(), dot(a, b)),
        Some(n) => Jet::atan2(dot(normal, n), dot(a, b)),
    };
    let turn = if angle.0[0].re < 0.0 { 2.0 * std::f64::consts::PI } else { 0.0 };
    let r = Jet::constant_series(radius);
    let tangents = [a, b].map(|p| (dot(p, p) - r * r).sqrt());
    let arc = angle + Jet::constant_series(turn) - Jet::atan2(tangents[0], r) - Jet::atan2(tangents[1], r);
    let level = if arc.0[0].re > 0.0 {
        tangents[0] + tangents[1] + r * arc
    } else {
        let d = difference_of_vectors(a, b);
        dot(d, d).sqrt()
    };
    if n.is_none() { level } else { (level * level + rise * rise).sqrt() }
}

/// Scalar quantity whose motion is prescribed as a function of time.
#[derive(Clone, Debug)]
pub enum PrescribedQuantity {
    /// Weighted sum of coordinates: factor, body and index of the coordinate.
    Coordinates(Vec<(f64, usize, usize)>),
    /// Displacement between two points along an axis of the ground.
    Way(AttachmentPoint, AttachmentPoint, usize),
}

/// Returns a prescribed quantity at a state, with its first and second rates.
pub fn series_of_prescribed_quantity(
    spec: &MechanismSpec,
    state: &State,
    measure: &PrescribedQuantity,
) -> Jet {
    let world = world_of_state(spec, state);
    match measure {
        PrescribedQuantity::Coordinates(list) => {
            list.iter().fold(Jet::constant_series(0.0), |sum, (factor, body, k)| {
                sum + Jet::constant_series(*factor) * world.coordinates[*body][*k]
            })
        }
        PrescribedQuantity::Way(a, b, axis) => {
            difference_of_vectors(position_of_end(&world, a), position_of_end(&world, b))[*axis]
        }
    }
}

/// Returns whether the ends of all cables are outside the balls and cylinders that the cables wrap around.
pub fn are_cables_outside_surfaces(spec: &MechanismSpec, q: &[f64]) -> bool {
    let (_, nv) = coordinate_and_velocity_counts(spec);
    let world = world_of_state(spec, &State::new(q, &vec![0.0; nv], &vec![0.0; nv]));
    spec.elements.iter().all(|element| match element {
        ForceElement::Along(_, ForcePath::Cable { ends, around, radius, axis }) => {
            let (ends, ..) = cable_ends_in_obstacle_plane(&world, ends, around, *axis);
            ends.iter().all(|p| dot(*p, *p).0[0].re > 1.1 * radius * radius)
        }
        _ => true,
    })
}

fn tension_of_law(law: ForceLaw, length: Jet) -> C {
    match law {
        ForceLaw::Attraction(k) => (length.0[0] * length.0[0]).inv() * k,
        ForceLaw::Friction(f) => {
            let v = length.first_time_derivative();
            let peak = (-(v * v) / (f.stribeck_speed * f.stribeck_speed)).exp() * (f.stiction - f.coulomb);
            (peak + f.coulomb) * (v / f.speed).tanh() + v * f.viscous
        }
        ForceLaw::Spring(k, free) => (length.0[0] - free) * k,
        ForceLaw::Dashpot(c) => length.first_time_derivative() * c,
        ForceLaw::Inerter(b) => length.second_time_derivative() * b,
    }
}

/// Returns `τ = M a + h` as the sum over all masses and forces.
pub fn inverse_dynamics(spec: &MechanismSpec, state: &State) -> Vec<C> {
    let now = world_of_state(spec, state);
    let nv = state.v.len();
    (0..nv)
        .map(|k| {
            let mut unit = State {
                q: state.q.clone(),
                v: vec![complex_from_real(0.0); nv],
                a: vec![complex_from_real(0.0); nv],
            };
            unit.v[k] = complex_from_real(1.0);
            generalized_force(spec, &now, &world_of_state(spec, &unit))
        })
        .collect()
}

/// Returns the power `λᵀ τ` of the forces `τ` for velocities `λ`.
pub fn power_of_forces(spec: &MechanismSpec, state: &State, lambda: &[f64]) -> C {
    let rates = lambda.iter().map(|x| complex_from_real(*x)).collect();
    let partial = State { q: state.q.clone(), v: rates, a: vec![complex_from_real(0.0); lambda.len()] };
    generalized_force(spec, &world_of_state(spec, state), &world_of_state(spec, &partial))
}

/// Returns the generalized force for one generalized speed. `partial` is the motion in which only this
/// generalized speed is nonzero, with the value one.
fn generalized_force(spec: &MechanismSpec, now: &BodyMotions, partial: &BodyMotions) -> C {
    let mut tau = complex_from_real(0.0);
    for (piece, moved) in now.pieces.iter().zip(&partial.pieces) {
        tau += piece.generalized_inertial_force(moved, spec.gravity);
    }
    for element in &spec.elements {
        tau += match element {
            ForceElement::Between(law, a, b) => {
                tension_of_law(*law, distance_between_ends(now, a, b))
                    * distance_between_ends(partial, a, b).first_time_derivative()
            }
            ForceElement::Along(law, path) => {
                tension_of_law(*law, length_of_path(now, path))
                    * length_of_path(partial, path).first_time_derivative()
            }
            ForceElement::On(law, body, k) => {
                tension_of_law(*law, now.coordinates[*body][*k])
                    * partial.coordinates[*body][*k].first_time_derivative()
            }
            ForceElement::Push(end, force) => -complex_dot(
                force.map(complex_from_real),
                velocity_of_position(position_of_end(partial, end)),
            ),
            ForceElement::Twist(body, torque) => {
                -complex_dot(torque.map(complex_from_real), angular_motion(&partial.poses[*body].r).0)
            }
            ForceElement::Follow(end, force) => {
                let r = &now.poses[end.body.unwrap_or(0)].r;
                let force: [C; 3] = from_fn(|i| (0..3).map(|j| r[i][j].0[0] * force[j]).sum());
                -complex_dot(force, velocity_of_position(position_of_end(partial, end)))
            }
        };
    }
    tau
}

/// Returns the mass matrix by columns, and the bias forces.
pub fn mass_and_bias(spec: &MechanismSpec, q: &[C], v: &[C]) -> (Vec<Vec<C>>, Vec<C>) {
    let nv = v.len();
    let state_with_velocity = |v: &[C], a: Vec<C>| State { q: q.to_vec(), v: v.to_vec(), a };
    let zero = vec![complex_from_real(0.0); nv];
    let bias = inverse_dynamics(spec, &state_with_velocity(v, zero.clone()));
    // The mass matrix is computed without forces at rest. Subtracting forces would leave rounding errors.
    let is_inerter = |element: &&ForceElement| {
        let (ForceElement::Between(law, ..) | ForceElement::On(law, ..) | ForceElement::Along(law, _)) =
            element
        else {
            return false;
        };
        matches!(law, ForceLaw::Inerter(_))
    };
    let elements = spec.elements.iter().filter(is_inerter).cloned().collect();
    let unloaded = MechanismSpec { gravity: [0.0; 3], elements, ..spec.clone() };
    let columns = (0..nv)
        .map(|k| {
            let mut a = zero.clone();
            a[k] = complex_from_real(1.0);
            inverse_dynamics(&unloaded, &state_with_velocity(&zero, a))
        })
        .collect();
    (columns, bias)
}

/// Returns the configuration after an imaginary step along one velocity on the configuration manifold,
/// `q ⊕ i h e`.
pub fn configuration_after_imaginary_step(spec: &MechanismSpec, q: &[C], k: usize, h: f64) -> Vec<C> {
    stepped_configuration(spec, q, k, C::new(0.0, h))
}

/// Returns the point with parameter `h` of a curve on the configuration manifold that starts at `q` with
/// these velocities.
pub fn displaced_configuration(spec: &MechanismSpec, q: &[C], rates: &[f64], h: f64) -> Vec<C> {
    let step_coordinate =
        |q: Vec<C>, (k, rate): (usize, &f64)| stepped_configuration(spec, &q, k, complex_from_real(rate * h));
    let mut q = rates.iter().enumerate().fold(q.to_vec(), step_coordinate);
    let mut first = 0;
    for body in &spec.bodies {
        let (own, _) = body.kind.coordinate_and_velocity_counts();
        if own >= 4 {
            let quaternion = &mut q[first + own - 4..first + own];
            let length = quaternion.iter().map(|x| x * x).sum::<C>().sqrt();
            quaternion.iter_mut().for_each(|x| *x /= length);
        }
        first += own + usize::from(body.slider.is_some());
    }
    q
}

/// Returns the configuration after a step along one velocity, `q ⊕ h e`. Terms of second order in `h` are
/// neglected.
fn stepped_configuration(spec: &MechanismSpec, q: &[C], k: usize, h: C) -> Vec<C> {
    let mut stepped = q.to_vec();
    let (mut q0, mut v0) = (0, 0);
    for body in &spec.bodies {
        let (nq, nv) = body.kind.coordinate_and_velocity_counts();
        if (v0..v0 + nv).contains(&k) {
            step_joint(body.kind, &mut stepped[q0..q0 + nq], k - v0, h);
        }
        (q0, v0) = (q0 + nq, v0 + nv);
        if body.slider.is_some() {
            if v0 == k {
                stepped[q0] += h;
            }
            (q0, v0) = (q0 + 1, v0 + 1);
        }
    }
    stepped
}

fn step_joint(kind: TestJointKind, q: &mut [C], k: usize, h: C) {
    match (kind, k) {
        (TestJointKind::Ball, _) => rotate_quaternion(q, k, h),
        (TestJointKind::Free, 0..3) => {
            let r = rotation_of_quaternion(&q[3..]);
            (0..3).for_each(|i| q[i] += r[i][k] * h);
        }
        (TestJointKind::Free, _) => rotate_quaternion(&mut q[3..], k - 3, h),
        _ => q[k] += h,
    }
}

/// Rotates a quaternion: `q ⊗ (e h / 2, 1)`.
fn rotate_quaternion(q: &mut [C], k: usize, h: C) {
    let (x, y, z, w) = (q[0], q[1], q[2], q[3]);
    let rate = [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]][k];
    (0..4).for_each(|i| q[i] += rate[i] * h * 0.5);
}

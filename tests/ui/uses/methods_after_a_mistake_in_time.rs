use linkwork::prelude::*;

#[mechanism(gravity = -g * z, derivatives, regressor, sensitivities, prepare)]
struct BeadOnSpinningHoop {
    g: f64,
    m: f64,
    radius: f64,
    spin: f64,
    theta: Coordinate,
    #[frame(ground, z(spin * t))]
    hoop: Frame,
    #[particle(mass = mm, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))]
    bead: Particle,
    #[point(on = bead, at = radius * hoop.y)]
    eye: Point,
    tension: Input,
    #[acts(on = bead, value = -tension * velocity)]
    thread: Force,
    #[define(v(bead / ground / ground))]
    velocity: Vector,
    #[output(r(bead / ground))]
    place: Vector,
    #[output(velocity, resolved_in = hoop)]
    sliding: Vector,
    #[output(dot(a(bead / ground / ground), hoop.x) + tension * norm(velocity) / m)]
    pull: Scalar,
}

fn main() {
    let hoop = BeadOnSpinningHoop { g: 9.81, m: 0.1, radius: 0.3, spin: 8.0 };
    let (t, q, v, u) = (0.0, [0.5].into(), [2.0].into(), [1.0].into());
    let tau = hoop.generalized_forces(t, &q, &v, &u) - hoop.bias_forces(t, &q, &v);
    let a = hoop.forward_dynamics(t, &q, &v, &tau) + hoop.mass_matrix(t, &q) * v;
    let _ = hoop.place(t, &q) + hoop.place_jacobian(t, &q) * v;
    let _ = hoop.sliding(t, &q, &v).norm() + (hoop.sliding_jacobian(t, &q, &v) * v).norm();
    let _ = hoop.pull(t, &q, &v, &a, &u) + hoop.total_mass();
    let (_, _) = hoop.linearize(t, &q, &v, &u);
    let bead = frame!(BeadOnSpinningHoop, "bead");
    let _ = hoop.frame_placement(bead, t, &q);
    let _ = hoop.frame_placement(frame!(BeadOnSpinningHoop, "eye"), t, &q);
    let _ = hoop.frame_velocity(bead, t, &q, &v) - hoop.frame_jacobian(bead, t, &q) * v;
    let _ = hoop.frame_acceleration(bead, t, &q, &v, &a);
    let standard = hoop.standard_parameters();
    let _ = hoop.joint_torque_regressor(t, &q, &v, &a) * standard;
    let _ = hoop.base_regressor(t, &q, &v, &a) * hoop.base_parameters(&standard);
    let _ = hoop.inverse_dynamics_by_parameters(t, &q, &v, &a) + hoop.forward_dynamics_by_parameters(t, &q, &v, &tau);
    let _ = (BeadOnSpinningHoop::PARAMETERS, BeadOnSpinningHoop::BODIES, BeadOnSpinningHoop::BASE_PARAMETERS);
    let prepared: PreparedBeadOnSpinningHoop = hoop.prepare();
    let _ = prepared.mass_matrix(t, &q) * prepared.sliding(t, &q, &v).norm();
    let _ = simulate(&hoop).from(q, v);
    let _ = simulate(&prepared).from(q, v);
}

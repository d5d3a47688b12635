//! Second-order forms of mechanisms with constraints: mass, damping, gyroscopic, stiffness and circulatory
//! matrices in independent coordinates, compared with closed forms.

use linkwork::prelude::*;
use linkwork_design::steady::constrained_equilibrium;
use linkwork_design::{Error, SecondOrderForm};
use nalgebra::{DMatrix, dmatrix};

#[track_caller]
fn assert_relatively_close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "expected {expected}, found {found}");
}

#[track_caller]
fn assert_same_matrix(found: &DMatrix<f64>, expected: &DMatrix<f64>, tolerance: f64) {
    assert!(
        (found - expected).amax() <= tolerance * expected.amax().max(1.0),
        "expected {expected}, found {found}"
    );
}

/// Test mechanism: a particle on a massless rod, with gravity, a dashpot and wind.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct BlownParticle {
    mass: f64,
    length: f64,
    oil: f64,
    #[particle(mass = mass)]
    bob: Particle,
    #[joint(ground -> bob, along = (x, y))]
    place: Stage,
    #[constraint(norm(r(bob / ground)) == length)]
    rod: Holonomic,
    #[acts(on = place.x, damping = oil)]
    dashpot: Dashpot,
    #[acts(on = place.x)]
    wind: Force,
}

/// Compares with the closed form in the angle `θ` from the downward vertical:
/// `m L² θ̈ + c L² cos² θ θ̇ + L √((m g)² + F²) θ = 0` about `tan θ = F / (m g)`. With `x = L sin θ`, the
/// coefficients of the form in `x` are these divided by `(L cos θ)²`.
#[test]
fn particle_on_rod_in_wind_matches_closed_form() {
    let (mass, length, oil, wind) = (2.0, 0.7, 1.3, 8.0);
    let blown = BlownParticle { mass, length, oil };
    let problem = constrained_equilibrium(&blown).from([0.2, -0.6].into()).with_inputs([wind].into());
    let form = problem.second_order_form(&problem.find().unwrap()).unwrap();
    let weight = mass * 9.81;
    let angle = wind.atan2(weight);
    let of_x = (length * angle.cos()).powi(2);
    assert_relatively_close(form.mass[0], mass * length * length / of_x, 1e-12);
    assert_relatively_close(form.damping[0], oil, 1e-12);
    assert_relatively_close(form.stiffness[0], length * weight.hypot(wind) / of_x, 1e-12);
    assert_relatively_close(form.input[0], 1.0, 1e-12);
    let system = form.state_space().unwrap();
    assert_eq!(system.states()[0].to_string(), "place.x, m");
    // The linear system of the same equilibrium has the same matrices.
    let direct = problem.linear_system(&problem.find().unwrap()).unwrap();
    assert!((system.a() - direct.a()).amax() < 1e-11 && (system.b() - direct.b()).amax() < 1e-12);
}

/// Test mechanism: a slider-crank with springs.
#[mechanism(derivatives)]
struct SliderCrank {
    r: f64,
    l: f64,
    inertia: f64,
    piston: f64,
    winding: f64,
    stiffness: f64,
    oil: f64,
    #[body(mass = 1, inertia = diagonal(inertia, inertia, inertia))]
    crank: Body,
    #[body(mass = 1.5, inertia = diagonal(0.01, 0.01, 0.01))]
    rod: Body,
    #[body(mass = piston)]
    slider: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(r * x) -> rod, about = z)]
    elbow: Pin,
    #[joint(ground -> slider, along = x)]
    guide: Sleeve,
    #[joint(rod.at(l * x) -> slider, about = z)]
    wrist: Pin,
    #[acts(on = main, stiffness = winding)]
    coil: Spring,
    #[acts(on = guide, stiffness = stiffness)]
    spring: Spring,
    #[acts(on = guide, damping = oil)]
    dashpot: Dashpot,
}

/// Compares with the closed form in the crank angle. With the piston position
/// `x(θ) = r cos θ + √(l² − r² sin² θ)` and the angle `φ(θ)` of the rod, whose centre of mass is at the crank
/// pin: `M = J + m₁ r² + I φ'² + m x'²`, `D = c x'²`, `K = k_θ + k (x'² + x x'')`.
#[test]
fn slider_crank_on_springs_matches_closed_form() {
    let (r, l) = (0.1, 0.25);
    let machine =
        SliderCrank { r, l, inertia: 0.02, piston: 3.0, winding: 20.0, stiffness: 700.0, oil: 25.0 };
    let problem = constrained_equilibrium(&machine).from([0.9, -1.2, 0.3].into());
    let found = problem.find().unwrap();
    let form = problem.second_order_form(&found).unwrap();
    let (s, c) = found.q[0].sin_cos();
    let root = (l * l - r * r * s * s).sqrt();
    let x = r * c + root;
    let first = -r * s - r * r * s * c / root;
    let second = -r * c - r * r * (c * c - s * s) / root - (r * r * s * c).powi(2) / root.powi(3);
    assert!((20.0 * found.q[0] + 700.0 * x * first).abs() < 1e-9 && s.abs() > 0.1, "{found:?}");
    // Derivative of the form's coordinate with respect to the crank angle.
    let per = match form.state_space().unwrap().states()[0].name.as_str() {
        "main" => 1.0,
        "guide" => first,
        "elbow" => -1.0 - r * c / root,
        other => panic!("{other}"),
    };
    let turned = r * c / root;
    let mass = 0.02 + 1.5 * r * r + 0.01 * turned * turned + 3.0 * first * first;
    assert_relatively_close(form.mass[0] * per * per, mass, 1e-10);
    assert_relatively_close(form.damping[0] * per * per, 25.0 * first * first, 1e-10);
    assert_relatively_close(
        form.stiffness[0] * per * per,
        20.0 + 700.0 * (first * first + x * second),
        1e-10,
    );
}

/// Test mechanism: particle in a rotating bowl, with drag from air at rest.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct RotatingBowl {
    mass: f64,
    radius: f64,
    spin: f64,
    air: f64,
    #[frame(ground, z(spin * t))]
    turning: Frame,
    #[body(frame = turning)]
    bowl: Body,
    #[particle(mass = mass)]
    ball: Particle,
    #[joint(bowl -> ball, along = (x, y, z))]
    place: Stage,
    #[constraint(place.z == (place.x * place.x + place.y * place.y) / (2 * radius))]
    surface: Holonomic,
    #[acts(on = ball, value = -air * v(ball / ground / ground))]
    drag: Force,
}

/// Compares the second-order form with the closed form `M = m`, `D = c`, `G = 2 m Ω [[0, −1], [1, 0]]`,
/// `K = m (g / a − Ω²)`, `N = c Ω [[0, −1], [1, 0]]`.
#[test]
fn particle_in_rotating_bowl_has_closed_form() {
    let (mass, radius, spin, air) = (0.4, 0.3, 5.0, 0.7);
    let bowl = RotatingBowl { mass, radius, spin, air };
    let problem = constrained_equilibrium(&bowl).at_time(0.37);
    let form = problem.second_order_form(&problem.find().unwrap()).unwrap();
    let (one, turn) = (DMatrix::<f64>::identity(2, 2), dmatrix![0.0, -1.0; 1.0, 0.0]);
    assert_same_matrix(&form.mass, &(&one * mass), 1e-12);
    assert_same_matrix(&form.damping, &(&one * air), 1e-12);
    assert_same_matrix(&form.gyroscopic, &(&turn * (2.0 * mass * spin)), 1e-12);
    assert_same_matrix(&form.stiffness, &(&one * (mass * (9.81 / radius - spin * spin))), 1e-11);
    assert_same_matrix(&form.circulatory, &(&turn * (air * spin)), 1e-12);
}

/// Test mechanism: knife edge on ice. The force depends on the lateral position, and the edge prevents
/// lateral velocity.
#[mechanism(derivatives)]
struct Skate {
    pull: f64,
    #[body(mass = 1, inertia = diagonal(0.1, 0.1, 0.1))]
    skate: Body,
    #[joint(ground -> skate, along = (x, y), about = z)]
    pose: Planar,
    #[constraint(dot(v(skate / ground / ground), skate.y) = 0)]
    edge: Nonholonomic,
    #[acts(on = skate, value = -pull * dot(r(skate / ground), y) * x)]
    slope: Force,
}

#[test]
fn coordinates_without_velocities_have_no_form() {
    let form_with_pull = |pull: f64| -> Result<SecondOrderForm, Error> {
        let skate = Skate { pull };
        let problem = constrained_equilibrium(&skate).fix(Skate::VELOCITIES);
        problem.second_order_form(&problem.find()?)
    };
    let free = form_with_pull(0.0).unwrap();
    assert_eq!(free.mass.nrows(), 2);
    let error = form_with_pull(3.0).unwrap_err().to_string();
    assert_eq!(
        error,
        "no second-order form: forces depend on `pose.y`, which has no independent speed of its own"
    );
}

//! Checks that functions of loaded mechanisms equal those that the compiler generates as Rust code, and those
//! of the interpreter.

use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork_jit::{Error, Loader, Robot};

macro_rules! both {
    ($name:ident, $($tokens:tt)*) => {
        $($tokens)*

        /// Source text of the declaration above, from which the mechanism is loaded.
        const $name: &str = stringify!($($tokens)*);
    };
}

both! {
    CART_POLE,
    #[mechanism(gravity = -9.81 * y, derivatives)]
    struct CartPole {
        cart_mass: f64,
        pole_mass: f64,
        pole_length: f64,
        #[body(mass = cart_mass)]
        cart: Body,
        #[body(mass = pole_mass, com = pole_length / 2 * y, inertia = rod(pole_mass, pole_length, y))]
        pole: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[joint(cart -> pole, about = z)]
        hinge: Pin,
        #[acts(on = cart, along = x)]
        push: Force,
    }
}

both! {
    SPINNER,
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct Spinner {
        #[body(mass = 2, inertia = diagonal(0.3, 0.2, 0.1))]
        base: Body,
        #[body(mass = 0.5, com = 0.1 * x, inertia = diagonal(0.01, 0.02, 0.03))]
        arm: Body,
        #[joint(ground -> base)]
        free: Free,
        #[joint(base.at(0.2 * x) -> arm, about = y)]
        hinge: Pin,
        #[acts(on = hinge)]
        motor: Torque,
    }
}

both! {
    SLIDER,
    #[mechanism(gravity = -9.81 * y)]
    struct Slider {
        #[body(mass = 1, com = 0.2 * x, inertia = rod(1, 0.4, x))]
        crank: Body,
        #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
        rod: Body,
        #[joint(ground -> crank, about = z)]
        motor: Pin,
        #[joint(crank.at(0.4 * x) -> rod, about = z)]
        knee: Pin,
        #[constraint(0.4 * sin(motor) = -sin(motor + knee))]
        guide: Holonomic,
    }
}

/// Returns `n` reproducible sample values between −0.6 and 0.6.
fn sample_values(seed: usize, n: usize) -> Vec<f64> {
    (0..n).map(|k| 0.6 * ((7 * k + 3 * seed + 1) as f64).sin()).collect()
}

fn assert_close_entries(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= 1e-12 * scale, "{what}: entry {k} is {a} instead of {b}");
    }
}

/// Checks that every compiled function of a robot equals that of an interpreted robot.
fn assert_agrees_with_interpreter(robot: &Robot, oracle: &Robot) -> Result<(), Error> {
    let neutral = robot.neutral()?;
    for f in robot.functions() {
        let lists: Vec<Vec<f64>> = (f.arguments().iter().enumerate())
            .map(|(k, (name, n))| match *name {
                "q" | "from" | "to" => {
                    let q = robot.integrate(neutral.as_slice(), &sample_values(k, robot.nv()));
                    q.map_or(Vec::new(), |q| q.as_slice().to_vec())
                }
                _ => sample_values(k, *n),
            })
            .collect();
        let lists: Vec<&[f64]> = lists.iter().map(Vec::as_slice).collect();
        let found = robot.evaluate(&f, &lists)?;
        assert!(found.iter().all(|x| x.is_finite()), "{} {found:?}", f.name());
        assert_close_entries(&found, &oracle.evaluate(&oracle.function(f.name())?, &lists)?, f.name());
        if cfg!(any(target_arch = "x86_64", target_arch = "aarch64")) {
            assert!(f.compile(), "{} is interpreted", f.name());
        }
    }
    Ok(())
}

#[test]
fn cart_poles_agree_with_generated_rust() -> Result<(), Error> {
    let own = CartPole { cart_mass: 1.2, pole_mass: 0.3, pole_length: 0.8 };
    let set = [("cart_mass", 1.2), ("pole_mass", 0.3), ("pole_length", 0.8)];
    let robot = Loader::text(CART_POLE).load()?.with_parameters(&set)?;
    let (q, v, tau) = ([0.3, -0.7], [0.4, 1.1], [0.2, -0.5]);
    let state: [SVector<f64, 2>; 3] = [q.into(), v.into(), tau.into()];
    let [sq, sv, st] = &state;
    assert_close_entries(robot.mass_matrix(&q)?.as_slice(), own.mass_matrix(sq).as_slice(), "mass matrix");
    assert_close_entries(
        robot.bias_forces(&q, &v)?.as_slice(),
        own.bias_forces(sq, sv).as_slice(),
        "bias forces",
    );
    assert_close_entries(
        robot.forward_dynamics(&q, &v, &tau)?.as_slice(),
        own.forward_dynamics(sq, sv, st).as_slice(),
        "a",
    );
    assert_close_entries(&[robot.kinetic_energy(&q, &v)?], &[own.kinetic_energy(sq, sv)], "kinetic energy");
    let (by_q, by_v, by_tau) = own.forward_dynamics_derivatives(sq, sv, st);
    let found = robot.forward_dynamics_derivatives(&q, &v, &tau)?;
    for (found, own) in found.iter().zip([by_q, by_v, by_tau]) {
        assert_close_entries(found.as_slice(), own.as_slice(), "derivatives");
    }
    let (a, b) = own.linearize(sq, sv, &[0.7].into());
    let [state, input] = robot.linearize(&q, &v, &[0.7])?;
    assert_close_entries(state.as_slice(), a.as_slice(), "the system");
    assert_close_entries(input.as_slice(), b.as_slice(), "the inputs");
    assert_agrees_with_interpreter(
        &robot,
        &Loader::text(CART_POLE).interpreted().load()?.with_parameters(&set)?,
    )
}

#[test]
fn free_bodies_agree_with_generated_rust() -> Result<(), Error> {
    let robot = Loader::text(SPINNER).load()?;
    let q = Spinner.integrate(&Spinner.neutral(), &SVector::from_column_slice(&sample_values(1, 7)));
    let (v, a) = (sample_values(2, 7), sample_values(3, 7));
    let (sv, sa) = (SVector::from_column_slice(&v), SVector::from_column_slice(&a));
    let tau = robot.inverse_dynamics(q.as_slice(), &v, &a)?;
    assert_close_entries(tau.as_slice(), Spinner.inverse_dynamics(&q, &sv, &sa).as_slice(), "forces");
    let there = robot.integrate(q.as_slice(), &v)?;
    assert_close_entries(there.as_slice(), Spinner.integrate(&q, &sv).as_slice(), "integrate");
    assert_close_entries(robot.difference(q.as_slice(), there.as_slice())?.as_slice(), &v, "difference");
    let arm = frame!(Spinner, "arm");
    let placement = robot.frame_placement("arm", q.as_slice())?;
    let own = Spinner.frame_placement(arm, &q);
    assert_close_entries(placement.to_homogeneous().as_slice(), own.to_homogeneous().as_slice(), "placement");
    let own = Spinner.frame_velocity(arm, &q, &sv);
    assert_close_entries(
        robot.frame_velocity("arm", q.as_slice(), &v)?.as_slice(),
        own.as_slice(),
        "velocity",
    );
    let own = Spinner.frame_acceleration(arm, &q, &sv, &sa);
    assert_close_entries(
        robot.frame_acceleration("arm", q.as_slice(), &v, &a)?.as_slice(),
        own.as_slice(),
        "acceleration",
    );
    assert_close_entries(
        robot.frame_jacobian("arm", q.as_slice())?.as_slice(),
        Spinner.frame_jacobian(arm, &q).as_slice(),
        "J",
    );
    assert_agrees_with_interpreter(&robot, &Loader::text(SPINNER).interpreted().load()?)
}

#[test]
fn constrained_accelerations_agree_with_generated_rust() -> Result<(), Error> {
    let robot = Loader::text(SLIDER).load()?;
    let (q, v, tau) = ([0.4, -0.6], [0.5, -0.9], [1.5, 0.0]);
    let found = robot.forward_dynamics(&q, &v, &tau)?;
    let own = Slider.forward_dynamics(&q.into(), &v.into(), &tau.into());
    assert_close_entries(found.as_slice(), own.as_slice(), "accelerations");
    Ok(())
}

/// Checks that copies of a robot share code but have parameters of their own, and that evaluation of many
/// states equals evaluation one by one.
#[test]
fn robots_are_shared_by_threads() -> Result<(), Error> {
    let robot = Loader::text(CART_POLE).load()?;
    let results: Vec<Result<f64, Error>> = std::thread::scope(|scope| {
        let spawn_robot_thread = |k: usize| {
            let robot = robot.clone();
            scope.spawn(move || {
                let length = 1.0 + k as f64;
                let set = [("cart_mass", 1.0), ("pole_mass", 1.0), ("pole_length", length)];
                let robot = robot.with_parameters(&set)?;
                // The inertia about the hinge of a rod: m l² / 3.
                Ok(robot.mass_matrix(&[0.0, 0.0])?[(1, 1)] * 3.0 / length.powi(2))
            })
        };
        let threads: Vec<_> = (0..4).map(spawn_robot_thread).collect();
        threads.into_iter().map(|thread| thread.join().unwrap_or(Ok(f64::NAN))).collect()
    });
    for result in results {
        assert!((result? - 1.0).abs() < 1e-14);
    }
    let robot = robot.with_parameters(&[("cart_mass", 1.0), ("pole_mass", 1.0), ("pole_length", 1.0)])?;
    let f = robot.function("bias_forces")?;
    let (q, v) = ([0.1, 0.2, 0.3, 0.4], [0.5, 0.6]);
    let mut all = [0.0; 4];
    robot.evaluate_many_into(&f, 2, &[&q, &v], &mut all)?;
    assert_close_entries(&all[2..], &robot.evaluate(&f, &[&q[2..], &v])?, "the second state");
    Ok(())
}

/// Checks that mechanisms can be loaded repeatedly.
#[test]
fn robots_are_loaded_again_and_again() -> Result<(), Error> {
    for _ in 0..20 {
        let robot = Loader::text(SPINNER).load()?;
        assert!(robot.potential_energy(robot.neutral()?.as_slice())?.abs() < 1e-12);
    }
    Ok(())
}

#[test]
fn load_errors_report_their_cause() -> Result<(), Error> {
    let told =
        |result: Result<Robot, Error>| result.map(|_| String::new()).map_err(|error| error.to_string());
    for (text, part) in [
        ("struct A {", "line 1"),
        ("struct A {}", "no struct with `#[mechanism]`"),
        ("#[mechanism] struct A { b: Body }", "`b`"),
        ("#[mechanism] struct A; #[mechanism] struct B;", "choose one of A, B"),
        ("#[mechanism(urdf = \"missing.urdf\")] struct A;", "missing.urdf"),
    ] {
        let found = told(linkwork_jit::declare(text));
        assert!(found.as_ref().is_err_and(|message| message.contains(part)), "{text}: {found:?}");
    }
    assert!(matches!(linkwork_jit::load("missing.urdf"), Err(Error::File { .. })));
    assert!(matches!(linkwork_jit::load("."), Err(Error::File { .. })));
    assert!(matches!(Loader::text(SPINNER).options("derivatives(").load(), Err(Error::Syntax(_))));

    let mut robot = Loader::text(CART_POLE).load()?;
    assert_eq!(
        robot.mass_matrix(&[0.0, 0.0]),
        Err(Error::Missing(["`cart_mass`", "`pole_mass`", "`pole_length`"].map(str::to_string).to_vec()))
    );
    let error = robot.set_parameter("cart_mas", 1.0).map_err(|error| error.to_string());
    assert_eq!(error, Err("no parameter `cart_mas`; did you mean `cart_mass`?".to_string()));
    assert!(matches!(robot.set_parameter("cart_mass", f64::NAN), Err(Error::Value(_))));
    robot.set_parameters(&[1.0, -1.0, 1.0])?;
    let error = robot.validate().map_err(|error| error.to_string());
    assert!(
        error.as_ref().is_err_and(|text| text.contains("`pole`") && text.contains("negative")),
        "{error:?}"
    );
    robot.set_parameter("pole_mass", 1.0)?;
    robot.validate()?;
    assert!(matches!(robot.mass_matrix(&[0.0]), Err(Error::Length { expected: 2, found: 1, .. })));
    let f = robot.function("mass_matrix")?;
    assert!(matches!(robot.evaluate(&f, &[]), Err(Error::Arguments { found: 0, .. })));
    assert!(matches!(robot.evaluate_into(&f, &[&[0.0, 0.0]], &mut [0.0; 3]), Err(Error::Length { .. })));
    assert!(matches!(robot.function("mass_matrx"), Err(Error::Unknown { .. })));
    assert!(matches!(robot.frame_placement("hand", &[0.0, 0.0]), Err(Error::Unknown { kind: "frame", .. })));
    let other = Loader::text(SPINNER).load()?;
    assert!(matches!(other.evaluate(&f, &[&[0.0, 0.0]]), Err(Error::OtherMechanism(_))));
    // What is not a number goes through: the caller decides.
    assert!(robot.mass_matrix(&[0.0, f64::NAN])?[(0, 1)].is_nan());
    Ok(())
}

/// Checks names, units, limits and documentation of a robot that is loaded from a file.
#[test]
fn robots_of_files_have_names_and_limits() -> Result<(), Error> {
    let urdf = r#"<robot name="r"><link name="a"/><link name="b"><inertial><mass value="2"/>
        <origin xyz="0 0 0.5"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
        <limit lower="-1" upper="2" velocity="3" effort="4"/></joint></robot>"#;
    let path = std::env::temp_dir().join(format!("linkwork_jit_{}.urdf", std::process::id()));
    std::fs::write(&path, urdf).map_err(|error| Error::Internal(error.to_string()))?;
    let robot = linkwork_jit::load(&path);
    let parameters = Loader::file(&path).options("parameters = inertial(\"b\")").load();
    std::fs::remove_file(&path).map_err(|error| Error::Internal(error.to_string()))?;
    let (robot, parameters) = (robot?, parameters?);
    assert_eq!((robot.velocities()[0].name.as_str(), robot.velocities()[0].unit.as_str()), ("j", "rad/s"));
    let limit = &robot.limits()?[0];
    assert_eq!((limit.lower, limit.upper, limit.velocity, limit.effort), (-1.0, 2.0, 3.0, 4.0));
    // A pendulum: m g l sin(q) with a level arm of 0.5 m; the mass is upright at zero.
    let f = robot.inverse_dynamics(&[0.3], &[0.0], &[0.0])?;
    assert_close_entries(f.as_slice(), &[-2.0 * 9.81 * 0.5 * 0.3_f64.sin()], "the torque");
    assert!(robot.frames().iter().any(|name| name == "b"));
    assert!(robot.function("inverse_dynamics")?.documentation().contains("orces"));
    let mass = parameters.parameters().iter().position(|p| p.name.ends_with("mass"));
    let mass = mass.map(|k| parameters.parameter_values()[k]);
    assert_eq!(mass, Some(2.0));
    Ok(())
}

/// Free bodies, and joints with a `ref`, begin where the file places them: all frames are those of the file
/// without joints, whose bodies are fixed in the world.
#[test]
fn robots_begin_in_the_pose_of_their_file() -> Result<(), Error> {
    let scene = |[free, hinge, slide]: [&str; 3]| {
        format!(
            "<mujoco><compiler autolimits='true'/><worldbody><frame pos='0 0 1' euler='0 0 90'><body \
             name='crate' pos='.3 -.2 .5' euler='30 -100 170'>{free}<geom size='.1'/></body></frame>\
             <body name='ball' pos='1 2 3' quat='0 1 0 0'>{free}<geom size='.1'/>\
             <body name='lid' pos='0 .1 .2' euler='0 20 0'>{hinge}<geom size='.1' pos='.2 0 0'/>\
             </body></body>\
             <body name='block'>{slide}<geom size='.1'/></body>\
             <body name='origin'>{free}<geom size='.1'/></body>\
             </worldbody></mujoco>"
        )
    };
    let load_from_temporary_file = |test: &str, text: String| {
        let path = std::env::temp_dir().join(format!("linkwork-pose-{test}-{}.xml", std::process::id()));
        std::fs::write(&path, text).expect("a temporary file");
        let robot = Loader::file(&path).load();
        std::fs::remove_file(&path).expect("the file is there");
        robot
    };
    let moving = load_from_temporary_file(
        "moving",
        scene([
            "<freejoint/>",
            "<joint name='swing' axis='0 1 .5' pos='.1 0 0' ref='35'/>",
            "<joint name='lift' type='slide' axis='0 0 1' ref='.4'/>",
        ]),
    )?;
    let q = moving.initial_configuration()?;
    // The frame rotates the position of the crate by a right angle about z.
    assert!([0.2, 0.3, 1.5].iter().zip(&q).all(|(expected, found)| (expected - found).abs() < 1e-15), "{q}");
    let fixed = load_from_temporary_file("fixed", scene([""; 3]))?;
    for frame in ["crate", "ball", "lid", "block", "origin"] {
        let there = fixed.frame_placement(frame, &[])?;
        let here = moving.frame_placement(frame, q.as_slice())?;
        assert!((there.to_homogeneous() - here.to_homogeneous()).amax() < 1e-14, "{frame}: {here} {there}");
    }
    // Simulations begin there, too.
    let start = moving.simulate().duration(0.0).finish()?;
    assert_eq!(start.q, q.as_slice());
    // The free base of an SDF file has the pose that it has if it is fixed.
    let file = std::env::temp_dir().join(format!("linkwork-pose-{}.sdf", std::process::id()));
    let text = "<sdf version='1.9'><model name='m'><pose>.4 -.3 2 .1 -.7 2.6</pose><link name='base'><pose>\
                .1 0 .2 0 0 .5</pose></link><link name='arm'><pose>0 .5 0 1 0 0</pose></link><joint \
                name='hinge' type='revolute'><parent>base</parent><child>arm</child><axis><xyz>1 0 \
                0</xyz></axis></joint>\
                </model></sdf>";
    std::fs::write(&file, text).expect("a temporary file");
    let [free, fixed] =
        ["free", "fixed"].map(|base| Loader::file(&file).options(&format!("base = {base}")).load());
    std::fs::remove_file(&file).expect("the file is there");
    let (free, fixed) = (free?, fixed?);
    let q = free.initial_configuration()?;
    for frame in ["base", "arm"] {
        let there = fixed.frame_placement(frame, &[0.0])?;
        let here = free.frame_placement(frame, q.as_slice())?;
        assert!((there.to_homogeneous() - here.to_homogeneous()).amax() < 1e-14, "{frame}: {here} {there}");
    }
    // A mechanism of another source begins in its neutral configuration.
    let cart = Loader::text(CART_POLE).load()?.with_parameters(&[
        ("cart_mass", 1.0),
        ("pole_mass", 1.0),
        ("pole_length", 1.0),
    ])?;
    assert_eq!(cart.initial_configuration()?, cart.neutral()?);
    Ok(())
}

//! Checks that motions of loaded mechanisms equal those of generated Rust code, and closed-form solutions.

use linkwork::contact;
use linkwork::integrate::Hooks;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork_jit::{Error, Inputs, Loader, Method, Robot};

macro_rules! both {
    ($name:ident, $($tokens:tt)*) => {
        $($tokens)*

        /// Source text of the declaration above, from which the mechanism is loaded.
        const $name: &str = stringify!($($tokens)*);
    };
}

both! {
    SLIDER,
    #[mechanism(gravity = -9.81 * y, derivatives)]
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
        #[acts(on = motor)]
        drive: Torque,
    }
}

both! {
    BOX,
    #[mechanism(gravity = -9.81 * z)]
    struct Box {
        #[body(mass = 2, inertia = cuboid(2, 0.4, 0.3, 0.2))]
        case: Body,
        #[joint(ground -> case)]
        pose: Free,
        #[contact(case.cuboid(0.4, 0.3, 0.2), ground.plane(z), friction = 0.4, restitution = 0.3)]
        floor: Contact,
    }
}

both! {
    WEDGE,
    #[mechanism(gravity = -9.81 * y)]
    struct SlippingBall {
        #[body(mass = 1, inertia = sphere(1, 0.1))]
        ball: Body,
        #[joint(ground -> ball, about = z)]
        pose: Planar,
        #[constraint(slips(ball.sphere(0.1), ground.plane(y)), friction = 0.3, speed = 0.0001)]
        floor: Slipping,
    }
}

const N: usize = 8;

fn padded_vector<const K: usize>(x: &[f64]) -> SVector<f64, K> {
    SVector::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0))
}

#[track_caller]
fn assert_close_entries(found: &[f64], expected: &[f64], tolerance: f64) {
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "entry {k} is {a} instead of {b}");
    }
}

/// Checks accelerations with multipliers, also in a singular configuration, projections, impulses,
/// derivatives and assembly against generated Rust code.
#[test]
fn constraints_agree_with_generated_rust() -> Result<(), std::boxed::Box<dyn std::error::Error>> {
    let robot = Loader::text(SLIDER).load()?;
    let m = robot.padded::<N, N, N>()?;
    let tau = [1.5, 0.0];
    for (q, v) in [([0.4, -0.6], [0.5, -0.9]), ([0.0, 0.0], [0.0, 0.0])] {
        let (sq, sv, st) = (q.into(), v.into(), tau.into());
        let (pq, pv, pt) = (padded_vector::<N>(&q), padded_vector::<N>(&v), padded_vector::<N>(&tau));
        let (a, lambda) = Constrained::<N, N, N, N, N>::constrained_dynamics(&m, 0.0, &pq, &pv, &pt);
        let (own, multipliers) = Slider.constrained_dynamics(&sq, &sv, &st);
        assert_close_entries(a.as_slice(), own.as_slice(), 1e-12);
        assert_close_entries(lambda.as_slice(), multipliers.as_slice(), 1e-12);
        assert_close_entries(robot.forward_dynamics(&q, &v, &tau)?.as_slice(), own.as_slice(), 1e-12);
        let found = Hooks::project(&m, 0.0, &pq, &pv)?;
        let own = Hooks::project(&Slider, 0.0, &sq, &sv)?;
        assert_close_entries(found.0.as_slice(), own.0.as_slice(), 1e-12);
        assert_close_entries(found.1.as_slice(), own.1.as_slice(), 1e-12);
        let found = Hooks::velocity_change_by_impulse(&m, 0.0, &found.0, &found.1, 1e-3, &pt);
        assert_close_entries(
            found.as_slice(),
            Hooks::velocity_change_by_impulse(&Slider, 0.0, &own.0, &own.1, 1e-3, &st).as_slice(),
            1e-12,
        );
        let (by_q, by_v, by_tau) = Slider.forward_dynamics_derivatives(&sq, &sv, &st);
        let found = robot.forward_dynamics_derivatives(&q, &v, &tau)?;
        for (found, own) in found.iter().zip([by_q, by_v, by_tau]) {
            assert_close_entries(found.as_slice(), own.as_slice(), 1e-10);
        }
    }
    let guess = [0.3, 0.2];
    let own = Slider.assemble(&guess.into(), &[0])?;
    assert_close_entries(robot.assemble(&guess, &[0])?.as_slice(), own.as_slice(), 1e-12);
    assert_eq!(robot.assembly_mode(own.as_slice(), &[0])?, Slider.assembly_mode(&own, &[0]));
    let v = Slider.complete_velocity(&own, &[2.0, 0.0].into(), &[0])?;
    assert_close_entries(
        robot.complete_velocity(own.as_slice(), &[2.0, 0.0], &[0])?.as_slice(),
        v.as_slice(),
        1e-12,
    );
    let far = robot.assemble(&[0.3, 0.2], &[0, 1]);
    assert!(far.as_ref().is_err_and(|error| error.to_string().contains("`guide`")), "{far:?}");
    assert!(robot.assemble(&guess, &[2]).is_err_and(|error| error.to_string().contains("velocity 2")));
    Ok(())
}

/// Checks that every integration method computes the motion of generated Rust code.
#[test]
fn motions_under_constraints_agree_with_generated_rust() -> Result<(), Error> {
    let robot = Loader::text(SLIDER).load()?;
    let q = Slider.assemble(&[0.4, 0.0].into(), &[0]).expect("it can be assembled");
    let v = Slider.complete_velocity(&q, &[1.0, 0.0].into(), &[0]).expect("it moves");
    let simulate_with_method = |method: Method| {
        let run = robot.simulate().from(q.as_slice(), v.as_slice()).inputs(Inputs::Constant(&[2.0]));
        run.method(method).duration(0.5).sample_every(0.25).run()
    };
    let own = simulate(&Slider).from(q, v).inputs(|_, _, _| [2.0].into()).duration(0.5);
    let ends = [
        (Method::DormandPrince(1e-9), own.clone().finish(), 1e-12),
        (Method::Rk4(0.01), own.clone().method(Rk4::step(0.01)).finish(), 1e-12),
        (Method::ImplicitMidpoint(0.01), own.clone().method(ImplicitMidpoint::step(0.01)).finish(), 1e-10),
        (Method::Rodas(1e-8), own.clone().method(Rodas::new().tolerance(1e-8, 1e-8)).finish(), 1e-5),
    ];
    for (method, end, tolerance) in ends {
        let tolerance: f64 = tolerance;
        let end = end.expect("it moves");
        let run = simulate_with_method(method)?;
        assert_eq!(run.samples.iter().map(|sample| sample.t).collect::<Vec<_>>(), [0.0, 0.25, 0.5]);
        let last = &run.samples[2];
        assert_close_entries(&last.q, end.q.as_slice(), tolerance.max(1e-7));
        assert_close_entries(&last.v, end.v.as_slice(), tolerance.max(1e-7));
        assert_eq!(last.u, [2.0]);
    }
    Ok(())
}

/// Checks a box that tumbles to rest, with time stepping and with located events, against generated Rust
/// code.
#[test]
fn contacts_agree_with_generated_rust() -> Result<(), Error> {
    let robot = Loader::text(BOX).load()?;
    let mut q = Box.neutral();
    q[2] = 0.6;
    let v: SVector<f64, 6> = [0.4, 0.1, 0.0, 1.0, 2.0, 0.5].into();
    let own = simulate(&Box).from(q, v).duration(0.8);
    let steps = own.clone().method(TimeStepping::step(2e-3)).finish().expect("it moves");
    let begin = q;
    let run =
        |method: Method| robot.simulate().from(begin.as_slice(), v.as_slice()).duration(0.8).method(method);
    let end = run(Method::TimeStepping(2e-3)).finish()?;
    assert_close_entries(&end.q, steps.q.as_slice(), 1e-9);
    assert_close_entries(&end.v, steps.v.as_slice(), 1e-9);
    let method = TimeStepping::step(2e-3).leapfrog();
    let steps = own.clone().method(method).finish().expect("it moves");
    let end = run(Method::from_name("time_stepping_leapfrog", Some(2e-3))?).finish()?;
    assert_close_entries(&end.q, steps.q.as_slice(), 1e-9);
    assert_close_entries(&end.v, steps.v.as_slice(), 1e-9);
    let events = own.method(EventDriven::new().tolerance(1e-9, 1e-9)).finish().expect("it moves");
    let end = run(Method::EventDriven(1e-9)).finish()?;
    assert_close_entries(&end.q, events.q.as_slice(), 1e-6);
    assert_close_entries(&end.v, events.v.as_slice(), 1e-6);
    // Two bodies of code for any mechanism with contacts.
    let m = robot.padded_contacts::<N, N, N, N, 24>()?;
    q[2] = 0.1;
    let own = contact::acting(&Box, 0.0, &q, &SVector::zeros(), &SVector::zeros()).expect("forces");
    let found = contact::acting(&m, 0.0, &padded_vector(q.as_slice()), &SVector::zeros(), &SVector::zeros());
    assert_close_entries(found.expect("forces").as_slice(), own.as_slice(), 1e-6);
    let refused = run(Method::Rk4(1e-3)).finish();
    assert!(refused.is_err_and(|error| error.to_string().contains("choose the method `time_stepping`")));
    q[2] = 0.05;
    let overlap = robot.simulate().from(q.as_slice(), &[0.0; 6]).duration(0.1).finish();
    let error = overlap.map_err(|error| error.to_string());
    assert!(
        error.as_ref().is_err_and(|text| text.contains("overlap by 0.05") && text.contains("`floor")),
        "{error:?}"
    );
    Ok(())
}

/// Checks that a ball that slides on a floor is decelerated by `μ g`, until it rolls after `2 v / (7 μ g)`.
#[test]
fn sliding_constraints_have_friction() -> Result<(), Error> {
    let robot = Loader::text(WEDGE).load()?;
    let (q, v, mu_g) = ([0.0, 0.1, 0.0], [2.0, 0.0, 0.0], 0.3 * 9.81);
    let a = robot.forward_dynamics(&q, &v, &[0.0; 3])?;
    let own = SlippingBall.forward_dynamics(&q.into(), &v.into(), &SVector::zeros());
    assert_close_entries(a.as_slice(), own.as_slice(), 1e-12);
    assert_close_entries(&a.as_slice()[..2], &[-mu_g, 0.0], 1e-6);
    let end = robot.simulate().from(&q, &v).duration(0.1).finish()?;
    assert_close_entries(&end.q[..2], &[0.2 - mu_g * 0.005, 0.1], 1e-6);
    let end = robot.simulate().from(&q, &v).method(Method::Rodas(1e-6)).duration(0.5).finish()?;
    assert_close_entries(&[end.v[0], end.v[2]], &[2.0 * 5.0 / 7.0, -20.0 * 5.0 / 7.0], 1e-3);
    Ok(())
}

/// Checks motions with declared generalized speeds, first-order states and explicit time against closed
/// forms.
#[test]
fn speeds_states_and_time_are_integrated() -> Result<(), Error> {
    let rotor = linkwork_jit::declare(
        "#[mechanism]
        struct Rotor {
            #[body(mass = 1, inertia = diagonal(2, 3, 4))]
            rotor: Body,
            #[joint(ground -> rotor, about = z)]
            angle: Pin,
            #[speed(4 * rate(angle))]
            fast: Speed,
        }",
    )?;
    let end = rotor.simulate().from(&[0.0], &[3.0]).duration(2.0).finish()?;
    assert_close_entries(&[end.q[0], end.v[0]], &[1.5, 3.0], 1e-9);
    let sled = linkwork_jit::declare(
        "#[mechanism]
        struct Sled {
            lag: f64,
            throttle: Input,
            #[state(rate = (throttle - thrust) / lag)]
            thrust: State,
            #[body(mass = 2)]
            sled: Body,
            #[joint(ground -> sled, along = x)]
            rail: Sleeve,
            #[acts(on = rail, value = thrust)]
            engine: Force,
        }",
    )?;
    let sled = sled.with_parameters(&[("lag", 0.5)])?;
    let late = 1.0 - (-4.0_f64).exp();
    for (v, start) in [(&[0.0][..], 0.0), (&[0.0, 2.0], 2.0)] {
        let run = sled.simulate().from(&[0.0], v).inputs(Inputs::Constant(&[6.0])).duration(2.0);
        let end = run.finish()?;
        let velocity = (12.0 - (6.0 - start) * 0.5 * late) / 2.0;
        assert_close_entries(&end.v, &[velocity, start + (6.0 - start) * late], 1e-8);
    }
    // A cart that is pushed by a force of time: sin(3 t) N on 2 kg.
    let cart = linkwork_jit::declare(
        "#[mechanism]
        struct Cart {
            #[body(mass = 2)]
            cart: Body,
            #[joint(ground -> cart, along = x)]
            rail: Sleeve,
            #[acts(on = rail, value = sin(3 * t))]
            push: Force,
        }",
    )?;
    let end = cart.simulate().start_at(1.0).from(&[0.0], &[0.0]).duration(1.5).finish()?;
    assert_close_entries(&end.v, &[(3.0_f64.cos() - 7.5_f64.cos()) / 6.0], 1e-9);
    Ok(())
}

const CART: &str = "#[mechanism]
    struct Cart {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail)]
        push: Force,
    }";

/// Checks inputs of all kinds, with jumps, and a controller that fails.
#[test]
fn inputs_are_followed_exactly() -> Result<(), Error> {
    let cart = Loader::text(CART).load()?;
    fn simulate_pushed_cart(cart: &Robot, inputs: Inputs<'_>) -> Result<linkwork_jit::Sample, Error> {
        cart.simulate().from(&[0.0], &[0.0]).inputs(inputs).duration(3.0).finish()
    }
    // Up to 2 N within 1 s, a jump to −1 N, constant after 2 s.
    let (times, values) = ([0.0, 1.0, 1.0, 2.0], [0.0, 2.0, -1.0, 1.0]);
    let end = simulate_pushed_cart(&cart, Inputs::Samples { times: &times, values: &values })?;
    assert_close_entries(&[end.v[0], end.u[0]], &[1.0 + 0.0 + 1.0, 1.0], 1e-12);
    let mut calls = 0;
    let mut ramp_controller = |t: f64, _: &[f64], _: &[f64], u: &mut [f64]| {
        calls += 1;
        u[0] = t;
        Ok(())
    };
    assert_close_entries(
        &simulate_pushed_cart(&cart, Inputs::Sampled(1.0, &mut ramp_controller))?.v,
        &[3.0],
        1e-12,
    );
    assert!((3..=4).contains(&calls));
    let mut damping_controller = |_: f64, _: &[f64], v: &[f64], u: &mut [f64]| {
        u[0] = 1.0 - v[0];
        Ok(())
    };
    assert_close_entries(
        &simulate_pushed_cart(&cart, Inputs::Function(&mut damping_controller))?.v,
        &[1.0 - (-3.0_f64).exp()],
        1e-8,
    );
    let mut failing_controller = |t: f64, _: &[f64], _: &[f64], _: &mut [f64]| match t < 1.0 {
        true => Ok(()),
        false => Err("no more".to_string()),
    };
    assert_eq!(
        simulate_pushed_cart(&cart, Inputs::Function(&mut failing_controller)).map(|_| ()),
        Err(Error::Value("no more".to_string()))
    );
    let wrong = simulate_pushed_cart(&cart, Inputs::Constant(&[1.0, 2.0]));
    assert!(matches!(wrong, Err(Error::Length { expected: 1, found: 2, .. })));
    let backwards = simulate_pushed_cart(&cart, Inputs::Samples { times: &[1.0, 0.0], values: &[0.0, 0.0] });
    assert!(matches!(backwards, Err(Error::Value(_))));
    Ok(())
}

/// Checks an overdamped oscillator: the implicit method takes over, and the motion has the closed form.
#[test]
fn stiff_motions_are_integrated_by_an_implicit_method() -> Result<(), Error> {
    let (fast, slow) = (1e5, 2.0);
    let text = format!(
        "#[mechanism]
        struct Cart {{
            #[body(mass = 1)]
            cart: Body,
            #[joint(ground -> cart, along = x)]
            rail: Sleeve,
            #[acts(on = rail, stiffness = {})]
            spring: Spring,
            #[acts(on = rail, damping = {})]
            damper: Dashpot,
        }}",
        fast * slow,
        fast + slow
    );
    let cart: Robot = linkwork_jit::declare(&text)?;
    let run = cart.simulate().from(&[1.0], &[0.0]).method(Method::Automatic(1e-9));
    let run = run.duration(2.0).sample_every(0.5).run()?;
    assert!(run.stiff_from.is_some_and(|t| t < 0.5), "{:?}", run.stiff_from);
    for sample in &run.samples {
        let exact = (fast * (-slow * sample.t).exp() - slow * (-fast * sample.t).exp()) / (fast - slow);
        assert_close_entries(&sample.q, &[exact], 1e-7);
    }
    Ok(())
}

//! Balances two poles in series on a cart with a linear-quadratic regulator from generated derivatives, and
//! determines its region of attraction.
//!
//! ```text
//! cargo run --release --example lqr_double_pendulum -p linkwork-models
//! ```

mod controller;
#[path = "../regulator/mod.rs"]
mod regulator;

use controller::{Cart, Regulator, State, force_on_cart, quadratic_costs};
use linkwork::discrete;
use linkwork::optimal::Value;
use linkwork::prelude::*;
use regulator::linear_quadratic_regulator;

/// Period of the cart's controller, s.
const PERIOD: f64 = 0.005;

/// Final state of a run that starts with inclined poles, and its costs.
struct BalancingRun {
    q: State,
    v: State,
    strongest: f64,
    costs: f64,
}

/// Simulates the controlled cart for some seconds from rest, with the poles at these angles.
fn simulate_from_angles(
    regulator: &Regulator,
    lower: f64,
    upper: f64,
    seconds: f64,
) -> Result<BalancingRun, Error> {
    let (cart, method, rate) = (Cart {}, Rk4::step(PERIOD), quadratic_costs());
    // The angle of the upper hinge is relative to the lower pole.
    let (mut q, mut v) = (State::from([0.0, lower, upper - lower]), State::zeros());
    let (mut strongest, mut costs) = (0.0_f64, 0.0);
    for _ in 0..(seconds / PERIOD) as usize {
        let push = force_on_cart(regulator, &q, &v);
        strongest = strongest.max(push.abs());
        costs += (q.dot(&(rate.qq * q)) + v.dot(&(rate.vv * v)) + push * rate.uu[0] * push) / 2.0;
        (q, v) = discrete::step(&cart, &method, 0.0, &q, &v, &[push].into())?;
        if q[1].abs() > 1.5 {
            break; // The poles lie on the rail.
        }
    }
    Ok(BalancingRun { q, v, strongest, costs })
}

/// Prints the runs from three initial states, and compares their costs with the predicted ones.
fn print_three_runs(regulator: &Regulator, to_go: &Value<f64, { Cart::NV }>) -> Result<(), Error> {
    println!("lower, rad   upper, rad   strongest push, N   costs   promised   left after 6 s");
    for (lower, upper) in [(0.01, 0.0), (0.1, 0.1), (0.2, -0.05)] {
        let BalancingRun { q, v, strongest, costs } = simulate_from_angles(regulator, lower, upper, 6.0)?;
        let promised = to_go.at(&[0.0, lower, upper - lower].into(), &State::zeros());
        let left = q.amax().max(v.amax());
        println!("{lower:10.2} {upper:12.2} {strongest:19.2} {costs:7.3} {promised:10.3} {left:16.1e}");
        assert!(left < 2e-3, "the poles stand, and the cart is back");
        // The prediction is that of the linear system without a force limit: it holds for small angles while
        // the motor is strong enough.
        let kept = (costs / promised - 1.0).abs() < 0.01;
        assert!(kept || strongest == 30.0, "{costs} is about {promised}");
    }
    Ok(())
}

/// Prints the angles from which the poles return, up to 0.6 rad to each side, and returns the table row by
/// row.
fn print_basin_of_attraction(regulator: &Regulator) -> Result<[[bool; 13]; 13], Error> {
    let mut caught = [[false; 13]; 13];
    println!(
        "\nfrom where it catches the poles (+): lower pole from −0.6 to 0.6 rad to the right, upper one \
         upwards"
    );
    for (i, row) in caught.iter_mut().enumerate().rev() {
        for (j, caught) in row.iter_mut().enumerate() {
            let [upper, lower] = [i, j].map(|k| 0.1 * (k as f64 - 6.0));
            let end = simulate_from_angles(regulator, lower, upper, 4.0)?;
            *caught = end.q.rows(1, 2).amax() < 0.05;
            print!(" {}", if *caught { '+' } else { '·' });
        }
        println!();
    }
    Ok(caught)
}

fn main() -> Result<(), Error> {
    let (upright, still) = (State::zeros(), [0.0].into());
    let found =
        linear_quadratic_regulator(&Cart {}, &Rk4::step(PERIOD), &upright, &still, &quadratic_costs());
    let (regulator, to_go) = found.expect("a push on the cart can keep both poles upright");
    println!("push = {:.2?} · q + {:.2?} · v\n", regulator.by_q.as_slice(), regulator.by_v.as_slice());
    print_three_runs(&regulator, &to_go)?;

    let caught = print_basin_of_attraction(&regulator)?;
    // The table is symmetric; small angles return, large ones do not.
    for (i, row) in caught.iter().enumerate() {
        for (j, &caught_here) in row.iter().enumerate() {
            assert_eq!(caught_here, caught[12 - i][12 - j], "the mirrored poles end alike");
        }
    }
    assert!((5..8).all(|i| (5..8).all(|j| caught[i][j])), "0.1 rad of either pole come back");
    assert!(!caught[12][0] && !caught[0][12], "a pole that leans by 0.6 rad against the other does not");
    Ok(())
}

#[test]
fn regulator_balances_both_poles() -> Result<(), Error> {
    main()
}

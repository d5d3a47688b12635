//! Backward recursion of optimal control: compared with dense linear algebra, and used in differential
//! dynamic programming, whose iterations converge quadratically.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::optimal::{
    EmptyRange, Indefinite, InputLimits, Policy, Quadratic, Value, backward, backward_within,
};
use linkwork::prelude::*;
use linkwork::{SecondDerivatives, discrete};
use support::random::Random;

/// Two links in a vertical plane with a motor at the shoulder only.
#[mechanism(gravity = -9.81 * y, second_derivatives)]
struct Pendubot {
    #[body(mass = 0.6, com = -0.3 * y, inertia = diagonal(0.02, 0.01, 0.02))]
    upper: Body,
    #[body(mass = 0.4, com = -0.25 * y, inertia = diagonal(0.01, 0.01, 0.01))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-0.6 * y) -> lower, about = z)]
    elbow: Pin,
    #[acts(on = shoulder)]
    motor: Torque,
}

/// Flying body on which two input forces act along its z axis.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct Flyer {
    #[body(mass = 1.2, com = 0.02 * z, inertia = diagonal(0.01, 0.012, 0.02))]
    frame: Body,
    #[joint(ground -> frame)]
    flight: Free,
    #[acts(on = frame.at(0.2 * x), along = frame.z)]
    front: Force,
    #[acts(on = frame.at(-0.2 * x + 0.1 * y), along = frame.z)]
    back: Force,
}

fn random_positive_definite<const N: usize>(random: &mut Random) -> SMatrix<f64, N, N> {
    let m = SMatrix::<f64, N, N>::from_fn(|_, _| random.uniform_number(1.0));
    m * m.transpose() + SMatrix::identity() * 0.1
}

/// The recursion on blocks gives the results of Riccati's equation with dense matrices.
#[test]
fn block_recursion_satisfies_riccatis_equation() {
    let mut random = Random::new(1);
    let m = Flyer {};
    let q = m.integrate(&Flyer::neutral(&m), &random.random_vector(1.0));
    let (v, u) = (random.random_vector(1.0), random.random_vector(3.0));
    let steps = [
        discrete::transition(&m, &Rk4::step(0.1), 0.0, &q, &v, &u).expect("it moves"),
        discrete::transition(&m, &SemiImplicitEuler::step(0.1), 0.0, &q, &v, &u).expect("it moves"),
    ];
    let (s, c, r) =
        (random_positive_definite::<12>(&mut random), random_positive_definite::<14>(&mut random), 0.3);
    let (g, w) = (random.random_vector::<14>(1.0), random.random_vector::<12>(1.0));
    let diagonal_block =
        |m: &SMatrix<f64, 14, 14>, i: usize, j: usize| m.fixed_view::<6, 6>(6 * i, 6 * j).into_owned();
    let mixed_block = |i: usize| c.fixed_view::<6, 2>(6 * i, 12).into_owned();
    let cost = Quadratic {
        q: g.fixed_rows::<6>(0).into_owned(),
        v: g.fixed_rows::<6>(6).into_owned(),
        u: g.fixed_rows::<2>(12).into_owned(),
        qq: diagonal_block(&c, 0, 0),
        qv: diagonal_block(&c, 0, 1),
        vv: diagonal_block(&c, 1, 1),
        qu: mixed_block(0),
        vu: mixed_block(1),
        uu: c.fixed_view::<2, 2>(12, 12).into_owned(),
    };
    let block_of_second_derivatives = |i: usize, j: usize| s.fixed_view::<6, 6>(6 * i, 6 * j).into_owned();
    let after = Value {
        q: w.fixed_rows::<6>(0).into_owned(),
        v: w.fixed_rows::<6>(6).into_owned(),
        qq: block_of_second_derivatives(0, 0),
        qv: block_of_second_derivatives(0, 1),
        vv: block_of_second_derivatives(1, 1),
    };
    for (step, r) in steps.iter().flat_map(|step| [(step, 0.0), (step, r)]) {
        let (a, b) = (step.a::<12>(), step.b::<12>());
        let (policy, found) = backward(step, &cost, &after, r).expect("it is convex");
        let xx = c.fixed_view::<12, 12>(0, 0) + a.transpose() * s * a;
        let ux = c.fixed_view::<2, 12>(12, 0) + b.transpose() * s * a;
        let uu = c.fixed_view::<2, 2>(12, 12) + b.transpose() * s * b;
        let (x, du) = (g.fixed_rows::<12>(0) + a.transpose() * w, g.fixed_rows::<2>(12) + b.transpose() * w);
        let inverse = (uu + SMatrix::<f64, 2, 2>::identity() * r).try_inverse().expect("it is positive");
        let (k, gain) = (-inverse * du, -inverse * ux);
        let scale = xx.amax();
        assert!((policy.change - k).amax() < 1e-12 * k.amax());
        assert!((policy.by_q - gain.fixed_view::<2, 6>(0, 0)).amax() < 1e-12 * gain.amax());
        assert!((policy.by_v - gain.fixed_view::<2, 6>(0, 6)).amax() < 1e-12 * gain.amax());
        assert!((policy.expected[0] - du.dot(&k)).abs() < 1e-12 * du.dot(&k).abs());
        assert!((policy.expected[1] - 0.5 * k.dot(&(uu * k))).abs() < 1e-12 * du.dot(&k).abs());
        // Cost-to-go under any policy with this gain and change of inputs.
        let to_go = xx + gain.transpose() * uu * gain + gain.transpose() * ux + ux.transpose() * gain;
        let slope = x + gain.transpose() * (uu * k + du) + ux.transpose() * k;
        assert!((found.qq - to_go.fixed_view::<6, 6>(0, 0)).amax() < 1e-12 * scale);
        assert!((found.qv - to_go.fixed_view::<6, 6>(0, 6)).amax() < 1e-12 * scale);
        assert!((found.vv - to_go.fixed_view::<6, 6>(6, 6)).amax() < 1e-12 * scale);
        assert!((found.q - slope.fixed_rows::<6>(0)).amax() < 1e-12 * scale);
        assert!((found.v - slope.fixed_rows::<6>(6)).amax() < 1e-12 * scale);
    }
}

/// Flying body with a hinged arm. Displacements of its pose are in rotating axes, that of the hinge is a
/// plain difference.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct Flapper {
    #[body(mass = 1.2, com = 0.02 * z, inertia = diagonal(0.01, 0.012, 0.02))]
    frame: Body,
    #[body(mass = 0.4, com = 0.2 * x, inertia = diagonal(0.001, 0.004, 0.004))]
    arm: Body,
    #[joint(ground -> frame)]
    flight: Free,
    #[joint(frame.at(0.1 * x) -> arm, about = y)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
    #[acts(on = frame.at(-0.2 * x), along = frame.z)]
    rotor: Force,
}

/// Second-order costs of values that depend on state and inputs are `Jᵀ g` and `Jᵀ H J`. The blocks equal the
/// product of the whole matrices, also where half of the values have zero gradient and curvature.
#[test]
fn cost_derivatives_follow_the_chain_rule() {
    let mut random = Random::new(7);
    let mut numbers = |n: usize| (0..n).map(|_| random.uniform_number(1.0)).collect::<Vec<f64>>();
    let jacobian = SMatrix::<f64, 6, 8>::from_column_slice(&numbers(48));
    let mut gradient = SVector::<f64, 6>::from_column_slice(&numbers(6));
    let half = SMatrix::<f64, 6, 6>::from_column_slice(&numbers(36));
    let mut hessian = half.transpose() * half;
    for k in [0, 2, 5] {
        gradient[k] = 0.0;
        hessian.column_mut(k).fill(0.0);
        hessian.row_mut(k).fill(0.0);
    }
    let mut cost = Quadratic::<f64, 3, 2>::zeros();
    (cost.q[1], cost.qv[(0, 2)]) = (1.0, 2.0);
    let (by_q, by_v, by_u) = (
        jacobian.fixed_columns::<3>(0).into_owned(),
        jacobian.fixed_columns::<3>(3).into_owned(),
        jacobian.fixed_columns::<2>(6).into_owned(),
    );
    cost.add_costs_of(&gradient, &hessian, (&by_q, &by_v, &by_u));
    let (first, second) = (jacobian.transpose() * gradient, jacobian.transpose() * hessian * jacobian);
    let block_of_second_derivatives = |i: usize, j: usize, rows: usize, columns: usize| {
        second.view((i, j), (rows, columns)).iter().copied().collect::<Vec<f64>>()
    };
    cost.q[1] -= 1.0;
    cost.qv[(0, 2)] -= 2.0;
    let assert_close_entries = |what: &str, found: &[f64], expected: &[f64]| {
        let far = found.iter().zip(expected).fold(0.0, |far: f64, (a, b)| far.max((a - b).abs()));
        assert!(far < 1e-13 && found.len() == expected.len(), "{what}: {found:?} and {expected:?}");
    };
    assert_close_entries("q", cost.q.as_slice(), &first.as_slice()[..3]);
    assert_close_entries("v", cost.v.as_slice(), &first.as_slice()[3..6]);
    assert_close_entries("u", cost.u.as_slice(), &first.as_slice()[6..]);
    assert_close_entries("qq", cost.qq.as_slice(), &block_of_second_derivatives(0, 0, 3, 3));
    assert_close_entries("qv", cost.qv.as_slice(), &block_of_second_derivatives(0, 3, 3, 3));
    assert_close_entries("vv", cost.vv.as_slice(), &block_of_second_derivatives(3, 3, 3, 3));
    assert_close_entries("qu", cost.qu.as_slice(), &block_of_second_derivatives(0, 6, 3, 2));
    assert_close_entries("vu", cost.vu.as_slice(), &block_of_second_derivatives(3, 6, 3, 2));
    assert_close_entries("uu", cost.uu.as_slice(), &block_of_second_derivatives(6, 6, 2, 2));
}

#[test]
fn chained_steps_equal_one_long_step() {
    let (mut random, m) = (Random::new(3), Flapper {});
    let q = m.integrate(&Flapper::neutral(&m), &random.random_vector(1.0));
    let (v, u) = (random.random_vector(1.0), random.random_vector(3.0));
    let step = discrete::transition(&m, &SemiImplicitEuler::step(0.1), 0.0, &q, &v, &u).expect("it moves");
    assert!(step.chained.is_some());
    let s = random_positive_definite::<14>(&mut random);
    let block_of_second_derivatives = |i: usize, j: usize| s.fixed_view::<7, 7>(7 * i, 7 * j).into_owned();
    let after = Value {
        q: random.random_vector(1.0),
        v: random.random_vector(1.0),
        qq: block_of_second_derivatives(0, 0),
        qv: block_of_second_derivatives(0, 1),
        vv: block_of_second_derivatives(1, 1),
    };
    let cost = Quadratic { uu: SMatrix::identity(), qq: SMatrix::identity() * 0.3, ..Quadratic::zeros() };
    let (policy, value) = backward(&step, &cost, &after, 0.2).expect("it is convex");
    let plain = discrete::Transition { chained: None, ..step };
    let (expected, to_go) = backward(&plain, &cost, &after, 0.2).expect("it is convex");
    let scale = to_go.hessian::<14>().amax();
    assert!((value.hessian::<14>() - to_go.hessian::<14>()).amax() < 1e-12 * scale);
    assert!((value.q - to_go.q).amax() < 1e-12 * scale && (value.v - to_go.v).amax() < 1e-12 * scale);
    assert!((policy.change - expected.change).amax() < 1e-12 * expected.change.amax());
    assert!((policy.by_q - expected.by_q).amax() < 1e-12 * expected.by_q.amax());
    assert!((policy.by_v - expected.by_v).amax() < 1e-12 * expected.by_v.amax());
}

#[test]
fn nonconvex_costs_are_errors() {
    let step = discrete::transition(
        &Pendubot {},
        &Rk4::step(0.01),
        0.0,
        &[0.1, 0.2].into(),
        &[0.0, 0.0].into(),
        &[0.0].into(),
    );
    let (step, mut cost) = (step.expect("it moves"), Quadratic::zeros());
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        cost.uu[0] = bad;
        assert_eq!(backward(&step, &cost, &Value::zeros(), 0.0), Err(Indefinite { input: 0 }), "{bad}");
    }
}

const STEPS: usize = 60;
type State = (SVector<f64, 2>, SVector<f64, 2>);

/// Optimal control problem of the pendubot: move from hanging at rest to a goal, with a running cost.
struct Problem {
    method: SemiImplicitEuler<f64>,
    goal: SVector<f64, 2>,
}

impl Problem {
    fn total_cost(&self, states: &[State], inputs: &[SVector<f64, 1>]) -> f64 {
        let (q, v) = states[STEPS];
        let effort: f64 = inputs.iter().map(|u| 0.5 * 1e-3 * u[0] * u[0]).sum();
        effort + 50.0 * (q - self.goal).norm_squared() + 5.0 * v.norm_squared()
    }

    fn terminal_value(&self, (q, v): &State) -> Value<f64, 2> {
        let one = SMatrix::<f64, 2, 2>::identity();
        Value { q: (q - self.goal) * 100.0, v: v * 10.0, qq: one * 100.0, vv: one * 10.0, ..Value::zeros() }
    }

    /// Returns the feedback policies of all instants, the first one first, and the largest component of the
    /// cost gradient with respect to the inputs. Returns `None` if the costs are not convex.
    fn policies_of_instants<M>(
        &self,
        m: &M,
        states: &[State],
        inputs: &[SVector<f64, 1>],
        curved: bool,
    ) -> Option<(Vec<Policy<f64, 2, 1>>, f64)>
    where
        M: SecondDerivatives<2, 2, 1, Scalar = f64>,
    {
        let (mut to_go, mut policies, mut slope) = (self.terminal_value(&states[STEPS]), Vec::new(), 0.0_f64);
        // The adjoint of the trajectory is the weight of the dynamics' curvature and gives the gradient,
        // which is zero at the optimum.
        let mut adjoint = (to_go.q, to_go.v);
        for ((q, v), u) in states.iter().zip(inputs).rev() {
            let step = discrete::transition(m, &self.method, 0.0, q, v, u).expect("it moves");
            let mut cost = Quadratic::zeros();
            (cost.u, cost.uu[0]) = (u * 1e-3, 1e-3);
            if curved {
                let factors = (&adjoint.0, &adjoint.1);
                let curvature =
                    discrete::second_order(m, &self.method, 0.0, q, v, u, factors).expect("it moves");
                cost = cost.with_curvature(&curvature);
            }
            let policy;
            (policy, to_go) = backward(&step, &cost, &to_go, 0.0).ok()?;
            let (by_q, by_v, by_u) = step.adjoint(&adjoint.0, &adjoint.1);
            slope = slope.max((by_u + cost.u).amax());
            adjoint = (by_q, by_v);
            policies.push(policy);
        }
        policies.reverse();
        Some((policies, slope))
    }

    fn rollout_policies<M>(
        &self,
        m: &M,
        states: &[State],
        inputs: &[SVector<f64, 1>],
        policies: &[Policy<f64, 2, 1>],
        length: f64,
    ) -> (Vec<State>, Vec<SVector<f64, 1>>)
    where
        M: SecondDerivatives<2, 2, 1, Scalar = f64>,
    {
        let (mut all, mut new) = (vec![states[0]], Vec::new());
        for ((policy, u), (q, v)) in policies.iter().zip(inputs).zip(states) {
            let (now_q, now_v) = all[all.len() - 1];
            let change = policy.change * length + policy.by_q * (now_q - q) + policy.by_v * (now_v - v);
            new.push(u + change);
            all.push(discrete::step(m, &self.method, 0.0, &now_q, &now_v, &(u + change)).expect("it moves"));
        }
        (all, new)
    }
}

/// Checks that differential dynamic programming converges quadratically near the optimum with the curvature
/// of the dynamics, and linearly without it.
#[test]
fn dynamic_programming_converges_quadratically() {
    let m = Pendubot {};
    let problem = Problem { method: SemiImplicitEuler::step(0.02), goal: [0.9, 0.4].into() };
    let gradient_norms_of_iterations = |curved_from: usize| {
        let mut inputs = vec![SVector::from([0.5]); STEPS];
        let mut states = vec![(SVector::from([0.0, 0.0]), SVector::from([0.0, 0.0]))];
        for u in &inputs {
            let (q, v) = states[states.len() - 1];
            states.push(discrete::step(&m, &problem.method, 0.0, &q, &v, u).expect("it moves"));
        }
        let mut slopes = Vec::new();
        for iteration in 0..200 {
            let curved = iteration >= curved_from;
            let Some((policies, slope)) = problem.policies_of_instants(&m, &states, &inputs, curved) else {
                break;
            };
            slopes.push(slope);
            if slope < 1e-12 {
                break;
            }
            let now = problem.total_cost(&states, &inputs);
            let tried =
                (0..20).map(|k| problem.rollout_policies(&m, &states, &inputs, &policies, 0.5_f64.powi(k)));
            let mut better =
                tried.filter(|(states, inputs)| problem.total_cost(states, inputs) < now + 1e-12);
            let Some(next) = better.next() else { break };
            (states, inputs) = next;
        }
        slopes
    };
    let (newton, gauss) = (gradient_norms_of_iterations(5), gradient_norms_of_iterations(usize::MAX));
    println!("{newton:?}\n{gauss:?}");
    // From the fifth iteration on, each gradient is below a multiple of the square of the one before, down to
    // rounding error.
    let quadratic = newton[5..].windows(2).all(|w| w[1] < 1e3 * w[0] * w[0] + 1e-13);
    assert!(quadratic && newton[newton.len() - 1] < 1e-12 && newton.len() < 10, "{newton:?}");
    // Without curvature each iteration reduces the gradient by a factor of 2 to 4.
    assert!(gauss.len() > 20 && gauss[8..].windows(2).all(|w| w[1] > 0.2 * w[0]), "{gauss:?}");
}

/// Checks that within limits the change of two inputs is the best of nine candidates, each input free or at
/// one of its limits. The cost-to-go predicts the costs of a displaced state under the policy.
#[test]
fn input_limits_bound_the_optimal_change() {
    let mut random = Random::new(5);
    let m = Flyer {};
    let q = Flyer::neutral(&m);
    let zero = SVector::zeros();
    let step =
        discrete::transition(&m, &Rk4::step(0.1), 0.0, &q, &zero, &SVector::zeros()).expect("it moves");
    let mut kinds = [0; 3];
    for _ in 0..300 {
        let mut cost = Quadratic::zeros();
        (cost.uu, cost.u) = (random_positive_definite::<2>(&mut random), random.random_vector(2.0));
        (cost.qq, cost.vv) =
            (random_positive_definite::<6>(&mut random), random_positive_definite::<6>(&mut random));
        cost.qu = SMatrix::from_fn(|_, _| random.uniform_number(0.3));
        let (u, reach) = (random.random_vector::<2>(0.5), SVector::from([0.6, f64::INFINITY]));
        let limits =
            InputLimits::around(&u, &-reach, &reach.map(|x| x.min(0.7))).expect("they are consistent");
        let (mut policy, mut to_go) = (Policy::zeros(), Value::zeros());
        backward_within(&step, &cost, 0.0, &limits, &mut policy, &mut to_go).expect("it is convex");
        let cost_change_of_inputs = |du: &SVector<f64, 2>| cost.u.dot(du) + 0.5 * du.dot(&(cost.uu * du));
        let mut best = f64::INFINITY;
        for choice in 0..9 {
            let at = [choice % 3, choice / 3];
            let (mut system, mut right) = (cost.uu, -cost.u);
            for i in (0..2).filter(|i| at[*i] > 0) {
                system.fill_row(i, 0.0);
                system[(i, i)] = 1.0;
                let limit = if at[i] == 1 { -reach[i] - u[i] } else { reach[i].min(0.7) - u[i] };
                right[i] = limit;
            }
            let Some(du) = system.lu().solve(&right) else { continue };
            if du.iter().all(|x| x.is_finite()) && (limits.clamp(&du) - du).amax() < 1e-12 {
                best = best.min(cost_change_of_inputs(&du));
            }
        }
        assert!(
            (cost_change_of_inputs(&policy.change) - best).abs() < 1e-12,
            "{} {best}",
            cost_change_of_inputs(&policy.change)
        );
        assert!((policy.expected[0] + policy.expected[1] - best).abs() < 1e-12);
        let held = (0..2).filter(|i| policy.by_q.row(*i).amax() == 0.0).count();
        kinds[held] += 1;
        let dq = random.random_vector::<6>(1e-2);
        let du = policy.inputs(1.0, &dq, &SVector::zeros());
        let predicted = cost_change_of_inputs(&du) + dq.dot(&(cost.qu * du)) + 0.5 * dq.dot(&(cost.qq * dq));
        assert!((predicted - best - to_go.at(&dq, &SVector::zeros())).abs() < 1e-12);
    }
    assert!(kinds.iter().all(|count| *count > 20), "{kinds:?}");
    let contradictory =
        InputLimits::around(&SVector::from([0.0, 0.0]), &[0.0, 1.0].into(), &[1.0, 0.5].into());
    assert_eq!(contradictory, Err(EmptyRange { input: 1 }));
}

/// At the end of iterations with a weak motor, the gradient of the costs is zero where the torque is within
/// its limits, and presses it against the limit elsewhere (conditions of Karush, Kuhn and Tucker).
#[test]
fn weak_motor_reaches_its_torque_limits() {
    let m = Pendubot {};
    let problem = Problem { method: SemiImplicitEuler::step(0.02), goal: [0.9, 0.4].into() };
    let reach = SVector::from([2.0]);
    let mut inputs = vec![SVector::from([0.5]); STEPS];
    let mut states = vec![(SVector::from([0.0, 0.0]), SVector::from([0.0, 0.0]))];
    for u in &inputs {
        let (q, v) = states[states.len() - 1];
        states.push(discrete::step(&m, &problem.method, 0.0, &q, &v, u).expect("it moves"));
    }
    let mut policies = vec![Policy::zeros(); STEPS];
    let mut violation = f64::INFINITY;
    let (mut at_limit, mut regularisation) = (0, 1e-6);
    for _ in 0..600 {
        let (mut to_go, mut adjoint) =
            (problem.terminal_value(&states[STEPS]), (SVector::zeros(), SVector::zeros()));
        adjoint = (to_go.q + adjoint.0, to_go.v + adjoint.1);
        (violation, at_limit) = (0.0, 0);
        for (k, ((q, v), u)) in states.iter().zip(&inputs).enumerate().rev() {
            let step = discrete::transition(&m, &problem.method, 0.0, q, v, u).expect("it moves");
            let mut cost = Quadratic::zeros();
            (cost.u, cost.uu[0]) = (u * 1e-3, 1e-3);
            let (by_q, by_v, by_u) = step.adjoint(&adjoint.0, &adjoint.1);
            let slope = by_u[0] + cost.u[0];
            let is_held = u[0].abs() > reach[0] - 1e-12;
            at_limit += usize::from(is_held);
            violation = violation.max(if is_held { (slope * u[0].signum()).max(0.0) } else { slope.abs() });
            adjoint = (by_q, by_v);
            let limits = InputLimits::around(u, &-reach, &reach).expect("they are consistent");
            backward_within(&step, &cost, regularisation, &limits, &mut policies[k], &mut to_go)
                .expect("it is convex");
        }
        if violation < 1e-9 {
            break;
        }
        let now = problem.total_cost(&states, &inputs);
        let mut tried = (0..20).map(|k| {
            let (mut all, mut new) = (vec![states[0]], Vec::new());
            for ((policy, u), (q, v)) in policies.iter().zip(&inputs).zip(&states) {
                let (now_q, now_v) = all[all.len() - 1];
                let change = policy.inputs(0.5_f64.powi(k), &(now_q - q), &(now_v - v));
                let next = (u + change).map(|u| u.clamp(-reach[0], reach[0]));
                new.push(next);
                all.push(discrete::step(&m, &problem.method, 0.0, &now_q, &now_v, &next).expect("it moves"));
            }
            (all, new)
        });
        let next = tried.find(|(states, inputs)| problem.total_cost(states, inputs) < now + 1e-13);
        // With more regularisation the change of the inputs is shorter, and its gains are smaller.
        match next {
            Some(next) => ((states, inputs), regularisation) = (next, (regularisation * 0.2).max(1e-6)),
            None => regularisation *= 10.0,
        }
    }
    assert!(violation < 1e-7, "{violation:e}");
    assert!((5..STEPS - 5).contains(&at_limit), "{at_limit}");
}

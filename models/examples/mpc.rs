//! Model-predictive control of a cart-pole that moves from one end of its rail to the other without exceeding
//! it. To incline the pole in the direction of motion the cart must first move backwards, for which it has
//! two centimetres. Twenty-five times a second, the motion of the next second is linearised about the
//! previous plan. A quadratic program then finds the forces of minimum cost within the limits of rail and
//! motor.
//!
//! ```text
//! cargo run --release --example mpc -p linkwork-models
//! ```

mod regulator;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use linkwork::discrete;
use linkwork::optimal::{Quadratic, Value};
use linkwork::prelude::*;
use regulator::linear_quadratic_regulator;

/// Cart on a short rail with a pole pinned to it, upright at zero.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct RailCartPole {
    #[body(mass = 1)]
    cart: Body,
    #[body(mass = 0.2, com = 0.5 * y, inertia = rod(0.2, 1, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[limit(on = rail, from = -0.52, to = 0.52, max_effort = 8)]
    buffers: Limit,
    #[acts(on = rail)]
    push: Force,
}

/// Position of the cart, m, angle of the pole, rad, then their rates.
type State = SVector<f64, 4>;
const RAIL: usize = index!(RailCartPole::VELOCITIES, "rail");

/// Number of planned steps, and the period of each, s.
const STEPS: usize = 25;
const PERIOD: f64 = 0.04;
const METHOD: Rk4<f64> = Rk4::step(PERIOD);
/// Target state of the cart: at rest two centimetres before the buffer.
const GOAL: State = State::new(0.5, 0.0, 0.0, 0.0);
/// Number of unknowns of a step in the quadratic program: a force, then the state after it.
const SIZE: usize = 5;

/// Returns the costs of one control period about a state of rest.
fn quadratic_costs() -> Quadratic<f64, 2, 1> {
    Quadratic {
        qq: SMatrix::from_diagonal(&[20.0, 5.0].into()),
        vv: SMatrix::from_diagonal(&[1.0, 0.5].into()),
        uu: [0.02].into(),
        ..Quadratic::zeros()
    }
}

/// Returns the state of the cart-pole after one control period with a constant force.
fn next_state(x: &State, push: f64) -> Result<State, Error> {
    let (q, v) = discrete::split(x);
    let (q, v) = discrete::step(&RailCartPole {}, &METHOD, 0.0, &q, &v, &[push].into())?;
    Ok(discrete::stacked(&q, &v))
}

/// Sparse matrix in triplet form: rows, columns and values of its entries.
#[derive(Default)]
struct TripletEntries(Vec<usize>, Vec<usize>, Vec<f64>);

impl TripletEntries {
    fn push_entry(&mut self, row: usize, column: usize, value: f64) {
        self.0.push(row);
        self.1.push(column);
        self.2.push(value);
    }

    fn sparse_matrix(self, rows: usize, columns: usize) -> CscMatrix<f64> {
        CscMatrix::new_from_triplets(rows, columns, self.0, self.1, self.2)
    }
}

/// Quadratic program for the forces and states of the next second: minimum cost, with `rows x = right` for
/// the motion and `rows x ≤ right` for the limits.
struct QuadraticProgram {
    hessian: TripletEntries,
    gradient: [f64; SIZE * STEPS],
    rows: TripletEntries,
    right: Vec<f64>,
}

impl QuadraticProgram {
    /// Adds the equations of motion from a state to the quadratic program, linearised about the motion under
    /// the planned forces: `x⁺ − A x − B u = f − A x̄ − B ū`.
    fn add_motion_equations(&mut self, start: &State, plan: &[f64; STEPS]) -> Result<(), Error> {
        let mut x = *start;
        for (k, &push) in plan.iter().enumerate() {
            let (q, v) = discrete::split(&x);
            let step = discrete::transition(&RailCartPole {}, &METHOD, 0.0, &q, &v, &[push].into())?;
            let (a, b) = (step.a::<4>(), step.b::<4>());
            let next: State = discrete::stacked(&step.q, &step.v);
            // The initial state is given and moves to the right-hand side.
            let known = if k == 0 { next - b * push } else { next - a * x - b * push };
            for i in 0..4 {
                let row = self.right.len();
                self.rows.push_entry(row, SIZE * k + 1 + i, 1.0);
                self.rows.push_entry(row, SIZE * k, -b[i]);
                for j in (0..4).filter(|_| k > 0) {
                    self.rows.push_entry(row, SIZE * (k - 1) + 1 + j, -a[(i, j)]);
                }
                self.right.push(known[i]);
            }
            x = next;
        }
        Ok(())
    }

    /// Adds the limits of the force in each step and of the position after it to the quadratic program, in
    /// both directions.
    fn add_force_and_position_limits(&mut self) {
        let m = RailCartPole {};
        let (least, most) = (m.lower_limits()[RAIL], m.upper_limits()[RAIL]);
        let strength = m.effort_limits()[RAIL];
        for k in 0..STEPS {
            for (column, least, most) in [(SIZE * k, -strength, strength), (SIZE * k + 1 + RAIL, least, most)]
            {
                for (sign, bound) in [(1.0, most), (-1.0, -least)] {
                    self.rows.push_entry(self.right.len(), column, sign);
                    self.right.push(bound);
                }
            }
        }
    }

    /// Adds the cost of every step to the quadratic program, and at the end the cost-to-go of the regulator.
    fn add_costs(&mut self, to_go: &Value<f64, 2>) {
        let costs = quadratic_costs();
        let each = Value { qq: costs.qq, vv: costs.vv, ..Value::zeros() }.hessian::<4>();
        for k in 0..STEPS {
            let last = k + 1 == STEPS;
            let weight = if last { to_go.hessian::<4>() } else { each };
            self.hessian.push_entry(SIZE * k, SIZE * k, costs.uu[0]);
            let first = SIZE * k + 1;
            for j in 0..4 {
                (0..=j).for_each(|i| self.hessian.push_entry(first + i, first + j, weight[(i, j)]));
                self.gradient[first + j] = -(weight.row(j) * GOAL)[0];
            }
        }
    }

    /// Returns the optimal forces of the quadratic program, or `None` if it is infeasible.
    fn optimal_forces(self) -> Option<[f64; STEPS]> {
        let (count, columns, motions) = (self.right.len(), SIZE * STEPS, 4 * STEPS);
        let (hessian, rows) =
            (self.hessian.sparse_matrix(columns, columns), self.rows.sparse_matrix(count, columns));
        let cones = [ZeroConeT(motions), NonnegativeConeT(count - motions)];
        let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
        let mut solver = DefaultSolver::new(&hessian, &self.gradient, &rows, &self.right, &cones, settings);
        solver.solve();
        let solved = solver.solution.status == SolverStatus::Solved;
        solved.then(|| std::array::from_fn(|k| solver.solution.x[SIZE * k]))
    }
}

/// Returns the optimal forces of the next second, for a motion that is linearised about the previous plan;
/// `None` if no forces satisfy the limits.
fn plan_forces(x: &State, plan: &[f64; STEPS], to_go: &Value<f64, 2>) -> Result<Option<[f64; STEPS]>, Error> {
    let (hessian, rows) = (TripletEntries::default(), TripletEntries::default());
    let mut program = QuadraticProgram { hessian, gradient: [0.0; SIZE * STEPS], rows, right: Vec::new() };
    program.add_motion_equations(x, plan)?;
    program.add_force_and_position_limits();
    program.add_costs(to_go);
    Ok(program.optimal_forces())
}

fn main() -> Result<(), Error> {
    let found = linear_quadratic_regulator(
        &RailCartPole {},
        &METHOD,
        &SVector::zeros(),
        &SVector::zeros(),
        &quadratic_costs(),
    );
    let (regulator, to_go) = found.expect("a push on the cart can keep the pole upright");
    let (most, strength) = (RailCartPole {}.upper_limits()[RAIL], RailCartPole {}.effort_limits()[RAIL]);

    // The regulator alone, without limits, and the planner from the same initial state.
    let start = State::new(-0.5, 0.0, 0.0, 0.0);
    let (mut free, mut x, mut plan) = (start, start, [0.0; STEPS]);
    let (mut furthest, mut strongest) = ([0.0_f64; 2], [0.0_f64; 2]);
    println!("  t, s   cart, m   pole, rad   push, N   cart without a plan, m");
    for k in 0..100 {
        let (dq, dv) = discrete::split(&(free - GOAL));
        let push = regulator.inputs(1.0, &dq, &dv)[0];
        free = next_state(&free, push)?;

        plan.rotate_left(1);
        plan = plan_forces(&x, &plan, &to_go)?.expect("there is a way within the limits");
        if k % 6 == 0 {
            let t = PERIOD * k as f64;
            println!("{t:6.2} {:9.4} {:11.4} {:9.3} {:15.4}", x[0], x[1], plan[0], free[0]);
        }
        x = next_state(&x, plan[0])?;
        for (i, (x, push)) in [(x, plan[0]), (free, push)].into_iter().enumerate() {
            furthest[i] = furthest[i].max(x[0].abs());
            strongest[i] = strongest[i].max(push.abs());
        }
    }
    println!("\nlimits          {most:.3} m  {strength:6.2} N");
    println!("with a plan     {:.3} m  {:6.2} N", furthest[0], strongest[0]);
    println!("without a plan  {:.3} m  {:6.2} N", furthest[1], strongest[1]);

    assert!(furthest[0] < most + 1e-4 && strongest[0] < strength + 1e-4, "it keeps its limits");
    assert!(furthest[0] > most - 1e-4 && strongest[0] > strength - 1e-4, "all of which it uses");
    assert!((x - GOAL).amax() < 2e-3, "it arrives");
    assert!(furthest[1] > 1.1 * most && strongest[1] > strength, "the regulator alone keeps none");
    Ok(())
}

#[test]
fn cart_stays_on_its_rail() -> Result<(), Error> {
    main()
}

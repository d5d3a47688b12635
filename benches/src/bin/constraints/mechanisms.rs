//! The constrained mechanisms of the comparison; `peers/constraints/mechanisms.py` has the same parameters.

use linkwork::nalgebra::SVector;
use linkwork::prelude::{Constrained, Rk4, simulate};
use linkwork_benches::peers::contender::{Contender, ContenderOwner, MeasuredFunction};
use linkwork_benches::peers::own::{GeneratedContender, ToNumberList};
use linkwork_benches::random::Random;
use linkwork_benches::states::{STATES, State};
use linkwork_models::{
    AndrewsSqueezer, BallInBowl, Bicycle, BricardLinkage, ChaplyginSleigh, FiveBar, FourBar, Rattleback,
    RollingDisk, SliderCrank, StewartPlatform, TwoWindows,
};
use std::rc::Rc;

/// Step size of the measured simulations, s.
const STEP: f64 = 1e-3;

/// Constrained mechanism whose functions are measured.
pub struct Mechanism {
    /// Title of the mechanism in the table.
    pub title: &'static str,
    /// Name of the folder with the mechanism's peer code.
    pub name: &'static str,
    /// Number of coordinates of the mechanism.
    pub nq: usize,
    /// Number of velocities of the mechanism.
    pub nv: usize,
    /// Number of scalar constraints of the mechanism.
    pub nc: usize,
    /// `q`, `v`, `v̇` and zero forces of every state, concatenated.
    pub numbers: Vec<f64>,
    /// Contender that computes the constrained accelerations at all states.
    pub accelerations: Box<dyn Contender>,
    /// Contender that simulates a hundred steps from the first state.
    pub motion: Box<dyn Contender>,
}

/// Accelerations and multipliers. Peers compute both but return only the accelerations.
struct AccelerationsAndMultipliers<const NV: usize, const NC: usize>(SVector<f64, NV>, SVector<f64, NC>);

impl<const NV: usize, const NC: usize> ToNumberList for AccelerationsAndMultipliers<NV, NC> {
    fn flatten(&self) -> Vec<f64> {
        self.0.flatten()
    }
}

/// Returns a mechanism with its states: first the given configuration and velocity projected onto the
/// constraints, then random ones at distances up to `spread`.
fn mechanism_with_states<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    (title, name): (&'static str, &'static str),
    m: M,
    (q, v): (impl Into<SVector<f64, NQ>>, impl Into<SVector<f64, NV>>),
    (spread, step): (f64, f64),
) -> Mechanism
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Clone + 'static,
{
    let (middle, start) = (q.into(), v.into());
    let consistent_state = |q: &SVector<f64, NQ>, v: &SVector<f64, NV>| {
        let q = m.assemble(0.0, q, &[]).ok()?;
        let v = m.project_velocity(0.0, &q, v).ok()?;
        let tau = SVector::zeros();
        let a = m.constrained_dynamics(0.0, &q, &v, &tau).0;
        Some(State { q, v, a, tau })
    };
    let mut random = Random::new(7);
    let mut random_vector = |limit| SVector::<f64, NV>::from_fn(|_, _| random.uniform_within(limit));
    let mut states = Vec::from_iter(consistent_state(&middle, &start));
    while states.len() < STATES {
        let speed = start.amax().max(1.0);
        states.extend(consistent_state(&m.integrate(&middle, &random_vector(spread)), &random_vector(speed)));
    }
    let states = Rc::new(states);
    let numbers = states.iter().flat_map(State::concatenated_state_numbers).collect();
    let accelerations = GeneratedContender {
        owner: ContenderOwner::Linkwork,
        mechanism: m.clone(),
        states: states.clone(),
        name: MeasuredFunction::Constrained.generated_function_name(),
        call: |m: &M, s: &State<NQ, NV>| {
            let (a, lambda) = m.constrained_dynamics(0.0, &s.q, &s.v, &s.tau);
            AccelerationsAndMultipliers(a, lambda)
        },
    };
    let motion = GeneratedContender {
        owner: ContenderOwner::Linkwork,
        mechanism: (m, step),
        states: Rc::new(states[..1].to_vec()),
        name: MeasuredFunction::Motion.generated_function_name(),
        call: |(m, step): &(M, f64), s: &State<NQ, NV>| {
            let run = simulate(m).from(s.q, s.v).method(Rk4::step(*step));
            run.duration(100.0 * step).finish().map_or(SVector::repeat(f64::NAN), |end| end.v)
        },
    };
    let (accelerations, motion) = (Box::new(accelerations), Box::new(motion));
    Mechanism { title, name, nq: NQ, nv: NV, nc: NC, numbers, accelerations, motion }
}

/// Returns the constructors of all mechanisms that are measured.
pub fn mechanism_constructors() -> Vec<fn() -> Mechanism> {
    vec![
        || {
            let m = FourBar { g: 9.81, density: 0.8, a: 0.3, b: 0.9, c: 0.7, d: 0.8 };
            let start = ([0.3, 0.6, 1.8], [2.0, 0.0, 0.0]);
            mechanism_with_states(("four-bar linkage", "four_bar"), m, start, (0.3, STEP))
        },
        || {
            let m = SliderCrank { g: 9.81, r: 0.04, l: 0.13, m_crank: 0.9, m_rod: 0.5, m_piston: 0.35 };
            let start = ([0.3, -0.4, 0.16], [20.0, 0.0, 0.0]);
            mechanism_with_states(("slider-crank", "slider_crank"), m, start, (0.3, STEP))
        },
        || {
            let start = (AndrewsSqueezer::START, [0.0; 7]);
            mechanism_with_states(
                ("Andrews' squeezer", "andrews_squeezer"),
                AndrewsSqueezer {},
                start,
                (0.05, 3e-5),
            )
        },
        || {
            let m = TwoWindows { g: 9.81, mass: 1.0, length: 1.0 };
            let start = ([0.0; 5], [-1.0, 1.0, -1.0, 1.0, -1.0]);
            mechanism_with_states(("two windows", "two_windows"), m, start, (0.3, STEP))
        },
        || {
            let m = BricardLinkage { g: 9.81, mass: 1.0, length: 1.0 };
            let start = ([0.3, -0.23, 0.3, -0.23, 0.3], [0.0; 5]);
            mechanism_with_states(("Bricard's linkage", "bricard_linkage"), m, start, (0.1, STEP))
        },
        || {
            let (crank_mass, forearm_mass, tool_mass) = (0.4, 0.3, 0.9);
            let m = FiveBar {
                g: 9.81,
                crank_mass,
                forearm_mass,
                tool_mass,
                base: 0.25,
                crank: 0.3,
                forearm: 0.4,
            };
            let start = ([2.0, -1.3, 0.9, 1.3], [1.0, 0.0, -1.0, 0.0]);
            mechanism_with_states(("five-bar", "five_bar"), m, start, (0.2, STEP))
        },
        stewart_platform,
        || {
            let m = RollingDisk { g: 9.81, m: 2.0, radius: 0.4 };
            let start = ([0.0, 0.0, 0.4, 0.0, 0.1, 0.0], [1.2, 0.0, 0.0, 0.0, 0.0, 3.0]);
            mechanism_with_states(("rolling disk", "rolling_disk"), m, start, (0.3, STEP))
        },
        || {
            let m = BallInBowl { g: 9.81, mass: 0.3, radius: 0.05, bowl: 0.45 };
            let start = ([0.2, 0.1, -0.33, 0.5, 0.5, -0.5, 0.5], [0.3, 0.2, 0.0, 1.0, 2.0, 3.0]);
            mechanism_with_states(("ball in a bowl", "ball_in_bowl"), m, start, (0.1, STEP))
        },
        || {
            let m = ChaplyginSleigh { m: 1.0, j: 0.5, a: 0.3 };
            mechanism_with_states(
                ("Chaplygin's sleigh", "chaplygin_sleigh"),
                m,
                ([0.0; 3], [1.0, 0.0, 2.0]),
                (1.0, STEP),
            )
        },
        || {
            let v = [4.6, 0.0, 0.0, 0.1, 0.0, 0.0, -15.3, 0.0, -13.1];
            let m = Bicycle::BENCHMARK;
            mechanism_with_states(("bicycle", "bicycle"), m, (m.neutral(), v), (0.2, STEP))
        },
        || {
            let m = Rattleback::BENCHMARK;
            let start = ([0.0, 0.0, 0.02, 0.01, 0.01, 0.0, 0.9999], [0.0, 0.0, 0.0, 0.0, 0.0, -5.0]);
            mechanism_with_states(("rattleback", "rattleback"), m, start, (0.1, STEP))
        },
    ]
}

fn stewart_platform() -> Mechanism {
    let m = StewartPlatform {
        g: 9.81,
        base_radius: 0.8,
        platform_radius: 0.5,
        platform_mass: 30.0,
        across: 1.5,
        axial: 2.5,
        leg_mass: 2.0,
        leg: 0.6,
    };
    let mut q = m.neutral();
    q[2] = 0.9;
    for leg in 0..6 {
        q[9 + 3 * leg] = 1.0;
    }
    let mut v = SVector::<f64, { StewartPlatform::NV }>::zeros();
    v.fixed_rows_mut::<6>(0).copy_from_slice(&[0.3, -0.2, 0.5, 0.4, 0.6, -0.5]);
    mechanism_with_states(("Stewart platform", "stewart_platform"), m, (q, v), (0.1, STEP))
}

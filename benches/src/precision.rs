//! Problems for the comparison of integration methods: an n-body problem, and stiff or constrained
//! mechanisms.

#[path = "../../tests/support/counting.rs"]
mod counting;

use counting::CountingMechanism;
use linkwork::Mechanism;
use linkwork::integrate::Method;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork_models::{AndrewsSqueezer, CarAxle};
use std::time::Instant;

/// Seven stars in a plane that attract each other, with close encounters (Hairer, Nørsett and Wanner,
/// *Solving Ordinary Differential Equations I*, 1993, II.10).
#[mechanism(derivatives)]
pub struct Pleiades {
    #[particle(mass = 1 + i)]
    star: [Particle; 7],
    #[joint(ground -> star[i], along = (x, y))]
    place: [Stage; 7],
    #[acts(between = (star[0], star[1]), strength = 2)]
    pull_0_1: Attraction,
    #[acts(between = (star[0], star[2]), strength = 3)]
    pull_0_2: Attraction,
    #[acts(between = (star[0], star[3]), strength = 4)]
    pull_0_3: Attraction,
    #[acts(between = (star[0], star[4]), strength = 5)]
    pull_0_4: Attraction,
    #[acts(between = (star[0], star[5]), strength = 6)]
    pull_0_5: Attraction,
    #[acts(between = (star[0], star[6]), strength = 7)]
    pull_0_6: Attraction,
    #[acts(between = (star[1], star[2]), strength = 6)]
    pull_1_2: Attraction,
    #[acts(between = (star[1], star[3]), strength = 8)]
    pull_1_3: Attraction,
    #[acts(between = (star[1], star[4]), strength = 10)]
    pull_1_4: Attraction,
    #[acts(between = (star[1], star[5]), strength = 12)]
    pull_1_5: Attraction,
    #[acts(between = (star[1], star[6]), strength = 14)]
    pull_1_6: Attraction,
    #[acts(between = (star[2], star[3]), strength = 12)]
    pull_2_3: Attraction,
    #[acts(between = (star[2], star[4]), strength = 15)]
    pull_2_4: Attraction,
    #[acts(between = (star[2], star[5]), strength = 18)]
    pull_2_5: Attraction,
    #[acts(between = (star[2], star[6]), strength = 21)]
    pull_2_6: Attraction,
    #[acts(between = (star[3], star[4]), strength = 20)]
    pull_3_4: Attraction,
    #[acts(between = (star[3], star[5]), strength = 24)]
    pull_3_5: Attraction,
    #[acts(between = (star[3], star[6]), strength = 28)]
    pull_3_6: Attraction,
    #[acts(between = (star[4], star[5]), strength = 30)]
    pull_4_5: Attraction,
    #[acts(between = (star[4], star[6]), strength = 35)]
    pull_4_6: Attraction,
    #[acts(between = (star[5], star[6]), strength = 42)]
    pull_5_6: Attraction,
}

impl Pleiades {
    /// Initial configuration and velocity of the stars.
    pub const START: ([f64; 14], [f64; 14]) = (
        [3.0, 3.0, 3.0, -3.0, -1.0, 2.0, -3.0, 0.0, 2.0, 0.0, -2.0, -4.0, 2.0, 4.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.25, 0.0, 1.0, 1.75, 0.0, -1.5, 0.0],
    );
}

/// Centrifugal governor whose sleeve is on a stiff spring in viscous oil: the motion of the sleeve decays
/// within a millisecond, the balls swing for seconds.
#[mechanism(gravity = -9.81 * z, derivatives)]
pub struct StiffGovernor {
    #[body(mass = 2, inertia = diagonal(0.01, 0.01, 0.02))]
    sleeve: Body,
    #[body]
    arm: Body,
    #[particle(mass = 1, at = arm.at(-0.4 * z))]
    ball: Particle,
    #[joint(ground -> sleeve, along = z, about = z)]
    collar: Collar,
    #[joint(sleeve -> arm, about = x)]
    hinge: Pin,
    #[acts(on = collar.slide, stiffness = 1e6)]
    coil: Spring,
    #[acts(on = collar.slide, damping = 1e4)]
    oil: Dashpot,
    #[acts(on = hinge, damping = 0.02)]
    air: Dashpot,
}

/// Result of an integration method on a test problem: final state, evaluations and time.
pub struct IntegrationResult {
    /// Final configuration of the motion.
    pub q: Vec<f64>,
    /// Number of evaluations of the accelerations.
    pub evaluations: usize,
    /// Number of evaluations of the derivatives of the accelerations.
    pub derivatives: usize,
    /// Minimum of the measured processor times, s.
    pub seconds: f64,
}

/// Names of the test problems of the integrators, by index.
pub const PROBLEMS: [&str; 4] = ["pleiades", "car axis", "Andrews' squeezer", "stiff governor"];

/// Operation on a test problem, generic over the type of its mechanism.
trait ProblemVisitor {
    type VisitResult;
    fn visit_mechanism<M, const N: usize>(
        self,
        m: &M,
        start: ([f64; N], [f64; N]),
        end: f64,
    ) -> Self::VisitResult
    where
        M: Mechanism<N, N, 0, Scalar = f64>;
}

fn visit_problem<V: ProblemVisitor>(problem: usize, visit: V) -> V::VisitResult {
    match problem {
        0 => visit.visit_mechanism(&Pleiades {}, Pleiades::START, 3.0),
        1 => visit.visit_mechanism(&CarAxle {}, ([0.0, 0.5, 1.0, 0.5], [-0.5, 0.0, -0.5, 0.0]), 3.0),
        2 => visit.visit_mechanism(&AndrewsSqueezer {}, (AndrewsSqueezer::START, [0.0; 7]), 0.03),
        _ => visit.visit_mechanism(&StiffGovernor {}, ([0.01, 0.0, 0.8], [0.0, 6.0, 0.0]), 5.0),
    }
}

struct IntegrationVisitor<S>(S);

impl<S: Method<f64> + Clone> ProblemVisitor for IntegrationVisitor<S> {
    type VisitResult = Result<IntegrationResult, Error>;

    fn visit_mechanism<M, const N: usize>(
        self,
        m: &M,
        start: ([f64; N], [f64; N]),
        end: f64,
    ) -> Self::VisitResult
    where
        M: Mechanism<N, N, 0, Scalar = f64>,
    {
        let mut best: Option<IntegrationResult> = None;
        for _ in 0..5 {
            let counted = CountingMechanism::<M, true>::new(m);
            let clock = Instant::now();
            let run =
                simulate(&counted).from(start.0, start.1).method(self.0.clone()).duration(end).finish()?;
            let seconds = clock.elapsed().as_secs_f64();
            if best.as_ref().is_none_or(|found| seconds < found.seconds) {
                let q = run.q.iter().copied().collect();
                best = Some(IntegrationResult {
                    q,
                    evaluations: counted.evaluations.get(),
                    derivatives: counted.derivatives.get(),
                    seconds,
                });
            }
        }
        best.ok_or(Error::NotFinite { t: 0.0 })
    }
}

/// Integrates a test problem with a method, and returns its result.
///
/// # Errors
///
/// Returns the errors of the simulation.
pub fn solve_problem<S: Method<f64> + Clone>(problem: usize, method: S) -> Result<IntegrationResult, Error> {
    visit_problem(problem, IntegrationVisitor(method))
}

struct StartStateVisitor;

impl ProblemVisitor for StartStateVisitor {
    type VisitResult = (Vec<f64>, f64);

    fn visit_mechanism<M, const N: usize>(
        self,
        _: &M,
        (q, v): ([f64; N], [f64; N]),
        end: f64,
    ) -> Self::VisitResult
    where
        M: Mechanism<N, N, 0, Scalar = f64>,
    {
        (q.into_iter().chain(v).collect(), end)
    }
}

/// Returns the initial state, configuration and velocity, and the final time of a problem, s.
pub fn initial_state_and_final_time(problem: usize) -> (Vec<f64>, f64) {
    visit_problem(problem, StartStateVisitor)
}

struct RateVisitor<'a> {
    t: f64,
    y: &'a [f64],
    rate: &'a mut [f64],
}

impl ProblemVisitor for RateVisitor<'_> {
    type VisitResult = ();

    fn visit_mechanism<M, const N: usize>(self, m: &M, _: ([f64; N], [f64; N]), _: f64)
    where
        M: Mechanism<N, N, 0, Scalar = f64>,
    {
        let (q, v) = self.y.split_at(N);
        let (q, v) = (SVector::from_column_slice(q), SVector::from_column_slice(v));
        let a = Mechanism::forward_dynamics(m, self.t, &q, &v, &SVector::zeros());
        let (place, change) = self.rate.split_at_mut(N);
        place.copy_from_slice(v.as_slice());
        change.copy_from_slice(a.as_slice());
    }
}

/// Writes the time derivative of a state, with accelerations that satisfy the constraints, as the right-hand
/// side for other libraries.
pub fn write_rate_of_state(problem: usize, t: f64, y: &[f64], rate: &mut [f64]) {
    visit_problem(problem, RateVisitor { t, y, rate });
}

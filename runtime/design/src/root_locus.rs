//! Root loci: closed-loop poles as functions of a gain.

use crate::matrices::C;
use crate::{Error, StateSpace};
use nalgebra::DMatrix;

/// Closed-loop poles under negative feedback as functions of the gain `k`, ordered by branch.
#[derive(Clone, Debug, PartialEq)]
pub struct RootLocus {
    /// Gains of the root locus, in ascending order.
    pub gains: Vec<f64>,
    /// Branches of the root locus: for each branch, the closed-loop pole at every gain.
    pub branches: Vec<Vec<C>>,
    /// Poles of the open loop, at which branches begin.
    pub poles: Vec<C>,
    /// Zeros of the open loop, at which branches end.
    pub zeros: Vec<C>,
    /// Sampling period of a discrete system, s.
    pub period: Option<f64>,
}

/// Orders closed-loop poles by branch: each is matched with a near pole of the previous gain.
fn order_poles_along_branches(before: &[C], mut now: Vec<C>) -> Vec<C> {
    let mut order = vec![C::new(0.0, 0.0); before.len()];
    let mut free: Vec<usize> = (0..before.len()).collect();
    // The nearest pair is matched first, so that no branch continues into another.
    while !free.is_empty() && !now.is_empty() {
        let pairs = free
            .iter()
            .enumerate()
            .flat_map(|(i, f)| now.iter().enumerate().map(move |(j, p)| (i, j, (before[*f] - p).norm())));
        let Some((i, j, _)) = pairs.min_by(|a, b| a.2.total_cmp(&b.2)) else { break };
        order[free.swap_remove(i)] = now.swap_remove(j);
    }
    order
}

impl StateSpace {
    /// Computes the closed-loop poles under the feedback `u = r − k y` for these gains `k`.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] unless the system has one input and one output, [`Error::AlgebraicLoop`] at a gain of
    /// `−1 / D`.
    pub fn root_locus(&self, gains: &[f64]) -> Result<RootLocus, Error> {
        self.check_single_input_and_output()?;
        let (poles, zeros) = (self.poles()?, self.zeros()?);
        let mut branches: Vec<Vec<C>> = vec![Vec::new(); poles.len()];
        let mut before = poles.clone();
        for k in gains {
            let closed = self.feedback_gain(&DMatrix::from_element(1, 1, *k))?;
            before = order_poles_along_branches(&before, closed.poles()?);
            branches.iter_mut().zip(&before).for_each(|(branch, pole)| branch.push(*pole));
        }
        Ok(RootLocus { gains: gains.to_vec(), branches, poles, zeros, period: self.period })
    }

    /// Returns gains that resolve the root locus. They are zero, then logarithmically spaced from where poles
    /// begin to move to where they are near zeros or far away. Intervals in which a pole moves by more than a
    /// fortieth of the largest pole or zero are refined.
    ///
    /// # Errors
    ///
    /// As for [`root_locus`](Self::root_locus).
    pub fn locus_gains(&self) -> Result<Vec<f64>, Error> {
        self.check_single_input_and_output()?;
        let poles = self.poles()?;
        let all = poles.iter().copied().chain(self.zeros()?);
        let size = all.map(|x| x.norm()).fold(1e-6, f64::max);
        let distance_from_open_loop_poles = |k: f64| -> Result<f64, Error> {
            let closed = self.feedback_gain(&DMatrix::from_element(1, 1, k))?.poles()?;
            Ok(order_poles_along_branches(&poles, closed)
                .iter()
                .zip(&poles)
                .map(|(a, b)| (a - b).norm())
                .fold(0.0, f64::max))
        };
        let (mut low, mut high) = (1.0, 1.0);
        for _ in 0..60 {
            if distance_from_open_loop_poles(low)? <= 0.01 * size {
                break;
            }
            low *= 0.4;
        }
        for _ in 0..60 {
            if distance_from_open_loop_poles(high)? >= 4.0 * size {
                break;
            }
            high *= 2.5;
        }
        // If all branches end in zeros, no pole moves far.
        high = high.min(1e6 * low.max(1e-9)).max(10.0 * low);
        let mut gains = vec![0.0];
        gains.extend(crate::logarithmic(low, high, 80)?);
        for _ in 0..6 {
            let locus = self.root_locus(&gains)?;
            let is_coarse_interval =
                |k: usize| locus.branches.iter().any(|b| (b[k] - b[k - 1]).norm() > 0.025 * size);
            let more: Vec<f64> = (1..gains.len())
                .filter(|k| is_coarse_interval(*k))
                .map(|k| 0.5 * (gains[k - 1] + gains[k]))
                .collect();
            if more.is_empty() || gains.len() > 1500 {
                break;
            }
            gains.extend(more);
            gains.sort_by(f64::total_cmp);
        }
        Ok(gains)
    }
}

//! Assembly: computes states that satisfy the constraints, near a given state and with some entries fixed.

use crate::constrained::Metric;
use crate::evaluate::{Evaluated, Values};
use linkwork::nalgebra::DMatrix;
use linkwork_compiler::mechanism::Chart;
use std::f64::consts::PI;
use std::ops::Range;

/// Relative residual above which velocities contradict a constraint.
const CONTRADICTION: f64 = 1e-6;
/// Maximum residual of a configuration that satisfies the constraints, m and rad.
const SETTLED: f64 = 1e-12;
/// Maximum residual of a configuration after whole revolutions were subtracted from its angles, m and rad.
const UNWOUND: f64 = 1e-10;
/// Maximum number of Newton steps.
const ATTEMPTS: usize = 50;
/// Minimum fraction of a Newton step; the line search fails below it.
const SHORTEST: f64 = 1e-6;
/// Minimum decrease of the residuals for which a step is accepted, relative to the decrease that the linear
/// equations predict.
const DECREASE: f64 = 1e-4;
/// Number of steps in which the given entries move to their values.
const STEPS: u8 = 40;
/// Number of perturbed initial configurations from which a mechanism is assembled.
const ASSEMBLIES: u8 = 100;
/// Maximum step of an angle, rad. Short steps lead from an initial configuration near an assembly mode into
/// that mode.
const LONGEST: f64 = 0.3;
/// Absolute value below which the determinant of a matrix with rows of length one counts as zero.
const SINGULAR: f64 = 1e-9;

impl Evaluated<'_, '_> {
    /// Projects a state onto the constraints: the configuration, then the velocity. `None` if no such state
    /// is near.
    pub fn settle(&self, t: f64, q: &mut Vec<f64>, v: &mut [f64]) -> Option<()> {
        if !self.is_constrained() {
            return Some(());
        }
        let free = vec![false; v.len()];
        self.configure(t, q, &free)?;
        self.move_along(t, q, v, &free)
    }

    /// Iterates over the ranges of configuration entries that change together, with their velocities: the
    /// entries of a rotation, or the position of a free body.
    fn together(&self) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        self.model
            .charts
            .iter()
            .flat_map(|chart| match *chart {
                Chart::Plain(at, from) => [Some((at.and_next(1), from.and_next(1))), None],
                Chart::Ball(at, from) => [Some((at.and_next(4), from.and_next(3))), None],
                Chart::Free(at, from) => [
                    Some((at.and_next(3), from.and_next(3))),
                    Some(((at + 3).and_next(4), (from + 3).and_next(3))),
                ],
            })
            .flatten()
    }

    /// Returns which velocities of joints change marked entries of a configuration, or entries that change
    /// together with them.
    pub fn moving(&self, marks: &[bool]) -> Vec<bool> {
        let mut moving = vec![false; self.model.nv()];
        for (entries, velocities) in self.together() {
            moving[velocities].fill(marks[entries].contains(&true));
        }
        moving
    }

    /// Returns which entries of a configuration are changed by marked velocities of joints only.
    pub fn entries(&self, marks: &[bool]) -> Vec<bool> {
        let mut found = vec![false; self.model.nq()];
        for (entries, velocities) in self.together() {
            found[entries].fill(!marks[velocities].contains(&false));
        }
        found
    }

    /// Returns which velocities affect no constraint, at this configuration and near it. The first list has
    /// the velocities of the joints, the second the entries of `v`, which differ if generalized speeds are
    /// declared.
    pub fn unreached(&self, t: f64, q: &[f64]) -> [Vec<bool>; 2] {
        [true, false].map(|of_joints| self.unreached_of(t, q, of_joints))
    }

    fn unreached_of(&self, t: f64, q: &[f64], of_joints: bool) -> Vec<bool> {
        let v = vec![0.0; self.model.nv()];
        let mut unreached = vec![true; v.len()];
        for size in [0.0, 0.1] {
            let mut beside: Vec<f64> = q.iter().enumerate().map(|(k, x)| x + size * beside(1, k)).collect();
            if self.normalise(&mut beside).is_err() {
                continue;
            }
            let state = Values { t, q: &beside, v: &v, ..Values::default() };
            let jacobian = self.called("constraint_jacobian", state).map(|jacobian| match of_joints {
                true => self.by_joints(state, jacobian),
                false => jacobian,
            });
            let all = self.model.constraints.len();
            for (column, unreached) in
                jacobian.iter().flat_map(|jacobian| jacobian.chunks(all)).zip(&mut unreached)
            {
                *unreached &= column.iter().all(|entry| *entry == 0.0);
            }
        }
        unreached
    }

    /// Returns a configuration with the given entries, reached in small steps from the configuration on the
    /// constraints that is nearest to zero, so that a loop stays in the assembly mode of that configuration.
    /// If the given entries contradict the constraints, the result violates them.
    pub fn led(&self, t: f64, q: &[f64], given: &[bool], apart: &[bool], held: &[bool]) -> Vec<f64> {
        let mut zero = self.neutral();
        let is_apart = self.entries(apart);
        for k in (0..q.len()).filter(|k| is_apart[*k]) {
            zero[k] = q[k];
        }
        let Some(begin) = self.assembled(t, (&zero, &zero), &is_apart, apart) else { return q.to_vec() };
        let mut at = begin.clone();
        for step in 1..=STEPS {
            let part = f64::from(step) / f64::from(STEPS);
            for k in (0..q.len()).filter(|k| given[*k]) {
                at[k] = if step == STEPS { q[k] } else { begin[k] + (q[k] - begin[k]) * part };
            }
            if self.normalise(&mut at).is_err() {
                return q.to_vec();
            }
            // The nearest configuration that Newton's method reaches.
            _ = self.configure(t, &mut at, held);
        }
        at
    }

    /// Returns a configuration on the constraints. The iteration starts from `q`, then from increasingly
    /// perturbed values of the entries that are not held. The first result whose angles are within half a
    /// revolution of the guess is preferred.
    pub fn assembled(
        &self,
        t: f64,
        (q, guess): (&[f64], &[f64]),
        given: &[bool],
        held: &[bool],
    ) -> Option<Vec<f64>> {
        let mut far = None;
        let found = (0..=ASSEMBLIES).find_map(|attempt| {
            let mut from = q.to_vec();
            let size = 0.02 * f64::from(attempt);
            for (k, x) in from.iter_mut().enumerate().filter(|(k, _)| !given[*k]) {
                *x += size * beside(attempt, k);
            }
            self.normalise(&mut from).ok()?;
            self.configure(t, &mut from, held)?;
            let found = self.unwound(t, guess, from);
            let is_near = self.angles().all(|k| (found[k] - guess[k]).abs() <= PI + SETTLED);
            if is_near {
                return Some(found);
            }
            far.get_or_insert(found);
            None
        });
        found.or(far)
    }

    /// Iterates over the indices of configuration entries that are angles.
    fn angles(&self) -> impl Iterator<Item = usize> {
        let units = self.model.units.configuration.iter().enumerate();
        units.filter(|(_, unit)| *unit == "rad").map(|(k, _)| k)
    }

    /// Subtracts whole revolutions from angles that differ by more than half a revolution from the guess, if
    /// the constraints remain satisfied: from all angles together, or otherwise from each one separately.
    fn unwound(&self, t: f64, guess: &[f64], q: Vec<f64>) -> Vec<f64> {
        let v = vec![0.0; self.model.nv()];
        let without = |mut q: Vec<f64>, k: usize| {
            q[k] -= 2.0 * PI * ((q[k] - guess[k]) / (2.0 * PI)).round();
            q
        };
        let holds = |q: &[f64]| {
            let left = self.called("constraint_residuals", Values { t, q, v: &v, ..Values::default() });
            left.is_some_and(|left| left.iter().all(|x| x.abs() <= UNWOUND))
        };
        let all = self.angles().fold(q.clone(), without);
        if all == q || holds(&all) {
            return all;
        }
        self.angles().fold(q, |q, k| {
            let next = without(q.clone(), k);
            if holds(&next) { next } else { q }
        })
    }

    /// Returns the assembly mode of a configuration, as generated code computes it: the sign of the
    /// determinant of the derivatives of the constraints with respect to the coordinates that are not held.
    /// `None` if the constraints do not determine these coordinates, or if the determinant is zero.
    pub fn assembly_mode(&self, t: f64, q: &[f64], held: &[bool]) -> Option<i8> {
        let v = vec![0.0; held.len()];
        let state = Values { t, q, v: &v, ..Values::default() };
        let all = self.model.constraints.len();
        let open = self.model.holonomic();
        let jacobian = self.called("constraint_jacobian", state)?;
        let free: Vec<usize> = (0..held.len()).filter(|k| !held[*k]).collect();
        let fixed: Vec<usize> = (0..held.len()).filter(|k| held[*k]).collect();
        if open == 0 || open != free.len() {
            return None;
        }
        let mut rows = DMatrix::from_fn(held.len(), held.len(), |i, j| match i.checked_sub(open) {
            Some(k) if fixed[k] == j => 1.0,
            None if !held[j] => jacobian[j * all + i],
            _ => 0.0,
        });
        rows.row_iter_mut().for_each(|mut row| {
            let length = row.norm();
            row /= length;
        });
        let determinant = rows.determinant();
        (determinant.abs() > SINGULAR).then_some(if determinant > 0.0 { 1 } else { -1 })
    }

    /// Projects a configuration onto the constraints by Newton's method, with minimum steps in the metric of
    /// the mass matrix and without changing held velocities. Steps that do not reduce the residuals are
    /// halved.
    fn configure(&self, t: f64, q: &mut Vec<f64>, held: &[bool]) -> Option<()> {
        let v = vec![0.0; held.len()];
        let residuals = |q: &[f64]| {
            let found = self.called("constraint_residuals", Values { t, q, v: &v, ..Values::default() })?;
            found.iter().all(|x| x.is_finite()).then_some(found)
        };
        let mut left = residuals(q)?;
        for _ in 0..ATTEMPTS {
            if left.iter().all(|x| x.abs() <= SETTLED) {
                return Some(());
            }
            let state = Values { t, q, v: &v, ..Values::default() };
            let (all, positions) = (self.model.constraints.len(), left.len());
            let jacobian = self.by_joints(state, self.called("constraint_jacobian", state)?);
            // Position-level constraints come first.
            let jacobian: Vec<f64> =
                jacobian.chunks(all).flat_map(|column| &column[..positions]).copied().collect();
            let target: Vec<f64> = left.iter().map(|x| -x).collect();
            let mass = self.called("mass_matrix", state)?;
            let mass = self.by_joints(state, transposed(&self.by_joints(state, mass), held.len()));
            let (moved, _) = nearest(&mass, &jacobian, &target, held)?;
            let rates = self.rates_of_joints(q, &moved);
            // The units of declared generalized speeds do not distinguish rotations from translations.
            let units = self.model.speeds.is_none().then_some(&self.model.units.velocities);
            let rotations =
                moved.iter().zip(units.into_iter().flatten()).filter(|(_, unit)| *unit == "rad/s");
            let longest = rotations.fold(0.0_f64, |longest, (rotation, _)| longest.max(rotation.abs()));
            let mut part = (LONGEST / longest).min(1.0);
            (*q, left) = loop {
                let mut next: Vec<f64> = q.iter().zip(&rates).map(|(q, rate)| q + part * rate).collect();
                self.normalise(&mut next).ok()?;
                match residuals(&next) {
                    Some(found) if norm(&found) <= (1.0 - DECREASE * part) * norm(&left) => {
                        break (next, found);
                    }
                    _ if part < SHORTEST => return None,
                    _ => part /= 2.0,
                }
            };
        }
        None
    }

    /// Changes the velocities that are not held by the minimum amount that satisfies the constraints. `None`
    /// if the held velocities contradict the constraints.
    pub fn move_along(&self, t: f64, q: &[f64], v: &mut [f64], held: &[bool]) -> Option<()> {
        let state = Values { t, q, v, ..Values::default() };
        let target: Vec<f64> = self.called("constraint_rates", state)?.iter().map(|rate| -rate).collect();
        let jacobian = self.called("constraint_jacobian", state)?;
        let (change, off) = nearest(&self.called("mass_matrix", state)?, &jacobian, &target, held)?;
        v.iter_mut().zip(change).for_each(|(v, change)| *v += change);
        (off <= CONTRADICTION).then_some(())
    }

    /// Converts a matrix in column-major order that multiplies `v` to one that multiplies the velocities of
    /// the joints.
    fn by_joints(&self, state: Values<'_>, matrix: Vec<f64>) -> Vec<f64> {
        let n = self.model.nv();
        if self.model.speeds.is_none() || n == 0 {
            return matrix;
        }
        let rows = matrix.len() / n;
        let column = |k: usize| {
            let unit: Vec<f64> = (0..n).map(|j| f64::from(u8::from(j == k))).collect();
            let speeds = self.called("speeds_of_rates", Values { v: &unit, ..state }).unwrap_or_default();
            let entry = |i: usize| speeds.iter().enumerate().map(|(j, s)| matrix[j * rows + i] * s).sum();
            (0..rows).map(entry).collect::<Vec<f64>>()
        };
        (0..n).flat_map(column).collect()
    }
}

/// Returns the minimum motion of the velocities that are not held with `jacobian · motion = target`, in the
/// metric of the mass matrix, and the largest residual.
fn nearest(mass: &[f64], jacobian: &[f64], target: &[f64], held: &[bool]) -> Option<(Vec<f64>, f64)> {
    let (n, m) = (held.len(), target.len());
    let free: Vec<usize> = (0..n).filter(|k| !held[*k]).collect();
    let mass: Vec<f64> =
        free.iter().flat_map(|j| free.iter().map(move |i| j * n + i)).map(|at| mass[at]).collect();
    let jacobian: Vec<f64> = free.iter().flat_map(|k| &jacobian[k * m..(k + 1) * m]).copied().collect();
    let (x, off) = Metric::of(&mass, free.len())?.nearest(vec![0.0; free.len()], &jacobian, target);
    let mut motion = vec![0.0; n];
    free.iter().zip(x).for_each(|(k, x)| motion[*k] = x);
    Some((motion, off))
}

/// Transposes a square matrix.
fn transposed(matrix: &[f64], n: usize) -> Vec<f64> {
    (0..n).flat_map(|i| (0..n).map(move |j| j * n + i)).map(|at| matrix[at]).collect()
}

/// Returns a number from −1 to 1 of a sequence that does not repeat (multiples of irrational fractions).
fn beside(attempt: u8, k: usize) -> f64 {
    2.0 * (f64::from(attempt) * 0.618 + k as f64 * 0.755).fract() - 1.0
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

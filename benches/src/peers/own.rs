//! Generated functions as contenders.

use super::code;
use super::contender::{Contender, Owner};
use crate::states::State;
use linkwork::nalgebra::SMatrix;
use std::hint::black_box;
use std::rc::Rc;

/// A function of the mechanism `M`.
pub type Call<M, R, const NQ: usize, const NV: usize> = fn(&M, &State<NQ, NV>) -> R;

/// A generated function with the mechanism that it belongs to.
pub struct Own<M, R, const NQ: usize, const NV: usize> {
    /// Whether the mechanism has parameters.
    pub owner: Owner,
    /// The mechanism.
    pub mechanism: M,
    /// What it is called on.
    pub states: Rc<Vec<State<NQ, NV>>>,
    /// The function's name.
    pub name: &'static str,
    /// The function.
    pub call: Call<M, R, NQ, NV>,
}

impl<M, R: Flat, const NQ: usize, const NV: usize> Contender for Own<M, R, NQ, NV> {
    fn owner(&self) -> Owner {
        self.owner
    }

    fn variant(&self) -> String {
        String::new()
    }

    fn pass(&mut self) {
        for state in self.states.iter() {
            let result = (self.call)(black_box(&self.mechanism), black_box(state));
            black_box(&result);
        }
    }

    fn result(&mut self, state: usize) -> Vec<f64> {
        (self.call)(&self.mechanism, &self.states[state]).flat()
    }

    fn bytes(&self) -> Option<u64> {
        code::bytes::<M>(self.call as *const (), self.name)
    }
}

/// A generated function that puts its results into `K` matrices, which keep their zeros.
pub struct Keeping<M, const NQ: usize, const NV: usize, const K: usize> {
    /// The mechanism.
    pub mechanism: M,
    /// What it is called on.
    pub states: Rc<Vec<State<NQ, NV>>>,
    /// The function's name.
    pub name: &'static str,
    /// The function.
    pub call: fn(&M, &State<NQ, NV>, &mut [SMatrix<f64, NV, NV>; K]),
    /// The matrices.
    pub matrices: [SMatrix<f64, NV, NV>; K],
}

impl<M, const NQ: usize, const NV: usize, const K: usize> Contender for Keeping<M, NQ, NV, K> {
    fn owner(&self) -> Owner {
        Owner::Kept
    }

    fn variant(&self) -> String {
        String::new()
    }

    fn pass(&mut self) {
        for state in self.states.iter() {
            (self.call)(black_box(&self.mechanism), black_box(state), &mut self.matrices);
            black_box(&self.matrices);
        }
    }

    fn result(&mut self, state: usize) -> Vec<f64> {
        (self.call)(&self.mechanism, &self.states[state], &mut self.matrices);
        self.matrices.iter().flat_map(Flat::flat).collect()
    }

    fn bytes(&self) -> Option<u64> {
        code::bytes::<M>(self.call as *const (), self.name)
    }
}

/// Results as lists.
pub trait Flat {
    /// All numbers, column by column.
    fn flat(&self) -> Vec<f64>;
}

impl<const R: usize, const C: usize> Flat for SMatrix<f64, R, C> {
    fn flat(&self) -> Vec<f64> {
        self.as_slice().to_vec()
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn flat(&self) -> Vec<f64> {
        [self.0.flat(), self.1.flat()].concat()
    }
}

impl<A: Flat, B: Flat, C: Flat> Flat for (A, B, C) {
    fn flat(&self) -> Vec<f64> {
        [self.0.flat(), self.1.flat(), self.2.flat()].concat()
    }
}

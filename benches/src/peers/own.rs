//! Contenders of the comparison that call generated functions.

use super::code;
use super::contender::{Contender, Owner};
use crate::states::State;
use linkwork::nalgebra::SMatrix;
use std::hint::black_box;
use std::rc::Rc;

/// Closure type that calls one function of the mechanism `M` at a state.
pub type MechanismCall<M, R, const NQ: usize, const NV: usize> = fn(&M, &State<NQ, NV>) -> R;

/// Contender that calls a generated function of a mechanism.
pub struct GeneratedContender<M, R, const NQ: usize, const NV: usize> {
    /// Variant of the generated code: with or without parameters.
    pub owner: Owner,
    /// Mechanism whose function is called.
    pub mechanism: M,
    /// States at which the function is called.
    pub states: Rc<Vec<State<NQ, NV>>>,
    /// Name of the generated function that is called.
    pub name: &'static str,
    /// Closure that calls the generated function.
    pub call: MechanismCall<M, R, NQ, NV>,
}

impl<M, R: Flat, const NQ: usize, const NV: usize> Contender for GeneratedContender<M, R, NQ, NV> {
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
        (self.call)(&self.mechanism, &self.states[state]).to_number_list()
    }

    fn bytes(&self) -> Option<u64> {
        code::machine_code_bytes::<M>(self.call as *const (), self.name)
    }
}

/// Generated function that writes its results to `K` matrices with permanent zeros.
pub struct MatrixContender<M, const NQ: usize, const NV: usize, const K: usize> {
    /// Mechanism whose function is called.
    pub mechanism: M,
    /// States at which the function is called.
    pub states: Rc<Vec<State<NQ, NV>>>,
    /// Name of the generated function that is called.
    pub name: &'static str,
    /// Closure that calls the generated function and writes its matrices.
    pub call: fn(&M, &State<NQ, NV>, &mut [SMatrix<f64, NV, NV>; K]),
    /// Matrices to which the generated function writes its results.
    pub matrices: [SMatrix<f64, NV, NV>; K],
}

impl<M, const NQ: usize, const NV: usize, const K: usize> Contender for MatrixContender<M, NQ, NV, K> {
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
        self.matrices.iter().flat_map(Flat::to_number_list).collect()
    }

    fn bytes(&self) -> Option<u64> {
        code::machine_code_bytes::<M>(self.call as *const (), self.name)
    }
}

/// Conversion of results to lists of numbers.
pub trait Flat {
    /// Returns all numbers in column-major order.
    fn to_number_list(&self) -> Vec<f64>;
}

impl<const R: usize, const C: usize> Flat for SMatrix<f64, R, C> {
    fn to_number_list(&self) -> Vec<f64> {
        self.as_slice().to_vec()
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn to_number_list(&self) -> Vec<f64> {
        [self.0.to_number_list(), self.1.to_number_list()].concat()
    }
}

impl<A: Flat, B: Flat, C: Flat> Flat for (A, B, C) {
    fn to_number_list(&self) -> Vec<f64> {
        [self.0.to_number_list(), self.1.to_number_list(), self.2.to_number_list()].concat()
    }
}

//! Contenders of the comparison that call generated functions.

use super::code;
use super::contender::{Contender, ContenderOwner};
use crate::states::State;
use linkwork::nalgebra::SMatrix;
use std::hint::black_box;
use std::rc::Rc;

/// Closure type that calls one function of the mechanism `M` at a state.
pub type MechanismCall<M, R, const NQ: usize, const NV: usize> = fn(&M, &State<NQ, NV>) -> R;

/// Contender that calls a generated function of a mechanism.
pub struct GeneratedContender<M, R, const NQ: usize, const NV: usize> {
    /// Variant of the generated code: with or without parameters.
    pub owner: ContenderOwner,
    /// Mechanism whose function is called.
    pub mechanism: M,
    /// States at which the function is called.
    pub states: Rc<Vec<State<NQ, NV>>>,
    /// Name of the generated function that is called.
    pub name: &'static str,
    /// Closure that calls the generated function.
    pub call: MechanismCall<M, R, NQ, NV>,
}

impl<M, R: ToNumberList, const NQ: usize, const NV: usize> Contender for GeneratedContender<M, R, NQ, NV> {
    fn owner(&self) -> ContenderOwner {
        self.owner
    }

    fn variant_name(&self) -> String {
        String::new()
    }

    fn evaluate_all_states(&mut self) {
        for state in self.states.iter() {
            let result = (self.call)(black_box(&self.mechanism), black_box(state));
            black_box(&result);
        }
    }

    fn result_at_state(&mut self, state: usize) -> Vec<f64> {
        (self.call)(&self.mechanism, &self.states[state]).flatten()
    }

    fn machine_code_size(&self) -> Option<u64> {
        code::machine_code_size::<M>(self.call as *const (), self.name)
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
    fn owner(&self) -> ContenderOwner {
        ContenderOwner::Kept
    }

    fn variant_name(&self) -> String {
        String::new()
    }

    fn evaluate_all_states(&mut self) {
        for state in self.states.iter() {
            (self.call)(black_box(&self.mechanism), black_box(state), &mut self.matrices);
            black_box(&self.matrices);
        }
    }

    fn result_at_state(&mut self, state: usize) -> Vec<f64> {
        (self.call)(&self.mechanism, &self.states[state], &mut self.matrices);
        self.matrices.iter().flat_map(ToNumberList::flatten).collect()
    }

    fn machine_code_size(&self) -> Option<u64> {
        code::machine_code_size::<M>(self.call as *const (), self.name)
    }
}

/// Conversion of results to lists of numbers.
pub trait ToNumberList {
    /// Returns all numbers in column-major order.
    fn flatten(&self) -> Vec<f64>;
}

impl<const R: usize, const C: usize> ToNumberList for SMatrix<f64, R, C> {
    fn flatten(&self) -> Vec<f64> {
        self.as_slice().to_vec()
    }
}

impl<A: ToNumberList, B: ToNumberList> ToNumberList for (A, B) {
    fn flatten(&self) -> Vec<f64> {
        [self.0.flatten(), self.1.flatten()].concat()
    }
}

impl<A: ToNumberList, B: ToNumberList, C: ToNumberList> ToNumberList for (A, B, C) {
    fn flatten(&self) -> Vec<f64> {
        [self.0.flatten(), self.1.flatten(), self.2.flatten()].concat()
    }
}

//! Replacement of the code generator on unsupported processors, where programs are interpreted.

use crate::AnyTable;
use crate::layout::InputLayout;
use linkwork_compiler::lower::Program;

/// Compiled program on unsupported processors: this type has no values.
pub(crate) enum Code {}

impl Code {
    /// Returns an error, because no code generator exists for this processor.
    pub fn compile(_program: &Program, _layout: &InputLayout, _results: usize) -> Result<Code, String> {
        Err("there is no code generator for this processor".to_string())
    }

    /// Evaluates the program. It is never called, because no machine code exists on such processors.
    pub fn call(&self, _: &[f64], _: &[&[f64]], _: &[AnyTable], _: &mut [f64], _: &mut [f64]) {
        match *self {}
    }

    /// Evaluates the program if arguments have the right lengths. It is never called.
    pub fn call_if_lengths_match(
        &self,
        _: &[f64],
        _: &[&[f64]],
        _: &[usize],
        _: &[AnyTable],
        _: &mut [f64],
    ) -> bool {
        match *self {}
    }
}

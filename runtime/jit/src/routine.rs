//! Program of a function with its machine code, which is generated at the first call.

use crate::AnyTable;
use crate::code::Code;
use crate::layout::InputLayout;
use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::expr::Lookup;
use linkwork_compiler::lower::Program;
use std::sync::OnceLock;

/// Program of a function with the layout of its inputs, and its machine code once compiled.
pub(crate) struct Routine {
    program: OnceLock<Program>,
    layout: InputLayout,
    /// Number of the program's outputs that are results of the function.
    results: usize,
    code: OnceLock<Option<Code>>,
}

/// Values with which a program is evaluated.
#[derive(Clone, Copy)]
pub(crate) struct Values<'a> {
    /// Parameters of the mechanism, which are the first input of the program.
    pub parameters: &'a [f64],
    /// Arguments of the function, which are the further inputs of the program.
    pub arguments: &'a [&'a [f64]],
    /// Interpolation tables that the program reads.
    pub tables: &'a [AnyTable],
    /// Whether programs are interpreted instead of compiled.
    pub interpreted: bool,
}

impl Routine {
    /// Returns the routine of a program whose first `results` outputs are results of the function; `None` if
    /// the function has too many arguments.
    pub fn new(program: Program, arguments: &[Argument], results: usize) -> Option<Routine> {
        let routine = Routine::routine_built_on_demand(arguments, results)?;
        Some(Routine { program: OnceLock::from(program), ..routine })
    }

    /// Returns the routine of a program that is built at the first call.
    pub fn routine_built_on_demand(arguments: &[Argument], results: usize) -> Option<Routine> {
        let layout = InputLayout::new(arguments)?;
        Some(Routine { program: OnceLock::new(), layout, results, code: OnceLock::new() })
    }

    /// Builds the program of the routine by `make`, unless it exists already.
    pub fn build_program_once(&self, make: impl FnOnce() -> Program) {
        self.program.get_or_init(make);
    }

    /// Returns the program of the routine, if it has been built.
    pub fn program(&self) -> Option<&Program> {
        self.program.get()
    }

    /// Generates the machine code of the routine at the first call. Returns false if the program is
    /// interpreted.
    pub fn compile_once(&self) -> bool {
        let compile_program = || Code::compile(self.program.get()?, &self.layout, self.results).ok();
        self.code.get_or_init(compile_program).is_some()
    }

    /// Returns the machine code of the routine, if it has been generated.
    #[inline]
    pub fn code(&self) -> Option<&Code> {
        self.code.get()?.as_ref()
    }

    /// Evaluates the program by machine code or by the interpreter. Writes the function's results to
    /// `results` and the further outputs to `more`.
    #[inline]
    pub fn run(&self, values: Values<'_>, results: &mut [f64], more: &mut [f64]) {
        match self.code() {
            Some(code) if !values.interpreted => {
                code.call(values.parameters, values.arguments, values.tables, results, more);
            }
            _ => self.compile_and_run_or_interpret(values, results, more),
        }
    }

    /// Evaluates a program that is interpreted or that has no machine code yet.
    #[cold]
    fn compile_and_run_or_interpret(&self, values: Values<'_>, results: &mut [f64], more: &mut [f64]) {
        match !values.interpreted && self.compile_once() {
            true => self.run(values, results, more),
            false => self.interpret_program(values, results, more),
        }
    }

    fn interpret_program(&self, values: Values<'_>, results: &mut [f64], more: &mut [f64]) {
        let Some(program) = self.program.get() else { return };
        let value_of_symbol = |symbol| {
            let value = self.layout.locate_symbol(symbol).and_then(|(slot, index)| match slot {
                0 => values.parameters.get(index),
                _ => values.arguments.get(slot - 1)?.get(index),
            });
            value.copied().unwrap_or(f64::NAN)
        };
        let value_of_table = |lookup: Lookup, x| {
            let table = values.tables.get(lookup.table_index());
            table.map_or(f64::NAN, |table| {
                table.value_or_derivative(x, [0, 1, 2].map(|k| lookup.derivative_order(k) as u8))
            })
        };
        let outputs = program.interpret_with_tables(&value_of_symbol, &value_of_table);
        let places = results[..self.results].iter_mut().chain(more);
        places.zip(outputs).for_each(|(place, value)| *place = value);
    }
}

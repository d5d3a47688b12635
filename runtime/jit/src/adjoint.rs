//! Vector–Jacobian products of functions: programs in reverse order (Griewank and Walther, *Evaluating
//! Derivatives*, 2008, chapter 3).

use crate::adjoint_steps;
use crate::error::Error;
use crate::functions::ResultAssembly;
use crate::robot::{Function, Robot};
use crate::routine::{Routine, Values};
use crate::shared::SharedMechanism;
use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::expr::{Extreme, Function as Elementary, Symbol, air};
use linkwork_compiler::lower::{Op, Operand, Program};
use linkwork_compiler::mechanism::{Quantity, SuppliedQuantity};
use std::collections::HashMap;
use std::sync::Arc;

/// Name of the argument with the factors of the results.
const FACTORS: &str = "factors";

/// Vector–Jacobian product of a function: derivatives of a weighted sum of its results with respect to all
/// arguments and parameters. They treat all entries of quaternions as independent, and are exact up to
/// rounding errors.
pub struct VectorJacobian {
    shared: Arc<SharedMechanism>,
    name: String,
    kind: VectorJacobianMethod,
    /// Number of entries of each argument of the function.
    arguments: Vec<usize>,
    factors: usize,
    parameters: usize,
}

/// Method by which a vector–Jacobian product is computed: a reversed program, or a function of the
/// configuration space.
enum VectorJacobianMethod {
    ReverseModeProgram(Box<Routine>),
    Integrate,
    Difference,
    TangentRate,
}

impl std::fmt::Debug for VectorJacobian {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "VectorJacobian({})", self.name)
    }
}

impl Function {
    /// Returns the vector–Jacobian product of the function.
    ///
    /// # Errors
    ///
    /// The function is composed of matrices of derivatives, or solves for constraint forces; or velocities
    /// are generalized speeds, and the function moves configurations.
    pub fn vector_jacobian(&self) -> Result<VectorJacobian, Error> {
        let entry = &self.shared_mechanism().entries[self.index()];
        let missing_adjoint_error =
            || Error::Value(format!("`{}` has no vector–Jacobian product", entry.name));
        let parameters = self.shared_mechanism().parameters.len();
        let sizes = self.shared_mechanism().sizes;
        let arguments: Vec<usize> = entry.arguments.iter().map(|a| sizes.length(*a)).collect();
        let program = match &entry.plan {
            ResultAssembly::Program(routine) => routine.program(),
            ResultAssembly::Frame(access, frame, routine) => {
                routine.build_program_once(|| self.shared_mechanism().frames.program(*access, *frame));
                routine.program()
            }
            _ => None,
        };
        let kind = match (program, entry.name.as_str()) {
            (Some(_), _) if entry.takes_features => return Err(missing_adjoint_error()),
            (Some(program), _) => {
                let inputs = parameters + arguments.iter().sum::<usize>();
                let given = Argument::Given(FACTORS, SuppliedQuantity::ResultFactor, entry.length);
                let all: Vec<Argument> = entry.arguments.iter().copied().chain([given]).collect();
                let symbols = entry.arguments.iter().flat_map(|argument| {
                    (0..sizes.length(*argument)).map(|k| symbol_of_entry(*argument, k)).collect::<Vec<_>>()
                });
                let symbols = symbols.chain((0..parameters).map(|k| Some(Quantity::Parameter(k).symbol())));
                let reversed = reverse_program(program, symbols).ok_or_else(missing_adjoint_error)?;
                VectorJacobianMethod::ReverseModeProgram(Box::new(
                    Routine::new(reversed, &all, inputs).ok_or_else(missing_adjoint_error)?,
                ))
            }
            (None, _) if self.shared_mechanism().has_speeds => return Err(missing_adjoint_error()),
            (None, "integrate") => VectorJacobianMethod::Integrate,
            (None, "difference") => VectorJacobianMethod::Difference,
            (None, "tangent_rate") => VectorJacobianMethod::TangentRate,
            _ => return Err(missing_adjoint_error()),
        };
        Ok(VectorJacobian {
            shared: self.shared_mechanism().clone(),
            name: entry.name.clone(),
            kind,
            arguments,
            factors: entry.length,
            parameters,
        })
    }
}

/// Returns the symbol of entry `k` of an argument.
fn symbol_of_entry(argument: Argument, k: usize) -> Option<Symbol> {
    let quantity = match argument {
        Argument::T => Quantity::Time,
        Argument::Q => Quantity::Configuration(k),
        Argument::V => Quantity::Velocity(k),
        Argument::A => Quantity::Acceleration(k),
        Argument::Tau => Quantity::Force(k),
        Argument::U => Quantity::Input(k),
        Argument::Given(_, block, _) => Quantity::Given(block, k),
        Argument::Standard(_) => Quantity::Given(SuppliedQuantity::Inertia, k),
        Argument::Factors(_) => Quantity::Given(SuppliedQuantity::Factor, k),
        Argument::Momenta(_) => Quantity::Momentum(k),
        Argument::Into(..) | Argument::Called(_) => return None,
    };
    Some(quantity.symbol())
}

impl VectorJacobian {
    /// Returns the number of derivatives: those with respect to all arguments in order, then those with
    /// respect to the parameters.
    #[must_use]
    pub fn length(&self) -> usize {
        self.arguments.iter().sum::<usize>() + self.parameters
    }

    /// Writes the derivatives with respect to the arguments one after the other, then with respect to the
    /// parameters. The factors are those of all results, in the order of the results of the function.
    ///
    /// # Errors
    ///
    /// A slice has the wrong length, or the robot belongs to another mechanism.
    pub fn evaluate_into(
        &self,
        robot: &Robot,
        arguments: &[&[f64]],
        factors: &[f64],
        out: &mut [f64],
    ) -> Result<(), Error> {
        robot.check_no_values_missing()?;
        if !Arc::ptr_eq(&self.shared, &robot.shared) {
            return Err(Error::OtherMechanism(self.name.clone()));
        }
        robot.check_length("arguments", self.arguments.len(), arguments.len())?;
        for (list, length) in arguments.iter().zip(&self.arguments) {
            robot.check_length("argument", *length, list.len())?;
        }
        robot.check_length(FACTORS, self.factors, factors.len())?;
        robot.check_length("derivatives", self.length(), out.len())?;
        let charts = &self.shared.charts;
        match &self.kind {
            VectorJacobianMethod::ReverseModeProgram(routine) => {
                let arguments: Vec<&[f64]> = arguments.iter().copied().chain([factors]).collect();
                let (parameters, tables) = (robot.parameter_values(), robot.interpolation_tables());
                let values = Values { parameters, arguments: &arguments, tables, interpreted: false };
                routine.run(values, out, &mut []);
            }
            _ => {
                out.fill(0.0);
                let (first, rest) = out.split_at_mut(self.arguments[0]);
                let second = &mut rest[..self.arguments[1]];
                let [a, b] = [arguments[0], arguments[1]];
                match self.kind {
                    VectorJacobianMethod::Integrate => {
                        adjoint_steps::add_integration_gradients(charts, a, b, factors, first, second)
                    }
                    VectorJacobianMethod::Difference => {
                        adjoint_steps::add_difference_gradients(charts, [a, b], factors, [first, second])
                    }
                    _ => adjoint_steps::add_tangent_rate_gradients(charts, [a, b], factors, [first, second]),
                }
            }
        }
        Ok(())
    }
}

/// Program followed by the instructions of its reverse-mode derivatives, while it is built.
struct ReverseModeProgram {
    instructions: Vec<Op>,
    /// Derivative with respect to the value of each instruction. The field below has the derivatives with
    /// respect to the inputs.
    values: Vec<Option<Operand>>,
    inputs: HashMap<Symbol, Operand>,
}

/// Returns the program of the derivatives with respect to the inputs; `None` if an instruction has no
/// derivative.
fn reverse_program(program: &Program, inputs: impl Iterator<Item = Option<Symbol>>) -> Option<Program> {
    let count = program.instructions.len();
    let mut reversed = ReverseModeProgram {
        instructions: program.instructions.clone(),
        values: vec![None; count],
        inputs: HashMap::new(),
    };
    for (k, output) in program.outputs.iter().enumerate() {
        reversed.add(*output, Operand::Symbol(Quantity::Given(SuppliedQuantity::ResultFactor, k).symbol()));
    }
    for k in (0..count).rev() {
        if let Some(factor) = reversed.values[k] {
            reversed.pass_derivative_on(program.instructions[k], Operand::Value(k), factor)?;
        }
    }
    let zero = Operand::Const(0.0);
    let outputs =
        inputs.map(|symbol| symbol.and_then(|symbol| reversed.inputs.get(&symbol).copied()).unwrap_or(zero));
    let outputs = outputs.collect();
    let mut program = Program { instructions: reversed.instructions, outputs, ..Program::default() };
    program.remove_unused_instructions();
    Some(program)
}

impl ReverseModeProgram {
    fn push_instruction(&mut self, op: Op) -> Operand {
        self.instructions.push(op);
        Operand::Value(self.instructions.len() - 1)
    }

    fn derivative_slot(&mut self, operand: Operand) -> Option<&mut Option<Operand>> {
        match operand {
            Operand::Value(k) => self.values.get_mut(k),
            _ => None,
        }
    }

    /// Returns the sum of the terms, so far, of the derivative with respect to an operand.
    fn accumulated_derivative(&mut self, operand: Operand) -> Option<Operand> {
        match operand {
            Operand::Symbol(symbol) => self.inputs.get(&symbol).copied(),
            operand => self.derivative_slot(operand).and_then(|known| *known),
        }
    }

    fn set_derivative(&mut self, operand: Operand, derivative: Operand) {
        match operand {
            Operand::Symbol(symbol) => {
                self.inputs.insert(symbol, derivative);
            }
            operand => {
                if let Some(known) = self.derivative_slot(operand) {
                    *known = Some(derivative);
                }
            }
        }
    }

    /// Adds a term to the derivative with respect to an operand.
    fn add(&mut self, operand: Operand, term: Operand) {
        if matches!(operand, Operand::Const(_)) {
            return;
        }
        let sum = match self.accumulated_derivative(operand) {
            None => term,
            Some(before) => self.push_instruction(Op::Add(before, term)),
        };
        self.set_derivative(operand, sum);
    }

    /// Subtracts a term from the derivative with respect to an operand.
    fn subtract_from_derivative(&mut self, operand: Operand, term: Operand) {
        if matches!(operand, Operand::Const(_)) {
            return;
        }
        let sum = match self.accumulated_derivative(operand) {
            None => self.push_instruction(Op::Neg(term)),
            Some(before) => self.push_instruction(Op::Sub(before, term)),
        };
        self.set_derivative(operand, sum);
    }

    /// Adds the product `a b` to the derivative with respect to an operand.
    fn add_product_to_derivative(&mut self, operand: Operand, a: Operand, b: Operand) {
        if matches!(operand, Operand::Const(_)) || a == Operand::Const(0.0) || b == Operand::Const(0.0) {
            return;
        }
        let sum = match self.accumulated_derivative(operand) {
            None => self.push_instruction(Op::Mul(a, b)),
            Some(before) => self.push_instruction(Op::MulAdd(a, b, before)),
        };
        self.set_derivative(operand, sum);
    }

    /// Subtracts the product `a b` from the derivative with respect to an operand.
    fn subtract_product_from_derivative(&mut self, operand: Operand, a: Operand, b: Operand) {
        if matches!(operand, Operand::Const(_)) || a == Operand::Const(0.0) || b == Operand::Const(0.0) {
            return;
        }
        let sum = match self.accumulated_derivative(operand) {
            None => {
                let product = self.push_instruction(Op::Mul(a, b));
                self.push_instruction(Op::Neg(product))
            }
            Some(before) => self.push_instruction(Op::NegMulAdd(a, b, before)),
        };
        self.set_derivative(operand, sum);
    }

    fn find_or_append_elementary_call(&mut self, f: Elementary, x: Operand) -> Operand {
        // Sines and cosines of one angle are computed once.
        let op = Op::Call(f, x);
        match self.instructions.iter().position(|known| *known == op) {
            Some(k) => Operand::Value(k),
            None => self.push_instruction(op),
        }
    }

    /// Propagates the derivative with respect to the value of an instruction to the operands of the
    /// instruction, as in reverse-mode differentiation.
    fn pass_derivative_on(&mut self, op: Op, value: Operand, factor: Operand) -> Option<()> {
        match op {
            Op::Neg(a) => self.subtract_from_derivative(a, factor),
            Op::Add(a, b) => {
                self.add(a, factor);
                self.add(b, factor);
            }
            Op::Sub(a, b) => {
                self.add(a, factor);
                self.subtract_from_derivative(b, factor);
            }
            Op::Mul(a, b) => {
                self.add_product_to_derivative(a, factor, b);
                self.add_product_to_derivative(b, factor, a);
            }
            Op::Div(a, b) => {
                let over = self.push_instruction(Op::Div(factor, b));
                self.add(a, over);
                self.subtract_product_from_derivative(b, over, value);
            }
            Op::MulAdd(a, b, c) => {
                self.add_product_to_derivative(a, factor, b);
                self.add_product_to_derivative(b, factor, a);
                self.add(c, factor);
            }
            Op::MulSub(a, b, c) => {
                self.add_product_to_derivative(a, factor, b);
                self.add_product_to_derivative(b, factor, a);
                self.subtract_from_derivative(c, factor);
            }
            Op::NegMulAdd(a, b, c) => {
                self.subtract_product_from_derivative(a, factor, b);
                self.subtract_product_from_derivative(b, factor, a);
                self.add(c, factor);
            }
            Op::Call(f, x) => {
                let slope = self.slope_of_elementary(f, x, value);
                self.add_product_to_derivative(x, factor, slope);
            }
            Op::Atan2(y, x) => {
                let square = self.push_instruction(Op::Mul(y, y));
                let square = self.push_instruction(Op::MulAdd(x, x, square));
                let over = self.push_instruction(Op::Div(factor, square));
                self.add_product_to_derivative(y, over, x);
                self.subtract_product_from_derivative(x, over, y);
            }
            Op::Pow(a, b) => {
                // b aᵇ⁻¹ and aᵇ ln a.
                let less = self.push_instruction(Op::Sub(b, Operand::Const(1.0)));
                let power = self.push_instruction(Op::Pow(a, less));
                let slope = self.push_instruction(Op::Mul(b, power));
                self.add_product_to_derivative(a, factor, slope);
                if !matches!(b, Operand::Const(_)) {
                    let logarithm = self.find_or_append_elementary_call(Elementary::Ln, a);
                    let slope = self.push_instruction(Op::Mul(value, logarithm));
                    self.add_product_to_derivative(b, factor, slope);
                }
            }
            Op::Extreme(which, a, b) => {
                let difference = match which {
                    Extreme::Max => self.push_instruction(Op::Sub(a, b)),
                    Extreme::Min => self.push_instruction(Op::Sub(b, a)),
                };
                let sign = self.find_or_append_elementary_call(Elementary::Signum, difference);
                let half = Operand::Const(0.5);
                let of_a = self.push_instruction(Op::MulAdd(half, sign, half));
                let of_b = self.push_instruction(Op::NegMulAdd(half, sign, half));
                self.add_product_to_derivative(a, factor, of_a);
                self.add_product_to_derivative(b, factor, of_b);
            }
            Op::Table(lookup, a, b, c) => {
                for (k, x) in [a, b, c].into_iter().take(lookup.variable_count()).enumerate() {
                    if let Some(slope) = lookup.partial_derivative(k) {
                        let slope = self.push_instruction(Op::Table(slope, a, b, c));
                        self.add_product_to_derivative(x, factor, slope);
                    }
                }
            }
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => return None,
        }
        Some(())
    }

    /// Returns the derivative of an elementary function at `x`, where `value` is the function's value.
    fn slope_of_elementary(&mut self, f: Elementary, x: Operand, value: Operand) -> Operand {
        let one = Operand::Const(1.0);
        match f {
            Elementary::Sin => self.find_or_append_elementary_call(Elementary::Cos, x),
            Elementary::Cos => {
                let sine = self.find_or_append_elementary_call(Elementary::Sin, x);
                self.push_instruction(Op::Neg(sine))
            }
            Elementary::Tan => self.push_instruction(Op::MulAdd(value, value, one)),
            Elementary::Asin | Elementary::Acos => {
                let square = self.push_instruction(Op::NegMulAdd(x, x, one));
                let root = self.find_or_append_elementary_call(Elementary::Sqrt, square);
                let sign = if f == Elementary::Asin { 1.0 } else { -1.0 };
                self.push_instruction(Op::Div(Operand::Const(sign), root))
            }
            Elementary::Atan => {
                let square = self.push_instruction(Op::MulAdd(x, x, one));
                self.push_instruction(Op::Div(one, square))
            }
            Elementary::Sinh => self.find_or_append_elementary_call(Elementary::Cosh, x),
            Elementary::Cosh => self.find_or_append_elementary_call(Elementary::Sinh, x),
            Elementary::Tanh => self.push_instruction(Op::NegMulAdd(value, value, one)),
            Elementary::Exp => value,
            Elementary::Ln => self.push_instruction(Op::Div(one, x)),
            Elementary::Sqrt => self.push_instruction(Op::Div(Operand::Const(0.5), value)),
            Elementary::Abs => self.find_or_append_elementary_call(Elementary::Signum, x),
            Elementary::Signum | Elementary::IsaLapseRate => Operand::Const(0.0),
            Elementary::IsaTemperature => self.find_or_append_elementary_call(Elementary::IsaLapseRate, x),
            Elementary::IsaPressure => {
                let temperature = self.find_or_append_elementary_call(Elementary::IsaTemperature, x);
                let over = self.push_instruction(Op::Div(value, temperature));
                self.push_instruction(Op::Mul(Operand::Const(-air::FALL_OVER_GAS), over))
            }
        }
    }
}

//! Interpreter of generated function bodies, without rustc: straight-line code with numbers, lanes, arrays
//! and tuples. Bodies with calls other than the operations of `Arithmetic` are not supported.

use linkwork_compiler::expr::Function;
use std::collections::BTreeMap;
use syn::{Block, Expr, ExprCall, ExprField, Lit, Member, Pat, Stmt, UnOp};

/// Reason why a generated function body cannot be interpreted.
#[derive(Debug)]
pub enum InterpretationError {
    /// The function body calls a function that the interpreter does not support.
    Foreign,
    /// The body is invalid Rust, or it does not end with a value.
    Wrong(String),
}

type Result<T> = std::result::Result<T, InterpretationError>;

fn foreign_code_error<T>() -> Result<T> {
    Err(InterpretationError::Foreign)
}

fn wrong_code_error<T>(what: impl Into<String>) -> Result<T> {
    Err(InterpretationError::Wrong(what.into()))
}

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Lanes(Vec<f64>),
    /// Array or tuple of values; a matrix is a list of its columns.
    List(Vec<Value>),
    /// Name of an operation, with the number of lanes of its result.
    Operation(String, Option<usize>),
}

impl Value {
    pub fn list_of_numbers(numbers: &[f64]) -> Value {
        Value::List(numbers.iter().map(|x| Value::Number(*x)).collect())
    }

    /// Returns all numbers of the value in order; of lanes, the number in `lane`.
    pub fn numbers_of_lane(&self, lane: usize) -> Result<Vec<f64>> {
        match self {
            Value::Number(x) => Ok(vec![*x]),
            Value::Lanes(all) => {
                all.get(lane).map_or_else(|| wrong_code_error("no such lane"), |x| Ok(vec![*x]))
            }
            Value::List(list) => {
                let all: Result<Vec<Vec<f64>>> =
                    list.iter().map(|value| value.numbers_of_lane(lane)).collect();
                Ok(all?.concat())
            }
            Value::Operation(name, _) => wrong_code_error(format!("{name} is not a number")),
        }
    }

    fn elements_of_list(&self) -> Result<&Vec<Value>> {
        match self {
            Value::List(list) => Ok(list),
            other => wrong_code_error(format!("{other:?} has no elements")),
        }
    }
}

/// Applies an operation to numbers, or to vectors lane by lane.
fn apply_lane_by_lane(values: &[Value], f: &dyn Fn(&[f64]) -> f64) -> Result<Value> {
    if let [Value::Number(_), ..] = values {
        let numbers: Result<Vec<f64>> =
            values
                .iter()
                .map(|value| {
                    if let Value::Number(x) = value { Ok(*x) } else { wrong_code_error("a number and lanes") }
                })
                .collect();
        return Ok(Value::Number(f(&numbers?)));
    }
    let lanes: Result<Vec<&Vec<f64>>> = values
        .iter()
        .map(|value| match value {
            Value::Lanes(lanes) => Ok(lanes),
            other => wrong_code_error(format!("lanes and {other:?}")),
        })
        .collect();
    let lanes = lanes?;
    let count = lanes.first().map_or(0, |first| first.len());
    if lanes.iter().any(|own| own.len() != count) {
        return wrong_code_error("lanes of different numbers");
    }
    Ok(Value::Lanes((0..count).map(|k| f(&lanes.iter().map(|own| own[k]).collect::<Vec<_>>())).collect()))
}

/// State of the interpreter: variables of nested blocks, parameters of the mechanism, and number of states.
pub struct InterpreterState {
    pub scopes: Vec<BTreeMap<String, Option<Value>>>,
    pub parameters: BTreeMap<String, Value>,
    pub states: usize,
}

impl InterpreterState {
    /// Executes a body and returns its value. Its variables remain defined.
    pub fn execute_function_body(&mut self, body: &Block) -> Result<Value> {
        let mut last = Value::List(Vec::new());
        for statement in &body.stmts {
            last = Value::List(Vec::new());
            match statement {
                Stmt::Local(local) => match &local.init {
                    Some(init) => {
                        let value = self.evaluate_expression(&init.expr)?;
                        self.bind_pattern(&local.pat, value)?;
                    }
                    None => self.declare_variables(&local.pat)?,
                },
                Stmt::Expr(expr, None) => last = self.evaluate_expression(expr)?,
                Stmt::Expr(expr, Some(_)) => drop(self.evaluate_expression(expr)?),
                Stmt::Item(syn::Item::Use(_)) => {}
                _ => return foreign_code_error(),
            }
        }
        Ok(last)
    }

    fn declare_variables(&mut self, pattern: &Pat) -> Result<()> {
        match pattern {
            Pat::Ident(name) => drop(self.current_scope().insert(name.ident.to_string(), None)),
            Pat::Tuple(tuple) => {
                tuple.elems.iter().try_for_each(|pattern| self.declare_variables(pattern))?
            }
            _ => return foreign_code_error(),
        }
        Ok(())
    }

    fn current_scope(&mut self) -> &mut BTreeMap<String, Option<Value>> {
        self.scopes.last_mut().expect("a scope")
    }

    pub fn bind_pattern(&mut self, pattern: &Pat, value: Value) -> Result<()> {
        let patterns = match pattern {
            Pat::Wild(_) => return Ok(()),
            Pat::Ident(name) => {
                self.current_scope().insert(name.ident.to_string(), Some(value));
                return Ok(());
            }
            Pat::Tuple(tuple) => &tuple.elems,
            Pat::Slice(slice) => &slice.elems,
            _ => return foreign_code_error(),
        };
        let (values, open) = (value.elements_of_list()?, matches!(patterns.last(), Some(Pat::Rest(_))));
        let count = patterns.len() - usize::from(open);
        if values.len() < count || (values.len() > count && !open) {
            return wrong_code_error(format!("{} values for {count} patterns", values.len()));
        }
        for (pattern, value) in patterns.iter().take(count).zip(values.clone()) {
            self.bind_pattern(pattern, value)?;
        }
        Ok(())
    }

    pub fn variable_value(&self, name: &str) -> Result<Value> {
        let found = self.scopes.iter().rev().find_map(|scope| scope.get(name));
        found.cloned().flatten().map_or_else(|| wrong_code_error(format!("`{name}` has no value")), Ok)
    }

    fn evaluate_expression(&mut self, expr: &Expr) -> Result<Value> {
        match expr {
            Expr::Lit(lit) => match &lit.lit {
                Lit::Float(x) => x.base10_parse().map(Value::Number).or_else(|_| foreign_code_error()),
                _ => foreign_code_error(),
            },
            Expr::Path(path) => match path.path.get_ident() {
                Some(name) if name == "self" => foreign_code_error(),
                Some(name) => self.variable_value(&name.to_string()),
                None => self.named_operation(&path.path),
            },
            Expr::Paren(inner) => self.evaluate_expression(&inner.expr),
            Expr::Reference(inner) => self.evaluate_expression(&inner.expr),
            Expr::Unary(unary) => {
                let value = self.evaluate_expression(&unary.expr)?;
                match unary.op {
                    UnOp::Neg(_) => apply_lane_by_lane(&[value], &|x| -x[0]),
                    UnOp::Deref(_) => Ok(value),
                    _ => foreign_code_error(),
                }
            }
            Expr::Binary(binary) => {
                let values =
                    [self.evaluate_expression(&binary.left)?, self.evaluate_expression(&binary.right)?];
                match binary.op {
                    syn::BinOp::Add(_) => apply_lane_by_lane(&values, &|x| x[0] + x[1]),
                    syn::BinOp::Sub(_) => apply_lane_by_lane(&values, &|x| x[0] - x[1]),
                    syn::BinOp::Mul(_) => apply_lane_by_lane(&values, &|x| x[0] * x[1]),
                    syn::BinOp::Div(_) => apply_lane_by_lane(&values, &|x| x[0] / x[1]),
                    _ => foreign_code_error(),
                }
            }
            Expr::Tuple(tuple) => self.evaluate_list(tuple.elems.iter()),
            Expr::Array(array) => self.evaluate_list(array.elems.iter()),
            Expr::Repeat(repeat) => Ok(Value::List(vec![
                self.evaluate_expression(&repeat.expr)?;
                integer_literal_value(&repeat.len)?
            ])),
            Expr::Struct(fields) => self.evaluate_list(fields.fields.iter().map(|field| &field.expr)),
            Expr::Block(block) => {
                self.scopes.push(BTreeMap::new());
                let value = self.execute_function_body(&block.block);
                self.scopes.pop();
                value
            }
            Expr::Field(field) => self.parameter_field(field),
            Expr::Index(inner) => {
                let (list, at) =
                    (self.evaluate_expression(&inner.expr)?, integer_literal_value(&inner.index)?);
                list.elements_of_list()?
                    .get(at)
                    .cloned()
                    .map_or_else(|| wrong_code_error(format!("no element {at}")), Ok)
            }
            Expr::Assign(assign) => {
                let value = self.evaluate_expression(&assign.right)?;
                self.assign_value(&assign.left, &[], value)?;
                Ok(Value::List(Vec::new()))
            }
            Expr::Call(call) => self.evaluate_call(call),
            Expr::MethodCall(call) => {
                let value = self.evaluate_expression(&call.receiver)?;
                let first_turbofish_constant = || {
                    call.turbofish
                        .as_ref()
                        .and_then(|types| integer_generic_arguments(types).first().copied())
                };
                match (call.method.to_string().as_str(), value, first_turbofish_constant()) {
                    ("lanes", value, None) => Ok(value),
                    ("sum", Value::Lanes(lanes), None) => Ok(Value::Number(lanes.iter().sum())),
                    ("lane", Value::Lanes(lanes), Some(k)) if k < lanes.len() => Ok(Value::Number(lanes[k])),
                    ("first", Value::Lanes(lanes), Some(n)) if n <= lanes.len() => {
                        Ok(Value::Lanes(lanes[..n].to_vec()))
                    }
                    ("lane" | "first" | "sum", ..) => wrong_code_error(format!("{}", quote::quote!(#call))),
                    _ => foreign_code_error(),
                }
            }
            _ => foreign_code_error(),
        }
    }

    fn evaluate_list<'e>(&mut self, all: impl Iterator<Item = &'e Expr>) -> Result<Value> {
        Ok(Value::List(all.map(|expr| self.evaluate_expression(expr)).collect::<Result<_>>()?))
    }

    /// Returns the parameter for `self.parameter`. Storage of vectors, matrices and lanes is the value
    /// itself.
    fn parameter_field(&mut self, field: &ExprField) -> Result<Value> {
        let is_matrix_data_access = |base: &Expr| match base {
            Expr::Field(inner) => matches!(&inner.member, Member::Named(name) if name == "data"),
            Expr::MethodCall(call) => call.method == "lanes",
            _ => false,
        };
        match (&*field.base, &field.member) {
            (Expr::Path(base), Member::Named(name)) if base.path.is_ident("self") => {
                match self.parameters.get(&name.to_string()) {
                    Some(value) => Ok(value.clone()),
                    None => foreign_code_error(),
                }
            }
            (base, Member::Named(name)) if name == "data" => self.evaluate_expression(base),
            (base, Member::Unnamed(at)) if at.index == 0 && is_matrix_data_access(base) => {
                // The numbers of lanes form an array.
                match self.evaluate_expression(base)? {
                    Value::Lanes(lanes) => Ok(Value::list_of_numbers(&lanes)),
                    value => Ok(value),
                }
            }
            // The lanes of an argument.
            (Expr::Path(base), Member::Unnamed(at)) if at.index == 0 && base.path.is_ident("t") => {
                self.variable_value("t")
            }
            _ => foreign_code_error(),
        }
    }

    /// Assigns a value to a variable, or a number to an entry of a matrix.
    fn assign_value(&mut self, place: &Expr, more: &[usize], value: Value) -> Result<()> {
        let (mut at, mut inner) = (more.to_vec(), place);
        let name = loop {
            match inner {
                Expr::Path(name) => break quote::quote!(#name).to_string(),
                Expr::Index(one) => {
                    at.insert(0, integer_literal_value(&one.index)?);
                    inner = &one.expr;
                }
                Expr::Field(field) => inner = &field.base,
                Expr::Reference(reference) => inner = &reference.expr,
                _ => return foreign_code_error(),
            }
        };
        let found = self.scopes.iter_mut().rev().find_map(|scope| scope.get_mut(&name));
        let Some(variable) = found else { return wrong_code_error(format!("`{name}` is not declared")) };
        if at.is_empty() {
            *variable = Some(value);
            return Ok(());
        }
        let mut entry = variable.as_mut();
        for k in &at {
            entry = entry.and_then(|entry| match entry {
                Value::List(list) => list.get_mut(*k),
                _ => None,
            });
        }
        let Some(entry) = entry else { return wrong_code_error(format!("{name} has no {at:?}")) };
        *entry = value;
        Ok(())
    }

    /// Returns the operation `Ops::name::<…>`; the number of lanes is its last type argument.
    fn named_operation(&self, path: &syn::Path) -> Result<Value> {
        let mut segments = path.segments.iter().rev();
        let (Some(last), Some(before)) = (segments.next(), segments.next()) else {
            return foreign_code_error();
        };
        if before.ident != "Ops" {
            return foreign_code_error();
        }
        let lanes = match &last.arguments {
            syn::PathArguments::AngleBracketed(types) => match types.args.last() {
                Some(syn::GenericArgument::Const(expr)) => Some(integer_literal_value(expr)?),
                Some(syn::GenericArgument::Type(syn::Type::Path(name))) if name.path.is_ident("LANES") => {
                    Some(self.states)
                }
                _ => None,
            },
            _ => None,
        };
        Ok(Value::Operation(last.ident.to_string(), lanes))
    }

    fn evaluate_call(&mut self, call: &ExprCall) -> Result<Value> {
        let Expr::Path(function) = &*call.func else { return foreign_code_error() };
        let last = function.path.segments.last().expect("a name");
        let name = last.ident.to_string();
        if ["from_array_storage", "ArrayStorage", "Lanes"].contains(&name.as_str()) {
            return self.evaluate_expression(&call.args[0]);
        }
        if name.starts_with("store_") {
            return self.interpret_lane_store(&name, last, call);
        }
        let operation = match function.path.get_ident() {
            Some(_) if self.variable_value(&name).is_err() => return foreign_code_error(),
            Some(_) => self.variable_value(&name)?,
            None => self.named_operation(&function.path)?,
        };
        let Value::Operation(name, lanes) = operation else { return foreign_code_error() };
        let values: Vec<Value> =
            call.args.iter().map(|expr| self.evaluate_expression(expr)).collect::<Result<_>>()?;
        apply_operation(&name, lanes, &values).unwrap_or_else(foreign_code_error)
    }

    /// Interprets a generated call that stores SIMD lanes to rows of a matrix.
    fn interpret_lane_store(
        &mut self,
        name: &str,
        last: &syn::PathSegment,
        call: &ExprCall,
    ) -> Result<Value> {
        let syn::PathArguments::AngleBracketed(types) = &last.arguments else { return foreign_code_error() };
        let constants = integer_generic_arguments(types);
        let vectors: Vec<Value> =
            call.args.iter().skip(1).map(|e| self.evaluate_expression(e)).collect::<Result<_>>()?;
        let lane_of_vector = |vector: usize, k: usize| match &vectors[vector] {
            Value::Lanes(lanes) if k < lanes.len() => Ok(Value::Number(lanes[k])),
            other => wrong_code_error(format!("lane {k} of {other:?}")),
        };
        let lanes_in_vector =
            |vector: usize| if let Value::Lanes(lanes) = &vectors[vector] { lanes.len() } else { 0 };
        match (name, constants.as_slice()) {
            ("store_two", [i, j, row]) => {
                self.assign_value(&call.args[0], &[*row], lane_of_vector(0, *i)?)?;
                self.assign_value(&call.args[0], &[row + 1], lane_of_vector(1, *j)?)?;
            }
            ("store_lanes_in_column", [row]) => {
                for k in 0..lanes_in_vector(0) {
                    self.assign_value(&call.args[0], &[row + k], lane_of_vector(0, k)?)?;
                }
            }
            ("store_two_rows", [row, column]) => {
                for k in 0..lanes_in_vector(0) {
                    self.assign_value(&call.args[0], &[column + k, *row], lane_of_vector(0, k)?)?;
                    self.assign_value(&call.args[0], &[column + k, row + 1], lane_of_vector(1, k)?)?;
                }
            }
            _ => return foreign_code_error(),
        }
        Ok(Value::List(Vec::new()))
    }
}

/// Returns the result of an operation; `None` for an unknown operation.
fn apply_operation(name: &str, lanes: Option<usize>, values: &[Value]) -> Option<Result<Value>> {
    // In a product of a number and lanes, the number is not broadcast in the code.
    let apply_with_broadcast_number = |rest: &str| -> Option<Result<Value>> {
        let (Value::Number(x), Value::Lanes(own)) = (values.first()?, values.get(1)?) else {
            return Some(wrong_code_error(format!("{name} of {values:?}")));
        };
        let all = [vec![Value::Lanes(vec![*x; own.len()])], values[1..].to_vec()].concat();
        match rest {
            "" => Some(apply_lane_by_lane(&all, &|x| x[0] * x[1])),
            rest => apply_operation(rest, lanes, &all),
        }
    };
    let function_by_name = |name: &str| Function::ALL.iter().find(|(known, _)| *known == name);
    Some(match (name, values) {
        ("mul_add", [_, _, _]) => apply_lane_by_lane(values, &|x| x[0] * x[1] + x[2]),
        ("mul_sub", [_, _, _]) => apply_lane_by_lane(values, &|x| x[0] * x[1] - x[2]),
        ("neg_mul_add", [_, _, _]) => apply_lane_by_lane(values, &|x| x[2] - x[0] * x[1]),
        ("scale", [_, _]) => apply_with_broadcast_number("")?,
        ("scale_add", [_, _, _]) => apply_with_broadcast_number("mul_add")?,
        ("scale_sub", [_, _, _]) => apply_with_broadcast_number("mul_sub")?,
        ("neg_scale_add", [_, _, _]) => apply_with_broadcast_number("neg_mul_add")?,
        ("splat", [Value::Number(x)]) => Ok(Value::Lanes(vec![*x; lanes?])),
        ("each", [all]) => Ok(all.clone()),
        ("lanes", [Value::List(list)]) => {
            let number_of_value = |value: &Value| if let Value::Number(x) = value { Some(*x) } else { None };
            match list.iter().map(number_of_value).collect::<Option<Vec<f64>>>() {
                Some(lanes) => Ok(Value::Lanes(lanes)),
                None => wrong_code_error(format!("lanes of {list:?}")),
            }
        }
        // The time of several states.
        ("lanes", [Value::Lanes(lanes)]) => Ok(Value::Lanes(lanes.clone())),
        ("join", [Value::Lanes(a), Value::Lanes(b)]) if a.len() == b.len() && lanes == Some(2 * a.len()) => {
            Ok(Value::Lanes([a.clone(), b.clone()].concat()))
        }
        ("sin_cos", [x]) => sine_and_cosine(x),
        ("sin_cos_all", [Value::List(angles)]) => {
            let all: Result<Vec<Value>> = angles.iter().map(sine_and_cosine).collect();
            all.and_then(|all| {
                let kth_elements_of_pairs = |k: usize| -> Result<Value> {
                    Ok(Value::List(
                        all.iter()
                            .map(|pair| Ok(pair.elements_of_list()?[k].clone()))
                            .collect::<Result<_>>()?,
                    ))
                };
                Ok(Value::List(vec![kth_elements_of_pairs(0)?, kth_elements_of_pairs(1)?]))
            })
        }
        ("atan2", [_, _]) => apply_lane_by_lane(values, &|x| x[0].atan2(x[1])),
        ("powf", [_, _]) => apply_lane_by_lane(values, &|x| x[0].powf(x[1])),
        ("min", [_, _]) => apply_lane_by_lane(values, &|x| x[0].min(x[1])),
        ("max", [_, _]) => apply_lane_by_lane(values, &|x| x[0].max(x[1])),
        (name, [_]) => {
            let (_, function) = function_by_name(name)?;
            apply_lane_by_lane(values, &|x| function.evaluate_at(x[0]))
        }
        _ => return None,
    })
}

/// Returns sine and cosine of a value, lane by lane.
fn sine_and_cosine(x: &Value) -> Result<Value> {
    let x = std::slice::from_ref(x);
    Ok(Value::List(vec![apply_lane_by_lane(x, &|x| x[0].sin())?, apply_lane_by_lane(x, &|x| x[0].cos())?]))
}

/// Returns the value of an integer literal in a function body.
fn integer_literal_value(expr: &Expr) -> Result<usize> {
    match expr {
        Expr::Lit(syn::ExprLit { lit: Lit::Int(k), .. }) => {
            k.base10_parse().or_else(|_| foreign_code_error())
        }
        _ => foreign_code_error(),
    }
}

/// Returns the integers among the generic arguments of a call.
fn integer_generic_arguments(types: &syn::AngleBracketedGenericArguments) -> Vec<usize> {
    let integer_of_generic_argument = |argument: &syn::GenericArgument| match argument {
        syn::GenericArgument::Const(expr) => integer_literal_value(expr).ok(),
        _ => None,
    };
    types.args.iter().filter_map(integer_of_generic_argument).collect()
}

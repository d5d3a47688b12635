//! The runtime's traits of outputs: all of a mechanism's in one vector.

use super::interface::{ALLOW, Head, Interface};
use super::signature::Signature;
use super::states;
use crate::catalogue::{Argument, BY_PARAMETERS, DERIVATIVES, Id, Shape};
use crate::derive::Function;
use std::fmt::Write;

/// Implements them for the type of this name, if it has outputs that follow from state, accelerations and inputs.
pub fn write_impls(
    out: &mut String,
    name: &str,
    functions: &[Function],
    i: &Interface<'_>,
    s: &Signature<'_>,
) {
    // The rates of states are no measurements, nor are matrices.
    let is_rate = |f: &Function| i.states.iter().any(|(name, _)| f.name == states::rate(name));
    let outputs: Vec<&Function> = functions
        .iter()
        .filter(|f| f.id == Id::Output && !is_rate(f) && !matches!(f.shape, Shape::Matrix(..)))
        .collect();
    let count: usize = outputs.iter().map(|f| rows(f)).sum();
    if count == 0 {
        return;
    }
    let Head { generics, arguments, bounds } = &Head::new(i, s);
    let begin = |out: &mut String, of: &str| {
        let sizes = [s.nq, s.nv, s.nu, count].map(|n| n.to_string()).join(", ");
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::{of}<{sizes}> for {name}{arguments} {bounds} {{"
        );
    };
    let taken = [Argument::T, Argument::Q, Argument::V, Argument::A, Argument::U];
    let parameters = s.parameters(&taken);
    let call = |f: &Function, suffix: &str| {
        let names: Vec<&str> = f.arguments.iter().map(|a| a.name()).collect();
        format!("Self::{}{suffix}(self, {})", f.name, names.join(", "))
    };
    let vector = s.vector(count);
    let names: Vec<String> =
        outputs.iter().flat_map(|f| entries(f)).map(|name| format!("{name:?}")).collect();
    let unit = |f: &Function| {
        let place = i.outputs.iter().position(|name| *name == f.name);
        place.and_then(|k| i.units.outputs.get(k)).map_or("", |unit| unit)
    };
    let units: Vec<&str> = outputs.iter().flat_map(|f| std::iter::repeat_n(unit(f), rows(f))).collect();
    begin(out, "Outputs");
    let _ = writeln!(
        out,
        "type Scalar = {};\nconst OUTPUTS: [&'static str; {count}] = [{}];
        const OUTPUT_UNITS: [&'static str; {count}] = {units:?};
        #[inline]\nfn outputs({parameters}) -> {vector} {{\nlet mut all = <{vector}>::zeros();",
        s.scalar.name(),
        names.join(", "),
    );
    let mut first = 0;
    for f in &outputs {
        let value = match f.shape {
            Shape::Scalar => format!("::linkwork::nalgebra::SVector::from([{}])", call(f, "")),
            _ => call(f, ""),
        };
        let _ = writeln!(out, "::linkwork::__private::put_rows(&mut all, {first}, &{value});");
        first += rows(f);
    }
    out.push_str("all\n}\n}\n");
    if !i.facts.requests.derivatives {
        return;
    }
    begin(out, "OutputDerivatives");
    let of = s.shape(Shape::Jacobians(count, s.nv, s.nu));
    let _ = writeln!(
        out,
        "#[inline]\nfn output_derivatives({parameters}) -> {of} {{\nlet mut all = <{of}>::zeros();"
    );
    let mut first = 0;
    for f in &outputs {
        let _ = writeln!(out, "all.put_rows({first}, &{});", call(f, DERIVATIVES));
        first += rows(f);
    }
    out.push_str("all\n}\n}\n");
    // As of the derivatives of the states themselves.
    if i.states.is_empty() || i.facts.kinematic || i.facts.constraints.is_some() {
        return;
    }
    let n = i.states.len();
    let sizes = [s.nq, s.nv, s.nu, n, count].map(|n| n.to_string()).join(", ");
    let of = s.shape(Shape::Matrix(count, n));
    let which: Vec<String> = i.states.iter().map(|(_, k)| k.to_string()).collect();
    let _ = writeln!(
        out,
        "{ALLOW}impl{generics} ::linkwork::OutputsByStates<{sizes}> for {name}{arguments} {bounds} {{
        #[inline]\nfn outputs_by_states({parameters}) -> {of} {{\nlet mut all = <{of}>::zeros();"
    );
    let mut first = 0;
    for f in &outputs {
        let _ = writeln!(
            out,
            "::linkwork::__private::put_rows(&mut all, {first}, &::linkwork::__private::columns(&{}, [{}]));",
            call(f, BY_PARAMETERS),
            which.join(", "),
        );
        first += rows(f);
    }
    out.push_str("all\n}\n}\n");
}

fn rows(f: &Function) -> usize {
    match f.shape {
        Shape::Vector(n) => n,
        _ => 1,
    }
}

/// The names of an output's entries: its components in space, or numbers.
fn entries(f: &Function) -> Vec<String> {
    match rows(f) {
        1 => vec![f.name.clone()],
        3 => ["x", "y", "z"].map(|axis| format!("{}.{axis}", f.name)).to_vec(),
        n => (0..n).map(|k| format!("{}[{k}]", f.name)).collect(),
    }
}

//! Configuration space of a mechanism with generalized speeds. Its functions call hidden functions for joint
//! velocities and convert between the two.

use super::signature::SignatureContext;
use crate::catalogue::Shape;
use std::fmt::Write;

/// Writes `integrate`, `difference` and `displacement_rate`, or stubs for a mechanism that failed to compile.
pub fn write_manifold(out: &mut String, stub: bool, s: &SignatureContext<'_>) {
    let (q, v, lanes) = (s.vector_type(s.nq), s.vector_type(s.nv), s.lane_function_suffix());
    let functions = [
        (
            "integrate",
            "Returns `q ⊕ dv`: the configuration reached from `q` in one unit of time with the constant \
             joint velocities to which the generalized speeds `dv` correspond at `q`, with normalised \
             quaternions.",
            format!("q: &{q}, dv: &{v}) -> {q}"),
            format!("self.__integrate{lanes}(q, &self.rates_of_speeds{lanes}(q, dv))"),
        ),
        (
            "difference",
            "Returns `to ⊖ from`: the generalized speeds, at `from`, that lead from one configuration to \
             another in one unit of time, so that `integrate(from, difference(from, to))` is `to`.",
            format!("from: &{q}, to: &{q}) -> {v}"),
            format!("self.speeds_of_rates{lanes}(from, &self.__difference{lanes}(from, to))"),
        ),
        (
            "displacement_rate",
            "Returns the rate of `dv` for which `q ⊕ dv` moves with the generalized speeds `v`.",
            format!("q: &{q}, dv: &{v}, v: &{v}) -> {v}"),
            format!(
                "let way = self.rates_of_speeds{lanes}(q, dv);
                let there = self.__integrate{lanes}(q, &way);
                let rates = self.rates_of_speeds{lanes}(&there, v);
                self.speeds_of_rates{lanes}(q, &self.__tangent_rate{lanes}(&way, &rates))"
            ),
        ),
    ];
    for (name, about, signature, body) in functions {
        let body = if stub { "loop {}" } else { &body };
        let generics = s.lanes_suffix_and_generics();
        let _ = writeln!(
            out,
            "/// {about}\n#[inline]\n#[must_use]\npub fn {name}{generics}(&self, {signature} {{\n{body}\n}}"
        );
    }
}

/// Writes the functions of the trait `Mechanism` for which only mechanisms with generalized speeds override
/// the default.
pub fn write_mechanism_trait_overrides(out: &mut String, s: &SignatureContext<'_>) {
    let (q, v) = (s.vector_type(s.nq), s.vector_type(s.nv));
    let _ = writeln!(
        out,
        "#[inline]\nfn tangent_rate(&self, _dv: &{v}, _v: &{v}) -> {v} {{ {v}::repeat({nan}) }}
        #[inline]\nfn displacement_rate(&self, q: &{q}, dv: &{v}, v: &{v}) -> {v} {{ \
            Self::displacement_rate(self, q, dv, v) }}",
        v = turbofish_form_of_type(&v),
        nan = nan_expression(s),
    );
}

/// Writes the functions on the configuration space for the trait `Batch`.
pub fn write_batch_configuration_functions(out: &mut String, s: &SignatureContext<'_>) {
    let (q, v) = (s.vector_type(s.nq), s.vector_type(s.nv));
    let _ = writeln!(
        out,
        "#[inline]\nfn tangent_rate_lanes<const LANES: usize>(&self, _dv: &{v}, _v: &{v}) -> {v} {{ \
         {v}::repeat(::linkwork::__private::Lanes([::linkwork::__private::constant(f64::NAN); LANES])) }}
        #[inline]\nfn displacement_rate_lanes<const LANES: usize>(&self, q: &{q}, dv: &{v}, v: &{v}) -> {v} \
            {{ Self::displacement_rate_lanes(self, q, dv, v) }}",
        v = turbofish_form_of_type(&v),
    );
}

/// Returns a type in the form in which its functions are called (`SVector::<f64, 2>`).
fn turbofish_form_of_type(v: &str) -> String {
    v.replacen("SVector<", "SVector::<", 1)
}

/// Returns the Rust expression of a NaN.
fn nan_expression(s: &SignatureContext<'_>) -> String {
    format!("::linkwork::__private::constant::<{}>(f64::NAN)", s.scalar.scalar_name())
}

/// Writes the functions of the trait `Derivatives` on the configuration space.
pub fn write_configuration_space_derivatives(out: &mut String, s: &SignatureContext<'_>) {
    let (q, v, square) = (s.vector_type(s.nq), s.vector_type(s.nv), s.shape_type(Shape::Square(s.nv)));
    let unknown = format!("{}::repeat({})", square.replacen("SMatrix<", "SMatrix::<", 1), nan_expression(s));
    let _ = writeln!(
        out,
        "#[inline]\nfn integrate_derivatives(&self, _dv: &{v}) -> ({square}, {square}) {{ ({unknown}, \
         {unknown}) }}
        #[inline]\nfn tangent_rate_derivatives(&self, _dv: &{v}, _v: &{v}) -> ({square}, {square}) {{ \
            ({unknown}, {unknown}) }}
        fn integrate_derivatives_at(&self, q: &{q}, dv: &{v}) -> ({square}, {square}) {{
            let way = self.rates_of_speeds(q, dv);
            let there = self.__integrate(q, &way);
            ::linkwork::__private::integrate_derivatives_in_speeds(
                &self.__rate_matrix(q),
                &self.__speed_matrix(&there),
                &self.__integrate_derivatives(&way),
                &self.__rate_changes(q, dv),
            )
        }}
        fn displacement_rate_derivatives(&self, q: &{q}, dv: &{v}, v: &{v}) -> ({square}, {square}, \
            {square}) {{
            let way = self.rates_of_speeds(q, dv);
            let there = self.__integrate(q, &way);
            let rates = self.rates_of_speeds(&there, v);
            let found = self.speeds_of_rates(q, &self.__tangent_rate(&way, &rates));
            let moved = ::linkwork::__private::integrate_derivatives_in_speeds(
                &self.__rate_matrix(q),
                &self.__speed_matrix(&there),
                &self.__integrate_derivatives(&way),
                &self.__rate_changes(q, dv),
            );
            ::linkwork::__private::displacement_rate_derivatives_in_speeds(
                [&self.__speed_matrix(q), &self.__rate_matrix(q), &self.__rate_matrix(&there)],
                &self.__tangent_rate_derivatives(&way, &rates),
                &moved,
                [&self.__rate_changes(q, dv), &self.__rate_changes(q, &found), &self.__rate_changes(&there, \
                    v)],
            )
        }}
        #[inline]\nfn turning(&self, q: &{q}, v: &{v}) -> {square} {{ self.__turning(q, v) }}",
    );
}

/// Writes the function of the trait `SecondDerivatives` on the configuration space.
pub fn write_manifold_second_derivatives(out: &mut String, s: &SignatureContext<'_>) {
    let (v, square) = (s.vector_type(s.nv), s.shape_type(Shape::Square(s.nv)));
    let unknown = format!("{}::repeat({})", square.replacen("SMatrix<", "SMatrix::<", 1), nan_expression(s));
    let _ = writeln!(
        out,
        "#[inline]\nfn tangent_rate_second_derivatives(&self, _dv: &{v}, _v: &{v}, _lambda: &{v}) \
         -> ({square}, {square}) {{ ({unknown}, {unknown}) }}"
    );
}

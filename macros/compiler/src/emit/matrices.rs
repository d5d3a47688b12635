//! Results of several matrices, and what is composed of them at run time.

use super::function::{Shape, Signature};

/// Type of a result of several matrices.
pub fn several(shape: Shape, s: &Signature<'_>) -> String {
    let square = |n| s.shape(Shape::Square(n));
    match shape {
        Shape::Pair(n) => format!("({0}, {0})", square(n)),
        Shape::Forward(n) | Shape::CalledForward(n) => format!("({0}, {0}, {0})", square(n)),
        Shape::Linear(n, m) | Shape::CalledLinear(n, m) => {
            format!("({}, {})", square(2 * n), s.shape(Shape::Matrix(2 * n, m)))
        }
        _ => String::new(),
    }
}

/// The result from the outputs; `part` writes the matrix of so many rows and columns from the outputs after the first so
/// many.
pub fn compose(shape: Shape, s: &Signature<'_>, part: impl Fn(usize, usize, usize) -> String) -> String {
    let square = |k: usize, n: usize| part(k * n * n, n, n);
    match shape {
        Shape::Pair(n) => format!("({}, {})\n", square(0, n), square(1, n)),
        Shape::Forward(n) => {
            let forces = (square(0, n), square(1, n));
            format!(
                "let inverse = {};\n{}(by_q, by_v, inverse)\n",
                square(2, n),
                solved(&forces.0, &forces.1)
            )
        }
        Shape::CalledForward(_) => format!("{}(by_q, by_v, inverse)\n", called(s, "")),
        Shape::Linear(n, m) => {
            let (by_u, turning) = (part(3 * n * n, n, m), part(3 * n * n + n * m, n, n));
            let forces = solved(&square(0, n), &square(1, n));
            format!("let inverse = {};\n{forces}{}", square(2, n), assembled(n, m, &by_u, &turning, s))
        }
        Shape::CalledLinear(n, m) => {
            let from = |k: usize| part(n + k * n * n, n, n);
            let (by_u, turning) = (part(n + 2 * n * n, n, m), part(n + 2 * n * n + n * m, n, n));
            let less = format!("forces.0 -= {};\nforces.1 -= {};\n", from(0), from(1));
            let assembled = assembled(n, m, &by_u, &turning, s);
            format!("let tau = &{};\n{}{assembled}", part(0, n, 1), called(s, &less))
        }
        _ => String::new(),
    }
}

/// Derivatives of the accelerations from those of the forces: `−M⁻¹ ∂τ/∂x`.
fn solved(by_q: &str, by_v: &str) -> String {
    format!(
        "use ::linkwork::__private::minus_product;
        let by_q = minus_product(&inverse, &{by_q});
        let by_v = minus_product(&inverse, &{by_v});\n"
    )
}

/// The same by calls of the other functions; `less` is taken from the derivatives of the forces first.
fn called(s: &Signature<'_>, less: &str) -> String {
    let t = if s.time { "t, " } else { "" };
    let lanes = s.suffix();
    format!(
        "let a = &self.forward_dynamics{lanes}({t}q, v, tau);
        let mut forces = self.inverse_dynamics_derivatives{lanes}({t}q, v, a);
        {less}let inverse = self.mass_matrix_inverse{lanes}({t}q);
        {}",
        solved("forces.0", "forces.1")
    )
}

/// The system's two matrices from their blocks.
fn assembled(n: usize, m: usize, by_u: &str, turning: &str, s: &Signature<'_>) -> String {
    let number = |x: &str| format!("::linkwork::__private::constant::<{}>({x})", s.scalar.name());
    format!(
        "let by_u = minus_product(&inverse, &{by_u});
        let turning = {turning};
        let mut a = [[{zero}; {twice}]; {twice}];
        let mut b = [[{zero}; {twice}]; {m}];
        for j in 0..{n} {{
            for i in 0..{n} {{
                a[j][i] = turning.data.0[j][i];
                a[j][{n} + i] = by_q.data.0[j][i];
                a[{n} + j][{n} + i] = by_v.data.0[j][i];
            }}
            a[{n} + j][j] = {one};
        }}
        for j in 0..{m} {{
            for i in 0..{n} {{ b[j][{n} + i] = -by_u.data.0[j][i]; }}
        }}
        ({storage}(a)), {storage}(b)))\n",
        zero = number("0.0"),
        one = number("1.0"),
        twice = 2 * n,
        storage = "::linkwork::nalgebra::SMatrix::from_array_storage(::linkwork::nalgebra::ArrayStorage",
    )
}

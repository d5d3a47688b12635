//! Results of several matrices, and what is composed of them at run time.

use super::function::{Shape, Signature};

/// Type of a result of several matrices.
pub fn several(shape: Shape, s: &Signature<'_>) -> String {
    let square = |n| s.shape(Shape::Square(n));
    match shape {
        Shape::Pair(n) => format!("({0}, {0})", square(n)),
        Shape::Forward(n) => format!("({0}, {0}, {0})", square(n)),
        Shape::Linear(n, m) => format!("({}, {})", square(2 * n), s.shape(Shape::Matrix(2 * n, m))),
        _ => String::new(),
    }
}

/// The result from the outputs; `part` writes the matrix of so many rows and columns from the outputs after the first so
/// many.
pub fn compose(shape: Shape, scalar: &str, part: impl Fn(usize, usize, usize) -> String) -> String {
    match shape {
        Shape::Pair(n) => format!("({}, {})\n", part(0, n, n), part(n * n, n, n)),
        Shape::Forward(n) => format!("{}(by_q, by_v, inverse)\n", solved(n, &part)),
        Shape::Linear(n, m) => {
            let (by_u, turning) = (part(3 * n * n, n, m), part(3 * n * n + n * m, n, n));
            let number = |x: &str| format!("::linkwork::__private::constant::<{scalar}>({x})");
            format!(
                "{solved}let by_u = minus_product(&inverse, &{by_u});
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
                solved = solved(n, &part),
                zero = number("0.0"),
                one = number("1.0"),
                twice = 2 * n,
                storage =
                    "::linkwork::nalgebra::SMatrix::from_array_storage(::linkwork::nalgebra::ArrayStorage",
            )
        }
        _ => String::new(),
    }
}

/// Derivatives of the accelerations from those of the forces: `−M⁻¹ ∂τ/∂x`.
fn solved(n: usize, part: &impl Fn(usize, usize, usize) -> String) -> String {
    format!(
        "use ::linkwork::__private::minus_product;
        let inverse = {};\nlet by_q = minus_product(&inverse, &{});\nlet by_v = minus_product(&inverse, &{});\n",
        part(2 * n * n, n, n),
        part(0, n, n),
        part(n * n, n, n)
    )
}

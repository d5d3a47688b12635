//! Tests of equations with inertial terms only, printed if forces are too long to be readable, and of the
//! messages if no equations are printed.

use super::*;
use quote::ToTokens;

/// A satellite in a central gravity field, whose forces contain the fifth power of the distance.
const SATELLITE: &str = "struct Satellite { mu: f64, m: f64, a: f64, b: f64, c: f64,
    #[body(mass = m, inertia = diagonal(a, b, c))] body: Body,
    #[joint(ground -> body)] pose: Free,
    #[acts(on = body, about = body.x)] wheel: Torque,
    #[acts(between = (ground, body), mu = mu)] pull: Gravity }";

/// Checks that the left sides are those of a free body, which other tests compare with two derivations, and
/// that the right sides are symbols.
#[test]
fn free_body_prints_eulers_equations_under_any_load() {
    let text = call_with_parsed_model("0 * z", SATELLITE, |model| {
        let joints = crate::kinematics::joints_of_model(&model);
        let mass = crba::mass_matrix(&model, &joints);
        assert!(derive(&model, &joints, &mass, None, &EquationSizeLimits::READABLE).is_none());
        let e = derive_inertial_terms(&model, &joints, &mass, &EquationSizeLimits::READABLE).expect("short");
        check_values_of_printed_equations(&model, &e);
        crate::equations_as_text(&model)
    });
    let free = call_with_parsed_model("g * z", FREE, |model| {
        let mut model = model;
        model.gravity = Vec3([model.graph.zero(); 3]);
        crate::equations_as_text(&model)
    });
    let (found, expected) = (sides_of_equations(&text), sides_of_equations(&free));
    assert_eq!(found.len(), 7);
    for (k, (found, expected)) in found.iter().zip(&expected).enumerate().skip(1) {
        assert_eq!((&found.0, &found.1), (&expected.0, &format!("Q{k}")));
    }
    assert!(text.contains("\na pose.wx' + (c - b) pose.wy pose.wz = Q4\n"), "{text}");
    let said = text.replace('\n', " ");
    assert!(
        said.contains("Q6 are the generalized forces of gravity, force elements and inputs; their terms"),
        "{text}"
    );
    assert!(said.contains("The option `equations = lagrange` of `#[mechanism]`"), "{text}");
}

/// Returns the constant `EQUATIONS` of a mechanism.
fn text_of_equations_constant(arguments: &str, item: &str) -> String {
    let emitted = crate::expand(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""));
    let file = syn::parse_file(&emitted.text).expect("a file");
    let constants = file.items.iter().filter_map(|item| match item {
        syn::Item::Impl(block) => Some(&block.items),
        _ => None,
    });
    let found = constants.flatten().find_map(|item| match item {
        syn::ImplItem::Const(c) if c.ident == "EQUATIONS" => match &c.expr {
            syn::Expr::Index(index) => Some(index.expr.to_token_stream().to_string()),
            _ => None,
        },
        _ => None,
    });
    found.expect("the constant")
}

#[test]
fn omitted_terms_of_equations_are_reported() {
    let text = text_of_equations_constant("gravity = -9.81 * z", SKEW);
    for part in
        ["M(q) v' + h(q, v) = tau", "too many terms to be readable", "`equations = lagrange`", "`kane`"]
    {
        assert!(text.contains(part), "{text}");
    }
    let text = text_of_equations_constant("gravity = -9.81 * z, equations = structure", CART_POLE);
    assert!(text.contains("`equations = structure` omits the terms"), "{text}");
}

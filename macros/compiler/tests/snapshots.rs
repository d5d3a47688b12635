//! Generated code of small mechanisms, as a reviewer of a change of the compiler reads it. A difference is no mistake by itself:
//! look at it, and write the files anew with `LINKWORK_WRITE=1 cargo test -p linkwork-compiler --test snapshots`.

use linkwork_compiler::expand;
use quote::ToTokens;
use std::fs;
use std::path::Path;

const PENDULUM: &str = "m: f64, l: f64,
    #[particle(mass = m)] bob: Particle,
    #[joint(ground -> bob.at(-l * y), about = z)] hinge: Pin,";

const CART_POLE: &str = "
    #[body(mass = 1)] cart: Body,
    #[body(mass = 0.2, com = 0.3 * y, inertia = rod(0.2, 0.6, y))] pole: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> pole, about = z)] hinge: Pin,
    #[acts(on = rail)] push: Force,";

/// Name, arguments of the attribute, fields, and what is shown.
const MECHANISMS: [(&str, &str, &str, &[&str]); 6] = [
    (
        "pendulum",
        "gravity = -9.81 * y",
        PENDULUM,
        &[
            "EQUATIONS",
            "mass_matrix",
            "bias_forces",
            "inverse_dynamics",
            "forward_dynamics",
            "kinetic_energy",
        ],
    ),
    (
        "loop",
        "gravity = -9.81 * y",
        "#[body(mass = 1, com = x / 2, inertia = rod(1, 1, x))] crank: Body,
        #[body(mass = 2, com = x, inertia = rod(2, 2, x))] coupler: Body,
        #[body(mass = 2, com = x, inertia = rod(2, 2, x))] rocker: Body,
        #[joint(ground -> crank, about = z)] input: Pin,
        #[joint(crank.at(x) -> coupler, about = z)] middle: Pin,
        #[joint(ground.at(2 * x) -> rocker, about = z)] output: Pin,
        #[joint(coupler.at(2 * x) -> rocker.at(2 * x), about = z)] last: Pin,",
        &[
            "constraint_residuals",
            "constraint_jacobian",
            "forward_dynamics",
            "constrained_dynamics",
            "__constrained_dynamics",
        ],
    ),
    (
        "limbs",
        "gravity = -9.81 * y",
        "#[body(mass = 1)] cart: Body,
        #[body(mass = 0.2, com = 0.3 * y, inertia = rod(0.2, 0.6, y))] left: Body,
        #[body(mass = 0.2, com = 0.3 * y, inertia = rod(0.2, 0.6, y))] right: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart.at(-x) -> left, about = z)] first: Pin,
        #[joint(cart.at(x) -> right, about = z)] second: Pin,",
        &["mass_matrix", "bias_forces", "inverse_dynamics", "forward_dynamics"],
    ),
    (
        "prepare",
        "gravity = -9.81 * y, prepare",
        PENDULUM,
        &["prepare", "__prepared_numbers", "inverse_dynamics", "forward_dynamics"],
    ),
    ("batch", "gravity = -9.81 * y, batch", CART_POLE, &["forward_dynamics", "forward_dynamics_lanes"]),
    (
        "derivatives",
        "gravity = -9.81 * y, derivatives",
        CART_POLE,
        &["mass_matrix_inverse", "inverse_dynamics_derivatives", "forward_dynamics_derivatives", "linearize"],
    ),
];

/// The code without documentation, without what only says what is missing, and without frames.
fn shown(text: &str, functions: &[&str]) -> String {
    let mut file = syn::parse_file(text).unwrap();
    file.items.retain_mut(|item| {
        let syn::Item::Impl(block) = item else { return false };
        let clause = block.generics.where_clause.to_token_stream().to_string();
        let of = block.trait_.as_ref().map_or(String::new(), |t| t.0.to_token_stream().to_string());
        if clause.contains("absent") || of.contains("NamedFrame") || of.contains("Batch") {
            return false;
        }
        block.attrs.clear();
        let inherent = of.is_empty();
        block.items.retain_mut(|member| {
            let attributes = match member {
                syn::ImplItem::Fn(f) => {
                    let name = f.sig.ident.to_string();
                    if inherent && (!functions.contains(&name.as_str())) {
                        return false;
                    }
                    &mut f.attrs
                }
                syn::ImplItem::Const(c) if inherent && c.ident == "EQUATIONS" && functions.is_empty() => {
                    &mut c.attrs
                }
                syn::ImplItem::Type(_) => return true,
                _ => return false,
            };
            attributes.retain(|attribute| !attribute.path().is_ident("doc"));
            true
        });
        !block.items.is_empty() && (inherent || of.contains("Evaluate"))
    });
    prettyplease::unparse(&file)
        .replace("::linkwork::nalgebra::", "na::")
        .replace("::linkwork::__private::", "private::")
}

#[test]
fn generated_code() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    let write = std::env::var_os("LINKWORK_WRITE").is_some();
    let mut differ = Vec::new();
    for (name, attribute, fields, functions) in MECHANISMS {
        let item = format!("pub struct Shown {{ {fields} }}").parse().unwrap();
        let emitted = expand(attribute.parse().unwrap(), item, Path::new(""));
        assert!(!emitted.tokens.to_string().contains("compile_error"), "{name}: {}", emitted.tokens);
        let code = shown(&emitted.text, functions);
        let path = folder.join(format!("{name}.txt"));
        if write {
            fs::write(&path, &code).unwrap();
        }
        let expected = fs::read_to_string(&path).unwrap_or_default();
        if let Some((k, (now, before))) = code
            .lines()
            .zip(expected.lines().chain(std::iter::repeat("")))
            .enumerate()
            .find(|(_, (a, b))| a != b)
        {
            differ.push(format!("{name}.txt, line {}:\n  before: {before}\n  now:    {now}", k + 1));
        }
        assert!(code.lines().count() >= expected.lines().count() || !differ.is_empty(), "{name} is shorter");
    }
    assert!(differ.is_empty(), "generated code differs:\n{}", differ.join("\n"));
}

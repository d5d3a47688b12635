//! Tests of mechanisms with many elements, deep nesting, and coefficients near the limits of their range.

use super::{expand_and_check, run_with_little_stack};
use linkwork_compiler::expand;
use proc_macro2::TokenStream;
use std::path::Path;
use std::time::Instant;

/// Returns the fields of a chain of bodies with pins.
fn chain_fields(n: usize, kind: &str) -> String {
    let mut text = String::new();
    for k in 0..n {
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at(0.5 * x)", k - 1) };
        let axis = match kind {
            "Pin" => [", about = z", ", about = y", ", about = x"][k % 3],
            "Sleeve" => [", along = x", ", along = y", ", along = z"][k % 3],
            _ => "",
        };
        text += &format!(
            "#[body(mass = 1, com = 0.1 * y, inertia = sphere(1, 1))] b{k}: Body, \
             #[joint({parent} -> b{k}{axis})] j{k}: {kind},\n"
        );
    }
    text
}

fn concatenate_items(n: usize, item: impl Fn(usize) -> String) -> String {
    (0..n).map(item).collect()
}

/// Returns the fields of a planar chain of `pins` pins with `ties` further pins to the ground.
fn chain_fields_with_ground_pins(pins: usize, ties: usize) -> String {
    let bodies = concatenate_items(pins, |k| {
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at(x)", k - 1) };
        format!(
            "#[body(mass = 1, inertia = rod(1, 1, x))] b{k}: Body, \
             #[joint({parent} -> b{k}, about = z)] j{k}: Pin,\n"
        )
    });
    let ends = concatenate_items(ties, |k| {
        let (body, x, y) = ((2 * k + 3) % pins, (2 * k) % 7, k % 3);
        format!("#[joint(b{body}.at(x) -> ground.at({x} * x + {y} * y), about = z)] tie{k}: Pin,\n")
    });
    format!("struct S {{ {bodies} {ends} }}")
}

/// Returns the text of a mechanism whose mass is an expression.
pub fn mechanism_with_mass(e: &str) -> String {
    format!("struct S {{ m: f64, #[body(mass = {e})] b: Body, #[joint(ground -> b, along = x)] j: Sleeve }}")
}

fn mechanism_with_com(e: &str) -> String {
    format!(
        "struct S {{ m: f64, #[body(mass = 1, com = {e})] b: Body, \
         #[joint(ground -> b, about = unit(x + y + z))] j: Pin }}"
    )
}

fn mechanism_with_inertia(e: &str) -> String {
    format!(
        "struct S {{ m: f64, #[body(mass = 1, inertia = {e})] b: Body, \
         #[joint(ground -> b, about = z)] j: Pin }}"
    )
}

#[test]
fn oversized_input_of_every_kind_terminates() {
    let cases: Vec<(&str, String)> = vec![
        ("deep parentheses", mechanism_with_mass(&("(".repeat(100_000) + "m" + &")".repeat(100_000)))),
        ("deep brackets", mechanism_with_mass(&("[".repeat(10_000) + "m" + &"]".repeat(10_000)))),
        ("deep braces", "{".repeat(10_000) + &"}".repeat(10_000)),
        ("deep calls", mechanism_with_mass(&("sin(".repeat(10_000) + "m" + &")".repeat(10_000)))),
        ("parentheses just below the limit", mechanism_with_mass(&("(".repeat(40) + "m" + &")".repeat(40)))),
        ("minus signs", mechanism_with_mass(&("-".repeat(100_000) + "m"))),
        ("minus signs with spaces", mechanism_with_mass(&("- ".repeat(40) + "m"))),
        ("a sum", mechanism_with_mass(&vec!["m"; 10_000].join(" + "))),
        ("a sum just below the limit", mechanism_with_mass(&vec!["m"; 390].join(" + "))),
        ("a product", mechanism_with_mass(&vec!["m"; 10_000].join(" * "))),
        ("a product just below the limit", mechanism_with_mass(&vec!["m"; 390].join(" * "))),
        ("quotients", mechanism_with_mass(&vec!["m"; 390].join(" / "))),
        ("members", mechanism_with_mass(&("m".to_string() + &".m".repeat(10_000)))),
        ("members just below the limit", mechanism_with_mass(&("m".to_string() + &".m".repeat(390)))),
        ("rotations", mechanism_with_inertia(&("rod(1, 1, x)".to_string() + &".rotated(z(m))".repeat(390)))),
        ("rotations of an end", {
            let end = "ground".to_string() + &".rotated(x(m), y(m))".repeat(190);
            format!(
                "struct S {{ m: f64, #[body(mass = 1)] b: Body, #[joint({end} -> b, along = x)] j: Sleeve }}"
            )
        }),
        ("inertias", mechanism_with_inertia(&vec!["sphere(m, 1)"; 390].join(" + "))),
        ("parameters", format!("struct S {{ {} }}", concatenate_items(10_000, |k| format!("p{k}: f64,")))),
        ("parameters in use", {
            let sum = concatenate_items(190, |k| format!("+ p{k}"));
            format!(
                "struct S {{ {} #[body(mass = 1 {sum})] b: Body, #[joint(ground -> b, along = x)] j: Sleeve \
                 }}",
                concatenate_items(190, |k| format!("p{k}: f64,"))
            )
        }),
        ("parameters of one name", format!("struct S {{ {} }}", "p: f64,".repeat(10_000))),
        (
            "unknown things",
            format!("struct S {{ {} }}", concatenate_items(10_000, |k| format!("p{k}: Thing,"))),
        ),
        (
            "bodies",
            format!(
                "struct S {{ {} }}",
                concatenate_items(10_000, |k| format!("#[body(mass = 1)] b{k}: Body,"))
            ),
        ),
        ("particles", {
            let all = concatenate_items(200, |k| {
                format!("#[particle(mass = 1, at = b.at({k} * x))] p{k}: Particle,")
            });
            format!(
                "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve, {all} }}"
            )
        }),
        ("joints of one body", {
            let all = concatenate_items(5_000, |k| format!("#[joint(ground -> b, along = x)] j{k}: Sleeve,"));
            format!("struct S {{ #[body(mass = 1)] b: Body, {all} }}")
        }),
        ("force elements", {
            let all = concatenate_items(2_000, |k| format!("#[acts(on = j, damping = {k})] d{k}: Dashpot,"));
            format!(
                "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve, {all} }}"
            )
        }),
        ("inputs", {
            let all =
                concatenate_items(500, |k| format!("#[acts(on = b.at({k} * y), along = x)] f{k}: Force,"));
            format!(
                "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve, {all} }}"
            )
        }),
        ("arguments", mechanism_with_mass(&concatenate_items(10_000, |k| format!("1, a{k} = 1,")))),
        ("attributes", format!("struct S {{ {} b: Body }}", "#[body(mass = 1)]".repeat(10_000))),
        ("a long chain", format!("struct S {{ {} }}", chain_fields(2_000, "Pin"))),
        ("a long chain of welds", format!("struct S {{ {} }}", chain_fields(1_000, "Weld"))),
        (
            "a chain of welds on a pin",
            format!(
                "struct S {{ {} {} }}",
                chain_fields(1, "Pin"),
                chain_fields(900, "Weld").replace("b0: Body", "c0: Body").replace("ground ->", "b0 ->")
            ),
        ),
        ("a chain tied to the ground", chain_fields_with_ground_pins(85, 41)),
        ("a chain tied to the ground a few times", chain_fields_with_ground_pins(40, 4)),
        ("a chain tied to the ground everywhere", chain_fields_with_ground_pins(100, 50)),
        ("a chain tied to the ground too often", chain_fields_with_ground_pins(20, 100)),
        ("a chain of sleeves", format!("struct S {{ {} }}", chain_fields(40, "Sleeve"))),
        ("long generics", format!("struct S<{}> {{}}", concatenate_items(10_000, |k| format!("T{k},")))),
        ("deep types", format!("struct S {{ a: {}f64{} }}", "Vec<".repeat(10_000), ">".repeat(10_000))),
        ("references", format!("struct S {{ a: {}f64 }}", "&".repeat(10_000))),
        ("long names", mechanism_with_mass(&"m".repeat(100_000))),
        ("a long number", mechanism_with_mass(&"9".repeat(100_000))),
    ];
    expand_cases_with_little_stack(cases);
}

#[test]
fn too_many_loops_are_rejected_with_a_reason() {
    for (pins, ties, reason) in [
        (20, 100, "500 scalar constraints, more than 256"),
        (85, 41, "too many constraints of this mechanism are coupled"),
    ] {
        let output = expand(
            TokenStream::new(),
            chain_fields_with_ground_pins(pins, ties).parse().unwrap(),
            Path::new("../../tests/ui"),
        );
        let output = format!("{} {}", output.tokens, output.text);
        assert!(output.contains(reason), "{pins} pins with {ties} ties: {:.2000}", output);
    }
}

/// Returns a mechanism whose mass depends on a chain of `n` definitions, each of which uses the previous one
/// twice.
fn nested_definitions_source(start: &str, n: usize) -> String {
    let chain = (0..n).fold(format!("#[define({start})] d0: Scalar,"), |text, k| {
        format!("{text} #[define(sin(d{k}) * cos(d{k}))] d{}: Scalar,", k + 1)
    });
    format!(
        "struct S {{ m: f64, {chain} #[body(mass = 2 + d{n})] b: Body, \
         #[joint(ground -> b, along = x)] j: Sleeve }}"
    )
}

/// Returns a mechanism with identical carts, each driven by a chain of `n` definitions of its own coordinate.
/// The first two carts are coupled.
fn coupled_carts_source(n: usize) -> String {
    let cart_declarations = |name: &str| {
        let laws = concatenate_items(n, |k| {
            format!("#[define(2 * sin({name}{k} + 0.3) - 0.1)] {name}{}: Scalar, ", k + 1)
        });
        format!(
            "#[body(mass = 1)] {name}: Body, #[joint(ground -> {name}, along = x)] at_{name}: Sleeve,
             #[define(at_{name})] {name}0: Scalar, {laws}
             #[acts(on = at_{name}, value = {name}{n})] drive_{name}: Force, "
        )
    };
    let all: String = ["a", "b", "c"].map(cart_declarations).concat();
    format!("struct S {{ {all} #[acts(between = (a, b.at(x)), stiffness = 2)] tie: Spring }}")
}

#[test]
fn shared_subexpressions_do_not_explode() {
    let nested_calls =
        |f: &dyn Fn(String) -> String, start: &str, n: usize| (0..n).fold(start.to_string(), |e, _| f(e));
    let cases: Vec<(&str, String)> = vec![
        (
            "cross products on the left",
            mechanism_with_com(&nested_calls(&|e| format!("cross({e}, [1, m, 2])"), "[m, 1, 2]", 38)),
        ),
        (
            "cross products on the right",
            mechanism_with_com(&nested_calls(&|e| format!("cross([1, m, 2], {e})"), "[m, 1, 2]", 38)),
        ),
        (
            "cross products of two",
            mechanism_with_com(&nested_calls(&|e| format!("cross({e}, {e} + [1, m, 2])"), "[m, 1, 2]", 9)),
        ),
        ("powers of powers", mechanism_with_mass(&nested_calls(&|e| format!("pow({e}, 8)"), "(1 + m)", 40))),
        ("powers of sums", mechanism_with_mass(&nested_calls(&|e| format!("pow(1 + {e}, 4)"), "m", 40))),
        ("powers of numbers", mechanism_with_mass(&nested_calls(&|e| format!("pow({e}, 8)"), "2", 40))),
        ("sines of sines", mechanism_with_mass(&nested_calls(&|e| format!("(2 + sin({e}))"), "m", 22))),
        (
            "lengths of lengths",
            mechanism_with_mass(&nested_calls(&|e| format!("norm([{e}, m, 1])"), "m", 22)),
        ),
        (
            "quotients of quotients",
            mechanism_with_mass(&nested_calls(&|e| format!("(1 / (1 + {e}))"), "m", 22)),
        ),
        (
            "extremes of extremes",
            mechanism_with_mass(&nested_calls(&|e| format!("max(min({e}, m), {e})"), "m", 9)),
        ),
        (
            "unit vectors of unit vectors",
            mechanism_with_com(&nested_calls(&|e| format!("unit({e} + [1, m, 2])"), "[m, 1, 2]", 40)),
        ),
        ("large numbers", mechanism_with_mass("1e308 * m * 1e308")),
        ("small numbers", mechanism_with_mass("1e-308 * m * 1e-308")),
        ("a number that is zero", mechanism_with_mass("m + 1e-999")),
        (
            "large figures",
            "struct S { #[body(mass = 1e300, com = 1e300 * y)] b: Body, \
             #[joint(ground -> b, about = z)] j: Pin }"
                .into(),
        ),
        ("large figures of parameters", mechanism_with_com("1e200 * m * x + 1e200 * y")),
        (
            "large springs",
            "struct S { #[body(mass = 1)] a: Body, #[joint(ground -> a, along = x)] i: Sleeve, \
             #[acts(on = i, stiffness = 1e300, free_length = 1e300)] s: Spring }"
                .into(),
        ),
        (
            "large inertias",
            mechanism_with_inertia("diagonal(1e308, 1e308, 1e308) + diagonal(1e308, 1e308, 1e308)"),
        ),
        ("large solids", mechanism_with_inertia("sphere(1e200, 1e200)")),
        (
            "large axes",
            "struct S { m: f64, #[body(mass = m, com = x)] b: Body, \
             #[joint(ground -> b, about = unit(1e200 * x + 1e200 * y))] j: Pin }"
                .into(),
        ),
        (
            "small axes",
            "struct S { m: f64, #[body(mass = m, com = x)] b: Body, \
             #[joint(ground -> b, about = unit(1e-200 * x + 1e-200 * y))] j: Pin }"
                .into(),
        ),
        (
            "large leads",
            "struct S { m: f64, #[body(mass = m, com = x)] b: Body, \
             #[joint(ground -> b, about = z, pitch = 1e300)] j: Screw }"
                .into(),
        ),
        (
            "large gravity",
            mechanism_with_mass("m")
                .replace("j: Sleeve", "j: Sleeve, #[joint(b -> c, along = 1e-300 * x)] k: Pin"),
        ),
        ("a sum of many parameters", mechanism_with_mass_sums(40, 250)),
        ("definitions that name another twice", nested_definitions_source("m", 60)),
        ("definitions of a mistake", nested_definitions_source("nothing", 60)),
        ("definitions one in another", nested_definitions_source("m", 200)),
        ("a spring between alike carts", coupled_carts_source(0)),
        ("laws of alike carts", coupled_carts_source(20)),
        ("long laws of alike carts", coupled_carts_source(1500)),
    ];
    expand_cases_with_little_stack(cases);
}

/// Returns a mechanism whose mass is a sum of sums of parameters.
fn mechanism_with_mass_sums(sums: usize, terms: usize) -> String {
    let name_of_parameter = |k: usize, i: usize| format!("m{k}_{i}");
    let sum_source = |k: usize| (0..terms).map(|i| name_of_parameter(k, i)).collect::<Vec<_>>().join(" + ");
    let parameter_declarations =
        |k: usize| (0..terms).map(|i| name_of_parameter(k, i) + ": f64, ").collect::<String>();
    let sum_definition =
        |k: usize| format!("{} #[define({})] sum{k}: Scalar, ", parameter_declarations(k), sum_source(k));
    let all = (0..sums).map(|k| format!("sum{k}")).collect::<Vec<_>>().join(" + ");
    let fields: String = (0..sums).map(sum_definition).collect();
    mechanism_with_mass(&all).replace("m: f64, ", &fields)
}

/// Returns the text of a struct with a field of this type.
fn struct_with_type(text: &str) -> String {
    format!("struct S {{ a: {text} }}")
}

/// Returns the text of an expression with `n` levels of nesting.
fn nested_expression(n: usize, before: &str, inside: &str, after: &str) -> String {
    before.repeat(n) + inside + &after.repeat(n)
}

/// Input that nests without brackets, or needs much stack per level, is rejected or fits the stack.
#[test]
fn nested_input_does_not_overflow_the_stack() {
    let mut cases: Vec<(String, String)> = Vec::new();
    for n in [40, 46, 20_000] {
        let mut add = |name: &str, item: String| cases.push((format!("{n} {name}"), item));
        let pieces = concatenate_items(n, |k| format!("if m < {k} {{ {k} }} else "));
        add("pieces", mechanism_with_mass(&format!("{pieces} {{ m }}")));
        add(
            "pieces in pieces",
            mechanism_with_mass(&nested_expression(n.min(10_000), "if m < 1 { ", "m", " } else { 1 }")),
        );
        add(
            "branches in braces",
            mechanism_with_mass(&nested_expression(
                n.min(10_000),
                "if m < 1 { 1 } else if m < 2 { 2 } else { ",
                "m",
                " }",
            )),
        );
        add("signs in brackets", mechanism_with_mass(&nested_expression(n / 2, "-(", "m", ")")));
        add("runs of signs in brackets", mechanism_with_mass(&nested_expression(n / 4, "- - - (", "m", ")")));
        for function in ["sin", "sqrt", "abs"] {
            add(function, mechanism_with_mass(&nested_expression(n, &format!("{function}("), "m", ")")));
        }
        for (before, after) in [
            ("max(m, ", ")"),
            ("pow(", ", 2)"),
            ("atan2(", ", 2)"),
            ("norm([", ", m, 1])"),
            ("norm(unit([m, 1, ", "]))"),
            ("dot(x, [1, 2, ", "])"),
            ("norm(cross(x, [1, 2, ", "]))"),
            ("trace(skew([1, 2, ", "]))"),
            ("angle(x, [1, 2, ", "])"),
            ("1 / (1 + m * (2 - ", "))"),
            ("dot(transpose([[1, 2, 3], [4, 5, 6], [7, 8, ", "]]) * x, y)"),
        ] {
            // Each bracket of a level counts.
            let brackets = before.matches(['(', '[']).count();
            add(
                before,
                mechanism_with_mass(&nested_expression(n.min(10_000) / brackets, before, "m", after)),
            );
        }
        add("references", struct_with_type(&nested_expression(n, "&mut ", "f64", "")));
        add("pointers", struct_with_type(&nested_expression(n, "*const ", "f64", "")));
        add("functions", struct_with_type(&nested_expression(n / 2, "fn() -> ", "f64", "")));
        add(
            "lifetimes of functions",
            struct_with_type(&nested_expression(n / 8, "for<'a> fn() -> ", "f64", "")),
        );
        add("generics in tuples", struct_with_type(&nested_expression(n / 4, "Vec<(", "f64", ")>")));
        for operand in
            ["1 + ", "return ", "|a| ", "!", "&mut ", "1 .. ", "a = ", "if a {} else ", "break 'a "]
        {
            add(operand, struct_with_type(&format!("[f64; {} 1]", operand.repeat(n))));
            add(operand, struct_with_type(&format!("Foo<{{ {} 1 }}>", operand.repeat(n))));
        }
        add("methods", struct_with_type(&format!("[f64; a{}]", ".b()?".repeat(n))));
        add("members", struct_with_type(&format!("[f64; a{}]", ".b".repeat(n))));
        add("bounds", format!("struct S<T> where T: {} A {{ a: T }}", "A + ".repeat(n)));
        add("closures", format!("struct S<T> where {} f64: A {{ a: T }}", "fn() -> ".repeat(n)));
    }
    for (name, item) in cases {
        run_with_little_stack(move || expand_and_check(TokenStream::new(), item.parse().unwrap(), &name));
    }
}

fn expand_cases_with_little_stack(cases: Vec<(&'static str, String)>) {
    for (name, item) in cases {
        let expand_and_print_time = move || {
            let start = Instant::now();
            let tokens = item.parse().unwrap_or_else(|_| panic!("{name} are no tokens"));
            expand_and_check(TokenStream::new(), tokens, name);
            println!("{:>8.2?} {name}", start.elapsed());
        };
        run_with_little_stack(expand_and_print_time);
    }
}

//! Test that parses the MathML of the documentation and compares its values with those of the plain text.

use super::super::print::mathml::format_name;
use super::*;
use roxmltree::{Document, Node};

/// Converts a MathML element to plain text, with simplified names of symbols.
fn element_to_text(node: Node<'_, '_>) -> String {
    let children: Vec<Node<'_, '_>> = node.children().filter(Node::is_element).collect();
    let own_text = || node.text().unwrap_or("").to_string();
    let child_text = |k: usize| element_to_text(children[k]);
    let replace_commas_by_dots = |index: String| index.replace(',', ".");
    match node.tag_name().name() {
        "math" | "mrow" => concatenate_elements(&children),
        "mn" | "mi" => own_text(),
        "mo" => match own_text().as_str() {
            "+" => " + ".to_string(),
            "−" => if node.attribute("form") == Some("prefix") { "-" } else { " - " }.to_string(),
            "\u{2062}" => " ".to_string(),
            "\u{2061}" => String::new(),
            "˙" => "'".to_string(),
            "¨" => "''".to_string(),
            "=" => " = ".to_string(),
            other => other.to_string(),
        },
        "mover" => child_text(0) + &child_text(1),
        "msub" => format!("{}_{}", child_text(0), replace_commas_by_dots(child_text(1))),
        "msubsup" => {
            format!(
                "{}_{}{}",
                child_text(0),
                replace_commas_by_dots(child_text(1)),
                superscript_of_digit(&child_text(2))
            )
        }
        "msup" => child_text(0) + &superscript_of_digit(&child_text(1)),
        "mfrac" => format!("({})/({})", child_text(0), child_text(1)),
        "msqrt" => format!("sqrt({})", child_text(0)),
        other => panic!("<{other}>"),
    }
}

/// Concatenates elements. An argument without parentheses gets them.
fn concatenate_elements(children: &[Node<'_, '_>]) -> String {
    let (mut out, mut of) = (String::new(), false);
    for child in children {
        let one = element_to_text(*child);
        out += &if of && !one.starts_with('(') { format!("({one})") } else { one };
        of = child.text() == Some("\u{2061}");
    }
    out
}

fn superscript_of_digit(digit: &str) -> String {
    ["", "", "²", "³", "⁴", "⁵", "⁶", "⁷"][digit.parse::<usize>().expect("a power")].to_string()
}

/// Returns the left and right side of each equation on a MathML page.
fn equations_of_page(page: &str) -> Vec<(String, String)> {
    let document = Document::parse(page).unwrap_or_else(|e| panic!("{e}: {page}"));
    let paragraphs = document.root_element().children();
    paragraphs
        .map(|paragraph| {
            let parts: Vec<Node<'_, '_>> = paragraph.children().filter(Node::is_element).collect();
            // Each term is a formula of its own.
            let line = parts.iter().map(|part| element_to_text(*part)).collect::<String>();
            let (left, right) = line.split_once(" = ").unwrap_or_else(|| panic!("{line}"));
            (left.to_string(), right.to_string())
        })
        .collect()
}

/// Checks that the MathML and the plain text of a mechanism's equations have the same values.
fn check_mathml_page(model: &Model<'_>) {
    let joints = crate::kinematics::joints_of_model(model);
    let mass = crba::mass_matrix(model, &joints);
    let e = derive(model, &joints, &mass, None, &EquationSizeLimits::READABLE).expect("small");
    let written = format_equations(model, &e);
    let (plain, page) = (sides_of_equations(&written.plain), equations_of_page(&written.mathml));
    assert_eq!(plain.len(), page.len(), "{}", written.mathml);
    let rates = written::coordinate_rate_velocity_flags(model);
    let names = written::typeset_names_with_extra_names(model, &[]);
    let symbols = (0..model.parameters.len())
        .map(Quantity::Parameter)
        .chain((0..model.nq()).map(Quantity::Configuration))
        .chain((0..model.nv()).flat_map(|k| [Quantity::Velocity(k), Quantity::Acceleration(k)]))
        .chain((0..model.nu()).map(Quantity::Input))
        .chain((0..model.constraints.len()).map(|k| Quantity::Given(SuppliedQuantity::Multiplier, k)))
        .chain([Quantity::Time]);
    let spelled: Vec<(String, Symbol)> = symbols
        .map(|q| {
            let (name, dots) = written::name_and_derivative_order(model, &rates, q.symbol());
            let spelled = format_name(&names.typeset_name(&name), dots, 1);
            (element_to_text(Document::parse(&spelled).unwrap().root_element()), q.symbol())
        })
        .collect();
    for seed in 1..4 {
        let symbol = random_symbol_values(model, seed);
        let value_of_spelled_name = |word: &str| match spelled.iter().find(|(name, _)| name == word) {
            Some((_, s)) => symbol(*s),
            None => panic!("{word}: {spelled:?}"),
        };
        let names = value_lookup_by_name(model, &symbol);
        for (k, (plain, page)) in plain.iter().zip(&page).enumerate() {
            if k > 0 {
                assert_near(
                    &[evaluate_text(&page.0, &value_of_spelled_name)],
                    &[evaluate_text(&plain.0, &names)],
                    &page.0,
                );
            }
            assert_near(
                &[evaluate_text(&page.1, &value_of_spelled_name)],
                &[evaluate_text(&plain.1, &names)],
                &page.1,
            );
        }
    }
}

#[test]
fn mathml_pages_state_the_same_equations_as_text() {
    for item in [CART_POLE, NUMBERS] {
        call_with_parsed_model("-9.81 * z", item, |model| check_mathml_page(&model));
    }
    for item in [DOUBLE_PENDULUM, GYROSCOPE, SHAFT, SPHERICAL, CHAIN, BALL, ARM, WAGON, SPHERE, DISK, FREE] {
        call_with_parsed_model("-g * z", item, |model| check_mathml_page(&model));
        call_with_parsed_model("-g * y", item, |model| check_mathml_page(&model));
    }
}

/// The pages of all other forms are well-formed as well.
#[test]
fn mathml_pages_of_all_forms_are_well_formed() {
    for (words, item) in [("hamilton", CART_POLE), ("hamilton", ARM), ("routh", GYROSCOPE), ("kane", SPHERE)]
    {
        let g = if item.contains(" g: f64") { "g" } else { "9.81" };
        let arguments = format!("gravity = -{g} * z, equations = {words}").parse().unwrap();
        let emitted = crate::expand(arguments, item.parse().unwrap(), Path::new(""));
        let tokens = emitted.tokens.to_string();
        let file = syn::parse_file(&tokens).expect("a file");
        let page = file.items.iter().find_map(|item| match item {
            syn::Item::Struct(item) => item.attrs.iter().find_map(|attribute| {
                let list =
                    attribute.meta.require_list().ok().filter(|list| list.path.is_ident("cfg_attr"))?;
                let (head, text) =
                    list.tokens.to_string().split_once('=').map(|(a, b)| (a.to_string(), b.to_string()))?;
                head.starts_with("doc")
                    .then(|| syn::parse_str::<syn::LitStr>(text.trim()).expect("a text").value())
            }),
            _ => None,
        });
        let page = page.unwrap_or_else(|| panic!("{tokens}"));
        let html = page.trim_start().lines().next().expect("a line");
        assert!(equations_of_page(html).len() >= 2, "{words}: {html}");
    }
}

//! Tests of the attribute's options: valid and invalid arguments, and the resulting messages or code.

use linkwork_compiler::{check_mechanism, expand};
use std::path::Path;

const CART: &str = "#[body(mass = 1)] cart: Body, #[joint(ground -> cart, along = x)] rail: Sleeve,";

fn compiler_messages(arguments: &str, fields: &str) -> Vec<String> {
    let item = format!("struct S {{ {fields} }}");
    check_mechanism(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""))
}

fn generated_code(arguments: &str, fields: &str) -> String {
    let item = format!("/// `::linkwork::`\npub struct S {{ {fields} }}");
    let emitted = expand(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""));
    emitted.into_tokens().unwrap().to_string().replace(' ', "")
}

const NONE: [String; 0] = [];

#[test]
fn conditional_struct_fields_are_rejected() {
    let help = "= help: put `#[cfg(…)]` on the whole struct, before `#[mechanism]`, and write one struct for \
                each case";
    let used = "#[body(mass = m)] cart: Body, #[joint(ground -> cart, along = x)] rail: Sleeve,";
    for attribute in ["cfg(unix)", "cfg_attr(unix, unit(kg))", "cfg_attr(unix, cfg(test))"] {
        let messages = compiler_messages("", &format!("#[{attribute}] m: f64, {used}"));
        assert_eq!(messages, [format!("a parameter cannot be conditional\n\n{help}")], "{attribute}");
    }
    assert_eq!(compiler_messages("", &format!("#[cfg_attr(unix, serde(skip))] m: f64, {used}")), NONE);
    let messages = compiler_messages("", &format!("#[cfg(unix)] {CART}"));
    assert_eq!(messages, [format!("an element cannot be conditional\n\n{help}")]);
}

#[test]
fn runtime_crate_may_be_renamed() {
    let fields = format!("{CART} #[output(r(cart / ground))] place: Vector,");
    let words = "derivatives, centroidal, regressor, packed, batch";
    let usual = generated_code(words, &fields);
    for (path, spelt) in [("lw", "uselwas"), ("::a::b", "use::a::bas"), ("crate::c", "usecrate::cas")] {
        for arguments in [format!("crate = {path}, {words}"), format!("{words}, crate = {path}")] {
            let renamed = generated_code(&arguments, &fields);
            assert!(renamed.contains(&format!("{spelt}__linkwork_of_S;")), "{path}");
            // Text of the user does not change.
            assert!(renamed.contains("\"`::linkwork::`\""));
            let of_the_user = "\"`::linkwork::`\"";
            let back = renamed.replace("__linkwork_of_S::", "::linkwork::");
            let rest = back.replace(of_the_user, "");
            assert_eq!(
                rest.matches("::linkwork::").count(),
                usual.replace(of_the_user, "").matches("::linkwork::").count()
            );
            assert!(!renamed.replace(of_the_user, "").contains("::linkwork::"), "{path}");
        }
    }
    // A generic struct, without and with an error.
    let expand_generic_mechanism = |fields: &str| {
        let item = format!("struct S<T> {{ m: T, {} {fields} }}", CART.replace("mass = 1", "mass = m"));
        let emitted = expand("crate = lw, prepare".parse().unwrap(), item.parse().unwrap(), Path::new(""));
        emitted.into_tokens().unwrap().to_string().replace(' ', "")
    };
    for fields in ["", "#[output(unknown)] mistake: Scalar,"] {
        assert!(!expand_generic_mechanism(fields).contains("::linkwork::"), "{fields}");
    }
    assert!(compiler_messages("crate = 3", CART)[0].starts_with("expected a path for `crate`"));
    assert!(compiler_messages("crate = ", CART)[0].starts_with("expected a path for `crate`"));
    assert_eq!(compiler_messages("crate = a, crate = b", CART), ["`crate` is given twice"]);
}

#[test]
fn doc_comments_of_fields_are_copied_to_functions() {
    let text = generated_code(
        "",
        "/// Mass | of all.\n m: f64,
        /// A box.\n #[body(mass = m)] cart: Body,
        /// How far it\n/// went.\n///\n/// More.\n #[joint(ground -> cart, along = x)] rail: Sleeve,
        /// The push.\n #[acts(on = rail)] push: Force,
        /// Where it is.\n #[output(r(cart / ground))] place: Vector,
        /// What it feels.\n #[output(reaction_force(rail))] load: Vector,
        /// How it speeds up.\n #[output(dot(a(cart / ground / ground), x))] jolt: Scalar,",
    );
    for expected in [
        "|parameter|`m`|kg|Mass\\\\|ofall.|",
        "-`cart`:Abox.",
        "|`q[0]`|`rail`|m|Howfaritwent.|",
        "|`v[0]`|`rail`|m/s||",
        "|`u[0]`|`push`|N|Thepush.|",
        "|output|`place`|m|Whereitis.|",
        "\"Whereitis.\\n\\nTheoutput`place`.\"",
        "\"Whatitfeels.\\n\\nTheoutput`load`,inthemotionundertheinputs",
        "\"Howitspeedsup.\\n\\nTheoutput`jolt`,fortheaccelerations`a`.Theoption`derivatives`addsfunctionsforitsderivatives.\"",
    ] {
        assert!(text.contains(expected), "{expected}\n{text}");
    }
}

#[test]
fn documentation_states_what_determines_the_motion() {
    let fields =
        "#[body(mass = 1, inertia = sphere(1, 1))] stone: Body, #[joint(ground -> stone)] flight: Free,
        #[output(stone)] diagram: FreeBody, #[output(reaction_force(flight))] load: Vector,";
    let text = generated_code("", fields);
    for expected in [
        "thefree-bodydiagramof`stone`inthemotionthatthestatedetermines:nothingacts.",
        "Theoutput`load`,inthemotionthatthestatedetermines:",
    ] {
        assert!(text.contains(expected), "{expected}\n{text}");
    }
    let text = generated_code("", &format!("{fields} #[acts(on = stone, along = x)] push: Force,"));
    for expected in [
        "thefree-bodydiagramof`stone`inthemotionundertheinputs:`push`.",
        "Theoutput`load`,inthemotionundertheinputs:",
    ] {
        assert!(text.contains(expected), "{expected}\n{text}");
    }
    let text =
        generated_code("", &format!("{fields} #[contact(stone.sphere(1), ground.plane(z))] floor: Contact,"));
    let expected = "Theoutput`load`,inthemotionthatthestatedetermineswithouttheforcesofunilateralcontacts:";
    assert!(text.contains(expected), "{expected}\n{text}");
}

/// The mechanism of a file is a constant, unless the struct is generic.
#[test]
fn robot_file_mechanism_is_a_constant() {
    let expand_file_mechanism = |item: &str| {
        let arguments = "urdf = \"../../models/urdf/double_pendulum.urdf\", parameters = [inertial]";
        let emitted = expand(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""));
        emitted.into_tokens().unwrap().to_string().replace(' ', "")
    };
    let plain = expand_file_mechanism("pub struct S;");
    assert!(plain.contains("pubconstFILE:Self=") && plain.contains("pubconstfnfrom_file()->Self"), "{plain}");
    let own = expand_file_mechanism(
        "pub struct S { gain: f64, #[acts(on = joint1, damping = gain)] drag: Dashpot }",
    );
    assert!(
        !own.contains("pubconstFILE:Self=") && own.contains("pubconstfnfrom_file(gain:f64)->Self"),
        "{own}"
    );
    let generic = expand_file_mechanism("pub struct S<T>;");
    assert!(
        !generic.contains("pubconstFILE:Self=") && generic.contains("pubfnfrom_file()->Self"),
        "{generic}"
    );
}

#[test]
fn documentation_explains_empty_equations() {
    let equations_doc = |arguments: &str, fields: &str| {
        let text = generated_code(arguments, fields);
        let before = text.split("pubconstEQUATIONS:&'staticstr=").next().unwrap().to_string();
        before.rsplit("#[doc=").next().unwrap().to_string()
    };
    assert!(
        equations_doc("", "#[body(mass = 1)] stone: Body, #[joint(ground -> stone)] base: Weld,")
            .contains("Empty:nothingmoves.")
    );
    let kinematic = CART.replace("mass = 1", "");
    assert!(
        equations_doc("inertia = none", &kinematic)
            .contains("Empty:withoutinertiatherearenoequationsofmotion.")
    );
    assert!(!equations_doc("", CART).contains("Empty"));
    assert!(
        generated_code("equations = structure", CART)
            .contains("Theoption`equations=structure`omitstheterms.")
    );
}

/// After an error the set of frames is unknown, so every frame name is accepted.
#[test]
fn frame_names_are_accepted_after_an_error() {
    let any = "None=>::core::option::Option::Some(0)";
    assert!(!generated_code("", CART).contains(any));
    assert!(generated_code("", &format!("{CART} #[output(unknown)] mistake: Scalar,")).contains(any));
}

/// An input that only the rate of a state contains has no generalized force, even if a force depends on
/// velocities.
#[test]
fn inputs_of_state_rates_have_no_generalized_force() {
    let fields = "lag: f64, command: Input, #[state(rate = (command - level) / lag)] level: State, \
                  #[body(mass = 1, com = x)] arm: Body, #[joint(ground -> arm, about = z)] pin: Pin, \
                  #[acts(on = cable(arm.at(x) / ground.at(2 * y), ground.cylinder(0.1, z)), value = -3 * \
                  rate(cable(arm.at(x) / ground.at(2 * y), ground.cylinder(0.1, z))))] rope: Force,";
    let emitted = generated_code("", fields);
    assert!(!emitted.contains("compile_error"), "{emitted}");
}

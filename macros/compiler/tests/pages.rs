//! Checks that documentation pages and test lists name all joints, elements and options of the compiler, and
//! all passes of programs.

use linkwork_compiler::lower::pipeline::{DRAFT, FINISH};
use linkwork_compiler::syntax::{ElementKind, ForceKind, JointKind, RequestOption};
use std::path::Path;

/// Files by their paths in the repository, each with the form in which `NAME` appears.
type FilesWithNameForms = &'static [(&'static str, &'static str)];

/// Checks that names are on pages, and fails with the files in which names are missing.
fn check_names_on_pages(names: &[String], places: FilesWithNameForms) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut missing = Vec::new();
    for (path, form) in places {
        let text = std::fs::read_to_string(root.join(path)).unwrap();
        let absent = names.iter().map(|name| form.replace("NAME", name)).filter(|form| !text.contains(form));
        missing.extend(absent.map(|form| format!("{path} lacks {form}")));
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// Joints are listed in the guide, the runtime's tables, the book, the error for the type `Joint`, and the
/// lists for random mechanisms.
#[test]
fn joints_are_listed_in_all_pages() {
    let names: Vec<String> = JointKind::names().map(ToString::to_string).collect();
    check_names_on_pages(
        &names,
        &[
            ("runtime/guide/language.md", "| [`NAME`](crate::elements::NAME) |"),
            ("runtime/src/elements.rs", "[`NAME`]"),
            ("runtime/src/elements/joints.rs", "pub enum NAME {}"),
            ("models/src/lib.rs", "`NAME`"),
            ("macros/compiler/src/syntax/words/tables.rs", "`NAME`"),
            ("macros/compiler/tests/model/main.rs", "(\"NAME\","),
            ("macros/compiler/tests/oracle/spec.rs", "Kind::NAME,"),
            ("macros/compiler/tests/oracle/features/source.rs", "(\"NAME\","),
            ("tests/random_tree/mod.rs", "\"NAME\""),
        ],
    );
}

/// Elements are listed in the guide, the runtime's tables and types; force elements also in the random
/// mechanisms of the oracle.
#[test]
fn elements_are_listed_in_all_pages() {
    let names: Vec<String> = ElementKind::element_names().map(ToString::to_string).collect();
    assert!(names.iter().all(|name| ElementKind::find_by_name(name).is_some()));
    check_names_on_pages(
        &names,
        &[
            ("runtime/guide/language.md", "[`NAME`](crate::elements::NAME)"),
            ("runtime/src/elements.rs", "[`NAME`]"),
        ],
    );
    let forces = ForceKind::names().map(ToString::to_string);
    // These two are compared only with closed-form solutions.
    let forces: Vec<String> = forces.filter(|name| name != "Friction" && name != "Gravity").collect();
    check_names_on_pages(&forces, &[("macros/compiler/tests/oracle/features/source.rs", "\"NAME\"")]);
}

/// Returns the spelling of an option, from the trait that reports its absence: `AsksForSecondDerivatives`
/// becomes `second_derivatives`.
fn option_spelling(word: RequestOption) -> String {
    let name = word.trait_for_missing_option().trim_start_matches("AsksFor");
    let snake_case_letter =
        |c: char| if c.is_uppercase() { format!("_{}", c.to_lowercase()) } else { c.to_string() };
    name.chars().map(snake_case_letter).collect::<String>().trim_start_matches('_').to_string()
}

#[test]
fn language_words_are_listed_in_the_guide() {
    let names: Vec<String> = RequestOption::ALL.into_iter().map(option_spelling).collect();
    check_names_on_pages(
        &names,
        &[
            ("macros/src/lib.rs", "/// | `NAME` |"),
            ("runtime/guide/functions.md", "| `NAME` |"),
            ("runtime/src/absent.rs", "this needs the option `NAME`"),
            ("macros/compiler/tests/mechanisms/mod.rs", "NAME"),
        ],
    );
    // This option is rejected if no coordinate is cyclic.
    let any: Vec<String> = names.into_iter().filter(|name| name != "routh").collect();
    check_names_on_pages(
        &any,
        &[
            ("macros/compiler/tests/oracle/features/source.rs", "    \"NAME\","),
            ("macros/compiler/tests/recovery.rs", "NAME"),
        ],
    );
}

#[test]
fn compiler_passes_are_listed_in_the_readme() {
    let rows: Vec<String> =
        DRAFT.iter().chain(FINISH).map(|pass| format!("| `{}` | {} |", pass.name, pass.about)).collect();
    check_names_on_pages(&rows, &[("macros/compiler/README.md", "NAME")]);
}

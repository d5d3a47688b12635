//! Dependencies between modules: each stage imports only the modules that the README permits.

mod imports;

use imports::{SourceDependencies, dependency_cycles, rust_files};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
/// Folders of the sources, relative to [`ROOT`]: the stages that know no mechanics are a crate of their own.
const SOURCES: [&str; 2] = ["src", "../symbolic/src"];
const INVARIANT: &str = "- Architecture invariant: ";

/// Returns the permitted modules of each module, from the README's lines "`a` uses `b` and `c`; `d` uses
/// `e`."
fn permitted_module_dependencies() -> BTreeMap<String, Vec<String>> {
    let readme = fs::read_to_string(Path::new(ROOT).join("README.md")).unwrap();
    let clauses =
        readme.lines().filter_map(|line| line.strip_prefix(INVARIANT)).flat_map(|line| line.split(';'));
    let mut found = BTreeMap::new();
    for clause in clauses.filter(|clause| clause.contains("` uses ")) {
        let mut words = clause.split('`').skip(1).step_by(2).map(ToString::to_string);
        let module = words.next().unwrap();
        assert!(found.insert(module, words.collect()).is_none(), "two invariants for one module: {clause}");
    }
    found
}

/// Returns all source files of the compiler, each with its module. The pipeline, in the files of the crates'
/// roots, may use all modules.
fn source_files_with_modules() -> Vec<(String, PathBuf)> {
    let mut files = Vec::new();
    for source in SOURCES.map(|source| Path::new(ROOT).join(source)) {
        let module_of_path = |path: &Path| {
            let first = path.strip_prefix(&source).unwrap().components().next().unwrap();
            Path::new(first.as_os_str()).file_stem().unwrap().to_string_lossy().into_owned()
        };
        files.extend(rust_files(&source).into_iter().map(|path| (module_of_path(&path), path)));
    }
    files.sort();
    files
}

/// Returns the code without comments and unit tests. Unit tests may use any module.
fn code_without_tests(path: &Path) -> String {
    let is_test = path.components().any(|c| c.as_os_str() == "tests") || path.ends_with("tests.rs");
    let text = if is_test { String::new() } else { fs::read_to_string(path).unwrap() };
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Returns the modules that a piece of code names: `crate::a::…`, `crate::{a, b::…}`.
fn modules_named_in_code(code: &str) -> Vec<String> {
    let leading_word =
        |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut found = Vec::new();
    for rest in code.split("crate::").skip(1) {
        let Some(group) = rest.strip_prefix('{') else {
            found.push(leading_word(rest));
            continue;
        };
        let mut depth = 0;
        let mut start = true;
        for (at, c) in group.char_indices() {
            if start && depth == 0 && c.is_alphabetic() {
                found.push(leading_word(&group[at..]));
                start = false;
            }
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => start = true,
                _ => {}
            }
        }
    }
    found
}

#[test]
fn stages_import_only_earlier_stages() {
    let invariants = permitted_module_dependencies();
    let mut violations = Vec::new();
    for (module, path) in source_files_with_modules() {
        if ["lib", "source", "declarations"].contains(&module.as_str()) {
            continue;
        }
        let Some(allowed) = invariants.get(&module) else {
            violations.push(format!("the README says nothing of `{module}`"));
            continue;
        };
        for used in modules_named_in_code(&code_without_tests(&path)) {
            if used != module && !allowed.contains(&used) {
                violations.push(format!("{}: `{module}` uses `{used}`", path.display()));
            }
        }
    }
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

/// Returns the stages in the order of the README's table.
fn stages_of_readme() -> Vec<String> {
    let readme = fs::read_to_string(Path::new(ROOT).join("README.md")).unwrap();
    let table = readme.lines().skip_while(|line| !line.starts_with("| stage |")).skip(2);
    let rows = table.map_while(|line| line.strip_prefix("| `"));
    rows.filter_map(|row| row.split('`').next().map(ToString::to_string)).collect()
}

#[test]
fn stages_use_only_stages_listed_above() {
    let (stages, invariants) = (stages_of_readme(), permitted_module_dependencies());
    assert!(invariants.keys().all(|stage| stages.contains(stage)), "missing in the table: {invariants:?}");
    for (at, stage) in stages.iter().enumerate() {
        for used in invariants.get(stage).into_iter().flatten() {
            assert!(stages[..at].contains(used), "`{stage}` uses `{used}`, which does not stand above it");
        }
    }
}

/// Maximum number of files in a permitted import cycle.
const MOST_IN_A_CIRCLE: usize = 3;

#[test]
fn import_cycles_have_a_maximum_length() {
    for source in SOURCES {
        let imports = SourceDependencies::read_imports(&Path::new(ROOT).join(source));
        let format_import_cycle = |circle: &Vec<usize>| {
            let names: Vec<String> = circle.iter().map(|file| imports.relative_file_path(*file)).collect();
            format!("{}: {}", circle.len(), names.join(" "))
        };
        let all = dependency_cycles(&imports.dependency_graph());
        let list: Vec<String> = all.iter().map(format_import_cycle).collect();
        println!("{}", list.join("\n"));
        assert!(all.iter().all(|circle| circle.len() <= MOST_IN_A_CIRCLE), "{}", list.join("\n"));
    }
}

#[test]
fn middle_stages_use_no_tokens_or_spans() {
    for (module, path) in source_files_with_modules() {
        let words: &[&str] = match module.as_str() {
            "expr" | "mechanism" | "kinematics" | "passes" | "vectorise" | "mechanics" | "lower" => {
                &["proc_macro2", "syn::", "quote!", "Span"]
            }
            "resolve" => &["syn::", "quote!"],
            _ => continue,
        };
        let code = code_without_tests(&path).replace("crate::syntax::", "");
        for word in words {
            assert!(!code.contains(word), "{}: `{word}` in `{module}`", path.display());
        }
    }
}

#[test]
fn compiler_uses_no_hash_tables() {
    for (_, path) in source_files_with_modules() {
        let code = code_without_tests(&path);
        for word in ["HashMap", "HashSet", "RandomState"] {
            assert!(!code.contains(word), "{}: `{word}`", path.display());
        }
    }
}

#[test]
fn use_items_are_parsed_like_rustc() {
    let code = "use crate::diag::{A, b}; use crate::{expr, mechanism::{Model, x}, lower::y}; let z = \
                crate::emit::f();";
    assert_eq!(modules_named_in_code(code), ["diag", "expr", "mechanism", "lower", "emit"]);
    assert_eq!(permitted_module_dependencies()["import"], ["diag", "hull", "syntax"]);
}

//! Dependencies between the files of the crate. Names in `use` declarations and paths are resolved through
//! re-exports to the file that defines them. A file that only declares modules and re-exports names has no
//! dependencies.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Path of a module from the crate's root, as a list of names.
type ModulePath = Vec<String>;

/// Source file of the compiler with its imports, for checks of the architecture.
struct File {
    path: PathBuf,
    module: ModulePath,
    /// Tokens of the code, without comments, strings, unit tests and imports.
    tokens: Vec<String>,
    /// Names that the source file defines.
    items: BTreeSet<String>,
    /// Imports: local name (`*` for all names), path as written, and whether the name is re-exported.
    imports: Vec<(String, Vec<String>, bool)>,
}

/// Returns the paths of all Rust files below a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut todo = vec![folder.to_path_buf()];
    while let Some(folder) = todo.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                todo.push(path);
            } else if path.extension().is_some_and(|end| end == "rs") {
                files.push(path);
            }
        }
    }
    files
}

/// Source files of the crate, with the dependencies between them.
pub struct SourceDependencies {
    files: Vec<File>,
    by_module: BTreeMap<ModulePath, usize>,
}

impl SourceDependencies {
    /// Reads all source files of the compiler below a folder, except tests.
    pub fn read_imports(source: &Path) -> SourceDependencies {
        let paths = rust_files(source).into_iter().filter(|path| !is_test_file(path));
        let mut files: Vec<File> = paths.map(|path| File::read_file_imports(source, path)).collect();
        files.sort_by(|a, b| a.path.cmp(&b.path));
        let by_module = files.iter().enumerate().map(|(k, file)| (file.module.clone(), k)).collect();
        SourceDependencies { files, by_module }
    }

    /// Returns the path of a source file relative to the folder of the crate's sources.
    pub fn relative_file_path(&self, file: usize) -> String {
        self.files[file].path.to_string_lossy().into_owned()
    }

    /// Returns the import graph: for each file, the files on which it depends.
    pub fn dependency_graph(&self) -> Vec<BTreeSet<usize>> {
        (0..self.files.len()).map(|k| self.dependencies_of_file(k)).collect()
    }

    fn dependencies_of_file(&self, k: usize) -> BTreeSet<usize> {
        let file = &self.files[k];
        let mut found = BTreeSet::new();
        for (name, path, passes_on) in &file.imports {
            if !passes_on || file.tokens.contains(name) {
                found.extend(self.defining_file(&file.module, path, 0));
            }
        }
        let mut at = 0;
        while at < file.tokens.len() {
            let path = path_from_token(&file.tokens, at);
            at += (2 * path.len()).saturating_sub(1).max(1);
            if path.len() > 1 {
                found.extend(self.defining_file(&file.module, &path, 0));
            }
        }
        found.remove(&k);
        found
    }

    /// Returns the file that defines a path in a module. Returns `None` for modules and for names of other
    /// crates.
    fn defining_file(&self, from: &[String], path: &[String], depth: usize) -> Option<usize> {
        let mut module = from.to_vec();
        let mut rest = path;
        while let [first, others @ ..] = rest {
            match first.as_str() {
                "crate" => module.clear(),
                "super" => drop(module.pop()),
                "self" => {}
                _ => break,
            }
            rest = others;
        }
        self.resolve_import_path(&module, rest, depth)
    }

    fn resolve_import_path(&self, module: &[String], path: &[String], depth: usize) -> Option<usize> {
        let [first, rest @ ..] = path else { return None };
        let child: ModulePath = module.iter().chain([first]).cloned().collect();
        if self.by_module.contains_key(&child) {
            return self.resolve_import_path(&child, rest, depth);
        }
        let own = *self.by_module.get(module)?;
        let file = &self.files[own];
        if file.items.contains(first) {
            return Some(own);
        }
        if depth > 8 {
            return None;
        }
        let follow_import = |target: &[String], rest: &[String]| {
            let whole: Vec<String> = target.iter().chain(rest).cloned().collect();
            let outside = !matches!(whole[0].as_str(), "crate" | "super" | "self")
                && !self.by_module.contains_key(&[module, &whole[..1]].concat());
            if outside { None } else { self.defining_file(module, &whole, depth + 1) }
        };
        let named = file.imports.iter().find(|(name, ..)| name == first);
        if let Some((_, target, _)) = named {
            return follow_import(target, rest);
        }
        file.imports
            .iter()
            .filter(|(name, ..)| name == "*")
            .find_map(|(_, target, _)| follow_import(target, path))
    }
}

/// Returns the cycles of a graph, the largest first: files that depend on each other directly or indirectly.
pub fn dependency_cycles(graph: &[BTreeSet<usize>]) -> Vec<Vec<usize>> {
    let reached: Vec<BTreeSet<usize>> = (0..graph.len())
        .map(|k| {
            let (mut seen, mut todo) = (BTreeSet::new(), vec![k]);
            while let Some(at) = todo.pop() {
                todo.extend(graph[at].iter().copied().filter(|next| seen.insert(*next)));
            }
            seen
        })
        .collect();
    let mut all: Vec<Vec<usize>> = Vec::new();
    for k in 0..graph.len() {
        let circle: Vec<usize> =
            (0..graph.len()).filter(|j| reached[k].contains(j) && reached[*j].contains(&k)).collect();
        if circle.len() > 1 && circle[0] == k {
            all.push(circle);
        }
    }
    all.sort_by_key(|circle| std::cmp::Reverse(circle.len()));
    all
}

fn is_test_file(path: &Path) -> bool {
    path.components().any(|c| c.as_os_str() == "tests") || path.ends_with("tests.rs")
}

impl File {
    fn read_file_imports(source: &Path, path: PathBuf) -> File {
        let text = fs::read_to_string(&path).unwrap();
        let path = path.strip_prefix(source).unwrap().to_path_buf();
        let mut module: ModulePath = path
            .with_extension("")
            .components()
            .map(|c| c.as_os_str().to_string_lossy().into_owned())
            .collect();
        module.pop_if(|last| last == "mod" || last == "lib");
        let mut file = File::parse_source(&text);
        (file.path, file.module) = (path, module);
        file
    }

    /// Parses the text of a source file into its tokens, definitions and imports.
    fn parse_source(text: &str) -> File {
        let all = split_into_tokens(text.split("#[cfg(test)]\nmod tests {").next().unwrap());
        let mut file = File {
            path: PathBuf::new(),
            module: Vec::new(),
            tokens: Vec::new(),
            items: BTreeSet::new(),
            imports: Vec::new(),
        };
        let mut at = 0;
        while at < all.len() {
            match all[at].as_str() {
                "use" => {
                    let end = at + all[at..].iter().position(|t| t == ";").unwrap();
                    let passes_on = at > 0 && matches!(all[at - 1].as_str(), "pub" | ")");
                    let mut list = Vec::new();
                    collect_import_leaves(&all[at + 1..end], &mut 0, &[], &mut list);
                    file.imports.extend(list.into_iter().map(|(name, path)| (name, path, passes_on)));
                    at = end + 1;
                    continue;
                }
                "struct" | "enum" | "trait" | "type" | "const" | "static" | "fn" => {
                    if let Some(name) = all.get(at + 1) {
                        file.items.insert(name.clone());
                    }
                }
                _ => {}
            }
            file.tokens.push(all[at].clone());
            at += 1;
        }
        file
    }
}

/// Collects the leaves of an import: local name and path.
fn collect_import_leaves(
    tokens: &[String],
    at: &mut usize,
    before: &[String],
    list: &mut Vec<(String, Vec<String>)>,
) {
    let mut path = before.to_vec();
    while let Some(token) = tokens.get(*at) {
        *at += 1;
        match token.as_str() {
            "::" => {}
            "{" => {
                while tokens.get(*at).is_some_and(|t| t != "}") {
                    collect_import_leaves(tokens, at, &path, list);
                }
                *at += 1;
                while tokens.get(*at).is_some_and(|t| t == ",") {
                    *at += 1;
                }
                return;
            }
            "," => break,
            "}" => {
                *at -= 1;
                break;
            }
            "as" => {
                list.push((tokens[*at].clone(), path));
                *at += 1;
                while tokens.get(*at).is_some_and(|t| t == ",") {
                    *at += 1;
                }
                return;
            }
            "self" if !path.is_empty() => {}
            word => path.push(word.to_string()),
        }
    }
    if path.last().is_some_and(|last| last == "*") {
        path.pop();
        list.push(("*".to_string(), path));
    } else if let Some(last) = path.last() {
        list.push((last.clone(), path.clone()));
    }
}

/// Returns the Rust path that begins at a token.
fn path_from_token(tokens: &[String], mut at: usize) -> Vec<String> {
    let is_word_token =
        |t: Option<&String>| t.is_some_and(|t| t.starts_with(|c: char| c.is_alphabetic() || c == '_'));
    let mut path = Vec::new();
    while is_word_token(tokens.get(at)) {
        path.push(tokens[at].clone());
        if tokens.get(at + 1).is_none_or(|t| t != "::") || !is_word_token(tokens.get(at + 2)) {
            break;
        }
        at += 2;
    }
    path
}

/// Splits code into tokens; `::` is one token. Comments, strings and characters are omitted.
fn split_into_tokens(text: &str) -> Vec<String> {
    let c: Vec<char> = text.chars().collect();
    let (mut at, mut found) = (0, Vec::new());
    while at < c.len() {
        let next = c.get(at + 1).copied();
        match c[at] {
            '/' if next == Some('/') => at += c[at..].iter().take_while(|c| **c != '\n').count(),
            '"' => {
                at += 1;
                while at < c.len() && c[at] != '"' {
                    at += 1 + usize::from(c[at] == '\\');
                }
                at += 1;
            }
            '\'' if next == Some('\\') => at += 3 + c[at + 3..].iter().take_while(|c| **c != '\'').count(),
            '\'' if c.get(at + 2) == Some(&'\'') => at += 3,
            ':' if next == Some(':') => {
                found.push("::".to_string());
                at += 2;
            }
            first if first.is_alphanumeric() || first == '_' => {
                let word: String = c[at..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').collect();
                at += word.chars().count();
                found.push(word);
            }
            sign => {
                if !sign.is_whitespace() {
                    found.push(sign.to_string());
                }
                at += 1;
            }
        }
    }
    found
}

#[test]
fn use_items_of_files_are_parsed() {
    let file = File::parse_source(
        "use crate::a::{self, b::{C, d as e}}; pub use f::*; // use g;\nimpl<'a> X<'a> { fn y() { z::w(\"use \
         h;\", ':') } }",
    );
    let imports: Vec<String> =
        file.imports.iter().map(|(name, path, on)| format!("{name} {} {on}", path.join("::"))).collect();
    assert_eq!(imports, ["a crate::a false", "C crate::a::b::C false", "e crate::a::b::d false", "* f true"]);
    let at = file.tokens.iter().position(|t| t == "z").unwrap();
    assert_eq!(path_from_token(&file.tokens, at), ["z", "w"]);
}

#[test]
fn import_cycles_are_found() {
    let graph: Vec<BTreeSet<usize>> = [vec![1], vec![2], vec![0], vec![0, 4], vec![]]
        .into_iter()
        .map(|list: Vec<usize>| list.into_iter().collect())
        .collect();
    assert_eq!(dependency_cycles(&graph), [[0, 1, 2]]);
}

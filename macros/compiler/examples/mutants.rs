//! Adds all mutants of a copy of this crate to its source. An environment variable selects the active mutants
//! at run time, so one build serves all of them. `.ci/mutate` makes the copy, builds it and runs the tests
//! with one mutant after another.
//!
//! ```sh
//! cargo run -p linkwork-compiler --example mutants -- COPY-OF-THE-CRATE [NUMBER-OF-A-MUTANT-TO-LEAVE-OUT …]
//! ```
//!
//! Prints a line for each mutant: its number, the file and line of the original, the original and the mutated
//! expression. Expressions of constants, arguments of macros and comparisons with limits of `machine` are not
//! mutated. These limits affect only the cost of the generated code, which other tests check.
use proc_macro2::Span;
use quote::{ToTokens, quote};
use std::path::{Path, PathBuf};
use syn::visit_mut::{self, VisitMut};
use syn::{Arm, BinOp, Block, Expr, Lit, Pat, PatGuard, parse_quote, spanned::Spanned};

/// Folders and files that are mutated: the code that selects cases, offsets and sizes.
const ROOMS: [&str; 4] = ["src/catalogue", "src/derive", "src/derive.rs", "src/emit"];

/// Source of a module of the copy that reads the selected mutants. If an environment variable contains a file
/// name, the program also writes the numbers of the mutants that it reaches to this file.
const CHOICE: &str = r#"//! The mutants that are asked for.
use std::env::var;
use std::fs::File;
use std::io::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
static CHOSEN: OnceLock<Vec<usize>> = OnceLock::new();
static REACHED: OnceLock<Option<File>> = OnceLock::new();
static SEEN: [AtomicBool; 10_000] = [const { AtomicBool::new(false) }; 10_000];
/// Returns whether the environment selects this mutant.
pub fn is(mutant: usize) -> bool {
    if !SEEN[mutant].load(Ordering::Relaxed)
        && !SEEN[mutant].swap(true, Ordering::Relaxed)
        && let Some(file) = REACHED.get_or_init(|| var("LINKWORK_REACHED").ok().map(|path| File::create(path).unwrap()))
    {
        let _ = (&*file).write_all(format!("{mutant}\n").as_bytes());
    }
    let selected = || var("LINKWORK_MUTANTS").unwrap_or_default().split(',').flat_map(str::parse).collect();
    CHOSEN.get_or_init(selected).contains(&mutant)
}
"#;

/// Visitor that adds mutants to the expressions of a file.
struct Mutator<'a> {
    file: PathBuf,
    /// Names of the limits of `machine` that the mutated file imports.
    limits: Vec<String>,
    next: usize,
    left_out: &'a [usize],
}

impl Mutator<'_> {
    /// Returns an expression that selects `original` or `instead` by the mutant's number; `None` if this
    /// mutant is omitted.
    fn mutant_selection_expression(
        &mut self,
        at: Span,
        shown: &dyn ToTokens,
        original: &Expr,
        instead: &Expr,
    ) -> Option<Expr> {
        let number = self.next;
        self.next += 1;
        if self.left_out.contains(&number) {
            return None;
        }
        let (line, before, after) = (at.start().line, shortened_tokens(shown), shortened_tokens(instead));
        println!("{number}\t{}:{line}\t{before}\t{after}", self.file.display());
        Some(parse_quote!((if crate::mutant::is(#number) { #instead } else { #original })))
    }

    /// Returns whether an expression is a limit of `machine`.
    fn is_limit_of_machine(&self, expr: &Expr) -> bool {
        matches!(expr, Expr::Path(path) if self.limits.iter().any(|limit| path.path.is_ident(limit)))
    }

    /// Returns the mutant of an expression whose subexpressions are unchanged.
    fn mutant_of_expression(expr: &Expr) -> Option<Expr> {
        let mut instead = expr.clone();
        match &mut instead {
            Expr::Binary(binary) => {
                binary.op = match binary.op {
                    BinOp::Add(_) => parse_quote!(-),
                    BinOp::Sub(_) | BinOp::Mul(_) => parse_quote!(+),
                    BinOp::Eq(_) => parse_quote!(!=),
                    BinOp::Ne(_) => parse_quote!(==),
                    BinOp::Lt(_) => parse_quote!(<=),
                    BinOp::Le(_) => parse_quote!(<),
                    BinOp::Gt(_) => parse_quote!(>=),
                    BinOp::Ge(_) => parse_quote!(>),
                    BinOp::And(_) if !contains_let(expr) => parse_quote!(||),
                    BinOp::Or(_) => parse_quote!(&&),
                    _ => return None,
                }
            }
            Expr::Lit(literal) => {
                let Lit::Int(number) = &literal.lit else { return None };
                let next = number.base10_parse::<u64>().ok()? + 1;
                literal.lit =
                    Lit::Int(syn::LitInt::new(&format!("{next}{}", number.suffix()), number.span()));
            }
            Expr::MethodCall(call) if call.method == "skip" && call.args.len() == 1 => {
                return Some((*call.receiver).clone());
            }
            Expr::MethodCall(call) => {
                call.method = syn::Ident::new(confusable_name(&call.method.to_string())?, call.method.span())
            }
            Expr::Field(field) => {
                let syn::Member::Named(name) = &mut field.member else { return None };
                *name = syn::Ident::new(confusable_name(&name.to_string())?, name.span());
            }
            Expr::Path(path) => {
                let name = path.path.get_ident()?;
                path.path = syn::Ident::new(confusable_name(&name.to_string())?, name.span()).into();
            }
            _ => return None,
        }
        Some(instead)
    }
}

/// Returns the names that a file imports from `machine`.
fn names_imported_from_machine(file: &syn::File) -> Vec<String> {
    let machine_names_of_use_item = |item: &syn::Item| match item {
        syn::Item::Use(item) => {
            let text = item.tree.to_token_stream().to_string();
            text.strip_prefix("crate :: machine ::").map(|names| {
                names.split(|c: char| !(c.is_ascii_uppercase() || c == '_')).map(str::to_string).collect()
            })
        }
        _ => None,
    };
    let names: Vec<Vec<String>> = file.items.iter().filter_map(machine_names_of_use_item).collect();
    names.concat().into_iter().filter(|name| !name.is_empty()).collect()
}

/// Returns a function name that could be confused with this one.
fn confusable_name(name: &str) -> Option<&'static str> {
    Some(match name {
        "nq" => "nv",
        "nv" => "nq",
        "any" => "all",
        "all" => "any",
        "rows" => "columns",
        "columns" => "rows",
        "first" => "last",
        "last" => "first",
        "min" => "max",
        "max" => "min",
        _ => return None,
    })
}

fn contains_let(expr: &Expr) -> bool {
    match expr {
        Expr::Let(_) => true,
        Expr::Binary(binary) => contains_let(&binary.left) || contains_let(&binary.right),
        Expr::Paren(inner) => contains_let(&inner.expr),
        _ => false,
    }
}

/// Returns the source text of tokens on one line, cut after 100 characters.
fn shortened_tokens(tokens: &dyn ToTokens) -> String {
    let text = tokens.to_token_stream().to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    text.chars().take(100).collect()
}

impl VisitMut for Mutator<'_> {
    fn visit_expr_mut(&mut self, expr: &mut Expr) {
        if let Expr::Binary(binary) = expr
            && [&binary.left, &binary.right].iter().any(|side| self.is_limit_of_machine(side))
        {
            return;
        }
        let (original, instead) = (expr.clone(), Self::mutant_of_expression(expr));
        match expr {
            // Assigned places, called functions and conditions with `let` remain unchanged.
            Expr::Call(call) => call.args.iter_mut().for_each(|argument| self.visit_expr_mut(argument)),
            Expr::Assign(assign) => self.visit_expr_mut(&mut assign.right),
            Expr::Reference(reference) if reference.mutability.is_some() => return,
            _ => visit_mut::visit_expr_mut(self, expr),
        }
        if let Some(instead) = instead
            && let Some(both) = self.mutant_selection_expression(original.span(), &original, expr, &instead)
        {
            *expr = both;
        }
    }

    /// Adds mutants of match arms that have the body of the next arm.
    fn visit_expr_match_mut(&mut self, matched: &mut syn::ExprMatch) {
        self.visit_expr_mut(&mut matched.expr);
        let bodies: Vec<Expr> = matched.arms.iter().map(|arm| (*arm.body).clone()).collect();
        for (k, arm) in matched.arms.iter_mut().enumerate() {
            let Arm { body, pat, .. } = arm;
            if let Pat::Guard(PatGuard { guard, .. }) = pat {
                self.visit_expr_mut(guard);
            }
            self.visit_expr_mut(body);
            let next =
                bodies.get(k + 1).filter(|next| shortened_tokens(*next) != shortened_tokens(&bodies[k]));
            if let Some(next) = next
                && let Some(both) = self.mutant_selection_expression(pat.span(), &quote!(#pat =>), body, next)
            {
                **body = both;
            }
        }
    }

    fn visit_item_mut(&mut self, item: &mut syn::Item) {
        let attributes = match item {
            syn::Item::Const(_) | syn::Item::Static(_) | syn::Item::Macro(_) => return,
            syn::Item::Fn(function) if function.sig.constness.is_some() => return,
            syn::Item::Mod(module) => &module.attrs,
            syn::Item::Fn(function) => &function.attrs,
            _ => return visit_mut::visit_item_mut(self, item),
        };
        if !attributes.iter().any(|attribute| attribute.path().is_ident("cfg")) {
            visit_mut::visit_item_mut(self, item);
        }
    }

    fn visit_impl_item_mut(&mut self, item: &mut syn::ImplItem) {
        match item {
            syn::ImplItem::Const(_) => {}
            syn::ImplItem::Fn(function) if function.sig.constness.is_some() => {}
            _ => visit_mut::visit_impl_item_mut(self, item),
        }
    }

    fn visit_block_mut(&mut self, block: &mut Block) {
        block.stmts.retain(|statement| !matches!(statement, syn::Stmt::Macro(call) if call.mac.path.is_ident("debug_assert")));
        visit_mut::visit_block_mut(self, block);
    }

    /// Expands a shorthand field, whose value could not be mutated otherwise.
    fn visit_field_value_mut(&mut self, field: &mut syn::FieldValue) {
        field.colon_token.get_or_insert_default();
        visit_mut::visit_field_value_mut(self, field);
    }

    fn visit_type_mut(&mut self, _: &mut syn::Type) {}
    fn visit_pat_mut(&mut self, _: &mut syn::Pat) {}
    fn visit_path_mut(&mut self, _: &mut syn::Path) {}
    fn visit_attribute_mut(&mut self, _: &mut syn::Attribute) {}
    /// Skips array lengths, which must remain constant expressions.
    fn visit_expr_repeat_mut(&mut self, repeat: &mut syn::ExprRepeat) {
        self.visit_expr_mut(&mut repeat.expr);
    }
}

/// Adds all Rust files at a path to `found`, in sorted order.
fn collect_rust_files(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_file() {
        found.push(path.to_path_buf());
        return;
    }
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(path).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    entries
        .iter()
        .filter(|entry| entry.is_dir() || entry.extension().is_some_and(|end| end == "rs"))
        .for_each(|entry| collect_rust_files(entry, found));
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let copy = PathBuf::from(arguments.next().expect("the copy to write into"));
    let left_out: Vec<usize> = arguments.map(|number| number.parse().expect("a number")).collect();
    let mut files = Vec::new();
    ROOMS.iter().for_each(|room| collect_rust_files(&copy.join(room), &mut files));
    let mut next = 0;
    for path in files {
        let text = std::fs::read_to_string(&path).expect("a file of Rust");
        let mut parsed = syn::parse_file(&text).expect("Rust");
        let file = path.strip_prefix(&copy).expect("a file of the copy").to_path_buf();
        let limits = names_imported_from_machine(&parsed);
        let mut mutator = Mutator { file, limits, next, left_out: &left_out };
        mutator.visit_file_mut(&mut parsed);
        next = mutator.next;
        std::fs::write(&path, prettyplease::unparse(&parsed)).expect("written");
    }
    std::fs::write(copy.join("src/mutant.rs"), CHOICE).expect("written");
    let library = copy.join("src/lib.rs");
    let text = std::fs::read_to_string(&library).expect("the library");
    let module = "\nmod mutant;\n";
    if !text.contains(module) {
        std::fs::write(&library, text + module).expect("written");
    }
}

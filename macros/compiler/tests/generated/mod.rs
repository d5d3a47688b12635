//! Parsing of the Rust code that the compiler generates, for tests.

use syn::{Expr, Item, Stmt};

/// Returns the items of generated code. A block `const _: () = { … };` is replaced by the items in it.
pub fn items_of_generated_code(file: syn::File) -> Vec<Item> {
    let items_of_anonymous_const = |item: Item| match item {
        Item::Const(block) if block.ident == "_" => match *block.expr {
            Expr::Block(block) => {
                let items = block.block.stmts.into_iter().filter_map(|statement| match statement {
                    Stmt::Item(item) => Some(item),
                    _ => None,
                });
                items.collect()
            }
            _ => Vec::new(),
        },
        item => vec![item],
    };
    file.items.into_iter().flat_map(items_of_anonymous_const).collect()
}

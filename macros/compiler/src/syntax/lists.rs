//! Lists of elements: `leg: [Body; 2]` is expanded into two fields, `leg_0` and `leg_1`. In the attributes of
//! a list, `i` is the index of the element. Everywhere, `leg[1]` and `leg[i + 1]` denote one element. Later
//! stages see plain fields only.

use super::element::{ATTRIBUTES, is_attribute_among};
use crate::diag::Diagnostics;
use proc_macro2::{Delimiter, Group, Ident, Literal, Span, TokenStream, TokenTree};
use quote::ToTokens;
use syn::ext::IdentExt;
use syn::{BinOp, Expr, ExprLit, Field, Fields, Lit, Meta, Type, UnOp};

/// Name of the index of a list's element in its attributes.
const INDEX: &str = "i";
/// Maximum number of elements of all lists of a struct together.
const MAX_LIST_ELEMENTS: usize = 4096;
/// Maximum number of tokens of a struct after expansion of its lists.
const MAX_EXPANDED_TOKENS: usize = 1_000_000;
/// Maximum number of tokens in brackets after the name of a list.
const MAX_INDEX_TOKENS: usize = 64;

/// Lists of elements in a struct, with their lengths.
pub struct ElementListLengths {
    lists: Vec<(String, usize)>,
    tokens: usize,
}

impl ElementListLengths {
    /// Expands the lists among the struct's fields, and returns their names and lengths.
    pub fn expand_lists(fields: &mut Fields, cx: &mut Diagnostics) -> ElementListLengths {
        let mut lists = ElementListLengths { lists: Vec::new(), tokens: 0 };
        let Fields::Named(named_fields) = fields else { return lists };
        let counts: Vec<Option<usize>> =
            named_fields.named.iter().map(|field| lists.read_list_length(field, cx)).collect();
        if lists.lists.is_empty() {
            return lists;
        }
        cx.set_element_list_names(lists.lists.iter().map(|(name, _)| name.clone()).collect());
        lists.report_field_named_index(named_fields.named.iter(), cx);
        let fields_before = std::mem::take(&mut named_fields.named);
        for (mut field, count) in fields_before.into_iter().zip(counts) {
            let Some(count) = count else {
                lists.rewrite_list_indices_in_attributes(&mut field, None, cx);
                named_fields.named.push(field);
                continue;
            };
            for k in 0..count {
                named_fields.named.push(lists.list_element_field(&field, k, cx));
            }
        }
        lists
    }

    /// Returns the number of elements of a field that is a list; 0 for an invalid list.
    fn read_list_length(&mut self, field: &Field, cx: &mut Diagnostics) -> Option<usize> {
        let (Type::Array(array), Some(ident)) = (&field.ty, &field.ident) else { return None };
        if matches!(&*array.elem, Type::Path(path) if path.path.is_ident("f64") || path.path.is_ident("f32"))
        {
            return None;
        }
        let left = MAX_LIST_ELEMENTS - self.lists.iter().map(|(_, count)| count).sum::<usize>();
        let count = match &array.len {
            Expr::Lit(ExprLit { lit: Lit::Int(n), .. }) => n.base10_parse::<usize>().unwrap_or(usize::MAX),
            other => {
                cx.report_error(span_of_first_token(other), "the length of a list must be a number").add_help(
                    "write `[Body; 2]`: the value of a Rust constant is not known yet when mechanisms are \
                     compiled",
                );
                0
            }
        };
        let found = cx.len();
        if count > left {
            cx.report_error(
                span_of_first_token(&array.len),
                format!("the lists of a mechanism have at most {MAX_LIST_ELEMENTS} elements"),
            );
        } else if count == 0 && matches!(&array.len, Expr::Lit(_)) {
            cx.report_error(span_of_first_token(&array.len), "a list has at least one element")
                .add_help("write its length, as in `[Body; 2]`");
        }
        let count = if cx.len() > found { 0 } else { count };
        self.lists.push((ident.unraw().to_string(), count));
        Some(count)
    }

    /// Reports a field that has the name of the list index.
    fn report_field_named_index<'a>(
        &self,
        mut fields: impl Iterator<Item = &'a Field>,
        cx: &mut Diagnostics,
    ) {
        let other = fields.find(|field| field.ident.as_ref().is_some_and(|ident| ident == INDEX));
        if let Some(ident) = other.and_then(|field| field.ident.as_ref()) {
            cx.report_error(ident.span(), format!("`{INDEX}` counts the elements of lists"))
                .add_help("give the field another name");
        }
    }

    /// Returns one element of a list as a separate field.
    fn list_element_field(&mut self, list: &Field, k: usize, cx: &mut Diagnostics) -> Field {
        let mut field = list.clone();
        if let Type::Array(array) = &list.ty {
            field.ty = (*array.elem).clone();
        }
        field.ident =
            list.ident.as_ref().map(|ident| element_name(&ident.unraw().to_string(), k, ident.span()));
        self.rewrite_list_indices_in_attributes(&mut field, Some(k), cx);
        field
    }

    fn rewrite_list_indices_in_attributes(
        &mut self,
        field: &mut Field,
        index: Option<usize>,
        cx: &mut Diagnostics,
    ) {
        for attribute in field.attrs.iter_mut().filter(|attribute| is_attribute_among(attribute, &ATTRIBUTES))
        {
            if let Meta::List(list) = &mut attribute.meta {
                list.tokens = self.rewrite_list_index(std::mem::take(&mut list.tokens), index, cx);
            }
        }
    }

    /// Replaces `leg[1]` by the name of the element, and the index by its value.
    pub fn rewrite_list_index(
        &mut self,
        tokens: TokenStream,
        index: Option<usize>,
        cx: &mut Diagnostics,
    ) -> TokenStream {
        if self.lists.is_empty() {
            return tokens;
        }
        let mut tokens = tokens.into_iter().peekable();
        let mut written = Vec::new();
        let mut member = false;
        while let Some(token) = tokens.next() {
            self.tokens += 1;
            if self.tokens > MAX_EXPANDED_TOKENS {
                if self.tokens == MAX_EXPANDED_TOKENS + 1 {
                    cx.report_error(
                        token.span(),
                        format!("lists expand to at most {MAX_EXPANDED_TOKENS} tokens"),
                    );
                }
                break;
            }
            let after_dot = std::mem::replace(&mut member, is_punctuation(&token, '.'));
            match token {
                TokenTree::Ident(word) if !after_dot => {
                    let index_of = match tokens.peek() {
                        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Bracket => {
                            Some(group.clone())
                        }
                        _ => None,
                    };
                    let ends = tokens.peek().is_none_or(|next| !is_punctuation(next, '='));
                    let (token, used) =
                        self.replacement_of_list_word(&word, index_of.as_ref(), ends, index, cx);
                    written.push(token);
                    if used {
                        tokens.next();
                    }
                }
                TokenTree::Group(group) => {
                    let inner = self.rewrite_list_index(group.stream(), index, cx);
                    let mut rewritten = Group::new(group.delimiter(), inner);
                    rewritten.set_span(group.span());
                    written.push(rewritten.into());
                }
                token => written.push(token),
            }
        }
        written.into_iter().collect()
    }

    /// Returns the replacement of a word, and whether the brackets after it were consumed.
    fn replacement_of_list_word(
        &self,
        word: &Ident,
        brackets: Option<&Group>,
        ends: bool,
        index: Option<usize>,
        cx: &mut Diagnostics,
    ) -> (TokenTree, bool) {
        let text = word.unraw().to_string();
        if text == INDEX
            && let Some(k) = index
        {
            let mut number = Literal::usize_unsuffixed(k);
            number.set_span(word.span());
            return (number.into(), false);
        }
        let Some((_, count)) = self.lists.iter().find(|(name, _)| *name == text) else {
            return (word.clone().into(), false);
        };
        let Some(group) = brackets else {
            // An invalid list, or the name of an argument.
            if *count > 0 && ends {
                let error = cx.report_error(word.span(), format!("`{text}` is a list of {count}"));
                match index {
                    Some(_) => error.add_help(format!("write `{text}[{INDEX}]`, or `{text}[0]`")),
                    None => error.add_help(format!("write which one, as in `{text}[0]`")),
                };
            }
            return (word.clone().into(), false);
        };
        let k = self.evaluate_list_index(&text, *count, group, index, cx).unwrap_or(0);
        (element_name(&text, k, word.span()).into(), true)
    }

    /// Returns the value of the index in brackets after the name of a list.
    fn evaluate_list_index(
        &self,
        list: &str,
        count: usize,
        group: &Group,
        index: Option<usize>,
        cx: &mut Diagnostics,
    ) -> Option<usize> {
        let short = group.stream().into_iter().count() <= MAX_INDEX_TOKENS;
        let written: Option<Expr> = short.then(|| syn::parse2(group.stream()).ok()).flatten();
        let value = written.as_ref().and_then(|e| integer_value(e, index));
        let Some(value) = value else {
            let error = cx.report_error(group.span(), format!("expected an index into `{list}`"));
            match index {
                Some(_) => error.add_help(format!(
                    "write an integer, or an expression of `{INDEX}`, as in `{list}[{INDEX} + 1]`"
                )),
                None => error.add_help(format!(
                    "write an integer, as in `{list}[0]`; `{INDEX}` is available only in the attributes of \
                     lists"
                )),
            };
            return None;
        };
        let place = usize::try_from(value).ok().filter(|k| *k < count);
        if place.is_none() && count > 0 {
            let error = cx.report_error(
                group.span(),
                format!("`{list}[{value}]` does not exist: `{list}` is a list of {count}"),
            );
            error.add_help(format!("its elements are `{list}[0]` to `{list}[{}]`", count - 1));
            if let Some(k) = index {
                error.add_note(format!("`{INDEX}` is {k} here"));
            }
        }
        place
    }
}

/// Returns the name of a list element, such as `leg_1` of the list `leg`.
fn element_name(list: &str, k: usize, span: Span) -> Ident {
    Ident::new(&format!("{list}_{k}"), span)
}

fn is_punctuation(token: &TokenTree, sign: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == sign)
}

/// Returns the span of the first token of a Rust expression.
fn span_of_first_token(e: &Expr) -> Span {
    e.to_token_stream().into_iter().next().map_or_else(Span::call_site, |token| token.span())
}

/// Returns the value of an integer expression; `None` for overflow and division by zero.
fn integer_value(e: &Expr, index: Option<usize>) -> Option<i64> {
    match e {
        Expr::Lit(ExprLit { lit: Lit::Int(n), .. }) => n.base10_parse().ok(),
        Expr::Path(path) if path.path.is_ident(INDEX) => index.and_then(|k| i64::try_from(k).ok()),
        Expr::Paren(inner) => integer_value(&inner.expr, index),
        Expr::Group(inner) => integer_value(&inner.expr, index),
        Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => {
            integer_value(&unary.expr, index)?.checked_neg()
        }
        Expr::Binary(both) => {
            let (a, b) = (integer_value(&both.left, index)?, integer_value(&both.right, index)?);
            match both.op {
                BinOp::Add(_) => a.checked_add(b),
                BinOp::Sub(_) => a.checked_sub(b),
                BinOp::Mul(_) => a.checked_mul(b),
                BinOp::Div(_) => a.checked_div(b),
                BinOp::Rem(_) => a.checked_rem(b),
                _ => None,
            }
        }
        _ => None,
    }
}

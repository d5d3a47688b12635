//! The arguments of an attribute: parsed whatever they are, then taken one by one by what expects them.

use super::expression::{parse_expr, parse_name};
use super::{Expr, ExprKind, Name};
use crate::diag::{Diagnostics, Place};
use proc_macro2::{Span, TokenStream};
use syn::parse::{ParseStream, Parser};
use syn::{Attribute, Ident, LitStr, Meta, Token, bracketed, token};

/// The arguments of an attribute: at most one relation `a -> b`, at most one equation between two expressions, and
/// `key = value` in any order.
pub struct Arguments {
    relation: Option<(Expr, Expr)>,
    equation: Option<(Expr, Expr)>,
    plain: Vec<Expr>,
    named: Vec<(Name, Value)>,
    seen: Vec<Name>,
    place: Place,
}

enum Value {
    Expr(Expr),
    Text(LitStr),
    Texts(Vec<LitStr>),
}

impl Arguments {
    /// The arguments of `#[word(…)]`.
    pub fn of(attribute: &Attribute, cx: &mut Diagnostics) -> Option<Arguments> {
        let span = attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        match &attribute.meta {
            Meta::List(list) => Arguments::parse(list.tokens.clone(), span, cx),
            Meta::Path(_) => Arguments::parse(TokenStream::new(), span, cx),
            Meta::NameValue(_) => {
                cx.error(span, "expected arguments in parentheses");
                None
            }
        }
    }

    /// Parses the tokens between the parentheses.
    pub fn parse(tokens: TokenStream, span: Span, cx: &mut Diagnostics) -> Option<Arguments> {
        let parsed = (|input: ParseStream<'_>| parse_arguments(input, span)).parse2(tokens);
        let mut arguments = match parsed {
            Ok(arguments) => arguments,
            // The end of the input has no place of its own.
            Err(error) if error.to_string().starts_with("unexpected end") => {
                cx.error(span, "unexpected end of the arguments");
                return None;
            }
            Err(error) => {
                cx.syn(error);
                return None;
            }
        };
        let mut first: Vec<(Name, Value)> = Vec::new();
        for (key, value) in std::mem::take(&mut arguments.named) {
            if first.iter().any(|(other, _)| other.text == key.text) {
                cx.error(key.place, format!("`{}` is given twice", key.text));
            } else {
                first.push((key, value));
            }
        }
        arguments.named = first;
        Some(arguments)
    }

    fn take(&mut self, key: &str) -> Option<(Name, Value)> {
        let at = self.named.iter().position(|(name, _)| name.text == key)?;
        let (name, value) = self.named.remove(at);
        self.seen.push(name.clone());
        Some((name, value))
    }

    /// Where a key that was not yet taken stands.
    pub fn place_of(&self, key: &str) -> Option<Place> {
        self.named.iter().find(|(name, _)| name.text == key).map(|(name, _)| name.place.clone())
    }

    /// Drops a key.
    pub fn forget(&mut self, key: &str) {
        self.named.retain(|(name, _)| name.text != key);
    }

    /// Drops all keys.
    pub fn forget_all(&mut self) {
        self.named.clear();
    }

    /// Where a key that was taken stood.
    pub fn seen(&self, key: &str) -> Option<Place> {
        self.seen.iter().find(|name| name.text == key).map(|name| name.place.clone())
    }

    /// The expressions without a key.
    pub fn take_plain(&mut self) -> Vec<Expr> {
        std::mem::take(&mut self.plain)
    }

    /// Where a word stands alone, without a value.
    pub fn word_given(&mut self, word: &str) -> Option<Place> {
        let is_word = |e: &Expr| matches!(&e.kind, ExprKind::Name(name) if name == word);
        let at = self.plain.iter().position(is_word)?;
        Some(self.plain.remove(at).place)
    }

    /// The expression of a key, if given.
    pub fn take_expr(&mut self, key: &str, cx: &mut Diagnostics) -> Option<Expr> {
        match self.take(key)? {
            (_, Value::Expr(e)) => Some(e),
            (_, Value::Text(text)) => {
                cx.error(text.span(), format!("expected an expression for `{key}`, found a text"))
                    .help("write it without quotes");
                None
            }
            (name, Value::Texts(_)) => {
                cx.error(name.place, format!("expected an expression for `{key}`, found texts"))
                    .help("write it without quotes");
                None
            }
        }
    }

    /// The expression of a key that must be there; `example` is what may stand for it.
    pub fn need_expr(
        &mut self,
        key: &str,
        example: &str,
        attribute: &str,
        known: &[&str],
        cx: &mut Diagnostics,
    ) -> Option<Expr> {
        // A key that is not known is reported as such: most likely it is the missing one.
        if self.place_of(key).is_none()
            && self.named.iter().all(|(name, _)| known.contains(&name.text.as_str()))
        {
            cx.error(self.place.clone(), format!("missing `{key}`"))
                .help(format!("write `#[{attribute}(…, {key} = {example})]`").replace("(…, on", "(on"));
        }
        self.take_expr(key, cx)
    }

    /// The expressions of a key: one, or several in parentheses.
    pub fn take_list(&mut self, key: &str, cx: &mut Diagnostics) -> Vec<Expr> {
        match self.take_expr(key, cx) {
            Some(Expr { kind: ExprKind::Tuple(items), .. }) => items,
            Some(e) => vec![e],
            None => Vec::new(),
        }
    }

    /// The word of a key, one of a few.
    pub fn take_word(&mut self, key: &str, words: &[&str], cx: &mut Diagnostics) -> Option<(String, Place)> {
        let (name, value) = self.take(key)?;
        match value {
            Value::Expr(Expr { kind: ExprKind::Name(word), place }) if words.contains(&word.as_str()) => {
                Some((word, place))
            }
            Value::Expr(Expr { kind: ExprKind::Name(word), place }) => {
                cx.error(place, format!("unknown choice `{word}` for `{key}`"))
                    .suggest(&word, words.iter().copied());
                None
            }
            _ => {
                cx.error(name.place, format!("expected a word for `{key}`"))
                    .suggest("", words.iter().copied());
                None
            }
        }
    }

    /// The string of a key.
    pub fn take_text(&mut self, key: &str, cx: &mut Diagnostics) -> Option<Name> {
        match self.take(key)? {
            (_, Value::Text(text)) => Some(Name { text: text.value(), place: text.span().into() }),
            (name, _) => {
                cx.error(name.place, format!("expected a string for `{key}`"))
                    .help(format!("write `{key} = \"…\"`"));
                None
            }
        }
    }

    /// The strings of a key, in brackets.
    pub fn take_texts(&mut self, key: &str, cx: &mut Diagnostics) -> Vec<Name> {
        let named = |text: &LitStr| Name { text: text.value(), place: text.span().into() };
        match self.take(key) {
            None => Vec::new(),
            Some((_, Value::Texts(texts))) => texts.iter().map(named).collect(),
            Some((_, Value::Expr(Expr { kind: ExprKind::Array(items), .. }))) if items.is_empty() => {
                Vec::new()
            }
            Some((name, _)) => {
                cx.error(name.place, format!("expected a list of strings for `{key}`"))
                    .help(format!("write `{key} = [\"…\", \"…\"]`"));
                Vec::new()
            }
        }
    }

    /// The relation `parent -> child`.
    pub fn take_relation(&mut self, cx: &mut Diagnostics) -> Option<(Expr, Expr)> {
        if self.relation.is_none() {
            let place = self.plain.first().map_or(&self.place, |e| &e.place).clone();
            self.plain.clear();
            cx.error(place, "a joint says which bodies it joins")
                .help("write `#[joint(parent -> child, …)]`, with `ground` for what does not move");
        }
        self.relation.take()
    }

    /// The one equation `a = b`, whose left side may be a single name; `b` is absent if an expression stands alone.
    pub fn take_equation(&mut self) -> Option<(Expr, Option<Expr>)> {
        if let Some((left, right)) = self.equation.take() {
            return Some((left, Some(right)));
        }
        let is_expr = |(_, value): &(Name, Value)| matches!(value, Value::Expr(_));
        if let Some(at) = self.named.iter().position(is_expr)
            && self.plain.is_empty()
            && let (name, Value::Expr(right)) = self.named.remove(at)
        {
            return Some((Expr { kind: ExprKind::Name(name.text), place: name.place }, Some(right)));
        }
        let first = (!self.plain.is_empty()).then(|| self.plain.remove(0));
        first.map(|e| (e, None))
    }

    /// Reports what was not taken; `whose` is the element with its article.
    pub fn finish(&mut self, whose: &str, known: &[&str], cx: &mut Diagnostics) {
        for (name, _) in self.named.drain(..) {
            let error = cx.error(name.place, format!("{whose} has no argument `{}`", name.text));
            match elsewhere(whose, &name.text) {
                Some(help) => error.help(help),
                None => error.suggest(&name.text, known.iter().copied()),
            };
        }
        for e in self.plain.drain(..) {
            cx.error(e.place, "expected `name = value`").suggest("", known.iter().copied());
        }
        if let Some((left, right)) = self.equation.take() {
            cx.error(left.place.to(&right.place), "expected `name = value`")
                .suggest("", known.iter().copied());
        }
        if let Some((parent, child)) = self.relation.take() {
            cx.error(parent.place.to(&child.place), format!("{whose} joins nothing"))
                .help("`parent -> child` stands in a joint");
        }
    }
}

/// What to do where an argument is not known that says something all the same.
fn elsewhere(whose: &str, name: &str) -> Option<&'static str> {
    match (whose, name) {
        (_, "rotation" | "axes") => Some(
            "rotate an end of the joint or an inertia: `body.rotated(z(angle))`, `rod(m, l, x).rotated(z(angle))`",
        ),
        ("a Rolling constraint", "friction" | "speed") => {
            Some("surfaces with friction slip: declare a `Slipping` with `slips(…)` in place of `rolls(…)`")
        }
        _ => None,
    }
}

fn parse_arguments(input: ParseStream<'_>, span: Span) -> syn::Result<Arguments> {
    let mut arguments = Arguments {
        relation: None,
        equation: None,
        plain: Vec::new(),
        named: Vec::new(),
        seen: Vec::new(),
        place: span.into(),
    };
    while !input.is_empty() {
        parse_argument(input, &mut arguments)?;
        if !input.is_empty() {
            if !input.peek(Token![,]) {
                return Err(super::expression::unexpected(input));
            }
            input.parse::<Token![,]>()?;
        }
    }
    Ok(arguments)
}

fn parse_argument(input: ParseStream<'_>, arguments: &mut Arguments) -> syn::Result<()> {
    use syn::ext::IdentExt;
    if input.peek(Ident::peek_any)
        && input.peek2(Token![=])
        && !input.peek2(Token![==])
        && !input.peek2(Token![=>])
    {
        let key = parse_name(input)?;
        input.parse::<Token![=]>()?;
        if input.is_empty() || input.peek(Token![,]) {
            return Err(syn::Error::new(key.place.span, format!("`{}` has no value", key.text)));
        }
        let value = parse_value(input)?;
        arguments.named.push((key, value));
        return Ok(());
    }
    let first = parse_expr(input)?;
    if input.peek(Token![->]) {
        let arrow: Token![->] = input.parse()?;
        if input.is_empty() || input.peek(Token![,]) {
            return Err(syn::Error::new(arrow.spans[1], "nothing stands behind this arrow"));
        }
        let second = parse_expr(input)?;
        if arguments.relation.is_some() {
            return Err(syn::Error::new(arrow.spans[0], "a second `parent -> child`"));
        }
        arguments.relation = Some((first, second));
    } else if (input.peek(Token![=]) && !input.peek(Token![=>])) || input.peek(Token![==]) {
        let sign = input.span();
        let _ = input.parse::<Token![==]>().map(drop).or_else(|_| input.parse::<Token![=]>().map(drop));
        if input.is_empty() || input.peek(Token![,]) {
            return Err(syn::Error::new(sign, "nothing stands behind this sign"));
        }
        let second = parse_expr(input)?;
        if arguments.equation.is_some() {
            return Err(syn::Error::new(sign, "a second equation"));
        }
        arguments.equation = Some((first, second));
    } else {
        arguments.plain.push(first);
    }
    Ok(())
}

fn parse_value(input: ParseStream<'_>) -> syn::Result<Value> {
    if input.peek(LitStr) {
        return input.parse().map(Value::Text);
    }
    if input.peek(token::Bracket) {
        let ahead = input.fork();
        let content;
        bracketed!(content in ahead);
        if content.peek(LitStr) {
            let content;
            bracketed!(content in input);
            let texts = content.parse_terminated(<LitStr as syn::parse::Parse>::parse, Token![,])?;
            return Ok(Value::Texts(texts.into_iter().collect()));
        }
    }
    parse_expr(input).map(Value::Expr)
}

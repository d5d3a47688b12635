//! The arguments of an attribute: parsed whatever they are, then taken one by one by what expects them.

use super::expression::{parse_expr, parse_name};
use super::figures::{self, FileFigures};
use super::{BinaryOp, Expr, ExprKind, Name, words};
use crate::diag::{Diagnostics, Place, nearest, syn_error};

use proc_macro2::{Span, TokenStream};
use syn::parse::{ParseStream, Parser};
use syn::{Attribute, Ident, LitStr, Meta, Token, bracketed, token};

mod slips;

use slips::{names_without_brackets_or_quotes, no_arrow, no_comma, text_alone, unnamed};

/// The arguments of an attribute: at most one relation `a -> b`, at most one equation between two expressions (of an
/// equilibrium any number), and `key = value` in any order.
pub struct Arguments {
    relation: Option<(Expr, Expr)>,
    equations: Vec<(Expr, Expr)>,
    plain: Vec<Expr>,
    named: Vec<(Name, Value)>,
    seen: Vec<Name>,
    place: Place,
    /// The element that they belong to.
    owner: String,
    /// What its word asks for.
    form: Form,
}

/// What the arguments of an attribute may be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// Two bodies are joined by an arrow.
    Joint,
    /// Any number of places have values.
    Equilibrium,
    /// Nothing of this.
    Other,
}

/// Names for the two ends of a thing in other tools.
const ENDS: [(&str, &str); 14] = [
    ("parent", "child"),
    ("from", "to"),
    ("base", "follower"),
    ("predecessor", "successor"),
    ("inboard", "outboard"),
    ("frame_a", "frame_b"),
    ("body_a", "body_b"),
    ("body1", "body2"),
    ("link1", "link2"),
    ("point1", "point2"),
    ("first", "second"),
    ("start", "end"),
    ("a", "b"),
    ("parent_link", "child_link"),
];

enum Value {
    Figures(Vec<FileFigures>),
    Expr(Expr),
    Text(LitStr),
    Texts(Vec<LitStr>),
}

impl Arguments {
    /// The arguments of `#[word(…)]`.
    pub fn of(attribute: &Attribute, cx: &mut Diagnostics) -> Option<Arguments> {
        let span = attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        let is = |word: &str| attribute.path().is_ident(word);
        let form = match (is("joint"), is("equilibrium")) {
            (true, _) => Form::Joint,
            (_, true) => Form::Equilibrium,
            _ => Form::Other,
        };
        match &attribute.meta {
            Meta::List(list) => Arguments::parse_with(list.tokens.clone(), span, form, cx),
            Meta::Path(_) => Arguments::parse_with(TokenStream::new(), span, form, cx),
            Meta::NameValue(_) => {
                let word = attribute.path().get_ident().map_or_else(String::new, Ident::to_string);
                cx.error(span, "expected arguments in parentheses").help(format!("write `#[{word}(…)]`"));
                None
            }
        }
    }

    /// Parses the tokens between the parentheses.
    pub fn parse(tokens: TokenStream, span: Span, cx: &mut Diagnostics) -> Option<Arguments> {
        Arguments::parse_with(tokens, span, Form::Other, cx)
    }

    fn parse_with(tokens: TokenStream, span: Span, form: Form, cx: &mut Diagnostics) -> Option<Arguments> {
        let parsed = (|input: ParseStream<'_>| parse_arguments(input, span, form)).parse2(tokens);
        let mut arguments = match parsed {
            Ok(arguments) => arguments,
            // The end of the input has no place of its own.
            Err(error) if error.to_string().starts_with("unexpected end") => {
                cx.error(span, "unexpected end of the arguments")
                    .help("something is missing behind the last word");
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
                cx.error(key.place, format!("`{}` is given twice", key.text)).help("remove one of the two");
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

    /// The expressions without a key, which stay.
    pub fn plain(&self) -> &[Expr] {
        &self.plain
    }

    /// True if nothing is left.
    pub fn is_empty(&self) -> bool {
        self.named.is_empty() && self.plain.is_empty() && self.equations.is_empty() && self.relation.is_none()
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

    /// Reports a value or parentheses behind a word that stands alone; the word counts as given. True if there are any.
    pub fn check_word(&mut self, word: &str, cx: &mut Diagnostics) -> bool {
        let is_call = |e: &Expr| matches!(&e.kind, ExprKind::Call(name, _) if name.text == word);
        let call = self.plain.iter().position(is_call).map(|at| self.plain.remove(at).place);
        let named = self.take(word);
        let Some(place) = call.or(named.as_ref().map(|(name, _)| name.place.clone())) else { return false };
        let off = match &named {
            Some((_, Value::Expr(e))) => e.name() == Some("false") || e.literal() == Some(0.0),
            _ => false,
        };
        let help = if off { "leave it out".to_string() } else { format!("write `{word}` alone") };
        cx.error(place.clone(), format!("`{word}` is a word without a value")).help(help);
        self.plain.push(Expr { kind: ExprKind::Name(word.to_string()), place });
        true
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
            (name, Value::Texts(_) | Value::Figures(_)) => {
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
        // A key that is not known is reported as such: most likely it is the missing one. So is a value without a key.
        if self.place_of(key).is_none()
            && self.named.iter().all(|(name, _)| known.contains(&name.text.as_str()))
        {
            if let [value, others @ ..] = self.plain.as_slice()
                && attribute != "constraint"
                && !value.name().is_some_and(|word| known.contains(&word))
            {
                let error = cx.error(value.place.clone(), "expected `name = value`");
                error.help(format!("write `{key} = {}`", value.spelt()));
                if !others.is_empty() {
                    error.suggest("", known.iter().copied());
                }
                self.plain.clear();
                return None;
            }
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
    pub fn take_word(
        &mut self,
        key: &str,
        choices: &[&str],
        cx: &mut Diagnostics,
    ) -> Option<(String, Place)> {
        let (name, value) = self.take(key)?;
        match value {
            Value::Expr(Expr { kind: ExprKind::Name(word), place }) if choices.contains(&word.as_str()) => {
                Some((word, place))
            }
            Value::Expr(Expr { kind: ExprKind::Name(word), place }) => {
                let said = if key == "formulation" { words::FORMULATIONS } else { &[] };
                words::point(
                    cx.error(place, format!("unknown choice `{word}` for `{key}`")),
                    said,
                    &word,
                    choices,
                );
                None
            }
            Value::Text(text) if choices.contains(&text.value().as_str()) => {
                cx.error(text.span(), format!("expected a word for `{key}`"))
                    .help(format!("write it without quotes: `{key} = {}`", text.value()));
                None
            }
            _ => {
                cx.error(name.place, format!("expected a word for `{key}`"))
                    .suggest("", choices.iter().copied());
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
            Some((name, value)) => {
                let list =
                    names_without_brackets_or_quotes(&value).unwrap_or_else(|| "\"…\", \"…\"".to_string());
                cx.error(name.place, format!("expected a list of strings for `{key}`"))
                    .help(format!("write `{key} = [{list}]`"));
                Vec::new()
            }
        }
    }

    /// The figures of a file that are parameters.
    pub fn take_figures(&mut self, key: &str) -> Vec<FileFigures> {
        match self.take(key) {
            Some((_, Value::Figures(figures))) => figures,
            _ => Vec::new(),
        }
    }

    /// The relation `parent -> child`.
    pub fn take_relation(&mut self, known: &[&str], cx: &mut Diagnostics) -> Option<(Expr, Expr)> {
        if self.relation.is_none() {
            let (place, ends) = self.seeming_ends(known);
            self.plain.clear();
            let diagnostic = cx.error(place, "a joint says which bodies it joins");
            match ends {
                Some([parent, child]) => diagnostic.help(format!("write `{parent} -> {child}`")),
                None => diagnostic
                    .help("write `#[joint(parent -> child, …)]`, with `ground` for what does not move"),
            };
        }
        self.relation.take()
    }

    /// What seems to be meant by the two ends of a joint that has no arrow, and where it stands; taken away if it has keys.
    fn seeming_ends(&mut self, known: &[&str]) -> (Place, Option<[String; 2]>) {
        let spelt = |a: &Expr, b: &Expr| Some([a.spelt(), b.spelt()]);
        if let Some((place, a, b)) = self.take_ends() {
            return (place, spelt(&a, &b));
        }
        let place = self.plain.first().map_or(&self.place, |e| &e.place).clone();
        match self.plain.as_slice() {
            [Expr { kind: ExprKind::Binary(BinaryOp::Sub, a, b, _), .. }] => return (place, spelt(a, b)),
            [a] => return (place, Some(["parent".to_string(), a.spelt()])),
            [a, b, ..] => return (place, spelt(a, b)),
            [] => {}
        }
        let stranger = |(name, value): &(Name, Value)| {
            !known.contains(&name.text.as_str()) && matches!(value, Value::Expr(_))
        };
        let Some(at) = self.named.iter().position(stranger) else { return (place, None) };
        let (name, value) = self.named.remove(at);
        let Value::Expr(value) = value else { return (name.place, None) };
        let ends = match (&value.kind, name.text.as_str()) {
            (ExprKind::Tuple(two) | ExprKind::Array(two), _) if two.len() == 2 => spelt(&two[0], &two[1]),
            (ExprKind::Name(_), "parent" | "from" | "base") => Some([value.spelt(), "child".to_string()]),
            (ExprKind::Name(_), "on" | "body" | "child" | "to" | "link") => {
                Some(["parent".to_string(), value.spelt()])
            }
            (ExprKind::Name(_) | ExprKind::Method(..), other) => Some([other.to_string(), value.spelt()]),
            _ => None,
        };
        (name.place, ends)
    }

    /// Two ends with names of their own, such as `from = a, to = b`.
    pub fn take_ends(&mut self) -> Option<(Place, Expr, Expr)> {
        let given = |key: &str| {
            self.named.iter().any(|(name, value)| name.text == key && matches!(value, Value::Expr(_)))
        };
        let (a, b) = ENDS.into_iter().find(|(a, b)| given(a) && given(b))?;
        let place = self.named.iter().find(|(name, _)| name.text == a || name.text == b)?.0.place.clone();
        let mut end = |key: &str| match self.take(key) {
            Some((_, Value::Expr(e))) => Some(e),
            _ => None,
        };
        Some((place, end(a)?, end(b)?))
    }

    /// The relation `a -> b` of what is no joint.
    pub fn take_arrow(&mut self) -> Option<(Expr, Expr)> {
        self.relation.take()
    }

    /// The one equation `a = b`, whose left side may be a single name; `b` is absent if an expression stands alone.
    pub fn take_equation(&mut self) -> Option<(Expr, Option<Expr>)> {
        if let Some((left, right)) = self.equations.pop() {
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

    /// All places with their values, those of one word first.
    pub fn take_values(&mut self) -> Vec<(Expr, Expr)> {
        let mut values = Vec::new();
        let mut rest = Vec::new();
        for (name, value) in self.named.drain(..) {
            match value {
                Value::Expr(e) => {
                    values.push((Expr { kind: ExprKind::Name(name.text), place: name.place }, e))
                }
                other => rest.push((name, other)),
            }
        }
        self.named = rest;
        values.append(&mut self.equations);
        values
    }

    /// Says which element they belong to.
    pub fn owned_by(mut self, name: &Name) -> Arguments {
        self.owner.clone_from(&name.text);
        self
    }

    /// Reports what was not taken; `whose` is the element with its article. Arguments with one answer are one mistake.
    pub fn finish(&mut self, whose: &str, known: &[&str], cx: &mut Diagnostics) {
        let (owner, example) = (&self.owner, words::example(whose));
        let mut answers: Vec<String> = Vec::new();
        for (name, value) in self.named.drain(..) {
            let word = name.text.as_str();
            let near = nearest(word, known).is_some();
            let help = match elsewhere(whose, word) {
                Some(help) => Some(help.to_string()),
                None => words::argument_help(whose, owner, word, known),
            };
            let help = help.or((!near && known.len() < 2).then(|| format!("write `{example}`")));
            if let Some(help) = &help {
                if answers.contains(help) {
                    continue;
                }
                answers.push(help.clone());
            }
            let error = cx.error(name.place, format!("{whose} has no argument `{word}`"));
            match help {
                Some(help) => error.help(help),
                None => error.suggest(word, known.iter().copied()),
            };
            if whose == "`#[mechanism]`" && error.is_bare() {
                error.help(match value {
                    Value::Text(_) => "a file is named by `urdf = \"path/to/robot.urdf\"`",
                    _ => "the documentation of `mechanism` lists its arguments",
                });
            }
        }
        if let Some(e) = self.plain.drain(..).next() {
            unnamed(&e, known, example, cx);
        }
        if let Some((left, right)) = self.equations.pop() {
            let error = cx.error(left.place.to(&right.place), "expected `name = value`");
            match left.name().filter(|name| known.contains(name)) {
                Some(name) => error.help(format!("write `{name} = {}`", right.spelt())),
                None if known.is_empty() => error.help(format!("write `{example}`")),
                None => error.suggest("", known.iter().copied()),
            };
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
        ("a Body", "rotation" | "axes" | "rpy" | "orientation") => Some(
            "rotate an end of the joint or an inertia: `body.rotated(z(angle))`, `rod(m, l, x).rotated(z(angle))`",
        ),
        ("a Rolling constraint", "friction" | "speed") => {
            Some("surfaces with friction slip: declare a `Slipping` with `slips(…)` in place of `rolls(…)`")
        }
        _ => None,
    }
}

fn parse_arguments(input: ParseStream<'_>, span: Span, form: Form) -> syn::Result<Arguments> {
    let mut arguments = Arguments {
        relation: None,
        equations: Vec::new(),
        plain: Vec::new(),
        named: Vec::new(),
        seen: Vec::new(),
        place: span.into(),
        owner: String::new(),
        form,
    };
    while !input.is_empty() {
        parse_argument(input, &mut arguments)?;
        if !input.is_empty() {
            if !input.peek(Token![,]) {
                return Err(no_comma(input));
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
            let message = format!("`{}` has no value", key.text);
            return Err(syn_error(key.place.span, &message, &format!("write `{} = …`", key.text)));
        }
        let value = match key.text.as_str() {
            "parameters" => Value::Figures(figures::parse(input)?),
            _ => parse_value(input)?,
        };
        if let ("between" | "on", Value::Expr(first)) = (key.text.as_str(), &value)
            && input.peek(Token![->])
        {
            let arrow: Token![->] = input.parse()?;
            let second = parse_expr(input).map_or_else(|_| "…".to_string(), |second| second.spelt());
            let help = format!("write `between = ({}, {second})`", first.spelt());
            return Err(syn_error(arrow.spans[0], "expected `,`", &help));
        }
        arguments.named.push((key, value));
        return Ok(());
    }
    if input.peek(LitStr) {
        return Err(text_alone(&input.parse()?));
    }
    let first = parse_expr(input)?;
    if let Some(error) = no_arrow(input, &first, arguments) {
        return Err(error);
    }
    if input.peek(Token![->]) {
        let arrow: Token![->] = input.parse()?;
        if input.is_empty() || input.peek(Token![,]) {
            let help = format!("write `{} -> child`", first.spelt());
            return Err(syn_error(arrow.spans[1], "nothing stands behind this arrow", &help));
        }
        let second = parse_expr(input)?;
        if arguments.relation.is_some() {
            let help = "a joint has two ends; write a joint for each `parent -> child`";
            return Err(syn_error(arrow.spans[0], "a second `parent -> child`", help));
        }
        arguments.relation = Some((first, second));
    } else if (input.peek(Token![=]) && !input.peek(Token![=>])) || input.peek(Token![==]) {
        let sign = input.span();
        let _ = input.parse::<Token![==]>().map(drop).or_else(|_| input.parse::<Token![=]>().map(drop));
        if input.is_empty() || input.peek(Token![,]) {
            return Err(syn_error(sign, "nothing stands behind this sign", "write `a = b`"));
        }
        let second = parse_expr(input)?;
        if !arguments.equations.is_empty() && arguments.form != Form::Equilibrium {
            return Err(syn_error(sign, "a second equation", "declare a constraint for each"));
        }
        arguments.equations.push((first, second));
    } else {
        arguments.plain.push(first);
    }
    Ok(())
}

/// Names in quotes, with commas between them.
fn parse_texts(input: ParseStream<'_>) -> syn::Result<Vec<LitStr>> {
    let mut texts = Vec::new();
    while !input.is_empty() {
        if !input.peek(LitStr) {
            let help = "names in a list are quoted, all of them: `[\"first\", \"second\"]`";
            return Err(syn_error(input.span(), "expected a name in quotes", help));
        }
        texts.push(input.parse()?);
        if !input.is_empty() {
            if !input.peek(Token![,]) {
                return Err(no_comma(input));
            }
            input.parse::<Token![,]>()?;
        }
    }
    Ok(texts)
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
            return parse_texts(&content).map(Value::Texts);
        }
    }
    parse_expr(input).map(Value::Expr)
}

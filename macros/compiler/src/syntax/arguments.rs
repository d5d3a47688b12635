//! The arguments of an attribute: parsed whatever they are, then taken one by one by what expects them.

use super::figures::FileFigures;
use super::{Expr, ExprKind, Name, words};
use crate::diag::{Diagnostics, Place, nearest};

use proc_macro2::{Span, TokenStream};
use syn::parse::{ParseStream, Parser};
use syn::{Attribute, Ident, LitStr, Meta};

mod ends;
mod parse;
mod slips;

use parse::parse_arguments;
use slips::{decimal_comma, names_without_brackets_or_quotes, unnamed};

/// The arguments of an attribute: at most one relation `a -> b`, at most one equation between two expressions
/// (of an equilibrium any number), and `key = value` in any order.
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
        if let Some(error) = decimal_comma(&tokens) {
            cx.syn(error);
            return None;
        }
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

    /// The one place that stands alone where a place has a key: most likely the second of a pair without
    /// parentheses.
    pub fn take_second(&mut self, first: &Expr) -> Option<Expr> {
        let is_place =
            |e: &Expr| matches!(e.kind, ExprKind::Name(_) | ExprKind::Method(..) | ExprKind::Field(..));
        match self.plain.as_slice() {
            [second] if is_place(first) && is_place(second) => self.plain.pop(),
            _ => None,
        }
    }

    /// Where a word stands alone, without a value.
    pub fn word_given(&mut self, word: &str) -> Option<Place> {
        let is_word = |e: &Expr| matches!(&e.kind, ExprKind::Name(name) if name == word);
        let at = self.plain.iter().position(is_word)?;
        Some(self.plain.remove(at).place)
    }

    /// Reports a value or parentheses behind a word that stands alone; the word counts as given. True if
    /// there are any.
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
        // A key that is not known is reported as such: most likely it is the missing one. So is a value
        // without a key.
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

    /// The relation `a -> b` of what is no joint.
    pub fn take_arrow(&mut self) -> Option<(Expr, Expr)> {
        self.relation.take()
    }

    /// The one equation `a = b`, whose left side may be a single name; `b` is absent if an expression stands
    /// alone.
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

    /// Reports what was not taken; `whose` is the element with its article. Arguments with one answer are one
    /// mistake.
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
            let error = cx.error(left.place.join(&right.place), "expected `name = value`");
            match left.name().filter(|name| known.contains(name)) {
                Some(name) => error.help(format!("write `{name} = {}`", right.spelt())),
                None if known.is_empty() => error.help(format!("write `{example}`")),
                None => error.suggest("", known.iter().copied()),
            };
        }
        if let Some((parent, child)) = self.relation.take() {
            cx.error(parent.place.join(&child.place), format!("{whose} joins nothing"))
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

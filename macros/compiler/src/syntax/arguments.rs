//! Arguments of an attribute, which are parsed without knowledge of the attribute and then taken one by one
//! by its reader.

use super::file_parameters::FileParameters;
use super::{Expr, ExprKind, Name, words};
use crate::diag::{Diagnostics, Place, nearest_candidate};

use proc_macro2::{Span, TokenStream};
use syn::parse::{ParseStream, Parser};
use syn::{Attribute, Ident, LitStr, Meta};

mod corrections;
mod ends;
mod parse;

use corrections::{decimal_comma_error, quoted_names, report_unnamed_argument};
use parse::parse_arguments;

/// Arguments of an attribute: at most one relation `a -> b`, at most one equation between two expressions
/// (any number for an equilibrium), and `key = value` in any order.
pub struct Arguments {
    relation: Option<(Expr, Expr)>,
    equations: Vec<(Expr, Expr)>,
    plain: Vec<Expr>,
    named: Vec<(Name, ArgumentValue)>,
    seen: Vec<Name>,
    place: Place,
    /// Name of the element to which the arguments belong.
    owner: String,
    /// Grammar of the attribute's arguments.
    grammar: Grammar,
}

/// Grammar of the arguments of an attribute.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Grammar {
    /// Arguments of a joint: two bodies with an arrow between them.
    Joint,
    /// Arguments of an equilibrium: any number of equations.
    Equilibrium,
    /// Arguments of any other attribute.
    Other,
}

enum ArgumentValue {
    FileParameters(Vec<FileParameters>),
    Expr(Expr),
    Text(LitStr),
    Texts(Vec<LitStr>),
}

impl Arguments {
    /// Parses the arguments of an attribute.
    pub fn parse_attribute_arguments(attribute: &Attribute, cx: &mut Diagnostics) -> Option<Arguments> {
        let span = attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        let is_attribute_named = |word: &str| attribute.path().is_ident(word);
        let grammar = match (is_attribute_named("joint"), is_attribute_named("equilibrium")) {
            (true, _) => Grammar::Joint,
            (_, true) => Grammar::Equilibrium,
            _ => Grammar::Other,
        };
        match &attribute.meta {
            Meta::List(list) => Arguments::parse_with_grammar(list.tokens.clone(), span, grammar, cx),
            Meta::Path(_) => Arguments::parse_with_grammar(TokenStream::new(), span, grammar, cx),
            Meta::NameValue(_) => {
                let word = attribute.path().get_ident().map_or_else(String::new, Ident::to_string);
                cx.report_error(span, "expected arguments in parentheses")
                    .add_help(format!("write `#[{word}(…)]`"));
                None
            }
        }
    }

    /// Parses the tokens between the parentheses of an attribute.
    pub fn parse(tokens: TokenStream, span: Span, cx: &mut Diagnostics) -> Option<Arguments> {
        Arguments::parse_with_grammar(tokens, span, Grammar::Other, cx)
    }

    fn parse_with_grammar(
        tokens: TokenStream,
        span: Span,
        grammar: Grammar,
        cx: &mut Diagnostics,
    ) -> Option<Arguments> {
        if let Some(error) = decimal_comma_error(&tokens) {
            cx.report_syn_error(error);
            return None;
        }
        let parsed = (|input: ParseStream<'_>| parse_arguments(input, span, grammar)).parse2(tokens);
        let mut arguments = match parsed {
            Ok(arguments) => arguments,
            // The end of the input has no span.
            Err(error) if error.to_string().starts_with("unexpected end") => {
                cx.report_error(span, "unexpected end of the arguments")
                    .add_help("an argument is missing after the last token");
                return None;
            }
            Err(error) => {
                cx.report_syn_error(error);
                return None;
            }
        };
        let mut first: Vec<(Name, ArgumentValue)> = Vec::new();
        for (key, value) in std::mem::take(&mut arguments.named) {
            if first.iter().any(|(other, _)| other.text == key.text) {
                cx.report_error(key.place, format!("`{}` is given twice", key.text))
                    .add_help("remove one of the two");
            } else {
                first.push((key, value));
            }
        }
        arguments.named = first;
        Some(arguments)
    }

    fn take_named_argument(&mut self, key: &str) -> Option<(Name, ArgumentValue)> {
        let index = self.named.iter().position(|(name, _)| name.text == key)?;
        let (name, value) = self.named.remove(index);
        self.seen.push(name.clone());
        Some((name, value))
    }

    /// Returns the span of a key that has not been taken.
    pub fn span_of_key(&self, key: &str) -> Option<Place> {
        self.named.iter().find(|(name, _)| name.text == key).map(|(name, _)| name.place.clone())
    }

    /// Removes a key with its value from the arguments of an attribute.
    pub fn remove_key(&mut self, key: &str) {
        self.named.retain(|(name, _)| name.text != key);
    }

    /// Removes all keys with their values from the arguments of an attribute.
    pub fn remove_all_keys(&mut self) {
        self.named.clear();
    }

    /// Returns the span of a key that has been taken.
    pub fn span_of_taken_key(&self, key: &str) -> Option<Place> {
        self.seen.iter().find(|name| name.text == key).map(|name| name.place.clone())
    }

    /// Returns the positional arguments of an attribute: expressions without a key.
    pub fn positional_arguments(&self) -> &[Expr] {
        &self.plain
    }

    /// Returns whether no argument of the attribute remains.
    pub fn is_empty(&self) -> bool {
        self.named.is_empty() && self.plain.is_empty() && self.equations.is_empty() && self.relation.is_none()
    }

    /// Removes and returns the positional arguments: expressions without a key.
    pub fn take_positional_arguments(&mut self) -> Vec<Expr> {
        std::mem::take(&mut self.plain)
    }

    /// Removes and returns the only expression without a key if both it and `first` are positions. It is most
    /// likely the second element of a pair without parentheses.
    pub fn take_end_of_bare_pair(&mut self, first: &Expr) -> Option<Expr> {
        let is_place_expression =
            |e: &Expr| matches!(e.kind, ExprKind::Name(_) | ExprKind::Method(..) | ExprKind::Field(..));
        match self.plain.as_slice() {
            [second] if is_place_expression(first) && is_place_expression(second) => self.plain.pop(),
            _ => None,
        }
    }

    /// Removes an option without a value, and returns its span.
    pub fn take_flag_option(&mut self, word: &str) -> Option<Place> {
        let is_option_name = |e: &Expr| matches!(&e.kind, ExprKind::Name(name) if name == word);
        let index = self.plain.iter().position(is_option_name)?;
        Some(self.plain.remove(index).place)
    }

    /// Reports a value or parentheses after an option, which has neither; the option counts as given. Returns
    /// true if there are any.
    pub fn report_option_value(&mut self, word: &str, cx: &mut Diagnostics) -> bool {
        let is_option_call = |e: &Expr| matches!(&e.kind, ExprKind::Call(name, _) if name.text == word);
        let call = self.plain.iter().position(is_option_call).map(|index| self.plain.remove(index).place);
        let argument = self.take_named_argument(word);
        let Some(place) = call.or(argument.as_ref().map(|(name, _)| name.place.clone())) else {
            return false;
        };
        let off = match &argument {
            Some((_, ArgumentValue::Expr(e))) => {
                e.as_name() == Some("false") || e.literal_number() == Some(0.0)
            }
            _ => false,
        };
        let help = if off { "leave it out".to_string() } else { format!("write `{word}` alone") };
        cx.report_error(place.clone(), format!("`{word}` is an option without a value")).add_help(help);
        self.plain.push(Expr { kind: ExprKind::Name(word.to_string()), place });
        true
    }

    /// Returns the expression of a key, if the key is present.
    pub fn take_expression_of_key(&mut self, key: &str, cx: &mut Diagnostics) -> Option<Expr> {
        match self.take_named_argument(key)? {
            (_, ArgumentValue::Expr(e)) => Some(e),
            (_, ArgumentValue::Text(text)) => {
                cx.report_error(text.span(), format!("expected an expression for `{key}`, found a string"))
                    .add_help("write it without quotes");
                None
            }
            (name, ArgumentValue::Texts(_) | ArgumentValue::FileParameters(_)) => {
                cx.report_error(name.place, format!("expected an expression for `{key}`, found strings"))
                    .add_help("write it without quotes");
                None
            }
        }
    }

    /// Returns the expression of a required key; `example` is a possible value.
    pub fn require_expression(
        &mut self,
        key: &str,
        example: &str,
        attribute: &str,
        known: &[&str],
        cx: &mut Diagnostics,
    ) -> Option<Expr> {
        // An unknown key or a value without a key is reported instead, because it is most likely the missing
        // one.
        if self.span_of_key(key).is_none()
            && self.named.iter().all(|(name, _)| known.contains(&name.text.as_str()))
        {
            if let [value, others @ ..] = self.plain.as_slice()
                && attribute != "constraint"
                && !value.as_name().is_some_and(|word| known.contains(&word))
            {
                let error = cx.report_error(value.place.clone(), "expected `name = value`");
                error.add_help(format!("write `{key} = {}`", value.short_source_text()));
                if !others.is_empty() {
                    error.suggest_name("", known.iter().copied());
                }
                self.plain.clear();
                return None;
            }
            cx.report_error(self.place.clone(), format!("missing `{key}`"))
                .add_help(format!("write `#[{attribute}(…, {key} = {example})]`").replace("(…, on", "(on"));
        }
        self.take_expression_of_key(key, cx)
    }

    /// Removes a key and returns its expressions: one expression, or several in parentheses.
    pub fn take_list(&mut self, key: &str, cx: &mut Diagnostics) -> Vec<Expr> {
        match self.take_expression_of_key(key, cx) {
            Some(Expr { kind: ExprKind::Tuple(items), .. }) => items,
            Some(e) => vec![e],
            None => Vec::new(),
        }
    }

    /// Removes a key and returns its value, which is one of a few words.
    pub fn take_choice(
        &mut self,
        key: &str,
        choices: &[&str],
        cx: &mut Diagnostics,
    ) -> Option<(String, Place)> {
        let (name, value) = self.take_named_argument(key)?;
        match value {
            ArgumentValue::Expr(Expr { kind: ExprKind::Name(word), place })
                if choices.contains(&word.as_str()) =>
            {
                Some((word, place))
            }
            ArgumentValue::Expr(Expr { kind: ExprKind::Name(word), place }) => {
                let synonyms = if key == "formulation" { words::FORMULATIONS } else { &[] };
                words::suggest_meaning_or_known_word(
                    cx.report_error(place, format!("unknown value `{word}` for `{key}`")),
                    synonyms,
                    &word,
                    choices,
                );
                None
            }
            ArgumentValue::Text(text) if choices.contains(&text.value().as_str()) => {
                cx.report_error(text.span(), format!("expected a name for `{key}`"))
                    .add_help(format!("write it without quotes: `{key} = {}`", text.value()));
                None
            }
            _ => {
                cx.report_error(name.place, format!("expected a name for `{key}`"))
                    .suggest_name("", choices.iter().copied());
                None
            }
        }
    }

    /// Removes a key from the arguments and returns its string value.
    pub fn take_text(&mut self, key: &str, cx: &mut Diagnostics) -> Option<Name> {
        match self.take_named_argument(key)? {
            (_, ArgumentValue::Text(text)) => Some(Name { text: text.value(), place: text.span().into() }),
            (name, _) => {
                cx.report_error(name.place, format!("expected a string for `{key}`"))
                    .add_help(format!("write `{key} = \"…\"`"));
                None
            }
        }
    }

    /// Returns the strings in brackets that are the value of a key.
    pub fn take_string_list(&mut self, key: &str, cx: &mut Diagnostics) -> Vec<Name> {
        let name_of_literal = |text: &LitStr| Name { text: text.value(), place: text.span().into() };
        match self.take_named_argument(key) {
            None => Vec::new(),
            Some((_, ArgumentValue::Texts(texts))) => texts.iter().map(name_of_literal).collect(),
            Some((_, ArgumentValue::Expr(Expr { kind: ExprKind::Array(items), .. }))) if items.is_empty() => {
                Vec::new()
            }
            Some((name, value)) => {
                let list = quoted_names(&value).unwrap_or_else(|| "\"…\", \"…\"".to_string());
                cx.report_error(name.place, format!("expected a list of strings for `{key}`"))
                    .add_help(format!("write `{key} = [{list}]`"));
                Vec::new()
            }
        }
    }

    /// Returns the parameters that replace values of a robot file.
    pub fn take_file_parameters(&mut self, key: &str) -> Vec<FileParameters> {
        match self.take_named_argument(key) {
            Some((_, ArgumentValue::FileParameters(figures))) => figures,
            _ => Vec::new(),
        }
    }

    /// Returns the relation `a -> b` of an element that is not a joint.
    pub fn take_arrow_relation(&mut self) -> Option<(Expr, Expr)> {
        self.relation.take()
    }

    /// Removes and returns the only equation `a = b`. The left side may be a single name; `b` is `None` for
    /// an expression without an equals sign.
    pub fn take_only_equation(&mut self) -> Option<(Expr, Option<Expr>)> {
        if let Some((left, right)) = self.equations.pop() {
            return Some((left, Some(right)));
        }
        let is_expression_argument =
            |(_, value): &(Name, ArgumentValue)| matches!(value, ArgumentValue::Expr(_));
        if let Some(index) = self.named.iter().position(is_expression_argument)
            && self.plain.is_empty()
            && let (name, ArgumentValue::Expr(right)) = self.named.remove(index)
        {
            return Some((Expr { kind: ExprKind::Name(name.text), place: name.place }, Some(right)));
        }
        let first = (!self.plain.is_empty()).then(|| self.plain.remove(0));
        first.map(|e| (e, None))
    }

    /// Removes and returns all equations; equations with a single name on the left side come first.
    pub fn take_equations(&mut self) -> Vec<(Expr, Expr)> {
        let mut values = Vec::new();
        let mut rest = Vec::new();
        for (name, value) in self.named.drain(..) {
            match value {
                ArgumentValue::Expr(e) => {
                    values.push((Expr { kind: ExprKind::Name(name.text), place: name.place }, e))
                }
                other => rest.push((name, other)),
            }
        }
        self.named = rest;
        values.append(&mut self.equations);
        values
    }

    /// Sets the name of the element to which the arguments belong.
    pub fn with_owner(mut self, name: &Name) -> Arguments {
        self.owner.clone_from(&name.text);
        self
    }

    /// Reports the remaining arguments; `whose` is the element with its article. Arguments with the same help
    /// are reported once.
    pub fn report_remaining_arguments(&mut self, whose: &str, known: &[&str], cx: &mut Diagnostics) {
        let (owner, example) = (&self.owner, words::example_declaration(whose));
        let mut answers: Vec<String> = Vec::new();
        for (name, value) in self.named.drain(..) {
            let word = name.text.as_str();
            let near = nearest_candidate(word, known).is_some();
            let help = words::help_for_unknown_argument(whose, owner, word, known)
                .or((!near && known.len() < 2).then(|| format!("write `{example}`")));
            if let Some(help) = &help {
                if answers.contains(help) {
                    continue;
                }
                answers.push(help.clone());
            }
            let error = cx.report_error(name.place, format!("{whose} has no argument `{word}`"));
            match help {
                Some(help) => error.add_help(help),
                None => error.suggest_name(word, known.iter().copied()),
            };
            if whose == "`#[mechanism]`" && error.has_no_help() {
                error.add_help(match value {
                    ArgumentValue::Text(_) => "a file is named by `urdf = \"path/to/robot.urdf\"`",
                    _ => "the documentation of `mechanism` lists its arguments",
                });
            }
        }
        if let Some(e) = self.plain.drain(..).next() {
            report_unnamed_argument(&e, known, example, cx);
        }
        if let Some((left, right)) = self.equations.pop() {
            let error = cx.report_error(left.place.extend_to_end_of(&right.place), "expected `name = value`");
            match left.as_name().filter(|name| known.contains(name)) {
                Some(name) => error.add_help(format!("write `{name} = {}`", right.short_source_text())),
                None if known.is_empty() => error.add_help(format!("write `{example}`")),
                None => error.suggest_name("", known.iter().copied()),
            };
        }
        if let Some((parent, child)) = self.relation.take() {
            cx.report_error(
                parent.place.extend_to_end_of(&child.place),
                format!("{whose} does not connect bodies"),
            )
            .add_help("`parent -> child` belongs to a joint");
        }
    }
}

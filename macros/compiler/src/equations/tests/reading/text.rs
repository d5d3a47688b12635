//! Parser of printed linear equations, for the tests.

use super::*;

/// Closure that returns the value of a name.
pub type NameValues<'a> = &'a dyn Fn(&str) -> f64;

/// Parser and evaluator of printed sums such as `1/2 m l² cos(theta)/(a + b)`.
pub struct PrintedSumEvaluator<'a> {
    rest: &'a str,
    values: NameValues<'a>,
}

pub fn evaluate_text(text: &str, values: NameValues<'_>) -> f64 {
    let mut reader = PrintedSumEvaluator { rest: text, values };
    let found = reader.parse_sum();
    assert_eq!(reader.rest, "", "{text}");
    found
}

impl PrintedSumEvaluator<'_> {
    pub fn consume_prefix(&mut self, text: &str) -> bool {
        let rest = self.rest.strip_prefix(text);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    pub fn parse_sum(&mut self) -> f64 {
        let mut sum = if self.consume_prefix("-") { -self.parse_product() } else { self.parse_product() };
        loop {
            if self.consume_prefix(" + ") {
                sum += self.parse_product();
            } else if self.consume_prefix(" - ") {
                sum -= self.parse_product();
            } else {
                return sum;
            }
        }
    }

    pub fn parse_product(&mut self) -> f64 {
        let mut product = self.parse_factor();
        loop {
            let goes_on = !self.rest.starts_with(" + ") && !self.rest.starts_with(" - ");
            if self.consume_prefix("/") {
                product /= self.parse_factor();
            } else if goes_on && self.consume_prefix(" ") {
                product *= self.parse_factor();
            } else {
                return product;
            }
        }
    }

    pub fn parse_factor(&mut self) -> f64 {
        if self.consume_prefix("(") {
            let sum = self.parse_sum();
            assert!(self.consume_prefix(")"), "{}", self.rest);
            return sum.powi(self.parse_power());
        }
        let is_name_character = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '\'');
        let powers = ['²', '³', '⁴', '⁵', '⁶', '⁷'];
        let end = self.rest.find(|c| !is_name_character(c) || powers.contains(&c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        let power = self.parse_power();
        if self.consume_prefix("(") {
            let argument = self.parse_sum();
            assert!(self.consume_prefix(")"), "{}", self.rest);
            let found = match word {
                "sqrt" => argument.sqrt(),
                "acos" => argument.acos(),
                "sin" => argument.sin(),
                "cos" => argument.cos(),
                other => panic!("the function {other}"),
            };
            return found.powi(power);
        }
        let found = if word == "pi" { PI } else { word.parse().unwrap_or_else(|_| (self.values)(word)) };
        found.powi(power)
    }

    pub fn parse_power(&mut self) -> i32 {
        let powers = [("²", 2), ("³", 3), ("⁴", 4), ("⁵", 5), ("⁶", 6), ("⁷", 7)];
        powers.into_iter().find(|(sign, _)| self.consume_prefix(sign)).map_or(1, |(_, power)| power)
    }
}

/// Parsed text of printed linear equations and their conditions.
#[derive(Default)]
pub struct ParsedEquations {
    equations: Vec<(String, String)>,
    polynomial: String,
    pub frequency: String,
    pub verdict: String,
    conditions: Vec<String>,
}

impl ParsedEquations {
    pub fn parse(text: &str) -> ParsedEquations {
        // Continuation lines are indented.
        let mut lines: Vec<String> = Vec::new();
        for line in text.lines() {
            let ends = lines.last().is_some_and(|last| last.contains(" = ") || last.ends_with("> 0"));
            match (line.strip_prefix("    "), lines.last_mut()) {
                (Some(more), Some(last))
                    if !last.is_empty()
                        && !last.ends_with("where")
                        && !last.ends_with("of")
                        && !last.ends_with(':')
                        && !last.ends_with("positive)")
                        && !(ends && last.ends_with(" 0") && last.starts_with(' ')) =>
                {
                    *last += &format!(" {}", more.trim_start());
                }
                _ => lines.push(line.to_string()),
            }
        }
        let mut found = ParsedEquations::default();
        let mut after = false;
        for line in &lines {
            after |= line.starts_with("Motions");
            if let Some(condition) = line.strip_suffix(" > 0") {
                found.conditions.push(condition.trim_start().to_string());
            } else if let Some(polynomial) =
                line.strip_prefix("    ").and_then(|line| line.strip_suffix(" = 0"))
            {
                found.polynomial = polynomial.to_string();
            } else if let Some(frequency) = line.strip_prefix("    omega = ") {
                found.frequency = frequency.to_string();
            } else if line.contains("table") || line.contains("too long") {
                found.verdict.clone_from(line);
            } else if let Some((left, right)) =
                line.split_once(" = ").filter(|_| !after && !line.contains("; other values"))
            {
                found.equations.push((left.to_string(), right.to_string()));
            }
        }
        found
    }

    /// Returns the coefficients of a name in all equations, on the left or on the right sides.
    pub fn coefficient_column(&self, name: &str, right: bool, parameters: NameValues<'_>) -> Vec<f64> {
        let name_value_with_unit_variable = |word: &str| match word {
            _ if word == name => 1.0,
            _ if self.is_variable_name(word) => 0.0,
            _ => parameters(word),
        };
        self.equations
            .iter()
            .map(|(a, b)| evaluate_text(if right { b } else { a }, &name_value_with_unit_variable))
            .collect()
    }

    /// Returns true for names of variables, and false for names of parameters.
    pub fn is_variable_name(&self, word: &str) -> bool {
        [
            "lambda", "motor", "push", "thrust", "rail", "hinge", "shoulder", "elbow", "pose", "one", "two",
            "three", "theta", "power",
        ]
        .iter()
        .any(|name| word.starts_with(name))
    }

    /// Returns whether all printed stability conditions hold for these parameters.
    pub fn satisfies_conditions(&self, parameters: NameValues<'_>) -> bool {
        self.conditions.iter().all(|condition| evaluate_text(condition, parameters) > 0.0)
    }

    /// Returns the coefficients of the printed characteristic polynomial in ascending powers, determined from
    /// its values.
    pub fn characteristic_coefficients(&self, parameters: NameValues<'_>) -> Vec<f64> {
        let polynomial_value =
            |s: f64| evaluate_text(&self.polynomial, &|word| if word == "s" { s } else { parameters(word) });
        let degree =
            ["⁶", "⁵", "⁴", "³", "²"].iter().position(|p| self.polynomial.contains(&format!("s{p}")));
        let n = degree.map_or(1, |k| 6 - k);
        // Newton interpolation at equidistant points, expanded to powers.
        let points: Vec<f64> = (0..=n).map(|k| k as f64 - n as f64 / 2.0).collect();
        let mut table: Vec<f64> = points.iter().map(|s| polynomial_value(*s)).collect();
        for order in 1..=n {
            for k in (order..=n).rev() {
                table[k] = (table[k] - table[k - 1]) / (points[k] - points[k - order]);
            }
        }
        let mut sum = vec![0.0; n + 1];
        for k in (0..=n).rev() {
            for power in (1..=n).rev() {
                sum[power] = sum[power - 1] - points[k] * sum[power];
            }
            sum[0] = table[k] - points[k] * sum[0];
        }
        sum
    }

    pub fn characteristic_roots(&self, parameters: NameValues<'_>) -> Vec<Complex<f64>> {
        polynomial_roots(&self.characteristic_coefficients(parameters))
    }
}

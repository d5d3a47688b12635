//! One section of the tour as data, and as text for the terminal; [`crate::page`] renders it as a web page.

use crate::scene::Scene;
use linkwork_design::picture::Chart;
use std::fmt::Write;

/// Results of one section of the tour.
pub struct Section {
    /// Heading of the section.
    pub title: String,
    /// Description of the section in a few sentences.
    pub text: String,
    /// Source text of the mechanism's declaration.
    pub declaration: String,
    /// Equations of motion of the mechanism, or an empty string if they are too long to print.
    pub equations: &'static str,
    /// Tables of results of the section.
    pub tables: Vec<Table>,
    /// Comparisons of the results in a section of the report with expected values.
    pub checks: Vec<UpperBoundCheck>,
    /// Animated scenes of the section.
    pub scenes: Vec<Scene>,
    /// Plots of the section.
    pub pictures: Vec<Picture>,
}

/// Plot as SVG.
pub struct Picture {
    /// Heading of the plot.
    pub title: &'static str,
    /// SVG text of the plot.
    pub svg: String,
}

impl Picture {
    /// Creates a plot of curves over time with a label for their quantity. The function `draw` adds the
    /// curves.
    pub fn over_time(
        title: &'static str,
        y: &str,
        draw: impl FnOnce(Chart) -> Chart,
    ) -> Result<Self, linkwork_design::Error> {
        Ok(Self { title, svg: draw(Chart::over_time("", y)).svg()? })
    }
}

/// Converts points to the pairs of a curve.
pub fn pairs_of_curve(points: &[[f64; 2]]) -> impl Iterator<Item = (f64, f64)> {
    points.iter().map(|[x, y]| (*x, *y))
}

/// Table whose first column holds names, and whose other columns hold values.
pub struct Table {
    /// Headings of the columns of the table.
    pub head: Vec<&'static str>,
    /// Cells of the table, row by row.
    pub rows: Vec<Vec<String>>,
}

/// Check that a value is below a bound.
pub struct UpperBoundCheck {
    /// Name of the checked value, with its unit.
    pub what: &'static str,
    /// Measured value of the quantity.
    pub value: f64,
    /// Upper bound of the checked value.
    pub bound: f64,
}

impl UpperBoundCheck {
    /// Creates a check of a value against its upper bound.
    pub fn new(what: &'static str, value: f64, bound: f64) -> Self {
        Self { what, value, bound }
    }

    /// Whether the checked value is below its bound; NaN is not.
    pub fn is_below_bound(&self) -> bool {
        self.value < self.bound
    }
}

/// Formats a number with three digits, and with a power of ten if it is very small or large.
pub fn format_number(x: f64) -> String {
    let size = x.abs();
    if size > 0.0 && !(1e-3..1e4).contains(&size) {
        return format!("{x:.1e}");
    }
    let decimals = (2.0 - size.max(1e-3).log10().floor()).max(0.0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// Returns the declaration of a mechanism without its documentation, from the text of its file.
pub fn declaration_of_mechanism(file: &str, name: &str) -> String {
    let lines: Vec<&str> = file.lines().filter(|line| !line.trim_start().starts_with("///")).collect();
    let starts_struct_declaration =
        |line: &&str, word: &str| line.starts_with(&format!("pub struct {name}{word}"));
    let Some(head) =
        lines.iter().position(|l| [" ", ";", "<"].iter().any(|word| starts_struct_declaration(l, word)))
    else {
        return String::new();
    };
    let first = lines[..head].iter().rposition(|l| l.starts_with("#[mechanism")).unwrap_or(head);
    let length = lines[head..].iter().position(|l| *l == "}" || l.ends_with(';')).unwrap_or(0) + 1;
    let kept = lines[first..head + length].iter().filter(|l| !l.starts_with("#[derive"));
    kept.copied().collect::<Vec<_>>().join("\n")
}

/// Width of the report in the terminal, characters.
const WIDTH: usize = 100;

impl Section {
    /// Returns the section as text for a terminal.
    pub fn section_text(&self, number: usize) -> String {
        let mut out = format!("{number}  {}\n", self.title);
        write_wrapped_words(&mut out, &self.text);
        let shown = if self.equations.is_empty() { &self.declaration } else { self.equations };
        for line in shown.lines() {
            let _ = writeln!(out, "     │ {line}");
        }
        for table in &self.tables {
            out.push('\n');
            write_table(&mut out, table);
        }
        out.push('\n');
        let widest = self.checks.iter().map(|c| c.what.chars().count()).max().unwrap_or(0);
        for check in &self.checks {
            let mark = if check.is_below_bound() { '✓' } else { '✗' };
            let (value, bound) = (format_number(check.value), format_number(check.bound));
            let _ = writeln!(out, "   {mark} {:<widest$}  {value:>8} < {bound}", check.what);
        }
        out.push('\n');
        out
    }
}

fn write_wrapped_words(out: &mut String, text: &str) {
    let mut column = 0;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        let start = if column == 0 || column + 1 + length > WIDTH { "\n   " } else { " " };
        column = if start == " " { column + 1 + length } else { 3 + length };
        let start = if out.ends_with('\n') { start.trim_start_matches('\n') } else { start };
        out.push_str(start);
        out.push_str(word);
    }
    out.push('\n');
}

fn write_table(out: &mut String, table: &Table) {
    let column_width = |k: usize| {
        let cells = table.rows.iter().filter_map(|row| row.get(k)).map(|cell| cell.chars().count());
        cells.chain(table.head.get(k).map(|head| head.chars().count())).max().unwrap_or(0)
    };
    let columns = table.rows.first().map_or(0, Vec::len);
    let widths: Vec<usize> = (0..columns).map(column_width).collect();
    let head: Vec<String> = table.head.iter().map(ToString::to_string).collect();
    for row in std::iter::once(&head).filter(|head| !head.is_empty()).chain(&table.rows) {
        out.push_str("     ");
        for (k, (cell, w)) in row.iter().zip(&widths).enumerate() {
            let _ = if k == 0 { write!(out, "{cell:<w$}") } else { write!(out, "   {cell:>w$}") };
        }
        out.push('\n');
    }
}

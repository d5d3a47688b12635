//! One stop of the tour as data, and as text for the terminal; [`crate::page`] makes a web page of the same.

use crate::scene::Scene;
use linkwork_design::picture::Chart;
use std::fmt::Write;

/// What one stop has to show.
pub struct Section {
    /// Heading.
    pub title: String,
    /// What happens, in a few sentences.
    pub text: String,
    /// The mechanism as it was written.
    pub declaration: String,
    /// Its equations of motion; empty if they are too long to be read.
    pub equations: &'static str,
    /// Figures.
    pub tables: Vec<Table>,
    /// What must hold.
    pub checks: Vec<Check>,
    /// Moving pictures.
    pub scenes: Vec<Scene>,
    /// Pictures that stand still.
    pub pictures: Vec<Picture>,
}

/// A picture as SVG.
pub struct Picture {
    /// Heading.
    pub title: &'static str,
    /// The picture.
    pub svg: String,
}

impl Picture {
    /// Curves over time with a label for what they show; `draw` adds them.
    pub fn over_time(
        title: &'static str,
        y: &str,
        draw: impl FnOnce(Chart) -> Chart,
    ) -> Result<Self, linkwork_design::Error> {
        Ok(Self { title, svg: draw(Chart::over_time("", y)).svg()? })
    }
}

/// Points for a curve.
pub fn pairs(points: &[[f64; 2]]) -> impl Iterator<Item = (f64, f64)> {
    points.iter().map(|[x, y]| (*x, *y))
}

/// A table; the first column holds names, the others figures.
pub struct Table {
    /// Heads of the columns.
    pub head: Vec<&'static str>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

/// A figure that must stay below a bound.
pub struct Check {
    /// What it is, with its unit.
    pub what: &'static str,
    /// The figure.
    pub value: f64,
    /// The bound.
    pub bound: f64,
}

impl Check {
    /// A check, to be shown.
    pub fn new(what: &'static str, value: f64, bound: f64) -> Self {
        Self { what, value, bound }
    }

    /// Whether the figure is below its bound; a NaN is not.
    pub fn holds(&self) -> bool {
        self.value < self.bound
    }
}

/// Three digits, with a power of ten where the number is very small or large.
pub fn figure(x: f64) -> String {
    let size = x.abs();
    if size > 0.0 && !(1e-3..1e4).contains(&size) {
        return format!("{x:.1e}");
    }
    let decimals = (2.0 - size.max(1e-3).log10().floor()).max(0.0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// A mechanism as it was written, without its documentation, from the text of its file.
pub fn declaration(file: &str, name: &str) -> String {
    let lines: Vec<&str> = file.lines().filter(|line| !line.trim_start().starts_with("///")).collect();
    let starts = |line: &&str, word: &str| line.starts_with(&format!("pub struct {name}{word}"));
    let Some(head) = lines.iter().position(|l| [" ", ";", "<"].iter().any(|word| starts(l, word))) else {
        return String::new();
    };
    let first = lines[..head].iter().rposition(|l| l.starts_with("#[mechanism")).unwrap_or(head);
    let length = lines[head..].iter().position(|l| *l == "}" || l.ends_with(';')).unwrap_or(0) + 1;
    let kept = lines[first..head + length].iter().filter(|l| !l.starts_with("#[derive"));
    kept.copied().collect::<Vec<_>>().join("\n")
}

/// Width of the text in the terminal.
const WIDTH: usize = 100;

impl Section {
    /// The section for a terminal.
    pub fn text(&self, number: usize) -> String {
        let mut out = format!("{number}  {}\n", self.title);
        write_wrapped(&mut out, &self.text);
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
            let mark = if check.holds() { '✓' } else { '✗' };
            let (value, bound) = (figure(check.value), figure(check.bound));
            let _ = writeln!(out, "   {mark} {:<widest$}  {value:>8} < {bound}", check.what);
        }
        out.push('\n');
        out
    }
}

fn write_wrapped(out: &mut String, text: &str) {
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
    let width = |k: usize| {
        let cells = table.rows.iter().filter_map(|row| row.get(k)).map(|cell| cell.chars().count());
        cells.chain(table.head.get(k).map(|head| head.chars().count())).max().unwrap_or(0)
    };
    let columns = table.rows.first().map_or(0, Vec::len);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let head: Vec<String> = table.head.iter().map(ToString::to_string).collect();
    for row in std::iter::once(&head).filter(|head| !head.is_empty()).chain(&table.rows) {
        out.push_str("     ");
        for (k, (cell, w)) in row.iter().zip(&widths).enumerate() {
            let _ = if k == 0 { write!(out, "{cell:<w$}") } else { write!(out, "   {cell:>w$}") };
        }
        out.push('\n');
    }
}

//! Comma-separated values with a line of names: inputs over time, and motions.

use crate::Stop;
use std::path::Path;

/// Columns of numbers with their names, by times that do not decrease.
pub struct Table {
    /// Times, s.
    pub times: Vec<f64>,
    /// The other columns.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Table {
    /// Reads a file; one column is `t`.
    pub fn read(path: &Path) -> Result<Table, Stop> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| Stop::Failure(format!("cannot read {}: {error}", path.display())))?;
        // Spreadsheets begin their files with a byte order mark.
        Table::parse(text.trim_start_matches('\u{feff}'))
            .map_err(|why| Stop::Failure(format!("{}: {why}", path.display())))
    }

    fn parse(text: &str) -> Result<Table, String> {
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let head = lines.next().map(|(_, line)| fields(line)).unwrap_or_default();
        let time = head.iter().position(|name| name == "t").ok_or("there is no column `t`")?;
        if let Some(twice) = (1..head.len()).find(|k| head[..*k].contains(&head[*k])) {
            return Err(format!("there are two columns `{}`", head[twice]));
        }
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); head.len()];
        for (number, line) in lines {
            let found = fields(line);
            if found.len() != head.len() {
                let why =
                    format!("line {}: expected {} values, found {}", number + 1, head.len(), found.len());
                return Err(why);
            }
            for (column, field) in columns.iter_mut().zip(&found) {
                let value: Option<f64> = field.trim().parse().ok().filter(|x: &f64| x.is_finite());
                column.push(value.ok_or_else(|| format!("line {}: `{field}` is no number", number + 1))?);
            }
        }
        let mut columns: Vec<(String, Vec<f64>)> = head.into_iter().zip(columns).collect();
        let (_, times) = columns.remove(time);
        if times.is_empty() {
            return Err("there are no values".to_string());
        }
        match times.windows(2).position(|pair| pair[1] < pair[0]) {
            Some(k) => Err(format!("the times decrease after {} s", times[k])),
            None => Ok(Table { times, columns }),
        }
    }

    /// A column by name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(known, _)| known == name).map(|(_, values)| values.as_slice())
    }

    /// The value of a column at a time: on straight lines between those that are given, and as they are before and after. Where it
    /// jumps it is the value after the jump.
    pub fn at(&self, values: &[f64], t: f64) -> f64 {
        self.behind(values, t, self.times.partition_point(|known| *known <= t))
    }

    /// The limit of a column as time approaches `t` from before.
    pub fn before(&self, values: &[f64], t: f64) -> f64 {
        self.behind(values, t, self.times.partition_point(|known| *known < t))
    }

    /// The value on the straight line that leads to the row of a number.
    fn behind(&self, values: &[f64], t: f64, row: usize) -> f64 {
        match row {
            0 => values[0],
            k if k == values.len() => values[k - 1],
            k => {
                let part = (t - self.times[k - 1]) / (self.times[k] - self.times[k - 1]);
                values[k - 1] + part * (values[k] - values[k - 1])
            }
        }
    }
}

/// Fields of a line; those in quotes may have commas and doubled quotes.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut field, mut quoted) = (Vec::new(), String::new(), false);
    let mut rest = line.trim_end_matches('\r').chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '"' if quoted && rest.next_if_eq(&'"').is_some() => field.push('"'),
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(std::mem::take(&mut field).trim().to_string()),
            c => field.push(c),
        }
    }
    fields.push(field.trim().to_string());
    fields
}

#[cfg(test)]
mod tests {
    use super::{Table, fields};

    #[test]
    fn quotes_hold_commas() {
        assert_eq!(fields("t, q.a,\"b,\"\"c\"\"\"\r"), ["t", "q.a", "b,\"c\""]);
    }

    #[test]
    fn values_lie_on_straight_lines() {
        let table = Table::parse("t,u.a\n0,1\n2,3\n2,5\n").unwrap_or_else(|why| panic!("{why}"));
        let values = table.column("u.a").unwrap();
        assert_eq!([-1.0, 0.5, 2.0, 9.0].map(|t| table.at(values, t)), [1.0, 1.5, 5.0, 5.0]);
        assert_eq!([-1.0, 0.5, 2.0, 9.0].map(|t| table.before(values, t)), [1.0, 1.5, 3.0, 5.0]);
    }

    #[test]
    fn what_is_no_table_is_told() {
        for (text, part) in [
            ("", "no column `t`"),
            ("t,a\n", "no values"),
            ("t,a\n0,x\n", "line 2: `x` is no number"),
            ("t,a\n0\n", "expected 2 values"),
            ("t\n1\n0\n", "decrease"),
            ("t,a,a\n0,1,2\n", "two columns `a`"),
        ] {
            assert!(Table::parse(text).is_err_and(|why| why.contains(part)), "{text}");
        }
    }
}

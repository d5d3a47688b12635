//! Comma-separated values with a header line: inputs over time, and motions.

use crate::Stop;
use linkwork_compiler::import::with_standard_whitespace;
use std::path::Path;

/// Named columns of numbers, for times that do not decrease.
pub struct TimeSeriesTable {
    /// Times of the rows of the CSV file, s.
    pub times: Vec<f64>,
    /// Columns of the CSV file other than the time, with their names.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl TimeSeriesTable {
    /// Reads a CSV file, one column of which must be `t`.
    pub fn read_table(path: &Path) -> Result<TimeSeriesTable, Stop> {
        let text = read_spreadsheet_text(path).map_err(Stop::Failure)?;
        TimeSeriesTable::parse_csv(&text).map_err(|why| Stop::Failure(format!("{}: {why}", path.display())))
    }

    fn parse_csv(text: &str) -> Result<TimeSeriesTable, String> {
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let head = lines.next().map(|(_, line)| split_csv_fields(line)).unwrap_or_default();
        let time = head.iter().position(|name| name == "t").ok_or_else(|| {
            let found: Vec<String> = head.iter().map(|name| format!("`{name}`")).collect();
            match found.is_empty() {
                true => "there is no column `t`".to_string(),
                false => format!("there is no column `t`, but {}", found.join(", ")),
            }
        })?;
        if let Some(twice) = (1..head.len()).find(|k| head[..*k].contains(&head[*k])) {
            return Err(format!("there are two columns `{}`", head[twice]));
        }
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); head.len()];
        for (number, line) in lines {
            let found = split_csv_fields(line);
            if found.len() != head.len() {
                let why =
                    format!("line {}: expected {} values, found {}", number + 1, head.len(), found.len());
                return Err(why);
            }
            for (column, field) in columns.iter_mut().zip(&found) {
                let value: Option<f64> = field.trim().parse().ok().filter(|x: &f64| x.is_finite());
                column.push(value.ok_or_else(|| format!("line {}: `{field}` is not a number", number + 1))?);
            }
        }
        let mut columns: Vec<(String, Vec<f64>)> = head.into_iter().zip(columns).collect();
        let (_, times) = columns.remove(time);
        if times.is_empty() {
            return Err("there are no values".to_string());
        }
        match times.windows(2).position(|pair| pair[1] < pair[0]) {
            Some(k) => Err(format!("the times decrease after {} s", times[k])),
            None => Ok(TimeSeriesTable { times, columns }),
        }
    }

    /// Returns the column with a name.
    pub fn column_by_name(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(known, _)| known == name).map(|(_, values)| values.as_slice())
    }
}

/// Reads a text file. Byte order marks, which spreadsheets write, and no-break spaces count as blanks.
pub fn read_spreadsheet_text(path: &Path) -> Result<String, String> {
    let text =
        std::fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    Ok(with_standard_whitespace(&text).into_owned())
}

/// Splits a line into fields. Quoted fields may contain commas and doubled quotes.
fn split_csv_fields(line: &str) -> Vec<String> {
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
    use super::{TimeSeriesTable, split_csv_fields};

    #[test]
    fn quoted_csv_cells_may_contain_commas() {
        assert_eq!(split_csv_fields("t, q.a,\"b,\"\"c\"\"\"\r"), ["t", "q.a", "b,\"c\""]);
    }

    /// Checks files of spreadsheets, which begin with a byte order mark and may contain no-break spaces.
    #[test]
    fn byte_order_marks_and_no_break_spaces_are_whitespace() {
        let file = std::env::temp_dir().join(format!("linkwork-table-{}.csv", std::process::id()));
        for text in [
            "\u{feff}t,u.a\r\n0,1\r\n2,3\r\n",
            "t,\u{a0}u.a\n0,1\u{a0}\n\u{feff}2,3\n",
            "\u{feff}\"t\",u.a\n0,1\n2,3",
        ] {
            std::fs::write(&file, text).expect("a file");
            let table = TimeSeriesTable::read_table(&file).unwrap_or_else(|_| panic!("{text:?}"));
            assert_eq!(
                (table.times.as_slice(), table.column_by_name("u.a")),
                (&[0.0, 2.0][..], Some(&[1.0, 3.0][..]))
            );
        }
        let _ = std::fs::remove_file(&file);
    }

    #[test]
    fn malformed_tables_are_rejected_with_a_message() {
        for (text, part) in [
            ("", "no column `t`"),
            ("time;u.a\n0;1\n", "there is no column `t`, but `time;u.a`"),
            ("t,a\n", "no values"),
            ("t,a\n0,x\n", "line 2: `x` is not a number"),
            ("t,a\n0\n", "expected 2 values"),
            ("t\n1\n0\n", "decrease"),
            ("t,a,a\n0,1,2\n", "two columns `a`"),
        ] {
            assert!(TimeSeriesTable::parse_csv(text).is_err_and(|why| why.contains(part)), "{text}");
        }
    }
}

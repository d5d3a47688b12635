//! `--table NAME=FILE`: the values of a table, as one line of comma-separated values per grid point: the
//! variables, then the value.

use crate::Stop;
use crate::table::read_spreadsheet_text;
use clap::ArgMatches;
use linkwork::TableError;
use linkwork_jit::AnyTable;
use std::collections::BTreeMap;
use std::path::Path;

/// Values of an interpolation table on a rectangular grid.
#[derive(Clone, Debug, PartialEq)]
pub struct TableGrid {
    /// Grid points along each axis of the table.
    pub axes: Vec<Vec<f64>>,
    /// Values in the order of the grid points, with the last axis varying fastest.
    pub values: Vec<f64>,
    /// Whether the table is interpolated by splines.
    pub smooth: bool,
    /// Whether the table is extrapolated beyond its grid.
    pub extrapolated: bool,
}

impl TableGrid {
    fn parse_grid(text: &str, variables: usize) -> Result<TableGrid, String> {
        let mut points: BTreeMap<Vec<u64>, f64> = BTreeMap::new();
        let mut axes: Vec<Vec<f64>> = vec![Vec::new(); variables];
        let mut is_first = true;
        for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let fields: Vec<&str> = line.split(',').map(str::trim).collect();
            let found: Option<Vec<f64>> =
                fields.iter().map(|field| field.parse().ok().filter(|x: &f64| x.is_finite())).collect();
            let may_name = std::mem::take(&mut is_first);
            let Some(found) = found else {
                // The first line may contain names.
                if may_name && fields.iter().all(|field| field.parse::<f64>().is_err()) {
                    continue;
                }
                return Err(format!("line {}: expected numbers, found `{}`", number + 1, line.trim()));
            };
            let Some((value, x)) = found.split_last().filter(|(_, x)| x.len() == variables) else {
                return Err(format!(
                    "line {}: expected {variables} variable{} and a value, found {} numbers",
                    number + 1,
                    if variables == 1 { "" } else { "s" },
                    found.len()
                ));
            };
            axes.iter_mut().zip(x).for_each(|(axis, x)| axis.push(*x + 0.0));
            if points.insert(x.iter().map(|x| (*x + 0.0).to_bits()).collect(), *value).is_some() {
                return Err(format!("line {}: this point is given twice", number + 1));
            }
        }
        for axis in &mut axes {
            axis.sort_by(f64::total_cmp);
            axis.dedup();
        }
        let count: usize = axes.iter().map(Vec::len).product();
        let mut values = Vec::with_capacity(points.len());
        for k in 0..count.min(points.len() + 1) {
            let mut rest = k;
            let mut at: Vec<f64> = axes
                .iter()
                .rev()
                .map(|axis| {
                    let x = axis[rest % axis.len()];
                    rest /= axis.len();
                    x
                })
                .collect();
            at.reverse();
            let value = points.get(&at.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
            values.push(*value.ok_or_else(|| format!("the grid has no value at {at:?}"))?);
        }
        let grid = TableGrid { axes, values, smooth: false, extrapolated: false };
        grid.interpolation_table().map_err(|error| error.to_string())?;
        Ok(grid)
    }

    /// Returns the table for interpolation.
    pub fn interpolation_table(&self) -> Result<AnyTable, TableError> {
        let table = AnyTable::from_grid(&self.axes, &self.values)?;
        let table = if self.smooth { table.smooth() } else { table };
        Ok(if self.extrapolated { table.extrapolated() } else { table })
    }
}

/// Returns the tables of the `--table` options, in the order of the mechanism's tables, which are given with
/// the number of their variables.
pub fn tables_from_options(matches: &ArgMatches, tables: &[(String, usize)]) -> Result<Vec<TableGrid>, Stop> {
    let mut found: Vec<Option<TableGrid>> = vec![None; tables.len()];
    for given in matches.get_many::<String>("table").into_iter().flatten() {
        let invalid_table_option = |why: String| Stop::Failure(format!("`--table {given}`: {why}"));
        let (name, rest) =
            given.split_once('=').ok_or_else(|| invalid_table_option("expected NAME=FILE".to_string()))?;
        let at = tables.iter().position(|(known, _)| known == name.trim()).ok_or_else(|| {
            let known: Vec<&str> = tables.iter().map(|(name, _)| name.as_str()).collect();
            let known = if known.is_empty() {
                "there is none".to_string()
            } else {
                format!("but {}", known.join(", "))
            };
            invalid_table_option(format!("there is no table `{}`, {known}", name.trim()))
        })?;
        let (mut smooth, mut extrapolated, mut file) = (false, false, rest);
        while let Some((before, word)) = file.rsplit_once(',') {
            match word.trim() {
                "smooth" => smooth = true,
                "extrapolated" => extrapolated = true,
                _ => break,
            }
            file = before;
        }
        let text = read_spreadsheet_text(Path::new(file.trim())).map_err(invalid_table_option)?;
        let grid = TableGrid::parse_grid(&text, tables[at].1)
            .map_err(|why| invalid_table_option(format!("{file}: {why}")))?;
        if found[at].replace(TableGrid { smooth, extrapolated, ..grid }).is_some() {
            return Err(invalid_table_option(format!("the table `{}` is given twice", name.trim())));
        }
    }
    let missing: Vec<String> = (tables.iter().zip(&found))
        .filter(|(_, grid)| grid.is_none())
        .map(|((name, _), _)| format!("--table {name}=FILE"))
        .collect();
    match missing.is_empty() {
        true => Ok(found.into_iter().flatten().collect()),
        false => Err(Stop::Failure(format!("tables without values: {}", missing.join(" ")))),
    }
}

#[cfg(test)]
mod tests {
    use super::TableGrid;

    #[test]
    fn grid_points_are_accepted_in_any_order() {
        let grid = TableGrid::parse_grid("x, y, f\n1,0,3\n0,0,1\n0,5,2\n1,5,4\n", 2)
            .unwrap_or_else(|why| panic!("{why}"));
        assert_eq!(
            (grid.axes, grid.values),
            (vec![vec![0.0, 1.0], vec![0.0, 5.0]], vec![1.0, 2.0, 3.0, 4.0])
        );
    }

    #[test]
    fn tables_that_are_not_grids_are_rejected() {
        for (text, part) in [
            ("", "fewer than two points"),
            ("0,1\n", "fewer than two points"),
            ("0,1\n0,2\n", "line 2: this point is given twice"),
            ("0,1\n-0,2\n", "line 2: this point is given twice"),
            ("0,1,2\n", "line 1: expected 1 variable and a value, found 3 numbers"),
            ("0,1\nx,2\n", "line 2: expected numbers, found `x,2`"),
            ("0,1\n1,inf\n", "line 2: expected numbers"),
        ] {
            assert!(
                TableGrid::parse_grid(text, 1).is_err_and(|why| why.contains(part)),
                "{text}: {:?}",
                TableGrid::parse_grid(text, 1)
            );
        }
        assert!(
            TableGrid::parse_grid("0,0,1\n1,1,2\n", 2)
                .is_err_and(|why| why.contains("no value at [0.0, 1.0]"))
        );
    }
}

//! Tables: functions of up to three variables, as members of the parameter struct.

use super::docs;
use super::function::Outline;
use std::fmt::Write;

/// Returns the definition of the table type, if there are tables.
pub fn table_type_definition(o: &Outline<'_>) -> String {
    if o.tables.is_empty() {
        return String::new();
    }
    let text = "/* A function of one to three variables by its values on a grid. Between the points it is \
                linear in each variable, or\n * smooth: cubic along each axis, with slopes of the parabolas \
                through three points. Beyond the grid it keeps the value\n * of the edge, or is extrapolated \
                in straight lines. Points increase strictly, two on each axis or more. */\ntypedef struct \
                @PREFIX@_table {\n    const double *axes[3]; /* the points of each axis; variables that it \
                does not have need none */\n    int points[3]; /* how many there are */\n    const double \
                *values; /* in the order of the points, those along the last axis side by side */\n    int \
                smooth; /* 1 for continuous slopes, else 0 */\n    int extrapolated; /* 1 to go on in \
                straight lines, else 0 */\n} @PREFIX@_table;\n\n";
    text.replace("@PREFIX@", &o.prefix)
}

/// Returns the declarations of the table members, with the units of the variables and of the value.
pub fn table_member_declarations(o: &Outline<'_>, units: &[Vec<String>]) -> String {
    let mut text = String::new();
    for (k, member) in o.tables.iter().enumerate() {
        let units = units.get(k).map_or(&[][..], Vec::as_slice);
        let (value, variables) = units.split_last().map_or(("", &[][..]), |(v, rest)| (v.as_str(), rest));
        let says = format!("{value} of {}", variables.join(", "));
        let _ = writeln!(text, "    {}_table {member}; /* {} */", o.prefix, docs::comment_safe_text(&says));
    }
    text
}

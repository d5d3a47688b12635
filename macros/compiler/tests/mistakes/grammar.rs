//! Tests of error messages for syntax errors in attributes and in the struct.

use super::{ARM, ErrorRow, check_error_rows};

const ROWS: &[ErrorRow] = &[
    ("#[body(mass = 1 com = x)] tool: Body", "expected `,`", "write `…, com = …`"),
    ("#[body(mass = 1; com = x)] tool: Body", "expected `,`", "arguments are separated by `,`"),
    ("#[body(mass: 1)] tool: Body", "expected `=`", "write `mass = …`"),
    ("#[body(mass(1))] tool: Body", "expected `name = value`", "write `mass = 1`"),
    ("#[body(mass = )] tool: Body", "`mass` has no value", "write `mass = …`"),
    ("#[body(mass)] tool: Body", "`mass` has no value", "write `mass = …`"),
    (
        "#[body(= 1)] tool: Body",
        "expected an expression: a number, a name, a call or a vector",
        "write `name = value`",
    ),
    ("#[body(mass == 1)] tool: Body", "expected `name = value`", "write `mass = 1`"),
    ("#[body(mass += 1)] tool: Body", "expected `=`", "write `mass = …`"),
    ("#[body(mass = 1, mass = 2)] tool: Body", "`mass` is given twice", "remove one"),
    ("#[body(mass = 1 +)] tool: Body", "missing operand after this operator", "remove it"),
    (
        "#[body(mass = * 1)] tool: Body",
        "expected an expression: a number, a name, a call or a vector",
        "is a binary operator",
    ),
    (
        "#[body(mass = &m)] tool: Body",
        "expected an expression: a number, a name, a call or a vector",
        "remove the `&`",
    ),
    (
        "#[body(mass = {1})] tool: Body",
        "expected an expression: a number, a name, a call or a vector",
        "no blocks",
    ),
    (
        "#[body(mass = |m| m)] tool: Body",
        "expected an expression: a number, a name, a call or a vector",
        "parameters",
    ),
    ("#[body(mass = 0.5.)] tool: Body", "expected a name after this dot", "`body.x`"),
    ("#[body(mass = 1..2)] tool: Body", "expected a name after this dot", "`body.x`"),
    ("#[body(\"mass = 1\")] tool: Body", "expected an expression, found a string", "without quotes"),
    ("#[body = (mass = 1)] tool: Body", "expected arguments in parentheses", "write `#[body(…)]`"),
    ("#[body] tool: Body", "no joint connects `tool` to the ground", "add a joint"),
    ("tool: Body", "`tool` has no attribute that defines it", "add `#[body("),
    ("_: f64", "a field of a mechanism needs a name", "name"),
    ("arm: f64", "the name `arm` is used twice", "rename one of the two"),
    ("x: f64", "the name `x` is taken", "axes"),
    ("tool: f64", "unused parameter `tool`", "remove it"),
];

#[test]
fn grammar_errors_are_reported() {
    check_error_rows(|said| (String::new(), format!("{ARM} {said}")), ROWS);
}

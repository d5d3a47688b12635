//! Syntax errors in attributes and in the struct.

use super::{ARM, Row, answers};

const ROWS: &[Row] = &[
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
    ("#[body(mass = 1 +)] tool: Body", "nothing stands behind this operator", "remove it"),
    (
        "#[body(mass = * 1)] tool: Body",
        "expected an expression: a number, a name, a call or a vector",
        "`*` stands between",
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
    ("#[body(mass = 0.5.)] tool: Body", "expected a name behind this dot", "`body.x`"),
    ("#[body(mass = 1..2)] tool: Body", "expected a name behind this dot", "`body.x`"),
    ("#[body(\"mass = 1\")] tool: Body", "expected an expression, found a text", "without quotes"),
    ("#[body = (mass = 1)] tool: Body", "expected arguments in parentheses", "write `#[body(…)]`"),
    ("#[body] tool: Body", "nothing holds `tool`", "add a joint"),
    ("tool: Body", "`tool` does not say how it is placed", "add `#[body("),
    ("_: f64", "a field of a mechanism needs a name", "name"),
    ("arm: f64", "the name `arm` is used twice", "name one of the two otherwise"),
    ("x: f64", "the name `x` is taken", "axes"),
    ("tool: f64", "nothing uses the parameter `tool`", "remove it"),
];

#[test]
fn slips() {
    answers(|said| (String::new(), format!("{ARM} {said}")), ROWS);
}

//! Tests of equations printed as LaTeX.

use super::*;

/// Allowed commands of LaTeX and `amsmath`, in addition to Greek letters.
const COMMANDS: [&str; 27] = [
    "phi",
    "lambda",
    "begin",
    "end",
    "mathcal",
    "mathrm",
    "operatorname",
    "dot",
    "ddot",
    "tfrac",
    "frac",
    "sqrt",
    "times",
    "left",
    "right",
    "bigl",
    "bigr",
    "sin",
    "cos",
    "tan",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "theta",
    "omega",
    "quad",
];
/// One-character commands of LaTeX that may occur: thin spaces, an underscore, the end of a line.
const SIGNS: [char; 4] = [',', '!', '_', '\\'];

fn equations_latex(gravity: &str, item: &str) -> String {
    call_with_parsed_model(gravity, item, |model| crate::equations_latex(&model))
}

/// Returns the errors in a LaTeX text: unbalanced braces, unknown commands, `\left` without `\right`, indices
/// without braces.
pub(super) fn latex_errors(text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let mut open: Vec<&str> = Vec::new();
    let mut close_delimiter = |open: &mut Vec<&str>, what: &str, at: usize| {
        if open.pop() != Some(what) {
            faults.push(format!("closes no {what}: {}", &text[at..]));
        }
    };
    let mut unknown = Vec::new();
    let mut rest = text.char_indices().peekable();
    while let Some((at, c)) = rest.next() {
        match c {
            '{' => open.push("brace"),
            '}' => close_delimiter(&mut open, "brace", at),
            '(' => open.push("parenthesis"),
            ')' => close_delimiter(&mut open, "parenthesis", at),
            '_' | '^' if rest.peek().is_none_or(|(_, c)| *c != '{') => unknown.push(text[at..].to_string()),
            '\\' => {
                let length = text[at + 1..].bytes().take_while(u8::is_ascii_alphabetic).count();
                let word = &text[at + 1..at + 1 + length];
                match word {
                    "" => match rest.next() {
                        Some((_, sign)) if SIGNS.contains(&sign) => {}
                        _ => unknown.push(text[at..].to_string()),
                    },
                    "left" => open.push("left"),
                    "right" => {
                        // The delimiter after `\right` belongs to it; its own parenthesis is closed first.
                        open.pop();
                        close_delimiter(&mut open, "left", at);
                        rest.nth(length);
                        continue;
                    }
                    _ if COMMANDS.contains(&word) => {}
                    _ => unknown.push(text[at..].to_string()),
                }
                if length > 0 {
                    rest.nth(length - 1);
                }
            }
            c if c.is_ascii() => {}
            _ => unknown.push(text[at..].to_string()),
        }
    }
    faults.extend(unknown);
    faults.extend(open.iter().map(ToString::to_string));
    faults
}

#[test]
fn latex_checker_finds_faults() {
    assert_eq!(latex_errors("\\left(\\tfrac{1}{2}\\,m\\right)^{2} \\\\ x_{1}"), [""; 0]);
    for text in ["{", "}", "\\left(", "(\\right)", "\\foo", "\\%", "x_1", "x^2", "θ", "{(})", "\\"] {
        assert!(!latex_errors(text).is_empty(), "{text}");
    }
}

#[test]
fn latex_of_all_mechanisms_is_well_formed() {
    let numbers = [CART_POLE, NUMBERS].map(|item| ("-9.81 * z", item));
    let items = [DOUBLE_PENDULUM, GYROSCOPE, SHAFT, SPHERICAL, CHAIN, BALL, TRIPLE, ARM, WAGON];
    for (gravity, item) in numbers.into_iter().chain(items.map(|item| ("-g * z", item))) {
        for gravity in [gravity.to_string(), gravity.replace('z', "y")] {
            let text = equations_latex(&gravity, item);
            assert_eq!(latex_errors(&text), [""; 0], "{text}");
            assert!(text.starts_with("\\begin{aligned}\n& \\mathcal{L} = "), "{text}");
            assert!(text.ends_with("\n\\end{aligned}\n"), "{text}");
            let plain = call_with_parsed_model(&gravity, item, |model| crate::equations_as_text(&model));
            let count_occurrences = |text: &str, sign: &str| text.matches(sign).count();
            assert_eq!(count_occurrences(&text, " = "), count_occurrences(&plain, " = "), "{text}");
            let lines = count_occurrences(&text, "\n& ") - count_occurrences(&text, "\n& \\quad");
            assert_eq!(lines, count_occurrences(&plain, " = "), "{text}");
            assert_eq!(count_occurrences(&text, "&"), count_occurrences(&text, " \\\\\n") + 1, "{text}");
        }
    }
    assert_eq!(equations_latex("-9.81 * z", SKEW), "");
}

/// Words are upright with their underscores; rates have dots.
#[test]
fn latex_of_cart_pole_has_upright_words_and_dots() {
    let expected = r"\begin{aligned}
& \mathcal{L} = \tfrac{1}{2}\,(\mathrm{cart\_mass} + \mathrm{pole\_mass})\,\dot{\mathrm{rail}}^{2} + \tfrac{1}{2}\,\mathrm{pole\_mass}\,\mathrm{pole\_length}\,\bigl(\tfrac{1}{3}\,\mathrm{pole\_length}\,\dot{\mathrm{hinge}}^{2} - \cos(\mathrm{hinge})\,\dot{\mathrm{rail}}\,\dot{\mathrm{hinge}}\bigr) \\
& \quad {} - 4.905\,\mathrm{pole\_mass}\,\mathrm{pole\_length}\,\cos(\mathrm{hinge}) \\
& (\mathrm{cart\_mass} + \mathrm{pole\_mass})\,\ddot{\mathrm{rail}} \\
& \quad {} - \tfrac{1}{2}\,\mathrm{pole\_mass}\,\mathrm{pole\_length}\,(\cos(\mathrm{hinge})\,\ddot{\mathrm{hinge}} - \sin(\mathrm{hinge})\,\dot{\mathrm{hinge}}^{2}) + \mathrm{rail\_damping}\,\dot{\mathrm{rail}} = \mathrm{push} \\
& \mathrm{pole\_mass}\,\mathrm{pole\_length}\,\bigl(\tfrac{1}{3}\,\mathrm{pole\_length}\,\ddot{\mathrm{hinge}} - \tfrac{1}{2}\,\cos(\mathrm{hinge})\,\ddot{\mathrm{rail}} - 4.905\,\sin(\mathrm{hinge})\bigr) = 0
\end{aligned}
";
    assert_eq!(equations_latex("-9.81 * y", CART_POLE), expected);
}

/// Digits become subscripts; single letters are printed unchanged.
#[test]
fn latex_of_double_pendulum_has_numeric_subscripts() {
    let item = DOUBLE_PENDULUM.replace("shoulder", "theta1").replace("elbow", "theta2");
    let expected = r"\begin{aligned}
& \mathcal{L} = \tfrac{1}{2}\,\left(\tfrac{1}{3}\,m_{1}\,l_{1}^{2} + m_{2}\,\bigl(l_{1}^{2} + \tfrac{1}{3}\,l_{2}^{2} + l_{1}\,l_{2}\,\cos\theta_{2}\bigr)\right)\,\dot{\theta}_{1}^{2} + m_{2}\,l_{2}\,\left(\bigl(\tfrac{1}{3}\,l_{2} + \tfrac{1}{2}\,l_{1}\,\cos\theta_{2}\bigr)\,\dot{\theta}_{1}\,\dot{\theta}_{2} + \tfrac{1}{6}\,l_{2}\,\dot{\theta}_{2}^{2}\right) \\
& \quad {} + g\,l_{1}\,\bigl(\tfrac{1}{2}\,m_{1} + m_{2}\bigr)\,\cos\theta_{1} + \tfrac{1}{2}\,g\,m_{2}\,l_{2}\,\cos(\theta_{1} + \theta_{2}) \\
& \left(\tfrac{1}{3}\,m_{1}\,l_{1}^{2} + m_{2}\,\bigl(l_{1}^{2} + \tfrac{1}{3}\,l_{2}^{2} + l_{1}\,l_{2}\,\cos\theta_{2}\bigr)\right)\,\ddot{\theta}_{1} \\
& \quad {} + m_{2}\,l_{2}\,\left(\bigl(\tfrac{1}{3}\,l_{2} + \tfrac{1}{2}\,l_{1}\,\cos\theta_{2}\bigr)\,\ddot{\theta}_{2} - l_{1}\,\bigl(\dot{\theta}_{1} + \tfrac{1}{2}\,\dot{\theta}_{2}\bigr)\,\sin\theta_{2}\,\dot{\theta}_{2} + \tfrac{1}{2}\,g\,\sin(\theta_{1} + \theta_{2})\right) + g\,l_{1}\,\bigl(\tfrac{1}{2}\,m_{1} + m_{2}\bigr)\,\sin\theta_{1} = 0 \\
& m_{2}\,l_{2}\,\left(\bigl(\tfrac{1}{3}\,l_{2} + \tfrac{1}{2}\,l_{1}\,\cos\theta_{2}\bigr)\,\ddot{\theta}_{1} + \tfrac{1}{3}\,l_{2}\,\ddot{\theta}_{2} + \tfrac{1}{2}\,l_{1}\,\sin\theta_{2}\,\dot{\theta}_{1}^{2} + \tfrac{1}{2}\,g\,\sin(\theta_{1} + \theta_{2})\right) = \mathrm{motor}
\end{aligned}
";
    assert_eq!(equations_latex("-g * y", &item), expected);
}

/// Angular velocities and quaternion components have their joint as subscript.
#[test]
fn latex_of_top_has_joint_names_as_subscripts() {
    let expected = r"\begin{aligned}
& \mathcal{L} = \tfrac{1}{2}\,(m\,l^{2} + a)\,(\omega_{\mathrm{tip},x}^{2} + \omega_{\mathrm{tip},y}^{2}) + \tfrac{1}{2}\,c\,\omega_{\mathrm{tip},z}^{2} + g\,m\,l\,(2\,q_{\mathrm{tip},x}^{2} + 2\,q_{\mathrm{tip},y}^{2} - 1) \\
& (m\,l^{2} + a)\,\dot{\omega}_{\mathrm{tip},x} + (c - m\,l^{2} - a)\,\omega_{\mathrm{tip},y}\,\omega_{\mathrm{tip},z} - 2\,g\,m\,l\,(q_{\mathrm{tip},x}\,q_{\mathrm{tip},w} + q_{\mathrm{tip},y}\,q_{\mathrm{tip},z}) = 0 \\
& (m\,l^{2} + a)\,\dot{\omega}_{\mathrm{tip},y} + (m\,l^{2} + a - c)\,\omega_{\mathrm{tip},x}\,\omega_{\mathrm{tip},z} + 2\,g\,m\,l\,(q_{\mathrm{tip},x}\,q_{\mathrm{tip},z} - q_{\mathrm{tip},y}\,q_{\mathrm{tip},w}) = 0 \\
& c\,\dot{\omega}_{\mathrm{tip},z} = 0
\end{aligned}
";
    assert_eq!(equations_latex("-g * z", BALL), expected);
}

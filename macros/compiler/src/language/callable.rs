//! Names that can be called with arguments in parentheses: `sin(angle)`, `rod(m, l, y)`, `z(angle)`.

use super::{FunctionId, Rotation, Solid};
use crate::expr::Function;

/// A name of the language that can be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Callable {
    /// A piecewise expression `if a < b { below } else { above }`, with its operands and pieces.
    If,
    /// Elementary function of one variable, such as `sin`.
    Elementary(Function),
    /// Function of the language with a row in the table of functions.
    Function(FunctionId),
    /// Solid as a function of the language, as in `inertia = rod(…)`.
    Solid(Solid),
    /// Rotation as a function of the language, such as `x(angle)`.
    Rotation(Rotation),
    /// The function `rolls(surface, surface)`.
    Rolls,
    /// The function `slips(surface, surface)`.
    Slips,
    /// The function `collision()`: the collision geometry of a file.
    Collision,
    /// The function `poisson(e)`: a coefficient of restitution by impulses.
    Poisson,
}

/// Name of the calls that represent piecewise expressions; a keyword, so that no function can have it.
pub const IF: &str = "if";

/// Name of the method for the collision geometry of a file's link.
pub const COLLISION: &str = "collision";

/// Names that can be called and belong to no table.
const OTHERS: [(&str, Callable); 5] = [
    (IF, Callable::If),
    ("rolls", Callable::Rolls),
    ("slips", Callable::Slips),
    (COLLISION, Callable::Collision),
    ("poisson", Callable::Poisson),
];

impl Callable {
    /// Returns the callable function of the language with this name.
    pub fn find_by_name(name: &str) -> Option<Callable> {
        let elementary = Function::ALL.iter().find(|(known, _)| *known == name);
        let find_in_others_table = || OTHERS.iter().find(|(known, _)| *known == name);
        elementary
            .map(|(_, function)| Callable::Elementary(*function))
            .or_else(|| FunctionId::find_by_name(name).map(Callable::Function))
            .or_else(|| Solid::find_by_name(name).map(Callable::Solid))
            .or_else(|| Rotation::find_by_name(name).map(Callable::Rotation))
            .or_else(|| find_in_others_table().map(|(_, callable)| *callable))
    }

    /// Returns the name `rolls` or `slips` of a pair of surfaces.
    pub fn rolls_or_slips_name(self) -> &'static str {
        OTHERS.iter().find(|(_, callable)| *callable == self).map_or("", |(word, _)| word)
    }

    /// True for a name of a function of expressions.
    pub fn is_function_name(name: &str) -> bool {
        matches!(Callable::find_by_name(name), Some(Callable::Elementary(_) | Callable::Function(_)))
    }
}

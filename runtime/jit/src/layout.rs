//! Layout of the inputs of a program: the parameters, then the arguments of its function.

use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::expr::Symbol;
use linkwork_compiler::mechanism::Quantity;

/// Order in which a program receives its inputs.
pub(crate) struct InputLayout {
    arguments: Vec<Argument>,
}

impl InputLayout {
    /// Maximum number of inputs of a program, including the parameters.
    pub const MOST: usize = 12;

    /// Returns the layout of the parameters and these arguments; `None` if there are too many of them.
    pub fn new(arguments: &[Argument]) -> Option<InputLayout> {
        (arguments.len() < InputLayout::MOST).then(|| InputLayout { arguments: arguments.to_vec() })
    }

    /// Returns the number of inputs, including the parameters.
    pub fn len(&self) -> usize {
        1 + self.arguments.len()
    }

    /// Returns the index of the input that contains a symbol, and the symbol's index in it; `None` if no
    /// input contains it.
    pub fn locate_symbol(&self, symbol: Symbol) -> Option<(usize, usize)> {
        match Quantity::from_symbol(symbol) {
            Quantity::Parameter(k) => Some((0, k)),
            Quantity::Time => {
                let at = self.arguments.iter().position(|argument| *argument == Argument::T)?;
                Some((1 + at, 0))
            }
            quantity => (self.arguments.iter().enumerate())
                .find_map(|(at, argument)| Some((1 + at, argument.index_of_quantity(quantity)?))),
        }
    }
}

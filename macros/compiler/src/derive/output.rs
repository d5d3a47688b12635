//! Result of the derivation: everything that code generation writes.

use crate::catalogue::{Argument, CalledFunction, DeclaredFunction, GeneratedId, MatrixStructure, Shape};
use crate::equations::PrintedEquations;
use crate::lower::Program;
use crate::mechanism::{BLOCK_LENGTH, Chart, LINK_QUANTITIES, LinkBlock, MASS_PROPERTIES, Piece, Quantity};

/// Derived function with its documentation, signature and program.
#[derive(Clone)]
pub struct Function {
    /// Identifier of the function in the catalogue.
    pub id: GeneratedId,
    /// Name of the generated function.
    pub name: String,
    /// Documentation of the function, one paragraph per entry; empty for a hidden function.
    pub docs: Vec<String>,
    /// Arguments of the generated function after `&self`.
    pub arguments: Vec<Argument>,
    /// Shape of the generated function's result.
    pub shape: Shape,
    /// Program that computes the result of the function.
    pub program: Program,
    /// Structure of its matrices: zeros, packed entries, form of an inverse.
    pub structure: MatrixStructure,
    /// Form with loops over blocks of links, if it is faster than the program for a single state.
    pub loops: Option<Box<BlockLoopDerivatives>>,
}

/// Form of the derivatives of inverse dynamics that calls loops of the runtime.
#[derive(Clone)]
pub struct BlockLoopDerivatives {
    /// Program of the quantities that the loops need (`mechanics::derivatives::blocks`), followed by the
    /// derivatives of passive forces that are not zero.
    pub program: Program,
    /// Blocks of links, parents first.
    pub blocks: Vec<LinkBlock>,
    /// True if the first block is a free root link.
    pub free: bool,
    /// For each derivative of passive forces: whether it is with respect to `v`, row, column.
    pub passive: Vec<(bool, usize, usize)>,
    /// Column and row of the entries of each matrix that the loops write and that are always zero.
    pub zeros: [Vec<(usize, usize)>; 2],
}

impl BlockLoopDerivatives {
    /// Returns the number of outputs with quantities of links, which are followed by their mass properties.
    pub fn link_quantity_output_count(&self) -> usize {
        self.blocks.len() * LINK_QUANTITIES * BLOCK_LENGTH
    }

    /// Returns the number of outputs with mass properties, which are followed by the acceleration opposite to
    /// gravity and by the derivatives of passive forces.
    pub fn mass_property_output_count(&self) -> usize {
        self.blocks.len() * MASS_PROPERTIES * BLOCK_LENGTH
    }

    fn output_count(&self) -> usize {
        self.link_quantity_output_count() + self.mass_property_output_count() + 3 + self.passive.len()
    }
}

impl Function {
    /// Returns a declared function with its program and the structure of its matrices.
    pub fn new(declared: DeclaredFunction, program: Program, structure: MatrixStructure) -> Function {
        let DeclaredFunction { id, name, docs, arguments, shape } = declared;
        Function { id, name, docs, arguments, shape, program, structure, loops: None }
    }

    /// Returns an empty function for a mechanism with an error.
    pub fn empty_function(declared: DeclaredFunction) -> Function {
        Function::new(declared, Program::default(), MatrixStructure::default())
    }

    /// Returns a hidden function that computes a part of another function.
    pub fn hidden_part_function(
        name: String,
        arguments: Vec<Argument>,
        length: usize,
        program: Program,
    ) -> Function {
        let shape = Shape::Array(length);
        Function {
            id: GeneratedId::Part,
            name,
            docs: Vec::new(),
            arguments,
            shape,
            program,
            structure: MatrixStructure::default(),
            loops: None,
        }
    }

    /// Returns true for a function that only other generated functions call.
    pub fn is_hidden(&self) -> bool {
        self.docs.is_empty()
    }

    /// Returns true if the program reads results of another function.
    pub fn reads_results_of(&self, called: CalledFunction) -> bool {
        let symbols = self.program.used_symbols();
        symbols
            .iter()
            .any(|s| Argument::Called(called).index_of_quantity(Quantity::from_symbol(*s)).is_some())
    }

    /// Returns true if the program, its version in lanes and that with loops have the expected number of
    /// outputs and read only arguments of the function.
    fn has_declared_inputs_and_outputs(&self) -> bool {
        let expected = self.shape.output_count(&self.structure);
        let programs = [Some(&self.program), self.program.simd.as_deref()].map(|p| Some((p?, expected)));
        let loops = self.loops.as_ref().map(|loops| (&loops.program, loops.output_count()));
        programs.into_iter().chain([loops]).flatten().all(|(program, expected)| {
            let uses_only_available_arguments = || {
                program
                    .used_symbols()
                    .into_iter()
                    .map(Quantity::from_symbol)
                    .all(|q| self.is_available_argument(q))
            };
            program.outputs.len() == expected && uses_only_available_arguments()
        })
    }

    /// Returns true for a quantity stored in the mechanism, for an entry of an argument, and for a result of
    /// a function that every function may call.
    fn is_available_argument(&self, quantity: Quantity) -> bool {
        let called = CalledFunction::ALL.map(Argument::Called);
        match quantity {
            Quantity::Parameter(_) | Quantity::Prepared(_) | Quantity::Time => true,
            _ => self
                .arguments
                .iter()
                .chain(&called)
                .any(|argument| argument.index_of_quantity(quantity).is_some()),
        }
    }
}

/// Functions and data that are derived from a model, from which code is emitted.
pub struct DerivationOutput {
    /// Functions to be emitted, each with its documentation, shape and program.
    pub functions: Vec<Function>,
    /// Kinematic programs of the links.
    pub links: Vec<LinkRecursionPrograms>,
    /// Kinematic programs of the named frames.
    pub frames: Vec<FrameRecursionPrograms>,
    /// First indices in `q` and `v` of each joint, with its kind of configuration space, in the order of `v`.
    pub charts: Vec<Chart>,
    /// The equations of motion for printing; empty for large mechanisms.
    pub equations: PrintedEquations,
    /// The linearised equations of every declared equilibrium.
    pub linear_equations: Vec<PrintedEquations>,
    /// Variants of functions with precomputed values, if the option `prepare` is set.
    pub prepared: Option<PreparedFunctions>,
    /// Associated constants in addition to sizes and names.
    pub constants: Vec<AssociatedConstant>,
}

impl DerivationOutput {
    /// Returns all functions, including the functions of the prepared mechanism.
    pub fn all_functions(&self) -> impl Iterator<Item = &Function> {
        self.functions.iter().chain(self.prepared.iter().flat_map(|prepared| &prepared.functions))
    }

    /// Returns the text of an operation on constants whose result is not finite, if a program contains one.
    pub fn non_finite_constant_operation(&self) -> Option<String> {
        let numbers = self.prepared.iter().map(|prepared| &prepared.numbers);
        self.all_functions()
            .map(|f| &f.program)
            .chain(numbers)
            .find_map(Program::nonfinite_constant_operation_text)
    }

    /// Returns the name of a function whose program does not fit its arguments or its result. This is an
    /// internal error, which would produce wrong code.
    pub fn function_with_mismatched_program(&self) -> Option<&str> {
        let function =
            self.all_functions().find(|f| !f.has_declared_inputs_and_outputs()).map(|f| f.name.as_str());
        let link =
            self.links.iter().any(|l| !l.has_declared_inputs_and_outputs()).then_some("the steps of a link");
        let frame =
            self.frames.iter().find(|f| !f.has_declared_inputs_and_outputs()).map(|f| f.name.as_str());
        function.or(link).or(frame)
    }
}

/// Functions of the option `prepare`.
pub struct PreparedFunctions {
    /// Program of the precomputed values, as functions of the parameters.
    pub numbers: Program,
    /// Functions of the state and the precomputed values.
    pub functions: Vec<Function>,
}

/// Number of entries of a placement: a rotation matrix row by row, and a position.
pub const PLACEMENT: usize = 12;
/// Number of entries of a twist, or of its rate.
pub const TWIST: usize = 6;

/// Programs for the placement, twist and acceleration of one link from those of its parent.
pub struct LinkRecursionPrograms {
    /// Parent link; `None` for the ground.
    pub parent: Option<usize>,
    /// Indices in `v` of the degrees of freedom of its joint.
    pub velocities: Vec<usize>,
    /// True if the motion subspace depends on the configuration.
    pub driven: bool,
    /// Program of the link's placement from its parent's placement.
    pub placement: Program,
    /// Program of the link's twist from its parent's twist.
    pub twist: Program,
    /// Program of the link's acceleration from its parent's twist and acceleration.
    pub acceleration: Program,
    /// Columns of a Jacobian from the link's placement and the frame's position.
    pub columns: Program,
}

impl LinkRecursionPrograms {
    fn has_declared_inputs_and_outputs(&self) -> bool {
        [&self.placement, &self.twist, &self.acceleration, &self.columns]
            .map(|program| program.outputs.len())
            .eq(&[PLACEMENT, TWIST, TWIST, TWIST * self.velocities.len()])
    }
}

/// Programs for the placement and twist of a named frame from those of its link.
pub struct FrameRecursionPrograms {
    /// Name of the frame.
    pub name: String,
    /// Link in which the frame is fixed; `None` for the ground.
    pub link: Option<usize>,
    /// True if the frame is the link's own frame.
    pub is_link: bool,
    /// Program of the frame's placement from its link's placement.
    pub placement: Program,
    /// Twist in ground axes from the link's placement and twist.
    pub twist: Program,
    /// Acceleration in ground axes from the link's placement, twist and acceleration.
    pub acceleration: Program,
}

impl FrameRecursionPrograms {
    fn has_declared_inputs_and_outputs(&self) -> bool {
        [&self.placement, &self.twist, &self.acceleration].map(|program| program.outputs.len())
            == [PLACEMENT, TWIST, TWIST]
    }
}

/// Associated constant of the generated type that is a list.
pub struct AssociatedConstant {
    /// Name of the constant.
    pub name: &'static str,
    /// Documentation of the constant.
    pub docs: &'static str,
    /// Type of the items of the constant.
    pub item: &'static str,
    /// Source text of each item of the constant.
    pub list: Vec<String>,
}

impl AssociatedConstant {
    fn string_list_constant(name: &'static str, docs: &'static str, list: &[String]) -> AssociatedConstant {
        AssociatedConstant {
            name,
            docs,
            item: "&'static str",
            list: list.iter().map(|s| format!("{s:?}")).collect(),
        }
    }

    /// Returns the lists of names for the option `regressor`.
    pub fn regressor_name_constants(bodies: &[String], base: &[String]) -> Vec<AssociatedConstant> {
        vec![
            AssociatedConstant::string_list_constant(
                "BODIES",
                "Name of the body of each group of ten standard parameters, which include everything fixed \
                 to it.",
                bodies,
            ),
            AssociatedConstant::string_list_constant(
                "BASE_PARAMETERS",
                "Name of each base parameter: the link parameter, in the frame of its joint, that represents \
                 the combination.",
                base,
            ),
        ]
    }

    /// Returns the list of the rows and columns of the entries for the option `packed`.
    pub fn packed_entries_constant(list: &[(usize, usize)]) -> AssociatedConstant {
        AssociatedConstant {
            name: "MASS_MATRIX_ENTRIES",
            docs: "Row and column of every entry of `mass_matrix_packed`: the lower triangle of the mass \
                   matrix without entries that are always zero.",
            item: "(usize, usize)",
            list: list.iter().map(|entry| format!("{entry:?}")).collect(),
        }
    }

    /// Returns the list of the coordinates that the option `routh` eliminates.
    pub fn cyclic_coordinate_constant(list: &[usize]) -> AssociatedConstant {
        AssociatedConstant {
            name: "CYCLIC",
            docs: "Index in `v` of the velocity of each cyclic coordinate. The Lagrangian does not depend on \
                   a cyclic coordinate, for any values of the parameters, and only inputs change its \
                   momentum.",
            item: "usize",
            list: list.iter().map(ToString::to_string).collect(),
        }
    }

    /// Returns the list of the names of the conserved quantities.
    pub fn conserved_names_constant(list: &[String]) -> AssociatedConstant {
        AssociatedConstant::string_list_constant(
            "CONSERVED",
            "Name of every entry of [`conserved`](Self::conserved): a quantity that is constant in every \
             motion without inputs, for any values of the parameters. The energy, Jacobi's integral and \
             momenta are tried.",
            list,
        )
    }

    /// Returns the lists of the linearised equations of declared equilibria, each with its name; empty
    /// without equilibria.
    pub fn linear_equation_constants(all: &[(String, PrintedEquations)]) -> Vec<AssociatedConstant> {
        if all.is_empty() {
            return Vec::new();
        }
        let collect_text_parts =
            |part: fn(&(String, PrintedEquations)) -> String| all.iter().map(part).collect::<Vec<String>>();
        vec![
            AssociatedConstant::string_list_constant(
                "EQUILIBRIA",
                "Name of every declared equilibrium.",
                &collect_text_parts(|(name, _)| name.clone()),
            ),
            AssociatedConstant::string_list_constant(
                "LINEAR_EQUATIONS",
                "The equations of motion to first order about every equilibrium of `EQUILIBRIA`, as text in \
                 the parameters of the mechanism: the state at rest, the equations and, for at most three \
                 velocities and degree seven, the characteristic equation with the conditions of stability.",
                &collect_text_parts(|(_, written)| written.plain.clone()),
            ),
            AssociatedConstant::string_list_constant(
                "LINEAR_EQUATIONS_LATEX",
                "[`LINEAR_EQUATIONS`](Self::LINEAR_EQUATIONS) as LaTeX: an `aligned` environment of \
                 `amsmath` each.",
                &collect_text_parts(|(_, written)| written.latex.clone()),
            ),
        ]
    }

    /// Returns the list of the pieces of the drawing, for the option `drawing`.
    pub fn drawing_pieces_constant(pieces: &[Piece<'_>]) -> AssociatedConstant {
        let mut first = 0;
        let written = pieces.iter().map(|piece| {
            first += piece.numbers.len();
            let Piece { name, role, kind, frames: [a, b], .. } = piece;
            let rust_option_of_frame_index = |frame: &Option<usize>| match frame {
                Some(k) => format!("::core::option::Option::Some({k})"),
                None => "::core::option::Option::None".to_string(),
            };
            let at = first - piece.numbers.len();
            format!(
                "::linkwork::drawing::Piece {{ name: {name:?}, role: ::linkwork::drawing::Role::{role:?}, \
                 kind: ::linkwork::drawing::Kind::{kind:?}, frames: [{}, {}], first: {at} }}",
                rust_option_of_frame_index(a),
                rust_option_of_frame_index(b)
            )
        });
        AssociatedConstant {
            name: "DRAWING",
            docs: "Geometry of the mechanism for drawings, an entry for each solid, surface, joint, force \
                   element and input.",
            item: "::linkwork::drawing::Piece",
            list: written.collect(),
        }
    }

    /// Returns the list of the names of the parameters.
    pub fn parameter_names_constant(list: &[String]) -> AssociatedConstant {
        AssociatedConstant::string_list_constant("PARAMETERS", "Name of every parameter of the struct.", list)
    }
}

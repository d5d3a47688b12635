//! What is derived: everything that emission writes.

use crate::catalogue::{Argument, Called, Declared, Id, Shape, Structure};
use crate::equations::Written;
use crate::lower::Program;
use crate::mechanism::{Chart, Piece, Quantity};

/// A generated function.
#[derive(Clone)]
pub struct Function {
    /// Which it is.
    pub id: Id,
    /// Its name.
    pub name: String,
    /// Documentation, a paragraph each; none for a hidden function.
    pub docs: Vec<String>,
    /// Arguments after `&self`.
    pub arguments: Vec<Argument>,
    /// Result.
    pub shape: Shape,
    /// What it computes.
    pub program: Program,
    /// What is known of its matrices.
    pub structure: Structure,
}

impl Function {
    /// A function with its program and with what is known of its matrices.
    pub fn new(declared: Declared, program: Program, structure: Structure) -> Function {
        let Declared { id, name, docs, arguments, shape } = declared;
        Function { id, name, docs, arguments, shape, program, structure }
    }

    /// A function of a mechanism with a mistake, which does nothing.
    pub fn stub(declared: Declared) -> Function {
        Function::new(declared, Program::default(), Structure::default())
    }

    /// A hidden part of what is written as it is.
    pub fn part(name: String, arguments: Vec<Argument>, length: usize, program: Program) -> Function {
        let shape = Shape::Array(length);
        Function {
            id: Id::Part,
            name,
            docs: Vec::new(),
            arguments,
            shape,
            program,
            structure: Structure::default(),
        }
    }

    /// True for a function that only others call.
    pub fn is_hidden(&self) -> bool {
        self.docs.is_empty()
    }

    /// True if its program, and the one in lanes, has as many outputs as the result takes, and reads its arguments alone.
    fn is_whole(&self) -> bool {
        let expected = self.shape.outputs(&self.structure);
        let programs = [Some(&self.program), self.program.simd.as_deref()];
        programs.into_iter().flatten().all(|program| {
            let reads_arguments =
                || program.symbols().into_iter().map(Quantity::of).all(|q| self.is_given(q));
            program.outputs.len() == expected && reads_arguments()
        })
    }

    /// True for what the mechanism itself has, for an entry of an argument, and for a result of what all functions may call.
    fn is_given(&self, quantity: Quantity) -> bool {
        let called = Called::ALL.map(Argument::Called);
        match quantity {
            Quantity::Parameter(_) | Quantity::Prepared(_) | Quantity::Time => true,
            _ => self.arguments.iter().chain(&called).any(|argument| argument.index(quantity).is_some()),
        }
    }
}

/// Everything that is derived from a model.
pub struct Output {
    /// The generated functions.
    pub functions: Vec<Function>,
    /// Steps of the links.
    pub links: Vec<LinkSteps>,
    /// Steps of the frames.
    pub frames: Vec<FrameSteps>,
    /// First entries in `q` and `v` of each joint, with its kind of configuration space, in the order of `v`.
    pub charts: Vec<Chart>,
    /// The equations of motion for reading; empty for large mechanisms.
    pub equations: Written,
    /// The linear equations of every declared equilibrium.
    pub linear_equations: Vec<Written>,
    /// The functions of numbers that are computed before, if they were asked for.
    pub prepared: Option<Prepared>,
    /// Further constants.
    pub constants: Vec<Constant>,
}

impl Output {
    /// All functions, those of the prepared mechanism included.
    pub fn all_functions(&self) -> impl Iterator<Item = &Function> {
        self.functions.iter().chain(self.prepared.iter().flat_map(|prepared| &prepared.functions))
    }

    /// A part of a program that is no number wherever the mechanism is, as it is written.
    pub fn undefined(&self) -> Option<String> {
        let numbers = self.prepared.iter().map(|prepared| &prepared.numbers);
        self.all_functions().map(|f| &f.program).chain(numbers).find_map(Program::undefined)
    }

    /// The name of a function whose program does not fit its arguments or its result: a mistake of the compiler's, which would make wrong code.
    pub fn misfit(&self) -> Option<&str> {
        let function = self.all_functions().find(|f| !f.is_whole()).map(|f| f.name.as_str());
        let link = self.links.iter().any(|l| !l.is_whole()).then_some("the steps of a link");
        let frame = self.frames.iter().find(|f| !f.is_whole()).map(|f| f.name.as_str());
        function.or(link).or(frame)
    }
}

/// The functions of the word `prepare`.
pub struct Prepared {
    /// The numbers, of the parameters.
    pub numbers: Program,
    /// Functions of the state and the numbers.
    pub functions: Vec<Function>,
}

/// Numbers of a placement: a rotation matrix row by row, and a position.
pub const PLACEMENT: usize = 12;
/// Numbers of a twist, or of its rate.
pub const TWIST: usize = 6;

/// The steps of one link.
pub struct LinkSteps {
    /// Parent link.
    pub parent: Option<usize>,
    /// Entries of `v` of its degrees of freedom.
    pub velocities: Vec<usize>,
    /// Its motion subspace depends on the configuration.
    pub driven: bool,
    /// Placement from the parent's.
    pub placement: Program,
    /// Twist from the parent's.
    pub twist: Program,
    /// Acceleration from the parent's twist and acceleration.
    pub acceleration: Program,
    /// Columns of a Jacobian from the link's placement and the frame's position.
    pub columns: Program,
}

impl LinkSteps {
    fn is_whole(&self) -> bool {
        [&self.placement, &self.twist, &self.acceleration, &self.columns]
            .map(|program| program.outputs.len())
            .eq(&[PLACEMENT, TWIST, TWIST, TWIST * self.velocities.len()])
    }
}

/// The steps of one frame on its link.
pub struct FrameSteps {
    /// Its name.
    pub name: String,
    /// The link that carries it.
    pub link: Option<usize>,
    /// True if the frame is the link's own.
    pub is_link: bool,
    /// Placement from the link's.
    pub placement: Program,
    /// Twist in ground axes from the link's placement and twist.
    pub twist: Program,
    /// Acceleration in ground axes from the link's placement, twist and acceleration.
    pub acceleration: Program,
}

impl FrameSteps {
    fn is_whole(&self) -> bool {
        [&self.placement, &self.twist, &self.acceleration].map(|program| program.outputs.len())
            == [PLACEMENT, TWIST, TWIST]
    }
}

/// An associated constant: a list.
pub struct Constant {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub docs: &'static str,
    /// The type of an item.
    pub item: &'static str,
    /// The items as they are written.
    pub list: Vec<String>,
}

impl Constant {
    fn strings(name: &'static str, docs: &'static str, list: &[String]) -> Constant {
        Constant { name, docs, item: "&'static str", list: list.iter().map(|s| format!("{s:?}")).collect() }
    }

    /// The lists of names that go with the word `regressor`.
    pub fn regressor(bodies: &[String], base: &[String]) -> Vec<Constant> {
        vec![
            Constant::strings(
                "BODIES",
                "Name of the body that every ten standard parameters belong to, with all that is fixed to it.",
                bodies,
            ),
            Constant::strings(
                "BASE_PARAMETERS",
                "Name of every base parameter: the parameter of a link, about the frame of its joint, that stands for the combination.",
                base,
            ),
        ]
    }

    /// Where the entries stand that the word `packed` gives.
    pub fn entries(list: &[(usize, usize)]) -> Constant {
        Constant {
            name: "MASS_MATRIX_ENTRIES",
            docs: "Row and column of every entry of `mass_matrix_packed`: the lower triangle of the mass matrix without what is always zero.",
            item: "(usize, usize)",
            list: list.iter().map(|entry| format!("{entry:?}")).collect(),
        }
    }

    /// Which coordinates the word `routh` eliminates.
    pub fn cyclic(list: &[usize]) -> Constant {
        Constant {
            name: "CYCLIC",
            docs: "Index in `v` of the velocity of every cyclic coordinate: those on which the Lagrangian does not depend, whatever the parameters are, and whose momenta only inputs change.",
            item: "usize",
            list: list.iter().map(ToString::to_string).collect(),
        }
    }

    /// The names of what is conserved.
    pub fn conserved(list: &[String]) -> Constant {
        Constant::strings(
            "CONSERVED",
            "Name of every entry of [`conserved`](Self::conserved): what keeps its value in every motion without inputs, whatever the parameters are. Found by trying energy, Jacobi's integral and momenta.",
            list,
        )
    }

    /// The linear equations of declared equilibria: the name of each, and what is written; none without.
    pub fn linear_equations(all: &[(String, Written)]) -> Vec<Constant> {
        if all.is_empty() {
            return Vec::new();
        }
        let of = |part: fn(&(String, Written)) -> String| all.iter().map(part).collect::<Vec<String>>();
        vec![
            Constant::strings(
                "EQUILIBRIA",
                "Name of every declared equilibrium.",
                &of(|(name, _)| name.clone()),
            ),
            Constant::strings(
                "LINEAR_EQUATIONS",
                "The equations of motion to first order about every equilibrium of `EQUILIBRIA`, as text in the parameters of the mechanism: what is at rest, the equations, and of up to three velocities the characteristic equation with the conditions of stability.",
                &of(|(_, written)| written.plain.clone()),
            ),
            Constant::strings(
                "LINEAR_EQUATIONS_LATEX",
                "[`LINEAR_EQUATIONS`](Self::LINEAR_EQUATIONS) as LaTeX: an `aligned` environment of `amsmath` each.",
                &of(|(_, written)| written.latex.clone()),
            ),
        ]
    }

    /// What the word `drawing` gives.
    pub fn drawing(pieces: &[Piece<'_>]) -> Constant {
        let mut first = 0;
        let written = pieces.iter().map(|piece| {
            first += piece.numbers.len();
            let Piece { name, role, kind, frames: [a, b], .. } = piece;
            let frame = |frame: &Option<usize>| match frame {
                Some(k) => format!("::core::option::Option::Some({k})"),
                None => "::core::option::Option::None".to_string(),
            };
            let at = first - piece.numbers.len();
            format!(
                "::linkwork::drawing::Piece {{ name: {name:?}, role: ::linkwork::drawing::Role::{role:?}, kind: ::linkwork::drawing::Kind::{kind:?}, frames: [{}, {}], first: {at} }}",
                frame(a),
                frame(b)
            )
        });
        Constant {
            name: "DRAWING",
            docs: "What the mechanism looks like, piece by piece: solids, surfaces, joints, force elements, inputs.",
            item: "::linkwork::drawing::Piece",
            list: written.collect(),
        }
    }

    /// The names of the parameters.
    pub fn parameters(list: &[String]) -> Constant {
        Constant::strings("PARAMETERS", "Name of every parameter of the struct.", list)
    }
}

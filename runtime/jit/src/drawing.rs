//! Drawings of loaded mechanisms as data, for programs that render them.

use crate::error::Error;
use crate::load::Loader;
use crate::robot::Robot;
use linkwork::drawing::{Kind, Piece, Role};
use linkwork_compiler::compile_with_passes;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::{Graph, Lookup, Symbol};
use linkwork_compiler::lower::{Program, lower};
use linkwork_compiler::mechanism::{self, PieceShape, Quantity, SuppliedQuantity};
use linkwork_compiler::passes::PassSelection;
use std::collections::HashSet;
use std::sync::Mutex;

/// Drawing of a mechanism, whose frames are the frames of the robot.
#[derive(Clone, Debug)]
pub struct Drawing {
    pieces: Vec<Piece>,
    numbers: Program,
    heights: Program,
}

impl Loader {
    /// Returns the drawing of the mechanism, which [`load`](Self::load) leaves out.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn drawing(self) -> Result<Drawing, Error> {
        Loader::run_on_compiler_thread(move || self.compile_drawing())
    }

    fn compile_drawing(&self) -> Result<Drawing, Error> {
        let mut source = self.read_source()?;
        let requests = &mut source.mechanism.requests;
        (requests.prepare, requests.batch, requests.packed) = (false, false, false);
        (requests.drawing, requests.derivatives) = (true, false);
        let (graph, cx) = (Graph::new(), &mut Diagnostics::new());
        let passes = PassSelection { lanes: false, ..PassSelection::default() };
        let compiled = compile_with_passes(&source, &graph, passes, cx);
        let Some((model, _)) = compiled.filter(|_| cx.is_empty()) else {
            return Err(self.error_from_diagnostics(cx));
        };
        let (mut pieces, mut numbers) = (Vec::new(), Vec::new());
        for piece in &model.drawing {
            pieces.push(convert_piece(piece, numbers.len()));
            numbers.extend(piece.numbers.iter().copied());
        }
        Ok(Drawing { pieces, numbers: lower(&numbers), heights: lower(&model.heights) })
    }
}

impl Drawing {
    /// Returns the pieces of the drawing, in the order of their declaration.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Returns the numbers of all pieces, m and rad, for the values of the parameters of a robot.
    #[must_use]
    pub fn numbers(&self, robot: &Robot) -> Vec<f64> {
        evaluate_program(&self.numbers, robot, [f64::NAN; 2])
    }

    /// Returns the height of each terrain in the drawing, m, at a position along the terrain's first two
    /// axes, m.
    #[must_use]
    pub fn heights(&self, robot: &Robot, position: [f64; 2]) -> Vec<f64> {
        evaluate_program(&self.heights, robot, position)
    }
}

fn evaluate_program(program: &Program, robot: &Robot, given: [f64; 2]) -> Vec<f64> {
    let value_of_symbol = |symbol: Symbol| {
        let value = match Quantity::from_symbol(symbol) {
            Quantity::Parameter(k) => robot.parameter_values().get(k),
            Quantity::Given(SuppliedQuantity::Position, k) => given.get(k),
            _ => None,
        };
        value.copied().unwrap_or(f64::NAN)
    };
    let value_of_table = |lookup: Lookup, x| {
        let orders = [0, 1, 2].map(|k| lookup.derivative_order(k) as u8);
        robot
            .interpolation_tables()
            .get(lookup.table_index())
            .map_or(f64::NAN, |table| table.value_or_derivative(x, orders))
    };
    program.interpret_with_tables(&value_of_symbol, &value_of_table)
}

/// Converts a piece of the compiler's drawing to one of the runtime, whose numbers begin at index `first`.
/// The texts in it are never freed.
pub fn convert_piece(piece: &mechanism::Piece<'_>, first: usize) -> Piece {
    Piece {
        name: intern_text(&piece.name),
        role: convert_drawing_role(piece.role),
        kind: convert_piece_kind(&piece.kind),
        frames: piece.frames,
        first,
    }
}

/// Returns a text with static lifetime. Equal texts are stored once and never freed.
fn intern_text(text: &str) -> &'static str {
    static TEXTS: Mutex<Option<HashSet<&'static str>>> = Mutex::new(None);
    let mut texts = TEXTS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let texts = texts.get_or_insert_default();
    if let Some(known) = texts.get(text) {
        return known;
    }
    let new: &'static str = String::leak(text.to_string());
    texts.insert(new);
    new
}

fn convert_drawing_role(role: mechanism::ShownObjectKind) -> Role {
    match role {
        mechanism::ShownObjectKind::Body => Role::Body,
        mechanism::ShownObjectKind::Link => Role::Link,
        mechanism::ShownObjectKind::Visual => Role::Visual,
        mechanism::ShownObjectKind::Joint => Role::Joint,
        mechanism::ShownObjectKind::Surface => Role::Surface,
        mechanism::ShownObjectKind::Element => Role::Element,
        mechanism::ShownObjectKind::Input => Role::Input,
        mechanism::ShownObjectKind::Gravity => Role::Gravity,
    }
}

fn convert_piece_kind(kind: &PieceShape) -> Kind {
    match kind {
        PieceShape::Rod => Kind::Rod,
        PieceShape::Ring => Kind::Ring,
        PieceShape::Disk => Kind::Disk,
        PieceShape::Cylinder => Kind::Cylinder,
        PieceShape::Tube => Kind::Tube,
        PieceShape::Cone => Kind::Cone,
        PieceShape::Capsule => Kind::Capsule,
        PieceShape::Sphere => Kind::Sphere,
        PieceShape::Cuboid => Kind::Cuboid,
        PieceShape::Ellipsoid => Kind::Ellipsoid,
        PieceShape::Inertia => Kind::Inertia,
        PieceShape::Plane => Kind::Plane,
        PieceShape::Funnel => Kind::Funnel,
        PieceShape::Pipe => Kind::Pipe,
        PieceShape::Torus => Kind::Torus,
        PieceShape::Bowl => Kind::Bowl,
        PieceShape::Point => Kind::Point,
        PieceShape::Bar => Kind::Bar,
        PieceShape::Hinge => Kind::Hinge,
        PieceShape::Slide => Kind::Slide,
        PieceShape::Ball => Kind::Ball,
        PieceShape::Coil => Kind::Coil,
        PieceShape::Spiral => Kind::Spiral,
        PieceShape::Damper => Kind::Damper,
        PieceShape::Brake => Kind::Brake,
        PieceShape::Force(k) => Kind::Force(*k),
        PieceShape::Torque(k) => Kind::Torque(*k),
        PieceShape::Gravity => Kind::Gravity,
        PieceShape::Terrain(k) => Kind::Terrain(*k),
        PieceShape::Mesh(path) => Kind::Mesh(intern_text(path)),
    }
}

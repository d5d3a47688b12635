//! Frames: programs of placements, velocities, accelerations and Jacobians, composed of the steps of
//! the links between the ground and a frame.

use crate::functions::{LoadedFunction, Matrix, ResultAssembly};
use crate::merge::ProgramMerger;
use crate::routine::Routine;
use linkwork_compiler::catalogue::{Argument, GeneratedId};
use linkwork_compiler::derive::{
    DerivationOutput, FrameRecursionPrograms, LinkRecursionPrograms, PLACEMENT, TWIST,
};
use linkwork_compiler::lower::{Op, Operand, Program};
use linkwork_compiler::mechanism::{Model, Quantity, SuppliedQuantity};

/// Kinematic quantity of a frame: placement, velocity, acceleration or Jacobian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrameQuantity {
    Placement,
    Velocity,
    Acceleration,
    Jacobian,
}

impl FrameQuantity {
    /// All kinematic quantities of a frame, in the order of their functions.
    pub const ALL: [FrameQuantity; 4] = [
        FrameQuantity::Placement,
        FrameQuantity::Velocity,
        FrameQuantity::Acceleration,
        FrameQuantity::Jacobian,
    ];

    fn frame_function_name(self) -> &'static str {
        match self {
            FrameQuantity::Placement => "frame_placement",
            FrameQuantity::Velocity => "frame_velocity",
            FrameQuantity::Acceleration => "frame_acceleration",
            FrameQuantity::Jacobian => "frame_jacobian",
        }
    }

    fn frame_function_documentation(self, frame: &str) -> String {
        match self {
            FrameQuantity::Placement => format!(
                "Placement of `{frame}` in the ground: the rotation matrix from the axes of the frame to \
                 those of the ground, and the position of the origin, m."
            ),
            FrameQuantity::Velocity => format!(
                "Velocity of `{frame}` relative to the ground, in ground axes: of the origin, m/s, then \
                 angular, rad/s."
            ),
            FrameQuantity::Acceleration => format!(
                "Acceleration of `{frame}` relative to the ground, in ground axes, without gravity: of the \
                 origin, m/s², then angular, rad/s²."
            ),
            FrameQuantity::Jacobian => {
                format!(
                    "Jacobian of `{frame}`: its product with `v` is the velocity of the frame, but for \
                     motions prescribed in time."
                )
            }
        }
    }
}

/// Programs of the kinematics of each link and frame, from parent to child, of which functions of frames are
/// composed.
pub(crate) struct Frames {
    pub names: Vec<String>,
    links: Vec<LinkRecursionPrograms>,
    frames: Vec<FrameRecursionPrograms>,
    /// Programs of a mechanism with generalized speeds: the joint velocities, the joint accelerations, and
    /// the matrix from speeds to joint velocities.
    speeds: Option<[Program; 3]>,
    nv: usize,
}

impl Frames {
    /// Takes the kinematic programs of links and frames from the compiler's output.
    pub fn new(model: &Model<'_>, output: &mut DerivationOutput) -> Frames {
        let program_of_function =
            |id: GeneratedId| output.functions.iter().find(|f| f.id == id).map(|f| f.program.clone());
        let speeds = [GeneratedId::RatesOfSpeeds, GeneratedId::RateAccelerations, GeneratedId::RateMatrix]
            .map(program_of_function);
        let speeds = match speeds {
            [Some(rates), Some(accelerations), Some(matrix)] => Some([rates, accelerations, matrix]),
            _ => None,
        };
        let frames = std::mem::take(&mut output.frames);
        Frames {
            names: frames.iter().map(|frame| frame.name.clone()).collect(),
            links: std::mem::take(&mut output.links),
            frames,
            speeds,
            nv: model.nv(),
        }
    }

    /// Returns the functions of all frames: placement, velocity, acceleration and Jacobian of each frame.
    pub fn frame_function_entries(&self, time: bool) -> Vec<LoadedFunction> {
        let functions_of_frame = |frame: usize| {
            FrameQuantity::ALL.into_iter().filter_map(move |access| {
                use Argument::{A, Q, T, V};
                let state: &[Argument] = match access {
                    FrameQuantity::Placement | FrameQuantity::Jacobian => &[Q],
                    FrameQuantity::Velocity => &[Q, V],
                    FrameQuantity::Acceleration => &[Q, V, A],
                };
                let arguments: Vec<Argument> =
                    time.then_some(T).into_iter().chain(state.iter().copied()).collect();
                let result_matrix_shape = |name, rows, columns| Matrix { name, rows, columns };
                let results = match access {
                    FrameQuantity::Placement => {
                        vec![result_matrix_shape("rotation", 3, 3), result_matrix_shape("position", 3, 1)]
                    }
                    FrameQuantity::Jacobian => vec![result_matrix_shape("result", TWIST, self.nv)],
                    FrameQuantity::Velocity | FrameQuantity::Acceleration => {
                        vec![result_matrix_shape("result", TWIST, 1)]
                    }
                };
                let length = results.iter().map(Matrix::length).sum();
                let routine = Routine::routine_built_on_demand(&arguments, length)?;
                let name = &self.names[frame];
                let plan = ResultAssembly::Frame(access, frame, routine);
                let documentation = access.frame_function_documentation(name);
                let rank =
                    if matches!(access, FrameQuantity::Placement | FrameQuantity::Jacobian) { 2 } else { 1 };
                let name = format!("{}({name})", access.frame_function_name());
                Some(LoadedFunction {
                    rank,
                    ..LoadedFunction::new(&name, documentation, arguments, results, plan)
                })
            })
        };
        (0..self.names.len()).flat_map(functions_of_frame).collect()
    }

    /// Returns the indices of the links on the path from the ground to a frame, the link nearest to the
    /// ground first.
    fn links_to_frame(&self, frame: usize) -> Vec<usize> {
        let parent_link = |link: &usize| self.links[*link].parent;
        let mut path: Vec<usize> = std::iter::successors(self.frames[frame].link, parent_link).collect();
        path.reverse();
        path
    }

    /// Returns the moving link that carries a frame; `None` for the ground.
    pub fn link_of_frame(&self, frame: usize) -> Option<usize> {
        self.frames[frame].link
    }

    /// Returns the indices of the velocities that move a frame, in increasing order.
    pub fn velocities_of_frame(&self, frame: usize) -> Vec<usize> {
        if self.speeds.is_some() {
            return (0..self.nv).collect();
        }
        let links = self.links_to_frame(frame).into_iter().map(|link| &self.links[link]);
        let mut velocities: Vec<usize> = links.flat_map(|link| link.velocities.iter().copied()).collect();
        velocities.sort_unstable();
        velocities.dedup();
        velocities
    }

    /// Returns the program that computes the placements of all frames: for each frame a rotation matrix row
    /// by row, and a position.
    pub fn frame_placements_program(&self) -> Program {
        let mut merged = ProgramMerger::default();
        let mut links: Vec<Option<Vec<Operand>>> = vec![None; self.links.len()];
        let mut outputs = Vec::new();
        for (frame, steps) in self.frames.iter().enumerate() {
            let mut placement = ground_placement();
            for link in self.links_to_frame(frame) {
                placement = links[link]
                    .get_or_insert_with(|| {
                        append_program_with_inputs(&mut merged, &[&placement], &self.links[link].placement)
                    })
                    .clone();
            }
            outputs.extend(append_program_with_inputs(&mut merged, &[&placement], &steps.placement));
        }
        merged.finish(outputs)
    }

    /// Returns the program that computes a kinematic quantity of a frame.
    pub fn program(&self, access: FrameQuantity, frame: usize) -> Program {
        let mut merged = ProgramMerger::default();
        if let Some([rates, accelerations, _]) = &self.speeds {
            // Steps are in joint velocities. Both programs take speeds: they come before the exchange.
            let accelerations = match access {
                FrameQuantity::Acceleration => merged.append_program(accelerations),
                _ => Vec::new(),
            };
            let rates = merged.append_program(rates);
            for (k, rate) in rates.into_iter().enumerate() {
                merged.bind_symbol(Quantity::Velocity(k).symbol(), rate);
            }
            for (k, acceleration) in accelerations.into_iter().enumerate() {
                merged.bind_symbol(Quantity::Acceleration(k).symbol(), acceleration);
            }
        }
        let mut placement = ground_placement();
        let mut twist = vec![Operand::Const(0.0); TWIST];
        let mut acceleration = twist.clone();
        let mut placements = Vec::new();
        let path: Vec<&LinkRecursionPrograms> =
            self.links_to_frame(frame).into_iter().map(|link| &self.links[link]).collect();
        for link in &path {
            placement = append_program_with_inputs(&mut merged, &[&placement], &link.placement);
            placements.push(placement.clone());
            if access == FrameQuantity::Acceleration {
                acceleration =
                    append_program_with_inputs(&mut merged, &[&twist, &acceleration], &link.acceleration);
            }
            if matches!(access, FrameQuantity::Velocity | FrameQuantity::Acceleration) {
                twist = append_program_with_inputs(&mut merged, &[&twist], &link.twist);
            }
        }
        let steps = &self.frames[frame];
        let outputs = match access {
            FrameQuantity::Placement => {
                let placed = append_program_with_inputs(&mut merged, &[&placement], &steps.placement);
                // Steps have rotations row by row.
                let rotation = (0..9).map(|k| placed[3 * (k % 3) + k / 3]);
                rotation.chain(placed[9..].iter().copied()).collect()
            }
            FrameQuantity::Velocity => {
                append_program_with_inputs(&mut merged, &[&placement, &twist], &steps.twist)
            }
            FrameQuantity::Acceleration => append_program_with_inputs(
                &mut merged,
                &[&placement, &twist, &acceleration],
                &steps.acceleration,
            ),
            FrameQuantity::Jacobian => {
                let placed = append_program_with_inputs(&mut merged, &[&placement], &steps.placement);
                let mut jacobian = vec![Operand::Const(0.0); TWIST * self.nv];
                for (link, placement) in path.iter().zip(&placements) {
                    for (k, value) in placed[9..].iter().enumerate() {
                        merged.bind_symbol(Quantity::Given(SuppliedQuantity::Origin, k).symbol(), *value);
                    }
                    let columns = append_program_with_inputs(&mut merged, &[placement], &link.columns);
                    for (column, v) in columns.chunks_exact(TWIST).zip(&link.velocities) {
                        for (i, entry) in column.iter().enumerate() {
                            // Joints that follow one coordinate share a column.
                            let at = TWIST * v + i;
                            jacobian[at] = sum_of_operands(&mut merged, jacobian[at], *entry);
                        }
                    }
                }
                self.jacobian_in_speeds(&mut merged, jacobian)
            }
        };
        merged.finish(outputs)
    }

    /// Multiplies a Jacobian by the matrix from generalized speeds to joint velocities, if the mechanism
    /// declares speeds.
    fn jacobian_in_speeds(&self, merged: &mut ProgramMerger, jacobian: Vec<Operand>) -> Vec<Operand> {
        let Some([.., matrix]) = &self.speeds else { return jacobian };
        let matrix = merged.append_program(matrix);
        let mut product = vec![Operand::Const(0.0); TWIST * self.nv];
        for j in 0..self.nv {
            for i in 0..TWIST {
                for k in 0..self.nv {
                    let (a, b) = (jacobian[TWIST * k + i], matrix[j * self.nv + k]);
                    let at = TWIST * j + i;
                    product[at] = match (a, b) {
                        (Operand::Const(0.0), _) | (_, Operand::Const(0.0)) => continue,
                        (a, b) => merged.push(Op::MulAdd(a, b, product[at])),
                    };
                }
            }
        }
        product
    }
}

/// Returns the placement of the ground: the identity rotation and a zero position, as constants.
fn ground_placement() -> Vec<Operand> {
    (0..PLACEMENT).map(|k| Operand::Const(f64::from(u8::from(k < 9 && k % 4 == 0)))).collect()
}

/// Appends a program that takes kinematic quantities of the parent as inputs, which are bound to `values`.
/// Returns the outputs of the program.
fn append_program_with_inputs(
    merged: &mut ProgramMerger,
    values: &[&[Operand]],
    program: &Program,
) -> Vec<Operand> {
    for (k, value) in values.iter().copied().flatten().enumerate() {
        merged.bind_symbol(Quantity::Given(SuppliedQuantity::Parent, k).symbol(), *value);
    }
    merged.append_program(program)
}

fn sum_of_operands(merged: &mut ProgramMerger, a: Operand, b: Operand) -> Operand {
    match (a, b) {
        (Operand::Const(0.0), other) | (other, Operand::Const(0.0)) => other,
        (a, b) => merged.push(Op::Add(a, b)),
    }
}

//! Generated functions and the generic implementation of the same functions, on the same random states.

use crate::generic::{Model, Options, Workspace};
use crate::operations::{CompiledMechanism, FunctionOperationCounts};
use crate::robots::Panda;
use crate::states::{STATES, State, random_states};
use linkwork::{Mechanism, frame};
use linkwork_models::{PandaArm, SimpleHumanoid, Solo12, Ur5};
use nalgebra::{DMatrix, DVector, Matrix6xX, SMatrix, SVector};
use std::hint::black_box;
use std::rc::Rc;

/// Function of a robot in both implementations. The closures take the index of a state.
pub struct ImplementationPair {
    /// Name of the measured function.
    pub function: &'static str,
    /// Closure that calls the generated function at one of the states.
    pub generated: Box<dyn FnMut(usize)>,
    /// Closure that calls the generic implementation at one of the states.
    pub generic: Box<dyn FnMut(usize)>,
    /// Closure that returns the largest difference of both results, relative to one plus their magnitude.
    pub difference: Box<dyn FnMut(usize) -> f64>,
    /// Size of the generated function, in operations.
    pub size: FunctionOperationCounts,
}

/// Robot with its functions in both implementations.
pub struct ComparedRobot {
    /// Name of the robot.
    pub name: &'static str,
    /// Measured functions of the robot, each in both implementations.
    pub pairs: Vec<ImplementationPair>,
}

/// Returns all robots of the comparison of generated and generic code.
pub fn compared_robots() -> Vec<ComparedRobot> {
    macro_rules! robot {
        ($name:literal, $robot:ident, $file:literal, $arguments:literal, $options:expr, $frame:literal) => {{
            let source = RobotSource {
                name: $name,
                text: include_str!(concat!("../../models/urdf/", $file, ".urdf")),
                options: $options,
                arguments: concat!("urdf = \"../models/urdf/", $file, ".urdf\"", $arguments),
                frame: $frame,
            };
            robot_with_compared_functions(&source, &$robot, |q| {
                $robot.frame_jacobian(frame!($robot, $frame), q)
            })
        }};
    }
    let fixed = Options::default();
    let free = Options { free: true, ..fixed };
    let lock = &["panda_finger_joint1", "panda_finger_joint2"];
    let locked = Options { lock, ..fixed };
    vec![
        robot!("ur5", Ur5, "ur5", "", fixed, "tool0"),
        robot!(
            "panda arm",
            PandaArm,
            "panda",
            ", lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]",
            locked,
            "panda_hand"
        ),
        robot!("panda", Panda, "panda", ", mimic = independent", fixed, "panda_leftfinger"),
        robot!("solo12", Solo12, "solo12", ", base = free", free, "HR_FOOT"),
        robot!("simple_humanoid", SimpleHumanoid, "simple_humanoid", ", base = free", free, "r_wrist"),
    ]
}

/// Source text of a robot for both implementations.
struct RobotSource {
    name: &'static str,
    /// Text of the file, and the options with which the generic implementation reads it.
    text: &'static str,
    options: Options<'static>,
    /// Arguments of the attribute `#[mechanism]`.
    arguments: &'static str,
    /// Name of the frame whose Jacobian is measured.
    frame: &'static str,
}

/// Generic model with storage for the results of its algorithms.
struct GenericModelWithWorkspace {
    model: Rc<Model>,
    data: Workspace,
    vector: DVector<f64>,
    matrix: DMatrix<f64>,
    jacobian: Matrix6xX<f64>,
    frame: usize,
}

/// Type of closures that run a function of the generic implementation and return its result.
type GenericModelCall<const NQ: usize, const NV: usize> =
    for<'s> fn(&'s mut GenericModelWithWorkspace, &State<NQ, NV>) -> &'s [f64];

fn robot_with_compared_functions<M, J, const NQ: usize, const NV: usize, const NU: usize>(
    source: &RobotSource,
    robot: &'static M,
    jacobian: J,
) -> ComparedRobot
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
    J: Fn(&SVector<f64, NQ>) -> SMatrix<f64, 6, NV> + Copy + 'static,
{
    let model = Model::from_urdf(source.text, &source.options);
    let model = Rc::new(model.unwrap_or_else(|message| panic!("{}: {message}", source.name)));
    let operations = CompiledMechanism::compile_mechanism(source.arguments, "pub struct Robot;");
    let states = Rc::new(random_states(&model));
    let bench = GenericModelWithStates {
        frame: model.index_of_frame(source.frame).unwrap_or_default(),
        model,
        states,
    };
    let pairs = vec![
        bench.generated_and_generic_pair(
            "mass matrix",
            operations.operation_counts_of_function("mass_matrix"),
            |s| robot.mass_matrix(0.0, &s.q),
            |g, s| {
                g.model.mass_matrix(&mut g.data, s.q.as_slice(), &mut g.matrix);
                g.matrix.as_slice()
            },
        ),
        bench.generated_and_generic_pair(
            "bias forces",
            operations.operation_counts_of_function("bias_forces"),
            |s| robot.bias_forces(0.0, &s.q, &s.v),
            |g, s| {
                let tau = g.vector.as_mut_slice();
                let (q, v) = (s.q.as_slice(), s.v.as_slice());
                g.model.inverse_dynamics(&mut g.data, q, v, None, tau);
                g.vector.as_slice()
            },
        ),
        bench.generated_and_generic_pair(
            "inverse dynamics",
            operations.operation_counts_of_function("inverse_dynamics"),
            |s| robot.inverse_dynamics(0.0, &s.q, &s.v, &s.a),
            |g, s| {
                let tau = g.vector.as_mut_slice();
                let (q, v, a) = (s.q.as_slice(), s.v.as_slice(), s.a.as_slice());
                g.model.inverse_dynamics(&mut g.data, q, v, Some(a), tau);
                g.vector.as_slice()
            },
        ),
        bench.generated_and_generic_pair(
            "forward dynamics",
            operations.operation_counts_of_function("forward_dynamics"),
            |s| robot.forward_dynamics(0.0, &s.q, &s.v, &s.tau),
            |g, s| {
                let a = g.vector.as_mut_slice();
                let (q, v, tau) = (s.q.as_slice(), s.v.as_slice(), s.tau.as_slice());
                g.model.forward_dynamics(&mut g.data, q, v, tau, a);
                g.vector.as_slice()
            },
        ),
        bench.generated_and_generic_pair(
            "kinetic energy",
            operations.operation_counts_of_function("kinetic_energy"),
            |s| SVector::<f64, 1>::new(robot.kinetic_energy(0.0, &s.q, &s.v)),
            |g, s| {
                let energy = g.model.kinetic_energy(&mut g.data, s.q.as_slice(), s.v.as_slice());
                g.vector[0] = energy;
                &g.vector.as_slice()[..1]
            },
        ),
        bench.generated_and_generic_pair(
            "frame Jacobian",
            operations.jacobian_operation_counts(source.frame),
            move |s| jacobian(&s.q),
            |g, s| {
                let q = s.q.as_slice();
                g.model.frame_jacobian(&mut g.data, g.frame, q, &mut g.jacobian);
                g.jacobian.as_slice()
            },
        ),
    ];
    ComparedRobot { name: source.name, pairs }
}

/// Generic model with the states at which it is evaluated.
struct GenericModelWithStates<const NQ: usize, const NV: usize> {
    model: Rc<Model>,
    frame: usize,
    states: Rc<Vec<State<NQ, NV>>>,
}

impl<const NQ: usize, const NV: usize> GenericModelWithStates<NQ, NV> {
    fn allocate_generic_model(&self) -> GenericModelWithWorkspace {
        GenericModelWithWorkspace {
            model: self.model.clone(),
            data: self.model.allocate_workspace(),
            vector: DVector::zeros(NV),
            matrix: DMatrix::zeros(NV, NV),
            jacobian: Matrix6xX::zeros(NV),
            frame: self.frame,
        }
    }

    fn generated_and_generic_pair<F, const R: usize, const C: usize>(
        &self,
        function: &'static str,
        size: FunctionOperationCounts,
        generated: F,
        generic: GenericModelCall<NQ, NV>,
    ) -> ImplementationPair
    where
        F: Fn(&State<NQ, NV>) -> SMatrix<f64, R, C> + Copy + 'static,
    {
        let (mut room, mut room_again) = (self.allocate_generic_model(), self.allocate_generic_model());
        let [states, states_again, states_too] = [(); 3].map(|()| self.states.clone());
        ImplementationPair {
            function,
            generated: Box::new(move |k| {
                let result = generated(black_box(&states[k % STATES]));
                black_box(&result);
            }),
            generic: Box::new(move |k| {
                black_box(generic(&mut room, black_box(&states_again[k % STATES])));
            }),
            difference: Box::new(move |k| {
                let state = &states_too[k % STATES];
                let (found, expected) = (generated(state), generic(&mut room_again, state));
                assert_eq!(found.as_slice().len(), expected.len(), "{function}");
                let errors = found.as_slice().iter().zip(expected);
                errors.map(|(x, y)| (x - y).abs() / (1.0 + y.abs())).fold(0.0, f64::max)
            }),
            size,
        }
    }
}

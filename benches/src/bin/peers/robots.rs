//! Robots of the comparison with other libraries.

use linkwork::nalgebra::{ArrayStorage, SMatrix};
use linkwork_benches::generic::{Model, Options};
use linkwork_benches::peers::contender::{Contender, ContenderOwner, MeasuredFunction};
use linkwork_benches::peers::own::{GeneratedContender, MatrixContender, MechanismCall, ToNumberList};
use linkwork_benches::robots::{G1, Gen3, Kinova, Panda};
use linkwork_benches::states::{State, random_states};
use linkwork_models::{AnymalB, PandaArm, SimpleHumanoid, Solo12, Ur5};
use std::rc::Rc;

/// A measured function, and the contender that evaluates it with generated code.
pub type GeneratedFunctionContender = (MeasuredFunction, Box<dyn Contender>);

/// Robot with the generated functions that are compared.
pub struct RobotWithContenders {
    /// Name of the robot and of its folder of peer code.
    pub name: &'static str,
    /// Text of the robot's URDF file.
    pub urdf: String,
    /// Names of the joints of the file that are locked.
    pub lock: &'static [&'static str],
    /// Whether the robot's base is free.
    pub free: bool,
    /// Names of the robot's moving joints in order, without the joint of the base.
    pub joints: &'static [&'static str],
    /// Number of coordinates of the robot.
    pub nq: usize,
    /// Number of velocities of the robot.
    pub nv: usize,
    /// `q`, `v`, `a` and `τ` of every sample state, concatenated.
    pub numbers: Vec<f64>,
    /// Generated functions of the robot that are measured.
    pub functions: Vec<GeneratedFunctionContender>,
}

/// Returns a generated function of Linkwork as a contender of the comparison.
fn linkwork_contender<M: 'static, R: ToNumberList + 'static, const NQ: usize, const NV: usize>(
    (owner, mechanism): (ContenderOwner, M),
    states: &Rc<Vec<State<NQ, NV>>>,
    function: MeasuredFunction,
    call: MechanismCall<M, R, NQ, NV>,
) -> GeneratedFunctionContender {
    let states = states.clone();
    (
        function,
        Box::new(GeneratedContender {
            owner,
            mechanism,
            states,
            name: function.generated_function_name(),
            call,
        }),
    )
}

/// Expands to the generated functions of a mechanism as contenders.
macro_rules! functions {
    ($type:ty, $value:expr, $owner:ident, $states:expr) => {{
        let from = (ContenderOwner::$owner, $value);
        [
            linkwork_contender(from, $states, MeasuredFunction::Inverse, |m: &$type, s| {
                m.inverse_dynamics(&s.q, &s.v, &s.a)
            }),
            linkwork_contender(from, $states, MeasuredFunction::Mass, |m: &$type, s| m.mass_matrix(&s.q)),
            linkwork_contender(from, $states, MeasuredFunction::Forward, |m: &$type, s| {
                m.forward_dynamics(&s.q, &s.v, &s.tau)
            }),
        ]
    }};
}

/// Expands to the generated derivatives of a mechanism as contenders.
macro_rules! derivatives {
    ($type:ty, $value:expr, $owner:ident, $states:expr) => {{
        let from = (ContenderOwner::$owner, $value);
        [
            linkwork_contender(from, $states, MeasuredFunction::InverseDerivatives, |m: &$type, s| {
                m.inverse_dynamics_derivatives(&s.q, &s.v, &s.a)
            }),
            linkwork_contender(from, $states, MeasuredFunction::ForwardDerivatives, |m: &$type, s| {
                m.forward_dynamics_derivatives(&s.q, &s.v, &s.tau)
            }),
        ]
    }};
}

/// Returns functions that write their results to matrices with permanent zeros: the mass matrix, if at least
/// a quarter of its entries are zero, and derivatives.
macro_rules! kept {
    ($type:ty, $value:expr, Linkwork, $states:expr) => {{
        const N: usize = <$type>::NV;
        const ZERO: SMatrix<f64, N, N> = SMatrix::from_array_storage(ArrayStorage([[0.0; N]; N]));
        macro_rules! keeping {
            ($function:ident, $name:ident, $count:literal, $call:expr) => {
                (
                    MeasuredFunction::$function,
                    Box::new(MatrixContender {
                        mechanism: $value,
                        states: $states.clone(),
                        name: stringify!($name),
                        call: $call,
                        matrices: [ZERO; $count],
                    }),
                )
            };
        }
        let is_sparse = <$type>::MASS_MATRIX_ENTRIES.len() * 8 < 3 * N * (N + 1);
        let mass = is_sparse.then(|| -> GeneratedFunctionContender {
            keeping!(Mass, mass_matrix_into, 1, |m: &$type, s, [into]| m.mass_matrix_into(&s.q, into))
        });
        let derivatives: [GeneratedFunctionContender; 2] = [
            keeping!(
                InverseDerivatives,
                inverse_dynamics_derivatives_into,
                2,
                |m: &$type, s, [by_q, by_v]| {
                    m.inverse_dynamics_derivatives_into(&s.q, &s.v, &s.a, by_q, by_v)
                }
            ),
            keeping!(
                ForwardDerivatives,
                forward_dynamics_derivatives_into,
                3,
                |m: &$type, s, [by_q, by_v, inverse]| {
                    let a = m.forward_dynamics_derivatives_into(&s.q, &s.v, &s.tau, by_q, by_v, inverse);
                    std::hint::black_box(a);
                }
            ),
        ];
        mass.into_iter().chain(derivatives)
    }};
}

/// Returns a robot from its name, its URDF text with options, its type, and the functions of one or more of
/// its values.
macro_rules! robot {
    ($name:literal, $urdf:expr, $options:expr, $type:ident, $($macro:ident!($of:ident, $value:expr, $owner:ident)),+) => {{
        let (urdf, options): (String, Options<'static>) = ($urdf, $options);
        let model = Model::from_urdf(&urdf, &options);
        let model = model.unwrap_or_else(|message| panic!("{}: {message}", $name));
        let states: Rc<Vec<State<{ $type::NQ }, { $type::NV }>>> = Rc::new(random_states(&model));
        let joints = if options.free { 6 } else { 0 };
        let mut functions: Vec<GeneratedFunctionContender> = Vec::new();
        $(functions.extend($macro!($of, $value, $owner, &states));)+
        RobotWithContenders {
            name: $name,
            urdf,
            lock: options.lock,
            free: options.free,
            joints: &const { $type::VELOCITIES }[joints..],
            nq: $type::NQ,
            nv: $type::NV,
            numbers: states.iter().flat_map(State::concatenated_state_numbers).collect(),
            functions,
        }
    }};
}

/// Expands to the robot of a URDF file with its generated functions.
macro_rules! file {
    ($name:literal, $file:literal, $options:expr, $type:ident) => {
        robot!(
            $name,
            include_str!(concat!("../../../../models/urdf/", $file, ".urdf")).to_string(),
            $options,
            $type,
            functions!($type, $type, Linkwork),
            kept!($type, $type, Linkwork),
            derivatives!($type, $type, Linkwork)
        )
    };
}

#[cfg(feature = "chains")]
mod chains;

/// Returns the constructors of all robots of the comparison.
pub fn robot_constructors() -> Vec<fn() -> RobotWithContenders> {
    const FIXED: Options<'static> = Options { free: false, lock: &[] };
    const FREE: Options<'static> = Options { free: true, lock: &[] };
    const LOCKED: Options<'static> =
        Options { free: false, lock: &["panda_finger_joint1", "panda_finger_joint2"] };
    let files: [fn() -> RobotWithContenders; _] = [
        || file!("ur5", "ur5", FIXED, Ur5),
        || file!("panda_arm", "panda", LOCKED, PandaArm),
        || file!("panda", "panda", FIXED, Panda),
        || file!("kinova", "kinova", FIXED, Kinova),
        || file!("gen3", "gen3", FIXED, Gen3),
        || file!("solo12", "solo12", FREE, Solo12),
        || file!("anymal_b", "anymal_b", FREE, AnymalB),
        || file!("simple_humanoid", "simple_humanoid", FREE, SimpleHumanoid),
        || file!("g1", "g1", FREE, G1),
    ];
    #[cfg(feature = "chains")]
    return files.into_iter().chain(chains::robots()).collect();
    #[cfg(not(feature = "chains"))]
    files.to_vec()
}

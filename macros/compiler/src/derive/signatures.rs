//! The public functions without their programs: names, arguments, results, documentation. A mechanism with a mistake
//! has these alone.

use crate::emit::Argument::{A, Q, T, Tau, U, V};
use crate::emit::{Argument, Constant, Function, REACTION, Shape};
use crate::mechanics::regressor::COUNT;
use crate::model::{Model, Uses};
use crate::syntax::Requests;

/// What signatures depend on.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// `NQ`.
    pub nq: usize,
    /// `NV`.
    pub nv: usize,
    /// `NU`.
    pub nu: usize,
    /// Functions take time first.
    pub time: bool,
    /// Inputs act by way of the velocity.
    pub velocity_inputs: bool,
    /// Constraints determine coordinates without inertia.
    pub massless: bool,
}

impl Sizes {
    /// Those of a model.
    pub fn of(model: &Model<'_>) -> Sizes {
        Sizes {
            nq: model.nq(),
            nv: model.nv(),
            nu: model.nu(),
            time: model.time,
            velocity_inputs: model.velocity_inputs,
            massless: model.constraints.iter().any(|constraint| constraint.determines),
        }
    }

    /// A function of the motion.
    fn function(&self, name: &str, arguments: &[Argument], shape: Shape, docs: &[&str]) -> Function {
        Function {
            arguments: self.time.then_some(T).into_iter().chain(arguments.iter().copied()).collect(),
            ..constant(name, shape, docs)
        }
    }
}

/// A function of the parameters alone.
fn constant(name: &str, shape: Shape, docs: &[&str]) -> Function {
    Function {
        name: name.to_string(),
        docs: docs.iter().map(ToString::to_string).collect(),
        ..Function::new(shape)
    }
}

/// The functions of every mechanism.
pub fn always(sizes: &Sizes) -> Vec<Function> {
    [dynamics(sizes), energies(sizes), whole(sizes)].into_iter().flatten().collect()
}

/// The functions of a mechanism without dynamics.
pub fn kinematic(sizes: &Sizes) -> Vec<Function> {
    let is_kinematic = |f: &Function| ["neutral", "generalized_forces"].contains(&f.name.as_str());
    dynamics(sizes).into_iter().filter(is_kinematic).collect()
}

/// Equations of motion.
fn dynamics(sizes: &Sizes) -> Vec<Function> {
    let vector = Shape::Vector(sizes.nv);
    vec![
        constant(
            "neutral",
            Shape::Vector(sizes.nq),
            &["The configuration with all coordinates zero; identity quaternions."],
        ),
        sizes.function(
            "mass_matrix",
            &[Q],
            Shape::Square(sizes.nv),
            &[
                match sizes.massless {
                    true => {
                        "Mass matrix `M(q)`, symmetric positive semidefinite, both triangles: singular where coordinates have no inertia and follow from constraints."
                    }
                    false => "Mass matrix `M(q)`, symmetric positive definite, both triangles.",
                },
                "Composite-rigid-body algorithm (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 6). kg between translations, kg·m² between rotations, kg·m mixed.",
            ],
        ),
        sizes.function(
            "bias_forces",
            &[Q, V],
            vector,
            &[
                "Bias forces `h(q, v)`: Coriolis and centrifugal forces, gravity, springs, dashpots, friction. N for translations, N·m for rotations.",
                "Recursive Newton–Euler algorithm without accelerations.",
            ],
        ),
        sizes.function(
            "inverse_dynamics",
            &[Q, V, A],
            vector,
            &[
                "`τ = M(q) a + h(q, v)`: the forces (N) and torques (N·m) that give the acceleration `a`.",
                "Recursive Newton–Euler algorithm (Featherstone 2008, ch. 5).",
            ],
        ),
        sizes.function(
            "forward_dynamics",
            &[Q, V, Tau],
            vector,
            &[
                "`v̇ = M(q)⁻¹ (τ − h(q, v))`: the acceleration that the forces `tau` give. Not finite where `M(q)` is singular.",
                "Articulated-body algorithm, or sparse factorisation of `M`, whichever costs less (Featherstone 2008, ch. 6, 7).",
            ],
        ),
        sizes.function(
            "generalized_forces",
            if sizes.velocity_inputs { &[Q, V, U] } else { &[Q, U] },
            vector,
            &["Generalized forces `τ` of the inputs `u`, by virtual work: N for translations, N·m for rotations."],
        ),
    ]
}

/// Energies, Hamilton's quantities and powers.
fn energies(sizes: &Sizes) -> Vec<Function> {
    let vector = Shape::Vector(sizes.nv);
    vec![
        sizes.function(
            "kinetic_energy",
            &[Q, V],
            Shape::Scalar,
            &[match sizes.time {
                true => {
                    "Kinetic energy `T`, J. It is `½ vᵀ M v` only where nothing is driven: driven motion adds terms of first degree in `v` and of none."
                }
                false => "Kinetic energy `T = ½ vᵀ M(q) v`, J.",
            }],
        ),
        sizes.function(
            "potential_energy",
            &[Q],
            Shape::Scalar,
            &["Potential energy `U(q)` of gravity (zero at the ground's origin) and springs, J."],
        ),
        sizes.function(
            "generalized_momentum",
            &[Q, V],
            vector,
            &[match sizes.time {
                true => {
                    "Generalized momentum `p = ∂T/∂v`, kg·m/s for translations, kg·m²/s for rotations. It is `M v` only where nothing is driven."
                }
                false => {
                    "Generalized momentum `p = M(q) v`, kg·m/s for translations, kg·m²/s for rotations."
                }
            }],
        ),
        sizes.function(
            "momentum_rate",
            &[Q, V],
            vector,
            &[
                "Rate of the generalized momentum without inputs, N for translations, N·m for rotations: `ṗ = momentum_rate(q, v) + τ`.",
                "Hamilton's second equation; for ball and free joints in body components (Euler–Poincaré).",
            ],
        ),
        sizes.function(
            "dissipated_power",
            &[Q, V],
            Shape::Scalar,
            &[
                "Power that dashpots, friction and dissipation functions take out, W.",
                "Unless the mechanism is driven in time, `d(T + U)/dt = control_power + disturbance_power − dissipated_power`.",
            ],
        ),
        sizes.function("control_power", &[Q, V, U], Shape::Scalar, &["Power of the inputs `u`, W."]),
        sizes.function(
            "disturbance_power",
            &[Q, V],
            Shape::Scalar,
            &["Power of applied forces that are neither conservative nor dissipative nor inputs, W."],
        ),
    ]
}

/// The mechanism as one body.
fn whole(sizes: &Sizes) -> Vec<Function> {
    vec![
        constant("total_mass", Shape::Scalar, &["Mass of everything that moves, kg."]),
        sizes.function(
            "center_of_mass",
            &[Q],
            Shape::Vector(3),
            &["Centre of mass of everything that moves, m, from the ground's origin in ground axes."],
        ),
        sizes.function(
            "momentum",
            &[Q, V],
            Shape::Vector(6),
            &["Momentum in ground axes: linear (kg·m/s), then angular about the centre of mass (kg·m²/s)."],
        ),
    ]
}

/// What is generated on request.
pub fn requested(sizes: &Sizes, requests: Requests) -> Vec<Function> {
    let mut functions = Vec::new();
    if requests.centroidal {
        functions.extend(centroidal(sizes));
    }
    if requests.derivatives {
        let derivatives = derivatives(sizes);
        let into: Vec<Function> = derivatives.iter().filter_map(|f| into(f, sizes.nv)).collect();
        functions.extend(derivatives);
        functions.extend(into);
    }
    functions
}

/// Takes away from the functions of a mechanism with a mistake what one with constraints does not have, and adds what it has
/// besides, as far as that can be said without knowing the constraints.
pub fn constrain(functions: &mut Vec<Function>, sizes: &Sizes, slipping: usize, requests: Requests) {
    let solved = [
        "forward_dynamics",
        "forward_dynamics_derivatives",
        "forward_dynamics_derivatives_into",
        "linearize",
    ];
    functions.retain(|f| !solved.contains(&f.name.as_str()));
    functions.extend(constrained(sizes, 1, 1, slipping, false));
    if requests.derivatives {
        functions.extend(constrained_derivatives(sizes, 1));
    }
}

/// The functions of the word `centroidal`.
pub fn centroidal(sizes: &Sizes) -> Vec<Function> {
    vec![
        sizes.function(
            "centroidal_momentum_matrix",
            &[Q],
            Shape::Matrix(6, sizes.nv),
            &[
                "Centroidal momentum matrix `A(q)`: [`momentum`](Self::momentum) is `A v`, linear part first, then angular about the centre of mass, in ground axes. Of a mechanism that is driven in time, the part that the velocities contribute.",
                "kg and kg·m for translations, kg·m and kg·m² for rotations (Orin, Goswami and Lee, *Centroidal dynamics of a humanoid robot*, 2013).",
            ],
        ),
        sizes.function(
            "centroidal_momentum_bias",
            &[Q, V],
            Shape::Vector(6),
            &["`Ȧ v`: the rate of [`momentum`](Self::momentum) (N, then N·m about the centre of mass) where all accelerations are zero, so that it is `A v̇ + Ȧ v` in every motion."],
        ),
    ]
}

/// The functions of the word `regressor`, for so many bodies and base parameters.
pub fn regressor(sizes: &Sizes, bodies: usize, base: usize) -> Vec<Function> {
    let standard = COUNT * bodies;
    vec![
        sizes.function(
            "joint_torque_regressor",
            &[Q, V, A],
            Shape::Matrix(sizes.nv, standard),
            &[
                "Regressor `Y(q, v, a)`: without springs, friction and other elements, [`inverse_dynamics`](Self::inverse_dynamics) is `Y π`, with the [`standard_parameters`](Self::standard_parameters) `π`.",
                "Atkeson, An and Hollerbach, *Estimation of inertial parameters of manipulator loads and links* (1986); columns as in Pinocchio.",
            ],
        ),
        constant(
            "standard_parameters",
            Shape::Vector(standard),
            &["The mass properties `π`: for every one of `BODIES`, with all that is fixed to it, its mass `m` (kg), first moment `m c` (x, y, z; kg·m) and inertia (xx, xy, yy, xz, yz, zz; kg·m²) about the body's origin in its axes."],
        ),
        sizes.function(
            "base_regressor",
            &[Q, V, A],
            Shape::Matrix(sizes.nv, base),
            &["The regressor of the base parameters, whose columns are linearly independent: `base_regressor(q, v, a) · base_parameters(π)` is `joint_torque_regressor(q, v, a) · π` for every `π`."],
        ),
        Function {
            arguments: vec![Argument::Standard(standard)],
            ..constant(
                "base_parameters",
                Shape::Vector(base),
                &[
                    "The base parameters of given standard parameters: the fewest linear combinations by which mass properties act on the motion, all that can be identified from it.",
                    "What a joint's motion neither changes nor sets moving is moved to the parent (Gautier and Khalil, *Direct calculation of minimum set of inertial parameters of serial robots*, 1990); what then still depends on others is found in numbers. Where the geometry has parameters, combinations whose factors depend on them beyond those rules are left apart.",
                ],
            )
        },
    ]
}

/// The lists of names that go with them.
pub fn names(bodies: &[String], base: &[String]) -> Vec<Constant> {
    vec![
        strings(
            "BODIES",
            "Name of the body that every ten standard parameters belong to, with all that is fixed to it.",
            bodies,
        ),
        strings(
            "BASE_PARAMETERS",
            "Name of every base parameter: the parameter of a link, about the frame of its joint, that stands for the combination.",
            base,
        ),
    ]
}

fn strings(name: &'static str, docs: &'static str, list: &[String]) -> Constant {
    Constant { name, docs, item: "&'static str", list: list.iter().map(|s| format!("{s:?}")).collect() }
}

/// The functions of the word `packed`, for the entries that are not always zero.
pub fn packed(sizes: &Sizes, entries: &[(usize, usize)]) -> Vec<Function> {
    let packed = sizes.function(
        "mass_matrix_packed",
        &[Q],
        Shape::Vector(entries.len()),
        &["The entries of the [`mass_matrix`](Self::mass_matrix) in its lower triangle, column by column, without those that are always zero: entry `k` stands at `MASS_MATRIX_ENTRIES[k]`, row first."],
    );
    let mut into = sizes.function(
        "mass_matrix_into",
        &[Q, Argument::Into("m", sizes.nv)],
        Shape::Symmetric(sizes.nv),
        &["Puts the [`mass_matrix`](Self::mass_matrix) into `m`, `NV` by `NV`, except for the entries that are always zero, which keep what they are: `m` begins as a matrix of zeros and is given again each time. `MASS_MATRIX_ENTRIES` lists what is written, which goes to the other side of the diagonal too."],
    );
    into.structure.entries = entries.to_vec();
    vec![packed, into]
}

/// Where they stand.
pub fn entries(list: &[(usize, usize)]) -> Constant {
    Constant {
        name: "MASS_MATRIX_ENTRIES",
        docs: "Row and column of every entry of `mass_matrix_packed`: the lower triangle of the mass matrix without what is always zero.",
        item: "(usize, usize)",
        list: list.iter().map(|entry| format!("{entry:?}")).collect(),
    }
}

/// The functions of the word `sensitivities`, for so many parameters.
pub fn sensitivities(sizes: &Sizes, parameters: usize) -> Vec<Function> {
    let shape = Shape::Matrix(sizes.nv, parameters);
    vec![
        sizes.function(
            "inverse_dynamics_by_parameters",
            &[Q, V, A],
            shape,
            &["`∂τ/∂p` of [`inverse_dynamics`](Self::inverse_dynamics): column `k` is the derivative by the parameter that is named `PARAMETERS[k]`."],
        ),
        sizes.function(
            "forward_dynamics_by_parameters",
            &[Q, V, Tau],
            shape,
            &[
                "`∂v̇/∂p` of [`forward_dynamics`](Self::forward_dynamics): column `k` is the derivative by the parameter that is named `PARAMETERS[k]`.",
                "`∂v̇/∂p = −M⁻¹ ∂τ/∂p` at `a = v̇`.",
            ],
        ),
    ]
}

/// The names of the parameters.
pub fn parameters(list: &[String]) -> Constant {
    strings("PARAMETERS", "Name of every parameter of the struct.", list)
}

/// The functions of the word `derivatives`.
pub fn derivatives(sizes: &Sizes) -> Vec<Function> {
    const TANGENT: &str = "Column `i` of a derivative by `q` is along `q ⊕ ε eᵢ` (see `integrate`); for ball and free joints this is a motion in body axes.";
    let Sizes { nv, nu, .. } = *sizes;
    vec![
        sizes.function(
            "mass_matrix_inverse",
            &[Q],
            Shape::Inverse(nv),
            &[
                "Inverse of the mass matrix, `∂v̇/∂τ`. Not finite where `M(q)` is singular.",
                "By the sparse factorisation `M = Lᵀ D L` (Featherstone 2008, ch. 6).",
            ],
        ),
        sizes.function(
            "coriolis_matrix",
            &[Q, V],
            Shape::Square(nv),
            &[
                "A matrix `C(q, v)` with `C v` the Coriolis and centrifugal forces and `Ṁ − 2 C` skew.",
                "Echeandia and Wensing, *Numerical methods to compute the Coriolis matrix and Christoffel symbols* (2021).",
            ],
        ),
        sizes.function(
            "inverse_dynamics_derivatives",
            &[Q, V, A],
            Shape::Pair(nv),
            &[
                "`(∂τ/∂q, ∂τ/∂v)` of [`inverse_dynamics`](Self::inverse_dynamics); `∂τ/∂a` is the mass matrix.",
                TANGENT,
                "Singh, Russell and Wensing, *Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra* (2022).",
            ],
        ),
        sizes.function(
            "forward_dynamics_derivatives",
            &[Q, V, Tau],
            Shape::Forward(nv),
            &[
                "`(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂τ)` of [`forward_dynamics`](Self::forward_dynamics); the last is `M⁻¹`.",
                TANGENT,
                "`∂v̇/∂x = −M⁻¹ ∂τ/∂x` at `a = v̇` (Carpentier and Mansard, *Analytical derivatives of rigid body dynamics algorithms*, 2018); of a large mechanism it calls other functions. The operations counted are those without calls and products.",
                "How a mechanism with a free base moves in the axes of the base does not depend on its linear velocity, and on its orientation only by the components of uniform gravity: where no other force comes from the ground, these six columns are exact.",
            ],
        ),
        sizes.function(
            "linearize",
            &[Q, V, U],
            Shape::Linear(nv, nu),
            &[
                "`(A, B)` of `ẋ = A x + B δu`: the motion to first order about `q`, `v` and the inputs `u`, at the instant; `x` holds the displacement `δq` with `q ⊕ δq`, then `δv`.",
                TANGENT,
                "`δq̇` is `δv`, and for ball and free joints `δv + δq × v`.",
            ],
        ),
    ]
}

/// The same function with its results going into matrices that are given; none if it has no such variant.
pub fn into(f: &Function, nv: usize) -> Option<Function> {
    const KEPT: &str = "Entries that are always zero keep what they are: the matrices begin as zeros and are given again each time. Nothing large is moved.";
    let (given, docs): (&[&'static str], &[&str]) = match f.name.as_str() {
        "inverse_dynamics_derivatives" => (
            &["by_q", "by_v"],
            &[
                "Puts [`inverse_dynamics_derivatives`](Self::inverse_dynamics_derivatives) into `by_q` and `by_v`, `NV` by `NV` each.",
                KEPT,
            ],
        ),
        "forward_dynamics_derivatives" => (
            &["by_q", "by_v", "inverse"],
            &[
                "Puts [`forward_dynamics_derivatives`](Self::forward_dynamics_derivatives) into `by_q`, `by_v` and `inverse`, `NV` by `NV` each.",
                KEPT,
            ],
        ),
        _ => return None,
    };
    let given = given.iter().map(|name| Argument::Into(name, nv));
    Some(Function {
        arguments: f.arguments.iter().copied().chain(given).collect(),
        program: f.program.clone(),
        structure: f.structure.clone(),
        ..constant(&format!("{}_into", f.name), f.shape, docs)
    })
}

/// What the derivatives of forward dynamics of a large mechanism need, hidden.
pub fn accelerated(sizes: &Sizes) -> Function {
    let arguments = [Q, V, Tau, Argument::Into("inverse", sizes.nv)];
    sizes.function("__accelerations_and_inverse", &arguments, Shape::Accelerated(sizes.nv), &[])
}

/// The function of an output, and its Jacobian unless it depends on accelerations.
pub fn output(name: &str, size: usize, uses: Uses, sizes: &Sizes) -> Vec<Function> {
    let mut arguments = vec![Q];
    arguments.extend((uses.velocities || uses.accelerations).then_some(V));
    arguments.extend(uses.accelerations.then_some(A));
    arguments.extend(uses.inputs.then_some(U));
    let shape = if size == 1 { Shape::Scalar } else { Shape::Vector(size) };
    let about = match uses.accelerations {
        true => format!("The output `{name}`, of given accelerations. It has no Jacobian yet."),
        false => format!("The output `{name}`."),
    };
    let mut functions = vec![sizes.function(name, &arguments, shape, &[&about])];
    if !uses.accelerations {
        let what = match uses.velocities {
            true => "it changes with the velocities",
            false => "its rate is this times `v`",
        };
        functions.push(sizes.function(
            &format!("{name}_jacobian"),
            &arguments,
            Shape::Matrix(size, sizes.nv),
            &[&format!("Jacobian of the output `{name}`: {what}.")],
        ));
    }
    functions
}

/// The functions of a mechanism with `nc` constraints, of which `nh` are on configurations, beside those that solve; of an
/// overdetermined one those give what the solution follows from.
pub fn constrained(
    sizes: &Sizes,
    nh: usize,
    nc: usize,
    slipping: usize,
    overdetermined: bool,
) -> Vec<Function> {
    let nv = sizes.nv;
    let (force, bias) = (Argument::Given("force", 0, nv), Argument::Given("bias", nv, nc));
    let solution = Shape::Array(if overdetermined { (nv + nc) * (1 + nc) } else { nv + 3 * nc });
    let mut functions = constraints(sizes, nh, nc);
    functions.push(sizes.function("__constraint_correction", &[Q, force, bias], solution, &[]));
    let sides = Argument::Given("sides", nv + nc, slipping);
    if slipping == 0 {
        functions.push(sizes.function("__constrained_dynamics", &[Q, V, Tau], solution, &[]));
    } else {
        functions.push(sizes.function("__constrained_dynamics", &[Q, V, Tau, sides], solution, &[]));
        functions.push(sizes.function("__slipping_response", &[Q, V, force, bias, sides], solution, &[]));
    }
    functions
}

/// What `nc` constraints, of which `nh` are on configurations, say of a state.
pub fn constraints(sizes: &Sizes, nh: usize, nc: usize) -> Vec<Function> {
    vec![
        sizes.function(
            "constraint_residuals",
            &[Q],
            Shape::Vector(nh),
            &["Residuals `φ(q)` of the constraints on configurations, m and rad: zero where they hold."],
        ),
        sizes.function(
            "constraint_rates",
            &[Q, V],
            Shape::Vector(nc),
            &["Rates `J(q) v + …` of all constraints, m/s and rad/s: zero where they hold."],
        ),
        sizes.function(
            "constraint_jacobian",
            &[Q],
            Shape::Matrix(nc, sizes.nv),
            &["Jacobian `J(q)` of the constraints: how their rates change with the velocities."],
        ),
        sizes.function(
            "constraint_bias",
            &[Q, V],
            Shape::Vector(nc),
            &["Bias `b(q, v)` of the constraints, m/s² and rad/s²: their rates change by `J v̇ + b`."],
        ),
    ]
}

/// What a mechanism with `nc` constraints needs for the derivatives of its motion, all hidden.
pub fn constrained_derivatives(sizes: &Sizes, nc: usize) -> Vec<Function> {
    let Sizes { nv, nu, .. } = *sizes;
    let lambda = Argument::Given("lambda", 0, nc);
    let (motion, inputs) = (3 * nv * nv + 3 * nc * nv, nv + 2 * nv * nv + nv * nu);
    vec![
        sizes.function("__motion_derivatives", &[Q, V, A, lambda], Shape::Array(motion), &[]),
        sizes.function("__input_derivatives", &[Q, V, U], Shape::Array(inputs), &[]),
    ]
}

/// The hidden function of an output that names reactions: of the motion, its accelerations and its `nc` multipliers.
pub fn reaction(name: &str, size: usize, sizes: &Sizes, nc: usize) -> Function {
    let mut arguments = vec![Q, V, A];
    arguments.extend((sizes.nu > 0).then_some(U));
    arguments.extend((nc > 0).then_some(Argument::Given("lambda", 0, nc)));
    let shape = if size == 1 { Shape::Scalar } else { Shape::Vector(size) };
    sizes.function(&format!("{REACTION}{name}"), &arguments, shape, &[])
}

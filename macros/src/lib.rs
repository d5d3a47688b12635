//! The attribute macro of Linkwork. Use it through the crate `linkwork`, which re-exports it and holds what
//! the generated code calls.

mod above;

use proc_macro::{Span, TokenStream};
use std::path::PathBuf;

/// Compiles a mechanism: derives the equations of motion of the struct below and implements them for it.
///
/// ```
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -g * y, derivatives)]
/// #[derive(Clone, Copy, Debug)] // below the attribute
/// pub struct Pendulum {
///     pub g: f64,
///     pub mass: f64,
///     pub length: f64,
///
///     #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
///     rod: Body,
///     #[joint(ground -> rod, about = z)]
///     hinge: Pin,
///     #[acts(on = hinge)]
///     motor: Torque,
/// }
///
/// let pendulum = Pendulum { g: 9.81, mass: 2.0, length: 1.5 };
/// let (q, v, u) = ([0.5].into(), [0.0].into(), [0.0].into());
///
/// // A method that every mechanism has …
/// let a = pendulum.forward_dynamics(&q, &v, &u);
/// assert!((a[0] + 1.5 * 9.81 / 1.5 * 0.5_f64.sin()).abs() < 1e-12);
///
/// // … and one that `derivatives` asks for: ẋ = A x + B u.
/// let (by_state, _by_input) = pendulum.linearize(&q, &v, &u);
/// assert!((by_state[(1, 0)] + 1.5 * 9.81 / 1.5 * 0.5_f64.cos()).abs() < 1e-12);
/// ```
///
/// The struct's fields are parameters (`f64`, `f32` or the struct's own type parameter), which stay, and
/// elements (`linkwork::elements`), which say what the mechanism is made of and leave no trace in memory. The
/// generated methods, their shapes, units and conventions are those of the trait `linkwork::Mechanism`
/// (`linkwork::Rheonomic` if something depends on time) and stand in the rustdoc of the struct. The guide,
/// `linkwork::guide`, explains everything from the beginning.
///
/// **Order.** `#[mechanism]` stands above `#[derive(…)]`, so that the derives see the struct without its
/// elements. The other order is an error that says so.
///
/// **Mistakes** are compile errors at the token, all of them at once; those of a file carry its line and
/// column.
///
/// # A robot from a file
///
/// ```
/// use linkwork::prelude::*;
///
/// /// The path is relative to the crate's `Cargo.toml`.
/// #[mechanism(urdf = "../models/urdf/ur5.urdf", batch)]
/// pub struct Ur5;
///
/// assert_eq!((Ur5::NV, Ur5::INPUTS[0]), (6, "shoulder_pan_joint"));
/// ```
///
/// # Arguments
///
/// | argument | says |
/// | --- | --- |
/// | `gravity = -9.81 * y` | uniform gravity, a vector in ground axes, m/s²; none if not given, −9.81 z with a file |
/// | `scalar = f64` or `f32` | the scalar type of a mechanism without parameters |
/// | `friction_speed = 0.01` | speed at which dry friction of a file's joints is regularised, m/s or rad/s |
/// | `derivatives` | adds first derivatives of inverse and forward dynamics, and `linearize` |
/// | `momentum_derivatives` | adds derivatives of momenta and of their rates, which steps of implicit methods have in their Jacobians, and what `derivatives` adds |
/// | `second_derivatives` | adds second derivatives of inverse and forward dynamics and of the inputs' forces, contracted with factors, and what `derivatives` adds |
/// | `centroidal` | adds the centroidal momentum matrix and its bias |
/// | `hamilton` | adds the Hamiltonian and the canonical equations as functions of configuration and momentum |
/// | `routh` | adds the Routhian and motion without cyclic coordinates, as functions of their momenta |
/// | `conserved` | adds what keeps its value in every motion without inputs: energy, Jacobi's integral, momenta |
/// | `regressor` | adds the joint torque regressor, and base parameters, for identification |
/// | `sensitivities` | adds derivatives of the dynamics by the struct's parameters |
/// | `packed` | adds the mass matrix without entries that are always zero, and into a matrix of the caller |
/// | `prepare` | adds `prepare()`, which computes once what depends on the parameters alone |
/// | `batch` | adds a twin of every function of the state for several states at once |
/// | `drawing` | adds what the mechanism looks like as data (`DRAWING`, `linkwork::drawing`), for programs that draw it |
/// | `equations = lagrange`, `hamilton`, `kane`, `routh` or `structure` | which equations `EQUATIONS` and the documentation have: Lagrange's also where they are long, the canonical ones, those in independent speeds without multipliers, those without cyclic coordinates, or no terms at all. If not given, Lagrange's where they are short enough to be read |
/// | `formulation = multipliers` or `speeds` | how constraints are solved: with Lagrange multipliers, or in independent speeds (Kane); multipliers if not given |
/// | `independent = (velocity, …)` | the independent speeds, of `formulation = speeds`; chosen if not given. Speeds of your own are elements: `#[speed(…)] name: Speed` |
/// | `processor = detect` or `target` | whether large functions use AVX2 and FMA (products of large matrices AVX-512) where the processor has them, though the target does not promise them (x86-64, release builds, feature `std`); detect if not given |
/// | `skip_passes = [pass, …]` | passes over the model that are left out, of `frames` (link frames moved to where placements are sparse), `regroup` (mass properties moved towards the base), `parallel` (links on parallel axes described in common ones) and `limbs` (alike limbs, and joints of one path, as SIMD lanes); none if not given. The functions are the same to rounding, and cost more |
/// | `urdf = "path"` | a URDF file, relative to the crate's manifest; when it changes, the crate is compiled again |
/// | `mjcf = "path"` | an MJCF file (MuJoCo) with the files that it includes, in the same way |
/// | `sdf = "path"` | an SDF file of one model, in the same way |
/// | `base = fixed` or `free` | how the file's root link is held; fixed if not given. MJCF files say that themselves: `free` is for those with one outermost body and no joint on it |
/// | `passive = honour` or `ignore` | damping, friction and springs of the file's joints and tendons; honour if not given |
/// | `mimic = follow` or `independent` | joints with a `mimic` tag, and `<equality>` of MJCF; follow if not given |
/// | `contacts = file` or `ignore` | of an MJCF file, contacts of its bodies with the planes of its world; ignore if not given |
/// | `limits = honour` or `ignore` | limits of the file's joints, which the trait `linkwork::Limits` gives; honour if not given |
/// | `inertia = check`, `trust` or `none` | whether an inertia that no body can have is an error, or whether there are no masses and inertias at all: kinematics alone; check if not given |
/// | `inputs = joints`, `actuators` or `none` | whether every moving joint with one degree of freedom is an input, or every actuator of an MJCF file; joints if not given, and actuators for MJCF |
/// | `lock = ["joint", …]` | joints frozen at zero |
/// | `parameters = inertial`, `[inertial("link", …), placement, damping, friction]` | figures of the file that are fields of the struct, of all links or joints or of those named |
/// | `snap = 1e-4` | angles, positions and axes of joints that are no more than this (rad, m) off right angles, zero and coordinate axes are taken for those; the docs of the struct list them |
/// | `crate = path::to::linkwork` | where generated code finds this crate, if `Cargo.toml` gives it another name (`crate = name`) or another crate re-exports it (`crate = other::linkwork`) |
///
/// With `inertia = none` nothing needs a mass: frames with their velocities, accelerations and Jacobians, the
/// configuration space (`neutral`, `integrate`, `difference`, `tangent_rate`), residuals and Jacobians of
/// constraints, `assemble`, outputs and `generalized_forces` are generated, the dynamics and the trait
/// `Mechanism` are not. Files that describe shapes and joints alone are read so; what such a file says of
/// masses is skipped.
///
/// A mechanism has 128 degrees of freedom at most, and 1024 bodies: everything is written out for each of
/// them. Masses, moments and lengths that are given by numbers must leave room for products of theirs to be
/// finite.
///
/// `ground` is the fixed frame; a link of this name that does not stand there is called `ground_link`. A
/// fixed root of this name is the ground, and one of the frames. A link `world` that joints name and the file
/// does not declare is its root. What fixed joints hold to a fixed root enters no equation: its mass
/// properties are not checked.
///
/// # A closed loop in independent speeds
///
/// ```
/// use linkwork::prelude::*;
///
/// /// A four-bar linkage, solved in the speed of its crank.
/// #[mechanism(gravity = -9.81 * y, formulation = speeds, independent = (first))]
/// pub struct FourBar {
///     #[body(mass = 1, com = 0.4 * x, inertia = rod(1, 0.8, x))]
///     crank: Body,
///     #[body(mass = 2, com = 0.95 * x, inertia = rod(2, 1.9, x))]
///     coupler: Body,
///     #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
///     rocker: Body,
///     #[joint(ground -> crank, about = z)]
///     first: Pin,
///     #[joint(crank.at(0.8 * x) -> coupler, about = z)]
///     second: Pin,
///     #[joint(ground.at(2 * x) -> rocker, about = z)]
///     third: Pin,
///     #[joint(rocker.at(x) -> coupler.at(1.9 * x), about = z)]
///     closing: Pin,
/// }
///
/// # fn main() -> Result<(), ConstraintError> {
/// let linkage = FourBar {};
/// let q = linkage.assemble(&[1.2, -1.0, 1.4].into(), &[0])?;
/// let v = linkage.project_velocity(&q, &[2.0, 0.0, 0.0].into())?;
/// let a = linkage.forward_dynamics(&q, &v, &SVector::zeros());
/// let closed = linkage.constraint_jacobian(&q) * a + linkage.constraint_bias(&q, &v);
/// assert!(closed.amax() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[proc_macro_attribute]
pub fn mechanism(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    let (here, item) = (Span::call_site(), item.into());
    let text = here.local_file().and_then(|path| std::fs::read_to_string(path).ok()).unwrap_or_default();
    if let Some(bare) = linkwork_compiler::second_definition(&item, &text, here.line()) {
        return bare.into();
    }
    let emitted = match above::stands_below_a_derive(&text, here.line(), here.column()) {
        false => linkwork_compiler::expand(arguments.into(), item, &folder),
        true => linkwork_compiler::expand_below_a_derive(arguments.into(), item, &folder),
    };
    let mut tokens = TokenStream::from(emitted.tokens);
    match emitted.text.parse::<TokenStream>() {
        Ok(text) => tokens.extend(text),
        Err(error) => {
            let message = format!("a mistake of Linkwork's: {error}");
            tokens.extend(format!("::core::compile_error!({message:?});").parse::<TokenStream>());
        }
    }
    tokens
}

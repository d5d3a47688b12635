//! The attribute macro of Linkwork. Use it through the crate `linkwork`, which re-exports it and contains the
//! functions that the generated code calls.

mod above;

use proc_macro::{Span, TokenStream};
use std::path::PathBuf;

/// Derives the equations of motion of the mechanism that the struct describes, and implements them for it.
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
/// // A method of every mechanism …
/// let a = pendulum.forward_dynamics(&q, &v, &u);
/// assert!((a[0] + 1.5 * 9.81 / 1.5 * 0.5_f64.sin()).abs() < 1e-12);
///
/// // … and one that `derivatives` adds: ẋ = A x + B u.
/// let (by_state, _by_input) = pendulum.linearize(&q, &v, &u);
/// assert!((by_state[(1, 0)] + 1.5 * 9.81 / 1.5 * 0.5_f64.cos()).abs() < 1e-12);
/// ```
///
/// A field of the struct is a parameter (`f64`, `f32` or the struct's own type parameter) or an element
/// (`linkwork::elements`). Parameters remain fields. Elements define the bodies, joints and forces of the
/// mechanism and are removed from the struct. The trait `linkwork::Mechanism` documents the generated methods
/// with their shapes, units and conventions; the rustdoc of the struct lists them. The guide,
/// `linkwork::guide`, is an introduction from the beginning.
///
/// **Order.** `#[mechanism]` must be above `#[derive(…)]`, so that the derives see the struct without its
/// elements. The other order is reported as an error.
///
/// **Errors** are compile errors at the affected tokens. All errors are reported together; an error in an
/// imported file includes its line and column.
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
/// | argument | meaning |
/// | --- | --- |
/// | `gravity = -9.81 * y` | uniform gravitational acceleration, a vector in ground axes, m/s²; the default is zero, or −9.81 z with a file |
/// | `scalar = f64` or `f32` | scalar type of a mechanism without parameters |
/// | `friction_speed = 0.01` | regularisation speed of dry friction in a file's joints, m/s or rad/s |
/// | `derivatives` | adds first derivatives of inverse and forward dynamics, and `linearize` |
/// | `momentum_derivatives` | adds derivatives of the generalized momenta and of their rates, for the Jacobians of implicit integration methods; includes `derivatives` |
/// | `second_derivatives` | adds second derivatives of inverse and forward dynamics and of the inputs' generalized forces, contracted with a vector of factors; includes `derivatives` |
/// | `centroidal` | adds the centroidal momentum matrix and its bias |
/// | `hamilton` | adds the Hamiltonian and the canonical equations as functions of configuration and momentum |
/// | `routh` | adds the Routhian and the motion without cyclic coordinates, as functions of their momenta |
/// | `conserved` | adds the quantities that are conserved in every motion without inputs: energy, Jacobi's integral, momenta |
/// | `regressor` | adds the joint torque regressor, and base parameters, for identification |
/// | `sensitivities` | adds derivatives of the dynamics with respect to the struct's parameters |
/// | `packed` | adds the mass matrix without entries that are always zero, and a function that writes the mass matrix to a matrix of the caller |
/// | `prepare` | adds `prepare()`, which precomputes all values that depend only on the parameters |
/// | `batch` | adds a variant of every function of the state that evaluates several states at once |
/// | `drawing` | adds the mechanism's geometry (`DRAWING`, `linkwork::drawing`), for programs that draw it |
/// | `equations = lagrange`, `hamilton`, `kane`, `routh` or `structure` | form of the equations in `EQUATIONS` and in the documentation: Lagrange's equations of any length, Hamilton's canonical equations, Kane's equations in independent speeds without multipliers, Routh's equations without cyclic coordinates, or only their structure. The default is Lagrange's equations if they are short enough to be readable |
/// | `formulation = multipliers` or `speeds` | whether constraints are solved by Lagrange multipliers (default) or in independent speeds (Kane) |
/// | `independent = (velocity, …)` | independent speeds of `formulation = speeds`; chosen automatically by default. User-defined generalized speeds are elements: `#[speed(…)] name: Speed` |
/// | `processor = detect` or `target` | `detect` (default): large functions use AVX2 and FMA, and products of large matrices AVX-512, if the processor supports them, even if the compilation target does not include them (x86-64, release builds, feature `std`). `target`: only the instructions of the target are used |
/// | `arithmetic = fast` or `reproducible` | `reproducible`: the same bits on every machine, and in C |
/// | `skip_passes = [pass, …]` | optimisation passes to skip: `frames` (moves link frames to sparse placements), `regroup` (moves mass properties towards the base), `parallel` (expresses links on parallel axes in common axes) and `limbs` (evaluates identical limbs, and joints of one path, in SIMD lanes); none by default. The results are equal up to rounding; skipping a pass makes the functions slower |
/// | `urdf = "path"` | a URDF file, relative to the crate's manifest; its changes trigger recompilation |
/// | `mjcf = "path"` | an MJCF file (MuJoCo) with the files that it includes; path as for `urdf` |
/// | `sdf = "path"` | an SDF file of one model; path as for `urdf` |
/// | `base = fixed` or `free` | whether the file's root link is fixed to the ground (default) or a floating base. MJCF files specify this themselves; `free` is valid only for files with one outermost body without a joint |
/// | `passive = honour` or `ignore` | whether damping, friction and springs of the file's joints and tendons are imported (default) or ignored |
/// | `mimic = follow` or `independent` | whether joints with `mimic`, and joints and bodies in MJCF's `<equality>`, are coupled (default) or independent |
/// | `contacts = file`, `ground` or `ignore` | `file`: the contacts of an MJCF file are imported. `ground`: only those of bodies with the world. `ignore` (default): none |
/// | `loops = refuse` or `close` | whether a link of a URDF file that is the child of several joints is an error (default), or all but one of these joints close loops |
/// | `limits = honour`, `ignore` or `stops` | `honour` (default): the limits of the file's joints are those of the trait `linkwork::Limits`. `ignore`: they are not imported. `stops`: in addition, joints stop at the limits of their coordinates |
/// | `inertia = check`, `trust` or `none` | `check` (default): physically impossible inertias are errors. `trust`: inertias are not checked. `none`: masses and inertias are not imported, for kinematics alone |
/// | `inputs = joints`, `actuators` or `none` | whether every moving joint with one degree of freedom is an input, every actuator of an MJCF file, or nothing; the default is actuators for MJCF files and joints for others |
/// | `lock = ["joint", …]` | joints that are locked at coordinate zero |
/// | `parameters = inertial`, `[inertial("link", …), placement, damping, friction]` | values of the file that become fields of the struct, of all links or joints or of the named ones |
/// | `snap = 1e-4` | tolerance (rad, m) within which angles, positions and axes of joints are rounded to right angles, zero and coordinate axes; the documentation of the struct lists the rounded values |
/// | `crate = path::to::linkwork` | path of the crate `linkwork` in generated code, if `Cargo.toml` renames it (`crate = name`) or another crate re-exports it (`crate = other::linkwork`) |
///
/// With `inertia = none`, no body needs a mass. The generated functions are frames with their velocities,
/// accelerations and Jacobians, the configuration manifold (`neutral`, `integrate`, `difference`,
/// `tangent_rate`), residuals and Jacobians of constraints, `assemble`, outputs and `generalized_forces`.
/// The dynamics and the trait `Mechanism` are not generated. Use this option for files that describe only
/// shapes and joints; mass properties in the file are ignored.
///
/// A mechanism has at most 256 degrees of freedom and 1024 bodies, because the generated code is expanded for
/// each of them. Products of numeric masses, moments and lengths must be finite.
///
/// `ground` is the fixed frame; any other link of this name is renamed to `ground_link`. A fixed root with
/// the name `ground` is the ground itself, and remains one of the frames. A link `world` that joints refer to
/// but the file does not declare is its root. Links that are connected to a fixed root by fixed joints appear
/// in no equation, so their mass properties are not checked.
///
/// # A closed loop in independent speeds
///
/// ```
/// use linkwork::prelude::*;
///
/// /// A four-bar linkage, formulated in the speed of its crank.
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
    if let Some(bare) = linkwork_compiler::struct_without_fields_if_duplicate(&item, &text, here.line()) {
        return bare.into();
    }
    let emitted = match above::stands_below_a_derive(&text, here.line(), here.column()) {
        false => linkwork_compiler::expand(arguments.into(), item, &folder),
        true => linkwork_compiler::expand_derive_above_to_error(arguments.into(), item, &folder),
    };
    let mut tokens = TokenStream::from(emitted.tokens);
    match emitted.text.parse::<TokenStream>() {
        Ok(text) => tokens.extend(text),
        Err(error) => {
            let message = format!("internal error of Linkwork: {error}");
            tokens.extend(format!("::core::compile_error!({message:?});").parse::<TokenStream>());
        }
    }
    tokens
}

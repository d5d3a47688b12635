//! Diagnostics for functions that a mechanism lacks. Generated code declares each missing function under a
//! trait bound that no type satisfies, so that a call to it is a compile error with advice. Because the bound
//! is never satisfied, such a function does not conflict with outputs or methods of the same name.
//!
//! The lifetime parameter makes rustc accept a bound that names no other parameter; without it the
//! declaration itself would be rejected.

/// Trait bound, never satisfied, of functions that need the option `derivatives`: a call is an error that
/// names the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `derivatives`",
    label = "this needs the option `derivatives`",
    note = "add the option to the attribute: `#[mechanism(…, derivatives)]`"
)]
pub trait AsksForDerivatives<'a> {}

/// Trait bound, never satisfied, of functions that need the option `second_derivatives`: a call is an error
/// that names the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `second_derivatives`",
    label = "this needs the option `second_derivatives`",
    note = "add the option to the attribute: `#[mechanism(…, second_derivatives)]`"
)]
pub trait AsksForSecondDerivatives<'a> {}

/// Trait bound, never satisfied, of functions that need the option `momentum_derivatives`: a call is an error
/// that names the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `momentum_derivatives`",
    label = "this needs the option `momentum_derivatives`",
    note = "add the option to the attribute: `#[mechanism(…, momentum_derivatives)]`"
)]
pub trait AsksForMomentumDerivatives<'a> {}

/// Trait bound, never satisfied, of functions that need the option `centroidal`: a call is an error that
/// names the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `centroidal`",
    label = "this needs the option `centroidal`",
    note = "add the option to the attribute: `#[mechanism(…, centroidal)]`"
)]
pub trait AsksForCentroidal<'a> {}

/// Trait bound, never satisfied, of functions that need the option `hamilton`: a call is an error that names
/// the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `hamilton`",
    label = "this needs the option `hamilton`",
    note = "add the option to the attribute: `#[mechanism(…, hamilton)]`"
)]
pub trait AsksForHamilton<'a> {}

/// Trait bound, never satisfied, of functions that need the option `routh`: a call is an error that names the
/// missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `routh`",
    label = "this needs the option `routh`",
    note = "add the option to the attribute: `#[mechanism(…, routh)]`; the mechanism needs cyclic \
            coordinates"
)]
pub trait AsksForRouth<'a> {}

/// Trait bound, never satisfied, of functions that need the option `conserved`: a call is an error that names
/// the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `conserved`",
    label = "this needs the option `conserved`",
    note = "add the option to the attribute: `#[mechanism(…, conserved)]`"
)]
pub trait AsksForConserved<'a> {}

/// Trait bound, never satisfied, of functions that need the option `regressor`: a call is an error that names
/// the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `regressor`",
    label = "this needs the option `regressor`",
    note = "add the option to the attribute: `#[mechanism(…, regressor)]`"
)]
pub trait AsksForRegressor<'a> {}

/// Trait bound, never satisfied, of functions that need the option `sensitivities`: a call is an error that
/// names the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `sensitivities`",
    label = "this needs the option `sensitivities`",
    note = "add the option to the attribute: `#[mechanism(…, sensitivities)]`; the mechanism needs \
            parameters"
)]
pub trait AsksForSensitivities<'a> {}

/// Trait bound, never satisfied, of functions that need the option `packed`: a call is an error that names
/// the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `packed`",
    label = "this needs the option `packed`",
    note = "add the option to the attribute: `#[mechanism(…, packed)]`"
)]
pub trait AsksForPacked<'a> {}

/// Trait bound, never satisfied, of functions that need the option `prepare`: a call is an error that names
/// the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `prepare`",
    label = "this needs the option `prepare`",
    note = "add the option to the attribute: `#[mechanism(…, prepare)]`; the mechanism needs parameters"
)]
pub trait AsksForPrepare<'a> {}

/// Trait bound, never satisfied, of functions that need the option `batch`: a call is an error that names the
/// missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `batch`",
    label = "this needs the option `batch`",
    note = "add the option to the attribute: `#[mechanism(…, batch)]`"
)]
pub trait AsksForBatch<'a> {}

/// Trait bound, never satisfied, of functions that need the option `drawing`: a call is an error that names
/// the missing option.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `drawing`",
    label = "this needs the option `drawing`",
    note = "add the option to the attribute: `#[mechanism(…, drawing)]`"
)]
pub trait AsksForDrawing<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism with loops, rolling or other constraints.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints",
    label = "only mechanisms with constraints have this",
    note = "its coordinates are independent of each other: every `q` and `v` is a state"
)]
pub trait HasConstraints<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism with masses and inertias.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no inertia",
    label = "only mechanisms with inertia have this",
    note = "it is declared with `inertia = none`: kinematics alone"
)]
pub trait HasInertia<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism without constraints.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has constraints",
    label = "only mechanisms without constraints have this",
    note = "`forward_dynamics_derivatives` and `linearize` take the constraints into account"
)]
pub trait HasNoConstraints<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism with sliding contacts.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no contacts that slip",
    label = "only mechanisms with friction at contacts have this",
    note = "its equations always have a solution: `constrained_dynamics`"
)]
pub trait HasSlipping<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism without sliding contacts.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has contacts that slip",
    label = "only mechanisms whose friction does not follow from multipliers have this",
    note = "`forward_dynamics_derivatives` takes the friction into account"
)]
pub trait HasNoSlipping<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism with unilateral contacts.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no contacts that open and close",
    label = "only mechanisms with contacts or stops have this",
    note = "declare one: `#[contact(ball.sphere(radius), ground.plane(z))] bounce: Contact`, or a `Limit` \
            with `restitution`"
)]
pub trait HasContacts<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism with declared generalized speeds.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no speeds of its own",
    label = "only mechanisms with declared speeds have this",
    note = "declare them: `#[speed(rate(psi) * sin(theta))] p: Speed`; without, the velocities are those of \
            the joints"
)]
pub trait HasSpeeds<'a> {}

/// Trait bound, never satisfied, of functions that need joint velocities, not declared generalized speeds, as
/// the velocities of the mechanism.
#[diagnostic::on_unimplemented(
    message = "velocities of `{Self}` are declared speeds, whose effect on a configuration depends on it",
    label = "this does not depend on the configuration",
    note = "`Mechanism::displacement_rate(&m, &q, &dv, &v)` is the rate of a displacement from `q`, and \
            `Derivatives::displacement_rate_derivatives` and `Derivatives::integrate_derivatives_at` have \
            its derivatives and those of `integrate`"
)]
pub trait HasNoSpeeds<'a> {}

/// Trait bound, never satisfied, of functions that need the inverse of the mass matrix, which this mechanism
/// lacks.
#[diagnostic::on_unimplemented(
    message = "the mass matrix of `{Self}` has no inverse",
    label = "coordinates without inertia follow from constraints",
    note = "`forward_dynamics` and its derivatives take the constraints into account"
)]
pub trait HasRegularMass<'a> {}

/// Trait bound, never satisfied, of functions that need Jacobians of outputs, which outputs of accelerations
/// and reactions lack.
#[diagnostic::on_unimplemented(
    message = "an output of accelerations or reactions has no Jacobian",
    label = "this output has none",
    note = "with the option `derivatives`, an output of accelerations has a function of its name with \
            `_derivatives` after it; one of reactions has none yet"
)]
pub trait HasJacobian<'a> {}

/// Trait bound, never satisfied, of functions that need frames, which a prepared mechanism lacks.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no frames",
    label = "the mechanism that it was prepared from has them",
    note = "call this on the mechanism itself: frames are not prepared"
)]
pub trait HasFrames<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism with parameters.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no parameters",
    label = "only mechanisms with parameters have this",
    note = "all its values are constants, which were checked at compile time"
)]
pub trait HasParameters<'a> {}

/// Trait bound, never satisfied, of functions that need the stored parameters of a mechanism, which a
/// prepared mechanism lacks.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not store its parameters",
    label = "the mechanism that it was prepared from has this",
    note = "call this on the mechanism itself, before it is prepared"
)]
pub trait HoldsParameters<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism whose parameters include values of its
/// robot file.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no values of a file as parameters",
    label = "this needs the argument `parameters`",
    note = "name them: `#[mechanism(urdf = \"…\", parameters = inertial)]`"
)]
pub trait HasFileParameters<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism whose parameters include the mass
/// properties of a robot file's links.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no mass properties of links as parameters",
    label = "this needs `parameters = inertial`",
    note = "write `#[mechanism(urdf = \"…\", parameters = inertial)]`, or `inertial(\"link\", …)` for some \
            of the links"
)]
pub trait HasFileInertials<'a> {}

/// Trait bound, never satisfied, of functions that need a mechanism with declared equilibria.
#[diagnostic::on_unimplemented(
    message = "`{Self}` declares no equilibrium",
    label = "this needs a declared equilibrium",
    note = "declare one among the fields: `#[equilibrium(joint = angle)] upright: Equilibrium`"
)]
pub trait DeclaresEquilibria<'a> {}

/// Trait bound of mechanisms whose arithmetic gives the same bits on every machine. All types have this trait
/// with the feature `reproducible`, and none without it.
#[diagnostic::on_unimplemented(
    message = "`arithmetic = reproducible` needs the feature `reproducible` of the crate `linkwork`",
    label = "the arithmetic of this program depends on the processor",
    note = "add it to this dependency in Cargo.toml: `features = [\"reproducible\"]`"
)]
pub trait HasReproducibleArithmetic {}

#[cfg(feature = "reproducible")]
impl<T> HasReproducibleArithmetic for T {}

//! Generated code of mechanisms with constraints: constrained dynamics around the generated elimination,
//! assembly and projection.

use super::signature::SignatureContext;
use crate::catalogue::{Argument, GeneratedId, Shape};
use crate::derive::Function;
use crate::mechanism::DegreeOfFreedomCounts;
use std::fmt::Write;

pub use super::constraint_data::Constraints;

/// Source text of the types and arguments of constrained functions.
struct ConstrainedSignatureTexts {
    /// Rust type of a configuration.
    q: String,
    /// Rust type of a velocity.
    v: String,
    /// Rust type of the residuals of the holonomic constraints.
    residuals: String,
    /// Rust type of the multipliers of all constraints.
    multipliers: String,
    /// Parameter `t: f64, ` if functions take time, otherwise empty.
    t: String,
    /// Call argument `t, ` if functions take time, otherwise empty.
    pass: &'static str,
    /// Time argument of trait functions: `t`, or zero if functions do not take time.
    any: String,
}

impl ConstrainedSignatureTexts {
    fn new(c: &Constraints, s: &SignatureContext<'_>) -> ConstrainedSignatureTexts {
        let scalar = s.scalar.scalar_name();
        ConstrainedSignatureTexts {
            q: s.vector_type(s.nq),
            v: s.vector_type(s.nv),
            residuals: s.vector_type(c.holonomic),
            multipliers: s.vector_type(c.names.len()),
            t: if s.time { format!("t: {scalar}, ") } else { String::new() },
            pass: if s.time { "t, " } else { "" },
            any: if s.time {
                "t".to_string()
            } else {
                format!("::linkwork::__private::constant::<{scalar}>(0.0)")
            },
        }
    }
}

/// Writes the constants for the numbers of constraints and degrees of freedom, and for the names.
pub fn write_constants(out: &mut String, c: &Constraints) {
    if c.names.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "/// Number of scalar constraints.\npub const NC: usize = {};
        /// Number of holonomic constraints, which come first.\npub const NH: usize = {};
        /// Name of every constraint.\npub const CONSTRAINTS: [&'static str; {}] = {:?};
        /// Degrees of freedom: independent coordinates.\npub const NP: usize = {};
        /// Degrees of freedom: independent velocities.\npub const NS: usize = {};",
        c.names.len(),
        c.holonomic,
        c.names.len(),
        c.names,
        c.freedom.coordinates,
        c.freedom.velocities,
    );
}

/// Writes the assembly functions of a mechanism without inertia, which does not implement the trait
/// `Constrained`.
pub fn write_kinematic_assembly(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    if c.names.is_empty() {
        return;
    }
    let ConstrainedSignatureTexts { q, v, pass, .. } = ConstrainedSignatureTexts::new(c, s);
    let loops = format!(
        "let loops = ::linkwork::__private::Loops {{
            names: Self::CONSTRAINTS,
            angles: &{:?},
            turns: {:?},
            sizes: [Self::NH, {}],
            residuals: |q: &{q}| self.constraint_residuals({pass}q),
            jacobian: |q: &{q}| self.constraint_jacobian({pass}q),
            integrate: |q: &{q}, dv: &{v}| self.integrate(q, dv),
        }};",
        c.angles,
        (0..s.nv).map(|k| c.turns.get(k) == Some(&true)).collect::<Vec<_>>(),
        s.nv,
    );
    let format_assembly_call = |function: &str, more: &str| {
        format!("{loops} ::linkwork::__private::{function}(&loops, q, held{more})")
    };
    let bodies = [
        format_assembly_call("assemble", ", ::core::option::Option::None"),
        format_assembly_call("assemble", ", ::core::option::Option::Some(mode)"),
        format_assembly_call("assembly_mode", ""),
    ];
    write_assembly_functions(out, c, s, &bodies);
}

/// Writes `assemble`, `assemble_in_mode` and `assembly_mode` with the given bodies.
fn write_assembly_functions(
    out: &mut String,
    c: &Constraints,
    s: &SignatureContext<'_>,
    bodies: &[String; 3],
) {
    let ConstrainedSignatureTexts { q, t, .. } = ConstrainedSignatureTexts::new(c, s);
    let [any, one, mode] = bodies;
    let _ = writeln!(
        out,
        "/// Returns a configuration near `q` that satisfies the constraints. The coordinates whose \
         velocities have the indices `held` are not changed. Angles are within half a turn of `q`. See \
         [`assemble`](::linkwork::Constrained::assemble) of the trait.
        ///
        /// # Errors
        ///
        /// [`Configuration`](::linkwork::ConstraintError::Configuration) if no such configuration is found,
        /// [`Held`](::linkwork::ConstraintError::Held) for an invalid index.
        pub fn assemble(&self, {t}q: &{q}, held: &[usize]) -> ::core::result::Result<{q}, ::linkwork::ConstraintError> {{ {any} }}
        /// Returns a configuration around `q` that satisfies the constraints in the assembly mode `mode`, 1
        /// or −1. See [`assemble_in_mode`](::linkwork::Constrained::assemble_in_mode) of the trait.
        ///
        /// # Errors
        ///
        /// The errors of [`assemble`](Self::assemble), and [`Mode`](::linkwork::ConstraintError::Mode) if
        /// only configurations in the other mode are found.
        pub fn assemble_in_mode(&self, {t}q: &{q}, held: &[usize], mode: i8) -> ::core::result::Result<{q}, ::linkwork::ConstraintError> {{ {one} }}
        /// Returns the assembly mode of the configuration `q`, 1 or −1, with respect to the coordinates whose
        /// velocities are not `held`; `None` if these do not determine a mode. See
        /// [`assembly_mode`](::linkwork::Constrained::assembly_mode) of the trait.
        #[must_use]
        pub fn assembly_mode(&self, {t}q: &{q}, held: &[usize]) -> ::core::option::Option<i8> {{ {mode} }}"
    );
}

/// Writes the inherent functions of a mechanism with constraints: dynamics, assembly, completion, projection
/// and derivatives.
pub fn write_methods(out: &mut String, c: &Constraints, functions: &[Function], s: &SignatureContext<'_>) {
    if c.names.is_empty() {
        return;
    }
    let ConstrainedSignatureTexts { q, v, multipliers, t, pass, any, .. } =
        ConstrainedSignatureTexts::new(c, s);
    let (nv, nc) = (s.nv, c.names.len());
    let scalar = s.scalar.scalar_name();
    let format_constrained_call = |function: &str, more: &str| {
        format!("::linkwork::Constrained::{function}(self, {any}, q, held{more})")
    };
    let bodies = [
        format_constrained_call("assemble", ""),
        format_constrained_call("assemble_in_mode", ", mode"),
        format_constrained_call("assembly_mode", ""),
    ];
    write_assembly_functions(out, c, s, &bodies);
    if c.slipping.is_empty() {
        write_inverse_dynamics(out, c, s);
    }
    let _ =
        writeln!(
        out,
        "/// Acceleration under the forces `tau` and the constraints: `M v̇ + h = τ + Jᵀ λ`, `J v̇ + b = 0`.
        ///
        /// The Lagrange multipliers follow from a sparse elimination. Near singular configurations, and if
        /// the elimination would lose digits because masses are very different, an orthogonal factorisation
        /// of `J` in the metric of the kinetic energy is used instead. Through a singular configuration the
        /// accelerations are continuous. Redundant or contradictory constraints are solved by least squares.
        #[inline]\n#[must_use]
        pub fn forward_dynamics(&self, {t}q: &{q}, v: &{v}, tau: &{v}) -> {v} {{
            self.constrained_dynamics({pass}q, v, tau).0
        }}
        {solve}
        /// Returns the velocity change of minimum kinetic energy that removes the constraint velocities
        /// `gap`: `J x = −gap`.
        #[inline]\n#[must_use]
        pub fn constraint_correction(&self, {t}q: &{q}, gap: &{multipliers}) -> {v} {{
            self.__constraint_solution({pass}q, &[::linkwork::__private::constant::<{scalar}>(0.0); {nv}], &gap.data.0[0])
        }}
        #[doc(hidden)]\n#[inline]
        pub fn __constraint_solution(&self, {t}q: &{q}, force: &[{scalar}; {nv}], bias: &[{scalar}; {nc}]) -> {v} {{
            let found = self.__constraint_correction({pass}q, force, bias);
            {correction}.0
        }}
        #[doc(hidden)]
        pub const __STRUCTURE: ::linkwork::__private::Structure<'static, {nc}> = \
            ::linkwork::__private::Structure {{ groups: {groups:?}, determining: &{determining:?}, rank: \
            {rank} }};
        /// Returns the velocity that has the entries `held` (indices) of `v` and satisfies the constraints.
        /// If this does not determine it, it is the one nearest to `v` in the metric of the kinetic energy.
        /// See [`complete_velocity`](::linkwork::Constrained::complete_velocity) of the trait.
        ///
        /// # Errors
        ///
        /// [`Velocity`](::linkwork::ConstraintError::Velocity) if the held entries contradict the
        /// constraints, [`Held`](::linkwork::ConstraintError::Held) for an invalid index.
        pub fn complete_velocity(&self, {t}q: &{q}, v: &{v}, held: &[usize]) -> ::core::result::Result<{v}, ::linkwork::ConstraintError> {{
            ::linkwork::Constrained::complete_velocity(self, {any}, q, v, held)
        }}
        /// Returns the acceleration that has the entries `held` (indices) of `a` and satisfies the
        /// constraints. If this does not determine it, it is the one nearest to `a` in the metric of the
        /// kinetic energy. See [`complete_acceleration`](::linkwork::Constrained::complete_acceleration) of
        /// the trait.
        ///
        /// # Errors
        ///
        /// [`Acceleration`](::linkwork::ConstraintError::Acceleration) if the held entries contradict the
        /// constraints, [`Held`](::linkwork::ConstraintError::Held) for an invalid index.
        pub fn complete_acceleration(&self, {t}q: &{q}, v: &{v}, a: &{v}, held: &[usize]) -> ::core::result::Result<{v}, ::linkwork::ConstraintError> {{
            ::linkwork::Constrained::complete_acceleration(self, {any}, q, v, a, held)
        }}
        /// Returns the configuration nearest to `q`, in the metric of the kinetic energy, that satisfies the
        /// constraints.
        ///
        /// # Errors
        ///
        /// [`Configuration`](::linkwork::ConstraintError::Configuration) if Newton's method does not
        /// converge.
        pub fn project_configuration(&self, {t}q: &{q}) -> ::core::result::Result<{q}, ::linkwork::ConstraintError> {{
            ::linkwork::Constrained::project_configuration(self, {any}, q)
        }}
        /// Returns the velocity nearest to `v`, in the metric of the kinetic energy, that satisfies the
        /// constraints.
        ///
        /// # Errors
        ///
        /// [`Velocity`](::linkwork::ConstraintError::Velocity) if no velocity satisfies them.
        pub fn project_velocity(&self, {t}q: &{q}, v: &{v}) -> ::core::result::Result<{v}, ::linkwork::ConstraintError> {{
            ::linkwork::Constrained::project_velocity(self, {any}, q, v)
        }}",
        correction = constrained_solution_expression(c, false, &format!("careful_response(self, &Self::__STRUCTURE, {any}, q, force, bias)")),
        groups = c.groups,
        determining = c.determining,
        rank = s.nv.saturating_sub(c.freedom.velocities),
        solve = match c.slipping.is_empty() {
            true => constrained_dynamics_source(c, s),
            false => slipping_dynamics_source(c, s),
        },
    );
    if functions.iter().any(|f| f.id == GeneratedId::MotionDerivatives) {
        write_constrained_derivatives(out, c, s);
    }
}

/// Writes the function `constrained_inverse_dynamics`.
fn write_inverse_dynamics(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    let ConstrainedSignatureTexts { q, v, multipliers, t, any, .. } = ConstrainedSignatureTexts::new(c, s);
    let _ = writeln!(
        out,
        "/// Inverse dynamics under the constraints: returns the generalized forces `τ` at the velocities \
         `driven` (indices) and the multipliers `λ` that cause a motion, `M a + h = τ + Jᵀ λ`. The number of \
         driven velocities is the number of degrees of freedom (`NS`). See \
         [`constrained_inverse_dynamics`](::linkwork::Constrained::constrained_inverse_dynamics) of the trait.
        ///
        /// # Errors
        ///
        /// [`Velocity`](::linkwork::ConstraintError::Velocity) and
        /// [`Acceleration`](::linkwork::ConstraintError::Acceleration) for a motion that violates the
        /// constraints, [`Undriven`](::linkwork::ConstraintError::Undriven) if forces at other velocities
        /// would be needed, [`Held`](::linkwork::ConstraintError::Held) for an invalid index.
        pub fn constrained_inverse_dynamics(&self, {t}q: &{q}, v: &{v}, a: &{v}, driven: &[usize]) -> \
            ::core::result::Result<({v}, {multipliers}), ::linkwork::ConstraintError> {{
            ::linkwork::Constrained::constrained_inverse_dynamics(self, {any}, q, v, a, driven)
        }}"
    );
}

/// Returns the expression for accelerations and multipliers from the result `found` of the elimination. The
/// rank-revealing call `careful` is used if the elimination would lose digits. Corrections always use
/// multipliers.
fn constrained_solution_expression(c: &Constraints, independent: bool, careful: &str) -> String {
    let quick = if c.overdetermined {
        "least_solution(&Self::__STRUCTURE.groups, Self::__STRUCTURE.rank, &found)"
    } else if independent {
        "solution_with_predetermined_pivots(&found)"
    } else {
        "regular_solution(&Self::__STRUCTURE.groups, &found)"
    };
    format!(
        "match ::linkwork::__private::{quick} {{
            ::core::option::Option::Some(solution) => solution,
            ::core::option::Option::None => ::linkwork::__private::{careful},
        }}"
    )
}

/// Returns the function `constrained_dynamics` of a mechanism without sliding contacts.
fn constrained_dynamics_source(c: &Constraints, s: &SignatureContext<'_>) -> String {
    let ConstrainedSignatureTexts { q, v, multipliers, t, pass, any, .. } =
        ConstrainedSignatureTexts::new(c, s);
    let careful = format!("rank_revealing_dynamics(self, &Self::__STRUCTURE, {any}, q, v, tau)");
    let solution = constrained_solution_expression(c, c.independent, &careful);
    format!(
        "/// Returns the acceleration and the multipliers `λ` of the constraints, in the units of the table \
         of constraints. Multipliers of redundant constraints have minimum norm.
        #[inline]\n#[must_use]
        pub fn constrained_dynamics(&self, {t}q: &{q}, v: &{v}, tau: &{v}) -> ({v}, {multipliers}) {{
            let found = self.__constrained_dynamics({pass}q, v, tau);
            {solution}
        }}"
    )
}

/// Returns the functions of constrained dynamics of a mechanism with sliding contacts.
fn slipping_dynamics_source(c: &Constraints, s: &SignatureContext<'_>) -> String {
    let ConstrainedSignatureTexts { q, v, multipliers, t, pass, .. } = ConstrainedSignatureTexts::new(c, s);
    let (scalar, slipping) = (s.scalar.scalar_name(), &c.slipping);
    format!(
        "/// Returns the acceleration and the multipliers `λ` of the constraints, in the units of the table \
         of constraints. Multipliers of sliding contacts are normal forces; friction is proportional to \
         their magnitudes. The result is NaN if [`try_constrained_dynamics`](Self::try_constrained_dynamics) \
         fails.
        #[inline]\n#[must_use]
        pub fn constrained_dynamics(&self, {t}q: &{q}, v: &{v}, tau: &{v}) -> ({v}, {multipliers}) {{
            let lost = ::linkwork::__private::constant::<{scalar}>(f64::NAN);
            self.try_constrained_dynamics({pass}q, v, tau).unwrap_or_else(|_| (<{v}>::repeat(lost), <{multipliers}>::repeat(lost)))
        }}
        /// Returns the result of [`constrained_dynamics`](Self::constrained_dynamics), or an error if there
        /// is no unique solution.
        ///
        /// # Errors
        /// `Jammed` if the motion does not determine the normal force of a sliding contact (Painlevé's
        /// paradox); `Singular` if other constraints are redundant.
        #[inline]
        pub fn try_constrained_dynamics(&self, {t}q: &{q}, v: &{v}, tau: &{v}) -> ::core::result::Result<({v}, {multipliers}), ::linkwork::ConstraintError> {{
            ::linkwork::__private::slipping_solution(&{slipping:?}, &Self::__STRUCTURE.groups, \
                &Self::CONSTRAINTS, |sides| self.__constrained_dynamics({pass}q, v, tau, sides))
        }}"
    )
}

/// Writes the functions for derivatives of constrained motion and for its linearisation.
fn write_constrained_derivatives(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    let ConstrainedSignatureTexts { q, v, t, pass, .. } = ConstrainedSignatureTexts::new(c, s);
    let (scalar, nv, nc, nu, nh) = (s.scalar.scalar_name(), s.nv, c.names.len(), s.nu, c.holonomic);
    let DegreeOfFreedomCounts { coordinates: np, velocities: ns } = c.freedom;
    let square = s.shape_type(Shape::Square(nv));
    let solve = if c.slipping.is_empty() {
        format!(
            "|force: &[{scalar}; {nv}], bias: &[{scalar}; {nc}]| self.__constraint_solution({pass}q, force, bias)"
        )
    } else {
        let slipping = &c.slipping;
        format!(
            "::linkwork::__private::slipping_response(&{slipping:?}, &Self::__STRUCTURE.groups, &lambda, \
             |force, bias, sides| self.__slipping_response({pass}q, v, force, bias, sides))"
        )
    };
    let forces = "inputs.forces.into()";
    // Constructor of a matrix from an array of columns.
    let storage = "::linkwork::nalgebra::SMatrix::from_array_storage(::linkwork::nalgebra::ArrayStorage";
    let _ = writeln!(
        out,
        "/// `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂τ)` of [`forward_dynamics`](Self::forward_dynamics), constraints included.
        ///
        /// Column `i` of a derivative by `q` is along `q ⊕ ε eᵢ`, whether the constraints allow it or not;
        /// for ball and free joints this is a motion in body axes.
        #[must_use]
        pub fn forward_dynamics_derivatives(&self, {t}q: &{q}, v: &{v}, tau: &{v}) -> ({square}, {square}, \
            {square}) {{
            let (a, lambda) = self.constrained_dynamics({pass}q, v, tau);
            let parts = self.__motion_derivatives({pass}q, v, &a, &lambda.data.0[0]);
            ::linkwork::__private::constrained_derivatives(&parts, {solve})
        }}
        {multipliers}/// Linearises the motion about `q`, `v` and the inputs `u`, at the instant, in \
            independent coordinates and velocities. If the constraints permit a choice, the velocities \
            `preferred` (indices) are independent.
        ///
        /// Displacements of ball and free joints are measured in body axes: where those spin, the matrix
        /// changes along a steady motion, and its eigenvalues are not the exponents of stability.
        ///
        /// # Errors
        /// `Singular` if constraints lose rank{jams}.
        pub fn linearize(&self, {t}q: &{q}, v: &{v}, u: &{u}, preferred: &[usize]) -> \
            ::core::result::Result<::linkwork::constraint::Linearization<{scalar}, {nx}, {nu}, {np}, {ns}>, \
            ::linkwork::ConstraintError> {{
            let inputs = self.__input_derivatives({pass}q, v, u);
            let (a, lambda) = self.{motion};
            let parts = self.__motion_derivatives({pass}q, v, &a, &lambda.data.0[0]).with_inputs(&inputs);
            let (by_q, by_v, by_force) = ::linkwork::__private::constrained_derivatives(&parts, {solve});
            ::linkwork::__private::Motion {{
                by_q,
                by_v,
                by_u: by_force * ::linkwork::nalgebra::SMatrix::<{scalar}, {nv}, \
                    {nu}>::from_array_storage(::linkwork::nalgebra::ArrayStorage(inputs.by_u)),
                jacobian: self.constraint_jacobian({pass}q),
                rates_by_q: {storage}(parts.rates_by_q)),
                turning: {storage}(parts.turning)),
                holonomic: {nh},
                preferred,
            }}.independent()
        }}",
        multipliers = multiplier_derivatives_source(c, s),
        u = s.vector_type(nu),
        nx = np + ns,
        motion = if c.slipping.is_empty() {
            format!("constrained_dynamics({pass}q, v, &{forces})")
        } else {
            format!("try_constrained_dynamics({pass}q, v, &{forces})?")
        },
        jams = if c.slipping.is_empty() { "" } else { ", `Jammed` if friction jams" },
    );
}

/// Returns the generated function for derivatives of multipliers, or an empty text if it is not available.
fn multiplier_derivatives_source(c: &Constraints, s: &SignatureContext<'_>) -> String {
    if !are_constraints_differentiable(c) {
        return String::new();
    }
    let ConstrainedSignatureTexts { q, v, t, any, .. } = ConstrainedSignatureTexts::new(c, s);
    let rows = s.shape_type(Shape::Matrix(c.names.len(), s.nv));
    format!(
        "/// `(∂λ/∂q, ∂λ/∂v, ∂λ/∂τ)` of the multipliers of [`constrained_dynamics`](Self::constrained_dynamics): a row for each constraint.
        ///
        /// Column `i` of a derivative by `q` is along `q ⊕ ε eᵢ`, whether the constraints allow it or not.
        /// Derivatives for redundant constraints have minimum norm.
        #[must_use]
        pub fn multiplier_derivatives(&self, {t}q: &{q}, v: &{v}, tau: &{v}) -> ({rows}, {rows}, {rows}) {{
            ::linkwork::ConstrainedDerivatives::multiplier_derivatives(self, {any}, q, v, tau)
        }}
        "
    )
}

/// Writes the integrator hooks that make states satisfy the constraints.
pub fn write_projection_hooks(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    if c.names.is_empty() {
        return;
    }
    let ConstrainedSignatureTexts { q, v, .. } = ConstrainedSignatureTexts::new(c, s);
    let _ = writeln!(
        out,
        "const CONSTRAINED: bool = true;
        #[inline]\nfn project(&self, t: {scalar}, q: &{q}, v: &{v}) -> ::core::result::Result<({q}, {v}), \
            ::linkwork::ConstraintError> {{
            ::linkwork::Constrained::project_state(self, t, q, v)
        }}
        #[inline]\nfn velocity_change_by_impulse(&self, t: {scalar}, q: &{q}, v: &{v}, h: {scalar}, p: &{v}) \
            -> {v} {{
            ::linkwork::Constrained::constrained_impulse(self, t, q, v, h, p)
        }}
        fn is_nearly_singular(&self, t: {scalar}, q: &{q}, dv: &{v}) -> bool {{
            ::linkwork::__private::nearly_singular(self, &Self::__STRUCTURE, t, q, dv)
        }}",
        scalar = s.scalar.scalar_name(),
    );
    if !c.slipping.is_empty() {
        out.push_str("const SLIPPING: bool = true;\n");
    }
}

/// Writes the trait's forward dynamics that reports an error, for mechanisms with sliding contacts.
pub fn write_try_forward_dynamics(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    if c.slipping.is_empty() {
        return;
    }
    let ConstrainedSignatureTexts { q, v, pass, .. } = ConstrainedSignatureTexts::new(c, s);
    let _ = writeln!(
        out,
        "#[inline]\nfn try_forward_dynamics(&self, t: {scalar}, q: &{q}, v: &{v}, tau: &{v}) -> \
         ::core::result::Result<{v}, ::linkwork::ConstraintError> {{
            self.try_constrained_dynamics({pass}q, v, tau).map(|(a, _)| a)
        }}",
        scalar = s.scalar.scalar_name(),
    );
}

/// Writes the functions of the trait `Constrained`, which call the inherent functions.
pub fn write_trait(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    let ConstrainedSignatureTexts { q, v, residuals, multipliers, pass, .. } =
        ConstrainedSignatureTexts::new(c, s);
    let (scalar, nv, nc) = (s.scalar.scalar_name(), s.nv, c.names.len());
    let t = Argument::T.argument_name();
    let _ = writeln!(
        out,
        "const CONSTRAINTS: [&'static str; {nc}] = Self::CONSTRAINTS;
        const ANGLES: &'static [usize] = &{angles:?};
        #[inline]\nfn constraint_residuals(&self, {t}: {scalar}, q: &{q}) -> {residuals} {{ \
            Self::constraint_residuals(self, {pass}q) }}
        #[inline]\nfn constraint_rates(&self, {t}: {scalar}, q: &{q}, v: &{v}) -> {multipliers} {{ \
            Self::constraint_rates(self, {pass}q, v) }}
        #[inline]\nfn constraint_jacobian(&self, {t}: {scalar}, q: &{q}) -> \
            ::linkwork::nalgebra::SMatrix<{scalar}, {nc}, {nv}> {{ Self::constraint_jacobian(self, {pass}q) }}
        #[inline]\nfn constraint_bias(&self, {t}: {scalar}, q: &{q}, v: &{v}) -> {multipliers} {{ \
            Self::constraint_bias(self, {pass}q, v) }}
        #[inline]\nfn constrained_dynamics(&self, {t}: {scalar}, q: &{q}, v: &{v}, tau: &{v}) -> ({v}, \
            {multipliers}) {{ Self::constrained_dynamics(self, {pass}q, v, tau) }}
        #[inline]\nfn constraint_correction(&self, {t}: {scalar}, q: &{q}, gap: &{multipliers}) -> {v} {{ \
            Self::constraint_correction(self, {pass}q, gap) }}
        #[inline]\nfn constraint_response(&self, {t}: {scalar}, q: &{q}, p: &{v}, gap: &{multipliers}) -> \
            {v} {{ Self::__constraint_solution(self, {pass}q, &p.data.0[0], &gap.data.0[0]) }}",
        angles = c.angles,
    );
}

/// Writes the derivatives of the stabilised motion, in which constraint violations decay. Integration methods
/// call them through the trait `Constrained`.
pub fn write_stabilized_motion_derivatives(out: &mut String, s: &SignatureContext<'_>) {
    let (scalar, q, v, u) =
        (s.scalar.scalar_name(), s.vector_type(s.nq), s.vector_type(s.nv), s.vector_type(s.nu));
    let _ = writeln!(
        out,
        "#[inline]\nfn stabilized_derivatives(&self, t: {scalar}, state: (&{q}, &{v}), u: &{u}, rate: \
         {scalar}) -> ::core::option::Option<({square}, {square}, {inputs})> {{
            ::linkwork::__private::stabilized_derivatives(self, t, state, u, rate)
        }}",
        square = s.shape_type(Shape::Square(s.nv)),
        inputs = s.shape_type(Shape::Matrix(s.nv, s.nu)),
    );
}

/// Returns true if the derivatives of the equations determine those of accelerations and multipliers. They do
/// not for sliding contacts, whose friction depends on multipliers.
pub fn are_constraints_differentiable(c: &Constraints) -> bool {
    !c.names.is_empty() && c.slipping.is_empty()
}

/// Writes the function with which generic code gets from the trait `Derivatives` to the trait
/// `ConstrainedDerivatives`.
pub fn write_visit_constraints(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    if are_constraints_differentiable(c) {
        let _ = writeln!(
            out,
            "#[inline]\nfn visit_constraints<V: ::linkwork::constraint::Visitor<{}, {}, {}, {}>>(&self, \
             visitor: V) -> ::core::option::Option<V::Output> {{
                ::core::option::Option::Some(::linkwork::constraint::Visitor::visit(visitor, self))
            }}",
            s.scalar.scalar_name(),
            s.nq,
            s.nv,
            s.nu
        );
    }
}

/// Writes `equation_derivatives`, the function of the trait `ConstrainedDerivatives` without a default.
pub fn write_derivatives_trait(out: &mut String, c: &Constraints, s: &SignatureContext<'_>) {
    let ConstrainedSignatureTexts { q, v, multipliers, pass, .. } = ConstrainedSignatureTexts::new(c, s);
    let (scalar, nv, nc) = (s.scalar.scalar_name(), s.nv, c.names.len());
    let t = Argument::T.argument_name();
    let _ = writeln!(
        out,
        "#[inline]\nfn equation_derivatives(&self, {t}: {scalar}, q: &{q}, v: &{v}, a: &{v}, lambda: \
         &{multipliers}) -> ::linkwork::constraint::EquationDerivatives<{scalar}, {nv}, {nc}> {{
            ::linkwork::constraint::EquationDerivatives::from(self.__motion_derivatives({pass}q, v, a, \
                &lambda.data.0[0]))
        }}"
    );
}

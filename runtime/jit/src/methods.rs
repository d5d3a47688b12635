//! Methods for the main functions of mechanisms, on slices and on vectors and matrices of nalgebra.

use crate::error::Error;
use crate::robot::{Robot, State};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Rotation3, Translation3, Vector3};

impl Robot {
    /// Returns the index of the function that a method of [`Robot`] calls, or an error if the robot has
    /// no such function.
    fn function_index_of_method(&self, method: Method) -> Result<usize, Error> {
        let name = METHODS[method as usize];
        let index = self.shared.methods[method as usize];
        index.ok_or_else(|| Error::unknown_name_error("function", name, self.shared.names()))
    }

    fn frame_function_index(&self, function: &str, frame: &str) -> Result<usize, Error> {
        self.shared.index.get(&format!("{function}({frame})")).copied().ok_or_else(|| {
            Error::unknown_name_error("frame", frame, self.frames().iter().map(String::as_str))
        })
    }

    fn vector_of_method(&self, method: Method, state: State<'_>) -> Result<DVector<f64>, Error> {
        self.call_function_at_state(self.function_index_of_method(method)?, state).map(DVector::from_vec)
    }

    fn matrices_of_function<const N: usize>(
        &self,
        index: usize,
        state: State<'_>,
    ) -> Result<[DMatrix<f64>; N], Error> {
        let values = self.call_function_at_state(index, state)?;
        let results = &self.shared.entries[index].results;
        let mut first = 0;
        Ok(std::array::from_fn(|k| {
            let Some(result) = results.get(k) else { return DMatrix::zeros(0, 0) };
            let own = &values[first..first + result.length()];
            first += result.length();
            DMatrix::from_column_slice(result.rows, result.columns, own)
        }))
    }

    /// Returns the placement of a frame in the ground frame.
    ///
    /// # Errors
    ///
    /// The mechanism has no such frame, or a slice has the wrong length.
    pub fn frame_placement(&self, frame: &str, q: &[f64]) -> Result<Isometry3<f64>, Error> {
        let index = self.frame_function_index("frame_placement", frame)?;
        let mut values = [0.0; 12];
        self.call_with_state_into(index, State { q, ..State::default() }, &mut values)?;
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&values[..9]));
        let position = Translation3::from(Vector3::from_column_slice(&values[9..]));
        Ok(Isometry3::from_parts(position, rotation.into()))
    }

    /// Returns the velocity of a frame in ground axes: that of its origin, then the angular velocity.
    ///
    /// # Errors
    ///
    /// The mechanism has no such frame, or a slice has the wrong length.
    pub fn frame_velocity(&self, frame: &str, q: &[f64], v: &[f64]) -> Result<DVector<f64>, Error> {
        let index = self.frame_function_index("frame_velocity", frame)?;
        self.call_function_at_state(index, State { q, v, ..State::default() }).map(DVector::from_vec)
    }

    /// Returns the acceleration of a frame in ground axes: that of its origin, then the angular acceleration.
    ///
    /// # Errors
    ///
    /// The mechanism has no such frame, or a slice has the wrong length.
    pub fn frame_acceleration(
        &self,
        frame: &str,
        q: &[f64],
        v: &[f64],
        a: &[f64],
    ) -> Result<DVector<f64>, Error> {
        let index = self.frame_function_index("frame_acceleration", frame)?;
        self.call_function_at_state(index, State { q, v, a, ..State::default() }).map(DVector::from_vec)
    }

    /// Returns the Jacobian of a frame, whose product with the velocity of the mechanism is the velocity of
    /// the frame.
    ///
    /// # Errors
    ///
    /// The mechanism has no such frame, or a slice has the wrong length.
    pub fn frame_jacobian(&self, frame: &str, q: &[f64]) -> Result<DMatrix<f64>, Error> {
        let index = self.frame_function_index("frame_jacobian", frame)?;
        let [jacobian] = self.matrices_of_function(index, State { q, ..State::default() })?;
        Ok(jacobian)
    }

    /// Returns the configuration in the pose of the robot file: free bodies are where the file places them,
    /// and a joint with a `ref` has this coordinate. All other coordinates are those of
    /// [`neutral`](Self::neutral). `nq` entries, m and rad.
    ///
    /// # Errors
    ///
    /// The parameters do not satisfy the conditions of the mechanism.
    pub fn initial_configuration(&self) -> Result<DVector<f64>, Error> {
        match self.function("initial_configuration") {
            Ok(f) => Ok(DVector::from_vec(self.evaluate(&f, &[])?)),
            Err(_) => self.neutral(),
        }
    }
}

macro_rules! methods {
    (@state $($name:ident)*) => { State { $($name,)* ..State::default() } };
    ($($(#[$doc:meta])* $kind:ident $name:ident $into:ident ($($argument:ident),*);)*) => {
        /// Functions of a mechanism that have methods of `Robot`.
        #[derive(Clone, Copy)]
        #[allow(non_camel_case_types, reason = "names of functions")]
        enum Method {
            $($name,)*
            neutral,
            integrate,
            difference,
            tangent_rate,
        }

        /// Names of the functions with methods, in the order of [`Method`].
        pub(crate) const METHODS: &[&str] = &[$(stringify!($name),)* "neutral", "integrate", "difference", "tangent_rate"];

        impl Robot {
            $(
                $(#[$doc])*
                ///
                /// # Errors
                ///
                /// The mechanism lacks this function, a slice has the wrong length, or a parameter has no
                /// value.
                pub fn $name(&self, $($argument: &[f64]),*) -> methods!(@type $kind) {
                    let state = methods!(@state $($argument)*);
                    methods!(@body $kind self $name state)
                }

                #[doc = concat!("Writes the result of [`", stringify!($name), "`](Self::", stringify!($name), ") \
                    without allocation, matrices by columns one after the other.")]
                ///
                /// # Errors
                ///
                #[doc = concat!("As [`", stringify!($name), "`](Self::", stringify!($name), ").")]
                pub fn $into(&self, $($argument: &[f64],)* out: &mut [f64]) -> Result<(), Error> {
                    self.call_with_state_into(
                        self.function_index_of_method(Method::$name)?, methods!(@state $($argument)*), out,
                    )
                }
            )*
        }
    };
    (@type scalar) => { Result<f64, Error> };
    (@type vector) => { Result<DVector<f64>, Error> };
    (@type matrix) => { Result<DMatrix<f64>, Error> };
    (@type two) => { Result<[DMatrix<f64>; 2], Error> };
    (@type three) => { Result<[DMatrix<f64>; 3], Error> };
    (@body scalar $self:ident $name:ident $state:ident) => {{
        let mut value = [0.0];
        $self.call_with_state_into($self.function_index_of_method(Method::$name)?, $state, &mut value)?;
        Ok(value[0])
    }};
    (@body vector $self:ident $name:ident $state:ident) => { $self.vector_of_method(Method::$name, $state) };
    (@body matrix $self:ident $name:ident $state:ident) => {{
        let [matrix] = $self.matrices_of_function($self.function_index_of_method(Method::$name)?, $state)?;
        Ok(matrix)
    }};
    (@body $some:ident $self:ident $name:ident $state:ident) => {
        $self.matrices_of_function($self.function_index_of_method(Method::$name)?, $state)
    };
}

methods! {
    /// Returns the mass matrix at configuration `q`.
    matrix mass_matrix mass_matrix_into(q);
    /// Returns the bias forces: the generalized forces that keep the accelerations zero, due to gravity,
    /// springs, dampers and velocities.
    vector bias_forces bias_forces_into(q, v);
    /// Returns the accelerations caused by the generalized forces `tau`.
    vector forward_dynamics forward_dynamics_into(q, v, tau);
    /// Returns the generalized forces that cause the accelerations `a`.
    vector inverse_dynamics inverse_dynamics_into(q, v, a);
    /// Returns the generalized forces that the inputs `u` cause.
    vector generalized_forces generalized_forces_into(q, v, u);
    /// Returns the generalized momentum of the mechanism, one entry per velocity.
    vector generalized_momentum generalized_momentum_into(q, v);
    /// Returns the rate of the generalized momentum without inputs.
    vector momentum_rate momentum_rate_into(q, v);
    /// Returns the kinetic energy of the mechanism, J.
    scalar kinetic_energy kinetic_energy_into(q, v);
    /// Returns the potential energy of the mechanism, J.
    scalar potential_energy potential_energy_into(q);
    /// Returns the centre of mass of the mechanism in the ground frame, m.
    vector center_of_mass center_of_mass_into(q);
    /// Returns the inverse of the mass matrix (option `derivatives`).
    matrix mass_matrix_inverse mass_matrix_inverse_into(q);
    /// Returns the derivatives of inverse dynamics with respect to `q` and `v` (option `derivatives`).
    two inverse_dynamics_derivatives inverse_dynamics_derivatives_into(q, v, a);
    /// Returns the derivatives of forward dynamics with respect to `q`, `v` and `tau` (option `derivatives`).
    three forward_dynamics_derivatives forward_dynamics_derivatives_into(q, v, tau);
    /// Returns the matrices `A` and `B` of the linearised equations `ẋ = A x + B u` of displacements and
    /// velocities (option `derivatives`).
    two linearize linearize_into(q, v, u);
}

macro_rules! others {
    ($($(#[$doc:meta])* $name:ident $into:ident ($($argument:ident),*) $state:expr;)*) => {
        impl Robot {
            $(
                $(#[$doc])*
                ///
                /// # Errors
                ///
                /// A slice has the wrong length, or a parameter has no value.
                pub fn $name(&self, $($argument: &[f64]),*) -> Result<DVector<f64>, Error> {
                    self.vector_of_method(Method::$name, $state)
                }

                #[doc = concat!("Writes the result of [`", stringify!($name), "`](Self::", stringify!($name), ") \
                    without allocation.")]
                ///
                /// # Errors
                ///
                #[doc = concat!("As [`", stringify!($name), "`](Self::", stringify!($name), ").")]
                pub fn $into(&self, $($argument: &[f64],)* out: &mut [f64]) -> Result<(), Error> {
                    self.call_with_state_into(self.function_index_of_method(Method::$name)?, $state, out)
                }
            )*
        }
    };
}

others! {
    /// Returns the configuration with all coordinates zero and identity quaternions.
    neutral neutral_into() State::default();
    /// Returns the configuration that is reached from `q` after one unit of time with the constant joint
    /// velocity `dv`.
    integrate integrate_into(q, dv) State { q, other: &[dv], ..State::default() };
    /// Returns the constant joint velocity that leads from one configuration to another in one unit of time.
    difference difference_into(from, to) State { other: &[from, to], ..State::default() };
    /// Returns the rate of the displacement `dv` for which `integrate(q, dv)` moves with velocity `v`.
    tangent_rate tangent_rate_into(dv, v) State { v, other: &[dv], ..State::default() };
}

//! Kinematics of a mechanism: joints and motion subspaces, velocities and accelerations, the constraint rows
//! at configurations, redundant rows, and the number of degrees of freedom. Independent of the syntax tree.

mod directions;
pub mod jet;
mod joint;
mod links;
pub mod mobility;
mod rates;
pub mod redundancy;
mod rows;
mod spatial;
pub mod speeds;

pub use crate::expr::replace::symbols_in;
pub use directions::{AXES, directions_in_plane, normalised_or_zero, perpendicular_directions};
pub use joint::{Dof, Joint, JointDrift, joint_of_link, joints_of_model};
pub use links::{accelerations, express_in_link_axes, twists};
pub use rates::{
    CachedDerivatives, cached_velocity_gradient, configuration_rate, coordinate_as_expression,
    coordinate_in_terms_of_q, coordinate_velocity, generalized_force_opposing_energy,
    rotation_entries_with_rates, time_derivative, time_derivatives_along_motion, velocity_gradient,
    velocity_gradients,
};
pub use rows::{CompiledConstraintRows, random_configuration, symbol_value_at_rest};
pub use spatial::{SpatialVector, map_spatial};

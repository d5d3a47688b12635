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
pub use directions::{AXES, in_plane, normalised_or_zero, perpendicular_directions};
pub use joint::{Dof, Drift, Joint, joint_of_link, joints_of_model};
pub use links::{accelerations, change_axes, twists};
pub use rates::{
    Partials, configuration_rate, coordinate_position, coordinate_velocity, differentiated_gradient,
    energy_gradient, motion_rates, position_in, rotation_rates, time_derivative, velocity_gradient,
    velocity_gradients,
};
pub use rows::{Rows, random_configuration, sampled_value};
pub use spatial::{Spatial, map_spatial};

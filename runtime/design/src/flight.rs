//! Aircraft: linearised motion about steady flight in the usual states, named flight modes, and stability and
//! control derivatives.
//!
//! A mechanism counts as an aircraft if its first six velocities are those of a `Free` joint between the
//! ground (axes north, east and down) and the airframe (axes forward, right and down), and if no force
//! depends on the horizontal position or the heading.
//!
//! ```
//! use linkwork::prelude::*;
//! use linkwork_design::flight::{self, Derivatives, FlightModes};
//! use linkwork_design::steady::equilibrium;
//!
//! /// A flying wing without drag; its thrust balances the component of the lift along the inclined axis.
//! #[mechanism(gravity = 9.81 * z, derivatives)]
//! struct Wing {
//!     elevon: Input,
//!     #[body(mass = 400, inertia = diagonal(900, 600, 1400))]
//!     airframe: Body,
//!     #[joint(ground -> airframe)]
//!     flight: Free,
//!     #[define(v(airframe / ground / ground))]
//!     velocity: Vector,
//!     #[define(angle_of_attack(airframe, velocity))]
//!     alpha: Scalar,
//!     #[define(sideslip(airframe, velocity))]
//!     beta: Scalar,
//!     #[define(0.6 * dot(velocity, velocity) * 12)]
//!     load: Scalar,
//!     #[define(omega(airframe / ground))]
//!     turning: Vector,
//!     #[acts(on = airframe, value = -load * (5 * alpha * airframe.z + beta * airframe.y))]
//!     lift: Force,
//!     #[acts(on = airframe, value = load * (elevon - 0.5 * alpha - 0.05 * dot(turning, airframe.y)) * airframe.y)]
//!     pitching: Torque,
//!     #[acts(on = airframe, value = load * (0.3 * beta - 0.2 * dot(turning, airframe.z)) * airframe.z)]
//!     yawing: Torque,
//!     #[acts(on = airframe, value = load * (-0.5 * beta - 0.6 * dot(turning, airframe.x)) * airframe.x)]
//!     rolling: Torque,
//!     #[acts(on = airframe, along = airframe.x)]
//!     thrust: Force,
//! }
//!
//! // Level flight at 40 m/s: pitch angle, sink rate, elevon and thrust are unknown.
//! let level = equilibrium(&Wing {})
//!     .moving([40.0, 0.0, 1.0, 0.0, 0.0, 0.0].into())
//!     .coordinates(["flight.wy"])
//!     .speeds(["flight.vz"])
//!     .inputs(["elevon", "thrust"]);
//! let found = level.nearest().find()?;
//! let system = flight::linear_system(&Wing {}, &found.q, &found.v, &found.u)?;
//! let modes = FlightModes::from_system(&system)?;
//! assert!(modes.short_period.unwrap().frequency() > 10.0 * modes.phugoid.unwrap().frequency());
//! // Slope of the moment divided by the slope of the force, −0.5 / −5, in m.
//! let margin = Derivatives::at_state(&Wing {}, &found.q, &found.v, &found.u)?.static_margin(1.0)?;
//! assert!((margin - 0.1).abs() < 1e-3);
//! # Ok::<(), linkwork_design::Error>(())
//! ```

mod derivatives;
mod modes;
mod states;

pub use derivatives::{Derivatives, Reference};
pub use modes::FlightModes;
pub use states::{LATERAL, LONGITUDINAL, linear_system};

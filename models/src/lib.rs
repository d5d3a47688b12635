//! Ready-made mechanisms for Linkwork, from the textbook's first page to humanoid robots.
//!
//! Each has a file of its own that states the problem, its source, its parameters and, where there is one, the
//! closed form of its motion; a test beside it holds the generated equations against that closed form.
//!
//! | mechanism | freedom | closed form |
//! | --- | --- | --- |
//! | [`Pendulum`] | 1 | period by an elliptic integral |
//! | [`DoublePendulum`] | 2 | mass matrix and bias forces |
//! | [`TriplePendulum`], [`QuintuplePendulum`] | 3, 5 | mass matrix and bias forces in absolute angles |
//! | [`SphericalPendulum`] | 2 | conical motion |
//! | [`CartPole`] | 2 | mass matrix and bias forces |
//! | [`Gyroscope`] | 3 | steady precession |
//! | [`HeavyTop`] | 3 | steady precession |
//! | [`ShaftWithSlider`] | 2 | `r = r₀ cosh ωt`, conserved momentum |
//! | [`SpringChain`] | 3 | natural frequencies, modal damping |
//! | [`Ur5`] | 6 | Denavit–Hartenberg parameters |
//! | [`Panda`], [`PandaArm`], [`LoadedPanda`] | 8, 7, 7 | Denavit–Hartenberg parameters |
//! | [`Solo12`] | 18 | free fall, leg kinematics |
//! | [`SimpleHumanoid`] | 35 | free fall |
//!
//! ```
//! use linkwork::prelude::*;
//! use linkwork_models::Pendulum;
//!
//! # fn main() -> Result<(), Error> {
//! let pendulum = Pendulum { g: 9.81, mass: 1.0, length: 0.5 };
//! let end = simulate(&pendulum).from([0.3], [0.0]).duration(2.0).finish()?;
//! println!("after two seconds: {:.4} rad", end.q[0]);
//! # Ok(())
//! # }
//! ```
//!
//! The examples beside this crate are the next step: `cargo run --release --example tour -p linkwork-models`.

mod arm6;
mod arm7;
mod cart_pole;
mod double_pendulum;
mod gyroscope;
mod heavy_top;
mod humanoid;
mod pendulum;
mod pendulum_chain;
mod quadruped;
mod shaft_with_slider;
mod spherical_pendulum;
mod spring_chain;
#[cfg(test)]
mod testing;

pub use arm6::Ur5;
pub use arm7::{LoadedPanda, Panda, PandaArm};
pub use cart_pole::CartPole;
pub use double_pendulum::DoublePendulum;
pub use gyroscope::Gyroscope;
pub use heavy_top::HeavyTop;
pub use humanoid::SimpleHumanoid;
pub use pendulum::Pendulum;
pub use pendulum_chain::{QuintuplePendulum, TriplePendulum};
pub use quadruped::Solo12;
pub use shaft_with_slider::ShaftWithSlider;
pub use spherical_pendulum::SphericalPendulum;
pub use spring_chain::SpringChain;

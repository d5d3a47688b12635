//! The guide, chapter by chapter. Its Rust examples are compiled and run as tests, and assert the statements
//! of the text. Begin with [`first_mechanism`]; the other chapters can be read in any order.
//!
//! | chapter | about |
//! | --- | --- |
//! | [`first_mechanism`] | a pendulum, from its declaration to its motion; a controller |
//! | [`recipes`] | short answers to frequent questions, with code |
//! | [`language`] | all declarations of a mechanism's struct |
//! | [`robots`] | mechanisms from URDF, MJCF and SDF files |
//! | [`constraints`] | closed loops, gears, rolling and sliding |
//! | [`contact`] | contacts that open and close, joint stops: impacts, friction |
//! | [`functions`] | generated functions, printed equations |
//! | [`simulating`] | integrators, inputs, events |
//! | [`drives`] | motors, gears, series springs, delays, controllers, muscles |
//! | [`control`] | code for any mechanism: steps with Jacobians, regulators, Kalman filters, names |
//! | [`batches`] | evaluation of many states at once |
//! | [`gpus`] | functions for millions of states on GPUs |
//! | [`fmi`] | FMUs for simulation tools |
//! | [`without_std`] | microcontrollers |
//! | [`python`] | classes of Python from robot files and declarations |
//! | [`run_time`] | robots that are loaded at run time, without a compiler |
//! | [`speed`] | speed of generated code in release and debug builds; accuracy, stack, worst case |
//! | [`from_other_tools`] | corresponding names in SymPy, Pinocchio, MuJoCo and Drake |
//! | [`glossary`] | terms and symbols |
//!
//! These modules exist in the documentation only.

#[doc = include_str!("../guide/first_mechanism.md")]
pub mod first_mechanism {}

#[doc = include_str!("../guide/recipes.md")]
pub mod recipes {}

#[doc = include_str!("../guide/language.md")]
pub mod language {}

#[doc = include_str!("../guide/robots.md")]
pub mod robots {}

#[doc = include_str!("../guide/constraints.md")]
pub mod constraints {}

#[doc = include_str!("../guide/contact.md")]
pub mod contact {}

#[doc = include_str!("../guide/functions.md")]
pub mod functions {}

#[doc = include_str!("../guide/simulating.md")]
pub mod simulating {}

#[doc = include_str!("../guide/drives.md")]
pub mod drives {}

#[doc = include_str!("../guide/control.md")]
pub mod control {}

#[doc = include_str!("../guide/batches.md")]
pub mod batches {}

#[doc = include_str!("../guide/gpus.md")]
pub mod gpus {}

#[doc = include_str!("../guide/fmi.md")]
pub mod fmi {}

#[doc = include_str!("../guide/live.md")]
pub mod live {}

#[doc = include_str!("../guide/without_std.md")]
pub mod without_std {}

#[doc = include_str!("../guide/python.md")]
pub mod python {}

#[doc = include_str!("../guide/run_time.md")]
pub mod run_time {}

#[doc = include_str!("../guide/speed.md")]
pub mod speed {}

#[doc = include_str!("../guide/from_other_tools.md")]
pub mod from_other_tools {}

#[doc = include_str!("../guide/glossary.md")]
pub mod glossary {}

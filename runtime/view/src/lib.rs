#![doc = include_str!("../README.md")]

mod collada;
mod encode;
mod error;
mod figure;
mod free_body;
mod gallery;
mod live;
mod log;
mod mcap;
mod mesh;
mod motion;
mod page;
mod picture;
mod scene;
mod server;
mod terrain;
mod text;

pub use error::Error;
pub use figure::Figure;
pub use free_body::{Side, free_body};
#[doc(hidden)]
pub use gallery::gallery;
pub use live::Live;
pub use log::csv;
pub use mcap::{Instant, Names, mcap, mcap_of};
pub use motion::Motion;
pub use page::Page;

use linkwork::simulate::Sample;
use linkwork::{Drawn, Mechanism};

/// Returns a page that shows the motion of a mechanism: [`Motion::of`] on a [`Page`].
///
/// Meshes are not read: bodies with meshes are drawn by their mass properties, and the page lists the files.
/// To read meshes, use [`Figure::meshes`] with [`Motion::figure`].
///
/// # Errors
///
/// As for [`Motion::of`].
pub fn page<M, const NQ: usize, const NV: usize, const NU: usize>(
    title: &str,
    mechanism: &M,
    samples: &[Sample<<M as Mechanism<NQ, NV, NU>>::Scalar, NQ, NV, NU>],
) -> Result<String, Error>
where
    M: Mechanism<NQ, NV, NU> + Drawn<NQ, NV, Scalar = <M as Mechanism<NQ, NV, NU>>::Scalar>,
{
    Ok(Page::new(title).motion(Motion::of("", mechanism, samples)?).html())
}

//! The extension module `linkwork._native`: mechanisms that `linkwork-jit` loads, and their functions on
//! NumPy arrays. The package in Python has the classes, the conversion of arguments and the messages.

mod arrays;
mod error;
mod function;
mod motion;
mod page;
mod robot;
mod shared;

use pyo3::prelude::*;

/// Embedded declarations and robot files of the model gallery.
mod gallery {
    include!(concat!(env!("OUT_DIR"), "/gallery.rs"));
}

#[pymodule]
mod _native {
    use super::gallery;
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::function::{BoundFunction, Function};
    #[pymodule_export]
    use super::motion::simulate;
    #[pymodule_export]
    use super::page::write_page;
    #[pymodule_export]
    use super::robot::{Robot, load, roll_back};

    /// Path and text of an embedded file.
    type File = (&'static str, &'static str);

    /// Returns path and text of the Rust files and of the robot files of the gallery.
    #[pyfunction]
    fn gallery_files() -> [Vec<File>; 2] {
        [gallery::DECLARATIONS.to_vec(), gallery::ROBOTS.to_vec()]
    }
}

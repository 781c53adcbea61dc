//! The extension module `plume._plume`: Plume for Python, and Python's USD library for Plume.
//!
//! No logic: the command line is that of the crate `plume`, and so is every cave.

mod usd;

use std::ffi::OsString;
use std::sync::Arc;

use plume::cli::Host;
use pyo3::prelude::*;

use crate::usd::UsdCore;

#[pymodule]
mod _plume {
    use super::{Arc, Bound, Host, OsString, PyModule, PyModuleMethods, PyResult, Python, UsdCore, pyfunction};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", plume::VERSION)
    }

    /// Runs a command line, `plume` first, and gives its exit code. Takes Ctrl-C over: for the process of the command.
    #[pyfunction]
    fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
        py.detach(|| plume::cli::run(arguments, &Host::Python(Arc::new(UsdCore::default()))))
    }
}

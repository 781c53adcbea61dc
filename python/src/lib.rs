//! The extension module `plume._plume`: Plume for Python, and Python's USD library for Plume.
//!
//! No logic: the command line, recipes and caves are those of the Rust crates. Here they get Python names, NumPy arrays and
//! Python exceptions. Long work runs on threads without the interpreter lock (`work`).

mod array;
mod cave;
mod chunk;
mod dataset;
mod error;
mod generator;
mod graph;
mod json;
mod light;
mod make;
mod mesh;
mod package;
mod publish;
mod ray;
mod recipe;
mod tables;
mod texture;
mod usd;
mod words;
mod work;

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

use plume_cli::Host;
use plume_dataset::Engine;
use pyo3::prelude::*;

use crate::publish::publish;
use crate::ray::Ray;
use crate::usd::UsdCore;

#[pymodule]
mod _plume {
    use super::{
        Arc, Bound, Engine, Host, OsString, PyModule, PyModuleMethods, PyResult, Python, Ray, UsdCore, interpreter,
        publish, pyfunction,
    };

    #[pymodule_export]
    use super::cave::Cave;
    #[pymodule_export]
    use super::chunk::{Chunk, ChunkIterator, Chunks};
    #[pymodule_export]
    use super::dataset::{Dataset, dataset, make_item};
    #[pymodule_export]
    use super::generator::register_generator;
    #[pymodule_export]
    use super::graph::Graph;
    #[pymodule_export]
    use super::light::Light;
    #[pymodule_export]
    use super::make::{chunk_grid, generate, make_chunks, open};
    #[pymodule_export]
    use super::mesh::{Lod, Mesh, VisualMesh};
    #[pymodule_export]
    use super::package::Package;
    #[pymodule_export]
    use super::recipe::Recipe;
    #[pymodule_export]
    use super::tables::{generators, materials, presets, targets};
    #[pymodule_export]
    use super::texture::Textures;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", plume::VERSION)
    }

    /// Runs a command line, `plume` first, and returns its exit code. Takes over Ctrl-C, SIGTERM and SIGHUP, so it is
    /// meant for the process of the command.
    #[pyfunction]
    fn main(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
        let library = Arc::new(UsdCore::default());
        let ray = |tasks| Box::new(Ray(tasks)) as Box<dyn Engine>;
        let host = Host::Python { library, interpreter: interpreter(py)?, ray, publish };
        Ok(py.detach(|| plume_cli::run(arguments, &host)))
    }
}

fn interpreter(py: Python<'_>) -> PyResult<PathBuf> {
    py.import("sys")?.getattr("executable")?.extract()
}

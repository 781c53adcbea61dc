//! What an export wrote.

use std::path::PathBuf;

use plume_exporters::Summary;
use plume_exporters::package::Files;
use pyo3::prelude::*;

/// A package that was written.
#[pyclass(module = "plume", frozen, get_all)]
pub struct Package {
    /// The target it is for.
    target: String,
    /// Its folder or file.
    path: PathBuf,
    /// Number of its files, the manifest among them.
    files: usize,
    /// Size of its files together, before they are packed.
    bytes: u64,
    /// Triangles that cameras see, in full detail.
    visual_triangles: u64,
    /// Triangles that wheels touch; 0 if the target carries none.
    collision_triangles: u64,
    /// A command for a shell in the folder, or a sentence, that opens the package.
    open_with: String,
}

impl Package {
    /// The package of this export.
    pub fn new(target: &str, path: PathBuf, summary: &Summary, files: &Files) -> Self {
        Self {
            target: target.to_owned(),
            path,
            files: files.0.len(),
            bytes: files.bytes(),
            visual_triangles: summary.visual_triangles,
            collision_triangles: summary.collision_triangles,
            open_with: summary.open.clone(),
        }
    }
}

#[pymethods]
impl Package {
    fn __repr__(&self) -> String {
        let Self { target, path, files, bytes, .. } = self;
        format!("<plume.Package {target:?} at {:?}: {files} files, {:.0} MB>", path.display(), *bytes as f64 / 1e6)
    }
}

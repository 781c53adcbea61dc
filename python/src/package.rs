//! Exported packages.

use std::path::PathBuf;

use plume_exporters::Summary;
use plume_exporters::package::Files;
use pyo3::prelude::*;

/// A written package.
#[pyclass(module = "plume", frozen, get_all)]
pub struct Package {
    /// The target it is for.
    target: String,
    /// Its folder or file.
    path: PathBuf,
    /// Number of files, including the manifest.
    files: usize,
    /// Total size of the files, before bundling.
    bytes: u64,
    /// Number of triangles of the visual mesh, in full detail.
    visual_triangles: u64,
    /// Number of triangles of the collision mesh; 0 if the target has none.
    collision_triangles: u64,
    /// How to open the package: a shell command to run in its folder, or a sentence.
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
            open_with: summary.open.text().to_owned(),
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

//! Triangles as arrays. Vectors are passed to NumPy without a copy.

use numpy::PyArray2;
use plume_exporters::scene;
use pyo3::prelude::*;

use crate::array;

/// Triangles, counter-clockwise as seen from the air. Metres, right-handed, Z up, frame of the cave.
#[pyclass(module = "plume", frozen, subclass)]
pub struct Mesh {
    positions: Py<PyArray2<f32>>,
    indices: Py<PyArray2<u32>>,
    bounds: [[f32; 3]; 2],
}

/// Triangles with everything needed for rendering; the attributes are per vertex.
#[pyclass(module = "plume", frozen, subclass, extends = Mesh)]
pub struct VisualMesh {
    normals: Py<PyArray2<f32>>,
    uvs: Py<PyArray2<f32>>,
    tangents: Py<PyArray2<f32>>,
}

/// A coarser level of detail of a chunk, with the same textures. Vertices on the border of the chunk are those of the
/// full detail, so levels of neighbouring chunks meet without cracks.
#[pyclass(module = "plume", frozen, extends = VisualMesh)]
pub struct Lod {
    error_m: f32,
}

/// Positions and triangles of a mesh.
pub fn plain(py: Python<'_>, mesh: scene::Mesh) -> PyResult<PyClassInitializer<Mesh>> {
    let bounds = mesh.bounds();
    let positions = array::rows(py, mesh.positions)?.unbind();
    let indices = array::table(py, mesh.indices, 3)?.unbind();
    Ok(Mesh { positions, indices, bounds }.into())
}

/// A mesh with all its attributes.
pub fn visual(py: Python<'_>, mut mesh: scene::Mesh) -> PyResult<PyClassInitializer<VisualMesh>> {
    let normals = array::rows(py, std::mem::take(&mut mesh.normals))?.unbind();
    let uvs = array::rows(py, std::mem::take(&mut mesh.uvs))?.unbind();
    let tangents = array::rows(py, std::mem::take(&mut mesh.tangents))?.unbind();
    Ok(plain(py, mesh)?.add_subclass(VisualMesh { normals, uvs, tangents }))
}

/// A level of detail.
pub fn lod(py: Python<'_>, lod: scene::Lod) -> PyResult<Py<Lod>> {
    Py::new(py, visual(py, lod.mesh)?.add_subclass(Lod { error_m: lod.error_m }))
}

#[pymethods]
impl Mesh {
    /// The vertices: (v, 3) float32, m.
    #[getter]
    fn positions(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.positions.clone_ref(py)
    }

    /// The triangles as rows of `positions`: (t, 3) uint32.
    #[getter]
    fn indices(&self, py: Python<'_>) -> Py<PyArray2<u32>> {
        self.indices.clone_ref(py)
    }

    /// Minimum and maximum corner of the bounding box: (2, 3) float32, m.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        array::rows(py, self.bounds.to_vec())
    }
}

#[pymethods]
impl VisualMesh {
    /// Unit normals, pointing into the air: (v, 3) float32.
    #[getter]
    fn normals(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.normals.clone_ref(py)
    }

    /// Texture coordinates, 0 to 1, origin at the lower left of the image: (v, 2) float32.
    #[getter]
    fn uvs(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.uvs.clone_ref(py)
    }

    /// Tangents (MikkTSpace): unit x, y, z along +u, and the handedness ±1 of the bitangent: (v, 4) float32.
    #[getter]
    fn tangents(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.tangents.clone_ref(py)
    }
}

#[pymethods]
impl Lod {
    /// Upper bound of its distance from the full detail, m.
    #[getter]
    fn error_m(&self) -> f32 {
        self.error_m
    }
}

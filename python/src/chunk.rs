//! Chunks, loaded one at a time.

use std::sync::atomic::{AtomicBool, AtomicIsize, Ordering};

use plume_exporters::ExportError;
use plume_exporters::scene::{self, Chunks as _};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyList, PySlice};

use crate::cave::Cave;
use crate::mesh::{self, Lod, Mesh, VisualMesh};
use crate::texture::Textures;
use crate::work;

/// A box of the cave with its wall in full detail, its coarser levels of detail, collision mesh and textures.
///
/// Its arrays are the loaded data, passed on without a copy. The chunk owns them: they stay valid when the cave is
/// closed, and changing them affects nothing else.
///
/// >>> chunk = cave.chunks[0]
/// >>> chunk.positions.shape[1], chunk.indices.shape[1], str(chunk.uvs.dtype)
/// (3, 3, 'float32')
/// >>> bool((chunk.indices < len(chunk.positions)).all())
/// True
#[pyclass(module = "plume", frozen, extends = VisualMesh)]
pub struct Chunk {
    name: String,
    lods: Vec<Py<Lod>>,
    collision: Py<Mesh>,
    textures: Py<Textures>,
}

#[pymethods]
impl Chunk {
    /// Its name, unique in the cave, for example `chunk_0_2_1`.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Coarser levels of detail, the finest first; may be empty.
    #[getter]
    fn lods(&self, py: Python<'_>) -> Vec<Py<Lod>> {
        self.lods.iter().map(|lod| lod.clone_ref(py)).collect()
    }

    /// The collision mesh: fewer triangles, at most `mesh.collision_error_m` of the recipe away from the wall.
    #[getter]
    fn collision(&self, py: Python<'_>) -> Py<Mesh> {
        self.collision.clone_ref(py)
    }

    /// The textures of the wall.
    #[getter]
    fn textures(&self, py: Python<'_>) -> Py<Textures> {
        self.textures.clone_ref(py)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let triangles = slf.getattr("indices")?.len()?;
        Ok(format!("<plume.Chunk {:?}: {triangles} triangles>", slf.get().name))
    }
}

/// The chunks of a cave as a sequence in a fixed order. Each access reads the chunk from the folder again, so memory
/// holds only what you keep.
///
/// >>> [chunk.name for chunk in cave.chunks] == cave.chunks.names
/// True
#[pyclass(module = "plume", frozen)]
pub struct Chunks {
    cave: Py<Cave>,
}

impl Chunks {
    /// The chunks of this cave.
    pub fn of(cave: Py<Cave>) -> Self {
        Self { cave }
    }
}

#[pymethods]
impl Chunks {
    /// The names of the chunks; reads no files.
    #[getter]
    fn names(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.cave.get().open(py)?.chunk_names().map(str::to_owned).collect())
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.cave.get().open(py)?.chunk_names().count())
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let length = self.__len__(py)? as isize;
        if let Ok(slice) = index.cast::<PySlice>() {
            let indices = slice.indices(length)?;
            let chunks = (0..indices.slicelength as isize).map(|i| self.load(py, indices.start + i * indices.step));
            return Ok(PyList::new(py, chunks.collect::<PyResult<Vec<_>>>()?)?.into_any());
        }
        let index: isize = index.extract()?;
        let index = if index < 0 { index + length } else { index };
        if !(0..length).contains(&index) {
            return Err(PyIndexError::new_err(format!("there are {length} chunks")));
        }
        Ok(self.load(py, index)?.into_any())
    }

    fn __iter__(&self, py: Python<'_>) -> ChunkIterator {
        ChunkIterator { chunks: Self { cave: self.cave.clone_ref(py) }, next: AtomicIsize::new(0) }
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<plume.Chunks: {}>", self.__len__(py)?))
    }
}

impl Chunks {
    fn load<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, Chunk>> {
        let cave = self.cave.get().open(py)?;
        let index = index as usize;
        let chunk = work::briefly(py, || {
            let loaded = cave.chunks(&AtomicBool::new(false)).load(index);
            let scene = || cave.recipe().name().to_owned();
            Ok(loaded.map_err(|source| ExportError::Load { scene: scene(), index, source })?)
        })?;
        self.arrays(py, chunk)
    }

    fn arrays<'py>(&self, py: Python<'py>, chunk: scene::Chunk) -> PyResult<Bound<'py, Chunk>> {
        let textures = Textures::new(self.cave.clone_ref(py), chunk.material);
        let parts = Chunk {
            name: chunk.name,
            lods: chunk.lods.into_iter().map(|lod| mesh::lod(py, lod)).collect::<PyResult<_>>()?,
            collision: Py::new(py, mesh::plain(py, chunk.collision)?)?,
            textures: Py::new(py, textures)?,
        };
        Bound::new(py, mesh::visual(py, chunk.visual)?.add_subclass(parts))
    }
}

/// Loads the chunks of a cave one by one.
#[pyclass(module = "plume", frozen)]
pub struct ChunkIterator {
    chunks: Chunks,
    next: AtomicIsize,
}

#[pymethods]
impl ChunkIterator {
    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, Chunk>>> {
        let length = self.chunks.__len__(py)? as isize;
        let index = self.next.fetch_add(1, Ordering::Relaxed);
        (index < length).then(|| self.chunks.load(py, index)).transpose()
    }
}

//! Textures of a chunk as arrays.

use std::path::Path;

use image::{DynamicImage, ImageReader};
use numpy::{PyArray2, PyArray3};
use plume::cave::CaveError;
use plume_exporters::scene::{Image, Material};
use pyo3::prelude::*;

use crate::cave::Cave;
use crate::{array, work};

/// The textures of a chunk, each (height, width, channels) uint8 with the top row first, and the heights in metres.
///
/// Each access reads and decodes the file again, as long as the cave is open; the array is the decoded image, not a copy.
///
/// >>> textures = cave.chunks[0].textures
/// >>> textures.base_color.shape, textures.roughness.shape
/// ((256, 256, 3), (256, 256, 1))
#[pyclass(module = "plume", frozen)]
pub struct Textures {
    cave: Py<Cave>,
    material: Material,
}

impl Textures {
    /// The images of a material of this cave.
    pub fn new(cave: Py<Cave>, material: Material) -> Self {
        Self { cave, material }
    }

    /// One channel for grey, three for red, green and blue, whatever the file has: WebP has no grey images.
    fn array<'py>(&self, py: Python<'py>, image: &Image, channels: usize) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.cave.get().open(py)?;
        let decoded = work::briefly(py, || decoded(&image.path))?;
        let [height, width] = [decoded.height() as usize, decoded.width() as usize];
        let pixels = match channels {
            1 => decoded.into_luma8().into_raw(),
            _ => decoded.into_rgb8().into_raw(),
        };
        array::block(py, pixels, [height, width, channels])
    }
}

#[pymethods]
impl Textures {
    /// Base colour: red, green, blue in sRGB.
    #[getter]
    fn base_color<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.array(py, &self.material.base_color, 3)
    }

    /// Tangent-space normals, +Y up (OpenGL): x, y, z, where 0 stands for -1 and 255 for 1.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.array(py, &self.material.normal, 3)
    }

    /// Ambient occlusion, roughness and metalness (0); linear.
    #[getter]
    fn orm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.array(py, &self.material.orm, 3)
    }

    /// Roughness alone, one channel; linear.
    #[getter]
    fn roughness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        self.array(py, &self.material.roughness, 1)
    }

    /// Height of the rock above the mesh, in metres along the normal, (height, width) float32; None unless the recipe asks
    /// for it (`texture.height`).
    #[getter]
    fn height_m<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        let Some(height) = &self.material.height else { return Ok(None) };
        self.cave.get().open(py)?;
        let decoded = work::briefly(py, || decoded(&height.image.path))?.into_luma16();
        let columns = decoded.width() as usize;
        let metres = |grey: u16| (f32::from(grey) / 32_767.5 - 1.0) * height.amplitude_m;
        array::table(py, decoded.into_raw().into_iter().map(metres).collect(), columns).map(Some)
    }
}

/// The image in the file. Ours may exceed the default limits of the decoder.
fn decoded(path: &Path) -> Result<DynamicImage, CaveError> {
    let refused = |source: std::io::Error| CaveError::Input { path: path.to_owned(), source };
    let mut reader = ImageReader::open(path).map_err(refused)?;
    reader.no_limits();
    reader.decode().map_err(|error| refused(std::io::Error::other(error)))
}

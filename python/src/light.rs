//! Lamps.

use plume_exporters::scene;
use pyo3::prelude::*;

/// A lamp: a point light.
#[pyclass(module = "plume", frozen, get_all)]
pub struct Light {
    /// Its name, unique in the cave.
    name: String,
    /// Position: x, y, z in m.
    position: (f64, f64, f64),
    /// Colour: linear red, green, blue, 0 to 1.
    color: (f64, f64, f64),
    /// Luminous intensity, cd.
    intensity_cd: f64,
    /// Distance beyond which it can be ignored, m.
    range_m: f64,
}

impl Light {
    /// A lamp of a scene.
    pub fn of(light: &scene::Light) -> Self {
        let [x, y, z] = light.position.coords.into();
        let [r, g, b] = light.color;
        Self {
            name: light.name.clone(),
            position: (x, y, z),
            color: (r, g, b),
            intensity_cd: light.intensity_cd,
            range_m: light.range_m,
        }
    }
}

#[pymethods]
impl Light {
    fn __repr__(&self) -> String {
        format!("<plume.Light {:?} at {:?}: {} cd>", self.name, self.position, self.intensity_cd)
    }
}

//! The surface of a finished cave, and how far points are from it.

use nalgebra::Vector3;
use plume_exporters::scene::Scene;
use plume_exporters::surface;
use plume_truth::Inside;
use rayon::prelude::*;

use super::CaveError;
use crate::mesh::Nearest;

/// The triangles that simulators get: walls and things, without gravel.
pub struct Surface {
    nearest: Nearest,
    inside: Inside,
}

impl Surface {
    /// The surface of a scene.
    ///
    /// # Errors
    /// If a chunk cannot be read; if work was stopped.
    pub fn of(scene: &Scene) -> Result<Self, CaveError> {
        let (mut triangles, mut inside) = (Vec::new(), Inside::default());
        for mesh in surface::meshes(scene) {
            let mesh = mesh?;
            inside.add(&mesh.positions, &mesh.indices);
            let corner = |vertex: u32| Vector3::from(mesh.positions[vertex as usize].map(f64::from));
            triangles.extend(mesh.indices.as_chunks::<3>().0.iter().map(|triangle| triangle.map(corner)));
        }
        Ok(Self { nearest: Nearest::new(&triangles), inside })
    }

    /// Euclidean distances of finite `points` in metres to the nearest triangle: negative in the air, positive in what is solid.
    pub fn distances(&self, points: &[[f32; 3]]) -> Vec<f32> {
        let distance = |point: &[f32; 3]| {
            let away_m = self.nearest.nearest(Vector3::from(point.map(f64::from))).squared.sqrt() as f32;
            if self.inside.is_air(*point) { -away_m } else { away_m }
        };
        points.par_iter().map(distance).collect()
    }
}

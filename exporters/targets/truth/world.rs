//! What is gathered from the triangles of all chunks, one chunk at a time.

use std::path::Path;

use plume_truth::{Columns, Distances, Gap, Voxels};

use super::cloud::Cloud;
use super::{Part, TruthSettings};
use crate::error::ExportError;
use crate::labels::Labels;
use crate::scene::Scene;
use crate::surface::FloorBuilder;

/// The world as far as some parts of the package need it.
pub struct World {
    /// What the floor follows from, for [`Part::OF_FLOOR`].
    pub floor: Option<FloorBuilder>,
    /// The cells of a grid, for [`Part::Occupancy`] and [`Part::Voxels`].
    pub voxels: Option<Voxels>,
    /// For [`Part::Distance`].
    pub distances: Option<Distances>,
    /// For [`Part::OF_CLOUD`].
    pub cloud: Option<Cloud>,
    /// Number of triangles, gravel included.
    pub triangles: u64,
}

impl World {
    /// The world of a scene. Gravel is left out, as nothing collides with it.
    pub fn of(scene: &Scene, settings: &TruthSettings, labels: &Labels, scratch: &Path) -> Result<Self, ExportError> {
        let mut gathered = Gathered::new(scene, settings, scratch)?;
        let mut triangles = 0;
        for index in 0..scene.chunks.len() {
            triangles += gathered.add(scene, index, labels)?;
        }
        Ok(gathered.finish(triangles))
    }
}

struct Gathered {
    floor: Option<FloorBuilder>,
    /// Columns of the grid of voxels and distances.
    air: Option<Columns>,
    voxels: Option<Voxels>,
    distances: Option<Distances>,
    cloud: Option<Cloud>,
}

impl Gathered {
    fn new(scene: &Scene, settings: &TruthSettings, scratch: &Path) -> Result<Self, ExportError> {
        let TruthSettings { cell_m, voxel_m, reach_m, points_per_m2, .. } = *settings;
        let wants = |parts: &[Part]| parts.iter().any(|part| settings.files.contains(part));
        let has_voxels = wants(&[Part::Occupancy, Part::Voxels]);
        let has_distances = wants(&[Part::Distance]);
        let cloud = wants(&Part::OF_CLOUD).then(|| Cloud::new(scene.seed, points_per_m2, scratch));
        Ok(Self {
            floor: wants(&Part::OF_FLOOR).then(|| FloorBuilder::new(cell_m)),
            air: (has_voxels || has_distances).then(|| Columns::new(voxel_m)),
            voxels: has_voxels.then(|| Voxels::new(voxel_m)),
            distances: has_distances.then(|| Distances::new(voxel_m, reach_m)),
            cloud: cloud.transpose()?,
        })
    }

    /// Adds a chunk; returns the number of its triangles.
    fn add(&mut self, scene: &Scene, index: usize, labels: &Labels) -> Result<u64, ExportError> {
        let chunk = scene.chunk(index)?;
        let mesh = &chunk.visual;
        if !chunk.collides() {
            return Ok(mesh.triangles());
        }
        if let Some(floor) = &mut self.floor {
            floor.add(&chunk);
        }
        if let Some(air) = &mut self.air {
            air.add(&mesh.positions, &mesh.indices);
        }
        if let Some(distances) = &mut self.distances {
            distances.add(&mesh.positions, &mesh.indices);
        }
        if self.voxels.is_none() && self.cloud.is_none() {
            return Ok(mesh.triangles());
        }
        let (_, labels_of_faces) = labels.of_chunk(scene, index, &chunk)?;
        if let Some(voxels) = &mut self.voxels {
            voxels.add(&mesh.positions, &mesh.indices, &labels_of_faces);
        }
        if let Some(cloud) = &mut self.cloud {
            cloud.add(index, mesh, &labels_of_faces, &labels.triangles_of_things(scene, index)?)?;
        }
        Ok(mesh.triangles())
    }

    fn finish(self, triangles: u64) -> World {
        let Self { floor, air, mut voxels, mut distances, cloud } = self;
        let air: Vec<Gap> = air.map(Columns::into_gaps).unwrap_or_default();
        if let Some(voxels) = &mut voxels {
            voxels.fill(&air);
        }
        if let Some(distances) = &mut distances {
            distances.sign(&air);
        }
        World { floor, voxels, distances, cloud, triangles }
    }
}

//! What is gathered from the triangles of all chunks, one chunk at a time.

use std::fs::File;
use std::io;
use std::path::Path;

use plume_truth::{Grid, Stack, Told};

use super::cloud::Cloud;
use super::layer::Layer;
use super::{Part, TruthSettings};
use crate::error::{ExportError, at};
use crate::labels::Labels;
use crate::scene::Scene;
use crate::surface::FloorBuilder;

/// The world as far as some parts of the package need it. Only the floor is in memory.
pub struct World {
    /// What the floor follows from, for [`Part::OF_FLOOR`].
    pub floor: Option<FloorBuilder>,
    /// The states of the cells of a grid, for [`Part::OF_STATES`].
    pub states: Option<Layer<u8>>,
    /// How far they are from the surface, for [`Part::Distance`].
    pub distances: Option<Layer<f32>>,
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
        gathered.finish(triangles, scratch)
    }
}

struct Gathered {
    floor: Option<FloorBuilder>,
    told: Told,
    /// Voxels and distances, if any are told.
    grid: Option<Grid<File>>,
    cloud: Option<Cloud>,
}

impl Gathered {
    fn new(scene: &Scene, settings: &TruthSettings, scratch: &Path) -> Result<Self, ExportError> {
        let TruthSettings { cell_m, voxel_m, reach_m, points_per_m2, .. } = *settings;
        let wants = |parts: &[Part]| parts.iter().any(|part| settings.files.contains(part));
        let cloud = wants(&Part::OF_CLOUD).then(|| Cloud::new(scene.seed, points_per_m2, scratch));
        let has_distances = wants(&[Part::Distance]);
        let told =
            Told { cell_m: voxel_m, has_states: wants(&Part::OF_STATES), reach_m: has_distances.then_some(reach_m) };
        let grid = (told.has_states || has_distances).then(|| Ok(Grid::new(told, tempfile::tempfile_in(scratch)?)));
        Ok(Self {
            floor: wants(&Part::OF_FLOOR).then(|| FloorBuilder::new(cell_m)),
            told,
            grid: grid.transpose().map_err(in_grid)?,
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
        if self.grid.is_none() && self.cloud.is_none() {
            return Ok(mesh.triangles());
        }
        let (_, labels_of_faces) = labels.of_chunk(scene, index, &chunk)?;
        if let Some(grid) = &mut self.grid {
            grid.add(&mesh.positions, &mesh.indices, &labels_of_faces).map_err(in_grid)?;
        }
        if let Some(cloud) = &mut self.cloud {
            cloud.add(index, mesh, &labels_of_faces, &labels.triangles_of_things(scene, index)?)?;
        }
        Ok(mesh.triangles())
    }

    fn finish(self, triangles: u64, scratch: &Path) -> Result<World, ExportError> {
        let Self { floor, told, grid, cloud } = self;
        let mut states = told.has_states.then(|| Layer::new("voxels", scratch)).transpose()?;
        let mut distances = told.reach_m.map(|_| Layer::new("distance", scratch)).transpose()?;
        let add = |Stack { states: of_states, distances_m }: Stack| {
            states.iter_mut().try_for_each(|layer| layer.add(&of_states))?;
            distances.iter_mut().try_for_each(|layer| layer.add(&distances_m))
        };
        grid.map_or(Ok(()), |grid| grid.finish(add)).map_err(in_grid)?;
        Ok(World { floor, states, distances, cloud, triangles })
    }
}

/// An error of the system at the file of the grid.
fn in_grid(error: io::Error) -> ExportError {
    at("grid", &error).into()
}

//! The things near a place of a cave without a folder: their walls are meshed for them.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::Thing;
use super::along::ASIDE_M;
use super::gravel::strew;
use super::place::{MARGIN_M, Setting, owns, place};
use crate::mesh::{self, ChunkIndex, Grid, Mesh, MeshSettings};
use plume_graph::Aabb;

/// The things and the gravel in a box, those that the chunks of these settings have; none where the cave has too many cells. `None` if `stop`
/// was set.
pub fn place_in(setting: &Setting, mesh: &MeshSettings, bounds: Aabb<f64>, stop: &AtomicBool) -> Option<Vec<Thing>> {
    let Ok(grid) = Grid::new(setting.field.bounds(), mesh) else { return Some(Vec::new()) };
    let of = |index: ChunkIndex| {
        let Aabb { min, max } = grid.chunk_bounds(index);
        Aabb { min: min.map(f64::from), max: max.map(f64::from) }
    };
    let reach = bounds.padded(MARGIN_M + ASIDE_M);
    let needed: Vec<ChunkIndex> = grid.indices().filter(|index| of(*index).intersects(&reach)).collect();
    let wall = |&index: &ChunkIndex| {
        let wall = (!stop.load(Ordering::Relaxed)).then(|| mesh::visual_chunk(setting.field, &grid, index, mesh))?;
        Some((of(index), wall.unwrap_or_default()))
    };
    let walls: Vec<(Aabb<f64>, Mesh)> = needed.par_iter().map(wall).collect::<Option<_>>()?;
    let things_of = |(chunk, own): &(Aabb<f64>, Mesh)| {
        // As in the cave folder, where chunks without a wall have no things.
        if stop.load(Ordering::Relaxed) || own.triangles.is_empty() || !chunk.intersects(&bounds) {
            return Vec::new();
        }
        let all = || walls.iter().map(|(_, wall)| wall);
        let mut things = place(setting, *chunk, all());
        things.extend(strew(setting, *chunk, all()));
        things
    };
    let mut things: Vec<Thing> = walls.par_iter().flat_map_iter(things_of).collect();
    things.retain(|thing| owns(&bounds, thing.pose.translation.vector));
    (!stop.load(Ordering::Relaxed)).then_some(things)
}

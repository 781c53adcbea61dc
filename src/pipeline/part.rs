//! Part of a cave: some of its chunks, so that a large cave can be made by many machines.
//!
//! A chunk follows from the recipe, the graph and its number. Its things, and the pieces of rock behind its wall, follow
//! from the walls of its neighbours too, so these are meshed with it, unless one of the
//! [other parts](crate::store::CaveFolder::with_parts) has them.

use std::collections::BTreeSet;
use std::ops::Range;

use super::{Pipeline, PipelineError, field_and_grid, with_large_stacks};
use crate::mesh::{ChunkIndex, Grid};
use crate::recipe::Recipe;
use crate::store::{Stage, Unit, chunk_name};
use plume_graph::Graph;

impl Pipeline<'_> {
    /// Makes `stages` of the chunks with these numbers, in the order of the grid; numbers beyond it are of no chunk. Returns
    /// the meshes of those chunks that have a wall.
    ///
    /// # Errors
    /// If there is no valid grid, the disk fails, or the observer stops.
    pub fn part(&self, numbers: Range<usize>, stages: &BTreeSet<Stage>) -> Result<Vec<Unit>, PipelineError> {
        with_large_stacks(|| self.part_here(numbers, stages))
    }

    /// [`Pipeline::part`] on the threads of the caller.
    fn part_here(&self, numbers: Range<usize>, stages: &BTreeSet<Stage>) -> Result<Vec<Unit>, PipelineError> {
        let (field, grid) = field_and_grid(self.recipe, &self.graph)?;
        let own: Vec<ChunkIndex> = grid.indices().skip(numbers.start).take(numbers.len()).collect();
        let needs_neighbours = [Stage::Things, Stage::Pieces].iter().any(|stage| stages.contains(stage));
        self.meshes(&field, &grid, &if needs_neighbours { with_neighbours(&own, &grid) } else { own.clone() })?;
        let names: BTreeSet<String> = own.into_iter().map(chunk_name).collect();
        let all = self.walls();
        let own: Vec<Unit> = all.iter().filter(|wall| names.contains(&wall.name)).cloned().collect();
        if stages.contains(&Stage::Things) {
            self.things_on(&field, &grid, &own, &all)?;
        }
        if stages.contains(&Stage::Texture) {
            self.textures(&self.field(), &own)?;
        }
        if stages.contains(&Stage::Pieces) {
            self.pieces_behind(&own, &all)?;
        }
        Ok(own)
    }
}

/// These chunks and all that touch them, in the order of the grid.
fn with_neighbours(chunks: &[ChunkIndex], grid: &Grid) -> Vec<ChunkIndex> {
    let is_inside = |index: &[i32; 3]| (0..3).all(|axis| (0..grid.chunks[axis]).contains(&index[axis]));
    let around = |ChunkIndex([x, y, z]): &ChunkIndex| {
        let (x, y, z) = (*x, *y, *z);
        (z - 1..=z + 1).flat_map(move |z| (y - 1..=y + 1).flat_map(move |y| (x - 1..=x + 1).map(move |x| [x, y, z])))
    };
    let mut found: Vec<[i32; 3]> = chunks.iter().flat_map(around).filter(is_inside).collect();
    found.sort_by_key(|[x, y, z]| [*z, *y, *x]);
    found.dedup();
    found.into_iter().map(ChunkIndex).collect()
}

/// Numbers of chunks along x, y and z. Most have no wall.
///
/// # Errors
/// If there is no valid grid.
pub fn chunk_grid(recipe: &Recipe, graph: &Graph) -> Result<[i32; 3], PipelineError> {
    let (_, grid) = field_and_grid(recipe, graph)?;
    Ok(grid.chunks)
}

use crate::field::{Field, Region};

use super::Mesh;
use super::bubbles::drop_bubbles;
use super::collapse::StopCriterion;
use super::extract::extract;
use super::facet::{Facets, triangulate};
use super::grid::{ChunkIndex, Grid};
use super::lattice::{Lattice, Window};
use super::normals::normals;
use super::settings::MeshSettings;
use super::simplify::simplify;
use super::smooth::smooth;

/// The wall in one chunk: visual and collision mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct ChunkMeshes {
    /// The visual mesh, with normals.
    pub visual: Mesh,
    /// The collision mesh, without normals.
    pub collision: Mesh,
    /// Maximum simplification error of the visual mesh, in metres (see [`MeshSettings`]).
    pub visual_error_m: f32,
    /// The same for the collision mesh.
    pub collision_error_m: f32,
}

/// Whether a chunk may have a wall: it is neither all rock nor all air.
pub fn may_have_wall(field: &dyn Field, grid: &Grid, index: ChunkIndex) -> bool {
    field.region(grid.chunk_bounds(index)) == Region::Mixed
}

/// Makes a chunk; `None` if it has no wall.
///
/// `field` must be rock outside the bounds of the grid, and finite.
pub fn chunk(field: &dyn Field, grid: &Grid, index: ChunkIndex, settings: &MeshSettings) -> Option<ChunkMeshes> {
    let facets = facets(field, grid.voxel_m, &grid.owned(index))?;
    let (visual, visual_error_m) = visual(field, grid, index, settings, &facets);
    let touched = StopCriterion { error_m: settings.collision_error_m, most_triangles: None };
    let (collision, collision_error_m) = simplify(&facets, touched);
    Some(ChunkMeshes { visual, collision: collision.mesh, visual_error_m, collision_error_m })
}

/// Makes only the visual mesh of a chunk, the same as [`chunk`].
pub fn visual_chunk(field: &dyn Field, grid: &Grid, index: ChunkIndex, settings: &MeshSettings) -> Option<Mesh> {
    let facets = facets(field, grid.voxel_m, &grid.owned(index))?;
    Some(visual(field, grid, index, settings, &facets).0)
}

fn visual(field: &dyn Field, grid: &Grid, index: ChunkIndex, settings: &MeshSettings, facets: &Facets) -> (Mesh, f32) {
    let most_triangles = triangle_budget(field, grid, index, settings.max_triangles);
    let (visual, error_m) = simplify(facets, StopCriterion { error_m: settings.simplify_error_m, most_triangles });
    let normals = normals(field, grid.voxel_m, &visual);
    (Mesh { normals, ..visual.mesh }, error_m)
}

/// The unsimplified triangles of a chunk.
fn facets(field: &dyn Field, voxel_m: f32, owned: &Window) -> Option<Facets> {
    if field.region(owned.bounds(voxel_m)) != Region::Mixed {
        return None;
    }
    let lattice = Lattice::sample(field, voxel_m, &owned.with_halo());
    let mut surface = extract(&lattice, owned);
    drop(lattice);
    drop_bubbles(&mut surface);
    if !surface.quads.iter().any(|quad| quad.owned) {
        return None;
    }
    smooth(&mut surface);
    Some(triangulate(&surface, voxel_m))
}

/// Cells along the edge of a block of [`triangle_budget`].
const BLOCK: i32 = 32;

/// The share of a chunk in the triangle budget of the whole cave, by the number of blocks that the wall may cross. Every
/// chunk counts the blocks of all, so chunks stay independent.
fn triangle_budget(field: &dyn Field, grid: &Grid, index: ChunkIndex, max_triangles: u32) -> Option<usize> {
    let limit = (max_triangles > 0).then_some(u64::from(max_triangles))?;
    let own = mixed_blocks(field, grid, index);
    let all: u64 = grid.indices().map(|other| mixed_blocks(field, grid, other)).sum();
    Some((limit * own / all.max(1)) as usize)
}

fn mixed_blocks(field: &dyn Field, grid: &Grid, index: ChunkIndex) -> u64 {
    if !may_have_wall(field, grid, index) {
        return 0;
    }
    let mixed = |window: &Window| field.region(window.bounds(grid.voxel_m)) == Region::Mixed;
    grid.owned(index).blocks(BLOCK).filter(mixed).count() as u64
}

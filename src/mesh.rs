//! Chunks of triangles.
//!
//! A chunk is a pure function of the field, the [`Grid`] and its own [`ChunkIndex`]: any worker can make any chunk, in
//! any order, and neighbours still share their border vertices bit for bit.
//!
//! The field is sampled on one lattice for the whole cave; manifold dual marching cubes extracts the wall; a halo around
//! each chunk is wide enough that both sides of a border are computed identically. Promised for all chunks welded together:
//! watertight, manifold, consistent winding, no degenerate triangles. Not promised: that no two triangles intersect.
//!
//! ```
//! use plume::field::{Aabb, Analytic};
//! use plume::mesh::measure::{Report, weld};
//! use plume::mesh::{Grid, MeshSettings, chunk};
//!
//! let ball = Analytic::new(1.0, |[x, y, z]: [f32; 3]| (x * x + y * y + z * z).sqrt() - 2.0);
//! let settings = MeshSettings { voxel_m: 0.25, ..MeshSettings::default() };
//! let grid = Grid::new(Aabb { min: [-2.0; 3], max: [2.0; 3] }, &settings)?;
//! let chunks = grid.indices().filter_map(|index| chunk(&ball, &grid, index, &settings));
//! let walls: Vec<_> = chunks.map(|chunk| chunk.visual).collect();
//! assert!(Report::of(&weld(&walls)).is_clean(), "closed and manifold");
//! # Ok::<(), plume::mesh::GridError>(())
//! ```

mod bubbles;
mod cell;
mod chunk;
mod collapse;
mod collapse_mesh;
mod collide;
mod corners;
mod extract;
mod facet;
mod grid;
mod hausdorff;
mod lattice;
pub mod measure;
mod nearest;
mod normals;
mod quadric;
mod queue;
mod settings;
mod simplify;
mod smooth;

pub use chunk::{ChunkMeshes, chunk, may_have_wall, visual_chunk};
pub(crate) use collapse::{CollapsePolicy, Collapser, StopCriterion};
pub(crate) use collapse_mesh::{Collapse, CollapseMesh};
pub(crate) use collide::hull;
pub use collide::{MOST_CORNERS, Piece, PieceMeasures, PieceReport, PieceSettings, Zone, measure_pieces, pieces};
pub use grid::{ChunkIndex, Grid, GridError};
pub(crate) use hausdorff::HausdorffBound;
pub(crate) use nearest::{Found, Nearest, closest};
pub use settings::MeshSettings;

/// Positions are whole multiples of `1 / QUANTA_PER_M` metres, so that they can be compared and welded exactly, and so
/// that they are exact as `f32` within 4096 m of the origin.
pub const QUANTA_PER_M: i32 = 4096;

/// A triangle mesh: part of the wall of the cave, seen from inside.
///
/// Counter-clockwise triangles face the air.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in units of 1/[`QUANTA_PER_M`] m, cave frame.
    pub positions: Vec<[i32; 3]>,
    /// Unit normals of the field at the vertices, into the air. Empty for collision meshes.
    pub normals: Vec<[f32; 3]>,
    /// Indices of the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Whether a vertex is shared with another chunk. Such vertices never move or vanish.
    pub border: Vec<bool>,
}

impl Mesh {
    /// Area of all triangles in m².
    pub fn area_m2(&self) -> f64 {
        let corner = |v: u32| nalgebra::Point3::from(self.positions[v as usize].map(f64::from));
        let area = |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(&(corner(c) - corner(a))).norm() / 2.0;
        let quanta = f64::from(QUANTA_PER_M);
        self.triangles.iter().map(area).sum::<f64>() / (quanta * quanta)
    }

    /// The position of a vertex in metres; exact.
    pub fn position_m(&self, vertex: u32) -> [f32; 3] {
        self.positions[vertex as usize].map(|q| q as f32 / QUANTA_PER_M as f32)
    }

    /// The positions of all vertices in metres.
    pub fn positions_m(&self) -> Vec<[f32; 3]> {
        (0..self.positions.len() as u32).map(|vertex| self.position_m(vertex)).collect()
    }

    /// The part with these triangles, and the vertices that they use.
    pub(crate) fn part(&self, triangles: &[[u32; 3]]) -> Self {
        let mut used: Vec<u32> = triangles.concat();
        used.sort_unstable();
        used.dedup();
        let mut number = vec![0; self.positions.len()];
        used.iter().zip(0..).for_each(|(vertex, n)| number[*vertex as usize] = n);
        let all = || used.iter().map(|vertex| *vertex as usize);
        Self {
            positions: all().map(|vertex| self.positions[vertex]).collect(),
            normals: all().map(|vertex| self.normals[vertex]).collect(),
            triangles: triangles.iter().map(|triangle| triangle.map(|vertex| number[vertex as usize])).collect(),
            border: all().map(|vertex| self.border[vertex]).collect(),
        }
    }
}

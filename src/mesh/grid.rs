use crate::field::Aabb;

use super::lattice::Window;
use super::settings::MeshSettings;

/// The lattice that all chunks of a cave share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Edge of a lattice cell in metres.
    pub voxel_m: f32,
    /// Lattice cells per chunk along x, y and z.
    pub cells: [i32; 3],
    /// Lattice index of the lowest corner of chunk (0, 0, 0).
    pub origin: [i32; 3],
    /// Chunks along x, y and z.
    pub chunks: [i32; 3],
}

/// Index of a chunk in a [`Grid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ChunkIndex(pub [i32; 3]);

/// No grid fits the cave.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// The box is empty or not finite.
    #[error("the cave has no extent along {axis}: {min_m} m to {max_m} m")]
    Empty {
        /// `x`, `y` or `z`.
        axis: char,
        /// Lower end.
        min_m: f32,
        /// Upper end.
        max_m: f32,
    },
    /// Positions would no longer be exact.
    #[error("the cave extends {reach_m} m from its origin along {axis}, but the limit is {limit_m} m")]
    TooFar {
        /// `x`, `y` or `z`.
        axis: char,
        /// Greatest coordinate, without its sign.
        reach_m: f32,
        /// Greatest one allowed.
        limit_m: f32,
    },
    /// A chunk is narrower than its halo.
    #[error("a chunk has {cells} cells along {axis}, but needs at least {least}")]
    NarrowChunk {
        /// `x`, `y` or `z`.
        axis: char,
        /// Cells of a chunk.
        cells: i32,
        /// Least number of cells.
        least: i32,
    },
    /// A chunk would not fit in memory.
    #[error("a chunk has {cells} cells along {axis}, but the limit is {most}")]
    WideChunk {
        /// `x`, `y` or `z`.
        axis: char,
        /// Cells of a chunk.
        cells: i32,
        /// Greatest number of cells.
        most: i32,
    },
    /// There would be too many chunks to open.
    #[error("the cave has {chunks} chunks, but the limit is {limit}")]
    TooManyChunks {
        /// Chunks in the grid.
        chunks: i64,
        /// Greatest number of chunks.
        limit: i64,
    },
}

impl GridError {
    /// What to change.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Empty { .. } => "give the graph at least two nodes, and the passages a width",
            Self::TooFar { .. } => "make the cave shorter, or let it start near the origin",
            Self::NarrowChunk { .. } => "increase `mesh.chunk_m`, or reduce `mesh.divisions` or `mesh.voxel_m`",
            Self::WideChunk { .. } => "reduce `mesh.chunk_m`, or increase `mesh.divisions` or `mesh.voxel_m`",
            Self::TooManyChunks { .. } => "increase `mesh.chunk_m`, or make the cave smaller",
        }
    }
}

/// Beyond this `f32` cannot represent every multiple of 2⁻¹² m.
const LIMIT_M: f32 = 4095.0;
const LIMIT_CHUNKS: i64 = 1 << 20;
const WIDEST_CHUNK_CELLS: i32 = 4096;
const AXES: [char; 3] = ['x', 'y', 'z'];

impl Grid {
    /// The grid over `bounds`, outside which there is rock.
    ///
    /// # Errors
    /// If the bounds are empty or too far out, or the chunks too narrow, too wide or too many.
    pub fn new(bounds: Aabb<f32>, settings: &MeshSettings) -> Result<Self, GridError> {
        let mut grid = Self { voxel_m: settings.voxel_m, cells: [0; 3], origin: [0; 3], chunks: [0; 3] };
        for axis in 0..3 {
            let (first, count) = cells_over(bounds, settings.voxel_m, axis)?;
            let cells = chunk_cells(settings, axis, count)?;
            grid.origin[axis] = first;
            grid.cells[axis] = cells;
            grid.chunks[axis] = (count + cells - 1) / cells;
        }
        let chunks = grid.chunks.iter().map(|&n| i64::from(n)).product();
        if chunks > LIMIT_CHUNKS {
            return Err(GridError::TooManyChunks { chunks, limit: LIMIT_CHUNKS });
        }
        Ok(grid)
    }

    /// All chunks, x fastest, z slowest.
    pub fn indices(&self) -> impl Iterator<Item = ChunkIndex> + use<> {
        let [nx, ny, nz] = self.chunks;
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| ChunkIndex([x, y, z]))))
    }

    /// The box of a chunk. Its mesh may extend beyond it by about a cell.
    pub fn chunk_bounds(&self, index: ChunkIndex) -> Aabb<f32> {
        self.owned(index).bounds(self.voxel_m)
    }

    /// The cells of a chunk.
    pub(super) fn owned(&self, index: ChunkIndex) -> Window {
        let min = std::array::from_fn(|i| self.origin[i] + index.0[i] * self.cells[i]);
        Window { min, max: std::array::from_fn(|i| min[i] + self.cells[i]) }
    }
}

/// First cell and number of cells along an axis, with an extra cell on either side.
fn cells_over(bounds: Aabb<f32>, voxel_m: f32, axis: usize) -> Result<(i32, i32), GridError> {
    let (min_m, max_m) = (bounds.min[axis], bounds.max[axis]);
    let reach_m = min_m.abs().max(max_m.abs());
    if !reach_m.is_finite() || min_m >= max_m {
        return Err(GridError::Empty { axis: AXES[axis], min_m, max_m });
    }
    if reach_m > LIMIT_M {
        return Err(GridError::TooFar { axis: AXES[axis], reach_m, limit_m: LIMIT_M });
    }
    let first = (min_m / voxel_m).floor() as i32 - 1;
    let end = (max_m / voxel_m).ceil() as i32 + 1;
    Ok((first, end - first))
}

fn chunk_cells(settings: &MeshSettings, axis: usize, count: i32) -> Result<i32, GridError> {
    let cells = match settings.divisions {
        // A flat cave in one layer may be thinner than the halo: the chunk then includes additional rock.
        Some(divisions) if divisions[axis] == 1 => count.max(Window::HALO),
        Some(divisions) => (count as u32).div_ceil(divisions[axis].max(1)) as i32,
        None => (settings.chunk_m[axis] / settings.voxel_m).round() as i32,
    };
    let axis = AXES[axis];
    if cells < Window::HALO {
        return Err(GridError::NarrowChunk { axis, cells, least: Window::HALO });
    }
    if cells > WIDEST_CHUNK_CELLS {
        return Err(GridError::WideChunk { axis, cells, most: WIDEST_CHUNK_CELLS });
    }
    Ok(cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(min: [f32; 3], max: [f32; 3]) -> Aabb<f32> {
        Aabb { min, max }
    }

    #[test]
    fn chunks_cover_the_bounds() {
        let cave = bounds([-7.3, 0.0, 2.1], [31.0, 16.0, 9.9]);
        let grid = Grid::new(cave, &MeshSettings::default()).unwrap();
        assert_eq!(grid.chunks, [3, 2, 1]);
        let last = grid.chunk_bounds(grid.indices().last().unwrap());
        let first = grid.chunk_bounds(ChunkIndex([0; 3]));
        for axis in 0..3 {
            assert!(first.min[axis] < cave.min[axis] && last.max[axis] > cave.max[axis]);
        }
        assert_eq!(grid.indices().count(), 6);
    }

    #[test]
    fn divisions_are_kept() {
        let settings = MeshSettings { divisions: Some([4, 3, 1]), ..Default::default() };
        let grid = Grid::new(bounds([0.0; 3], [100.0, 40.0, 1.0]), &settings).unwrap();
        assert_eq!(grid.chunks, [4, 3, 1]);
    }

    #[test]
    fn absurd_grids_are_refused() {
        let refuse = |bounds, settings: MeshSettings| Grid::new(bounds, &settings).unwrap_err();
        let plain = MeshSettings::default;
        let cave = bounds([0.0; 3], [100.0; 3]);
        let empty = refuse(bounds([0.0; 3], [1.0, 0.0, 1.0]), plain());
        assert!(matches!(empty, GridError::Empty { axis: 'y', .. }));
        let endless = refuse(bounds([0.0; 3], [1.0, 1.0, f32::INFINITY]), plain());
        assert!(matches!(endless, GridError::Empty { axis: 'z', .. }));
        let far = refuse(bounds([-9e3; 3], [0.0; 3]), plain());
        assert!(matches!(far, GridError::TooFar { .. }));
        let narrow = refuse(cave, MeshSettings { voxel_m: 0.2, chunk_m: [1.0; 3], ..plain() });
        assert!(matches!(narrow, GridError::NarrowChunk { cells: 5, .. }));
        let divided = refuse(cave, MeshSettings { divisions: Some([1, 1, 99]), ..plain() });
        assert!(matches!(divided, GridError::NarrowChunk { axis: 'z', .. }));
        let wide = refuse(cave, MeshSettings { voxel_m: 0.05, chunk_m: [512.0; 3], ..plain() });
        assert!(matches!(wide, GridError::WideChunk { cells: 10240, .. }));
        let many = MeshSettings { chunk_m: [2.4; 3], ..plain() };
        let many = refuse(bounds([0.0; 3], [4000.0, 4000.0, 20.0]), many);
        assert!(matches!(many, GridError::TooManyChunks { .. }));
        assert!(many.hint().contains("chunk_m"));
    }
}

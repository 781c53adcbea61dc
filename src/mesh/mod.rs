//! Chunks of triangles.
//!
//! A chunk is a pure function of the field, the [`Grid`] and its own [`ChunkIndex`]: any worker can make any chunk, in
//! any order, and neighbours still share their border vertices bit for bit.

/// Positions are whole multiples of `1 / QUANTA_PER_M` metres, so that they can be compared and welded exactly, and so
/// that they are exact as `f32` within 4096 m of the origin.
pub const QUANTA_PER_M: i32 = 4096;

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

/// Which chunk of a [`Grid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ChunkIndex(pub [i32; 3]);

/// A triangle mesh: part of the wall of the cave, seen from inside.
///
/// Counter-clockwise triangles face the air.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in units of 1/[`QUANTA_PER_M`] m, cave frame.
    pub positions: Vec<[i32; 3]>,
    /// Unit normals of the field at the vertices, into the air.
    pub normals: Vec<[f32; 3]>,
    /// Indices of the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Whether a vertex is shared with another chunk. Such vertices never move or vanish.
    pub border: Vec<bool>,
}

impl Mesh {
    /// A vertex in metres; exact.
    pub fn position_m(&self, vertex: u32) -> [f32; 3] {
        self.positions[vertex as usize].map(|q| q as f32 / QUANTA_PER_M as f32)
    }
}

//! Limits of files, so that reading takes bounded time and memory.

/// Stations of a graph or survey.
pub const MAX_STATIONS: usize = 1_000_000;
/// Passages or legs.
pub const MAX_LEGS: usize = 4_000_000;
/// Distance of a node from the origin of its graph, and any other length, in metres.
pub const MAX_LENGTH_M: f64 = 1e6;
/// Largest coordinate of national grids, in metres: no place on earth has a larger one.
pub const MAX_COORDINATE_M: f64 = 1e8;
/// Files that one file includes, directly or indirectly.
pub const MAX_FILES: usize = 1_000;
/// Depth of nesting: elements, blocks, includes.
pub const MAX_DEPTH: usize = 64;
/// Bytes of one line of a text file.
pub const MAX_LINE: usize = 64 * 1024;
/// Total bytes of all files that one file includes.
pub const MAX_BYTES: usize = 256 << 20;

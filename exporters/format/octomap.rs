//! OctoMap binary trees, `.bt`: which cells are occupied, free or unknown.
//!
//! Follows the OctoMap library (Hornung et al. 2013, <https://octomap.github.io>): some lines of text, then for each inner node,
//! parents first, two bits for each of its eight children. The tree has sixteen levels and its root is centred on the origin, so its
//! cells are those of [`Voxels`]. Eight cells of the same kind are one of twice the side.
//!
//! ```
//! use plume_exporters::format::octomap;
//! use plume_truth::Voxels;
//!
//! let mut voxels = Voxels::new(0.1);
//! voxels.add(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[0, 1, 2], &[1]);
//! let mut file = Vec::new();
//! octomap::write(&mut file, 0.1, &voxels.into_blocks())?;
//! assert!(file.starts_with(b"# Octomap OcTree binary file\n"));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Write};

use plume_truth::{Block, SIDE, Voxels};

/// Levels of a tree below its root, which a format without a field for it fixes.
const LEVELS: u32 = 16;
/// Levels within a block.
const OF_BLOCK: u32 = SIDE.ilog2();
/// Blocks from the lowest corner of a tree to its middle.
const HALF: i32 = 1 << (LEVELS - OF_BLOCK - 1);

/// How far from the origin a tree of cells with this side reaches along each axis, in metres.
pub fn reach_m(cell_m: f64) -> f64 {
    f64::from(HALF) * SIDE as f64 * cell_m
}

/// Whether all blocks are within the reach of a tree.
pub fn holds(blocks: &[Block<u8>]) -> bool {
    blocks.iter().flat_map(|block| block.place).all(|n| (-HALF..HALF).contains(&n))
}

/// Writes a tree of cells with this side in metres. A tree [holds](holds()) all blocks.
///
/// # Errors
/// Those of `file`.
pub fn write(file: &mut dyn Write, cell_m: f64, blocks: &[Block<u8>]) -> io::Result<()> {
    let mut ordered: Vec<(u64, &Block<u8>)> = blocks.iter().map(|block| (order(block.place), block)).collect();
    ordered.sort_unstable_by_key(|(order, _)| *order);
    let (nodes, bytes) = match of_blocks(&ordered, LEVELS - OF_BLOCK) {
        Node::Inner { nodes, bytes } => (nodes, bytes),
        _ => (0, Vec::new()),
    };
    writeln!(file, "# Octomap OcTree binary file\n#\nid OcTree\nsize {nodes}\nres {cell_m}\ndata")?;
    file.write_all(&bytes)
}

/// The order of a block in the tree: the bits of its numbers, interleaved, those of z before y before x.
fn order(place: [i32; 3]) -> u64 {
    let bit = |n: i32, level: u32| ((n + HALF) as u64 >> level) & 1;
    let [x, y, z] = place;
    (0..LEVELS - OF_BLOCK)
        .map(|level| (bit(x, level) | bit(y, level) << 1 | bit(z, level) << 2) << (3 * level))
        .fold(0, |order, bits| order | bits)
}

/// A part of the tree.
enum Node {
    Unknown,
    Free,
    Occupied,
    /// Its number of nodes, itself included, and its bytes.
    Inner {
        nodes: u64,
        bytes: Vec<u8>,
    },
}

/// The node of so many levels that these blocks are in.
fn of_blocks(blocks: &[(u64, &Block<u8>)], levels: u32) -> Node {
    let Some(((_, first), more)) = blocks.split_first() else {
        return Node::Unknown;
    };
    if levels == 0 {
        debug_assert!(more.is_empty());
        return of_cells(&first.cells[..], [0; 3], SIDE);
    }
    let child = |(order, _): &(u64, _)| (order >> (3 * (levels - 1))) & 7;
    let start = |octant: u64| blocks.partition_point(|block| child(block) < octant);
    joined([0, 1, 2, 3, 4, 5, 6, 7].map(|octant| of_blocks(&blocks[start(octant)..start(octant + 1)], levels - 1)))
}

/// The node of a cube of cells of a block.
fn of_cells(cells: &[u8], [x, y, z]: [usize; 3], side: usize) -> Node {
    if side == 1 {
        return match cells[(x * SIDE + y) * SIDE + z] {
            Voxels::UNKNOWN => Node::Unknown,
            Voxels::FREE => Node::Free,
            _ => Node::Occupied,
        };
    }
    let half = side / 2;
    let corner = |octant: usize| [x + (octant & 1) * half, y + (octant >> 1 & 1) * half, z + (octant >> 2) * half];
    joined([0, 1, 2, 3, 4, 5, 6, 7].map(|octant| of_cells(cells, corner(octant), half)))
}

/// The node with these children.
fn joined(children: [Node; 8]) -> Node {
    let leaf = |is_leaf: fn(&Node) -> bool| children.iter().all(is_leaf);
    if leaf(|child| matches!(child, Node::Unknown)) {
        return Node::Unknown;
    }
    if leaf(|child| matches!(child, Node::Free)) {
        return Node::Free;
    }
    if leaf(|child| matches!(child, Node::Occupied)) {
        return Node::Occupied;
    }
    inner(&children)
}

fn inner(children: &[Node; 8]) -> Node {
    let (mut nodes, mut bytes, mut kinds) = (1, vec![0; 2], 0_u16);
    for (octant, child) in children.iter().enumerate() {
        let kind = match child {
            Node::Unknown => continue,
            Node::Free => 0b01,
            Node::Occupied => 0b10,
            Node::Inner { .. } => 0b11,
        };
        kinds |= kind << (2 * octant);
        nodes += 1;
        if let Node::Inner { nodes: below, bytes: own } = child {
            nodes += below - 1;
            bytes.extend(own);
        }
    }
    bytes[..2].copy_from_slice(&kinds.to_le_bytes());
    Node::Inner { nodes, bytes }
}

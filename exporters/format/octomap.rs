//! OctoMap binary trees, `.bt`: which cells are occupied, free or unknown.
//!
//! Follows the OctoMap library (Hornung et al. 2013, <https://octomap.github.io>): some lines of text, then for each inner node,
//! parents first, two bits for each of its eight children. The tree has sixteen levels and its root is centred on the origin, so its
//! cells are those of [`Voxels`]. Eight cells of the same kind are one of twice the side. Blocks are read when they are needed: in memory
//! are 24 bytes for each.
//!
//! ```
//! use plume_exporters::format::octomap;
//! use plume_truth::Voxels;
//!
//! let mut voxels = Voxels::new(0.1);
//! voxels.add(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[0, 1, 2], &[1]);
//! let blocks = voxels.into_blocks();
//! let places: Vec<[i32; 3]> = blocks.iter().map(|block| block.place).collect();
//! let mut file = Vec::new();
//! octomap::write(&mut file, 0.1, &places, |number| Ok(*blocks[number].cells))?;
//! assert!(file.starts_with(b"# Octomap OcTree binary file\n"));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Write};

use plume_truth::{CELLS, SIDE, Voxels};

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

/// Whether all blocks, of which these are the places, are within the reach of a tree.
pub fn holds(places: &[[i32; 3]]) -> bool {
    places.as_flattened().iter().all(|n| (-HALF..HALF).contains(n))
}

/// Writes a tree of cells with this side in metres, given the places of its blocks, which it [holds](holds()), and how to read the
/// states of the cells of one by its number.
///
/// # Errors
/// Those of `file` and of `states_of`.
pub fn write(
    file: &mut dyn Write,
    cell_m: f64,
    places: &[[i32; 3]],
    states_of: impl FnMut(usize) -> io::Result<[u8; CELLS]>,
) -> io::Result<()> {
    let mut ordered: Vec<(u64, u32)> = places.iter().map(|place| order(*place)).zip(0..).collect();
    ordered.sort_unstable();
    let mut tree = Tree { states_of, nodes: 0, items: Vec::new() };
    if tree.of_blocks(&ordered, LEVELS - OF_BLOCK)? == Kind::Inner {
        tree.nodes += 1;
    }
    let Tree { mut states_of, nodes, items } = tree;
    writeln!(file, "# Octomap OcTree binary file\n#\nid OcTree\nsize {nodes}\nres {cell_m}\ndata")?;
    for item in items {
        match item {
            Item::Node(kinds) => file.write_all(&kinds)?,
            Item::Block(number) => file.write_all(&Nodes::of(&states_of(number as usize)?).bytes)?,
        }
    }
    Ok(())
}

/// The order of a block in the tree: the bits of its numbers, interleaved, those of z before y before x.
fn order(place: [i32; 3]) -> u64 {
    let bit = |n: i32, level: u32| ((n + HALF) as u64 >> level) & 1;
    let [x, y, z] = place;
    (0..LEVELS - OF_BLOCK)
        .map(|level| (bit(x, level) | bit(y, level) << 1 | bit(z, level) << 2) << (3 * level))
        .fold(0, |order, bits| order | bits)
}

/// What a cube of the tree is.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Unknown,
    Free,
    Occupied,
    Inner,
}

/// What a file is written from, in its order.
enum Item {
    /// An inner node that is larger than a block.
    Node([u8; 2]),
    /// The inner nodes of the block with this number.
    Block(u32),
}

/// The tree down to its blocks.
struct Tree<F> {
    states_of: F,
    /// Number of nodes below the root.
    nodes: u64,
    items: Vec<Item>,
}

impl<F: FnMut(usize) -> io::Result<[u8; CELLS]>> Tree<F> {
    /// Adds the cube of so many levels that these blocks are in.
    fn of_blocks(&mut self, blocks: &[(u64, u32)], levels: u32) -> io::Result<Kind> {
        let Some(((_, first), more)) = blocks.split_first() else {
            return Ok(Kind::Unknown);
        };
        if levels == 0 {
            debug_assert!(more.is_empty());
            return self.of_block(*first);
        }
        let child = |(order, _): &(u64, u32)| (order >> (3 * (levels - 1))) & 7;
        let start = |octant: u64| blocks.partition_point(|block| child(block) < octant);
        let place = self.items.len();
        self.items.push(Item::Node([0; 2]));
        let mut children = [Kind::Unknown; 8];
        for (octant, kind) in (0..).zip(&mut children) {
            *kind = self.of_blocks(&blocks[start(octant)..start(octant + 1)], levels - 1)?;
        }
        let Some(own) = inner(children) else {
            // What is all of one kind has no nodes below it.
            self.items.truncate(place);
            return Ok(children[0]);
        };
        self.items[place] = Item::Node(own.kinds);
        self.nodes += own.children;
        Ok(Kind::Inner)
    }

    fn of_block(&mut self, number: u32) -> io::Result<Kind> {
        let nodes = Nodes::of(&(self.states_of)(number as usize)?);
        if nodes.kind == Kind::Inner {
            self.nodes += nodes.below;
            self.items.push(Item::Block(number));
        }
        Ok(nodes.kind)
    }
}

/// The nodes of a block.
struct Nodes {
    kind: Kind,
    /// Number of nodes below the uppermost.
    below: u64,
    /// The inner nodes.
    bytes: Vec<u8>,
}

impl Nodes {
    fn of(states: &[u8; CELLS]) -> Self {
        let mut nodes = Self { kind: Kind::Unknown, below: 0, bytes: Vec::new() };
        nodes.kind = nodes.of_cells(states, [0; 3], SIDE);
        nodes
    }

    /// Adds a cube of cells.
    fn of_cells(&mut self, states: &[u8; CELLS], [x, y, z]: [usize; 3], side: usize) -> Kind {
        if side == 1 {
            return match states[(x * SIDE + y) * SIDE + z] {
                Voxels::UNKNOWN => Kind::Unknown,
                Voxels::FREE => Kind::Free,
                _ => Kind::Occupied,
            };
        }
        let half = side / 2;
        let corner = |octant: usize| [x + (octant & 1) * half, y + (octant >> 1 & 1) * half, z + (octant >> 2) * half];
        let place = self.bytes.len();
        self.bytes.extend([0; 2]);
        let children = [0, 1, 2, 3, 4, 5, 6, 7].map(|octant| self.of_cells(states, corner(octant), half));
        let Some(own) = inner(children) else {
            self.bytes.truncate(place);
            return children[0];
        };
        self.bytes[place..place + 2].copy_from_slice(&own.kinds);
        self.below += own.children;
        Kind::Inner
    }
}

/// An inner node.
struct Inner {
    /// Number of its children.
    children: u64,
    /// Two bits for each octant.
    kinds: [u8; 2],
}

/// The inner node with these children; none if all are of the same kind and have no children themselves.
fn inner(children: [Kind; 8]) -> Option<Inner> {
    if children[0] != Kind::Inner && children == [children[0]; 8] {
        return None;
    }
    let (mut count, mut kinds) = (0, 0_u16);
    for (octant, child) in children.into_iter().enumerate() {
        let kind = match child {
            Kind::Unknown => continue,
            Kind::Free => 0b01,
            Kind::Occupied => 0b10,
            Kind::Inner => 0b11,
        };
        kinds |= kind << (2 * octant);
        count += 1;
    }
    Some(Inner { children: count, kinds: kinds.to_le_bytes() })
}

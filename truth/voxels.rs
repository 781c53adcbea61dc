//! Which cubes of a grid are air, and through which a surface passes.

use super::blocks::{Block, Blocks};
use super::columns::Gap;
use super::vector::{cross, dot, minus};

/// Cells of a cubic grid, which is fixed to the frame: cell `[i, j, k]` is the cube between `i` and `i + 1` times its side along x,
/// and so along the other axes.
pub struct Voxels {
    cell_m: f64,
    states: Blocks<u8>,
}

/// What is not told apart by rounding, in metres: a surface that is only so far from a cell passes through it.
const TOUCH_M: f64 = 1e-9;

impl Voxels {
    /// The state of a cell of which nothing is known: it is in the rock or in a body.
    pub const UNKNOWN: u8 = 0;
    /// The state of a cell that is all air. Those between are labels of what passes through.
    pub const FREE: u8 = u8::MAX;

    /// A grid of cells with this side in metres.
    pub fn new(cell_m: f64) -> Self {
        Self { cell_m, states: Blocks::new(Self::UNKNOWN) }
    }

    /// Marks the cells that triangles pass through or touch: corners in metres, three indices and a label a triangle.
    ///
    /// Where several pass through a cell, it has the largest label.
    ///
    /// # Panics
    /// If a label is that of a free or unknown cell.
    pub fn add(&mut self, corners: &[[f32; 3]], indices: &[u32], labels: &[u8]) {
        for (triangle, &label) in indices.as_chunks::<3>().0.iter().zip(labels) {
            assert!(![Self::UNKNOWN, Self::FREE].contains(&label), "{label} is not the label of a surface");
            self.add_triangle(triangle.map(|corner| corners[corner as usize].map(f64::from)), label);
        }
    }

    fn add_triangle(&mut self, corners: [[f64; 3]; 3], label: u8) {
        let bound = |axis: usize, of: fn(f64, f64) -> f64| corners.iter().map(|at| at[axis]).reduce(of).unwrap_or(0.0);
        let cell_of = |along_m: f64| (along_m / self.cell_m).floor() as i32;
        let first = [0, 1, 2].map(|axis| cell_of(bound(axis, f64::min) - TOUCH_M));
        let last = [0, 1, 2].map(|axis| cell_of(bound(axis, f64::max) + TOUCH_M));
        for i in first[0]..=last[0] {
            for j in first[1]..=last[1] {
                for k in first[2]..=last[2] {
                    let centre = [i, j, k].map(|n| (f64::from(n) + 0.5) * self.cell_m);
                    if touches(&corners, centre, 0.5 * self.cell_m + TOUCH_M) {
                        let state = self.states.cell_mut([i, j, k]);
                        *state = label.max(*state);
                    }
                }
            }
        }
    }

    /// Adds what triangles elsewhere made of a block of the same grid.
    pub(super) fn join(&mut self, place: [i32; 3], states: impl Iterator<Item = u8>) {
        self.states.join(place, states, u8::max);
    }

    /// Marks what is free, given the air in the columns of the same grid, once all triangles are there.
    ///
    /// No surface passes through the other cells, so each is on one side of all: that of its centre.
    pub fn fill(&mut self, air: &[Gap]) {
        for gap in air {
            for k in heights(gap, self.cell_m) {
                let state = self.states.cell_mut([gap.cell[0], gap.cell[1], k]);
                if *state == Self::UNKNOWN {
                    *state = Self::FREE;
                }
            }
        }
    }

    /// The states, in blocks by place.
    pub fn into_blocks(self) -> Vec<Block<u8>> {
        self.states.into_sorted()
    }
}

/// Numbers along z of the cells whose centres are in a gap.
pub(super) fn heights(gap: &Gap, cell_m: f64) -> std::ops::RangeInclusive<i32> {
    let [low, high] = [gap.floor_m, gap.ceiling_m].map(|z| f64::from(z) / cell_m - 0.5);
    low.ceil() as i32..=high.floor() as i32
}

/// Whether a triangle and a cube of this half side have a point in common, by the axes that could separate them (Akenine-Möller
/// 2001).
fn touches(corners: &[[f64; 3]; 3], centre: [f64; 3], half: f64) -> bool {
    let [a, b, c] = corners.map(|at| minus(at, centre));
    let edges = [minus(b, a), minus(c, b), minus(a, c)];
    let is_apart = |axis: [f64; 3]| {
        let along = [a, b, c].map(|corner| dot(axis, corner));
        let reach = half * (axis[0].abs() + axis[1].abs() + axis[2].abs());
        along.iter().all(|along| *along > reach) || along.iter().all(|along| *along < -reach)
    };
    let sides = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    !sides.into_iter().any(is_apart)
        && !is_apart(cross(edges[0], edges[1]))
        && !edges.into_iter().any(|edge| sides.into_iter().any(|side| is_apart(cross(side, edge))))
}

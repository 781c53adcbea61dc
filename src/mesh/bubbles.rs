//! Small pieces that float, in the rock or in the air.
//!
//! A piece is dropped when it spans fewer cells than [`MOST_CELLS`] along every axis. The halo is wider than that by
//! two, so a piece that reaches into a chunk and is cut off by its window spans more: every chunk judges alike.

use super::extract::Surface;
use super::lattice::Window;

const MOST_CELLS: i32 = Window::HALO - 2;

/// Removes the quads of small pieces. Their vertices stay, unused.
pub(super) fn drop_bubbles(surface: &mut Surface) {
    let roots = roots(surface);
    let mut spans = vec![Span::EMPTY; roots.len()];
    for (&root, &cell) in roots.iter().zip(&surface.cells) {
        spans[root as usize].add(cell);
    }
    surface.quads.retain(|quad| !spans[roots[quad.corners[0] as usize] as usize].is_small());
}

#[derive(Clone, Copy)]
struct Span {
    min: [i32; 3],
    max: [i32; 3],
}

impl Span {
    const EMPTY: Self = Self { min: [i32::MAX; 3], max: [i32::MIN; 3] };

    fn add(&mut self, cell: [i32; 3]) {
        for (axis, c) in cell.into_iter().enumerate() {
            self.min[axis] = self.min[axis].min(c);
            self.max[axis] = self.max[axis].max(c);
        }
    }

    fn is_small(&self) -> bool {
        (0..3).all(|axis| self.max[axis] - self.min[axis] < MOST_CELLS)
    }
}

/// The lowest vertex of the piece of each vertex.
fn roots(surface: &Surface) -> Vec<u32> {
    let mut parents: Vec<u32> = (0..surface.vertices.len() as u32).collect();
    for quad in &surface.quads {
        for pair in quad.corners.windows(2) {
            let (a, b) = (find(&mut parents, pair[0]), find(&mut parents, pair[1]));
            parents[a.max(b) as usize] = a.min(b);
        }
    }
    (0..parents.len() as u32).map(|vertex| find(&mut parents, vertex)).collect()
}

/// The root of a vertex, halving the path to it.
pub(super) fn find(parents: &mut [u32], mut vertex: u32) -> u32 {
    while parents[vertex as usize] != vertex {
        parents[vertex as usize] = parents[parents[vertex as usize] as usize];
        vertex = parents[vertex as usize];
    }
    vertex
}

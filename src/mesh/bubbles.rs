//! Removes small floating components, in the rock or in the air.
//!
//! A component is dropped if it spans fewer cells than [`MOST_CELLS`] along every axis. The halo is wider than that by two,
//! so a component that is in a chunk and cut off by its window spans more: every chunk decides the same.

use super::extract::Surface;
use super::lattice::Window;
use plume_graph::Aabb;

const MOST_CELLS: i32 = Window::HALO - 2;

/// Removes the quads of small components. Their vertices stay, unused.
pub(super) fn drop_bubbles(surface: &mut Surface) {
    let roots = roots(surface);
    let mut spans: Vec<Aabb<i32>> = surface.cells.iter().copied().map(Aabb::from).collect();
    for (&root, &cell) in roots.iter().zip(&surface.cells) {
        spans[root as usize] = spans[root as usize].including(cell);
    }
    let is_small = |span: &Aabb<i32>| span.size().iter().all(|&side| side < MOST_CELLS);
    surface.quads.retain(|quad| !is_small(&spans[roots[quad.corners[0] as usize] as usize]));
}

/// The lowest vertex of the component of each vertex.
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

/// The root of a vertex, with path halving.
pub(super) fn find(parents: &mut [u32], mut vertex: u32) -> u32 {
    while parents[vertex as usize] != vertex {
        parents[vertex as usize] = parents[parents[vertex as usize] as usize];
        vertex = parents[vertex as usize];
    }
    vertex
}

//! Taubin's λ|μ smoothing (*A signal processing approach to fair surface design*, 1995): evens out the steps of the
//! lattice without shrinking the cave.
//!
//! Each pass uses neighbours one vertex further away, which determines the width of the halo.

use nalgebra::Vector3;

use super::extract::{Quad, Surface};
use plume_graph::Rows;

/// Pairs of passes. Tuned: enough that no angle of a rough cave is under 2°.
const PAIRS: usize = 5;
const LAMBDA: f64 = 0.5;
const MU: f64 = -0.53;

/// Smooths the vertices in place.
pub(super) fn smooth(surface: &mut Surface) {
    let neighbours = Neighbours::new(surface);
    let mut next = surface.vertices.clone();
    for factor in [LAMBDA, MU].repeat(PAIRS) {
        for (vertex, moved) in next.iter_mut().enumerate() {
            *moved = neighbours.moved(&surface.vertices, vertex, factor);
        }
        std::mem::swap(&mut surface.vertices, &mut next);
    }
}

/// The neighbours of each vertex, in the order of the quads, so that sums are rounded equally in every chunk.
struct Neighbours(Rows<u32>);

impl Neighbours {
    /// Each neighbour is found once: the two quads of an edge traverse it in opposite directions.
    fn new(surface: &Surface) -> Self {
        let sides = |quad: &Quad| {
            let [a, b, c, d] = quad.corners;
            [(a as usize, b), (b as usize, c), (c as usize, d), (d as usize, a)]
        };
        Self(Rows::from_pairs(surface.vertices.len(), surface.quads.iter().flat_map(sides)))
    }

    fn moved(&self, vertices: &[Vector3<f64>], vertex: usize, factor: f64) -> Vector3<f64> {
        let at = vertices[vertex];
        let ends = &self.0[vertex];
        if ends.is_empty() {
            return at;
        }
        let sum = ends.iter().fold(Vector3::zeros(), |sum, &end| sum + vertices[end as usize]);
        at + (sum / ends.len() as f64 - at) * factor
    }
}

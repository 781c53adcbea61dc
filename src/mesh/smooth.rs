//! Taubin's λ|μ smoothing (*A signal processing approach to fair surface design*, 1995): evens out the steps of the
//! lattice without shrinking the cave.
//!
//! Each pass looks one vertex further, which is what sets the width of the halo.

use nalgebra::Vector3;

use super::extract::Surface;

/// Pairs of passes. Tuned: enough that no angle of a rough cave stays under 2°.
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

/// The vertices at the other ends of the edges of each vertex, in the order of the quads: sums then round alike in
/// every chunk.
struct Neighbours {
    starts: Vec<u32>,
    ends: Vec<u32>,
}

impl Neighbours {
    /// Neighbours that share both quads of an edge are found once: each quad gives the edge its own direction.
    fn new(surface: &Surface) -> Self {
        let mut starts = vec![0; surface.vertices.len() + 1];
        for corner in surface.quads.iter().flat_map(|quad| quad.corners) {
            starts[corner as usize + 1] += 1;
        }
        for vertex in 1..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let mut filled = starts.clone();
        let mut ends = vec![0; 4 * surface.quads.len()];
        for quad in &surface.quads {
            for side in 0..4 {
                let slot = &mut filled[quad.corners[side] as usize];
                ends[*slot as usize] = quad.corners[(side + 1) % 4];
                *slot += 1;
            }
        }
        Self { starts, ends }
    }

    fn moved(&self, vertices: &[Vector3<f64>], vertex: usize, factor: f64) -> Vector3<f64> {
        let at = vertices[vertex];
        let ends = &self.ends[self.starts[vertex] as usize..self.starts[vertex + 1] as usize];
        if ends.is_empty() {
            return at;
        }
        let sum = ends.iter().fold(Vector3::zeros(), |sum, &end| sum + vertices[end as usize]);
        at + (sum / ends.len() as f64 - at) * factor
    }
}

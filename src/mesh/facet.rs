//! From smoothed quads to triangles with positions in whole quanta.

use nalgebra::Vector3;

use super::extract::{Quad, Surface};
use super::{Mesh, QUANTA_PER_M};

/// The triangles of a chunk.
#[derive(Clone)]
pub(super) struct Facets {
    /// Positions, triangles and border; no normals yet.
    pub(super) mesh: Mesh,
    /// Sum of the area-weighted normals around each vertex, into the air. On a border it is computed before simplification
    /// and includes the quads of neighbours, so both sides have the same.
    pub(super) area_normals: Vec<Vector3<f64>>,
}

/// Rounds, and splits the quads that the chunk owns.
pub(super) fn triangulate(surface: &Surface, voxel_m: f32) -> Facets {
    let scale = f64::from(voxel_m) * f64::from(QUANTA_PER_M);
    let quantum = |v: &Vector3<f64>| [v.x, v.y, v.z].map(|c| (c * scale).round() as i32);
    let positions: Vec<_> = surface.vertices.iter().map(quantum).collect();
    let area_normals = area_normals(&positions, &surface.quads);
    let uses = Uses::count(surface);
    let mut facets = Facets { mesh: Mesh::default(), area_normals: Vec::new() };
    let mut names = vec![u32::MAX; positions.len()];
    for quad in surface.quads.iter().filter(|quad| quad.owned) {
        let corners = quad.corners.map(|corner| {
            let vertex = corner as usize;
            if names[vertex] == u32::MAX {
                names[vertex] = facets.mesh.positions.len() as u32;
                facets.mesh.positions.push(positions[vertex]);
                facets.mesh.border.push(uses.foreign[vertex]);
                facets.area_normals.push(area_normals[vertex]);
            }
            names[vertex]
        });
        facets.mesh.triangles.extend(split(&facets.mesh.positions, corners));
    }
    facets
}

/// Which vertices neighbours use.
struct Uses {
    foreign: Vec<bool>,
}

impl Uses {
    fn count(surface: &Surface) -> Self {
        let mut foreign = vec![false; surface.vertices.len()];
        for quad in surface.quads.iter().filter(|quad| !quad.owned) {
            for corner in quad.corners {
                foreign[corner as usize] = true;
            }
        }
        Self { foreign }
    }
}

fn area_normals(positions: &[[i32; 3]], quads: &[Quad]) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); positions.len()];
    for quad in quads {
        let [a, b, c, d] = quad.corners.map(|corner| positions[corner as usize]);
        // Whole numbers below 2⁵³: the sums are exact, in any order.
        let area = edge(a, c).cross(&edge(b, d));
        for corner in quad.corners {
            sums[corner as usize] += area;
        }
    }
    sums
}

/// Splits along the diagonal that does not fold the quad or, if both are valid, gives the larger smallest angle.
fn split(positions: &[[i32; 3]], [a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    let along_ac = [[a, b, c], [a, c, d]];
    let along_bd = [[a, b, d], [b, c, d]];
    if soundness(positions, along_bd) > soundness(positions, along_ac) {
        return along_bd;
    }
    along_ac
}

/// Whether two triangles face the same half-space, then the worse of their shapes.
fn soundness(positions: &[[i32; 3]], triangles: [[u32; 3]; 2]) -> (bool, f64) {
    let corners = triangles.map(|triangle| triangle.map(|corner| positions[corner as usize]));
    let [first, second] = corners.map(|[a, b, c]| edge(a, b).cross(&edge(a, c)));
    let [p, q] = corners.map(sharpness);
    (first.dot(&second) > 0.0, p.min(q))
}

/// The squared sine of the smallest angle of a triangle.
fn sharpness([a, b, c]: [[i32; 3]; 3]) -> f64 {
    let (ab, bc, ca) = (edge(a, b), edge(b, c), edge(c, a));
    let mut sides = [ab.norm_squared(), bc.norm_squared(), ca.norm_squared()];
    sides.sort_by(f64::total_cmp);
    let area = ab.cross(&ca).norm_squared();
    if area == 0.0 { 0.0 } else { area / (sides[1] * sides[2]) }
}

fn edge(from: [i32; 3], to: [i32; 3]) -> Vector3<f64> {
    Vector3::new(to[0] - from[0], to[1] - from[1], to[2] - from[2]).map(f64::from)
}

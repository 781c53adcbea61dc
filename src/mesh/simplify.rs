//! Simplification by edge collapses with quadric error metrics (Garland and Heckbert 1997).
//!
//! The error of a collapse is the root mean square distance of the new vertex to the planes of all triangles it represents,
//! with the weight capped at that of a few vertices: accuracy over a wide wall does not compensate for errors in a corner.
//! It is not a bound of the maximum distance. Measured on rough passages against the original mesh, in both directions, at
//! errors from 0.05 to 0.5 voxels: 99.9 % of the surface is within 1.3 times the error, all of it within three times.

use nalgebra::Vector3;

use super::Mesh;
use super::collapse::{CollapsePolicy, Collapser, StopCriterion};
use super::collapse_mesh::{Collapse, CollapseMesh};
use super::facet::Facets;

/// The simplified triangles, and the maximum error of a collapse in metres.
pub(super) fn simplify(facets: &Facets, goal: StopCriterion) -> (Facets, f32) {
    let mut collapser = Collapser::new(&facets.mesh, AnyEdge);
    let error_m = collapser.run(goal);
    if collapser.mesh.live() == facets.mesh.triangles.len() {
        return (facets.clone(), error_m);
    }
    (packed(&collapser.mesh, facets), error_m)
}

/// Any edge that does not join two border vertices may collapse, to the optimal position.
struct AnyEdge;

impl CollapsePolicy for AnyEdge {
    fn ways(ends: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        std::iter::once(ends)
    }

    fn plan(&self, collapse_mesh: &CollapseMesh, [a, b]: [u32; 2]) -> Option<Collapse> {
        let [at_a, at_b] = [a, b].map(|v| collapse_mesh.position(v));
        let joined = collapse_mesh.joined([a, b]);
        let collapse = |kept, gone, to| Collapse { kept, gone, to, error: joined.error(&to) };
        match [a, b].map(|v| collapse_mesh.is_border(v)) {
            [true, true] => None,
            [true, false] => Some(collapse(a, b, at_a)),
            [false, true] => Some(collapse(b, a, at_b)),
            [false, false] => {
                let middle = ((at_a + at_b) * 0.5).map(f64::round);
                let reach = (at_a - at_b).norm_squared();
                let best = joined.quadric.minimum().map(|p| p.map(f64::round));
                let best = best.filter(|p| (p - middle).norm_squared() <= reach);
                let middle = collapse(a, b, middle);
                let best = best.map(|p| collapse(a, b, p)).filter(|c| c.error < middle.error);
                Some(best.unwrap_or(middle))
            }
        }
    }

    fn allows(&self, _: &CollapseMesh, _: &Collapse) -> bool {
        true
    }

    fn apply(&mut self, _: &CollapseMesh, _: &Collapse) {}
}

/// The remaining triangles, in their original order.
fn packed(collapse_mesh: &CollapseMesh, before: &Facets) -> Facets {
    const NONE: u32 = u32::MAX;
    let first = before.mesh.positions.first().copied().unwrap_or_default();
    let areas = areas(collapse_mesh);
    let mut names = vec![NONE; areas.len()];
    let mut facets = Facets { mesh: Mesh::default(), area_normals: Vec::new() };
    for triangle in collapse_mesh.left() {
        let triangle = triangle.map(|corner| {
            let vertex = corner as usize;
            if names[vertex] == NONE {
                names[vertex] = facets.mesh.positions.len() as u32;
                let at = collapse_mesh.position(corner);
                let at = std::array::from_fn(|i| at[i] as i32 + first[i]);
                let border = collapse_mesh.is_border(corner);
                let lean = if border { before.area_normals[vertex] } else { areas[vertex] };
                facets.mesh.positions.push(at);
                facets.mesh.border.push(border);
                facets.area_normals.push(lean);
            }
            names[vertex]
        });
        facets.mesh.triangles.push(triangle);
    }
    facets
}

fn areas(collapse_mesh: &CollapseMesh) -> Vec<Vector3<f64>> {
    let mut areas = vec![Vector3::zeros(); collapse_mesh.vertices()];
    for triangle in collapse_mesh.left() {
        let [a, b, c] = collapse_mesh.corners_of(*triangle);
        let area = (b - a).cross(&(c - a));
        for &corner in triangle {
            areas[corner as usize] += area;
        }
    }
    areas
}

//! The collapse policy of textured chunks, so that one atlas serves all levels of detail.
//!
//! A vertex only merges into a neighbour, whose position, normal, texture coordinates and tangent stay exactly the same; its
//! copies along a seam follow. So every triangle stays in its chart, and since a chart is a projection along an axis, a
//! coarser triangle shows the wall behind it.
//!
//! Inside a chart the coverage is unchanged. Where a seam is straightened, triangles extend beyond the rim of their chart.
//! The displacement of the rim counts as an error of the collapse, so wrong texels are about as wide as the error of the
//! level. This is not a bound. Measured on the default cave at 80 texels per metre, with rims of two texels instead of eight,
//! as shares of the texels of a level: with half of the triangles 0.04 % are beyond the rim of their chart, with a quarter
//! 2.9 %, with a sixth 6.4 %; of these 0, 0.2 and 0.5 % are on another chart, the others on a row of the rim's colour.

use nalgebra::{Vector2, Vector3};

use super::Textured;
use super::adjacency::{NONE, neighbours};
use crate::mesh::{Collapse, CollapseMesh, CollapsePolicy, QUANTA_PER_M};

/// Minimum area in the atlas of a triangle with an area of 1. Charts start at 0.5. Tuned: lower stretches more.
const LEAST_FACING: f64 = 0.25;

/// The collapse policy of a textured chunk.
pub(super) struct Seams {
    /// The triangles by their copies: vertices of the textured chunk.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The copies in the plane of their chart, in quanta of the mesh.
    places: Vec<Vector2<f64>>,
    /// Kind by mesh vertex.
    roles: Vec<Role>,
    /// The neighbours of each copy along the rim of its chart in full detail, [`NONE`] if there are not two.
    rims: Vec<[u32; 2]>,
    /// Copies whose vertex remains.
    alive: Vec<bool>,
}

/// Position of a vertex relative to the seams of full detail.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    /// Inside a chart.
    Inside,
    /// On a seam between two charts that continues on both sides.
    Along,
    /// On the border of the chunk, where a seam ends, or where several meet.
    Fixed,
}

impl Seams {
    pub(super) fn new(textured: &Textured, border: &[bool]) -> Self {
        let quanta = f64::from(textured.size_px) / f64::from(textured.texels_per_m) * f64::from(QUANTA_PER_M);
        let place = |uv: &[f32; 2]| Vector2::from(*uv).map(f64::from) * quanta;
        let rims = rims(textured);
        Self {
            triangles: textured.triangles.clone(),
            places: textured.uvs.iter().map(place).collect(),
            roles: roles(textured, border, &rims),
            alive: vec![true; rims.len()],
            rims: rims.into_iter().map(|rim| rim.unwrap_or([NONE; 2])).collect(),
        }
    }

    /// The replacements of the copies of `gone`: two pairs, equal inside a chart. `None` if there is no such edge.
    fn pairs(&self, collapse_mesh: &CollapseMesh, [kept, gone]: [u32; 2]) -> Option<[[u32; 2]; 2]> {
        let mut pairs = collapse_mesh.around(gone).filter_map(|(triangle, vertices, place)| {
            let other = vertices.iter().position(|&vertex| vertex == kept)?;
            let copies = self.triangles[triangle];
            Some([copies[place], copies[other]])
        });
        Some([pairs.next()?, pairs.next()?])
    }

    /// Displacement of the rim on one side if `gone` is removed, in quanta: the maximum distance from the rim in full detail
    /// to the new one.
    fn drift(&self, gone: u32) -> f64 {
        let [back, ahead] = self.rims[gone as usize].map(|first| self.walk(gone, first));
        let (Some(back), Some(ahead)) = (back, ahead) else { return f64::INFINITY };
        if back == ahead {
            return f64::INFINITY;
        }
        let ends = [back, ahead].map(|copy| self.places[copy as usize]);
        let mut greatest = distance_to_edge(self.places[gone as usize], ends);
        for first in self.rims[gone as usize] {
            for copy in self.rim_from(gone, first).take_while(|&copy| !self.alive[copy as usize]) {
                greatest = greatest.max(distance_to_edge(self.places[copy as usize], ends));
            }
        }
        greatest
    }

    /// The first remaining copy along the rim.
    fn walk(&self, from: u32, first: u32) -> Option<u32> {
        self.rim_from(from, first).find(|&copy| self.alive[copy as usize])
    }

    /// The rim of full detail from `first` on, away from `from`; ends where the rim does.
    fn rim_from(&self, from: u32, first: u32) -> impl Iterator<Item = u32> {
        let mut before = from;
        std::iter::successors((first != NONE).then_some(first), move |&copy| {
            let [a, b] = self.rims[copy as usize];
            let next = if a == before { b } else { a };
            before = copy;
            (next != NONE).then_some(next)
        })
    }

    /// Whether a triangle has enough area in the atlas.
    fn is_seen(&self, copies: [u32; 3], [a, b, c]: [Vector3<f64>; 3]) -> bool {
        let [p, q, r] = copies.map(|copy| self.places[copy as usize]);
        let area = (b - a).cross(&(c - a)).norm();
        (q - p).perp(&(r - p)) > LEAST_FACING * area
    }
}

impl CollapsePolicy for Seams {
    fn ways([a, b]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        [[a, b], [b, a]].into_iter()
    }

    fn plan(&self, collapse_mesh: &CollapseMesh, [kept, gone]: [u32; 2]) -> Option<Collapse> {
        let error = collapse_mesh.error_of_keeping([kept, gone]);
        let collapse = |error| Some(Collapse { kept, gone, to: collapse_mesh.position(kept), error });
        let role = self.roles[gone as usize];
        if role == Role::Fixed {
            return None;
        }
        let [[left, to_left], [right, to_right]] = self.pairs(collapse_mesh, [kept, gone])?;
        match role {
            Role::Inside if to_left == to_right => collapse(error),
            Role::Along if left != right && to_left != to_right => {
                let drift = self.drift(left).max(self.drift(right));
                drift.is_finite().then(|| collapse(error + drift * drift)).flatten()
            }
            _ => None,
        }
    }

    fn allows(&self, collapse_mesh: &CollapseMesh, &Collapse { kept, gone, to, .. }: &Collapse) -> bool {
        let Some(pairs) = self.pairs(collapse_mesh, [kept, gone]) else { return false };
        collapse_mesh.around(gone).filter(|(_, vertices, _)| !vertices.contains(&kept)).all(
            |(triangle, vertices, place)| {
                let mut copies = self.triangles[triangle];
                let Some(copy) = renamed(pairs, copies[place]) else { return false };
                copies[place] = copy;
                let mut corners = vertices.map(|vertex| collapse_mesh.position(vertex));
                corners[place] = to;
                self.is_seen(copies, corners)
            },
        )
    }

    fn apply(&mut self, collapse_mesh: &CollapseMesh, &Collapse { kept, gone, .. }: &Collapse) {
        let pairs = self.pairs(collapse_mesh, [kept, gone]).expect("only an edge collapses");
        for (triangle, _, place) in collapse_mesh.around(gone) {
            let copy = &mut self.triangles[triangle][place];
            self.alive[*copy as usize] = false;
            *copy = renamed(pairs, *copy).expect("a valid collapse renames every copy");
        }
    }
}

fn renamed(pairs: [[u32; 2]; 2], copy: u32) -> Option<u32> {
    pairs.into_iter().find(|pair| pair[0] == copy).map(|pair| pair[1])
}

/// The neighbours of each copy along the rim of its chart, [`NONE`] if there are not two; `None` off the rim.
fn rims(textured: &Textured) -> Vec<Option<[u32; 2]>> {
    let mut ends: Vec<[u32; 2]> = Vec::new();
    let across = neighbours(textured.source.len(), &textured.triangles);
    for (triangle, around) in textured.triangles.iter().zip(&across) {
        for side in (0..3).filter(|&side| around[side] == NONE) {
            let [from, to] = [triangle[side], triangle[(side + 1) % 3]];
            ends.extend([[from, to], [to, from]]);
        }
    }
    ends.sort_unstable();
    let mut rims = vec![None; textured.source.len()];
    for of_copy in ends.chunk_by(|a, b| a[0] == b[0]) {
        rims[of_copy[0][0] as usize] = Some(match *of_copy {
            [[_, first], [_, second]] => [first, second],
            _ => [NONE; 2],
        });
    }
    rims
}

fn roles(textured: &Textured, border: &[bool], rims: &[Option<[u32; 2]>]) -> Vec<Role> {
    let mut copies = vec![0; border.len()];
    let mut inside = vec![0; border.len()];
    let mut along = vec![0; border.len()];
    for (&vertex, rim) in textured.source.iter().zip(rims) {
        copies[vertex as usize] += 1;
        inside[vertex as usize] += usize::from(rim.is_none());
        along[vertex as usize] += usize::from(rim.is_some_and(|rim| rim[0] != NONE));
    }
    let role = |vertex: usize| match (copies[vertex], inside[vertex], along[vertex]) {
        _ if border[vertex] => Role::Fixed,
        (1, 1, 0) => Role::Inside,
        (2, 0, 2) => Role::Along,
        _ => Role::Fixed,
    };
    (0..border.len()).map(role).collect()
}

fn distance_to_edge(p: Vector2<f64>, [a, b]: [Vector2<f64>; 2]) -> f64 {
    let along = (p - a).dot(&(b - a)) / (b - a).norm_squared();
    (p - a - (b - a) * along.clamp(0.0, 1.0)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of four cells of 1 m, a chart each, that meet along a seam of vertices 5 to 9; the middle one is `aside_m`
    /// off the line.
    fn sheet(aside_m: f32) -> Textured {
        let source: Vec<u32> = (0..10).chain(5..15).collect();
        let uv = |(copy, &vertex): (usize, &u32)| {
            let aside_m = if vertex == 7 { aside_m } else { 0.0 };
            let between_charts_m = (copy / 10) as f32;
            [(vertex % 5) as f32, (vertex / 5) as f32 + aside_m + between_charts_m].map(|place_m| place_m / 8.0)
        };
        let corners = [0..4, 10..14].into_iter().flatten();
        Textured {
            uvs: source.iter().enumerate().map(uv).collect(),
            triangles: corners.flat_map(|a| [[a, a + 1, a + 6], [a, a + 6, a + 5]]).collect(),
            source,
            texels_per_m: 1.0,
            size_px: 8,
            ..Textured::default()
        }
    }

    fn seams(aside_m: f32) -> Seams {
        let border: Vec<bool> = (0..15).map(|vertex| [5, 9].contains(&vertex)).collect();
        Seams::new(&sheet(aside_m), &border)
    }

    #[test]
    fn a_seam_collapses_along_its_line_and_ends_at_the_border() {
        let roles = seams(0.0).roles;
        assert_eq!(roles[5..10], [Role::Fixed, Role::Along, Role::Along, Role::Along, Role::Fixed]);
    }

    #[test]
    fn the_drift_of_a_seam_includes_earlier_collapses() {
        let metre = f64::from(QUANTA_PER_M);
        let mut seams = seams(0.25);
        let [lower, upper] = [7, 12];
        assert_eq!([lower, upper].map(|copy| seams.drift(copy)), [0.25 * metre; 2]);
        seams.alive[lower as usize] = false;
        assert_eq!(seams.drift(6), 0.25 * metre, "from 5 to 8, past 7");
        assert!(seams.drift(11) < 0.25 * metre, "the other side still ends at 7");
    }
}

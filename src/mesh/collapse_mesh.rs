//! A surface during edge collapses.

use nalgebra::Vector3;

use super::Mesh;
use super::corners::{Corner, Corners};
use super::quadric::Quadric;

/// A planned collapse: `gone` merges into `kept`, which moves to `to`.
pub(crate) struct Collapse {
    pub(crate) kept: u32,
    /// Never on the border.
    pub(crate) gone: u32,
    pub(crate) to: Vector3<f64>,
    /// Squared error, in quanta.
    pub(crate) error: f64,
}

/// Cosine of the largest rotation of a triangle in one collapse. Tuned: 72°.
const LEAST_TURN_COSINE: f64 = 0.3;
/// Minimum quality (1: equilateral, 0: no area) unless the collapse improves it. Tuned.
const LEAST_QUALITY: f64 = 0.12;
/// Number of original vertices whose planes share one error. Tuned: with less the maximum distance hardly decreases, with
/// more a bump can vanish in a large flat patch.
const PATCH: f64 = 4.0;
const NONE: u32 = u32::MAX;

/// A surface being collapsed. Positions are in whole quanta relative to the first, so that areas are exact and rounding does
/// not depend on the location.
pub(crate) struct CollapseMesh<'a> {
    border: &'a [bool],
    positions: Vec<Vector3<f64>>,
    quadrics: Vec<Quadric>,
    /// Weight of [`PATCH`] vertices.
    patch_weight: f64,
    /// Removed ones hold [`NONE`] three times.
    pub(super) triangles: Vec<[u32; 3]>,
    live: usize,
    pub(super) corners: Corners,
}

impl<'a> CollapseMesh<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        let first = mesh.positions.first().copied().unwrap_or_default();
        let local = |p: &[i32; 3]| Vector3::from_fn(|i, _| f64::from(p[i] - first[i]));
        let mut collapse_mesh = Self {
            border: &mesh.border,
            positions: mesh.positions.iter().map(local).collect(),
            quadrics: vec![Quadric::default(); mesh.positions.len()],
            patch_weight: 0.0,
            triangles: mesh.triangles.clone(),
            live: mesh.triangles.len(),
            corners: Corners::new(mesh),
        };
        for triangle in &mesh.triangles {
            let quadric = Quadric::of_triangle(collapse_mesh.corners_of(*triangle));
            for &corner in triangle {
                collapse_mesh.quadrics[corner as usize].add(&quadric);
            }
        }
        let weight: f64 = collapse_mesh.quadrics.iter().map(Quadric::weight).sum();
        collapse_mesh.patch_weight = PATCH * weight / mesh.positions.len() as f64;
        collapse_mesh
    }

    /// Number of vertices, including removed ones.
    pub(super) fn vertices(&self) -> usize {
        self.positions.len()
    }

    /// Number of remaining triangles.
    pub(crate) fn live(&self) -> usize {
        self.live
    }

    /// Whether a triangle remains.
    pub(crate) fn is_left(&self, triangle: usize) -> bool {
        self.triangles[triangle][0] != NONE
    }

    /// Whether a vertex remains.
    pub(crate) fn is_alive(&self, vertex: u32) -> bool {
        self.corners.is_alive(vertex)
    }

    /// Whether a vertex is shared with another chunk.
    pub(crate) fn is_border(&self, vertex: u32) -> bool {
        self.border[vertex as usize]
    }

    /// Position of a vertex.
    pub(crate) fn position(&self, vertex: u32) -> Vector3<f64> {
        self.positions[vertex as usize]
    }

    /// Index and vertices of each triangle at a vertex, and which of its corners the vertex is.
    pub(crate) fn around(&self, vertex: u32) -> impl Iterator<Item = (usize, [u32; 3], usize)> {
        let corners = self.corners.of(vertex);
        corners.map(|corner| (corner.triangle, self.triangles[corner.triangle], corner.place))
    }

    /// The mean squared distance of a position to the planes of two vertices.
    pub(super) fn joined(&self, ends: [u32; 2]) -> Joined {
        let mut quadric = self.quadrics[ends[0] as usize];
        quadric.add(&self.quadrics[ends[1] as usize]);
        Joined { quadric, weight: quadric.weight().min(self.patch_weight) }
    }

    /// Squared error of merging two vertices at the position of the first, in quanta.
    pub(crate) fn error_of_keeping(&self, [kept, gone]: [u32; 2]) -> f64 {
        self.joined([kept, gone]).error(&self.position(kept))
    }

    /// The corners of a triangle.
    pub(super) fn corners_of(&self, triangle: [u32; 3]) -> [Vector3<f64>; 3] {
        triangle.map(|corner| self.positions[corner as usize])
    }

    /// The remaining triangles, in their original order.
    pub(super) fn left(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.triangles.iter().filter(|triangle| triangle[0] != NONE)
    }

    /// Whether the remaining triangles around `vertex` neither flip nor become needles.
    pub(super) fn keeps_form(&self, vertex: u32, collapse: &Collapse) -> bool {
        let other = collapse.kept ^ collapse.gone ^ vertex;
        self.corners.of(vertex).all(|corner| {
            let triangle = self.triangles[corner.triangle];
            if triangle.contains(&other) {
                return true;
            }
            let before = self.corners_of(triangle);
            let mut after = before;
            after[corner.place] = collapse.to;
            let [old, new] = [before, after].map(|[a, b, c]| (b - a).cross(&(c - a)));
            let turn = old.dot(&new);
            let least = LEAST_TURN_COSINE * LEAST_TURN_COSINE;
            let turns_little = turn > 0.0 && turn * turn >= least * old.norm_squared() * new.norm_squared();
            turns_little && {
                let quality = squared_quality(after, new);
                quality >= LEAST_QUALITY * LEAST_QUALITY || quality >= squared_quality(before, old)
            }
        })
    }

    pub(super) fn apply(&mut self, &Collapse { kept, gone, to, .. }: &Collapse) {
        let mut next = self.corners.detach(gone);
        while let Some(corner) = next {
            next = self.corners.after(corner);
            let triangle = self.triangles[corner.triangle];
            if triangle.contains(&kept) {
                for (place, &vertex) in triangle.iter().enumerate() {
                    if vertex != gone {
                        self.corners.remove(vertex, Corner { place, ..corner });
                    }
                }
                self.triangles[corner.triangle] = [NONE; 3];
                self.live -= 1;
            } else {
                self.triangles[corner.triangle][corner.place] = kept;
                self.corners.insert(kept, corner);
            }
        }
        self.positions[kept as usize] = to;
        let quadric = self.quadrics[gone as usize];
        self.quadrics[kept as usize].add(&quadric);
    }
}

/// The combined planes of two vertices.
pub(super) struct Joined {
    pub(super) quadric: Quadric,
    weight: f64,
}

impl Joined {
    /// Squared error of a position, in quanta.
    pub(super) fn error(&self, to: &Vector3<f64>) -> f64 {
        self.quadric.sum_at(to) / self.weight
    }
}

/// Twelve times the squared area divided by the squared sum of squared sides (scaled to 1 for an equilateral triangle).
fn squared_quality([a, b, c]: [Vector3<f64>; 3], double_area: Vector3<f64>) -> f64 {
    let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    12.0 * double_area.norm_squared() / (sides * sides)
}

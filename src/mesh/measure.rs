//! Checks meshes: measures of topology and shape, for chunks welded together.
//!
//! ```
//! use plume::mesh::Mesh;
//! use plume::mesh::measure::Report;
//!
//! let triangle = Mesh {
//!     positions: vec![[0, 0, 0], [4096, 0, 0], [0, 4096, 0]],
//!     triangles: vec![[0, 1, 2]],
//!     ..Mesh::default()
//! };
//! let report = Report::of(&triangle);
//! assert_eq!((report.triangles, report.is_clean()), (1, false), "it has open edges");
//! ```

use nalgebra::Vector3;
use rustc_hash::FxHashMap;
use serde::Serialize;

use super::bubbles::find;
use super::{Mesh, QUANTA_PER_M};
use plume_graph::Aabb;

/// Properties of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// Used vertices.
    pub vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Triangles.
    pub triangles: usize,
    /// Boundary edges, with one triangle.
    pub open_edges: usize,
    /// Non-manifold edges, with three or more triangles.
    pub nonmanifold_edges: usize,
    /// Non-manifold vertices, whose triangles are not one fan.
    pub nonmanifold_vertices: usize,
    /// Edges with inconsistent winding of their two triangles.
    pub inconsistent_winding: usize,
    /// Degenerate triangles.
    pub degenerate_triangles: usize,
    /// The smallest angle of any triangle, in degrees.
    pub min_angle_deg: f64,
    /// Triangles with an angle under 1°.
    pub angles_under_1deg: usize,
    /// Connected components.
    pub components: usize,
    /// Total number of handles. Meaningless unless the mesh is clean.
    pub genus: i64,
    /// Area in square metres.
    pub area_m2: f64,
    /// Enclosed air in cubic metres. Meaningless unless the mesh is clean.
    pub volume_m3: f64,
    /// Lowest corner in metres; 0 without triangles.
    pub min_m: [f64; 3],
    /// Highest corner in metres.
    pub max_m: [f64; 3],
}

impl Report {
    /// Measures a mesh as it is: vertices are identified by index alone (see [`weld`]).
    pub fn of(mesh: &Mesh) -> Self {
        let mut report = Self { triangles: mesh.triangles.len(), ..Self::default() };
        report.count_edges(mesh);
        report.count_fans(mesh);
        report.count_components(mesh);
        report.measure_triangles(mesh);
        report.measure_bounds(mesh);
        let euler = report.vertices as i64 - report.edges as i64 + report.triangles as i64;
        report.genus = report.components as i64 - euler.div_euclid(2);
        report
    }

    /// Whether the mesh is watertight, manifold and consistently wound, without degenerate triangles.
    pub fn is_clean(&self) -> bool {
        self.open_edges == 0
            && self.nonmanifold_edges == 0
            && self.nonmanifold_vertices == 0
            && self.inconsistent_winding == 0
            && self.degenerate_triangles == 0
    }

    fn count_edges(&mut self, mesh: &Mesh) {
        let directed = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
        let mut edges: Vec<(u32, u32, bool)> =
            mesh.triangles.iter().flat_map(directed).map(|(a, b)| (a.min(b), a.max(b), a < b)).collect();
        edges.sort_unstable();
        for uses in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            self.edges += 1;
            match uses {
                [_] => self.open_edges += 1,
                [a, b] => self.inconsistent_winding += usize::from(a.2 == b.2),
                _ => self.nonmanifold_edges += 1,
            }
        }
    }

    /// A fan is a set of triangles at a vertex joined through the edges at it.
    fn count_fans(&mut self, mesh: &Mesh) {
        let mut corners: Vec<(u32, u32)> = Vec::with_capacity(3 * mesh.triangles.len());
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            corners.extend(triangle.iter().map(|&vertex| (vertex, index as u32)));
        }
        corners.sort_unstable();
        for corners in corners.chunk_by(|a, b| a.0 == b.0) {
            self.vertices += 1;
            let vertex = corners[0].0;
            let triangles = corners.iter().map(|&(_, index)| mesh.triangles[index as usize]);
            self.nonmanifold_vertices += usize::from(fans(vertex, triangles) > 1);
        }
    }

    fn count_components(&mut self, mesh: &Mesh) {
        let mut parents: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        self.components = self.vertices;
        for &[a, b, c] in &mesh.triangles {
            for (a, b) in [(a, b), (b, c)] {
                let (a, b) = (find(&mut parents, a), find(&mut parents, b));
                parents[a.max(b) as usize] = a.min(b);
                self.components -= usize::from(a != b);
            }
        }
    }

    fn measure_triangles(&mut self, mesh: &Mesh) {
        self.min_angle_deg = if mesh.triangles.is_empty() { 0.0 } else { 60.0 };
        let quantum = 1.0 / f64::from(QUANTA_PER_M);
        let at = |vertex: u32| Vector3::from(mesh.positions[vertex as usize]).map(f64::from);
        for triangle in &mesh.triangles {
            let corners = triangle.map(at).map(|p| p * quantum);
            let [a, b, c] = corners;
            let double_area = (b - a).cross(&(c - a)).norm();
            let angle = smallest_angle_deg(corners);
            self.degenerate_triangles += usize::from(double_area == 0.0);
            self.angles_under_1deg += usize::from(angle < 1.0);
            self.min_angle_deg = self.min_angle_deg.min(angle);
            self.area_m2 += double_area * 0.5;
            // Counter-clockwise as seen from the air: the normals point into the volume.
            self.volume_m3 -= a.dot(&b.cross(&c)) / 6.0;
        }
    }

    fn measure_bounds(&mut self, mesh: &Mesh) {
        let used = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]);
        if let Some(bounds) = Aabb::from_points(used) {
            let metres = |q: i32| f64::from(q) / f64::from(QUANTA_PER_M);
            (self.min_m, self.max_m) = (bounds.min.map(metres), bounds.max.map(metres));
        }
    }
}

/// Joins meshes at vertices of equal position. Keeps the first normal of each, and drops unused vertices.
pub fn weld<'a>(meshes: impl IntoIterator<Item = &'a Mesh>) -> Mesh {
    let mut welded = Mesh::default();
    let mut known: FxHashMap<[i32; 3], u32> = FxHashMap::default();
    for mesh in meshes {
        for triangle in &mesh.triangles {
            let triangle = triangle.map(|corner| {
                let vertex = corner as usize;
                *known.entry(mesh.positions[vertex]).or_insert_with(|| {
                    welded.positions.push(mesh.positions[vertex]);
                    welded.normals.extend(mesh.normals.get(vertex));
                    welded.border.push(mesh.border[vertex]);
                    welded.positions.len() as u32 - 1
                })
            });
            welded.triangles.push(triangle);
        }
    }
    welded
}

/// How well the borders of chunks match.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Seams {
    /// Positions used by two or more meshes.
    pub shared: usize,
    /// Of those, the ones with different normals.
    pub different_normals: usize,
    /// Of those, the ones not marked as border in every mesh.
    pub unmarked: usize,
    /// Border vertices missing in all other meshes.
    pub unmatched: usize,
}

impl Seams {
    /// Compares the border vertices of `meshes`.
    pub fn of<'a>(meshes: impl IntoIterator<Item = &'a Mesh>) -> Self {
        let mut vertices = Vec::new();
        for (number, mesh) in meshes.into_iter().enumerate() {
            for (vertex, &position) in mesh.positions.iter().enumerate() {
                let normal = mesh.normals.get(vertex).copied().unwrap_or_default();
                let bits = normal.map(f32::to_bits);
                vertices.push((position, number, bits, mesh.border[vertex]));
            }
        }
        vertices.sort_unstable();
        let mut seams = Self::default();
        for same in vertices.chunk_by(|a, b| a.0 == b.0) {
            let is_shared = same.iter().any(|other| other.1 != same[0].1);
            let is_border = |vertex: &(_, _, _, bool)| vertex.3;
            seams.unmatched += usize::from(!is_shared && same.iter().any(is_border));
            if is_shared {
                seams.shared += 1;
                seams.unmarked += usize::from(!same.iter().all(is_border));
                let differs = same.iter().any(|other| other.2 != same[0].2);
                seams.different_normals += usize::from(differs);
            }
        }
        seams
    }

    /// Whether neighbours agree on every vertex.
    pub fn is_clean(&self) -> bool {
        self.different_normals == 0 && self.unmarked == 0 && self.unmatched == 0
    }
}

fn fans(vertex: u32, triangles: impl Iterator<Item = [u32; 3]>) -> usize {
    let mut spokes: Vec<(u32, u32)> = Vec::new();
    let mut count = 0;
    for (index, triangle) in triangles.enumerate() {
        let ends = triangle.into_iter().filter(|&corner| corner != vertex);
        spokes.extend(ends.map(|end| (end, index as u32)));
        count += 1;
    }
    spokes.sort_unstable();
    let mut parents: Vec<u32> = (0..count as u32).collect();
    for pair in spokes.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let (a, b) = (find(&mut parents, pair[0].1), find(&mut parents, pair[1].1));
        parents[a.max(b) as usize] = a.min(b);
        count -= usize::from(a != b);
    }
    count
}

fn smallest_angle_deg(corners: [Vector3<f64>; 3]) -> f64 {
    let angle = |k: usize| {
        let [u, v] = [1, 2].map(|step| corners[(k + step) % 3] - corners[k]);
        libm::atan2(u.cross(&v).norm(), u.dot(&v)).to_degrees()
    };
    angle(0).min(angle(1)).min(angle(2))
}

//! A chart: triangles projected along one axis.

use super::raster::{Corners, SUBTEXELS};
use crate::mesh::{Mesh, QUANTA_PER_M};
use plume_graph::Aabb;

/// The six directions of projection: +x, -x, +y, -y, +z, -z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Axis(pub u8);

impl Axis {
    /// All six.
    pub const ALL: [Self; 6] = [Self(0), Self(1), Self(2), Self(3), Self(4), Self(5)];

    /// The component of `vector` along this direction.
    pub fn along(self, vector: [f32; 3]) -> f32 {
        let component = vector[usize::from(self.0 / 2)];
        if self.0.is_multiple_of(2) { component } else { -component }
    }

    /// The projection plane: a triangle that is counter-clockwise against the axis stays so.
    pub fn project(self, q: [i32; 3]) -> [i32; 2] {
        let axis = usize::from(self.0 / 2);
        let (u, v) = (q[(axis + 1) % 3], q[(axis + 2) % 3]);
        if self.0.is_multiple_of(2) { [u, v] } else { [v, u] }
    }
}

/// Triangles that do not overlap when projected along an axis.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    pub axis: Axis,
    /// Whether the chart is rotated by 90°, for packing.
    turned: bool,
    /// Triangles of the mesh.
    pub triangles: Vec<u32>,
    /// Minimum corner of the chart in mesh quanta.
    min: [i32; 2],
    /// Size of the chart in mesh quanta.
    pub extent: [i32; 2],
}

impl Chart {
    /// Projects `triangles` (not empty), the longer side along u.
    pub fn new(mesh: &Mesh, axis: Axis, triangles: Vec<u32>) -> Self {
        let mut chart = Self { axis, turned: false, triangles, min: [0; 2], extent: [0; 2] };
        chart.measure(mesh);
        if chart.extent[1] > chart.extent[0] {
            chart.turned = true;
            chart.measure(mesh);
        }
        chart
    }

    fn measure(&mut self, mesh: &Mesh) {
        let vertices = self.triangles.iter().flat_map(|&t| mesh.triangles[t as usize]);
        let places = vertices.map(|vertex| self.turn(self.axis.project(mesh.positions[vertex as usize])));
        let bounds = Aabb::from_points(places).expect("a chart has triangles");
        (self.min, self.extent) = (bounds.min, bounds.size());
    }

    fn turn(&self, p: [i32; 2]) -> [i32; 2] {
        if self.turned { [p[1], -p[0]] } else { p }
    }

    /// A vertex in lattice units from the lower left of the chart.
    pub fn place(&self, mesh: &Mesh, vertex: u32, scale: Scale) -> [i32; 2] {
        let p = self.turn(self.axis.project(mesh.positions[vertex as usize]));
        [0, 1].map(|k| scale.steps(p[k] - self.min[k]))
    }

    /// A triangle in lattice units from the lower left of the chart.
    pub fn corners(&self, mesh: &Mesh, triangle: u32, scale: Scale) -> Corners {
        mesh.triangles[triangle as usize].map(|vertex| self.place(mesh, vertex, scale))
    }

    /// Width and height in lattice units.
    pub fn size(&self, scale: Scale) -> [i32; 2] {
        self.extent.map(|q| scale.steps(q))
    }
}

/// From mesh quanta to the lattice of the rasteriser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    steps_per_quantum: f64,
}

impl Scale {
    pub fn new(texels_per_m: f64) -> Self {
        Self { steps_per_quantum: texels_per_m * f64::from(SUBTEXELS) / f64::from(QUANTA_PER_M) }
    }

    pub fn texels_per_m(self) -> f32 {
        (self.steps_per_quantum * f64::from(QUANTA_PER_M) / f64::from(SUBTEXELS)) as f32
    }

    fn steps(self, quanta: i32) -> i32 {
        (f64::from(quanta) * self.steps_per_quantum + 0.5).floor() as i32
    }
}

/// Projected area of a triangle along `axis`, in square quanta; positive if it faces the viewer.
pub(super) fn seen_area(mesh: &Mesh, triangle: u32, axis: Axis) -> f64 {
    let [a, b, c] = mesh.triangles[triangle as usize].map(|v| axis.project(mesh.positions[v as usize]).map(i64::from));
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) as f64 / 2.0
}

//! The way through the cave.

use nalgebra::{Point3, Vector2};

use plume_graph::{Aabb, Graph};

/// The way along the passages that is kept free.
pub(super) struct Corridor {
    half_m: f64,
    lines: Vec<[Point3<f64>; 2]>,
}

impl Corridor {
    /// Height difference beyond which a passage is another one, in metres.
    const STOREY_M: f64 = 4.0;

    /// The way of this width through the part of a graph that is near these bounds; none if it is not positive.
    pub fn new(graph: &Graph, width_m: f64, bounds: Aabb<f64>) -> Self {
        let half_m = width_m / 2.0;
        let near = bounds.padded(half_m + 1.0);
        let lines = graph.edges.iter().map(|edge| edge.map(|station| graph[station].position));
        let touches = |[a, b]: &[Point3<f64>; 2]| {
            let around = Aabb { min: <[f64; 3]>::from(*a), max: <[f64; 3]>::from(*a) }.including((*b).into());
            let tall = Aabb {
                min: [around.min[0], around.min[1], around.min[2] - Self::STOREY_M],
                max: [around.max[0], around.max[1], around.max[2] + Self::STOREY_M],
            };
            tall.intersects(&near)
        };
        Self { half_m, lines: if half_m > 0.0 { lines.filter(touches).collect() } else { Vec::new() } }
    }

    /// Whether something of this radius at a place on the floor would be in the way.
    pub fn is_within(&self, at: Point3<f64>, radius_m: f64) -> bool {
        self.lines.iter().any(|[a, b]| {
            let along = b - a;
            let flat: Vector2<f64> = along.xy();
            let share = if flat.norm_squared() > 0.0 { (at - a).xy().dot(&flat) / flat.norm_squared() } else { 0.0 };
            let nearest = a + along * share.clamp(0.0, 1.0);
            (at - nearest).xy().norm() < self.half_m + radius_m && (at.z - nearest.z).abs() < Self::STOREY_M
        })
    }
}

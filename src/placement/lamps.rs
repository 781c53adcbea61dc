//! Lamps along the passages.

use nalgebra::{Point3, Vector3};

use super::column::{ceiling_z, floor_z};
use crate::field::Field;
use plume_graph::Graph;

/// Height of a lamp between floor (0) and ceiling (1).
const HEIGHT_SHARE: f64 = 0.78;

/// A lamp.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    /// Its position.
    pub position: Point3<f64>,
}

/// Lamps at stations, such that no two are closer than `spacing_m` and no station is farther than that from one.
pub fn lamps(field: &dyn Field, graph: &Graph, spacing_m: f64) -> Vec<Lamp> {
    let mut lamps: Vec<Lamp> = Vec::new();
    for node in &graph.nodes {
        let is_lit = |lamp: &Lamp| (lamp.position - node.position).norm() < spacing_m;
        if lamps.iter().any(is_lit) {
            continue;
        }
        let (floor, ceiling) = (floor_z(field, node.position), ceiling_z(field, node.position));
        let (Some(floor), Some(ceiling)) = (floor, ceiling) else {
            continue;
        };
        let height = floor + HEIGHT_SHARE * (ceiling - floor);
        lamps.push(Lamp { position: node.position + Vector3::new(0.0, 0.0, height - node.position.z) });
    }
    lamps
}

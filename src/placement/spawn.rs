//! Start poses: level ground, headroom, facing along the passage.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::column::{ceiling_z, floor_z};
use crate::field::Field;
use plume_graph::{Graph, StationId};

/// Half the size of the footprint that must be level, m: a Husky is 0.99 m long and 0.67 m wide.
const FOOTPRINT_M: f64 = 0.45;
/// Minimum headroom, m.
const HEADROOM_M: f64 = 0.8;
/// Height of a pose above the highest point of its footprint, m.
const CLEARANCE_M: f64 = 0.02;

/// A pose on the ground: +X along the passage, +Z up.
#[derive(Clone, Debug, PartialEq)]
pub struct Spawn {
    /// Origin on the ground.
    pub pose: Isometry3<f64>,
    /// Height between the lowest and the highest point of the footprint, m.
    pub unevenness_m: f64,
}

/// Up to `count` start poses at stations of the graph: the most level one first, then far from those already chosen.
/// Empty if there is no headroom anywhere.
pub fn spawns(field: &dyn Field, graph: &Graph, count: usize) -> Vec<Spawn> {
    let mut candidates: Vec<Spawn> = graph.stations().filter_map(|station| spawn_at(field, graph, station)).collect();
    candidates.sort_by(|a, b| a.unevenness_m.total_cmp(&b.unevenness_m));
    // The better half is level enough; among those, the distance decides.
    candidates.truncate(candidates.len().div_ceil(2).max(count));
    let mut chosen: Vec<Spawn> = Vec::new();
    while chosen.len() < count && !candidates.is_empty() {
        let farthest = (0..candidates.len()).rev().max_by(|a, b| {
            let spread = |i: &usize| distance_to(&chosen, &candidates[*i]);
            spread(a).total_cmp(&spread(b))
        });
        chosen.push(candidates.remove(farthest.expect("there are candidates")));
    }
    chosen
}

/// Distance to the nearest chosen pose; infinite when there is none.
fn distance_to(chosen: &[Spawn], candidate: &Spawn) -> f64 {
    let at = |spawn: &Spawn| spawn.pose.translation.vector;
    chosen.iter().map(|c| (at(c) - at(candidate)).norm()).fold(f64::INFINITY, f64::min)
}

fn spawn_at(field: &dyn Field, graph: &Graph, station: StationId) -> Option<Spawn> {
    let centre = graph[station].position;
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    for (dx, dy) in footprint() {
        let from = centre + Vector3::new(dx, dy, 0.0);
        let floor = floor_z(field, from)?;
        if ceiling_z(field, from)? - floor < HEADROOM_M {
            return None;
        }
        low = low.min(floor);
        high = high.max(floor);
    }
    let origin = Point3::new(centre.x, centre.y, high + CLEARANCE_M);
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad(graph, station));
    let pose = Isometry3::from_parts(Translation3::from(origin), yaw);
    Some(Spawn { pose, unevenness_m: high - low })
}

/// A 3 × 3 pattern around the station.
fn footprint() -> impl Iterator<Item = (f64, f64)> {
    let steps = [-FOOTPRINT_M, 0.0, FOOTPRINT_M];
    steps.into_iter().flat_map(move |dx| steps.into_iter().map(move |dy| (dx, dy)))
}

/// Direction of the first passage at the station, rad from +X.
fn heading_rad(graph: &Graph, station: StationId) -> f64 {
    let Some([a, b]) = graph.edges.iter().find(|edge| edge.contains(&station)) else {
        return 0.0;
    };
    let other = if *a == station { *b } else { *a };
    let along = graph[other].position - graph[station].position;
    libm::atan2(along.y, along.x)
}

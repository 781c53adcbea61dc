//! Chooses the camera pose if none is given.

use std::f32::consts::TAU;

use super::camera::{Pose, Ray};
use super::march::{Approach, BRISK, march};
use crate::field::Field;
use crate::placement;
use crate::preview::{PreviewError, Subject};
use plume_graph::Graph;

/// Height of the camera above the ground, metres, if there is room for it.
pub const EYE_M: f32 = 1.0;
/// Maximum height relative to that of the passage.
const EYE_SHARE: f32 = 0.6;
/// Number of horizontal directions tried.
const DIRECTIONS: usize = 32;
/// Pitches tried, radians: for steep passages too.
const PITCHES: [f32; 7] = [-0.03, 0.2, -0.2, 0.4, -0.4, 0.65, -0.65];
/// Maximum pitch of the camera, radians: then both the steepest of those directions and the horizon are in the picture.
/// Tuned.
const MOST_PITCH: f32 = 0.35;
/// How much longer the line of sight has to be per radian of pitch. Tuned: level pictures are easier to read.
const LEVEL: f32 = 1.0;
/// Number of positions tried.
const PLACES: usize = 6;
/// Number of stations tried for level ground, the first of the graph.
const MOST_STATIONS: usize = 400;
const GLANCE: Approach = Approach { share: 0.0, least_m: 0.05, step: BRISK };
/// Lines of sight shorter than this show nothing, metres.
const BLIND_M: f32 = 0.05;

/// A pose, and how much it shows: the approximate visibility, metres.
struct Glance {
    pose: Pose,
    shows_m: f32,
}

/// Of some start poses, or stations in the air if there are none, the one that shows most.
pub fn best(subject: &Subject) -> Result<Pose, PreviewError> {
    // Of equals the last wins, so the first, most level one is put last.
    let glances = eyes(subject).into_iter().rev().map(|eye| glance(subject.field, eye));
    most(glances).map(|glance| glance.pose).ok_or(PreviewError::NoAir)
}

fn most(glances: impl Iterator<Item = Glance>) -> Option<Glance> {
    glances.max_by(|one, other| one.shows_m.total_cmp(&other.shows_m))
}

fn eyes(subject: &Subject) -> Vec<[f32; 3]> {
    let near = beginning(subject.graph);
    let spawns = placement::spawns(subject.field, &near, PLACES);
    if spawns.is_empty() {
        let stations = near.nodes.iter().map(|node| node.position.coords.map(|c| c as f32).into());
        let airy: Vec<[f32; 3]> = stations.filter(|&station| is_air(subject.field, station)).collect();
        return airy.iter().step_by(airy.len().div_ceil(PLACES).max(1)).copied().collect();
    }
    let ground = |spawn: placement::Spawn| spawn.pose.translation.vector.map(|c| c as f32).into();
    spawns.into_iter().map(|spawn| raised(subject.field, ground(spawn))).collect()
}

/// The camera position over a point on the ground.
pub fn raised(field: &dyn Field, ground: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = ground;
    let up = Ray { from: [x, y, z + BLIND_M], along: [0.0, 0.0, 1.0], start: 0.0 };
    let room_m = march(field, &[up], Approach { share: 0.0, least_m: 0.005, step: BRISK })[0];
    [x, y, z + EYE_M.min(EYE_SHARE * room_m).max(BLIND_M)]
}

/// Whether a point is in the air.
pub fn is_air(field: &dyn Field, point: [f32; 3]) -> bool {
    field.distances_at(&[point])[0] < 0.0
}

/// Looks from a point along the longest line of sight, not through a slit.
pub fn furthest(field: &dyn Field, eye: [f32; 3]) -> Pose {
    glance(field, eye).pose
}

fn glance(field: &dyn Field, eye: [f32; 3]) -> Glance {
    let angle = |i: usize| TAU * i as f32 / DIRECTIONS as f32;
    let pose = |i: usize| Pose { eye, yaw_rad: angle(i % DIRECTIONS), pitch_rad: PITCHES[i / DIRECTIONS] };
    let count = DIRECTIONS * PITCHES.len();
    let rays: Vec<Ray> = (0..count).map(|i| Ray { from: eye, along: pose(i).ahead(), start: 0.0 }).collect();
    let open = march(field, &rays, GLANCE);
    let shows_m = |i: usize| {
        let row = i - i % DIRECTIONS;
        let [left, right] = [1, DIRECTIONS - 1].map(|turn| open[row + (i + turn) % DIRECTIONS]);
        (0.4 * open[i] + 0.6 * left.min(right)) / (1.0 + LEVEL * pose(i).pitch_rad.abs())
    };
    let glances = (0..count).rev().map(|i| Glance { pose: pose(i), shows_m: shows_m(i) });
    let Glance { pose, shows_m } = most(glances).expect("there are directions");
    Glance { pose: Pose { pitch_rad: pose.pitch_rad.clamp(-MOST_PITCH, MOST_PITCH), ..pose }, shows_m }
}

/// The first stations and the passages between them.
fn beginning(graph: &Graph) -> Graph {
    let nodes = graph.nodes.iter().take(MOST_STATIONS).cloned().collect();
    let edges = graph.edges.iter().filter(|edge| edge.iter().all(|end| end.index() < MOST_STATIONS)).copied().collect();
    Graph::new(nodes, edges)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{CaveField, PassageSettings};
    use crate::material::{Look, MATERIALS};
    use nalgebra::Point3;
    use plume_graph::{Node, StationId};
    use serde_json::json;

    /// A straight passage from the origin, each station this much higher than the previous one, metres.
    fn passage(rise_m: f64) -> Graph {
        let node = |i: usize| Node {
            id: i as u64,
            parent: i.checked_sub(1).map(StationId::new),
            position: Point3::new(6.0, 0.0, rise_m) * i as f64,
            radius: 4.0,
            active: false,
            level: 0,
            section: None,
            name: None,
        };
        Graph::new((0..6).map(node).collect(), StationId::pairs((1..6).map(|i| [i - 1, i])))
    }

    /// The best of the glances along a passage.
    fn best_in(graph: &Graph) -> Glance {
        let passage = PassageSettings::default();
        let material = (MATERIALS.default_row().read)(json!({})).expect("settings of its own");
        let field = CaveField::new(graph, &passage, material, Look::default(), 3);
        let subject =
            Subject { name: "cave", graph, passage: &passage, field: &field, lamp_spacing_m: None, furnishing: None };
        glance(&field, best(&subject).expect("a passage has air").eye)
    }

    #[test]
    fn the_camera_looks_along_the_passage_and_not_at_the_ground() {
        for (rise_m, pitches) in [(0.0, 0.0..0.1), (2.0, 0.1..0.4), (-5.0, 0.3..0.4)] {
            let Glance { pose, shows_m } = best_in(&passage(rise_m));
            assert!(shows_m > 4.0 && pitches.contains(&pose.pitch_rad.abs()), "{rise_m}: {shows_m} m from {pose:?}");
        }
    }
}

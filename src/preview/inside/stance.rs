//! Where to stand and where to look, if nobody says.

use std::f32::consts::TAU;

use super::camera::{Pose, Ray};
use super::march::{Approach, BRISK, march};
use crate::field::Field;
use crate::graph::Graph;
use crate::preview::{PreviewError, Subject};
use crate::truth;

/// Height of the eye above the ground, metres, where there is room for it.
pub const EYE_M: f32 = 1.0;
/// Of the height of the passage at most.
const EYE_SHARE: f32 = 0.6;
/// Directions that are looked into.
const DIRECTIONS: usize = 32;
/// Stations that are tried for level ground, the first of the graph.
const MOST_STATIONS: usize = 400;
const GLANCE: Approach = Approach { share: 0.0, least_m: 0.05, step: BRISK };
/// A look that ends nearer than this shows nothing, metres.
const BLIND_M: f32 = 0.05;

/// At the first start pose, or the first station in the air, looking where the passage is open furthest.
pub fn first(subject: &Subject) -> Result<Pose, PreviewError> {
    let eye = eye(subject).ok_or(PreviewError::NoAir)?;
    Ok(Pose { eye, yaw: widest(subject.field, eye), pitch: -0.03 })
}

fn eye(subject: &Subject) -> Option<[f32; 3]> {
    let near = beginning(subject.graph);
    let spawn = truth::spawns(subject.field, &near, 1).into_iter().next();
    let ground = spawn.map(|spawn| spawn.pose.translation.vector.map(|c| c as f32).into());
    let Some(ground) = ground else {
        let points = near.nodes.iter().map(|node| node.position.coords.map(|c| c as f32).into());
        return points.into_iter().find(|&point| is_air(subject.field, point));
    };
    Some(raised(subject.field, ground))
}

/// The eye over a point on the ground.
pub fn raised(field: &dyn Field, ground: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = ground;
    let up = Ray { from: [x, y, z + BLIND_M], along: [0.0, 0.0, 1.0], start: 0.0 };
    let room_m = march(field, &[up], Approach { share: 0.0, least_m: 0.005, step: BRISK })[0];
    [x, y, z + EYE_M.min(EYE_SHARE * room_m).max(BLIND_M)]
}

/// Whether a point is in the air.
pub fn is_air(field: &dyn Field, point: [f32; 3]) -> bool {
    super::march::distances(field, &[point])[0] < 0.0
}

/// The direction in which one sees furthest, not through a slit.
pub fn widest(field: &dyn Field, eye: [f32; 3]) -> f32 {
    let angle = |i: usize| TAU * i as f32 / DIRECTIONS as f32;
    let ray = |i| Ray { from: eye, along: [libm::cosf(angle(i)), libm::sinf(angle(i)), 0.0], start: 0.0 };
    let rays: Vec<Ray> = (0..DIRECTIONS).map(ray).collect();
    let open = march(field, &rays, GLANCE);
    let around = |i: usize| {
        let beside = open[(i + 1) % DIRECTIONS].min(open[(i + DIRECTIONS - 1) % DIRECTIONS]);
        open[i] + 1.5 * beside
    };
    let best = (0..DIRECTIONS).rev().max_by(|&one, &other| around(one).total_cmp(&around(other)));
    angle(best.unwrap_or(0))
}

/// The first stations and the passages between them.
fn beginning(graph: &Graph) -> Graph {
    let nodes = graph.nodes.iter().take(MOST_STATIONS).cloned().collect();
    let edges = graph.edges.iter().filter(|edge| edge.iter().all(|&end| end < MOST_STATIONS)).copied().collect();
    Graph::new(nodes, edges)
}

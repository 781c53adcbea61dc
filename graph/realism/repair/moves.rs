//! The moves of the repair. Each returns a changed graph, or `None` if it does not apply; none checks whether it is better.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector2};

use super::plan::Plan;
use crate::rng::Rng;
use crate::{Graph, Node, StationId, millimetres};

/// A random change.
pub(super) type Move = fn(&Plan, &mut Rng) -> Option<Graph>;

/// All moves, with the metrics they affect.
pub(super) const MOVES: [Move; 9] = [
    bend,       // tortuosity up
    straighten, // tortuosity down
    warp,       // orientation entropy and tortuosity up
    add_spur,   // length variation up, degree correlation down
    prune,      // mean degree up, length entropy
    stretch,    // length variation up, length entropy down
    shorten,    // length entropy
    close_loop, // mean degree up
    open_loop,  // mean degree down, degree variation up
];

/// Most passages at a station after a move.
pub(super) const MAX_DEGREE: usize = 4;
/// Minimum angle between two passages at a station.
const MIN_ANGLE: f64 = 45.0 * PI / 180.0;
/// Turn of a new passage from one station to the next, standard deviation in radians.
const TURN: f64 = 0.45;
/// Steepest connector, rise per horizontal metre: 20 degrees.
const SLOPE: f64 = 0.36;
/// Minimum number of passages of a new loop.
const LOOP_HOPS: usize = 5;

/// Displaces the inner stations of a branch sideways, in one to three half-waves; a single passage is subdivided first.
fn bend(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let (mut graph, branch) = divided(plan, drawn(plan, rng));
    let last = branch.len() - 1;
    let chord = (graph[branch[last]].position - graph[branch[0]].position).xy();
    let across = Vector2::new(-chord.y, chord.x).try_normalize(1e-6)?;
    let waves = 1 + rng.index(3.min(last - 1));
    let swing_m = rng.sign() * rng.between(0.05, 0.4) * chord.norm() / waves as f64;
    for (place, &station) in branch.iter().enumerate().take(last).skip(1) {
        let phase = PI * (waves * place) as f64 / last as f64;
        shift(&mut graph[station], across * (swing_m * libm::sin(phase)));
    }
    Some(graph)
}

/// Moves the inner stations of a branch towards the straight line.
fn straighten(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let branch = drawn(plan, rng);
    let last = branch.len() - 1;
    let ends = [branch[0], branch[last]].map(|end| plan.graph[end].position);
    if last < 2 || ends[0] == ends[1] {
        return None;
    }
    let mut graph = plan.graph.clone();
    let part = rng.between(0.1, 0.5);
    for (place, &station) in branch.iter().enumerate().take(last).skip(1) {
        let straight = ends[0] + (ends[1] - ends[0]) * (place as f64 / last as f64);
        let by = (straight - graph[station].position).xy() * part;
        shift(&mut graph[station], by);
    }
    Some(graph)
}

/// Displaces all stations by a wave across the plan, gently enough to keep neighbours together.
fn warp(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let [width_m, depth_m, _] = plan.graph.bounds()?.size();
    let (span_m, least_m) = (Vector2::new(width_m, depth_m).norm(), 4.0 * plan.leg_m);
    if span_m <= least_m {
        return None;
    }
    let wave_m = least_m * libm::pow(span_m / least_m, rng.unit());
    let [along, across] = [rng.between(0.0, TAU), rng.between(0.0, TAU)].map(towards);
    let swing_m = rng.between(0.02, 0.12) * wave_m;
    let phase = rng.between(0.0, TAU);
    let mut graph = plan.graph.clone();
    for node in &mut graph.nodes {
        let place = node.position.xy().coords.dot(&along);
        shift(node, across * (swing_m * libm::sin(TAU * place / wave_m + phase)));
    }
    Some(graph)
}

/// Grows a dead end at a station that is not one.
fn add_spur(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let foot = StationId::new(rng.index(plan.neighbors.len()));
    let bearing_rad = rng.between(0.0, TAU);
    let length_m = plan.branch_m * libm::exp(rng.normal() - 0.7);
    let fits = (2..MAX_DEGREE).contains(&plan.degree(foot)) && is_open(plan, foot, bearing_rad);
    fits.then(|| grown(plan, rng, foot, bearing_rad, length_m))
}

/// Removes a dead end.
fn prune(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let branch = drawn(plan, rng);
    let degrees = [branch[0], branch[branch.len() - 1]].map(|end| plan.degree(end));
    let is_spur = degrees.contains(&1) && degrees.iter().any(|&degree| degree > 2);
    is_spur.then(|| without(plan, branch))
}

/// Extends a dead end.
fn stretch(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let branch = outwards(plan, drawn(plan, rng))?;
    let [before, tip] = [branch[branch.len() - 2], branch[branch.len() - 1]];
    let way = plan.way(before, tip);
    let bearing_rad = libm::atan2(way.y, way.x) + TURN * rng.normal();
    let length_m = plan.branch_m * rng.between(0.3, 1.5);
    Some(grown(plan, rng, tip, bearing_rad, length_m))
}

/// Removes the last stations of a dead end, but not all.
fn shorten(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let branch = outwards(plan, drawn(plan, rng)).filter(|branch| branch.len() > 2)?;
    let left = 2 + rng.index(branch.len() - 2);
    Some(without(plan, &branch[left - 1..]))
}

/// Joins two stations that are near in space and far along the cave.
fn close_loop(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let graph = &plan.graph;
    let from = StationId::new(rng.index(graph.nodes.len()));
    let reach_m = plan.branch_m.max(2.0 * plan.leg_m) * rng.between(0.5, 2.0);
    let takes_more = |node: StationId| (1..MAX_DEGREE).contains(&plan.degree(node));
    let is_near = |&to: &StationId| {
        let way = graph[to].position - graph[from].position;
        let is_level = graph[to].level == graph[from].level && way.z.abs() <= SLOPE * way.xy().norm();
        to != from && takes_more(to) && is_level && way.norm() <= reach_m
    };
    let near: Vec<StationId> = graph.stations().filter(is_near).collect();
    if !takes_more(from) || near.is_empty() {
        return None;
    }
    let to = near[rng.index(near.len())];
    let way = plan.way(from, to);
    let bearing_rad = libm::atan2(way.y, way.x);
    if plan.are_joined(from, to, LOOP_HOPS - 1)
        || !is_open(plan, from, bearing_rad)
        || !is_open(plan, to, bearing_rad + PI)
    {
        return None;
    }
    let legs = (way.norm() / plan.leg_m).round().max(1.0) as usize;
    Some(inserted(graph.clone(), from, to, legs - 1).0)
}

/// Removes a third of a branch on a loop or more, up to all of it.
fn open_loop(plan: &Plan, rng: &mut Rng) -> Option<Graph> {
    let branch = drawn(plan, rng);
    let legs = branch.len() - 1;
    let least = legs.div_ceil(3);
    let taken = least + rng.index(legs - least + 1);
    let first = rng.index(legs - taken + 1);
    let is_on_loop = plan.are_joined(branch[first], branch[first + 1], usize::MAX);
    is_on_loop.then(|| without(plan, &branch[first..=first + taken]))
}

fn drawn<'a>(plan: &'a Plan, rng: &mut Rng) -> &'a [StationId] {
    &plan.branches[rng.index(plan.branches.len())]
}

/// A branch with a dead end, oriented towards it.
fn outwards(plan: &Plan, branch: &[StationId]) -> Option<Vec<StationId>> {
    match [branch[0], branch[branch.len() - 1]].map(|end| plan.degree(end)) {
        [_, 1] => Some(branch.to_vec()),
        [1, _] => Some(branch.iter().rev().copied().collect()),
        _ => None,
    }
}

fn towards(bearing_rad: f64) -> Vector2<f64> {
    Vector2::new(libm::cos(bearing_rad), libm::sin(bearing_rad))
}

fn shift(node: &mut Node, by: Vector2<f64>) {
    let at = node.position;
    node.position = Point3::new(at.x + by.x, at.y + by.y, at.z).map(millimetres);
}

/// Whether no passage leaves a station too close to a bearing.
fn is_open(plan: &Plan, station: StationId, bearing_rad: f64) -> bool {
    let nearest = libm::cos(MIN_ANGLE);
    let mut ways = plan.neighbors[station].iter().map(|&other| plan.way(station, other));
    ways.all(|way| way.dot(&towards(bearing_rad)) <= nearest * way.norm())
}

/// The graph with a level, winding passage added at a station.
fn grown(plan: &Plan, rng: &mut Rng, from: StationId, mut bearing_rad: f64, length_m: f64) -> Graph {
    let mut graph = plan.graph.clone();
    let legs = (length_m / plan.leg_m).round().max(1.0) as usize;
    let leg_m = (length_m / legs as f64).max(0.5 * plan.leg_m);
    let mut tip = from;
    for _ in 0..legs {
        let mut node = Node { active: true, position: graph[tip].position, name: None, ..graph[from].clone() };
        shift(&mut node, towards(bearing_rad) * leg_m);
        let next = StationId::new(graph.nodes.len());
        graph.nodes.push(node);
        graph.edges.push([tip, next]);
        tip = next;
        bearing_rad += TURN * rng.normal();
    }
    Graph::new(graph.nodes, graph.edges)
}

/// The graph without the passages of a path.
fn without(plan: &Plan, way: &[StationId]) -> Graph {
    let mut gone: Vec<[StationId; 2]> =
        way.windows(2).map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]).collect();
    gone.sort_unstable();
    let mut graph = plan.graph.clone();
    graph.edges.retain(|edge| gone.binary_search(edge).is_err());
    graph
}

/// The graph with a branch that can be bent: a single passage is divided into four.
fn divided(plan: &Plan, branch: &[StationId]) -> (Graph, Vec<StationId>) {
    match *branch {
        [a, b] => inserted(plan.graph.clone(), a, b, 3),
        _ => (plan.graph.clone(), branch.to_vec()),
    }
}

/// The graph with two stations joined by this many new ones on a straight line, and the path along it.
fn inserted(mut graph: Graph, a: StationId, b: StationId, count: usize) -> (Graph, Vec<StationId>) {
    let ends = [a, b].map(|end| graph[end].position);
    let mut way = vec![a];
    for place in 1..=count {
        let part = place as f64 / (count + 1) as f64;
        let position = (ends[0] + (ends[1] - ends[0]) * part).map(millimetres);
        let nearer = if part < 0.5 { a } else { b };
        way.push(StationId::new(graph.nodes.len()));
        graph.nodes.push(Node { position, active: false, name: None, ..graph[nearer].clone() });
    }
    way.push(b);
    graph.edges.retain(|edge| *edge != [a.min(b), a.max(b)]);
    graph.edges.extend(way.windows(2).map(|pair| [pair[0], pair[1]]));
    (Graph::new(graph.nodes, graph.edges), way)
}

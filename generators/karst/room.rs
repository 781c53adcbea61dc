//! Makes room between passages: two that are too close are both moved apart.

use plume_graph::Neighbors;
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};
use plume_graph::section::{Section, clearance_radius_m};

/// Minimum rock between passages, in addition to what is lost when bends become stations, in metres (tuned).
const ROCK_M: f64 = 1.0;
/// Margin beyond the required distance within which pairs of vertices are tracked, in metres.
const WATCHED_M: f64 = 1.0;
const ROUNDS: usize = 24;
/// Maximum total displacement of two passages, in metres (tuned: more makes kinks, less drops many passages).
const MOST_GIVEN_M: f64 = 2.0;
/// Factor on the width of a passage for the search along the cave; the other passage may be wider.
const FARTHEST: f64 = 1.3;
/// Minimum distance relative to a short path along the cave between two places: forks of 74 degrees satisfy it.
const PART_OF_WAY: f64 = 0.6;
/// Fraction of a height between passages that remains when their slopes are smoothed (tuned).
const LEVELLED: f64 = 0.8;

/// Moves vertices aside until hardly any two passages are nearer than their clearance radii and the rock between them, or
/// than a fraction of the path that connects them.
pub(super) fn give_way(centreline: &mut CentrelineBuilder, watched: &[Watched]) {
    let is_there: Vec<bool> = centreline.neighbors().degrees().map(|passages| passages > 0).collect();
    let is_left = |watched: &&Watched| watched.pair.iter().all(|&vertex| is_there[vertex.index()]);
    for _ in 0..ROUNDS {
        let mut is_still = true;
        for &Watched { pair, least_m } in watched.iter().filter(is_left) {
            let [a, b] = pair;
            let way = centreline[b].position - centreline[a].position;
            // Slopes are limited, so passages can only move sideways.
            let up = LEVELLED * way.z;
            let aside = (least_m * least_m - up * up).max(0.0).sqrt() - way.xy().norm();
            if let (true, Some(along)) = (aside > 0.01, way.xy().try_normalize(1e-6)) {
                let moved = (along * (0.5 * aside)).push(0.0);
                centreline[a].position -= moved;
                centreline[b].position += moved;
                is_still = false;
            }
        }
        if is_still {
            break;
        }
    }
}

/// Pairs of vertices that could not be separated without distorting passages.
pub(super) fn crowds(centreline: &CentrelineBuilder, watched: &[Watched]) -> Vec<[VertexId; 2]> {
    let is_crowded =
        |Watched { pair: [a, b], least_m }: &&Watched| centreline.distance_m(*a, *b) < least_m - MOST_GIVEN_M;
    watched.iter().filter(is_crowded).map(|watched| watched.pair).collect()
}

/// Two vertices that may be too close.
pub(super) struct Watched {
    pair: [VertexId; 2],
    /// The distance that they should keep.
    least_m: f64,
}

/// Pairs of vertices that are too close, or nearly so.
pub(super) fn watched(centreline: &CentrelineBuilder) -> Vec<Watched> {
    let neighbors = centreline.neighbors();
    let near = near_pairs(&centreline.vertices);
    let mut walk = Walk::default();
    let mut watched = Vec::new();
    for pairs in near.chunk_by(|a, b| a[0] == b[0]) {
        walk.start(centreline, &neighbors, pairs[0][0]);
        for &pair in pairs {
            let [a, b] = pair;
            let least_m = least_m(&centreline[a], &centreline[b]).min(PART_OF_WAY * walk.way_m(b));
            if centreline.distance_m(a, b) < least_m + WATCHED_M {
                watched.push(Watched { pair, least_m });
            }
        }
    }
    watched
}

/// The distance that two passages should keep.
pub(super) fn least_m(a: &Vertex, b: &Vertex) -> f64 {
    reach_m(a) + reach_m(b) + ROCK_M
}

/// 0 without a section.
fn reach_m(vertex: &Vertex) -> f64 {
    vertex.section.map_or(0.0, |Section { width_m, height_m, .. }| clearance_radius_m(width_m, height_m))
}

/// Position of a vertex in a sweep over the rows of the plan.
struct Swept {
    row: i32,
    x: f64,
    vertex: VertexId,
}

/// Finds pairs of vertices that are closer than they should be, or nearly so.
fn near_pairs(vertices: &[Vertex]) -> Vec<[VertexId; 2]> {
    let widest = vertices.iter().map(reach_m).fold(0.0, f64::max);
    let most_m = 2.0 * widest + ROCK_M + WATCHED_M;
    let swept = |(place, vertex): (usize, &Vertex)| Swept {
        row: (vertex.position.y / most_m).floor() as i32,
        x: vertex.position.x,
        vertex: VertexId::new(place),
    };
    let mut sweep: Vec<Swept> = vertices.iter().enumerate().map(swept).collect();
    sweep.sort_unstable_by(|a, b| a.row.cmp(&b.row).then(a.x.total_cmp(&b.x)).then(a.vertex.cmp(&b.vertex)));
    let mut pairs = Vec::new();
    // Position of the sweep in the next row.
    let mut above = 0;
    for (place, here) in sweep.iter().enumerate() {
        let start = (here.row + 1, here.x - most_m);
        while sweep.get(above).is_some_and(|other| (other.row, other.x) < start) {
            above += 1;
        }
        let beside = |from: usize, row: i32| {
            sweep[from..].iter().take_while(move |other| other.row == row && other.x <= here.x + most_m)
        };
        let vertex = &vertices[here.vertex.index()];
        let is_near = |&other: &VertexId| {
            let other = &vertices[other.index()];
            let most_m = least_m(vertex, other) + WATCHED_M;
            (other.position - vertex.position).norm_squared() < most_m * most_m
        };
        let others = beside(place + 1, here.row).chain(beside(above, here.row + 1)).map(|other| other.vertex);
        pairs.extend(others.filter(is_near).map(|other| [here.vertex, other]));
    }
    pairs
}

/// The shortest paths along the cave from one vertex to those around it.
#[derive(Default)]
struct Walk(Vec<(VertexId, f64)>);

impl Walk {
    /// Restarts at a vertex, and goes as far as paths matter.
    fn start(&mut self, centreline: &CentrelineBuilder, neighbors: &Neighbors<Vertex>, from: VertexId) {
        let most_m = 2.0 * reach_m(&centreline[from]) + ROCK_M;
        let most_m = FARTHEST * most_m / PART_OF_WAY;
        self.0.clear();
        self.0.push((from, 0.0));
        let mut next = 0;
        while let Some(&(at, way_m)) = self.0.get(next) {
            next += 1;
            for &to in &neighbors[at] {
                let to_m = way_m + centreline.distance_m(at, to);
                if to_m <= most_m && to_m < self.way_m(to) {
                    self.0.push((to, to_m));
                }
            }
        }
    }

    /// Infinite if not reached.
    fn way_m(&self, vertex: VertexId) -> f64 {
        self.0.iter().filter(|(at, _)| *at == vertex).map(|&(_, way_m)| way_m).fold(f64::INFINITY, f64::min)
    }
}

//! Rock between passages: where two of them come nearer to each other than they should, or break into each other.
//!
//! A passage is taken for the hull that an ellipse of its wider end sweeps along its axis (the profile of the field, floor
//! and roughness left out), a room for such an ellipsoid. Two convex hulls are apart by no less than they are along any one
//! direction; the one that is looked along here is that in which their axes are nearest. So the thickness that is told is
//! never more than the true one, and exact for passages that cross above each other.
//!
//! Passages that are joined nearby are exempt: rock between them has to end somewhere.

use std::cmp::Ordering;
use std::collections::VecDeque;

use nalgebra::{Point2, Point3, Vector3};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashMap;
use serde::Serialize;

use super::segment::nearest_shares;
use super::{Graph, Node, Section, Shape, StationId};

/// Passages are joined nearby if a way leads from one to the other that is not longer than so many times the distance that
/// their axes should keep. Tuned on junctions: less tells of the rock between the legs of every acute one.
const NEARBY: f64 = 2.0;
/// Places told of one passage, the thinnest; keeps the memory linear where a graph is a tangle.
const MOST_OF_ONE: usize = 16;
/// Places that a report names.
const NAMED: usize = 10;
/// The least that a hull is searched for beyond its box, in metres, so that rounding loses none.
const ROUNDING_M: f64 = 1e-6;

/// How large passages are where a station does not say it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassageSize {
    /// Width in units of the radius of a station.
    pub width_per_radius: f64,
    /// Least width in metres.
    pub width_min_m: f64,
    /// Height of the full section in units of its width.
    pub height_ratio: f64,
    /// Depth of the floor below the axis in units of half the height.
    pub floor_drop: f64,
    /// Width of a room where three or more passages meet, in units of the width of its station.
    pub room_factor: f64,
}

impl Default for PassageSize {
    /// Passages as recipes make them that say nothing of them.
    fn default() -> Self {
        Self { width_per_radius: 0.6, width_min_m: 1.4, height_ratio: 1.1, floor_drop: 0.5, room_factor: 1.5 }
    }
}

/// A place where the rock is thinner than asked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Thin {
    /// The two passages, by their stations; a room is its station twice.
    pub passages: [[StationId; 2]; 2],
    /// Midway between them.
    pub place: Point3<f64>,
    /// Thickness of the rock in metres, never more than it is; 0 or less where they may break into each other.
    pub rock_m: f64,
    /// Whether the two passages have no level in common.
    pub between_levels: bool,
}

impl Thin {
    fn thinner_first(&self, other: &Self) -> Ordering {
        self.rock_m.total_cmp(&other.rock_m).then_with(|| self.passages.cmp(&other.passages))
    }
}

/// What [`thin_rock`] found, in short.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RockReport {
    /// The thickness that was asked for, in metres.
    pub rock_asked_m: f64,
    /// Pairs of passages with less rock between them, though no short way joins them.
    pub thin_places: usize,
    /// Those of them that lie on different levels.
    pub thin_between_levels: usize,
    /// Pairs that may break into each other.
    pub breakthroughs: usize,
    /// Those of them that lie on different levels.
    pub breakthroughs_between_levels: usize,
    /// The thinnest places, thinnest first.
    pub thinnest: Vec<Thin>,
}

impl RockReport {
    /// The report of a graph.
    pub fn of(graph: &Graph, passage_size: PassageSize, least_m: f64) -> Self {
        let mut thin = thin_rock(graph, passage_size, least_m);
        thin.sort_by(Thin::thinner_first);
        let count = |is: fn(&Thin) -> bool| thin.iter().filter(|place| is(place)).count();
        Self {
            rock_asked_m: least_m,
            thin_places: thin.len(),
            thin_between_levels: count(|place| place.between_levels),
            breakthroughs: count(|place| place.rock_m <= 0.0),
            breakthroughs_between_levels: count(|place| place.rock_m <= 0.0 && place.between_levels),
            thinnest: thin.into_iter().take(NAMED).collect(),
        }
    }
}

/// Every pair of passages of a graph with less than `least_m` of rock between them, unless a short way joins them; in the
/// order of the passages.
pub fn thin_rock(graph: &Graph, passage_size: PassageSize, least_m: f64) -> Vec<Thin> {
    let index = PassageIndex::new(graph, passage_size);
    let bodies = index.all_bodies();
    let of_one = |&body: &[StationId; 2]| {
        let mut thin: Vec<Thin> = index.thin(body, least_m).filter(|thin| thin.passages[0] == body).collect();
        thin.sort_by(Thin::thinner_first);
        thin.truncate(MOST_OF_ONE);
        thin
    };
    bodies.par_iter().flat_map_iter(of_one).collect()
}

/// Half the section of a passage.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Profile {
    half_width: f64,
    half_height: f64,
    /// Whether it is nearly a rectangle.
    square: bool,
}

impl Profile {
    fn of(node: &Node, passage_size: &PassageSize) -> Self {
        let of_width = |width: f64| 0.5 * width.max(passage_size.width_min_m);
        match node.section {
            Some(Section { width_m, height_m, shape: Shape::Drift }) => {
                Self { half_width: 0.5 * width_m, half_height: height_m / (1.0 + Section::DRIFT_DROP), square: true }
            }
            Some(Section { width_m, height_m, shape: Shape::Cave }) => {
                let half_height = height_m.max(passage_size.width_min_m) / (1.0 + passage_size.floor_drop);
                Self { half_width: of_width(width_m), half_height, square: false }
            }
            None => {
                let half_width = of_width(node.radius * passage_size.width_per_radius);
                Self { half_width, half_height: half_width * passage_size.height_ratio, square: false }
            }
        }
    }

    fn wider(self, other: Self) -> Self {
        Self {
            half_width: self.half_width.max(other.half_width),
            half_height: self.half_height.max(other.half_height),
            square: self.square || other.square,
        }
    }

    fn room(self, factor: f64) -> Self {
        Self { half_width: self.half_width * factor, half_height: self.half_height * factor.sqrt(), ..self }
    }

    /// How far it reaches along a unit vector.
    fn reach(&self, along: &Vector3<f64>) -> f64 {
        /// The fourth-power norm of a drift is at least 2^-1/4 of the Euclidean one.
        const SQUARE: f64 = 1.19;
        let flat = self.half_width * self.half_width * (along.x * along.x + along.y * along.y);
        let up = self.half_height * self.half_height * along.z * along.z;
        // Along an axis even a drift reaches no further than its half width or height.
        let most = self.half_width * along.xy().norm() + self.half_height * along.z.abs();
        let round = (flat + up).sqrt();
        if self.square { (SQUARE * round).min(most) } else { round }
    }
}

/// A passage or a room as a hull.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    ends: [Point3<f64>; 2],
    profile: Profile,
}

/// What lies between two hulls.
struct Gap {
    /// Least thickness.
    rock_m: f64,
    /// How far the axes would have to be apart for none.
    reach_m: f64,
    middle: Point3<f64>,
}

impl Body {
    /// The hull, moved.
    pub fn moved(&self, by: &Vector3<f64>) -> Self {
        Self { ends: self.ends.map(|end| end + by), ..*self }
    }

    fn gap(&self, other: &Self) -> Gap {
        let [p, q] = &self.ends;
        let [r, s] = &other.ends;
        let [here, there] = nearest_shares([p, q], [r, s]);
        let (on_this, on_other) = (p + (q - p) * here, r + (s - r) * there);
        let between = on_other - on_this;
        let along = between.try_normalize(1e-9).unwrap_or_else(Vector3::z);
        let reach_m = self.profile.reach(&along) + other.profile.reach(&along);
        Gap { rock_m: between.norm() - reach_m, reach_m, middle: on_this + between * 0.5 }
    }

    fn hull(&self, margin_m: f64) -> AABB<[f64; 3]> {
        let [p, q] = &self.ends;
        let Profile { half_width, half_height, .. } = self.profile;
        let reach = Vector3::new(half_width, half_width, half_height).map(|x| x + margin_m);
        AABB::from_corners((p.inf(q) - reach).into(), (p.sup(q) + reach).into())
    }
}

/// The passages of a graph that grows, and where they are.
#[derive(Clone)]
pub struct PassageIndex {
    passage_size: PassageSize,
    /// The stations.
    pub nodes: Vec<Node>,
    /// For each station those that passages join to it.
    neighbors: Vec<Vec<StationId>>,
    bodies: RTree<GeomWithData<Rectangle<[f64; 3]>, [StationId; 2]>>,
}

impl PassageIndex {
    /// The passages of a graph, all of them [settled](Self::settle).
    pub fn new(graph: &Graph, passage_size: PassageSize) -> Self {
        let neighbors = graph.neighbors().iter().map(<[_]>::to_vec).collect();
        let mut index = Self { passage_size, nodes: graph.nodes.clone(), neighbors, bodies: RTree::new() };
        let entries = index.all_bodies().into_iter().map(|body| index.entry(body)).collect();
        index.bodies = RTree::bulk_load(entries);
        index
    }

    /// Every station.
    fn stations(&self) -> impl Iterator<Item = StationId> + use<> {
        StationId::all(self.nodes.len())
    }

    /// A station.
    pub fn node(&self, station: StationId) -> &Node {
        &self.nodes[station.index()]
    }

    /// The stations that passages join to one.
    pub fn neighbors_of(&self, station: StationId) -> &[StationId] {
        &self.neighbors[station.index()]
    }

    /// The graph of all stations and passages, settled or not.
    pub fn into_graph(self) -> Graph {
        let edges = self.stations().flat_map(|a| self.neighbors[a.index()].iter().map(move |&b| [a, b]));
        let edges = edges.filter(|[a, b]| a < b).collect();
        Graph::new(self.nodes, edges)
    }

    /// Adds a station that hangs on nothing yet.
    pub fn add(&mut self, node: Node) -> StationId {
        let station = StationId::new(self.nodes.len());
        self.nodes.push(node);
        self.neighbors.push(Vec::new());
        station
    }

    /// Joins two stations. The passage stands in nobody's way until it is [settled](Self::settle).
    pub fn join(&mut self, a: StationId, b: StationId) {
        self.neighbors[a.index()].push(b);
        self.neighbors[b.index()].push(a);
    }

    /// Takes back the stations from `len` on, and what joins them.
    pub fn truncate(&mut self, len: usize) {
        for last in (len..self.nodes.len()).rev().map(StationId::new) {
            for other in std::mem::take(&mut self.neighbors[last.index()]) {
                self.neighbors[other.index()].retain(|&next| next != last);
            }
        }
        self.nodes.truncate(len);
        self.neighbors.truncate(len);
    }

    /// Parts two stations.
    pub fn part(&mut self, a: StationId, b: StationId) {
        self.neighbors[a.index()].retain(|&other| other != b);
        self.neighbors[b.index()].retain(|&other| other != a);
    }

    /// From now on these passages and rooms stand in the way of others.
    pub fn settle(&mut self, bodies: &[[StationId; 2]]) {
        for &body in bodies {
            self.bodies.insert(self.entry(body));
        }
    }

    /// No longer.
    pub fn unsettle(&mut self, body: [StationId; 2]) {
        self.bodies.remove(&self.entry(body));
    }

    /// All passages, and all rooms.
    pub fn all_bodies(&self) -> Vec<[StationId; 2]> {
        let of = |node: StationId| {
            let after =
                self.neighbors_of(node).iter().filter(move |&&other| other > node).map(move |&other| [node, other]);
            let room = self.is_room(node).then_some([node, node]);
            room.into_iter().chain(after).collect::<Vec<_>>()
        };
        self.stations().flat_map(of).collect()
    }

    /// Whether a station is a room.
    pub fn is_room(&self, node: StationId) -> bool {
        self.neighbors_of(node).len() >= 3 && self.node(node).section.is_none()
    }

    /// The hull of a passage, or of a room.
    pub fn body(&self, [a, b]: [StationId; 2]) -> Body {
        let [start, end] = [a, b].map(|node| Profile::of(self.node(node), &self.passage_size));
        let profile = if a == b { start.room(self.passage_size.room_factor) } else { start.wider(end) };
        Body { ends: [a, b].map(|node| self.node(node).position), profile }
    }

    /// Where one passage or room has too little rock to those that are settled.
    pub fn thin(&self, body: [StationId; 2], least_m: f64) -> impl Iterator<Item = Thin> {
        let hull = self.body(body).hull(least_m.max(0.0) + ROUNDING_M);
        let near = self.bodies.locate_in_envelope_intersecting(hull).map(|entry| entry.data);
        near.filter(move |&other| other != body).filter_map(move |other| self.thin_between(body, other, least_m))
    }

    /// The least rock between a hull that is not part of the graph and what is settled, if it is less than `least_m`.
    pub fn thinnest(&self, body: &Body, least_m: f64) -> Option<f64> {
        let near = self.bodies.locate_in_envelope_intersecting(body.hull(least_m.max(0.0) + ROUNDING_M));
        let rocks = near.map(|entry| self.body(entry.data).gap(body).rock_m);
        rocks.filter(|rock_m| *rock_m < least_m).min_by(f64::total_cmp)
    }

    /// Settled passages whose boxes meet that between two points of the plan, at any depth.
    pub fn under(&self, plan: [Point2<f64>; 2]) -> impl Iterator<Item = [StationId; 2]> {
        let [a, b] = plan;
        let column = AABB::from_corners([a.x, a.y, f64::MIN], [b.x, b.y, f64::MAX]);
        let near = self.bodies.locate_in_envelope_intersecting(column).map(|entry| entry.data);
        near.filter(|[a, b]| a != b)
    }

    /// The place between two passages or rooms, if it is too thin and no short way joins them.
    pub fn thin_between(&self, one: [StationId; 2], other: [StationId; 2], least_m: f64) -> Option<Thin> {
        if self.touch(one, other) {
            return None;
        }
        let gap = self.body(one).gap(&self.body(other));
        let joined = || self.is_way(one, other, NEARBY * (gap.reach_m + least_m.max(0.0)));
        if gap.rock_m >= least_m || joined() {
            return None;
        }
        let levels = |[a, b]: [StationId; 2]| [self.node(a).level, self.node(b).level];
        let common = levels(one).iter().any(|level| levels(other).contains(level));
        Some(Thin {
            passages: [one.min(other), one.max(other)],
            place: gap.middle,
            rock_m: gap.rock_m,
            between_levels: !common,
        })
    }

    /// Whether two passages share a station, or a third one joins them.
    fn touch(&self, one: [StationId; 2], other: [StationId; 2]) -> bool {
        one.iter().any(|end| other.contains(end) || self.neighbors_of(*end).iter().any(|next| other.contains(next)))
    }

    /// Whether a way of at most this length leads from the end of one passage to that of another.
    fn is_way(&self, from: [StationId; 2], to: [StationId; 2], most_m: f64) -> bool {
        let mut least: FxHashMap<StationId, f64> = FxHashMap::default();
        let mut open: VecDeque<(StationId, f64)> = from.iter().map(|&end| (end, 0.0)).collect();
        while let Some((node, way_m)) = open.pop_front() {
            if least.get(&node).is_some_and(|known| *known <= way_m) {
                continue;
            }
            if to.contains(&node) {
                return true;
            }
            least.insert(node, way_m);
            for &next in self.neighbors_of(node) {
                let way_m = way_m + (self.node(next).position - self.node(node).position).norm();
                if way_m <= most_m {
                    open.push_back((next, way_m));
                }
            }
        }
        false
    }

    fn entry(&self, body: [StationId; 2]) -> GeomWithData<Rectangle<[f64; 3]>, [StationId; 2]> {
        let hull = self.body(body).hull(0.0);
        GeomWithData::new(Rectangle::from_aabb(hull), body)
    }
}

//! Rock between passages: where two of them are too close, or break into each other.
//!
//! A passage is modelled as the hull swept by the ellipse of its wider end along its axis (the profile of the field without
//! floor and roughness), a room as such an ellipsoid. The distance of two convex hulls is at least their gap along any
//! direction; here the direction is that in which their axes are nearest. So the reported thickness is never more than the
//! true one, and exact for passages that cross above each other.
//!
//! Passages that are connected nearby are exempt: the rock between them has to end somewhere.
//!
//! ```
//! use plume_graph::centreline::{CentrelineBuilder, Vertex};
//! use plume_graph::clearance::{PassageSize, thin_rock};
//! use plume_graph::{Section, Shape};
//!
//! let section = Some(Section { width_m: 4.0, height_m: 4.0, shape: Shape::Drift });
//! let mut centreline = CentrelineBuilder::default();
//! for z in [0.0, 5.0] {
//!     let ends = [0.0, 30.0].map(|x| centreline.add(Vertex { position: [x, 0.0, z].into(), section, level: 0 }));
//!     centreline.join(ends[0], ends[1]);
//! }
//! let thin = thin_rock(&centreline.into_graph(), PassageSize::default(), 2.0);
//! assert!(thin.len() == 1 && thin[0].rock_m < 2.0, "1 m of rock between two drifts");
//! ```

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

/// Passages are connected nearby if a path between them is at most this many times as long as the distance that their axes
/// should keep. Tuned on junctions: with less, the rock between the legs of every acute one would be reported.
const NEARBY: f64 = 2.0;
/// Maximum number of places per passage, the thinnest ones; keeps memory linear for tangled graphs.
const MOST_OF_ONE: usize = 16;
/// Number of places listed in a report.
const NAMED: usize = 10;
/// Minimum margin of the search around the box of a hull, in metres, because of rounding.
const ROUNDING_M: f64 = 1e-6;

/// Size of passages at stations without a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassageSize {
    /// Width relative to the radius of a station.
    pub width_per_radius: f64,
    /// Minimum width in metres.
    pub width_min_m: f64,
    /// Height of the full section relative to its width.
    pub height_ratio: f64,
    /// Depth of the floor below the axis relative to half the height.
    pub floor_drop: f64,
    /// Width of a room where three or more passages meet, relative to the width of its station.
    pub room_factor: f64,
}

impl Default for PassageSize {
    /// The default sizes of recipes.
    fn default() -> Self {
        Self {
            width_per_radius: 0.6,
            width_min_m: 1.4,
            height_ratio: 1.1,
            floor_drop: Section::CAVE_DROP,
            room_factor: 1.5,
        }
    }
}

/// A place where the rock is thinner than required.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Thin {
    /// The two passages, by their stations; a room is its station twice.
    pub passages: [[StationId; 2]; 2],
    /// The midpoint between them.
    pub place: Point3<f64>,
    /// Lower bound of the thickness of the rock in metres; 0 or less where they may break into each other.
    pub rock_m: f64,
    /// Whether the two passages have no level in common.
    pub between_levels: bool,
}

impl Thin {
    fn thinner_first(&self, other: &Self) -> Ordering {
        self.rock_m.total_cmp(&other.rock_m).then_with(|| self.passages.cmp(&other.passages))
    }
}

/// Summary of [`thin_rock`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RockReport {
    /// The required thickness, in metres.
    pub rock_asked_m: f64,
    /// Pairs of passages with less rock between them, although no short path connects them.
    pub thin_places: usize,
    /// Those of them on different levels.
    pub thin_between_levels: usize,
    /// Pairs that may break into each other.
    pub breakthroughs: usize,
    /// Those of them on different levels.
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

/// Every pair of passages of a graph with less than `least_m` of rock between them, unless a short path connects them; in
/// the order of the passages.
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
    /// Whether it is nearly rectangular.
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

    /// Its extent along a unit vector.
    fn reach(&self, along: &Vector3<f64>) -> f64 {
        /// The fourth-power norm of a drift is at least 2^-1/4 of the Euclidean one.
        const SQUARE: f64 = 1.19;
        let flat = self.half_width * self.half_width * (along.x * along.x + along.y * along.y);
        let up = self.half_height * self.half_height * along.z * along.z;
        // Along an axis even a drift extends no further than its half width or height.
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

/// The gap between two hulls.
struct Gap {
    /// Minimum thickness.
    rock_m: f64,
    /// Distance of the axes at which there would be no rock.
    reach_m: f64,
    middle: Point3<f64>,
}

impl Body {
    /// The translated hull.
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

/// A spatial index of the passages of a growing graph.
#[derive(Clone)]
pub struct PassageIndex {
    passage_size: PassageSize,
    /// The stations.
    pub nodes: Vec<Node>,
    /// The neighbours of each station.
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

    /// Adds an isolated station.
    pub fn add(&mut self, node: Node) -> StationId {
        let station = StationId::new(self.nodes.len());
        self.nodes.push(node);
        self.neighbors.push(Vec::new());
        station
    }

    /// Joins two stations. The passage does not affect others until it is [settled](Self::settle).
    pub fn join(&mut self, a: StationId, b: StationId) {
        self.neighbors[a.index()].push(b);
        self.neighbors[b.index()].push(a);
    }

    /// Removes the stations from index `len` on, and their passages.
    pub fn truncate(&mut self, len: usize) {
        for last in (len..self.nodes.len()).rev().map(StationId::new) {
            for other in std::mem::take(&mut self.neighbors[last.index()]) {
                self.neighbors[other.index()].retain(|&next| next != last);
            }
        }
        self.nodes.truncate(len);
        self.neighbors.truncate(len);
    }

    /// Removes the passage between two stations.
    pub fn part(&mut self, a: StationId, b: StationId) {
        self.neighbors[a.index()].retain(|&other| other != b);
        self.neighbors[b.index()].retain(|&other| other != a);
    }

    /// From now on other passages must keep their distance from these passages and rooms.
    pub fn settle(&mut self, bodies: &[[StationId; 2]]) {
        for &body in bodies {
            self.bodies.insert(self.entry(body));
        }
    }

    /// Reverses that.
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

    /// Where a passage or room has too little rock to settled ones.
    pub fn thin(&self, body: [StationId; 2], least_m: f64) -> impl Iterator<Item = Thin> {
        let hull = self.body(body).hull(least_m.max(0.0) + ROUNDING_M);
        let near = self.bodies.locate_in_envelope_intersecting(hull).map(|entry| entry.data);
        near.filter(move |&other| other != body).filter_map(move |other| self.thin_between(body, other, least_m))
    }

    /// The minimum rock between a hull outside the graph and settled passages, if it is less than `least_m`.
    pub fn thinnest(&self, body: &Body, least_m: f64) -> Option<f64> {
        let near = self.bodies.locate_in_envelope_intersecting(body.hull(least_m.max(0.0) + ROUNDING_M));
        let rocks = near.map(|entry| self.body(entry.data).gap(body).rock_m);
        rocks.filter(|rock_m| *rock_m < least_m).min_by(f64::total_cmp)
    }

    /// Settled passages whose boxes overlap that of two points horizontally, at any depth.
    pub fn under(&self, plan: [Point2<f64>; 2]) -> impl Iterator<Item = [StationId; 2]> {
        let [a, b] = plan;
        let column = AABB::from_corners([a.x, a.y, f64::MIN], [b.x, b.y, f64::MAX]);
        let near = self.bodies.locate_in_envelope_intersecting(column).map(|entry| entry.data);
        near.filter(|[a, b]| a != b)
    }

    /// The place between two passages or rooms, if it is too thin and no short path connects them.
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

    /// Whether two passages share a station, or a third one connects them.
    fn touch(&self, one: [StationId; 2], other: [StationId; 2]) -> bool {
        one.iter().any(|end| other.contains(end) || self.neighbors_of(*end).iter().any(|next| other.contains(next)))
    }

    /// Whether a path of at most this length connects the ends of two passages.
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

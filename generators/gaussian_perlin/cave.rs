//! A growing cave: stations, passages, and the counts that decisions depend on, updated incrementally.

use nalgebra::Point3;

use super::GaussianPerlin;
use super::circle::Compass;
use super::grid::Grid;
use super::lengths::Lengths;
use super::tuning::{
    EXCESS_DEGREE, FEW_KNOTS, JOIN_DISTANCE, MEAN_LENGTH, REACH_GROWTH, REACH_JITTER, REACH_SHRINK, SPREAD,
    SPREAD_RIM_M, SPUR_REACH, TRUNK_REACH, WIDTH_PER_RADIUS,
};
use crate::perlin::Perlin;
use plume_graph::rng::Rng;
use plume_graph::{Graph, Node, StationId, millimetres};

/// Where a link starts, and where it meets the layer below.
pub(super) type Link = [Point3<f64>; 2];

/// The kind of branch a station belongs to.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum PassageKind {
    /// The longest branch of a block of planned lengths; spared by connectors.
    Main,
    Trunk,
    Spur,
    Link,
    Ramp,
}

/// A node with the state that growth needs.
pub(super) struct GrowingStation {
    pub(super) position: Point3<f64>,
    pub(super) radius: f64,
    pub(super) parent: Option<usize>,
    pub(super) neighbors: Vec<usize>,
    pub(super) kind: PassageKind,
    pub(super) level: u32,
    /// Azimuth in which it was reached.
    pub(super) heading_rad: f64,
    pub(super) alive: bool,
    /// Its index in the list of tips.
    pub(super) tip: Option<usize>,
}

impl GrowingStation {
    pub(super) fn new(position: Point3<f64>, radius: f64, kind: PassageKind, level: u32) -> Self {
        Self {
            position: position.map(millimetres),
            radius: millimetres(radius),
            parent: None,
            neighbors: Vec::new(),
            kind,
            level,
            heading_rad: 0.0,
            alive: true,
            tip: None,
        }
    }

    pub(super) fn degree(&self) -> usize {
        self.neighbors.len()
    }

    pub(super) fn half_width(&self) -> f64 {
        half_width(self.radius)
    }
}

/// Half the width of the passage at a node of this radius.
pub(super) fn half_width(radius: f64) -> f64 {
    0.5 * WIDTH_PER_RADIUS * radius
}

/// Lengths in metres that follow from the settings.
pub(super) struct DerivedLengths {
    /// Mean radius on trunks.
    pub(super) trunk_reach: f64,
    /// Mean radius on spurs and connectors.
    pub(super) spur_reach: f64,
    /// Mean length of a branch.
    pub(super) mean_length: f64,
    /// Longest span of a connector.
    pub(super) join_distance: f64,
    /// Half extents of the plan.
    pub(super) half: [f64; 2],
}

impl DerivedLengths {
    fn new(settings: &GaussianPerlin) -> Self {
        let span = settings.reach_max_m - settings.reach_min_m;
        let trunk_reach = settings.reach_min_m + TRUNK_REACH * span;
        let stations = f64::from(settings.nodes) / f64::from(settings.layers);
        let auto = 0.5 * SPREAD * trunk_reach * stations.sqrt() + SPREAD_RIM_M;
        let half = |side_m: f64| {
            if side_m > 0.0 { 0.5 * side_m / settings.scale } else { auto }
        };
        Self {
            trunk_reach,
            spur_reach: settings.reach_min_m + SPUR_REACH * span,
            mean_length: MEAN_LENGTH * trunk_reach,
            join_distance: JOIN_DISTANCE * trunk_reach,
            half: [half(settings.bounds_x_m), half(settings.bounds_y_m)],
        }
    }
}

/// The state of one attempt.
pub(super) struct Cave<'a> {
    pub(super) settings: &'a GaussianPerlin,
    pub(super) derived: DerivedLengths,
    pub(super) rng: Rng,
    pub(super) compass: Compass,
    pub(super) relief: Perlin,
    pub(super) lengths: Lengths,
    pub(super) stations: Vec<GrowingStation>,
    pub(super) grid: Grid,
    /// Stations with one passage.
    pub(super) tips: Vec<usize>,
    pub(super) deepest: u32,
    /// Links below each layer.
    pub(super) links: Vec<Vec<Link>>,
    mean_degree: f64,
    /// Number of stations of the reduced graph: those that do not have exactly two passages.
    vertices: usize,
    /// Number of branch ends at them.
    knot_ends: usize,
}

impl<'a> Cave<'a> {
    pub(super) fn new(settings: &'a GaussianPerlin, mut rng: Rng) -> Self {
        let derived = DerivedLengths::new(settings);
        Self {
            compass: Compass::new(settings, &mut rng),
            relief: Perlin::new(&mut rng),
            lengths: Lengths::new(settings.nodes, derived.mean_length),
            mean_degree: 2.0 + settings.loop_closure * rng.between(EXCESS_DEGREE[0], EXCESS_DEGREE[1]),
            settings,
            derived,
            rng,
            stations: Vec::new(),
            grid: Grid::default(),
            tips: Vec::new(),
            deepest: 0,
            links: Vec::new(),
            vertices: 0,
            knot_ends: 0,
        }
    }

    /// Number of nodes still to be placed.
    pub(super) fn room(&self) -> usize {
        (self.settings.nodes as usize).saturating_sub(self.stations.len())
    }

    /// Number of loops still missing for the mean degree of the reduced graph.
    pub(super) fn missing_loops(&self) -> f64 {
        if self.settings.loop_closure == 0.0 || self.vertices <= FEW_KNOTS {
            return 0.0;
        }
        0.5 * self.mean_degree * self.vertices as f64 - 0.5 * self.knot_ends as f64
    }

    pub(super) fn position(&self, station: usize) -> &Point3<f64> {
        &self.stations[station].position
    }

    /// Azimuth from one station to another.
    pub(super) fn azimuth_rad(&self, from: usize, to: usize) -> f64 {
        let way = self.position(to) - self.position(from);
        libm::atan2(way.y, way.x)
    }

    /// Horizontal distance.
    pub(super) fn distance(&self, a: usize, b: usize) -> f64 {
        (self.position(a).xy() - self.position(b).xy()).norm()
    }

    /// A random radius around `mean`, not far from the previous one.
    pub(super) fn draw_reach(&mut self, mean: f64, before: Option<f64>) -> f64 {
        let drawn = mean * libm::exp(REACH_JITTER * self.rng.normal());
        let smooth = before.map_or(drawn, |radius| drawn.max(radius / REACH_SHRINK).min(radius * REACH_GROWTH));
        smooth.max(self.settings.reach_min_m).min(self.settings.reach_max_m)
    }

    pub(super) fn add_station(&mut self, station: GrowingStation) -> usize {
        let index = self.stations.len();
        let parent = station.parent;
        self.grid.add_station(index, &station.position);
        self.deepest = self.deepest.max(station.level);
        self.stations.push(station);
        self.count(index);
        if let Some(parent) = parent {
            self.add_passage(parent, index);
        }
        index
    }

    /// Removes the stations from index `len` on, and their passages.
    pub(super) fn truncate(&mut self, len: usize) {
        for last in (len..self.stations.len()).rev() {
            for other in self.stations[last].neighbors.clone() {
                self.remove_passage(last, other);
            }
            self.uncount(last);
            self.grid.remove_station(last, &self.stations[last].position);
            self.stations.pop();
        }
    }

    pub(super) fn add_passage(&mut self, a: usize, b: usize) {
        self.relink(a, |neighbors| neighbors.push(b));
        self.relink(b, |neighbors| neighbors.push(a));
        let ends = [&self.stations[a].position, &self.stations[b].position];
        self.grid.add_passage([a.min(b), a.max(b)], ends);
    }

    pub(super) fn remove_passage(&mut self, a: usize, b: usize) {
        self.relink(a, |neighbors| neighbors.retain(|&other| other != b));
        self.relink(b, |neighbors| neighbors.retain(|&other| other != a));
        let ends = [&self.stations[a].position, &self.stations[b].position];
        self.grid.remove_passage([a.min(b), a.max(b)], ends);
    }

    fn relink(&mut self, station: usize, change: impl FnOnce(&mut Vec<usize>)) {
        self.uncount(station);
        change(&mut self.stations[station].neighbors);
        self.count(station);
    }

    fn count(&mut self, station: usize) {
        let degree = self.stations[station].degree();
        if degree == 1 {
            self.stations[station].tip = Some(self.tips.len());
            self.tips.push(station);
        }
        if degree != 2 {
            self.vertices += 1;
            self.knot_ends += degree;
        }
    }

    fn uncount(&mut self, station: usize) {
        let degree = self.stations[station].degree();
        if let Some(place) = self.stations[station].tip.take() {
            self.tips.swap_remove(place);
            if let Some(&moved) = self.tips.get(place) {
                self.stations[moved].tip = Some(place);
            }
        }
        if degree != 2 {
            self.vertices -= 1;
            self.knot_ends -= degree;
        }
    }

    pub(super) fn into_graph(self) -> Graph {
        let mut edges = Vec::with_capacity(self.stations.len());
        let mut nodes = Vec::with_capacity(self.stations.len());
        for (index, station) in self.stations.into_iter().enumerate() {
            edges.extend(station.neighbors.iter().map(|&other| [index, other].map(StationId::new)));
            nodes.push(Node {
                id: index as u64,
                parent: station.parent.map(StationId::new),
                position: station.position,
                radius: station.radius,
                active: station.alive && station.neighbors.len() == 1,
                level: station.level,
                section: None,
                name: None,
            });
        }
        Graph::new(nodes, edges)
    }
}

//! Karst caves: the paths of water through rock, as shortest paths over a cost field.
//!
//! Paris, Guérin, Peytavie, Collon, Galin: "Synthesizing Geologically Coherent Cave Networks", Computer Graphics Forum
//! 40(7), 2021; dead ends and retained cycles after KarstNSim (Gouy, Collon, Bailly-Comte, Galin, Antoine, Thebault,
//! Landrein: "KarstNSim", Computers & Geosciences 2024). Points are scattered through the rock, more densely on the
//! inception horizons; an edge between neighbouring points costs less along horizons, along fractures and through permeable
//! rock. Key points (sinks on the highest horizon, springs on the lowest, waypoints) are connected by the cheapest paths, a
//! path is dropped if a detour via a third key point is not much more expensive, and midpoints are displaced so that
//! passages wind.
//!
//! Unlike in the published code, all key points grow simultaneously, so that each meets only its neighbours (Mehlhorn 1988)
//! and the time is nearly linear; edges connect Gabriel neighbours, so that paths hardly cross; the distance to horizons
//! is evaluated for points, not for directions; passages that cross are joined, those without room are dropped, and the
//! others are moved apart.
//!
//! Promised: exactly the asked number of nodes in one component, at most five passages at a node, passages no steeper than
//! asked wherever their ends allow it. Not promised: that no two passages run through each other; half of the caves with
//! 250 nodes have at least one such pair, one above the other within ten metres of a fork.

mod cloud;
mod crossings;
mod crowds;
mod forks;
mod host_rock;
mod network;
mod paths;
mod room;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GenerateError, Generator};
use cloud::Cloud;
use host_rock::HostRock;
use paths::Paths;
use plume_graph::Outside;
use plume_graph::rng::Rng;
use plume_graph::seed;
use plume_graph::{Graph, centreline::CentrelineBuilder};

/// Square metres of the plan per metre of passages, per metre between key points (tuned at the defaults, with a sixth to
/// spare).
const PLAN_PER_LENGTH: f64 = 0.55;
/// Shortest side of the plan, in distances between key points.
const LEAST_SIDE: f64 = 1.6;
/// Share of sinks among the key points.
const SINKS: f64 = 0.4;
/// Number of other key points per spring.
const KEYS_PER_SPRING: usize = 80;
/// Most values in a list setting.
const MOST_VALUES: usize = 64;

/// Settings of the karst generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Karst {
    /// Number of nodes (stations on the centreline).
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Distance between stations in metres; the size of the rock follows from it. If `sinks` or `springs` are given, the
    /// distance is instead chosen so that they are reached.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub station_spacing_m: f64,
    /// Sinks, where water enters: easting and northing in metres, on the highest horizon. None: random.
    pub sinks: Vec<[f64; 2]>,
    /// Springs, where water leaves: easting and northing in metres, on the lowest horizon; the first is the root. None:
    /// random.
    pub springs: Vec<[f64; 2]>,
    /// Mean distance between random key points, in metres.
    #[schemars(range(min = 20.0, max = 200.0))]
    pub key_spacing_m: f64,
    /// Inception horizons: heights of bedding planes that water follows, at the middle of the plan, in metres.
    #[schemars(inner(range(min = -1000.0, max = 1000.0)))]
    pub horizons_m: Vec<f64>,
    /// Dip of all horizons, in degrees.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub dip_deg: f64,
    /// Dip direction of the horizons (azimuth), in degrees.
    #[schemars(range(min = 0.0, max = 360.0))]
    pub dip_azimuth_deg: f64,
    /// Extra cost of a path off the horizons, relative to the cost along them.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub horizon_weight: f64,
    /// Azimuths of the fracture sets, in degrees.
    #[schemars(inner(range(min = 0.0, max = 360.0)))]
    pub fracture_azimuths_deg: Vec<f64>,
    /// Extra cost of a path across the fractures, relative to the cost along them.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub fracture_weight: f64,
    /// Extra cost of a path through tight rock, relative to the cost through permeable rock.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub permeability_weight: f64,
    /// Size of permeable bodies, in metres.
    #[schemars(range(min = 10.0, max = 1000.0))]
    pub permeability_scale_m: f64,
    /// Distance between sample points in the rock, in metres.
    #[schemars(range(min = 8.0, max = 30.0))]
    pub sample_spacing_m: f64,
    /// Exponent of the pruning: the path between two key points is dropped if those via a third one cost less in total, with
    /// all costs raised to this power. 2 is sparse, 1.05 spongework (paper); above that there are few loops.
    #[schemars(range(min = 1.0, max = 10.0))]
    pub gamma: f64,
    /// Probability that a path is kept although the pruning would drop it, for more cycles.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub cycles: f64,
    /// Dead ends per key point.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub dead_ends: f64,
    /// Maximum inclination of the floor of a passage, in degrees.
    #[schemars(range(min = 10.0, max = 45.0))]
    pub slope_max_deg: f64,
    /// Displacement of midpoints relative to the length of their segments: 0 straight, 0.3 winding.
    #[schemars(range(min = 0.0, max = 0.4))]
    pub roughness: f64,
    /// Mean width of a passage, in metres.
    #[schemars(range(min = 1.5, max = 6.0))]
    pub width_m: f64,
    /// Variation of the width along a passage, relative to the mean.
    #[schemars(range(min = 0.0, max = 0.8))]
    pub width_variation: f64,
    /// Height of a passage relative to its width.
    #[schemars(range(min = 0.3, max = 1.5))]
    pub height_ratio: f64,
}

impl Default for Karst {
    fn default() -> Self {
        Self {
            nodes: 200,
            station_spacing_m: 4.0,
            sinks: Vec::new(),
            springs: Vec::new(),
            key_spacing_m: 50.0,
            horizons_m: vec![0.0, -12.0, -26.0],
            dip_deg: 2.0,
            dip_azimuth_deg: 120.0,
            horizon_weight: 2.0,
            fracture_azimuths_deg: vec![25.0, 100.0],
            fracture_weight: 4.0,
            permeability_weight: 1.0,
            permeability_scale_m: 60.0,
            sample_spacing_m: 10.0,
            gamma: 1.5,
            cycles: 0.0,
            dead_ends: 1.5,
            slope_max_deg: 20.0,
            roughness: 0.22,
            width_m: 3.0,
            width_variation: 0.4,
            height_ratio: 0.9,
        }
    }
}

impl Generator for Karst {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        self.check()?;
        self.fitted(self.drawn(seed))
    }
}

impl Karst {
    fn check(&self) -> Result<(), GenerateError> {
        let wrong = |key: &str, what: &str, hint: &str| GenerateError::new(format!("`{key}` {what}"), hint);
        if self.horizons_m.is_empty() || self.horizons_m.iter().any(|height| !(-200.0..=200.0).contains(height)) {
            return Err(wrong(
                "horizons_m",
                "has no heights for water to follow",
                "give at least one, from -200 to 200",
            ));
        }
        if self.fracture_azimuths_deg.iter().any(|azimuth| !(0.0..=360.0).contains(azimuth)) {
            return Err(wrong(
                "fracture_azimuths_deg",
                "contains a value that is not an azimuth",
                "azimuths are 0 to 360 degrees",
            ));
        }
        if self.horizons_m.len().max(self.fracture_azimuths_deg.len()) > MOST_VALUES {
            return Err(wrong("horizons_m", "and `fracture_azimuths_deg` are too long", "give at most 64 of each"));
        }
        let reach_m = 0.5 * self.side_m();
        for (key, points) in [("sinks", &self.sinks), ("springs", &self.springs)] {
            if !points.iter().flatten().all(|at| at.abs() <= reach_m) {
                let hint =
                    format!("with {} nodes the rock extends {reach_m:.0} m each way from the middle", self.nodes);
                return Err(wrong(key, "contains a point outside the rock", &hint));
            }
            if points.len() > self.nodes as usize {
                return Err(wrong(key, "contains more points than there are nodes", "ask for more nodes"));
            }
        }
        Ok(())
    }

    /// All passages of the rock, slightly more than are needed.
    fn drawn(&self, seed: u64) -> CentrelineBuilder {
        let mut rng = Rng::new(seed::stream(seed, "karst", 0));
        let rock = HostRock::new(self, &mut rng);
        let side_m = self.side_m();
        let cloud = Cloud::scatter(self, &rock, side_m, &mut rng);
        let keys = self.keys(&rock, &cloud, side_m, &mut rng);
        let used = Paths::between(&keys, &cloud, &rock).network(self, &cloud, &rock, &mut rng);
        network::drawn(self, &rock, &cloud, &used, &keys, &mut rng)
    }

    /// Side of the plan.
    fn side_m(&self) -> f64 {
        let length_m = f64::from(self.nodes) * self.station_spacing_m;
        (length_m * self.key_spacing_m * PLAN_PER_LENGTH).sqrt().max(LEAST_SIDE * self.key_spacing_m)
    }

    /// Samples next to the key points, each once, a spring first.
    fn keys(&self, rock: &HostRock, cloud: &Cloud, side_m: f64, rng: &mut Rng) -> Vec<usize> {
        let count = ((side_m / self.key_spacing_m) * (side_m / self.key_spacing_m)).ceil().max(2.0) as usize;
        let mut drawn = |edge: f64| [0, 1].map(|_| rng.between(-0.5, 0.5) * side_m * edge);
        let springs = or_drawn(&self.springs, count.div_ceil(KEYS_PER_SPRING), || rock.down_dip(drawn(1.0), side_m));
        let sinks = or_drawn(&self.sinks, (count as f64 * SINKS) as usize, || drawn(1.0));
        let waypoints = count.saturating_sub(springs.len() + sinks.len());
        let waypoints: Vec<[f64; 2]> = (0..waypoints).map(|_| drawn(1.0)).collect();
        let [low, high] = rock.extremes();
        let mut keys: Vec<usize> = springs.iter().map(|&at| cloud.nearest(at, low)).collect();
        keys.extend(sinks.iter().map(|&at| cloud.nearest(at, high)));
        keys.extend(waypoints.into_iter().map(|at| cloud.nearest(at, rock.some_horizon(rng))));
        let mut seen = rustc_hash::FxHashSet::default();
        keys.retain(|&key| seen.insert(key));
        keys
    }

    /// A graph of the asked number of nodes: what is near the root, or everything if key points are given.
    fn fitted(&self, centreline: CentrelineBuilder) -> Result<Graph, GenerateError> {
        let is_drawn = self.sinks.is_empty() && self.springs.is_empty();
        let most_m = if is_drawn { f64::from(self.nodes) * self.station_spacing_m } else { f64::INFINITY };
        let slope_max = libm::tan(self.slope_max_deg.to_radians());
        let cut = centreline.cut_to(most_m).without_spurs();
        cut.with_nodes(self.nodes as usize, slope_max).ok_or_else(|| {
            GenerateError::new(
                format!("found no passages with {} nodes in this rock", self.nodes),
                "increase `slope_max_deg`, or reduce `sample_spacing_m` or the distances between `horizons_m`",
            )
        })
    }
}

/// The given points, or this many random ones.
fn or_drawn(given: &[[f64; 2]], count: usize, mut draw: impl FnMut() -> [f64; 2]) -> Vec<[f64; 2]> {
    if given.is_empty() { (0..count).map(|_| draw()).collect() } else { given.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plume_graph::clearance::{PassageSize, thin_rock};
    use plume_graph::{NoOutside, StationId};

    fn graphs(settings: Karst) -> impl Iterator<Item = Graph> {
        (0..6).map(move |seed| settings.generate(seed, &NoOutside).expect("the rock has ways"))
    }

    #[test]
    fn passages_follow_the_horizons_and_the_fractures() {
        let off = |horizon_weight: f64| {
            let settings = Karst { horizon_weight, dip_deg: 0.0, ..Karst::default() };
            let away = |z: f64| {
                [0.0, -12.0, -26.0].map(|horizon: f64| (z - horizon).abs()).into_iter().fold(f64::MAX, f64::min)
            };
            graphs(settings).flat_map(|graph| graph.nodes).map(|node| away(node.position.z)).sum::<f64>()
        };
        assert!(off(6.0) < 0.8 * off(0.0));
        let across = |fracture_weight: f64| {
            let settings =
                Karst { fracture_weight, fracture_azimuths_deg: vec![0.0, 90.0], roughness: 0.0, ..Karst::default() };
            let sine = |graph: Graph| {
                let way = |&[a, b]: &[StationId; 2]| (graph[b].position - graph[a].position).xy();
                graph.edges.iter().map(way).map(|way| way.x.abs().min(way.y.abs())).sum::<f64>() / graph.length_m()
            };
            graphs(settings).map(sine).sum::<f64>()
        };
        let [with, without] = [8.0, 0.0].map(across);
        assert!(with < 0.9 * without, "{with} {without}");
    }

    #[test]
    fn a_low_gamma_makes_spongework() {
        let loops = |gamma: f64| {
            graphs(Karst { gamma, nodes: 800, ..Karst::default() }).map(|graph| graph.loops()).sum::<usize>()
        };
        let [many, few] = [1.05, 4.0].map(loops);
        assert!(many > few + few / 4, "{many} {few}");
    }

    #[test]
    fn given_springs_and_sinks_are_reached() {
        let settings =
            Karst { springs: vec![[60.0, 0.0]], sinks: vec![[-50.0, 40.0], [-40.0, -50.0]], ..Karst::default() };
        for graph in graphs(settings.clone()) {
            let from = |[x, y]: [f64; 2]| {
                move |node: &plume_graph::Node| libm::hypot(node.position.x - x, node.position.y - y)
            };
            assert!(from([60.0, 0.0])(&graph.nodes[0]) < 15.0);
            for sink in &settings.sinks {
                assert!(graph.nodes.iter().map(from(*sink)).fold(f64::MAX, f64::min) < 20.0);
            }
        }
        let outside = Karst { sinks: vec![[1e6, 0.0]], ..Karst::default() };
        assert!(outside.generate(1, &NoOutside).is_err());
    }

    #[test]
    fn hardly_two_passages_run_through_each_other() {
        let through = |graph: Graph| thin_rock(&graph, PassageSize::default(), 0.0).len();
        let counts: Vec<usize> = graphs(Karst { nodes: 250, ..Karst::default() }).map(through).collect();
        // Without the measures against it there would be eighty.
        assert!(counts.iter().sum::<usize>() <= 6, "{counts:?}");
    }
}

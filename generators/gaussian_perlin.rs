//! The generator of the PLUME paper, extended until its graphs have the statistics of real caves.
//!
//! Garcia, Richard, Olivares-Mendez: "PLUME: Procedural Layer Underground Modeling Engine", 2025. From the paper: an
//! origin node; round each node a circle of 360 sections, its radius the reach to the next node; a wrapped Gaussian and
//! a Perlin term over the sections; an arc behind without children; several children; branches that die; bounds; one
//! or several layers. Added here: log-normal branch lengths, two preferred azimuths, a clearance law, lawful loops,
//! relief, and a gate that grows the graph anew until its metrics lie inside the range of real caves (Collon et al.
//! 2017, see [`realism`](plume_graph::realism)).
//!
//! Promised: exactly the asked number of nodes, one component, at most four passages at a node, no passage through
//! another (see `clearance` for what that means). Not promised: that the gate is passed. With default settings it was
//! for 100 of 100 seeds at 50 and at 250 nodes, in one layer and in three. Settings far from the defaults, fewer than
//! 25 nodes (where it is not asked) or more than 20 000 (where it would cost too much) may fall outside; the graph
//! that came nearest is then given.

mod branches;
mod cave;
mod circle;
mod clearance;
mod grid;
mod growth;
mod hops;
mod layers;
mod lengths;
mod links;
mod loops;
mod step;
mod tuning;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GenerateError, Generator};
use growth::Shortfall;
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::realism::{LEAST_STATIONS, Metrics};
use plume_graph::rng::Rng;
use plume_graph::seed;

/// More nodes than this are not measured: betweenness takes the square of their number.
const GATE_TO: u32 = 20_000;
/// Nodes that all attempts together may place, which bounds the time a graph takes.
const EFFORT: u32 = 60_000;
/// Attempts, fewest and most.
const ATTEMPTS: [u32; 2] = [4, 400];
/// Held back from each end of a range, so that whoever measures the graph elsewhere agrees.
const INSET: f64 = 0.002;
/// Part of the attempts that may run out of room before the settings are found too tight, as a divisor.
const CROWDED: u32 = 16;

/// How the direction of the next passage is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// By a wrapped Gaussian round the direction of travel.
    Gaussian,
    /// By Perlin noise over the circle, without memory of the direction of travel.
    Perlin,
    /// By both, in the parts that `perlin_weight` sets.
    #[default]
    Hybrid,
}

/// Settings of the Gaussian-Perlin generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct GaussianPerlin {
    /// Number of nodes (stations on the centreline). 50 nodes make about 200 m of passage. From the paper.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Number of layers, one below the other, joined by ramps. From the paper.
    #[schemars(range(min = 1, max = 20))]
    pub layers: u32,
    /// Vertical distance between layers, in metres.
    #[schemars(range(min = 4.0, max = 40.0))]
    pub layer_spacing_m: f64,
    /// Number of links between each pair of neighbouring layers. 1 is the way down, beside which loops may join layers;
    /// more are counted, and then nothing else joins layers.
    #[schemars(range(min = 1, max = 20))]
    pub links: u32,
    /// Least distance in the plan between the heads of two links of a pair of layers, and between their feet, in metres.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub link_spacing_m: f64,
    /// Least inclination of a passage between layers, in degrees; 0 leaves it to the walk.
    #[schemars(range(min = 0.0, max = 90.0))]
    pub ramp_min_deg: f64,
    /// Greatest inclination of a passage between layers, in degrees: the paper's interconnection angle. 90 sinks shafts.
    #[schemars(range(min = 5.0, max = 90.0))]
    pub ramp_max_deg: f64,
    /// Greatest inclination of any other passage, in degrees.
    #[schemars(range(min = 2.0, max = 45.0))]
    pub max_slope_deg: f64,
    /// Least radius of a node, which is its distance to the next one, in metres. From the paper.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub reach_min_m: f64,
    /// Greatest radius of a node, in metres. From the paper.
    #[schemars(range(min = 1.5, max = 40.0))]
    pub reach_max_m: f64,
    /// Least number of branches that go on where a main branch ends. From the paper.
    #[schemars(range(min = 1, max = 3))]
    pub children_min: u32,
    /// Greatest number of branches that go on where a branch ends. From the paper.
    #[schemars(range(min = 1, max = 3))]
    pub children_max: u32,
    /// How directions are drawn: `gaussian`, `perlin`, or `hybrid` for both. From the paper.
    pub distribution: Distribution,
    /// Spread of the Gaussian round the direction of travel, in degrees: small is straight, large is winding.
    #[schemars(range(min = 5.0, max = 120.0))]
    pub sigma_deg: f64,
    /// Part of the Perlin term in the hybrid distribution, 0 to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub perlin_weight: f64,
    /// Arc behind a node in which nothing grows, in degrees. From the paper.
    #[schemars(range(min = 110.0, max = 240.0))]
    pub forbidden_deg: f64,
    /// How many loops are closed: 0 for none, 1 for as many as in real caves.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub loop_closure: f64,
    /// Slow rise and fall of the floor, as the standard height of its hills in metres; 0 is level.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub relief_m: f64,
    /// Enlarges the finished cave, its passages included; the other lengths here are those before, the bounds those
    /// after.
    #[schemars(range(min = 0.25, max = 20.0))]
    pub scale: f64,
    /// Length of the ground the cave may cover, centred on its origin, in metres; 0 is as much as it needs.
    #[schemars(range(min = 0.0, max = 100_000.0))]
    pub bounds_x_m: f64,
    /// Width of the ground the cave may cover, likewise.
    #[schemars(range(min = 0.0, max = 100_000.0))]
    pub bounds_y_m: f64,
}

impl Default for GaussianPerlin {
    fn default() -> Self {
        Self {
            nodes: 50,
            layers: 1,
            layer_spacing_m: 7.5,
            links: 1,
            link_spacing_m: 10.0,
            ramp_min_deg: 0.0,
            ramp_max_deg: 28.0,
            max_slope_deg: 20.0,
            reach_min_m: 1.5,
            reach_max_m: 6.0,
            children_min: 2,
            children_max: 3,
            distribution: Distribution::Hybrid,
            sigma_deg: 34.0,
            perlin_weight: 0.15,
            forbidden_deg: 150.0,
            loop_closure: 1.0,
            relief_m: 2.4,
            scale: 1.0,
            bounds_x_m: 0.0,
            bounds_y_m: 0.0,
        }
    }
}

impl Generator for GaussianPerlin {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        self.check()?;
        let graph = self.best(seed)?;
        Ok(graph.scaled(self.scale))
    }
}

impl GaussianPerlin {
    /// The first attempt that passes the gate, or the one that came nearest to it.
    fn best(&self, seed: u64) -> Result<Graph, GenerateError> {
        let gated = (LEAST_STATIONS as u32..=GATE_TO).contains(&self.nodes);
        let attempts = (EFFORT / self.nodes).clamp(ATTEMPTS[0], ATTEMPTS[1]);
        let mut best: Option<(f64, Graph)> = None;
        let mut most = Shortfall::default();
        for attempt in 0..attempts {
            let graph = match self.attempt(seed, attempt) {
                Ok(graph) if gated => graph,
                Ok(graph) => return Ok(graph),
                Err(shortfall) => {
                    most = shortfall.max(most);
                    if best.is_none() && attempt > attempts / CROWDED {
                        break;
                    }
                    continue;
                }
            };
            let metrics = Metrics::of(&graph);
            if metrics.is_some_and(|metrics| metrics.realism(INSET).is_real()) {
                return Ok(graph);
            }
            let distance = metrics.map_or(f64::INFINITY, |metrics| metrics.distance());
            if best.as_ref().is_none_or(|(least, _)| distance < *least) {
                best = Some((distance, graph));
            }
        }
        let best = best.map(|(_, graph)| graph);
        best.ok_or_else(|| self.too_tight(most))
    }

    /// Grows one graph.
    fn attempt(&self, seed: u64, attempt: u32) -> Result<Graph, Shortfall> {
        let stream = seed::stream(seed, "graph", u64::from(attempt));
        growth::grow(self, Rng::new(stream))
    }

    /// Relations between settings.
    fn check(&self) -> Result<(), GenerateError> {
        if self.reach_min_m > self.reach_max_m {
            return Err(GenerateError::new(
                format!("`reach_min_m` is {} but `reach_max_m` is {}", self.reach_min_m, self.reach_max_m),
                "the least radius may not exceed the greatest".to_owned(),
            ));
        }
        if self.ramp_min_deg > self.ramp_max_deg {
            return Err(GenerateError::new(
                format!("`ramp_min_deg` is {} but `ramp_max_deg` is {}", self.ramp_min_deg, self.ramp_max_deg),
                "the least inclination may not exceed the greatest".to_owned(),
            ));
        }
        if self.children_min > self.children_max {
            return Err(GenerateError::new(
                format!("`children_min` is {} but `children_max` is {}", self.children_min, self.children_max),
                "the least number of children may not exceed the greatest".to_owned(),
            ));
        }
        Ok(())
    }

    fn too_tight(&self, Shortfall { placed, links }: Shortfall) -> GenerateError {
        let asked = (self.links * (self.layers - 1)) as usize;
        if self.has_links() && placed >= self.nodes as usize && links < asked {
            return GenerateError::new(
                format!("{links} of {asked} links between {} layers found room", self.layers),
                "ask for fewer by `links`, lower `link_spacing_m`, widen the range from `ramp_min_deg` to `ramp_max_deg`, or \
                 ask for more nodes",
            );
        }
        let layers = if self.layers > 1 { format!(" in {} layers", self.layers) } else { String::new() };
        GenerateError::new(
            format!("no room for {} nodes{layers}", self.nodes),
            format!(
                "{placed} nodes were placed; widen the bounds, shorten `reach_max_m`, or ask for fewer {}",
                if self.layers > 1 { "nodes or layers" } else { "nodes" }
            ),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The walk itself, not the choice among walks, is what makes caves real.
    #[test]
    fn enough_caves_pass_the_gate_on_the_first_try() {
        for (nodes, percent) in [(50, 15), (250, 70)] {
            let settings = GaussianPerlin { nodes, ..Default::default() };
            let passed = (0..100)
                .filter_map(|seed| settings.attempt(seed, 0).ok())
                .filter_map(|graph| Metrics::of(&graph))
                .filter(|metrics| metrics.realism(INSET).is_real())
                .count();
            assert!(passed >= percent, "{nodes} nodes: {passed} of 100");
        }
    }

    #[test]
    fn an_attempt_does_not_depend_on_the_one_before() {
        let settings = GaussianPerlin::default();
        let third = settings.attempt(5, 3);
        assert_eq!(settings.attempt(5, 3), third);
        assert_ne!(settings.attempt(5, 2), third);
    }
}

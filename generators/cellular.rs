//! Caves from cellular automata: cells filled at random, then smoothed into chambers and passages.
//!
//! Johnson, Yannakakis, Togelius: "Cellular automata for real-time generation of infinite cave levels", 2010. Each layer
//! is a separate plan of cells. A cell becomes rock if enough of its neighbourhood is, for a few iterations; small pockets
//! and pillars are removed, the remaining regions are joined by corridors, and the medial axes of the open space are the
//! passages, as wide as the space is there. Layers are below each other; a ramp outside of both leads down.
//!
//! Promised: exactly the asked number of nodes in one component, at most five passages at a node, floors of a layer and
//! ramps within their maximum inclination. Not promised: the statistics of real caves; passages are short and meet often.

mod automaton;
mod layers;

use nalgebra::Point3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GenerateError, Generator};
use crate::perlin::Perlin;
use crate::raster::{self, Mask};
use plume_graph::Outside;
use plume_graph::centreline::{CentrelineBuilder, Vertex};
use plume_graph::rng::Rng;
use plume_graph::seed;
use plume_graph::{Graph, Section, Shape};

/// Cells of the plan per cell of length of its medial axes (tuned at the default fill), with some to spare.
const PLAN_PER_LENGTH: f64 = 14.0;
/// Fewest cells along a side.
const LEAST_SIDE: usize = 32;
/// Ratio of length to height of the relief: no floor is steeper than about 9 degrees.
const RELIEF_LENGTH: f64 = 12.0;
/// Shortest hills, in metres.
const RELIEF_LEAST_M: f64 = 40.0;

/// Settings of the cellular generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Cellular {
    /// Number of nodes (stations on the centreline).
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Distance between stations in metres; the size of the plan follows from it.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub station_spacing_m: f64,
    /// Number of layers, one below another.
    #[schemars(range(min = 1, max = 20))]
    pub layers: u32,
    /// Vertical distance between layers, in metres.
    #[schemars(range(min = 4.0, max = 100.0))]
    pub layer_spacing_m: f64,
    /// Maximum inclination of floors and of the ramps between layers, in degrees.
    #[schemars(range(min = 3.0, max = 30.0))]
    pub ramp_max_deg: f64,
    /// Size of a cell in metres.
    #[schemars(range(min = 0.5, max = 5.0))]
    pub cell_m: f64,
    /// Initial share of rock cells; 0.5 in the paper.
    #[schemars(range(min = 0.3, max = 0.6))]
    pub fill: f64,
    /// Number of iterations of the automaton; 4 in the paper.
    #[schemars(range(min = 1, max = 20))]
    pub iterations: u32,
    /// A cell becomes rock if at least this many of the nine cells of its Moore neighbourhood are; 5 in the paper.
    #[schemars(range(min = 4, max = 6))]
    pub rock_neighbours: u8,
    /// Open regions smaller than this are filled, in square metres.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub pocket_min_m2: f64,
    /// Pillars smaller than this are removed, in square metres; there is no room for them between stations.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub pillar_min_m2: f64,
    /// Width of the corridors that join regions, and of ramps, in metres; no passage is narrower.
    #[schemars(range(min = 1.0, max = 6.0))]
    pub width_min_m: f64,
    /// Maximum width of a passage, in metres.
    #[schemars(range(min = 2.0, max = 20.0))]
    pub width_max_m: f64,
    /// Height of a passage relative to its width.
    #[schemars(range(min = 0.3, max = 2.0))]
    pub height_ratio: f64,
    /// Maximum height of a passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub height_max_m: f64,
    /// Height of the relief that all layers follow, in metres.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub relief_m: f64,
}

impl Default for Cellular {
    fn default() -> Self {
        Self {
            nodes: 200,
            station_spacing_m: 4.0,
            layers: 1,
            layer_spacing_m: 10.0,
            ramp_max_deg: 15.0,
            cell_m: 1.0,
            fill: 0.47,
            iterations: 5,
            rock_neighbours: 5,
            pocket_min_m2: 40.0,
            pillar_min_m2: 30.0,
            width_min_m: 2.0,
            width_max_m: 7.0,
            height_ratio: 0.7,
            height_max_m: 3.5,
            relief_m: 2.0,
        }
    }
}

impl Generator for Cellular {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        self.check()?;
        let relief = Relief::new(self, &mut Rng::new(seed::stream(seed, "cellular relief", 0)));
        let length_m = f64::from(self.nodes) * self.station_spacing_m / f64::from(self.layers);
        let layers = (0..self.layers).map(|level| {
            let mask = self.plan(length_m, Rng::new(seed::stream(seed, "cellular", u64::from(level))));
            let centreline = raster::traced(&mask, self.cell_m).rooted_in_the_middle();
            self.shaped(centreline.cut_to(length_m).without_spurs(), level, &relief)
        });
        let centreline = layers::joined(self, layers.collect());
        let slope_max = libm::tan(self.ramp_max_deg.to_radians());
        centreline.with_nodes(self.nodes as usize, slope_max).ok_or_else(|| self.no_room())
    }
}

impl Cellular {
    /// Relations between settings.
    fn check(&self) -> Result<(), GenerateError> {
        if self.width_max_m < self.width_min_m {
            return Err(GenerateError::new(
                format!("`width_max_m` is {} m, under `width_min_m`", self.width_max_m),
                format!("it must be at least {} m", self.width_min_m),
            ));
        }
        let least = 1.5 * self.height_max_m;
        if self.layers > 1 && self.layer_spacing_m < least {
            return Err(GenerateError::new(
                format!("`layer_spacing_m` is {} m, which leaves no rock between layers", self.layer_spacing_m),
                format!("it must be at least {least} m for passages of this `height_max_m`"),
            ));
        }
        if self.layers > 1 && self.nodes < layers::LEAST_NODES * self.layers {
            return Err(self.no_room());
        }
        Ok(())
    }

    fn no_room(&self) -> GenerateError {
        GenerateError::new(
            format!("no room for {} layers in {} nodes", self.layers, self.nodes),
            format!("ask for at least {} nodes per layer, or for fewer layers", layers::LEAST_NODES),
        )
    }

    /// The open cells of a layer with about this length of passages, as one region.
    fn plan(&self, length_m: f64, mut rng: Rng) -> Mask {
        let cells = length_m / self.cell_m * PLAN_PER_LENGTH;
        let side = LEAST_SIDE.max(cells.sqrt().ceil() as usize);
        let mut mask = automaton::filled(side, self.fill, &mut rng);
        for _ in 0..self.iterations {
            automaton::step(&mut mask, self.rock_neighbours);
        }
        let cells = |area_m2: f64| (area_m2 / (self.cell_m * self.cell_m)).ceil() as usize;
        let half_width = (0.5 * self.width_min_m / self.cell_m).round() as usize;
        let mut mask = raster::without_pockets(mask, cells(self.pocket_min_m2));
        // A line needs two cells, so a layer of solid rock gets them.
        mask.dig([side / 2, side / 2], half_width.max(2));
        raster::without_pillars(raster::joined(mask, half_width), cells(self.pillar_min_m2))
    }

    /// The passages of a layer at their elevation, with widths and heights limited by the settings.
    fn shaped(&self, mut centreline: CentrelineBuilder, level: u32, relief: &Relief) -> CentrelineBuilder {
        for vertex in &mut centreline.vertices {
            let width_m = vertex.section.map_or(0.0, |section| section.width_m);
            *vertex = self.vertex(relief.at(vertex.position, level), width_m, level);
        }
        centreline
    }

    fn vertex(&self, position: Point3<f64>, width_m: f64, level: u32) -> Vertex {
        let width_m = width_m.clamp(self.width_min_m, self.width_max_m);
        let height_m = (width_m * self.height_ratio).min(self.height_max_m);
        Vertex { position, section: Some(Section { width_m, height_m, shape: Shape::Cave }), level }
    }
}

/// The relief that all layers follow, so that the rock between two of them has the same thickness everywhere.
struct Relief {
    noise: Perlin,
    height_m: f64,
    length_m: f64,
    spacing_m: f64,
}

impl Relief {
    fn new(settings: &Cellular, rng: &mut Rng) -> Self {
        Self {
            noise: Perlin::new(rng),
            height_m: settings.relief_m,
            length_m: (RELIEF_LENGTH * settings.relief_m).max(RELIEF_LEAST_M),
            spacing_m: settings.layer_spacing_m,
        }
    }

    fn at(&self, place: Point3<f64>, level: u32) -> Point3<f64> {
        let height = self.height_m * self.noise.at(place.x / self.length_m, place.y / self.length_m);
        Point3::new(place.x, place.y, height - self.spacing_m * f64::from(level))
    }
}

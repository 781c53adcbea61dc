//! Caves by cellular automata: cells filled at random, and rock that keeps to itself.
//!
//! Johnson, Yannakakis, Togelius: "Cellular automata for real-time generation of infinite cave levels", 2010. Each layer
//! is a plan of cells of its own. A cell becomes rock when enough of its neighbourhood is, a few times over; small pockets
//! and pillars go, regions that are left are joined by corridors, and the middle lines of what is open are the passages,
//! as wide as the open part is there. Layers lie one below the other; a ramp outside of both leads down.
//!
//! Promised: exactly the asked number of nodes in one component, at most five passages at a node, floors of a layer and
//! ramps under their greatest inclination. Not promised: the statistics of real caves; passages are short and meet often.

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

/// Cells of plan for each cell of length of its middle lines (tuned at the default fill), and more to be cut from.
const PLAN_PER_LENGTH: f64 = 14.0;
/// Fewest cells along a side.
const LEAST_SIDE: usize = 32;
/// Relief is so much longer than high that no floor is steeper than about 9 degrees.
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
    /// Distance between stations in metres; the plan is as large as that takes.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub station_spacing_m: f64,
    /// Number of layers, one below the other.
    #[schemars(range(min = 1, max = 20))]
    pub layers: u32,
    /// Vertical distance between layers, in metres.
    #[schemars(range(min = 4.0, max = 100.0))]
    pub layer_spacing_m: f64,
    /// Greatest inclination of floors and of the ramps between layers, in degrees.
    #[schemars(range(min = 3.0, max = 30.0))]
    pub ramp_max_deg: f64,
    /// Side of a cell in metres.
    #[schemars(range(min = 0.5, max = 5.0))]
    pub cell_m: f64,
    /// Part of the cells that are rock at first; the paper has 0.5.
    #[schemars(range(min = 0.3, max = 0.6))]
    pub fill: f64,
    /// How often every cell looks round; the paper has 4.
    #[schemars(range(min = 1, max = 20))]
    pub iterations: u32,
    /// A cell is rock when this many of the nine cells in its Moore neighbourhood, itself included, are; the paper has 5.
    #[schemars(range(min = 4, max = 6))]
    pub rock_neighbours: u8,
    /// Open regions smaller than this are filled, in square metres.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub pocket_min_m2: f64,
    /// Pillars smaller than this are taken out, in square metres; smaller ones have no room between stations.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub pillar_min_m2: f64,
    /// Width of the corridors that join regions, and of ramps; no passage is narrower. In metres.
    #[schemars(range(min = 1.0, max = 6.0))]
    pub width_min_m: f64,
    /// Greatest width of a passage, in metres.
    #[schemars(range(min = 2.0, max = 20.0))]
    pub width_max_m: f64,
    /// Height of a passage in units of its width.
    #[schemars(range(min = 0.3, max = 2.0))]
    pub height_ratio: f64,
    /// Greatest height of a passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub height_max_m: f64,
    /// Height of the hills and hollows that every layer follows, in metres.
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
                format!("it takes at least {} m", self.width_min_m),
            ));
        }
        let least = 1.5 * self.height_max_m;
        if self.layers > 1 && self.layer_spacing_m < least {
            return Err(GenerateError::new(
                format!("`layer_spacing_m` is {} m, which leaves no rock between layers", self.layer_spacing_m),
                format!("it takes at least {least} m for passages of this `height_max_m`"),
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
            format!("ask for {} nodes a layer or more, or for fewer layers", layers::LEAST_NODES),
        )
    }

    /// The open cells of a layer whose passages are about so long: one region.
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
        // A line needs two cells, and a layer that is all rock gets them.
        mask.dig([side / 2, side / 2], half_width.max(2));
        raster::without_pillars(raster::joined(mask, half_width), cells(self.pillar_min_m2))
    }

    /// The passages of a layer at their height, no wider and no higher than the settings allow.
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

/// The hills and hollows that all layers follow, so that the rock between two of them is as thick everywhere.
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

//! Tunnels assembled from tiles, like the worlds of the DARPA Subterranean Challenge.
//!
//! The tile set is that of its circuits (straight, bend, junctions, room, dead end, ramp, shaft) on a square grid, but each
//! tile is parametric: it has connectors, with a position, a direction and a width, and its passages wind between them, so
//! that no two are alike. Tiles are added at open connectors, unless they would overlap another tile or block a connector.
//! Connectors that meet close a loop, those that lead nowhere are capped.
//!
//! Promised: exactly the asked number of nodes in one component, at most four passages at a node, ramps and floors within
//! their maximum inclination, a connector wherever a passage enters the next tile.

mod board;
mod drawing;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::mine::Access;
use super::{GenerateError, Generator};
use board::Board;
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::rng::Rng;
use plume_graph::seed;

/// Nodes of a level in addition to the way down to the next one.
const LEAST_NODES: u32 = 8;
/// Inclination of ramps relative to the maximum; stations that cut their corners make them steeper.
const GENTLER: f64 = 0.9;

/// Settings of the tile generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Tiles {
    /// Number of nodes (stations on the centreline).
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Distance between stations in metres; the number of tiles follows from it.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub station_spacing_m: f64,
    /// Size of a tile, in metres; 20 in the challenge.
    #[schemars(range(min = 6.0, max = 60.0))]
    pub pitch_m: f64,
    /// Number of levels, one below another.
    #[schemars(range(min = 1, max = 20))]
    pub levels: u32,
    /// Vertical distance between levels, in metres.
    #[schemars(range(min = 5.0, max = 50.0))]
    pub level_spacing_m: f64,
    /// What joins the levels: `ramp` or `shaft`.
    pub access: Access,
    /// Number of ways down from each level, as far as there is room.
    #[schemars(range(min = 1, max = 20))]
    pub links: u32,
    /// Maximum inclination of a ramp, in degrees.
    #[schemars(range(min = 5.0, max = 30.0))]
    pub ramp_max_deg: f64,
    /// Weight of straight tiles; tiles are drawn at random by weight.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub straights: f64,
    /// Weight of bends.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub bends: f64,
    /// Weight of junctions of three passages.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub tees: f64,
    /// Weight of junctions of four passages.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub crosses: f64,
    /// Weight of rooms.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub rooms: f64,
    /// Weight of dead ends.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub dead_ends: f64,
    /// Probability that an open connector facing a new tile is joined to it, which closes a loop.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub loop_closure: f64,
    /// Minimum width of a connector, in metres.
    #[schemars(range(min = 1.5, max = 10.0))]
    pub width_min_m: f64,
    /// Maximum width of a connector, in metres; at most half a tile.
    #[schemars(range(min = 1.5, max = 10.0))]
    pub width_max_m: f64,
    /// Width of a room, in metres; at most nine tenths of a tile.
    #[schemars(range(min = 2.0, max = 30.0))]
    pub room_width_m: f64,
    /// Height of passages and rooms, in metres.
    #[schemars(range(min = 1.5, max = 15.0))]
    pub height_m: f64,
    /// Maximum offset of the middle of a tile, relative to its size.
    #[schemars(range(min = 0.0, max = 0.15))]
    pub wobble: f64,
}

impl Default for Tiles {
    fn default() -> Self {
        Self {
            nodes: 200,
            station_spacing_m: 4.0,
            pitch_m: 14.0,
            levels: 1,
            level_spacing_m: 9.0,
            access: Access::Ramp,
            links: 1,
            ramp_max_deg: 15.0,
            straights: 4.0,
            bends: 3.0,
            tees: 2.2,
            crosses: 0.6,
            rooms: 0.8,
            dead_ends: 0.6,
            loop_closure: 0.4,
            width_min_m: 3.0,
            width_max_m: 4.5,
            room_width_m: 9.0,
            height_m: 3.2,
            wobble: 0.1,
        }
    }
}

impl Generator for Tiles {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        self.check()?;
        let board = self.grown(Rng::new(seed::stream(seed, "tiles", 0)))?;
        let centreline = drawing::drawn(self, &board, &mut Rng::new(seed::stream(seed, "tiles drawing", 0)));
        let slope_max = match self.access {
            Access::Ramp => libm::tan(self.ramp_max_deg.to_radians()),
            Access::Shaft => f64::INFINITY,
        };
        centreline.with_nodes(self.nodes as usize, slope_max).ok_or_else(|| self.no_room())
    }
}

impl Tiles {
    /// Relations between settings.
    fn check(&self) -> Result<(), GenerateError> {
        let over = |name: &str, found: f64, most: f64, why: &str| {
            (found > most).then(|| {
                GenerateError::new(
                    format!("`{name}` is {found} m, {why}"),
                    format!("it must be at most {most} m with these tiles"),
                )
            })
        };
        let fault = over("width_max_m", self.width_max_m, 0.5 * self.pitch_m, "which leaves no rock between tiles")
            .or_else(|| over("width_min_m", self.width_min_m, self.width_max_m, "which is more than `width_max_m`"))
            .or_else(|| over("room_width_m", self.room_width_m, 0.9 * self.pitch_m, "which is more than a tile"))
            .or_else(|| match self.levels {
                1 => None,
                _ => over("height_m", self.height_m, self.level_spacing_m / 1.5, "which leaves no rock between levels"),
            });
        if let Some(fault) = fault {
            return Err(fault);
        }
        if [self.straights, self.bends, self.tees, self.crosses, self.rooms].iter().all(|&weight| weight <= 0.0) {
            let message = "all tiles with several connectors have the weight 0";
            return Err(GenerateError::new(message, "raise `straights`, `bends`, `tees`, `crosses` or `rooms`"));
        }
        let stations = (self.link_length_m() / self.station_spacing_m).ceil() as u32;
        if self.levels > 1 && self.nodes < self.levels * (LEAST_NODES + stations) {
            return Err(self.no_room());
        }
        Ok(())
    }

    fn no_room(&self) -> GenerateError {
        GenerateError::new(
            format!("no room for {} levels in {} nodes", self.levels, self.nodes),
            "ask for more nodes, fewer levels, a larger `station_spacing_m` or a steeper `ramp_max_deg`",
        )
    }

    /// Number of tiles in a row covered by a way down.
    fn link_tiles(&self) -> usize {
        match self.access {
            Access::Ramp => {
                let slope = GENTLER * libm::tan(self.ramp_max_deg.to_radians());
                (self.level_spacing_m / (slope * self.pitch_m)).ceil() as usize
            }
            Access::Shaft => 1,
        }
    }

    fn link_length_m(&self) -> f64 {
        self.link_tiles() as f64 * self.pitch_m
    }

    /// Levels from the top down, each with its share of the length, followed by the ways to the next one.
    fn grown(&self, mut rng: Rng) -> Result<Board, GenerateError> {
        let tiles = f64::from(self.nodes) * self.station_spacing_m / self.pitch_m;
        let mut board = Board::new(self, &mut rng);
        for level in 0..self.levels {
            let links = if level + 1 < self.levels { self.links as usize } else { 0 };
            let share = tiles * f64::from(level + 1) / f64::from(self.levels) - (links * self.link_tiles()) as f64;
            while board.length < share {
                board.grow(self, level as i32, &mut rng);
            }
            let dug = (0..links).filter(|_| board.descend(self.link_tiles(), level as i32, &mut rng)).count();
            if links > 0 && dug == 0 {
                return Err(self.no_room());
            }
        }
        Ok(board)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plume_graph::{NoOutside, StationId};

    #[test]
    fn connectors_that_meet_close_loops() {
        let loops = |loop_closure: f64| {
            let settings = Tiles { nodes: 600, loop_closure, ..Tiles::default() };
            (0..4).map(|seed| settings.generate(seed, &NoOutside).expect("there is room").loops()).sum::<usize>()
        };
        assert_eq!(loops(0.0), 0);
        assert!(loops(1.0) > 10);
    }

    #[test]
    fn weights_determine_the_tiles() {
        let straight =
            Tiles { bends: 0.0, tees: 0.0, crosses: 0.0, rooms: 0.0, dead_ends: 0.0, wobble: 0.0, ..Tiles::default() };
        let graph = straight.generate(1, &NoOutside).expect("there is room");
        let [width_m, depth_m, _] = graph.bounds().expect("it has nodes").size();
        assert!(width_m.min(depth_m) < 0.001);
    }

    #[test]
    fn shafts_are_vertical_and_ramps_are_not_too_steep() {
        let slope = |access: Access| {
            let settings = Tiles { nodes: 300, levels: 3, access, ..Tiles::default() };
            let graph = settings.generate(1, &NoOutside).expect("there is room");
            let way = |&[a, b]: &[StationId; 2]| graph[b].position - graph[a].position;
            graph
                .edges
                .iter()
                .map(way)
                .map(|way| libm::atan2(way.z.abs(), way.xy().norm()).to_degrees())
                .fold(0.0, f64::max)
        };
        assert!(slope(Access::Ramp) <= 15.1);
        assert!(slope(Access::Shaft) > 45.0);
    }
}

//! A cave as a file has it: stations and legs, before it is a graph.

use nalgebra::Point3;

use super::{Import, Parts, ReadError, Source};
use crate::graph::sketch::{Knot, Sketch};

/// A surveyed point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Station {
    /// In metres, east, north, up, as the file counts them; national grids are welcome.
    pub(super) position: Point3<f64>,
    /// Whether the cave opens to the surface here.
    pub(super) entrance: bool,
}

/// Distances from a station to the walls, as surveyors note them (LRUD). What was not noted is `None`.
///
/// A station has one for each passage that was looked along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Walls {
    pub(super) station: usize,
    /// The stations between which the surveyor looked: left and right are as one looks from the first to the second.
    /// Often one of them is the station itself.
    pub(super) looking: [usize; 2],
    pub(super) left_m: Option<f64>,
    pub(super) right_m: Option<f64>,
    pub(super) up_m: Option<f64>,
    pub(super) down_m: Option<f64>,
}

/// What was measured between two stations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leg {
    /// A passage.
    Passage,
    /// A shot at a wall.
    Splay,
    /// A passage that was measured before.
    Duplicate,
    /// A way over the ground.
    Surface,
}

/// Stations, legs and cross-sections, each in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Survey {
    pub(super) stations: Vec<Station>,
    pub(super) legs: Vec<([usize; 2], Leg)>,
    pub(super) walls: Vec<Walls>,
}

/// What reading a survey left out or filled in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Shots at walls that were dropped.
    pub splays: usize,
    /// Legs marked as measured before that were dropped.
    pub duplicates: usize,
    /// Legs over the ground that were dropped.
    pub surface: usize,
    /// Stations whose section was interpolated.
    pub interpolated: usize,
    /// Legs too short to matter whose stations became one.
    pub welded: usize,
    /// Passages added to join parts.
    pub joined: usize,
    /// Stations of parts that were left out.
    pub left_out: usize,
    /// Where the origin of the graph lies in the coordinates of the file, in metres: a survey is moved so that its first
    /// entrance, or else its first station, is the origin.
    pub origin_m: [f64; 3],
}

impl Survey {
    /// The graph of the passages; what is wrong with it is told of the `source` as a whole.
    pub(super) fn into_import(self, source: &Source, parts: Parts) -> Result<Import, ReadError> {
        let mut sketch = Sketch::default();
        for station in &self.stations {
            sketch.add(Knot { position: station.position, section: None, level: 0 });
        }
        for (ends, leg) in self.legs {
            if leg == Leg::Passage {
                sketch.lines.push(ends);
            }
        }
        let graph = sketch.into_graph();
        if parts == Parts::Refuse && graph.components().len() != 1 {
            return Err(ReadError::whole(source.path, "is in several parts", ""));
        }
        Ok(Import { graph, recipe: None, tally: Tally::default() })
    }
}

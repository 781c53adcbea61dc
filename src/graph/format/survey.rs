//! A cave as a file has it: stations and legs, before it is a graph.

use nalgebra::Point3;

use super::{Import, Parts, ReadError, Source};
use crate::graph::sketch::{Knot, Sketch};

/// Distances from a station to the walls, in metres, as surveyors note them (LRUD). Left and right as one looks along the
/// passage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Walls {
    pub(super) left_m: f64,
    pub(super) right_m: f64,
    pub(super) up_m: f64,
    pub(super) down_m: f64,
}

/// A surveyed point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Station {
    pub(super) position: Point3<f64>,
    pub(super) walls: Option<Walls>,
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

/// Stations and legs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Survey {
    pub(super) stations: Vec<Station>,
    pub(super) legs: Vec<([usize; 2], Leg)>,
}

/// What reading a survey left out or filled in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Shots at walls that were dropped.
    pub splays: usize,
    /// Legs marked as measured before that were dropped.
    pub duplicates: usize,
    /// Legs over the ground that were dropped.
    pub surface: usize,
    /// Stations whose section was interpolated.
    pub interpolated: usize,
    /// Legs without length whose stations became one.
    pub welded: usize,
    /// Passages added to join parts.
    pub joined: usize,
    /// Stations of parts that were left out.
    pub left_out: usize,
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

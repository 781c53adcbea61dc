//! A cave as surveyors have it: stations, legs and distances to walls, and how they become a graph.
//!
//! Readers fill in a [`Survey`]; what follows is the same for all of them. Splays, duplicates and legs over the
//! ground go ([`Leg`]), stations in one place become one ([`weld`]), parts that no passage joins are settled as
//! asked, and each station gets a section from what was measured there or near it ([`section`]). Loops stay as they
//! are: readers close them.
//!
//! Stations may have any coordinates, such as those of a national grid. The graph has its first entrance, or else its
//! first station, as its first node and near its origin, because caves are exact only near that; [`Tally::origin_m`]
//! leads back. Memory and time grow with the number of stations and legs.

mod section;
mod spread;
mod weld;

use std::path::Path;

use nalgebra::Point3;

use self::section::Room;
use super::limits::{MAX_LEGS, MAX_LENGTH_M, MAX_STATIONS};
use super::parts::Fate;
use super::{Import, Parts, ReadError, Source, origin};
use plume_graph::Graph;
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};

/// The least and the greatest reach of a station near which nothing was measured, in metres. Legs are as long as
/// the view was, up to 30 m and more, and passages are not as wide as that: with the default width of 0.6 reaches
/// these are 1.5 to 3.6 m. Tuned.
const REACH_M: [f64; 2] = [2.5, 6.0];

/// A surveyed point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SurveyStation {
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
    pub(super) stations: Vec<SurveyStation>,
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
    /// Where the origin of the graph lies in the coordinates of the file, in metres. A survey is moved so that its
    /// first entrance, or else its first station, is the origin; another graph only if it reaches too far away.
    pub origin_m: Point3<f64>,
}

impl Survey {
    /// The graph of the passages; what is wrong with it is told of the `source` as a whole.
    ///
    /// # Errors
    /// When a number is no length of a cave, there are no passages, or parts are refused and there are several.
    pub(super) fn into_import(self, source: &Source, parts: Parts) -> Result<Import, ReadError> {
        self.check(source.path)?;
        let mut tally = self.tally();
        let passages = self.passages();
        let places: Vec<Point3<f64>> = self.stations.iter().map(|station| station.position).collect();
        let welds = weld::welds(&places, &passages);
        let mut lines: Vec<[usize; 2]> = passages.iter().map(|ends| ends.map(|end| welds[end])).collect();
        lines.retain(|[a, b]| a != b);
        tally.welded = passages.len() - lines.len();

        let name = |station: usize| places[station].coords.map(|x| format!("{x:.1}")).data.0.concat().join(" ");
        let fate = Fate::of(&places, &lines, parts).map_err(|parts| parts.into_error(source.path, name))?;
        (tally.joined, tally.left_out) = (fate.joins.len(), fate.left_out);
        lines.retain(|line| line.iter().all(|&end| fate.stays[end]));
        lines.extend(fate.joins);

        let first = self.first(source.path, &welds, &fate.stays)?;
        tally.origin_m = places[first];
        let (rooms, interpolated) = section::rooms(&self, &welds, &lines);
        tally.interpolated = interpolated;
        let graph = graph(&places, lines, &rooms, first);
        if graph.nodes.len() < 2 {
            return Err(no_passages(source.path));
        }
        origin::check_reach(source.path, graph.nodes.iter().map(|node| node.position))?;
        Ok(Import { graph, recipe: None, tally })
    }

    fn check(&self, path: &Path) -> Result<(), ReadError> {
        for (what, found, most) in
            [("stations", self.stations.len(), MAX_STATIONS), ("legs", self.legs.len(), MAX_LEGS)]
        {
            if found > most {
                let message = format!("has {found} {what}, and {most} is the most");
                return Err(ReadError::whole(path, message, "import a part of the survey"));
            }
        }
        if self.stations.iter().any(|station| !station.position.iter().all(|x| x.is_finite())) {
            let hint = "check the calibrations, and the lengths and angles of the legs";
            return Err(ReadError::whole(path, "has a station whose coordinates are no numbers", hint));
        }
        section::check(&self.walls, path)
    }

    fn tally(&self) -> Tally {
        let count = |kind: Leg| self.legs.iter().filter(|(_, leg)| *leg == kind).count();
        Tally {
            splays: count(Leg::Splay),
            duplicates: count(Leg::Duplicate),
            surface: count(Leg::Surface),
            ..Tally::default()
        }
    }

    fn passages(&self) -> Vec<[usize; 2]> {
        self.legs.iter().filter(|(_, leg)| *leg == Leg::Passage).map(|&(ends, _)| ends).collect()
    }

    /// The station that becomes the origin.
    fn first(&self, path: &Path, welds: &[usize], stays: &[bool]) -> Result<usize, ReadError> {
        let entrances = (0..welds.len()).filter(|&station| self.stations[station].entrance);
        let first = entrances.chain(0..welds.len()).map(|station| welds[station]).find(|&station| stays[station]);
        first.ok_or_else(|| no_passages(path))
    }
}

fn no_passages(path: &Path) -> ReadError {
    let hint = "a cave takes legs that are no splays, no duplicates and not over the ground";
    ReadError::whole(path, "has no passages", hint)
}

/// The graph with `first` as its first node and the origin of its frame.
fn graph(places: &[Point3<f64>], lines: Vec<[usize; 2]>, rooms: &[Option<Room>], first: usize) -> Graph {
    let mut centreline = CentrelineBuilder::default();
    // Stations are within the limits, but not always the middle of the passage beside them, and what two of them are apart.
    let within = |length_m: f64| length_m.clamp(-MAX_LENGTH_M, MAX_LENGTH_M);
    for (place, room) in places.iter().zip(rooms) {
        let position = origin::counted_from(places[first], *place);
        centreline.add(match room {
            Some(room) => {
                Vertex { position: (position + room.middle).map(within), section: Some(room.section), level: 0 }
            }
            None => Vertex { position, section: None, level: 0 },
        });
    }
    centreline.vertices.swap(0, first);
    // Each station becomes the vertex of the same place.
    let swapped = |station: usize| match station {
        0 => VertexId::new(first),
        station if station == first => VertexId::new(0),
        station => VertexId::new(station),
    };
    centreline.lines = lines.into_iter().map(|line| line.map(swapped)).collect();
    let mut graph = centreline.into_graph();
    for node in &mut graph.nodes {
        let [least_m, most_m] = if node.section.is_none() { REACH_M } else { [0.0, MAX_LENGTH_M] };
        node.radius = node.radius.clamp(least_m, most_m);
    }
    graph
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use plume_graph::{Section, Shape};
    use serde_json::Value;

    use super::*;
    use crate::json;

    #[test]
    fn a_graph_that_reaches_the_limits_can_be_written_and_read() {
        let places = [0.0, -MAX_LENGTH_M, MAX_LENGTH_M].map(|x| Point3::new(x, 0.0, 0.0));
        let section = Section { width_m: 8.0, height_m: 4.0, shape: Shape::Cave };
        let room = Room { section, middle: Vector3::new(2.0, 0.0, 0.0) };
        let graph = graph(&places, vec![[0, 1], [1, 2]], &[None, Some(room), Some(room)], 0);
        let text = json::write(&graph, "", &Value::Null);
        assert_eq!(json::read(&text).expect("it is within the limits").graph, graph);
    }
}

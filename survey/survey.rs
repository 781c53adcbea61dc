//! A cave survey, i.e. stations, legs and distances to walls, and its conversion to a graph.
//!
//! Readers fill in a [`Survey`]; what follows is the same for all of them. Splays, duplicates and surface legs are dropped
//! ([`Leg`]), stations in one place become one ([`weld`]), disconnected parts are treated as asked, and each station gets a
//! section from measurements there or nearby ([`section`]). Loops are closed by the readers.
//!
//! Stations may have any coordinates, such as those of a national grid. The first entrance, or else the first station,
//! becomes the first node of the graph and its origin, because caves are exact only near the origin; [`Tally::origin_m`] is
//! the offset, which the graph keeps together with the coordinate system ([`Georeference`]). Nodes keep the names of their
//! stations. Memory and time grow with the number of stations and legs.

mod section;
mod spread;
mod weld;

use std::collections::HashMap;
use std::path::Path;

use nalgebra::Point3;

use self::section::Room;
use super::limits::{MAX_LEGS, MAX_LENGTH_M, MAX_STATIONS};
use super::parts::Fate;
use super::{Import, Parts, ReadError, Source, origin};
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};
use plume_graph::{Georeference, Graph, millimetres};

/// Minimum and maximum reach of a station without measurements nearby, in metres. Legs are as long as the line of sight, up
/// to 30 m and more, and passages are not that wide: with the default width of 0.6 reaches these are 1.5 to 3.6 m. Tuned.
const REACH_M: [f64; 2] = [2.5, 6.0];

/// A surveyed point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SurveyStation {
    /// In metres, east, north, up, in the coordinates of the file, which may be a national grid.
    pub(super) position: Point3<f64>,
    /// Whether the cave opens to the surface here.
    pub(super) entrance: bool,
    /// Its name with those of the surveys around it, `cave.series.12`.
    pub(super) name: Option<Box<str>>,
}

impl SurveyStation {
    /// A station without a name.
    pub(super) fn at(position: Point3<f64>) -> Self {
        Self { position, entrance: false, name: None }
    }
}

/// Distances from a station to the walls (LRUD). Missing ones are `None`.
///
/// A station has one for each passage that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Walls {
    pub(super) station: usize,
    /// The direction of view: left and right are as seen from the first station towards the second. Often one of them is the
    /// station itself.
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
    /// A splay: a shot at a wall.
    Splay,
    /// A duplicate: a passage measured before.
    Duplicate,
    /// A surface leg.
    Surface,
}

/// Stations, legs and cross-sections, each in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Survey {
    pub(super) stations: Vec<SurveyStation>,
    pub(super) legs: Vec<([usize; 2], Leg)>,
    pub(super) walls: Vec<Walls>,
    /// The coordinate system as the file names it.
    pub(super) system: Option<Box<str>>,
}

/// Counts of what was dropped or filled in when reading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Splays dropped.
    pub splays: usize,
    /// Duplicate legs dropped.
    pub duplicates: usize,
    /// Surface legs dropped.
    pub surface: usize,
    /// Stations with an interpolated section.
    pub interpolated: usize,
    /// Legs so short that their stations were welded.
    pub welded: usize,
    /// Passages added between disconnected parts.
    pub joined: usize,
    /// Stations of dropped parts.
    pub left_out: usize,
    /// Stations dropped because only legs without readings (`nosurvey`) lead there.
    pub unplaced: usize,
    /// Pieces laid beside the others, because nothing fixes their positions.
    pub afloat: usize,
    /// Readings that are probably mistakes, and are taken as they are.
    pub doubtful: usize,
    /// The origin of the graph in the coordinates of the file, in metres. A survey is moved so that its first entrance, or
    /// else its first station, is the origin; other graphs only if they reach too far away.
    pub origin_m: Point3<f64>,
}

impl Survey {
    /// The graph of the passages; errors refer to the `source` as a whole.
    ///
    /// # Errors
    /// If a number is not a plausible length, there are no passages, or there are several parts and they are refused.
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
        let names = names(self.stations, &welds);
        let mut graph = graph(&places, &names, lines, &rooms, first);
        graph.georeference = Georeference::of(tally.origin_m, self.system);
        if graph.nodes.len() < 2 {
            return Err(no_passages(source.path));
        }
        origin::check_reach(source.path, graph.nodes.iter().map(|node| node.position))?;
        Ok(Import { graph, recipe: None, tally, warnings: Vec::new() })
    }

    fn check(&self, path: &Path) -> Result<(), ReadError> {
        for (what, found, most) in
            [("stations", self.stations.len(), MAX_STATIONS), ("legs", self.legs.len(), MAX_LEGS)]
        {
            if found > most {
                let message = format!("has {found} {what}, more than {most}");
                return Err(ReadError::whole(path, message, "import only a part of the survey"));
            }
        }
        if self.stations.iter().any(|station| !station.position.iter().all(|x| x.is_finite())) {
            let hint = "check the calibrations, and the lengths and angles of the legs";
            return Err(ReadError::whole(path, "has a station whose coordinates are not finite", hint));
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
    let hint = "a cave needs legs other than splays, duplicates and surface legs";
    ReadError::whole(path, "has no passages", hint)
}

/// The name of each station that stands for its place: its own, or else that of the first one there that has any.
fn names(stations: Vec<SurveyStation>, welds: &[usize]) -> Vec<Option<Box<str>>> {
    let mut names: Vec<Option<Box<str>>> = stations.into_iter().map(|station| station.name).collect();
    for (station, &place) in welds.iter().enumerate() {
        if names[place].is_none() {
            names[place] = names[station].take();
        }
    }
    names
}

/// The graph with `first` as its first node and the origin of its frame.
fn graph(
    places: &[Point3<f64>],
    names: &[Option<Box<str>>],
    lines: Vec<[usize; 2]>,
    rooms: &[Option<Room>],
    first: usize,
) -> Graph {
    let mut centreline = CentrelineBuilder::default();
    // Stations are within the limits, but the axes of passages next to them, and distances between two of them, may not be.
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
    let named = named_places(&centreline, names, &lines);
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
        node.name = named.get(&place_of(node.position)).and_then(|&station| names[station].clone());
    }
    graph
}

/// The first named station that passages lead to, for each place. Randomly hashed, so that no file can provoke collisions.
fn named_places(
    centreline: &CentrelineBuilder,
    names: &[Option<Box<str>>],
    lines: &[[usize; 2]],
) -> HashMap<[u64; 3], usize> {
    let mut ends: Vec<usize> = lines.iter().flatten().copied().filter(|&end| names[end].is_some()).collect();
    ends.sort_unstable();
    let mut named = HashMap::new();
    for end in ends {
        named.entry(place_of(centreline.vertices[end].position)).or_insert(end);
    }
    named
}

/// A position to 1 mm, as the graph has it.
fn place_of(position: Point3<f64>) -> [u64; 3] {
    position.map(millimetres).coords.map(f64::to_bits).into()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use plume_graph::{Section, Shape};
    use serde_json::Value;

    use super::*;
    use crate::json;

    #[test]
    fn a_graph_at_the_limits_can_be_written_and_read() {
        let places = [0.0, -MAX_LENGTH_M, MAX_LENGTH_M].map(|x| Point3::new(x, 0.0, 0.0));
        let section = Section { width_m: 8.0, height_m: 4.0, shape: Shape::Cave };
        let room = Room { section, middle: Vector3::new(2.0, 0.0, 0.0) };
        let graph = graph(&places, &[None, None, None], vec![[0, 1], [1, 2]], &[None, Some(room), Some(room)], 0);
        let text = json::write(&graph, "", &Value::Null);
        assert_eq!(json::read(&text).expect("it is within the limits").graph, graph);
    }
}

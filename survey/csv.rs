//! A table of passages, one per row, with the coordinates of both ends: how GIS, spreadsheets and pandas hold lines.
//! Comma-separated values as in RFC 4180; semicolons and tabs are also read.
//!
//! ```csv
//! x1,y1,z1,radius1,level1,width1,height1,shape1,x2,y2,z2,radius2,level2,width2,height2,shape2
//! 0,0,0,4,0,,,,6,0,-1,4,0,3,2,cave
//! ```
//! The header names the columns, in any order; `x1`, `y1`, `x2` and `y2` are required, `from_x` and `to_x` are understood
//! too, other columns are ignored. Lengths are in metres, Z is up, in any grid ([`origin`](super::origin)). Ends in the same
//! place, to 1 mm, are one station, whose properties are those of the first row; a row with both ends in one place is welded.
//!
//! A graph with names of stations has columns `name1` and `name2` as well.
//!
//! Preserved are positions, radii, levels, sections, names and passages; not ids, parents, `active` and georeference.

use std::collections::HashMap;
use std::fmt::Write;

use nalgebra::Point3;

use super::draft::Draft;
use super::fields::{Field, Fields, field, shape_name};
use super::limits::{MAX_LEGS, MAX_STATIONS};
use super::text::{LENGTH_HINT, line_of, utf8};
use super::{Import, Parts, ReadError, Source, Tally, Written};
use plume_graph::echo::{sentence, shown};
use plume_graph::{Graph, Node, StationId, millimetres};

const HEADER_HINT: &str = "begin with a header of column names: x1,y1,z1,x2,y2,z2";

/// Reads the table.
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let text = utf8(source.path, source.bytes)?;
    let mut reader =
        csv::ReaderBuilder::new().delimiter(delimiter(text)).trim(csv::Trim::All).from_reader(text.as_bytes());
    let told = |error: csv::Error| told(source, text, &error);
    let columns = Columns::of(reader.headers().map_err(told)?)
        .map_err(|fault| ReadError::line(source.path, 1, fault, HEADER_HINT))?;
    let mut stations = Stations::default();
    let mut record = csv::StringRecord::new();
    let mut welded = 0;
    while reader.read_record(&mut record).map_err(told)? {
        let fault = |message: String, hint| ReadError::line(source.path, line(text, record.position()), message, hint);
        let ends = columns.ends(&record).map_err(|(message, hint)| fault(message, hint))?;
        if place(&ends[0]) == place(&ends[1]) {
            welded += 1;
            continue;
        }
        let edge = ends.map(|end| stations.find(end));
        stations.draft.edges.push(edge);
        if stations.draft.nodes.len() > MAX_STATIONS || stations.draft.edges.len() > MAX_LEGS {
            let message = format!("there are more than {MAX_STATIONS} stations or {MAX_LEGS} passages");
            return Err(fault(message, "split the table into several caves"));
        }
    }
    let places: Vec<Point3<f64>> = stations.draft.nodes.iter().map(|node| node.position).collect();
    let name = |node: usize| format!("the station at {} {} {}", places[node].x, places[node].y, places[node].z);
    let import = stations.draft.into_import(source.path, parts, name)?;
    Ok(Import { tally: Tally { welded, ..import.tally }, ..import })
}

/// The separator used in the header.
fn delimiter(text: &str) -> u8 {
    let header = text.lines().next().unwrap_or_default();
    [b'\t', b';'].into_iter().find(|&split| header.as_bytes().contains(&split)).unwrap_or(b',')
}

/// The line of a row, after any blank lines before it.
fn line(text: &str, position: Option<&csv::Position>) -> usize {
    line_of(text, position.map_or(0, |position| position.byte() as usize))
}

fn told(source: &Source, text: &str, error: &csv::Error) -> ReadError {
    let line = line(text, error.position());
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            let message = format!("has {len} columns, but the header has {expected_len}");
            ReadError::line(source.path, line, message, "give every row as many columns as the header has")
        }
        _ => ReadError::line(source.path, line, sentence(&error.to_string()), HEADER_HINT),
    }
}

/// The property that each column holds, and the end of the passage it belongs to.
struct Columns(Vec<(usize, usize, Field)>);

impl Columns {
    fn of(header: &csv::StringRecord) -> Result<Self, String> {
        let mut columns = Vec::new();
        for (column, name) in header.iter().enumerate() {
            let Some((end, field)) = end_and_field(name) else { continue };
            if columns.iter().any(|&(_, other_end, other)| (other_end, other) == (end, field)) {
                if field == Field::Name {
                    continue;
                }
                return Err(format!("two columns have the same meaning, one of them is {}", shown(name)));
            }
            columns.push((column, end, field));
        }
        for (end, field, name) in [(0, Field::X, "x1"), (0, Field::Y, "y1"), (1, Field::X, "x2"), (1, Field::Y, "y2")] {
            if !columns.iter().any(|&(_, other_end, other)| (other_end, other) == (end, field)) {
                return Err(format!("there is no column `{name}`"));
            }
        }
        Ok(Self(columns))
    }

    /// The two ends of a passage.
    fn ends(&self, record: &csv::StringRecord) -> Result<[Node; 2], (String, &'static str)> {
        let mut ends = [Fields::default(), Fields::default()];
        for &(column, end, field) in &self.0 {
            let text = record.get(column).unwrap_or_default();
            ends[end].set(field, text)?;
        }
        let [first, second] =
            ends.map(|end| end.node(0).map_err(|axis| (format!("an end has no {axis}"), LENGTH_HINT)));
        Ok([first?, second?])
    }
}

/// Reads `x1`, `x_1`, `from_x`, `start x` and the like.
fn end_and_field(name: &str) -> Option<(usize, Field)> {
    const ENDS: [&[&str]; 2] = [&["1", "from", "start", "source"], &["2", "to", "end", "target"]];
    let name = name.trim().to_ascii_lowercase();
    let ends = ENDS.iter().enumerate().flat_map(|(end, marks)| marks.iter().map(move |mark| (end, mark)));
    let mut found = ends.filter_map(|(end, mark)| {
        let rest = name.strip_suffix("_m").unwrap_or(&name);
        let rest = rest.strip_suffix(mark).or_else(|| rest.strip_prefix(mark))?;
        Some((end, field(rest)?))
    });
    found.next()
}

fn place(station: &Node) -> [u64; 3] {
    station.position.map(millimetres).coords.map(f64::to_bits).into()
}

/// The stations found so far, by position.
#[derive(Default)]
struct Stations {
    draft: Draft,
    /// Randomly hashed, so that no file can provoke collisions.
    of_place: HashMap<[u64; 3], StationId>,
}

impl Stations {
    fn find(&mut self, station: Node) -> StationId {
        let next = self.draft.nodes.len();
        let found = *self.of_place.entry(place(&station)).or_insert(StationId::new(next));
        if found.index() == next {
            self.draft.nodes.push(Node { id: next as u64, ..station });
        }
        found
    }
}

/// Writes the table.
pub(super) fn export(graph: &Graph) -> Vec<Written> {
    let header = |end: u8| format!("x{end},y{end},z{end},radius{end},level{end},width{end},height{end},shape{end}");
    let has_names = graph.nodes.iter().any(|node| node.name.is_some());
    let header = |end: u8| if has_names { format!("{},name{end}", header(end)) } else { header(end) };
    let mut text = format!("{},{}\n", header(1), header(2));
    for [a, b] in &graph.edges {
        let [first, second] = [&graph[*a], &graph[*b]].map(|node| match has_names {
            true => format!("{},{}", columns(node), quoted(node.name.as_deref().unwrap_or_default())),
            false => columns(node),
        });
        writeln!(text, "{first},{second}").expect("writing to a string cannot fail");
    }
    vec![Written { suffix: "", bytes: text.into_bytes() }]
}

/// A text as a field of the table.
fn quoted(text: &str) -> String {
    let is_plain = !text.contains([',', ';', '"', '\n', '\r']);
    if is_plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

fn columns(node: &Node) -> String {
    let [x, y, z] = node.position.coords.into();
    let section = node.section.map_or_else(
        || ",,".to_owned(),
        |section| format!("{},{},{}", section.width_m, section.height_m, shape_name(section.shape)),
    );
    format!("{x},{y},{z},{},{},{section}", node.radius, node.level)
}

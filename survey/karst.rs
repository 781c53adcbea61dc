//! Karst networks in the format of karstnet (Collon et al. 2017, <https://github.com/karstnet/karstnet>): two text files.
//!
//! `X_nodes.dat` has x, y and z of a node per line, in metres, Z up, separated by blanks; further columns are properties and
//! are ignored. `X_links.dat` has the numbers of two nodes per line, counted from 1. `#` begins a comment. The program of
//! Paris et al. 2021 writes the same pair, but with Y up: its caves lie on their side unless rotated.
//!
//! Positions may be in any grid ([`origin`](super::origin)). Preserves positions and passages in their order; not radii,
//! sections and levels.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use nalgebra::Point3;

use super::draft::{Draft, node_at};
use super::limits::{MAX_LEGS, MAX_LINE, MAX_STATIONS};
use super::text::{LENGTH_HINT, coordinate, utf8, whole};
use super::{Import, OUTSIDE_FILE, OUTSIDE_HINT, OUTSIDE_LINE, OUTSIDE_LINE_HINT, Parts, ReadError, Source, Written};
use plume_graph::echo::shown;
use plume_graph::{Graph, Node, StationId};

const NODES: &str = "_nodes.dat";
const LINKS: &str = "_links.dat";

/// Reads the pair, given either file.
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let name = source.path.to_string_lossy();
    let (stem, is_nodes) = match (stem(&name, NODES), stem(&name, LINKS)) {
        (Some(stem), _) => (stem, true),
        (_, Some(stem)) => (stem, false),
        _ => return Err(ReadError::whole(source.path, "is neither a file of nodes nor of links", PAIR_HINT)),
    };
    let other = PathBuf::from(format!("{stem}{}", if is_nodes { LINKS } else { NODES }));
    let is_outside_file = source.is_outside_file(&other);
    if source.refuses(is_outside_file) {
        return Err(ReadError::whole(&other, OUTSIDE_FILE, OUTSIDE_HINT));
    }
    let told = |error: std::io::Error| ReadError::whole(&other, error.to_string(), PAIR_HINT);
    let bytes = source.outside.read(&other).map_err(told)?;
    let (named, other) = ((source.path, source.bytes), (other.as_path(), bytes.as_slice()));
    let (nodes, links) = if is_nodes { (named, other) } else { (other, named) };
    let quiet = |fault: ReadError| match is_outside_file && fault.place.path() == other.0 {
        true => ReadError { message: OUTSIDE_LINE.to_owned(), hint: OUTSIDE_LINE_HINT.to_owned(), ..fault },
        false => fault,
    };
    let mut draft =
        Draft { nodes: read_nodes(nodes.0, nodes.1).map_err(quiet)?, edges: Vec::new(), georeference: None };
    draft.edges = read_links(links.0, links.1, draft.nodes.len()).map_err(quiet)?;
    draft.into_import(nodes.0, parts, |node| format!("node {}", node + 1))
}

const PAIR_HINT: &str = "a network is a pair of files in the same folder: X_nodes.dat and X_links.dat";

/// The name before an extension in either case.
fn stem<'a>(name: &'a str, ending: &str) -> Option<&'a str> {
    let (stem, end) = name.split_at_checked(name.len().checked_sub(ending.len())?)?;
    end.eq_ignore_ascii_case(ending).then_some(stem)
}

fn read_nodes(path: &Path, bytes: &[u8]) -> Result<Vec<Node>, ReadError> {
    let mut nodes = Vec::new();
    for row in rows(path, bytes)? {
        let (line, columns) = row?;
        if nodes.len() == MAX_STATIONS {
            let message = format!("there are more than {MAX_STATIONS} nodes");
            return Err(ReadError::line(path, line, message, "split the network into several caves"));
        }
        let [x, y, z] = first(path, line, columns, "a node is a line with x, y and z in metres")?;
        let read = |text| coordinate(text).map_err(|fault| ReadError::line(path, line, fault, LENGTH_HINT));
        nodes.push(node_at(nodes.len() as u64, Point3::new(read(x)?, read(y)?, read(z)?)));
    }
    Ok(nodes)
}

fn read_links(path: &Path, bytes: &[u8], nodes: usize) -> Result<Vec<[StationId; 2]>, ReadError> {
    let mut links = Vec::new();
    for row in rows(path, bytes)? {
        let (line, columns) = row?;
        if links.len() == MAX_LEGS {
            let message = format!("there are more than {MAX_LEGS} links");
            return Err(ReadError::line(path, line, message, "split the network into several caves"));
        }
        let ends: [&str; 2] = first(path, line, columns, LINK_HINT)?;
        let read = |text: &str| {
            let number = whole(text).map_err(|fault| ReadError::line(path, line, fault, LINK_HINT))?;
            let node = (number as usize).checked_sub(1).filter(|&node| node < nodes);
            node.map(StationId::new)
                .ok_or_else(|| ReadError::line(path, line, format!("there is no node {}", shown(text)), LINK_HINT))
        };
        links.push([read(ends[0])?, read(ends[1])?]);
    }
    Ok(links)
}

const LINK_HINT: &str = "a link is a line with the numbers of two nodes, counted from 1";

type Row<'a> = Result<(usize, &'a str), ReadError>;

/// Lines that are not empty, numbered from 1, without comments.
fn rows<'a>(path: &'a Path, bytes: &'a [u8]) -> Result<impl Iterator<Item = Row<'a>>, ReadError> {
    let lines = utf8(path, bytes)?.lines().enumerate();
    let rows = lines.map(move |(index, line)| {
        if line.len() > MAX_LINE {
            return Err(ReadError::line(path, index + 1, "is too long", "this does not look like a network"));
        }
        Ok((index + 1, line.split('#').next().unwrap_or_default().trim()))
    });
    Ok(rows.filter(|row| row.as_ref().map_or(true, |(_, text)| !text.is_empty())))
}

/// The first columns of a line.
fn first<'a, const N: usize>(path: &Path, line: usize, row: &'a str, hint: &str) -> Result<[&'a str; N], ReadError> {
    let columns: Vec<&str> = row.split_ascii_whitespace().take(N).collect();
    let found = columns.len();
    columns.try_into().map_err(|_| ReadError::line(path, line, format!("has {found} of {N} numbers"), hint))
}

/// Writes the pair.
pub(super) fn export(graph: &Graph) -> Vec<Written> {
    let mut nodes = String::new();
    for node in &graph.nodes {
        let [x, y, z] = node.position.coords.into();
        writeln!(nodes, "{x} {y} {z}").expect("writing to a string cannot fail");
    }
    let mut links = String::new();
    for [a, b] in &graph.edges {
        writeln!(links, "{} {}", a.index() + 1, b.index() + 1).expect("writing to a string cannot fail");
    }
    vec![
        Written { suffix: "_nodes", bytes: nodes.into_bytes() },
        Written { suffix: "_links", bytes: links.into_bytes() },
    ]
}

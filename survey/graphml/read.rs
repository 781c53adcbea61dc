//! Reads GraphML one element at a time: memory grows with the graph, not with the file.

use std::collections::HashMap;
use std::path::Path;

use quick_xml::XmlVersion;
use quick_xml::events::{BytesRef, BytesStart, Event};
use quick_xml::reader::Reader;

use crate::draft::Draft;
use crate::fields::{Field, Fields, field};
use crate::limits::{MAX_DEPTH, MAX_LEGS, MAX_LINE, MAX_STATIONS};
use crate::text::{LENGTH_HINT, coordinate, line_of, utf8};
use crate::{Import, Parts, ReadError, Source};
use plume_graph::echo::{sentence, shown};
use plume_graph::{Georeference, StationId};

/// Reads the graph of the file.
pub(crate) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let text = utf8(source.path, source.bytes)?;
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut walk = Walk::default();
    loop {
        let at = reader.buffer_position();
        let event = reader
            .read_event()
            .map_err(|error| Fault::new(sentence(&error.to_string()), "this is not well-formed XML"));
        let event = event.map_err(|fault| fault.at(source.path, text, reader.error_position()))?;
        if event == Event::Eof {
            break;
        }
        walk.take(event, at).map_err(|fault| fault.at(source.path, text, at))?;
    }
    walk.end().map_err(|fault| fault.at(source.path, text, text.len() as u64))?;
    walk.resolve_edges().map_err(|(fault, at)| fault.at(source.path, text, at))?;
    let Walk { mut draft, names, origin_m, system, .. } = walk;
    draft.georeference = Georeference::of(origin_m.into(), system);
    let names = by_node(names);
    number(&mut draft, &names);
    let name = |node: usize| format!("node {}", shown(&names[node]));
    draft.into_import(source.path, parts, name)
}

/// An error without its location.
struct Fault {
    message: String,
    hint: &'static str,
}

impl Fault {
    fn new(message: impl Into<String>, hint: &'static str) -> Self {
        Self { message: message.into(), hint }
    }

    /// The error at a byte of the text, reported as a line.
    fn at(self, path: &Path, text: &str, byte: u64) -> ReadError {
        ReadError::line(path, line_of(text, byte as usize), self.message, self.hint)
    }
}

/// Most keys that a file may declare; unknown ones are ignored.
const MAX_KEYS: usize = 1000;
const SHAPE_HINT: &str = "a GraphML file contains one <graph> of <node> and <edge> elements inside <graphml>";

/// An open element, as far as it matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Element {
    GraphMl,
    Key,
    /// The default of a key.
    Default,
    Graph,
    Node,
    /// A value of a node.
    Data(Option<Field>),
    /// A value of the graph.
    About(Option<About>),
    Other,
}

/// What a graph may say about its origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum About {
    /// A coordinate: 0 is east, 1 north, 2 up.
    Origin(usize),
    System,
}

impl About {
    fn named(name: &str) -> Option<Self> {
        match name {
            "origin_x" => Some(Self::Origin(0)),
            "origin_y" => Some(Self::Origin(1)),
            "origin_z" => Some(Self::Origin(2)),
            "system" => Some(Self::System),
            _ => None,
        }
    }
}

#[derive(Default)]
struct Walk {
    open: Vec<Element>,
    graphs: usize,
    /// The meaning of keys, by id.
    fields: HashMap<String, Option<Field>>,
    /// The meaning of keys of the graph, by id.
    abouts: HashMap<String, Option<About>>,
    origin_m: [f64; 3],
    system: Option<Box<str>>,
    /// The key that is open.
    key: Option<Field>,
    defaults: Fields,
    node: Fields,
    /// Text of the open value.
    value: String,
    draft: Draft,
    /// Nodes by name, randomly hashed, so that no file can provoke collisions.
    names: HashMap<String, StationId>,
    /// Edges by the names of their nodes, which may follow later, and where they are.
    pending: Vec<([String; 2], u64)>,
}

impl Walk {
    fn take(&mut self, event: Event, at: u64) -> Result<(), Fault> {
        match event {
            Event::Start(element) => self.start(&element, at),
            Event::End(_) => self.close(),
            Event::Text(text) => self.text(&text),
            Event::CData(text) => self.text(&text),
            Event::GeneralRef(reference) => self.reference(&reference),
            Event::DocType(_) => {
                Err(Fault::new("has a document type", "remove the <!DOCTYPE …>: GraphML does not need it"))
            }
            Event::Decl(_) | Event::PI(_) | Event::Comment(_) | Event::Empty(_) | Event::Eof => Ok(()),
        }
    }

    fn start(&mut self, element: &BytesStart, at: u64) -> Result<(), Fault> {
        if self.open.len() == MAX_DEPTH {
            return Err(Fault::new(format!("is nested more than {MAX_DEPTH} elements deep"), SHAPE_HINT));
        }
        let name = element.local_name();
        let open = match (self.open.last(), name.as_ref()) {
            (None, "graphml") => Element::GraphMl,
            (None, other) => return Err(Fault::new(format!("is not GraphML but <{other}>"), SHAPE_HINT)),
            (Some(Element::GraphMl), "key") => self.key(element)?,
            (Some(Element::Key), "default") => Element::Default,
            (Some(Element::GraphMl), "graph") => self.graph()?,
            (Some(Element::Graph), "node") => self.node(element)?,
            (Some(Element::Graph), "edge") => self.edge(element, at)?,
            (Some(Element::Graph), "data") => self.about(element)?,
            (Some(Element::Graph), "hyperedge") => {
                return Err(Fault::new("is a hyperedge", "replace it with edges between two nodes"));
            }
            (Some(Element::Node), "graph") => {
                return Err(Fault::new("is a graph inside a node", "ungroup the nodes"));
            }
            (Some(Element::Node), "data") => self.data(element)?,
            (Some(_), "Geometry") if self.open.contains(&Element::Node) => self.drawn(element)?,
            _ => Element::Other,
        };
        self.value.clear();
        self.open.push(open);
        Ok(())
    }

    fn key(&mut self, element: &BytesStart) -> Result<Element, Fault> {
        let [id, of, name] = attributes(element, ["id", "for", "attr.name"])?;
        let id = id.ok_or_else(|| Fault::new("a key has no id", SHAPE_HINT))?;
        let is_of = |what: &str| of.as_deref().is_none_or(|of| of == what || of == "all");
        if self.fields.len() == MAX_KEYS {
            return Err(Fault::new(format!("there are more than {MAX_KEYS} keys"), SHAPE_HINT));
        }
        self.key = name.as_deref().filter(|_| is_of("node")).and_then(field);
        self.abouts.insert(id.clone(), name.as_deref().filter(|_| is_of("graph")).and_then(About::named));
        if self.fields.insert(id.clone(), self.key).is_some() {
            return Err(Fault::new(format!("two keys have the id {}", shown(&id)), SHAPE_HINT));
        }
        Ok(Element::Key)
    }

    fn graph(&mut self) -> Result<Element, Fault> {
        self.graphs += 1;
        match self.graphs {
            1 => Ok(Element::Graph),
            _ => Err(Fault::new("is a second graph", "keep only one graph per file")),
        }
    }

    fn node(&mut self, element: &BytesStart) -> Result<Element, Fault> {
        let [id] = attributes(element, ["id"])?;
        let id = id.ok_or_else(|| Fault::new("a node has no id", SHAPE_HINT))?;
        let next = self.names.len();
        if next == MAX_STATIONS {
            let message = format!("there are more than {MAX_STATIONS} nodes");
            return Err(Fault::new(message, "split the graph into several caves"));
        }
        if self.names.contains_key(&id) {
            return Err(Fault::new(format!("two nodes have the id {}", shown(&id)), "give every node a unique id"));
        }
        self.names.insert(id, StationId::new(next));
        self.node = self.defaults.clone();
        Ok(Element::Node)
    }

    fn edge(&mut self, element: &BytesStart, at: u64) -> Result<Element, Fault> {
        let [source, target] = attributes(element, ["source", "target"])?;
        let (Some(source), Some(target)) = (source, target) else {
            return Err(Fault::new("an edge has no source or no target", SHAPE_HINT));
        };
        if self.draft.edges.len() + self.pending.len() == MAX_LEGS {
            let message = format!("there are more than {MAX_LEGS} edges");
            return Err(Fault::new(message, "split the graph into several caves"));
        }
        match (self.names.get(&source), self.names.get(&target)) {
            (Some(&source), Some(&target)) => self.draft.edges.push([source, target]),
            _ => self.pending.push(([source, target], at)),
        }
        Ok(Element::Other)
    }

    /// The meaning of undeclared keys follows from their ids.
    fn data(&self, element: &BytesStart) -> Result<Element, Fault> {
        let [key] = attributes(element, ["key"])?;
        let key = key.unwrap_or_default();
        Ok(Element::Data(self.fields.get(&key).copied().unwrap_or_else(|| field(&key))))
    }

    fn about(&self, element: &BytesStart) -> Result<Element, Fault> {
        let [key] = attributes(element, ["key"])?;
        let key = key.unwrap_or_default();
        Ok(Element::About(self.abouts.get(&key).copied().unwrap_or_else(|| About::named(&key))))
    }

    /// The box that yEd draws for a node, y pointing down.
    fn drawn(&mut self, element: &BytesStart) -> Result<Element, Fault> {
        let [x, y, width, height] = attributes(element, ["x", "y", "width", "height"])?;
        let read = |text: Option<String>| {
            text.map_or(Ok(0.0), |text| coordinate(&text)).map_err(|fault| Fault::new(fault, LENGTH_HINT))
        };
        if x.is_some() && y.is_some() {
            self.node.draw_at([read(x)? + read(width)? / 2.0, -(read(y)? + read(height)? / 2.0)]);
        }
        Ok(Element::Other)
    }

    fn text(&mut self, text: &str) -> Result<(), Fault> {
        if !matches!(self.open.last(), Some(Element::Data(Some(_)) | Element::About(Some(_)) | Element::Default)) {
            return Ok(());
        }
        if self.value.len() + text.len() > MAX_LINE {
            return Err(Fault::new("has too long a value", LENGTH_HINT));
        }
        self.value.push_str(text);
        Ok(())
    }

    fn reference(&mut self, reference: &BytesRef) -> Result<(), Fault> {
        let unknown = || Fault::new(format!("&{}; is not defined", &**reference), "write the character itself");
        let letter = match &**reference {
            "lt" => '<',
            "gt" => '>',
            "amp" => '&',
            "apos" => '\'',
            "quot" => '"',
            _ => reference.resolve_char_ref().ok().flatten().ok_or_else(unknown)?,
        };
        self.text(letter.encode_utf8(&mut [0; 4]))
    }

    fn close(&mut self) -> Result<(), Fault> {
        let value = std::mem::take(&mut self.value);
        let wrong = |(message, hint): (String, _)| Fault::new(message, hint);
        match (self.open.pop(), self.key) {
            (Some(Element::Data(Some(field))), _) => self.node.set(field, &value).map_err(wrong)?,
            (Some(Element::Default), Some(field)) => self.defaults.set(field, &value).map_err(wrong)?,
            (Some(Element::About(Some(About::System))), _) => self.system = plume_graph::name(&value),
            (Some(Element::About(Some(About::Origin(axis)))), _) => {
                self.origin_m[axis] = coordinate(&value).map_err(|fault| Fault::new(fault, LENGTH_HINT))?;
            }
            (Some(Element::Key), _) => self.key = None,
            (Some(Element::Node), _) => {
                let node = std::mem::take(&mut self.node).node(self.draft.nodes.len() as u64);
                let missing =
                    |axis| Fault::new(format!("the node has no {axis}"), "give nodes data with keys x, y and z");
                self.draft.nodes.push(node.map_err(missing)?);
            }
            _ => {}
        }
        Ok(())
    }

    fn end(&self) -> Result<(), Fault> {
        match self.graphs {
            _ if !self.open.is_empty() => {
                Err(Fault::new("ends before its elements are closed", "the file is truncated"))
            }
            0 => Err(Fault::new("contains no graph", SHAPE_HINT)),
            _ => Ok(()),
        }
    }

    fn resolve_edges(&mut self) -> Result<(), (Fault, u64)> {
        for (ends, at) in std::mem::take(&mut self.pending) {
            let find = |name: &String| {
                let unknown = || Fault::new(format!("there is no node {}", shown(name)), "edges refer to nodes by id");
                self.names.get(name).copied().ok_or_else(|| (unknown(), at))
            };
            let edge = [find(&ends[0])?, find(&ends[1])?];
            self.draft.edges.push(edge);
        }
        Ok(())
    }
}

/// The values of these attributes; of duplicates, the first.
fn attributes<const N: usize>(element: &BytesStart, names: [&str; N]) -> Result<[Option<String>; N], Fault> {
    let mut values = [const { None }; N];
    let mut all = element.attributes();
    for attribute in all.with_checks(false) {
        let attribute =
            attribute.map_err(|error| Fault::new(sentence(&error.to_string()), "this is not well-formed XML"))?;
        let Some(place) = names.iter().position(|&name| name == attribute.key.as_ref()) else { continue };
        let value = attribute.normalized_value(XmlVersion::Implicit1_0);
        let value = value.map_err(|error| Fault::new(sentence(&error.to_string()), "this is not well-formed XML"))?;
        values[place].get_or_insert_with(|| value.into_owned());
    }
    Ok(values)
}

fn by_node(names: HashMap<String, StationId>) -> Vec<String> {
    let mut names: Vec<(String, StationId)> = names.into_iter().collect();
    names.sort_unstable_by_key(|&(_, node)| node);
    names.into_iter().map(|(name, _)| name).collect()
}

/// Uses the names of nodes as ids, if all are numbers and unique.
fn number(draft: &mut Draft, names: &[String]) {
    let ids = names.iter().map(|name| name.strip_prefix('n').unwrap_or(name).parse().ok());
    let Some(ids) = ids.collect::<Option<Vec<u64>>>() else { return };
    let mut sorted = ids.clone();
    sorted.sort_unstable();
    if sorted.windows(2).all(|pair| pair[0] < pair[1]) {
        draft.nodes.iter_mut().zip(ids).for_each(|(node, id)| node.id = id);
    }
}

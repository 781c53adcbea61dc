//! Parses stations one at a time, checking each as it is read.

use std::fmt;

use nalgebra::Point3;
use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use super::error::ReadError;
use crate::limits::{MAX_LEGS, MAX_LENGTH_M, MAX_STATIONS};
use plume_graph::echo::{plain, sentence, shown};
use plume_graph::{Georeference, MAX_ORIGIN_M, Section, Shape, millimetres};

/// A node as in the file.
pub(super) struct ParsedStation {
    pub(super) id: u64,
    pub(super) parent: Option<u64>,
    pub(super) edges: Vec<u64>,
    pub(super) position: Point3<f64>,
    pub(super) radius: Option<f64>,
    pub(super) active: bool,
    pub(super) level: u32,
    pub(super) section: Option<Section>,
    pub(super) name: Option<Box<str>>,
}

/// A file as parsed.
pub(super) struct File {
    pub(super) version: Option<Value>,
    pub(super) recipe: Option<Value>,
    pub(super) georeference: Option<Georeference>,
    pub(super) stations: Vec<ParsedStation>,
}

/// Reads the text of a file.
pub(super) fn parse(text: &str) -> Result<File, ReadError> {
    let keys: Keys = serde_json::from_str(text).map_err(|error| explained(&error, text))?;
    let stations = keys.nodes.ok_or_else(|| ReadError::Shape { what: "there is no key `nodes`".to_owned() })?;
    // An imported graph has no recipe, which is written as null.
    let recipe = keys.recipe.filter(|recipe| !recipe.is_null());
    let georeference = keys.georeference.filter(|value| !value.is_null());
    let georeference = georeference.map(|value| read_georeference(&value)).transpose()?;
    Ok(File { version: keys.version, recipe, georeference, stations: stations? })
}

/// `{"origin_m": [east, north, up], "system": "EPSG:32633"}`, the system being optional.
fn read_georeference(value: &Value) -> Result<Georeference, ReadError> {
    let place = value.get("origin_m").and_then(|place| <[f64; 3]>::deserialize(place).ok());
    let place = place.filter(|place| place.iter().all(|x| x.abs() <= MAX_ORIGIN_M));
    let Some(origin_m) = place.map(Point3::from) else {
        let what = "`georeference` must have an `origin_m` of three coordinates in metres".to_owned();
        return Err(ReadError::Shape { what });
    };
    let system = value.get("system").and_then(Value::as_str).and_then(plume_graph::name);
    Ok(Georeference { origin_m, system })
}

/// The parser's error, or a better one if another program is known to be the cause.
fn explained(error: &serde_json::Error, text: &str) -> ReadError {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    let message = sentence(message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message));
    if error.is_data() {
        let what = format!("line {line} column {column}: {message}");
        return ReadError::Shape { what };
    }
    let before = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    let at = before.get(column.saturating_sub(1)..).unwrap_or_default();
    let literal = match at.trim_start_matches('-') {
        rest if rest.starts_with('N') => Some("NaN"),
        rest if rest.starts_with('I') => Some("Infinity"),
        _ => None,
    };
    match literal {
        Some(literal) => ReadError::NotANumber { line, column, literal },
        None => ReadError::Syntax { line, column, message },
    }
}

/// The keys of the file that matter.
#[derive(Default)]
struct Keys {
    version: Option<Value>,
    recipe: Option<Value>,
    georeference: Option<Value>,
    nodes: Option<Result<Vec<ParsedStation>, ReadError>>,
}

impl<'de> Deserialize<'de> for Keys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(KeysVisitor)
    }
}

struct KeysVisitor;

impl<'de> Visitor<'de> for KeysVisitor {
    type Value = Keys;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object with a key `nodes`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Keys, A::Error> {
        let mut keys = Keys::default();
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "plume" => keys.version = Some(map.next_value()?),
                "recipe" => keys.recipe = Some(map.next_value()?),
                "georeference" => keys.georeference = Some(map.next_value()?),
                "nodes" if keys.nodes.is_some() => {
                    return Err(A::Error::custom("the key `nodes` appears twice"));
                }
                "nodes" => keys.nodes = Some(map.next_value_seed(Nodes::default())?),
                _ => drop(map.next_value::<IgnoredAny>()?),
            }
        }
        Ok(keys)
    }
}

/// Each edge is listed at both ends.
const MAX_ENDS: usize = 2 * MAX_LEGS;

/// Collects stations until one is faulty.
#[derive(Default)]
struct Nodes {
    stations: Vec<ParsedStation>,
    /// Number of edges of all stations, as often as they are listed.
    edges: usize,
    fault: Option<ReadError>,
}

impl Nodes {
    fn take(&mut self, place: &str, keyed: bool, node: Value) {
        if self.fault.is_some() {
            return;
        }
        if self.stations.len() == MAX_STATIONS {
            self.fault = Some(ReadError::TooMany { what: "nodes", most: MAX_STATIONS });
            return;
        }
        match station(place, keyed, node) {
            Ok(station) if self.edges + station.edges.len() > MAX_ENDS => {
                self.fault = Some(ReadError::TooMany { what: "edges", most: MAX_LEGS });
            }
            Ok(station) => {
                self.edges += station.edges.len();
                self.stations.push(station);
            }
            Err(fault) => self.fault = Some(fault),
        }
    }

    fn done(self) -> Result<Vec<ParsedStation>, ReadError> {
        self.fault.map_or(Ok(self.stations), Err)
    }
}

impl<'de> DeserializeSeed<'de> for Nodes {
    type Value = Result<Vec<ParsedStation>, ReadError>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Nodes {
    type Value = Result<Vec<ParsedStation>, ReadError>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`nodes` to be a list, or an object keyed by id")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut nodes: A) -> Result<Self::Value, A::Error> {
        let mut place = 0;
        while let Some(node) = nodes.next_element()? {
            self.take(&format!("nodes[{place}]"), false, node);
            place += 1;
        }
        Ok(self.done())
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut nodes: A) -> Result<Self::Value, A::Error> {
        while let Some((key, node)) = nodes.next_entry::<String, Value>()? {
            self.take(&key, true, node);
        }
        Ok(self.done())
    }
}

/// Reads one node; `place` is its key if nodes are `keyed` by id.
fn station(place: &str, keyed: bool, node: Value) -> Result<ParsedStation, ReadError> {
    let label = if keyed { format!("node {}", plain(place)) } else { place.to_owned() };
    let Value::Object(fields) = node else {
        let what = format!("{label} must be an object, found {}", kind(&node));
        return Err(ReadError::Shape { what });
    };
    let id = match (fields.get("id"), keyed) {
        (None, true) => place.parse().ok(),
        (id, _) => id.and_then(Value::as_u64),
    };
    let Some(id) = id else {
        let fault = fields.get("id").map_or_else(
            || "is missing".to_owned(),
            |id| format!("must be a whole number, found {}", plain(&id.to_string())),
        );
        return Err(ReadError::Node { node: label, key: "id", fault });
    };
    let fields = Fields { id, fields };
    if keyed && place.parse() != Ok(id) {
        return Err(fields.fault("id", format!("differs from its key {}", shown(place))));
    }
    fields.station()
}

/// The fields of the node with this id.
struct Fields {
    id: u64,
    fields: Map<String, Value>,
}

impl Fields {
    fn station(&self) -> Result<ParsedStation, ReadError> {
        Ok(ParsedStation {
            id: self.id,
            parent: self.parent()?,
            edges: self.edges()?,
            position: self.position()?,
            radius: self.radius()?,
            active: self.active()?,
            level: self.level()?,
            section: self.section()?,
            // Other programs may keep something else under this key.
            name: self.get("name").and_then(Value::as_str).and_then(plume_graph::name),
        })
    }

    fn get(&self, key: &str) -> Option<&Value> {
        self.fields.get(key).filter(|value| !value.is_null())
    }

    fn parent(&self) -> Result<Option<u64>, ReadError> {
        let Some(value) = self.get("parent") else {
            return Ok(None);
        };
        match value.as_u64() {
            Some(parent) if parent == self.id => Err(self.fault("parent", "is the node itself".to_owned())),
            Some(parent) => Ok(Some(parent)),
            None => Err(self.unexpected("parent", "an id or null", value)),
        }
    }

    fn edges(&self) -> Result<Vec<u64>, ReadError> {
        let Some(value) = self.get("edges") else {
            return Ok(Vec::new());
        };
        let Value::Array(edges) = value else {
            return Err(self.unexpected("edges", "a list of ids", value));
        };
        edges
            .iter()
            .map(|edge| match edge.as_u64() {
                Some(id) if id == self.id => Err(self.fault("edges", "lead to the node itself".to_owned())),
                Some(id) => Ok(id),
                None => Err(self.unexpected("edges", "ids", edge)),
            })
            .collect()
    }

    fn position(&self) -> Result<Point3<f64>, ReadError> {
        let Some(value) = self.get("coordinates") else {
            return Err(self.fault("coordinates", "are missing".to_owned()));
        };
        let Value::Object(axes) = value else {
            return Err(self.unexpected("coordinates", "an object", value));
        };
        let x = self.coordinate("coordinates.x", axes.get("x"))?;
        let y = self.coordinate("coordinates.y", axes.get("y"))?;
        // Graphs drawn only in plan have no height.
        let z = match axes.get("z") {
            None => 0.0,
            z => self.coordinate("coordinates.z", z)?,
        };
        Ok(Point3::new(x, y, z).map(millimetres))
    }

    fn coordinate(&self, key: &'static str, value: Option<&Value>) -> Result<f64, ReadError> {
        let Some(value) = value else {
            return Err(self.fault(key, "is missing".to_owned()));
        };
        match value.as_f64() {
            Some(number) if number.abs() <= MAX_LENGTH_M => Ok(number),
            Some(_) => Err(self.fault(key, format!("is too far away: {value}"))),
            None => Err(self.unexpected(key, "a number", value)),
        }
    }

    fn radius(&self) -> Result<Option<f64>, ReadError> {
        self.get("radius").map(|value| self.length("radius", value)).transpose()
    }

    /// A length of at least 1 mm.
    fn length(&self, key: &'static str, value: &Value) -> Result<f64, ReadError> {
        match value.as_f64() {
            Some(number) if number > MAX_LENGTH_M => Err(self.fault(key, format!("is too large: {value}"))),
            Some(number) if millimetres(number) > 0.0 => Ok(millimetres(number)),
            Some(_) => Err(self.fault(key, format!("must be at least 0.001, found {value}"))),
            None => Err(self.unexpected(key, "a number", value)),
        }
    }

    fn active(&self) -> Result<bool, ReadError> {
        self.get("active")
            .map_or(Ok(false), |value| value.as_bool().ok_or_else(|| self.unexpected("active", "true or false", value)))
    }

    fn level(&self) -> Result<u32, ReadError> {
        self.get("level").map_or(Ok(0), |value| {
            let level = value.as_u64().and_then(|level| u32::try_from(level).ok());
            level.ok_or_else(|| self.unexpected("level", "a whole number", value))
        })
    }

    fn section(&self) -> Result<Option<Section>, ReadError> {
        let Some(value) = self.get("section") else {
            return Ok(None);
        };
        let (Some(width), Some(height)) = (value.get("width_m"), value.get("height_m")) else {
            return Err(self.fault("section", "has no `width_m` and `height_m`".to_owned()));
        };
        Ok(Some(Section {
            width_m: self.length("section.width_m", width)?,
            height_m: self.length("section.height_m", height)?,
            shape: self.shape(value.get("shape"))?,
        }))
    }

    fn shape(&self, value: Option<&Value>) -> Result<Shape, ReadError> {
        let read = |value: &Value| {
            let shape = Shape::deserialize(value);
            shape.map_err(|_| self.unexpected("section.shape", "`drift` or `cave`", value))
        };
        value.map_or(Ok(Shape::Drift), read)
    }

    fn unexpected(&self, key: &'static str, expected: &str, found: &Value) -> ReadError {
        self.fault(key, format!("must be {expected}, found {}", kind(found)))
    }

    fn fault(&self, key: &'static str, fault: String) -> ReadError {
        ReadError::Node { node: format!("node {}", self.id), key, fault }
    }
}

/// A value in words, shortened for a message.
fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(value) => format!("`{value}`"),
        Value::Number(number) => format!("the number {number}"),
        Value::String(text) => format!("the string {}", shown(text)),
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "an object".to_owned(),
    }
}

//! The names of station properties in tables and attributed graphs.

use nalgebra::Point3;

use super::draft::node_at;
use super::text::{LENGTH_HINT, coordinate, length, whole};
use plume_graph::echo::shown;
use plume_graph::{Node, Section, Shape};

/// A property of a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    X,
    Y,
    Z,
    Radius,
    Width,
    Height,
    Shape,
    Level,
    Active,
    Name,
}

/// The spellings of each, ours first; letters and digits in lower case.
const SPELLINGS: &[(Field, &[&str])] = &[
    (Field::X, &["x", "xm", "posx", "xpos", "easting", "east"]),
    (Field::Y, &["y", "ym", "posy", "ypos", "northing", "north"]),
    (Field::Z, &["z", "zm", "posz", "zpos", "elevation", "altitude", "alt"]),
    (Field::Radius, &["radius", "radiusm"]),
    (Field::Width, &["widthm", "width", "cswidth"]),
    (Field::Height, &["heightm", "height", "csheight"]),
    (Field::Shape, &["shape"]),
    (Field::Level, &["level", "layer", "storey"]),
    (Field::Active, &["active"]),
    (Field::Name, &["name", "station", "stationname"]),
];

/// The property of this name, ignoring case and punctuation.
pub(super) fn field(name: &str) -> Option<Field> {
    let letters = name.chars().filter(char::is_ascii_alphanumeric).map(|letter| letter.to_ascii_lowercase());
    let name: String = letters.take(16).collect();
    SPELLINGS.iter().find(|(_, names)| names.contains(&name.as_str())).map(|(field, _)| *field)
}

/// What a file says about one station.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Fields {
    x: Option<f64>,
    y: Option<f64>,
    z: Option<f64>,
    radius: f64,
    width_m: f64,
    height_m: f64,
    shape: Option<Shape>,
    level: u32,
    active: bool,
    name: Option<Box<str>>,
}

impl Fields {
    /// Sets a value from text; an empty one is ignored. Fails with what is wrong and a hint.
    pub(super) fn set(&mut self, field: Field, text: &str) -> Result<(), (String, &'static str)> {
        let hint = match field {
            Field::Level => "levels are whole numbers, counted from 0 at the top",
            Field::Active => "`active` says whether a dead end may grow further: true or false",
            _ => LENGTH_HINT,
        };
        self.read(field, text.trim()).map_err(|fault| (fault, hint))
    }

    fn read(&mut self, field: Field, text: &str) -> Result<(), String> {
        if text.is_empty() {
            return Ok(());
        }
        match field {
            Field::X => self.x = Some(coordinate(text)?),
            Field::Y => self.y = Some(coordinate(text)?),
            Field::Z => self.z = Some(coordinate(text)?),
            Field::Radius => self.radius = length(text)?,
            Field::Width => self.width_m = length(text)?,
            Field::Height => self.height_m = length(text)?,
            // Shapes of other programs, such as `circle` or `round`, are not mine drifts.
            Field::Shape => self.shape = Some(if text == "drift" { Shape::Drift } else { Shape::Cave }),
            Field::Level => self.level = whole(text)?,
            Field::Active => self.active = truth(text)?,
            Field::Name => self.name = plume_graph::name(text),
        }
        Ok(())
    }

    /// Uses the position of its drawing if the file gives no other.
    pub(super) fn draw_at(&mut self, [x, y]: [f64; 2]) {
        self.x = self.x.or(Some(x));
        self.y = self.y.or(Some(y));
    }

    /// The node; without a height it is at 0. Fails with the missing coordinate.
    pub(super) fn node(self, id: u64) -> Result<Node, &'static str> {
        let place = Point3::new(self.x.ok_or("x")?, self.y.ok_or("y")?, self.z.unwrap_or_default());
        let (width_m, height_m) = (self.width_m, self.height_m);
        let shape = self.shape.unwrap_or(Shape::Cave);
        let section = (width_m > 0.0 && height_m > 0.0).then_some(Section { width_m, height_m, shape });
        let Self { radius, level, active, name, .. } = self;
        Ok(Node { radius, section, level, active, name, ..node_at(id, place) })
    }
}

fn truth(text: &str) -> Result<bool, String> {
    match text.to_ascii_lowercase().as_str() {
        "true" | "1" => Ok(true),
        "false" | "0" => Ok(false),
        _ => Err(format!("{} is neither true nor false", shown(text))),
    }
}

/// Name of a shape in files.
pub(super) fn shape_name(shape: Shape) -> &'static str {
    match shape {
        Shape::Drift => "drift",
        Shape::Cave => "cave",
    }
}

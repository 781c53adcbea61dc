//! Where a surveyed cave lies on the earth, and what its stations are called there.

use nalgebra::Point3;

use super::Graph;
use super::echo::steers;

/// Longest name of a station or a coordinate system that is kept, in bytes.
pub const MAX_NAME_BYTES: usize = 200;

/// Largest coordinate of an origin, in metres: no place on earth has a larger one in any grid.
pub const MAX_ORIGIN_M: f64 = 1e8;

/// The origin of a graph in the coordinates of the survey that it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Georeference {
    /// The place of the graph's origin in metres: east, north, up.
    pub origin_m: Point3<f64>,
    /// The coordinate system as the survey names it, such as `EPSG:32633` or `UTM33N`.
    pub system: Option<Box<str>>,
}

impl Georeference {
    /// The same, or `None` if it says nothing, as the origin is that of an unknown system, or is nowhere on earth.
    pub fn of(origin_m: Point3<f64>, system: Option<Box<str>>) -> Option<Self> {
        let says_something = system.is_some() || origin_m != Point3::origin();
        let is_on_earth = origin_m.iter().all(|x| x.abs() <= MAX_ORIGIN_M);
        (says_something && is_on_earth).then_some(Self { origin_m, system })
    }
}

impl Graph {
    /// The same graph without names of stations and georeference: what the shape of the cave depends on.
    pub fn anonymous(&self) -> Self {
        let mut graph = self.clone();
        graph.nodes.iter_mut().for_each(|node| node.name = None);
        graph.georeference = None;
        graph
    }
}

/// A name from a file, without blanks around it. `None` if it is empty, longer than [`MAX_NAME_BYTES`], or has characters that
/// control a terminal or cannot be in XML.
pub fn name(text: &str) -> Option<Box<str>> {
    let text = text.trim();
    let is_usable = !text.is_empty() && text.len() <= MAX_NAME_BYTES;
    let is_plain = |c: char| !steers(c) && !matches!(c, '\u{fffe}' | '\u{ffff}');
    (is_usable && text.chars().all(is_plain)).then(|| text.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_and_harmless() {
        assert_eq!(name(" 3.höhle.12a ").as_deref(), Some("3.höhle.12a"));
        let long = "n".repeat(MAX_NAME_BYTES);
        assert_eq!(name(&long).as_deref(), Some(long.as_str()));
        for refused in ["", "  ", "a\u{1b}[2J", "a\u{202e}b", "a\nb", "a\u{ffff}", &format!("{long}n")] {
            assert_eq!(name(refused), None, "{refused:?}");
        }
    }

    #[test]
    fn a_georeference_says_something() {
        assert_eq!(Georeference::of(Point3::origin(), None), None);
        assert!(Georeference::of(Point3::origin(), name("EPSG:32633")).is_some());
        assert!(Georeference::of(Point3::new(0.0, 0.0, 7.0), None).is_some());
        assert_eq!(Georeference::of(Point3::new(0.0, f64::NAN, 2e8), name("EPSG:32633")), None);
    }
}

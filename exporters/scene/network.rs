//! The network of passages: what lies along the middle of the world.

use nalgebra::Point3;
use plume_truth::Passage;

/// Stations, and the passages between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Network {
    /// Places in the air.
    pub stations: Vec<Station>,
    /// Straight lines between two different stations.
    pub passages: Vec<Passage>,
}

/// A station of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Its name: letters, digits and `_`, unique in the network.
    pub name: String,
    /// Its place in metres.
    pub position: Point3<f64>,
    /// Its level, counted from 0 at the top.
    pub level: u32,
}

impl Network {
    /// The network as a robot is certified on it.
    pub fn ways(&self) -> plume_truth::Network {
        let stations = self.stations.iter().map(|station| station.position.coords.into()).collect();
        plume_truth::Network { stations, passages: self.passages.clone() }
    }

    /// What is wrong with it.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let mut names: Vec<&str> = self.stations.iter().map(|station| station.name.as_str()).collect();
        names.sort_unstable();
        let is_name =
            |name: &str| !name.is_empty() && name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
        if names.windows(2).any(|pair| pair[0] == pair[1]) || !names.into_iter().all(is_name) {
            return Some("the name of a station is taken or not `[a-zA-Z0-9_]+`");
        }
        let is_line = |Passage { ends: [a, b], .. }: &Passage| a != b && *a.max(b) < self.stations.len();
        (!self.passages.iter().all(is_line)).then_some("a passage is not between two of its stations")
    }
}

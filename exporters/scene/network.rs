//! The network of passages: what lies along the middle of the world.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Point3};
use plume_truth::Passage;

use crate::names;

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
    /// What it is called in the survey that the world was made from.
    pub label: Option<String>,
}

/// A station that a survey names, as a frame in files.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark<'a> {
    /// A safe name, unique among the landmarks: `station_` and what the survey calls it, as far as that is safe.
    pub frame: String,
    /// What the survey calls it.
    pub label: &'a str,
    /// Its place in metres.
    pub position: Point3<f64>,
}

/// Where a world lies in the coordinates of the survey that it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Georeference {
    /// The place of the origin in metres: east, north, up.
    pub origin_m: [f64; 3],
    /// The coordinate system as the survey names it.
    pub system: Option<String>,
}

impl Landmark<'_> {
    /// Its place, turned like the world.
    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::translation(self.position.x, self.position.y, self.position.z)
    }
}

impl Network {
    /// The network as a robot is certified on it.
    pub fn ways(&self) -> plume_truth::Network {
        let stations = self.stations.iter().map(|station| station.position.coords.into()).collect();
        plume_truth::Network { stations, passages: self.passages.clone() }
    }

    /// The stations that a survey names, in their order.
    pub fn landmarks(&self) -> Vec<Landmark<'_>> {
        let mut taken = BTreeSet::new();
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        let mut landmarks = Vec::new();
        for station in &self.stations {
            let Some(label) = station.label.as_deref() else { continue };
            let base = names::safe(&format!("station {label}"));
            let count = counts.entry(base.clone()).or_insert(1);
            let mut frame = base.clone();
            while !taken.insert(frame.clone()) {
                *count += 1;
                frame = format!("{base}_{count}");
            }
            landmarks.push(Landmark { frame, label, position: station.position });
        }
        landmarks
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_landmarks_are_safe_and_unique() {
        let labels = [Some("Hall.1"), None, Some("hall.1"), Some("hall 1 2"), Some("hall/1"), Some("höhle"), Some("7")];
        let station = |(number, label): (usize, &Option<&str>)| Station {
            name: number.to_string(),
            position: Point3::new(number as f64, 0.0, 0.0),
            level: 0,
            label: label.map(str::to_owned),
        };
        let network = Network { stations: labels.iter().enumerate().map(station).collect(), passages: Vec::new() };
        let landmarks = network.landmarks();
        let frames: Vec<&str> = landmarks.iter().map(|landmark| landmark.frame.as_str()).collect();
        let expected = [
            "station_hall_1",
            "station_hall_1_2",
            "station_hall_1_2_2",
            "station_hall_1_3",
            "station_h_hle",
            "station_7",
        ];
        assert_eq!(frames, expected);
        assert!(frames.iter().all(|frame| names::is_safe(frame)));
        assert_eq!((landmarks[1].label, landmarks[1].position.x), ("hall.1", 2.0));
    }
}

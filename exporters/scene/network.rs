//! The network of passages: what lies along the middle of the world.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Point3};
use plume_truth::Passage;

use crate::names;

/// Most stations that are frames in files. Chosen: editors and simulators open ten thousand empty nodes, but hardly a hundred
/// thousand.
pub const MOST_FRAMES: usize = 10_000;

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
    /// Its number among the stations of the network.
    pub station: usize,
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

    /// The stations that are frames in files, in their order: the [foremost](Self::foremost) [`MOST_FRAMES`].
    pub fn landmarks(&self) -> Vec<Landmark<'_>> {
        self.foremost(MOST_FRAMES)
    }

    /// Not more than `most` of the stations that a survey names, in their order. If these are more, those where passages end or
    /// meet come before the others.
    pub fn foremost(&self, most: usize) -> Vec<Landmark<'_>> {
        let mut landmarks = self.named();
        if landmarks.len() > most {
            let mut degrees = vec![0_usize; self.stations.len()];
            self.passages.iter().flat_map(|passage| passage.ends).for_each(|end| degrees[end] += 1);
            landmarks.sort_by_key(|landmark| degrees[landmark.station] == 2);
            landmarks.truncate(most);
            landmarks.sort_by_key(|landmark| landmark.station);
        }
        landmarks
    }

    /// Whether a survey names any station.
    pub fn has_names(&self) -> bool {
        self.stations.iter().any(|station| station.label.is_some())
    }

    /// All stations that a survey names, in their order.
    pub fn named(&self) -> Vec<Landmark<'_>> {
        let mut taken = BTreeSet::new();
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        let mut landmarks = Vec::new();
        for (number, station) in self.stations.iter().enumerate() {
            let Some(label) = station.label.as_deref() else { continue };
            let base = names::safe(&format!("station {label}"));
            let count = counts.entry(base.clone()).or_insert(1);
            let mut frame = base.clone();
            while !taken.insert(frame.clone()) {
                *count += 1;
                frame = format!("{base}_{count}");
            }
            landmarks.push(Landmark { station: number, frame, label, position: station.position });
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

    /// A long passage with a short one off its middle.
    #[test]
    fn of_too_many_stations_ends_and_junctions_are_frames() {
        let count = MOST_FRAMES + 3;
        let station = |number: usize| Station {
            name: number.to_string(),
            position: Point3::new(number as f64, 0.0, 0.0),
            level: 0,
            label: Some(format!("{number}")),
        };
        let passage = |ends| Passage { ends, reach_m: 1.0 };
        let mut passages: Vec<Passage> = (2..count).map(|number| passage([number - 1, number])).collect();
        passages.push(passage([0, count - 2]));
        let network = Network { stations: (0..count).map(station).collect(), passages };
        assert_eq!(network.named().len(), count);
        let kept: Vec<usize> = network.landmarks().iter().map(|landmark| landmark.station).collect();
        assert_eq!(kept.len(), MOST_FRAMES);
        assert!(kept.is_sorted());
        assert!([0, 1, count - 2, count - 1].iter().all(|station| kept.contains(station)));
        let names = |landmarks: Vec<Landmark>| landmarks.into_iter().map(|each| (each.station, each.frame)).collect();
        let (some, all): (BTreeMap<_, _>, BTreeMap<_, _>) = (names(network.landmarks()), names(network.named()));
        assert!(some.iter().all(|(station, frame)| all[station] == *frame), "a frame has the same name in the table");
    }
}

//! The files of the network of passages: a graph, and a survey of it.

use plume_graph::rng::Rng;
use plume_graph::seed;
use plume_truth::{Certificate, Floor, Passage, Room, Verdict};
use serde_json::{Value, json};

use super::TruthSettings;
use super::table::{Entry, Table};
use crate::error::ExportError;
use crate::format::graphml::{GraphMl, Key};
use crate::format::survex::{Aim, Errors, Leg, Section, Survey};
use crate::frame::milli;
use crate::package::Package;
use crate::scene::{Network, Scene, Station};

/// Steepest reading of a clinometer in degrees: what is steeper is plumbed.
const MOST_DEG: f64 = 89.9999;

/// What nodes and edges have.
const KEYS: [Key; 13] = [
    node("x", "double"),
    node("y", "double"),
    node("z", "double"),
    node("level", "int"),
    node("width_m", "double"),
    node("height_m", "double"),
    edge("length_m", "double"),
    edge("slope_deg", "double"),
    edge("widest_m", "double"),
    edge("class", "string"),
    edge("stopped_by", "string"),
    edge("value", "double"),
    edge("limit", "double"),
];

const fn node(name: &'static str, kind: &'static str) -> Key {
    Key { name, is_of_edges: false, kind }
}

const fn edge(name: &'static str, kind: &'static str) -> Key {
    Key { name, is_of_edges: true, kind }
}

/// The network in its world.
pub struct Topology<'a> {
    /// The scene.
    pub scene: &'a Scene<'a>,
    /// The floor around it.
    pub floor: &'a Floor,
    /// Those of the target.
    pub settings: &'a TruthSettings,
}

impl Topology<'_> {
    /// Writes `network.graphml`: two edges for each passage, as what a robot gets through may depend on the direction.
    pub fn write_network(
        &self,
        certificate: &Certificate,
        table: &mut Table,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let Network { stations, passages } = &self.scene.network;
        let mut graph = GraphMl::new(&KEYS);
        let headings = self.headings();
        for (Station { name, position, level, .. }, heading_rad) in stations.iter().zip(headings) {
            let [x, y, z] = position.coords.into();
            let mut values =
                vec![("x", x.to_string()), ("y", y.to_string()), ("z", z.to_string()), ("level", level.to_string())];
            if let Some(Room { left_m, right_m, up_m, down_m }) = Room::around(self.floor, [x, y, z], heading_rad) {
                values.push(("width_m", milli(left_m + right_m).to_string()));
                values.push(("height_m", milli(up_m + down_m).to_string()));
            }
            graph.node(name, &values);
        }
        for (Passage { ends, .. }, through) in passages.iter().zip(&certificate.passages) {
            for (ends, verdict) in [(*ends, &through.there), ([ends[1], ends[0]], &through.back)] {
                let [length_m, slope_rad] = [self.length_m(ends), self.slope_rad(ends)];
                let mut values = vec![
                    ("length_m", milli(length_m).to_string()),
                    ("slope_deg", milli(slope_rad.to_degrees()).to_string()),
                    ("widest_m", milli(through.widest_m).to_string()),
                ];
                values.extend(judged(verdict));
                graph.edge(ends.map(|end| stations[end].name.as_str()), &values);
            }
        }
        out.text("network.graphml", &graph.finish())?;
        let content = "stations, and passages each way: length, slope, and whether the robot gets through";
        table.add(Entry::new("network.graphml", content, "m, deg"));
        Ok(())
    }

    /// Writes `survey.svx`.
    pub fn write_survey(&self, table: &mut Table, out: &mut dyn Package) -> Result<(), ExportError> {
        let Network { stations, passages } = &self.scene.network;
        let TruthSettings { tape_sd_m: tape_m, angle_sd_deg: angle_deg, .. } = *self.settings;
        let has_errors = tape_m > 0.0 || angle_deg > 0.0;
        let name = |station: usize| stations[station].name.as_str();
        let survey = Survey {
            name: &self.scene.name,
            generator: &self.scene.generator,
            errors: has_errors.then_some(Errors { tape_m, angle_deg }),
            fixed: self.firsts().map(|first| (name(first), stations[first].position.coords.into())).collect(),
            legs: (0..).zip(passages).map(|(number, passage)| self.leg(number, passage.ends)).collect(),
            passages: passages.iter().filter_map(|passage| self.sections(passage.ends)).collect(),
        };
        out.text("survey.svx", &survey.text())?;
        table.add(Entry::new(
            "survey.svx",
            "survey along the passages, as with tape, compass and clinometer",
            "m, deg",
        ));
        Ok(())
    }

    /// Lengths of passages in all, on each level, and between levels, in metres.
    pub fn summary(&self) -> Value {
        let Network { stations, passages } = &self.scene.network;
        let levels = |passage: &Passage| passage.ends.map(|end| stations[end].level);
        let length_m = |is_own: &dyn Fn(&Passage) -> bool| {
            let own = passages.iter().filter(|passage| is_own(passage));
            milli(own.map(|passage| self.length_m(passage.ends)).fold(0.0, |sum, length_m| sum + length_m))
        };
        let deepest = stations.iter().map(|station| station.level).max();
        let of_level =
            |level: u32| json!({ "level": level, "length_m": length_m(&|passage| levels(passage) == [level; 2]) });
        json!({
            "stations": stations.len(),
            "passages": passages.len(),
            "length_m": length_m(&|_| true),
            "levels": deepest.map_or_else(Vec::new, |deepest| (0..=deepest).map(of_level).collect()),
            "tape_sd_m": self.settings.tape_sd_m,
            "angle_sd_deg": self.settings.angle_sd_deg,
            "between_levels_m": length_m(&|passage| levels(passage)[0] != levels(passage)[1]),
        })
    }

    /// A leg as it is read from the first of these stations.
    fn leg(&self, number: u64, ends: [usize; 2]) -> Leg<'_> {
        let [x, y, z] = self.along(ends);
        let mut random = Rng::new(seed::stream(self.scene.seed, "survey", number));
        let TruthSettings { tape_sd_m, angle_sd_deg, .. } = *self.settings;
        let mut read = |value: f64, sd: f64| value + sd * random.normal();
        let tape_m = read(self.length_m(ends), tape_sd_m).max(0.0);
        let compass_deg = read(libm::atan2(x, y).to_degrees(), angle_sd_deg).rem_euclid(360.0);
        let clino_deg = read(self.slope_rad(ends).to_degrees(), angle_sd_deg).clamp(-MOST_DEG, MOST_DEG);
        // Rounding must not make a full turn of what is almost one.
        let compass_deg = if compass_deg >= 359.999_95 { 0.0 } else { compass_deg };
        let aim = match (x, y) {
            (0.0, 0.0) if z > 0.0 => Aim::Up,
            (0.0, 0.0) => Aim::Down,
            _ => Aim::Bearing { compass_deg, clino_deg },
        };
        Leg { ends: ends.map(|end| self.scene.network.stations[end].name.as_str()), tape_m, aim }
    }

    /// The sections at both ends of a passage for one who looks along it; `None` if one is not in the air.
    fn sections(&self, ends: [usize; 2]) -> Option<[Section<'_>; 2]> {
        let heading_rad = self.heading(ends);
        let section = |end: usize| {
            let Station { name, position, .. } = &self.scene.network.stations[end];
            let Room { left_m, right_m, up_m, down_m } = Room::around(self.floor, position.coords.into(), heading_rad)?;
            Some(Section { station: name, room_m: [left_m, right_m, up_m, down_m] })
        };
        Some([section(ends[0])?, section(ends[1])?])
    }

    /// The first station of each part of the network.
    fn firsts(&self) -> impl Iterator<Item = usize> + use<> {
        let Network { stations, passages } = &self.scene.network;
        let mut first: Vec<usize> = (0..stations.len()).collect();
        let root = |first: &[usize], mut at: usize| {
            while first[at] != at {
                at = first[at];
            }
            at
        };
        for Passage { ends, .. } in passages {
            let roots = ends.map(|end| root(&first, end));
            first[roots[0].max(roots[1])] = roots[0].min(roots[1]);
        }
        first.into_iter().enumerate().filter(|(station, first)| station == first).map(|(station, _)| station)
    }

    /// For each station, the direction of the first passage at it, from +x towards +y in radians.
    fn headings(&self) -> Vec<f64> {
        let Network { stations, passages } = &self.scene.network;
        let mut headings = vec![0.0; stations.len()];
        for Passage { ends, .. } in passages.iter().rev() {
            ends.iter().for_each(|end| headings[*end] = self.heading(*ends));
        }
        headings
    }

    fn heading(&self, ends: [usize; 2]) -> f64 {
        let [x, y, _] = self.along(ends);
        libm::atan2(y, x)
    }

    /// Upwards, in radians.
    fn slope_rad(&self, ends: [usize; 2]) -> f64 {
        let [x, y, z] = self.along(ends);
        libm::atan2(z, libm::hypot(x, y))
    }

    fn length_m(&self, ends: [usize; 2]) -> f64 {
        let [x, y, z] = self.along(ends);
        libm::hypot(libm::hypot(x, y), z)
    }

    fn along(&self, [from, to]: [usize; 2]) -> [f64; 3] {
        let stations = &self.scene.network.stations;
        (stations[to].position - stations[from].position).into()
    }
}

/// The class of a passage, and what stops the robot there.
fn judged(verdict: &Verdict) -> Vec<(&'static str, String)> {
    let mut values = vec![("class", verdict.class.name().to_owned())];
    if let Some((fault, _)) = verdict.fault {
        values.push(("stopped_by", fault.cause.name().to_owned()));
        let [value, limit] = fault.at_edge().map(|value| milli(value).to_string());
        values.extend([("value", value), ("limit", limit)]);
    }
    values
}

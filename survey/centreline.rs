//! Collects what survey files say about named stations, until all of it is known.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Point3, Vector3};

use super::files::{FilePosition, Files};
use super::limits::{MAX_LEGS, MAX_STATIONS};
use super::measure::Measured;
use super::survey::{Leg, Survey, SurveyStation, Walls};
use super::traverse::{Fix, Shot, Traverse};
use super::unplaced::Remaining;
use super::{Import, Parts, ReadError, Source, Tally};
use plume_graph::MAX_NAME_BYTES;
use plume_graph::echo::shown;

/// Number of stations listed if a survey has disconnected pieces: one of each piece.
const NAMED: usize = 10;
const PIECES_HINT: &str = "fix a station in each piece, equate stations of different pieces, or add the missing shots; \
     `--set graph.parts=join` (or `keep`) lays the pieces beside each other, `longest` keeps one; at an import `--parts join`";
const UNPLACED_HINT: &str =
    "legs of style `nosurvey` have no length: fix a station in what lies behind them, or add readings";

/// A name within a survey: index into [`Names`].
pub(super) type Name = usize;

/// The tree of survey and station names.
#[derive(Debug)]
pub(super) struct Names {
    below: Vec<BTreeMap<Box<str>, Name>>,
}

impl Default for Names {
    fn default() -> Self {
        Self { below: vec![BTreeMap::new()] }
    }
}

impl Names {
    /// The root of all names.
    pub(super) const ROOT: Name = 0;

    /// The child of another name, created if it is new.
    ///
    /// # Errors
    /// If there are too many.
    pub(super) fn below(&mut self, above: Name, name: &str) -> Result<Name, String> {
        if let Some(&known) = self.below[above].get(name) {
            return Ok(known);
        }
        let new = self.add()?;
        self.below[above].insert(name.into(), new);
        Ok(new)
    }

    /// Adds an anonymous station.
    ///
    /// # Errors
    /// If there are too many.
    pub(super) fn add(&mut self) -> Result<Name, String> {
        check_room(self.below.len(), MAX_NAMES, "stations and surveys")?;
        self.below.push(BTreeMap::new());
        Ok(self.below.len() - 1)
    }

    /// What each name is called, and within which other name; `None` for the root and anonymous ones.
    fn above(&self) -> Vec<Option<(Name, &str)>> {
        let mut above: Vec<Option<(Name, &str)>> = vec![None; self.below.len()];
        for (survey, below) in self.below.iter().enumerate() {
            below.iter().for_each(|(name, &of)| above[of] = Some((survey, name)));
        }
        above
    }

    /// The full names of some stations, for messages.
    fn told(&self, names: impl Iterator<Item = Name>) -> String {
        let above = self.above();
        let told = names.map(|name| shown(&path(&above, name)));
        told.collect::<Vec<_>>().join(", ")
    }

    /// The full name of each name, such as `cave.series.12`, as far as it is short enough to be kept.
    fn full(&self) -> impl Fn(Name) -> Option<Box<str>> {
        let above = self.above();
        // Names come after those above them.
        let mut bytes = vec![0; above.len()];
        for (name, above) in above.iter().enumerate() {
            if let Some((survey, part)) = above {
                bytes[name] = bytes[*survey] + usize::from(bytes[*survey] > 0) + part.len();
            }
        }
        move |name| {
            let is_short = (1..=MAX_NAME_BYTES).contains(&bytes[name]);
            if is_short { plume_graph::name(&path(&above, name)) } else { None }
        }
    }
}

/// A name after those that it is within, with dots between them.
fn path(above: &[Option<(Name, &str)>], name: Name) -> String {
    let steps = std::iter::successors(above[name], |&(survey, _)| above[survey]);
    let mut parts: Vec<&str> = steps.map(|(_, part)| part).collect();
    parts.reverse();
    parts.join(".")
}

/// Limit on names of stations and surveys: a station may have several names.
const MAX_NAMES: usize = 2 * MAX_STATIONS;
/// Limit on cross-sections: one at each end of a leg.
const MAX_SECTIONS: usize = 2 * MAX_LEGS;

fn check_room(count: usize, most: usize, what: &str) -> Result<(), String> {
    if count < most { Ok(()) } else { Err(format!("the survey has more than {most} {what}")) }
}

/// A claimed position of a station.
struct Claim {
    name: Name,
    position: Point3<f64>,
    covariance: Option<Matrix3<f64>>,
    file_position: FilePosition,
}

/// A cross-section with named stations.
pub(super) struct Section {
    pub(super) station: Name,
    pub(super) looking: [Name; 2],
    /// Left, right, up and down in metres.
    pub(super) walls_m: [Option<f64>; 4],
}

fn is_noted(walls_m: &[Option<f64>; 4]) -> bool {
    walls_m.iter().any(Option::is_some)
}

/// Flags of shots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Flags {
    surface: bool,
    duplicate: bool,
    splay: bool,
}

impl Flags {
    /// Sets flags from words: `not` switches the next one off, flags that are not mentioned stay.
    pub(super) fn read(&mut self, words: &[&str]) -> Result<(), String> {
        let mut on = true;
        for word in words {
            let flag = match word.to_ascii_lowercase().as_str() {
                "not" => {
                    on = false;
                    continue;
                }
                "surface" => &mut self.surface,
                "duplicate" => &mut self.duplicate,
                "splay" => &mut self.splay,
                "approx" | "approximate" => {
                    on = true;
                    continue;
                }
                _ => return Err(format!("{} is not a flag", shown(word))),
            };
            *flag = on;
            on = true;
        }
        Ok(())
    }

    /// The kind of a shot that may end at a wall.
    pub(super) fn leg(self, at_wall: bool) -> Leg {
        if self.splay || at_wall {
            Leg::Splay
        } else if self.surface {
            Leg::Surface
        } else if self.duplicate {
            Leg::Duplicate
        } else {
            Leg::Passage
        }
    }
}

/// What has been read so far.
#[derive(Default)]
pub(super) struct Centreline {
    pub(super) names: Names,
    /// Union-find of equated stations.
    same: BTreeMap<Name, Name>,
    legs: Vec<([Name; 2], Leg)>,
    shots: Vec<([Name; 2], Vector3<f64>, Matrix3<f64>)>,
    /// How many times in a row the last shot was measured.
    repeats: usize,
    sections: Vec<Section>,
    claims: Vec<Claim>,
    entrances: BTreeSet<Name>,
    /// The cross-sections of the passage that is being read.
    tube: Vec<(Name, [Option<f64>; 4])>,
    /// The coordinate system, as it was first written.
    system: Option<String>,
    /// Readings that are probably mistakes, at most [`MAX_DOUBTS`].
    doubts: Vec<(FilePosition, String)>,
    /// Number of all of them.
    doubtful: usize,
}

/// Most doubtful readings that are told.
const MAX_DOUBTS: usize = 100;

impl Centreline {
    /// Adds a leg.
    ///
    /// # Errors
    /// If there are too many.
    pub(super) fn leg(&mut self, ends: [Name; 2], leg: Leg, measured: Measured) -> Result<(), String> {
        check_room(self.legs.len(), MAX_LEGS, "legs")?;
        if measured == Measured::Nothing {
            self.equate(ends[0], ends[1]);
            return Ok(());
        }
        if ends[0] == ends[1] {
            return Err("the shot ends at the station where it starts".to_owned());
        }
        if self.repeat(ends, &measured) {
            return Ok(());
        }
        self.legs.push((ends, leg));
        if let Measured::Shot { vector, covariance } = measured {
            self.shots.push((ends, vector, covariance));
            self.repeats = 1;
        }
        Ok(())
    }

    /// Consecutive shots between the same stations count as one shot, their mean.
    fn repeat(&mut self, ends: [Name; 2], measured: &Measured) -> bool {
        let (Measured::Shot { vector: again, .. }, Some((last, vector, _))) = (measured, self.shots.last_mut()) else {
            return false;
        };
        if *last != ends {
            return false;
        }
        self.repeats += 1;
        *vector += (again - *vector) / self.repeats as f64;
        true
    }

    /// Equates two stations.
    pub(super) fn equate(&mut self, a: Name, b: Name) {
        let (a, b) = (self.found(a), self.found(b));
        if a != b {
            self.same.insert(a.max(b), a.min(b));
        }
    }

    /// The representative of a station.
    fn found(&mut self, name: Name) -> Name {
        let mut at = name;
        while let Some(&next) = self.same.get(&at) {
            at = next;
        }
        // Path compression, so that chains of equates are walked once.
        let mut walked = name;
        while let Some(next) = self.same.get_mut(&walked).filter(|next| **next != at) {
            walked = std::mem::replace(next, at);
        }
        at
    }

    /// Fixes a station; without covariance, exactly.
    ///
    /// # Errors
    /// If there are too many.
    pub(super) fn fix(
        &mut self,
        name: Name,
        position: Point3<f64>,
        covariance: Option<Matrix3<f64>>,
        file_position: FilePosition,
    ) -> Result<(), String> {
        check_room(self.claims.len(), MAX_STATIONS, "fixes")?;
        self.claims.push(Claim { name, position, covariance, file_position });
        Ok(())
    }

    /// Marks a station as an entrance.
    pub(super) fn entrance(&mut self, name: Name) {
        self.entrances.insert(name);
    }

    /// Records what is doubtful about the readings in a line.
    pub(super) fn doubt(&mut self, file_position: FilePosition, doubts: Vec<String>) {
        self.doubtful += doubts.len();
        let room = MAX_DOUBTS.saturating_sub(self.doubts.len());
        self.doubts.extend(doubts.into_iter().take(room).map(|doubt| (file_position, doubt)));
    }

    /// Records distances to walls, if there are any.
    ///
    /// # Errors
    /// If there are too many.
    pub(super) fn section(&mut self, section: Section) -> Result<(), String> {
        check_room(self.sections.len(), MAX_SECTIONS, "cross-sections")?;
        if is_noted(&section.walls_m) {
            self.sections.push(section);
        }
        Ok(())
    }

    /// Adds a cross-section to the current passage.
    ///
    /// # Errors
    /// If there are too many.
    pub(super) fn add_to_tube(&mut self, station: Name, walls_m: [Option<f64>; 4]) -> Result<(), String> {
        check_room(self.sections.len() + self.tube.len(), MAX_SECTIONS, "cross-sections")?;
        self.tube.push((station, walls_m));
        Ok(())
    }

    /// Records the cross-sections of the passage: at its ends the direction is that of the first and last leg, elsewhere from
    /// the previous to the next station.
    pub(super) fn end_tube(&mut self) {
        let tube = std::mem::take(&mut self.tube);
        for (place, &(station, walls_m)) in tube.iter().enumerate().filter(|(_, (_, walls_m))| is_noted(walls_m)) {
            let before = tube[place.saturating_sub(1)].0;
            let behind = tube[(place + 1).min(tube.len() - 1)].0;
            self.sections.push(Section { station, looking: [before, behind], walls_m });
        }
    }

    /// Sets the coordinate system, which has to be the only one.
    ///
    /// # Errors
    /// If positions would have to be projected or rotated.
    pub(super) fn set_system(&mut self, system: &str) -> Result<(), String> {
        let name = system;
        let system = system.to_ascii_lowercase();
        if ["long-lat", "lat-long", "etrs", "epsg:4326", "epsg:4258", "jtsk", "jtsk03"].contains(&system.as_str()) {
            return Err(format!("coordinates in {} would have to be projected", shown(&system)));
        }
        match &self.system {
            // The name of the other may be from a file of which nothing may be shown.
            Some(known) if known.to_ascii_lowercase() != system => Err(format!(
                "coordinates in {} would have to be projected, since others are in another system",
                shown(&system)
            )),
            _ => {
                self.system.get_or_insert_with(|| name.to_owned());
                Ok(())
            }
        }
    }

    /// Sets the coordinate system to UTM in a zone of a datum.
    pub(super) fn set_datum(&mut self, datum: &str, zone: &str) {
        self.system = Some(format!("{datum}, UTM zone {zone}"));
    }

    /// The graph of everything that was read.
    pub(super) fn into_import(mut self, source: &Source, parts: Parts, files: &Files) -> Result<Import, ReadError> {
        self.end_tube();
        let mut numbers = Numbers { of: vec![None; self.names.below.len()], count: 0 };
        let legs: Vec<([Name; 2], Leg)> = std::mem::take(&mut self.legs);
        let mut legs: Vec<([usize; 2], Leg)> =
            legs.into_iter().map(|(ends, leg)| (ends.map(|end| numbers.of(self.found(end))), leg)).collect();
        if legs.is_empty() {
            return Err(ReadError::whole(
                source.path,
                "has no legs",
                "a cave needs two stations and a shot between them",
            ));
        }
        let shots = std::mem::take(&mut self.shots).into_iter().map(|(ends, vector, covariance)| Shot {
            ends: ends.map(|end| numbers.of(self.found(end))),
            vector,
            covariance,
        });
        let shots = shots.collect();
        let fixes = self.fixes(&mut numbers, files)?;
        let held = usize::from(!fixes.is_empty());
        let traverse = Traverse { stations: numbers.count, shots, fixes };
        let Some(mut placed) = traverse.place() else {
            let hint = "errors or standard deviations are out of all proportion; check the largest ones";
            return Err(ReadError::whole(source.path, "has loops that cannot be closed", hint));
        };
        let remaining = Remaining::of(&placed, &legs);
        let unplaced = remaining.retain(&mut legs);
        if unplaced > 0 && legs.iter().all(|(_, leg)| *leg != Leg::Passage) {
            return Err(ReadError::whole(source.path, "has no passages with a known position", UNPLACED_HINT));
        }
        let pieces = held + remaining.adrift.len();
        let afloat = match parts {
            Parts::Join | Parts::Keep => remaining.lay_out(&mut placed),
            Parts::Refuse | Parts::Longest => 0,
        };
        if pieces > 1 && parts == Parts::Refuse {
            let those = match files.has_outside_files() {
                true => "some".to_owned(),
                false => {
                    let named = &remaining.adrift[..remaining.adrift.len().min(NAMED)];
                    format!("those of {}", self.names.told(numbers.names(named)))
                }
            };
            let message = format!("has {pieces} disconnected pieces, and nothing fixes the position of {those}");
            return Err(ReadError::whole(source.path, message, PIECES_HINT));
        }
        let stations = placed.positions.into_iter().map(SurveyStation::at).collect();
        let mut survey = Survey { stations, legs, ..Survey::default() };
        for entrance in std::mem::take(&mut self.entrances) {
            if let Some(number) = numbers.of[self.found(entrance)] {
                survey.stations[number].entrance = true;
            }
        }
        survey.walls = self.walls(&numbers);
        // Nothing may be shown of files outside the folder of the imported one.
        if !files.has_outside_files() {
            self.name_stations(&numbers, &mut survey.stations);
            survey.system = self.system.as_deref().and_then(plume_graph::name);
        }
        let import = survey.into_import(source, parts)?;
        let warnings = self.doubts.into_iter().map(|(at, doubt)| files.warning(at, doubt)).collect();
        Ok(Import { tally: Tally { unplaced, afloat, doubtful: self.doubtful, ..import.tally }, warnings, ..import })
    }

    /// Names stations; of several names of one, the first in the file.
    fn name_stations(&mut self, numbers: &Numbers, stations: &mut [SurveyStation]) {
        let found: Vec<Name> = (0..self.names.below.len()).map(|name| self.found(name)).collect();
        let full = self.names.full();
        for (name, found) in found.into_iter().enumerate() {
            let Some(number) = numbers.of[found] else { continue };
            if stations[number].name.is_none() {
                stations[number].name = full(name);
            }
        }
    }

    /// One fix for each station; of several, an exact one.
    fn fixes(&mut self, numbers: &mut Numbers, files: &Files) -> Result<Vec<Fix>, ReadError> {
        let mut fixes: BTreeMap<usize, Fix> = BTreeMap::new();
        for claim in std::mem::take(&mut self.claims) {
            // A benchmark without legs is not part of the survey.
            let Some(station) = numbers.of[self.found(claim.name)] else { continue };
            let fix = Fix { station, position: claim.position, covariance: claim.covariance };
            match fixes.get(&station) {
                Some(known) if known.covariance.is_none() && fix.covariance.is_none() => {
                    if known.position != fix.position {
                        let message = "the station is also fixed at another position";
                        return Err(files.fault(
                            claim.file_position,
                            message,
                            "fix it only once, or look for a wrong equate",
                        ));
                    }
                }
                Some(known) if known.covariance.is_none() || fix.covariance.is_some() => {}
                _ => {
                    fixes.insert(station, fix);
                }
            }
        }
        Ok(fixes.into_values().collect())
    }

    fn walls(&mut self, numbers: &Numbers) -> Vec<Walls> {
        let sections = std::mem::take(&mut self.sections);
        let walls = sections.into_iter().filter_map(|section| {
            let [left_m, right_m, up_m, down_m] = section.walls_m;
            let mut number = |name| numbers.of[self.found(name)];
            let station = number(section.station)?;
            let looking = [number(section.looking[0])?, number(section.looking[1])?];
            Some(Walls { station, looking, left_m, right_m, up_m, down_m })
        });
        walls.collect()
    }
}

/// Numbers of the stations that have legs.
struct Numbers {
    of: Vec<Option<usize>>,
    count: usize,
}

impl Numbers {
    fn of(&mut self, name: Name) -> usize {
        *self.of[name].get_or_insert_with(|| {
            self.count += 1;
            self.count - 1
        })
    }

    /// The names of these stations.
    fn names(&self, stations: &[usize]) -> impl Iterator<Item = Name> {
        stations.iter().filter_map(|&station| self.of.iter().position(|&number| number == Some(station)))
    }
}

/// The covariance of a fix from its standard deviations in metres: one for all axes, one for the plan and one for the
/// height, or one for each axis. `None` if it is exact.
pub(super) fn spread(spreads_m: &[f64]) -> Option<Matrix3<f64>> {
    let spreads = match *spreads_m {
        [] => return None,
        [all] => [all; 3],
        [plan, height] => [plan, plan, height],
        [east, north, height, ..] => [east, north, height],
    };
    let variances = Vector3::from(spreads).map(|spread| (spread * spread).clamp(1e-6, 1e8));
    spreads.iter().any(|&spread| spread > 0.0).then(|| Matrix3::from_diagonal(&variances))
}

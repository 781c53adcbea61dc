//! Walls survey data (`.srv`): raw readings, as the help of Walls describes them under "Survey Data Format".
//!
//! Supported are compass-and-tape vectors in any order of columns, rectangular vectors, backsights (normal and corrected),
//! units and special formats of single values, corrections, declination and grid convergence, prefixes, fixes, wall shots,
//! distances to walls, and block comments. Names are `prefix3.prefix2.prefix1.name`.
//!
//! Variances weigh loops in Walls; here all vectors have those of BCRA grade 5, except that floated ones (`?` or `*`) give way to
//! the others. Dates, notes, flags, symbols and segments are skipped. Not supported are projects (`.wpj`), whose settings the
//! files of a project may need, instrument and target heights, mils, macros, and fixes in degrees; the error refers the user to
//! cavern, which reads Walls data since version 1.4.9.

mod units;
mod values;

use nalgebra::Point3;

use self::units::{Settings, Vectors};
use self::values::{length_m, pair};
use super::centreline::{Centreline, Name, Names, Section};
use super::files::{self, FilePosition, Files};
use super::limits::MAX_COORDINATE_M;
use super::measure::{Cell, Measured, Quantity, Reading, Row, Style};
use super::survey::Leg;
use super::{Import, Parts, ReadError, Source};
use plume_graph::echo::shown;

const HINT: &str = "run `cavern` 1.4.9 or later on the survey, and import the `.3d` file it writes";
/// Directives that only describe the survey.
const PASSED_OVER: &[&str] = &["date", "d", "segment", "seg", "s", "note", "n", "flag", "f", "symbol", "sym"];
/// Factor on the variance of floated vectors. Tuned.
const FLOATED: f64 = 1e6;

/// Reader of a row of [`FORMATS`](super::FORMATS).
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let mut reader = Reader {
        files: Files::new(source),
        centreline: Centreline::default(),
        settings: Settings::default(),
        saved: Vec::new(),
    };
    reader.read(source.bytes)?;
    reader.centreline.into_import(source, parts, &reader.files)
}

/// A survey while it is read.
struct Reader<'a> {
    files: Files<'a>,
    centreline: Centreline,
    settings: Settings,
    /// Settings put aside by `SAVE`.
    saved: Vec<Settings>,
}

impl Reader<'_> {
    fn read(&mut self, bytes: &[u8]) -> Result<(), ReadError> {
        let text = files::text(bytes);
        let mut comment: Option<FilePosition> = None;
        for (index, line) in text.split('\n').enumerate() {
            let line = self.files.line(index + 1, line)?.trim();
            let at = self.files.file_position(index + 1);
            match comment {
                Some(_) if line.starts_with("#]") => comment = None,
                Some(_) => {}
                None if line.starts_with("#[") => comment = Some(at),
                None => self.line(at, line).map_err(|message| self.files.fault(at, message, HINT))?,
            }
        }
        match comment {
            Some(open) => Err(self.files.fault(open, "the comment is never closed", "add a line `#]`")),
            None => Ok(()),
        }
    }

    fn line(&mut self, at: FilePosition, line: &str) -> Result<(), String> {
        let line = line.split(';').next().unwrap_or_default().trim();
        match line.strip_prefix('#') {
            Some(directive) => self.directive(at, directive),
            None if line.is_empty() => Ok(()),
            None => self.vector(at, line),
        }
    }

    fn directive(&mut self, at: FilePosition, line: &str) -> Result<(), String> {
        let (name, rest) = line.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((line, ""));
        let (name, rest) = (name.to_ascii_lowercase(), rest.trim());
        match name.as_str() {
            "units" | "u" => self.settings.read(rest, &mut self.saved),
            "prefix" | "prefix1" | "p" => self.settings.set_prefix(1, rest),
            "prefix2" => self.settings.set_prefix(2, rest),
            "prefix3" => self.settings.set_prefix(3, rest),
            "fix" => self.fix(at, rest),
            passed if PASSED_OVER.contains(&passed) => Ok(()),
            _ => Err(format!("#{} is not a supported directive", plume_graph::echo::plain(&name))),
        }
    }

    /// `#FIX <station> <east> <north> <up> [(variances)] [/note]`, in the order of rectangular vectors.
    fn fix(&mut self, at: FilePosition, text: &str) -> Result<(), String> {
        let text = text.split('/').next().unwrap_or_default();
        let (text, _) = without_group(text, '(', ')')?;
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let [station, coordinates @ ..] = words.as_slice() else {
            return Err("`#FIX` takes a station and its coordinates".to_owned());
        };
        if coordinates.len() != 3 {
            return Err("a fix has three coordinates".to_owned());
        }
        let mut position = Point3::origin();
        for (&axis, word) in self.settings.rectangular_axes().iter().zip(coordinates) {
            position[axis] = length_m(word, self.settings.distance_m)?;
        }
        if position.iter().any(|x| x.abs() > MAX_COORDINATE_M) {
            return Err(format!("coordinates must be within {} km", MAX_COORDINATE_M / 1000.0));
        }
        let station = self.station(station)?;
        self.centreline.fix(station, position, None, at)
    }

    /// A vector, or only the distances to the walls at a station.
    fn vector(&mut self, at: FilePosition, line: &str) -> Result<(), String> {
        let line = line.split('#').next().unwrap_or_default();
        let (line, variances) = without_group(line, '(', ')')?;
        let (line, walls) = match without_group(&line, '<', '>')? {
            (line, Some(walls)) => (line, Some(walls)),
            (line, None) => without_group(&line, '*', '*')?,
        };
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let walls_m = walls.map_or(Ok([None; 4]), |walls| self.settings.walls_m(&walls))?;
        match words[..] {
            [station] if walls_m.iter().any(Option::is_some) => {
                let station = self.station(station)?;
                self.centreline.section(Section { station, looking: [station; 2], walls_m })
            }
            [from, to, ref readings @ ..] if !readings.is_empty() => {
                let is_floated = variances.is_some_and(|variances| variances.contains(['?', '*']));
                self.leg(at, [from, to], readings, walls_m, is_floated)
            }
            _ => Err("a vector is two stations and its readings".to_owned()),
        }
    }

    fn leg(
        &mut self,
        at: FilePosition,
        ends: [&str; 2],
        readings: &[&str],
        walls_m: [Option<f64>; 4],
        is_floated: bool,
    ) -> Result<(), String> {
        let is_splay = ends.contains(&"-");
        let (style, cells) = match self.settings.vectors {
            Vectors::Tape => (Style::Normal, self.tape(readings, is_splay)?),
            Vectors::Rectangular if self.settings.turns_vectors() => {
                return Err("rectangular vectors would have to be turned by the grid convergence".to_owned());
            }
            Vectors::Rectangular => (Style::Cartesian, self.rectangular(readings)?),
        };
        let row = Row::of(cells);
        let mut measured = self.settings.instruments.shot(style, &row)?;
        self.centreline.doubt(at, self.settings.instruments.doubts(style, &row));
        if let (Measured::Shot { covariance, .. }, true) = (&mut measured, is_floated) {
            *covariance *= FLOATED;
        }
        let ends = [self.end(ends[0])?, self.end(ends[1])?];
        let station = ends[usize::from(self.settings.walls_at_end)];
        self.centreline.section(Section { station, looking: ends, walls_m })?;
        self.centreline.leg(ends, if is_splay { Leg::Splay } else { Leg::Passage }, measured)
    }

    /// Readings of tape, compass and clinometer, in metres and degrees. A shot at a wall may end before a gradient.
    fn tape(&self, words: &[&str], is_splay: bool) -> Result<Vec<(Reading, Cell)>, String> {
        let settings = &self.settings;
        let count = settings.columns.len();
        let may_lack = usize::from(is_splay && settings.columns.last() == Some(&'V'));
        if words.len() + may_lack < count {
            return Err(format!("the vector has {} readings, not {count}", words.len()));
        }
        if words.len() > count {
            return Err(format!("{} follows the last reading", shown(words[count])));
        }
        let mut cells = Vec::new();
        let mut add = |quantity, number: Option<f64>| {
            cells.extend(number.map(|number| (Reading::Of(quantity), Cell::Number(number))));
        };
        for (column, word) in settings.columns.iter().zip(words) {
            let [fore, back] = pair(word);
            match column {
                'D' => {
                    let metres = |word| length_m(word, settings.distance_m);
                    add(Quantity::Length, fore.map(metres).transpose()?);
                    add(Quantity::BackLength, back.map(metres).transpose()?);
                }
                'A' => {
                    let reversed = |deg: f64| if deg < 180.0 { deg + 180.0 } else { deg - 180.0 };
                    let [fore, back] = settings.azimuths.read(fore, back, reversed)?;
                    add(Quantity::Bearing, fore);
                    add(Quantity::BackBearing, back);
                }
                _ => {
                    let [fore, back] = settings.verticals.read(fore, back, |deg| -deg)?;
                    add(Quantity::Gradient, fore);
                    add(Quantity::BackGradient, back);
                }
            }
        }
        Ok(cells)
    }

    /// Differences of coordinates in metres; without a third one, the vector is level.
    fn rectangular(&self, words: &[&str]) -> Result<Vec<(Reading, Cell)>, String> {
        let axes = self.settings.rectangular_axes();
        if words.len() != axes.len() {
            return Err(format!("the vector has {} coordinates, not {}", words.len(), axes.len()));
        }
        let mut vector_m = [0.0; 3];
        for (&axis, word) in axes.iter().zip(words) {
            vector_m[axis] = length_m(word, self.settings.distance_m)?;
        }
        let quantities = [Quantity::East, Quantity::North, Quantity::Altitude];
        Ok(quantities
            .into_iter()
            .zip(vector_m)
            .map(|(of, length_m)| (Reading::Of(of), Cell::Number(length_m)))
            .collect())
    }

    /// The end of a vector; points on walls have no names.
    fn end(&mut self, name: &str) -> Result<Name, String> {
        if name == "-" { self.centreline.names.add() } else { self.station(name) }
    }

    /// A station: `name`, or with the prefixes of its lowest levels, `prefix2:prefix1:name`.
    fn station(&mut self, text: &str) -> Result<Name, String> {
        let mut parts = text.split(':');
        let name = parts.next_back().filter(|name| !name.is_empty() && !name.contains(','));
        let name = name.ok_or_else(|| format!("{} is not a name", shown(text)))?;
        let own: Vec<&str> = parts.collect();
        let mut prefixes = self.settings.prefixes.clone();
        let Some(first) = prefixes.len().checked_sub(own.len()) else {
            return Err(format!("{} has more than three prefixes", shown(text)));
        };
        prefixes[first..].iter_mut().zip(own).for_each(|(prefix, own)| *prefix = own.to_owned());
        let mut survey = Names::ROOT;
        for prefix in prefixes.iter().filter(|prefix| !prefix.is_empty()) {
            survey = self.centreline.names.below(survey, prefix)?;
        }
        self.centreline.names.below(survey, &self.settings.spelled(name))
    }
}

/// A text without what is between two characters, and that.
fn without_group(text: &str, open: char, close: char) -> Result<(String, Option<String>), String> {
    let Some((before, rest)) = text.split_once(open) else { return Ok((text.to_owned(), None)) };
    let Some((inside, after)) = rest.split_once(close) else {
        return Err(format!("`{open}` is not followed by `{close}`"));
    };
    Ok((format!("{before} {after}"), Some(inside.to_owned())))
}

//! Commands: lines that begin with an asterisk.

use std::rc::Rc;

use nalgebra::Point3;

use super::{Case, HINT, Reader};
use crate::ReadError;
use crate::centreline::{Names, spread};
use crate::files::FilePosition;
use crate::limits::MAX_COORDINATE_M;
use crate::measure::{Columns, Order};
use plume_graph::echo::shown;

/// Commands that only describe the survey, or check what is irrelevant here.
const PASSED_OVER: &[&str] = &["title", "date", "team", "instrument", "export", "ref", "copyright", "require", "solve"];

impl Reader<'_> {
    /// Executes the command of a line, in a file before which `outer` blocks were open.
    pub(super) fn command(&mut self, file_position: FilePosition, line: &str, outer: usize) -> Result<(), ReadError> {
        let fault = |reader: &Self, message: String| reader.files.fault(file_position, message, HINT);
        let words = self.settings.marks.quoted(line).map_err(|message| fault(self, message))?;
        let Some((command, words)) = words.split_first() else {
            return Err(fault(self, "the command after the asterisk is missing".to_owned()));
        };
        let command = command.to_ascii_lowercase();
        if command == "include" {
            return match words {
                [name] => self.include(file_position, name),
                _ => Err(fault(self, "`*include` takes one file name, in quotes if it contains blanks".to_owned())),
            };
        }
        self.obey(file_position, &command, words, outer).map_err(|message| fault(self, message))
    }

    fn obey(&mut self, file_position: FilePosition, command: &str, words: &[&str], outer: usize) -> Result<(), String> {
        if matches!(command, "begin" | "end" | "data" | "default") {
            self.centreline.end_tube();
            self.columns = Columns::default();
        }
        match (command, words) {
            ("begin", [] | [_]) => self.begin(file_position, words.first().copied()),
            ("end", [] | [_]) => self.end_block(words.first().copied(), outer),
            ("data", []) => Ok(()),
            ("data", words) => {
                self.settings.order = Rc::new(Order::read(words)?);
                Ok(())
            }
            ("units" | "calibrate" | "declination" | "sd" | "infer", words) => {
                let marks = Rc::clone(&self.settings.marks);
                self.settings.instruments.obey(command, words, &|word| marks.number(word))
            }
            ("flags", words) => self.settings.flags.read(words),
            ("cs", words) => self.centreline.set_system(words.last().copied().unwrap_or_default()),
            ("fix", [station, words @ ..]) => self.fix(file_position, station, words),
            ("equate", [first, others @ ..]) if !others.is_empty() => self.equate(first, others),
            ("entrance", [station]) => {
                let station = self.station(station)?;
                self.centreline.entrance(station);
                Ok(())
            }
            ("alias", [kind, "-", target @ ..]) if kind.eq_ignore_ascii_case("station") => self.alias(target),
            ("case", [case]) => self.set_case(case),
            ("truncate", [most]) => self.truncate(most),
            ("set", [item, characters @ ..]) => Rc::make_mut(&mut self.settings.marks).set(item, &characters.concat()),
            ("prefix", [name]) => {
                let is_root = self.settings.marks.behind_root(name) == Some("");
                self.settings.survey = if is_root { Names::ROOT } else { self.named(Names::ROOT, name)? };
                Ok(())
            }
            ("default", words) => words.iter().try_for_each(|what| self.reset(what)),
            (passed, _) if PASSED_OVER.contains(&passed) => Ok(()),
            ("fix" | "equate" | "entrance" | "alias" | "case" | "truncate" | "set" | "begin" | "end" | "prefix", _) => {
                Err(format!("`*{command}` does not take these arguments"))
            }
            _ => Err(format!("{} is not a supported command", shown(command))),
        }
    }

    fn number(&self, word: &str) -> Result<f64, String> {
        self.settings.marks.number(word).ok_or_else(|| format!("{} is not a number", shown(word)))
    }

    /// `*fix <station> [reference] [<x> <y> <z> [<standard deviations> [<covariances>]]]`
    fn fix(&mut self, file_position: FilePosition, station: &str, words: &[&str]) -> Result<(), String> {
        let name = self.station(station)?;
        let words = match words {
            [word, rest @ ..] if word.eq_ignore_ascii_case("reference") => rest,
            words => words,
        };
        let numbers: Result<Vec<f64>, String> = words.iter().map(|word| self.number(word)).collect();
        let numbers = numbers?;
        if numbers.iter().any(|number| number.abs() > MAX_COORDINATE_M) {
            return Err(format!("coordinates must be within {} km", MAX_COORDINATE_M / 1000.0));
        }
        let position = match numbers[..] {
            [] => Point3::origin(),
            [x, y, z, ..] if numbers.len() <= 6 || numbers.len() == 9 => Point3::new(x, y, z),
            _ => return Err("a fix has three coordinates and up to three standard deviations".to_owned()),
        };
        let covariance = numbers.get(3..).and_then(spread);
        self.centreline.fix(name, position, covariance, file_position)
    }

    fn equate(&mut self, first: &str, others: &[&str]) -> Result<(), String> {
        let first = self.station(first)?;
        for other in others {
            let other = self.station(other)?;
            self.centreline.equate(first, other);
        }
        Ok(())
    }

    fn alias(&mut self, target: &[&str]) -> Result<(), String> {
        self.settings.dash_is_wall = match target {
            [] => false,
            [".."] => true,
            _ => return Err("`-` can only be an alias of `..`".to_owned()),
        };
        Ok(())
    }

    fn set_case(&mut self, case: &str) -> Result<(), String> {
        self.settings.case = match case.to_ascii_lowercase().as_str() {
            "preserve" => Case::Kept,
            "toupper" => Case::Upper,
            "tolower" => Case::Lower,
            _ => return Err(format!("{} is not preserve, toupper or tolower", shown(case))),
        };
        Ok(())
    }

    fn truncate(&mut self, most: &str) -> Result<(), String> {
        self.settings.significant = match most.parse() {
            Ok(most @ 1..) => Some(most),
            _ if most.eq_ignore_ascii_case("off") => None,
            _ => return Err(format!("names cannot be truncated to {}", shown(most))),
        };
        Ok(())
    }

    /// Restores defaults.
    fn reset(&mut self, what: &str) -> Result<(), String> {
        let what = what.to_ascii_lowercase();
        let all = what == "all";
        if !all && !matches!(what.as_str(), "calibrate" | "data" | "units") {
            return Err(format!("{} has no default", shown(&what)));
        }
        if all || what == "calibrate" {
            self.settings.instruments.reset_calibration();
        }
        if all || what == "units" {
            self.settings.instruments.reset_units();
        }
        if all || what == "data" {
            self.settings.order = Rc::default();
        }
        Ok(())
    }
}

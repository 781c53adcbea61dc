//! Survey books of Compass (Fish: fountainware.com/compass): `.dat`, and the projects `.mak` that put several together.
//!
//! Shots are turned into vectors ([`dat`]) and closed by least squares ([`traverse`](super::traverse)). Left, right,
//! up and down come along. Shots flagged `X` do not exist, `S` are splays, `L` (not counted in the length) are
//! duplicates, `P` (not plotted) are taken to lead over the ground, `C` (not adjusted) hardly give way when loops
//! close. Calibrations, declinations and redundant backsights are applied; the convergence of a grid and the
//! project's own settings are not.
//!
//! The crate `compass_data` 0.0.7 reads these files too, but panics at a date that does not exist, which books with
//! unknown dates have, drops flags and backsights, and takes the first line that it cannot read for the end.

mod dat;
mod mak;

use std::path::Path;

use nalgebra::Point3;
use rustc_hash::FxHashMap;

use self::dat::Shot;
use self::mak::Book;
use super::limits::{MAX_LEGS, MAX_STATIONS};
use super::survey::{Station, Survey, Walls};
use super::traverse::{self, Accuracy, Fix, Placed, Traverse};
use super::{Import, Parts, ReadError, Source};

/// In which Compass has all lengths.
const METRES_PER_FOOT: f64 = 0.3048;
/// How much less a shot that is not to be adjusted gives way, as a share of its variance. Tuned.
const RIGID: f64 = 1e-4;
/// Pieces that nothing joins are laid out this far from each other, in metres, so that no two stations meet.
const APART_M: f64 = 10_000.0;

/// Reads a file as a row of [`FORMATS`](super::FORMATS) does.
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let mut cave = Cave::default();
    if source.path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mak")) {
        cave.add_project(source)?;
    } else {
        cave.add_book(source.path, source.bytes)?;
    }
    let placed = cave.placed(source.path, parts)?;
    cave.into_survey(placed).into_import(source, parts)
}

/// All that the books say.
#[derive(Default)]
struct Cave {
    /// Stations by the names they have in the book that is being read.
    of_name: FxHashMap<Vec<u8>, usize>,
    /// The name of each station.
    names: Vec<Vec<u8>>,
    traverse: Traverse,
    survey: Survey,
}

impl Cave {
    fn add_project(&mut self, source: &Source) -> Result<(), ReadError> {
        for book in &mak::books(source.path, source.bytes)? {
            if !book.links.is_empty() {
                self.forget_all_but(book);
            }
            for (name, position) in &book.fixes {
                let station = self.station(name);
                if self.traverse.fixes.iter().all(|fix| fix.station != station) {
                    self.traverse.fixes.push(Fix { station, position: *position, covariance: None });
                }
            }
            let bytes = source.outside.read(&book.path).map_err(|error| {
                let message = format!("names {}, which cannot be read: {error}", book.path.display());
                ReadError::line(source.path, book.line, message, "put it beside the project, with the same letters")
            })?;
            self.add_book(&book.path, &bytes)?;
        }
        Ok(())
    }

    /// A book that names links does not know the other stations of those before it, and may use their names anew.
    fn forget_all_but(&mut self, book: &Book) {
        let names = book.links.iter().chain(book.fixes.iter().map(|(name, _)| name));
        let known = names.filter_map(|name| Some((name.clone(), self.of_name.get(name).copied()?)));
        self.of_name = known.collect();
    }

    fn add_book(&mut self, path: &Path, bytes: &[u8]) -> Result<(), ReadError> {
        for (line, shot) in dat::shots(path, bytes)? {
            if self.names.len() >= MAX_STATIONS || self.survey.legs.len() >= MAX_LEGS {
                let message = format!("is too large: {MAX_STATIONS} stations and {MAX_LEGS} shots are the most");
                return Err(ReadError::line(path, line, message, "import a part of the survey"));
            }
            self.add(&shot);
        }
        Ok(())
    }

    fn add(&mut self, shot: &Shot) {
        let ends = [shot.from, shot.to].map(|name| self.station(name));
        self.survey.legs.push((ends, shot.leg));
        let covariance = Accuracy::default().covariance(&shot.vector) * if shot.is_rigid { RIGID } else { 1.0 };
        self.traverse.shots.push(traverse::Shot { ends, vector: shot.vector, covariance });
        let [left_m, right_m, up_m, down_m] = shot.walls_m;
        let station = ends[usize::from(shot.walls_at_end)];
        self.survey.walls.push(Walls { station, looking: ends, left_m, right_m, up_m, down_m });
    }

    fn station(&mut self, name: &[u8]) -> usize {
        if let Some(&station) = self.of_name.get(name) {
            return station;
        }
        let station = self.names.len();
        self.names.push(name.to_vec());
        self.of_name.insert(name.to_vec(), station);
        station
    }

    /// Where the stations are. Pieces that no shot ties to each other can only be told apart, not put together.
    fn placed(&mut self, path: &Path, parts: Parts) -> Result<Placed, ReadError> {
        self.traverse.stations = self.names.len();
        let loops = || ReadError::whole(path, "has loops that cannot be closed", "look for blunders in the shots");
        let placed = self.traverse.clone().place().ok_or_else(loops)?;
        if placed.adrift.len() + usize::from(!self.traverse.fixes.is_empty()) < 2 {
            return Ok(placed);
        }
        if parts != Parts::Longest {
            let name = |&station: &usize| String::from_utf8_lossy(&self.names[station]).escape_debug().to_string();
            let names: Vec<String> = placed.adrift.iter().take(10).map(name).collect();
            let message = format!("has pieces that no shot joins to the others, with stations {}", names.join(", "));
            let hint = "fix a station of each piece in a .mak project, add the shots that are missing, or take the \
                        `longest` of the parts";
            return Err(ReadError::whole(path, message, hint));
        }
        let apart = |(piece, &station): (usize, &usize)| Fix {
            station,
            position: Point3::new(0.0, 0.0, -APART_M * (piece + 1) as f64),
            covariance: None,
        };
        self.traverse.fixes.extend(placed.adrift.iter().enumerate().map(apart));
        self.traverse.clone().place().ok_or_else(loops)
    }

    fn into_survey(mut self, placed: Placed) -> Survey {
        let stations = placed.positions.into_iter().map(|position| Station { position, entrance: false });
        self.survey.stations = stations.collect();
        self.survey
    }
}

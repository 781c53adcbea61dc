//! Therion centrelines (`.th`): raw readings, before Therion has computed positions.
//!
//! Follows the Therion book 6.1, chapter "Creating data files". Supported are nested surveys, centrelines with all data
//! styles, units, calibrations, declinations, flags, fixes, equates across surveys, groups, splays, dimensions and
//! `input`. Drawings (`scrap`, `map`, `.th2`) and descriptions are skipped.
//!
//! Not supported: what needs other programs (`import`, declinations by date or from a model of the earth's field), and
//! later changes (`revise`); the error refers the user to Therion. With a `cs`, Therion rotates the survey to grid north
//! with that model; here only the given declination is applied.

mod lex;

use std::rc::Rc;

use nalgebra::Point3;

use super::centreline::{Centreline, Flags, Name, Names, Section};
use super::files::{self, FilePosition, Files};
use super::limits::{MAX_COORDINATE_M, MAX_DEPTH};
use super::measure::{Columns, Dialect, Instruments, Order, Row, Style};
use super::{Import, Parts, ReadError, Source};
use plume_graph::echo::shown;

/// Hint for a survey with unsupported features.
const HINT: &str = "run `therion` with `export model -fmt survex`, and import the `.3d` file it writes";
/// Blocks that are skipped.
const PASSED_BLOCKS: &[&str] = &["scrap", "map", "layout", "surface", "grade", "lookup", "comment"];
/// Commands that are skipped, outside and inside centrelines.
const PASSED_OVER: &[&str] = &["encoding", "join", "text"];
const PASSED_IN_CENTRELINE: &[&str] = &[
    "date",
    "explo-date",
    "team",
    "explo-team",
    "instrument",
    "grade",
    "mark",
    "walls",
    "vthreshold",
    "extend",
    "title",
    "copyright",
    "author",
    "id",
];

/// Longest prefix or suffix of station names: otherwise one long line could lengthen a million names.
const MAX_AFFIXES: usize = 200;

/// Reads a survey with all its inputs.
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let mut reader = Reader {
        files: Files::new(source),
        centreline: Centreline::default(),
        blocks: Vec::new(),
        survey: Names::ROOT,
        settings: Settings::default(),
        columns: Columns::default(),
        last_line: FilePosition::default(),
    };
    reader.read(source.bytes)?;
    reader.centreline.into_import(source, parts, &reader.files)
}

/// Settings for the following lines of a centreline.
#[derive(Clone, Debug, Default)]
struct Settings {
    order: Rc<Order>,
    instruments: Instruments,
    flags: Flags,
    /// Prefix and suffix of station names.
    affixes: [String; 2],
}

/// The kind of a block, and what is restored at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BlockKind {
    Survey,
    Centreline,
    Group,
    /// Index into [`PASSED_BLOCKS`].
    Passed(usize),
}

struct Block {
    kind: BlockKind,
    file_position: FilePosition,
    survey: Name,
    settings: Settings,
}

struct Reader<'a> {
    files: Files<'a>,
    centreline: Centreline,
    blocks: Vec<Block>,
    survey: Name,
    settings: Settings,
    columns: Columns,
    /// The last line of readings.
    last_line: FilePosition,
}

impl Reader<'_> {
    /// Reads a file.
    fn read(&mut self, bytes: &[u8]) -> Result<(), ReadError> {
        let text = files::text(bytes);
        let outer = self.blocks.len();
        let mut long = String::new();
        for (index, line) in text.split('\n').enumerate() {
            let line = self.files.line(index + 1, line)?;
            if let Some(begun) = line.strip_suffix('\\') {
                long += begun;
                self.files.line(index + 1, &long)?;
                continue;
            }
            let file_position = self.files.file_position(index + 1);
            let whole = std::mem::take(&mut long) + line;
            self.line(file_position, &whole, outer)?;
        }
        match self.blocks.get(outer) {
            Some(open) => Err(self.files.fault(open.file_position, "the block is never closed", "add its `end…`")),
            None => Ok(()),
        }
    }

    fn line(&mut self, file_position: FilePosition, line: &str, outer: usize) -> Result<(), ReadError> {
        if let Some(&Block { kind: BlockKind::Passed(block), .. }) = self.blocks.last() {
            let first = line.split_whitespace().next().unwrap_or_default();
            if first.strip_prefix("end") == Some(PASSED_BLOCKS[block]) {
                self.blocks.pop();
            }
            return Ok(());
        }
        let fault = |reader: &Self, message: String| reader.files.fault(file_position, message, HINT);
        let words = lex::words(line).map_err(|message| fault(self, message))?;
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        if let ["input" | "source", name] = words[..] {
            return self.input(file_position, name);
        }
        let in_centreline =
            matches!(self.blocks.last(), Some(Block { kind: BlockKind::Centreline | BlockKind::Group, .. }));
        let done = if in_centreline {
            self.measure(file_position, &words, outer)
        } else {
            self.describe(file_position, &words, outer)
        };
        done.map_err(|message| fault(self, message))
    }

    fn input(&mut self, file_position: FilePosition, name: &str) -> Result<(), ReadError> {
        if name.to_ascii_lowercase().ends_with(".th2") {
            return Ok(());
        }
        let bytes = self.files.open(file_position, name, ".th")?;
        self.read(&bytes)?;
        self.files.close();
        Ok(())
    }

    /// A line outside a centreline.
    fn describe(&mut self, file_position: FilePosition, words: &[&str], outer: usize) -> Result<(), String> {
        let Some((&command, words)) = words.split_first() else { return Ok(()) };
        match (command, words) {
            ("survey", [name, options @ ..]) => self.open_survey(file_position, name, options),
            ("endsurvey", _) => self.close(BlockKind::Survey, outer),
            ("centreline" | "centerline", _) => {
                self.open(file_position, BlockKind::Centreline)?;
                let declination_rad = self.settings.instruments.declination_rad();
                self.settings = Settings::default();
                self.settings.instruments.dialect = Dialect::Therion;
                self.settings.instruments.set_declination_rad(declination_rad);
                Ok(())
            }
            ("equate", words) => self.equate(words),
            ("cs", [system]) => self.centreline.set_system(system),
            (passed, _) if PASSED_OVER.contains(&passed) => Ok(()),
            (block, _) => match PASSED_BLOCKS.iter().position(|passed| *passed == block) {
                Some(index) => self.open(file_position, BlockKind::Passed(index)),
                None => Err(format!("{} is not a supported command", shown(block))),
            },
        }
    }

    /// A line of a centreline.
    fn measure(&mut self, file_position: FilePosition, words: &[&str], outer: usize) -> Result<(), String> {
        let Some((&command, rest)) = words.split_first() else {
            return self.data(file_position, &[]);
        };
        if matches!(command, "data" | "break" | "group" | "endgroup" | "endcentreline" | "endcenterline") {
            self.centreline.end_tube();
            self.columns = Columns::default();
        }
        match (command, rest) {
            ("endcentreline" | "endcenterline", _) => self.close(BlockKind::Centreline, outer),
            ("group", _) => self.open(file_position, BlockKind::Group),
            ("endgroup", _) => self.close(BlockKind::Group, outer),
            ("break", _) => Ok(()),
            ("data", rest) => {
                self.settings.order = Rc::new(Order::read(rest)?);
                Ok(())
            }
            ("declination", ["-" | ""]) => {
                let survey = self.blocks.iter().rev().find(|block| block.kind == BlockKind::Centreline);
                let declination_rad = survey.map(|block| block.settings.instruments.declination_rad());
                self.settings.instruments.set_declination_rad(declination_rad.unwrap_or_default());
                Ok(())
            }
            ("units" | "calibrate" | "sd" | "declination" | "infer", rest) => {
                self.settings.instruments.obey(command, rest, &lex::number)
            }
            ("flags", rest) => self.settings.flags.read(rest),
            ("station-names", [before, behind]) => {
                if before.len() + behind.len() > MAX_AFFIXES {
                    return Err(format!("`station-names` has more than {MAX_AFFIXES} letters"));
                }
                self.settings.affixes = [(*before).to_owned(), (*behind).to_owned()];
                Ok(())
            }
            ("station", [station, _, flags @ ..]) => self.station_flags(station, flags),
            ("fix", [station, coordinates @ ..]) => self.fix(file_position, station, coordinates),
            ("equate", rest) => self.equate(rest),
            ("cs", [system]) => self.centreline.set_system(system),
            ("comment", _) => self.open(file_position, BlockKind::Passed(PASSED_BLOCKS.len() - 1)),
            (passed, _) if PASSED_IN_CENTRELINE.contains(&passed) => Ok(()),
            (command, rest) => match command.strip_prefix('!') {
                Some("") => self.data(file_position, rest),
                Some(word) => self.data(file_position, &[&[word], rest].concat()),
                None => self.data(file_position, words),
            },
        }
    }

    fn open(&mut self, file_position: FilePosition, kind: BlockKind) -> Result<(), String> {
        if self.blocks.len() >= MAX_DEPTH {
            return Err(format!("blocks are nested more than {MAX_DEPTH} deep"));
        }
        self.blocks.push(Block { kind, file_position, survey: self.survey, settings: self.settings.clone() });
        Ok(())
    }

    /// Closes a block opened in this file; `outer` blocks were open before it.
    fn close(&mut self, kind: BlockKind, outer: usize) -> Result<(), String> {
        match self.blocks.pop() {
            Some(block) if block.kind == kind && self.blocks.len() >= outer => {
                self.survey = block.survey;
                self.settings = block.settings;
                Ok(())
            }
            Some(block) => Err(format!("this does not close the block of line {}", block.file_position.line)),
            None => Err("no block is open".to_owned()),
        }
    }

    /// `survey <id> [-namespace on|off] [-entrance <station>] [-declination [<angle> <unit>]] …`
    fn open_survey(&mut self, file_position: FilePosition, name: &str, options: &[&str]) -> Result<(), String> {
        self.open(file_position, BlockKind::Survey)?;
        let value = |option: &str| options.windows(2).find(|pair| pair[0] == option).map(|pair| pair[1]);
        if value("-namespace") != Some("off") {
            self.survey = self.centreline.names.below(self.survey, name)?;
        }
        if let Some(station) = value("-entrance") {
            let station = self.elsewhere(station)?;
            self.centreline.entrance(station);
        }
        match value("-declination").map(|text| text.split_whitespace().collect::<Vec<_>>()) {
            None => {}
            Some(words) if words.is_empty() => self.settings.instruments.set_declination_rad(0.0),
            Some(words) => self.settings.instruments.obey("declination", &words, &lex::number)?,
        }
        Ok(())
    }

    /// Reads a line of readings.
    fn data(&mut self, file_position: FilePosition, words: &[&str]) -> Result<(), String> {
        // An empty line does not end a traverse here; `break` does.
        if words.is_empty() {
            return Ok(());
        }
        let order = Rc::clone(&self.settings.order);
        let before = std::mem::replace(&mut self.last_line, file_position);
        let of_leg = if order.is_interleaved() { before } else { file_position };
        let row = self.columns.take(&order, words, &lex::cell)?;
        match row {
            None => Ok(()),
            Some(row) if order.style == Style::Passage => {
                let station = self.elsewhere(&row.from)?;
                self.centreline.add_to_tube(station, self.settings.instruments.walls(&row, false))
            }
            Some(row) => self.leg(of_leg, order.style, &row),
        }
    }

    fn leg(&mut self, file_position: FilePosition, style: Style, row: &Row) -> Result<(), String> {
        let names = [row.from.as_str(), row.to.as_deref().unwrap_or_default()];
        let at_wall = names.iter().any(|name| matches!(*name, "." | "-"));
        let [from, to] = [self.end(names[0])?, self.end(names[1])?];
        let instruments = &self.settings.instruments;
        for (station, at_end) in [(from, false), (to, true)] {
            let walls_m = instruments.walls(row, at_end);
            self.centreline.section(Section { station, looking: [from, to], walls_m })?;
        }
        let measured = instruments.shot(style, row)?;
        self.centreline.doubt(file_position, instruments.doubts(style, row));
        self.centreline.leg([from, to], self.settings.flags.leg(at_wall), measured)
    }

    /// The end of a shot: points on walls have no names.
    fn end(&mut self, name: &str) -> Result<Name, String> {
        if matches!(name, "." | "-") { self.centreline.names.add() } else { self.elsewhere(name) }
    }

    /// A station of the open survey.
    fn station(&mut self, name: &str) -> Result<Name, String> {
        let [before, behind] = &self.settings.affixes;
        self.centreline.names.below(self.survey, &format!("{before}{name}{behind}"))
    }

    /// A station that may be in a survey within the open one: `name@inner.outer`.
    fn elsewhere(&mut self, name: &str) -> Result<Name, String> {
        let Some((name, surveys)) = name.split_once('@') else { return self.station(name) };
        let names = &mut self.centreline.names;
        let survey = surveys.rsplit('.').try_fold(self.survey, |at, part| names.below(at, part))?;
        self.centreline.names.below(survey, name)
    }

    fn equate(&mut self, names: &[&str]) -> Result<(), String> {
        let [first, others @ ..] = names else { return Err("`equate` takes at least two stations".to_owned()) };
        if others.is_empty() {
            return Err("`equate` takes at least two stations".to_owned());
        }
        let first = self.elsewhere(first)?;
        for other in others {
            let other = self.elsewhere(other)?;
            self.centreline.equate(first, other);
        }
        Ok(())
    }

    fn station_flags(&mut self, station: &str, flags: &[&str]) -> Result<(), String> {
        let entrance = flags.iter().position(|&flag| flag == "entrance");
        if entrance.is_some_and(|at| at == 0 || flags[at - 1] != "not") {
            let station = self.elsewhere(station)?;
            self.centreline.entrance(station);
        }
        Ok(())
    }

    fn fix(&mut self, file_position: FilePosition, station: &str, coordinates: &[&str]) -> Result<(), String> {
        let numbers: Option<Vec<f64>> = coordinates.iter().map(|word| lex::number(word)).collect();
        let position = match numbers.as_deref() {
            Some([]) => Point3::origin(),
            Some(&[x, y, z, ..]) if [x, y, z].iter().all(|x| x.abs() <= MAX_COORDINATE_M) => Point3::new(x, y, z),
            _ => return Err("a fix has three coordinates in metres, and optional standard deviations".to_owned()),
        };
        let covariance = numbers.as_deref().and_then(|numbers| super::centreline::spread(numbers.get(3..)?));
        let station = self.elsewhere(station)?;
        self.centreline.fix(station, position, covariance, file_position)
    }
}

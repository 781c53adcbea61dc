//! Survex survey data (`.svx`): raw readings, before cavern has computed positions.
//!
//! Follows the Survex manual 1.4, chapter 4. Supported are all data styles with any order of columns, units, calibrations,
//! fixed declinations, standard deviations, nested surveys, equates, fixes, flags, anonymous stations, and includes. Loops
//! are closed as in Survex, so stations are where cavern puts them, except that stations of diving shots in loops may differ
//! by a fraction of the misclosure, because their covariances do. Where cavern refuses a survey because only legs of style
//! `nosurvey` lead on, what lies behind them is left out ([`unplaced`](super::unplaced)).
//!
//! Not supported: `*declination auto`, which needs a model of the earth's field, positions in a `*cs` in degrees or in
//! several systems, and Compass files named by `*include`; the error refers the user to cavern. Covariances of fixes between
//! axes are ignored, as are descriptions (`*title`, `*team`), `*export` and `*solve`: for simulation the whole survey is
//! wanted, adjusted once.

mod command;
mod lex;

use std::rc::Rc;

use lex::Marks;

use super::centreline::{Centreline, Flags, Name, Names, Section};
use super::files::{self, FilePosition, Files};
use super::limits::MAX_DEPTH;
use super::measure::{Columns, Instruments, Order, Row, Style};
use super::{Import, Parts, ReadError, Source};
use plume_graph::echo::shown;

/// Hint for a survey with unsupported features.
const HINT: &str = "run `cavern` on the survey, and import the `.3d` file it writes";
const ROW_HINT: &str =
    "a row has the readings that `*data` names, by default FROM TO TAPE COMPASS CLINO, as decimal numbers with a point";

/// Reads a survey with all included files.
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let mut reader = Reader {
        files: Files::new(source),
        centreline: Centreline::default(),
        settings: Settings::default(),
        blocks: Vec::new(),
        columns: Columns::default(),
        last_line: FilePosition::default(),
    };
    reader.read(source.bytes)?;
    reader.centreline.into_import(source, parts, &reader.files)
}

/// How names are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Case {
    #[default]
    Lower,
    Upper,
    Kept,
}

/// Settings saved by `*begin` and restored by `*end`.
#[derive(Clone, Debug, Default)]
struct Settings {
    marks: Rc<Marks>,
    order: Rc<Order>,
    instruments: Instruments,
    flags: Flags,
    case: Case,
    /// Significant characters of a name.
    significant: Option<usize>,
    /// Whether `-` is an alias of a station on a wall.
    dash_is_wall: bool,
    survey: Name,
}

/// An open block.
struct Block {
    /// The survey it opened.
    name: Option<String>,
    settings: Settings,
    file_position: FilePosition,
}

/// A survey while it is read.
struct Reader<'a> {
    files: Files<'a>,
    centreline: Centreline,
    settings: Settings,
    blocks: Vec<Block>,
    columns: Columns,
    /// The last line of readings.
    last_line: FilePosition,
}

impl Reader<'_> {
    /// Reads a file.
    fn read(&mut self, bytes: &[u8]) -> Result<(), ReadError> {
        let text = files::text(bytes);
        let blocks = self.blocks.len();
        for (index, line) in text.split('\n').enumerate() {
            let line = self.files.line(index + 1, line)?;
            let file_position = self.files.file_position(index + 1);
            let marks = Rc::clone(&self.settings.marks);
            match marks.command(line) {
                Some(command) => self.command(file_position, command, blocks)?,
                None if marks.is_comment(line) => {}
                None => self
                    .data(file_position, &marks.words(line))
                    .map_err(|message| self.files.fault(file_position, message, ROW_HINT))?,
            }
        }
        self.centreline.end_tube();
        self.columns = Columns::default();
        match self.blocks.get(blocks) {
            Some(open) => Err(self.files.fault(open.file_position, "the block is never closed", "add an `*end`")),
            None => Ok(()),
        }
    }

    /// Reads a line of readings.
    fn data(&mut self, file_position: FilePosition, words: &[&str]) -> Result<(), String> {
        let order = Rc::clone(&self.settings.order);
        let before = std::mem::replace(&mut self.last_line, file_position);
        let of_leg = if order.is_interleaved() { before } else { file_position };
        let marks = Rc::clone(&self.settings.marks);
        let Some(row) = self.columns.take(&order, words, &|reading, word| marks.cell(reading, word))? else {
            return Ok(());
        };
        if order.style == Style::Passage { self.cross_section(&row) } else { self.leg(of_leg, order.style, &row) }
    }

    fn leg(&mut self, file_position: FilePosition, style: Style, row: &Row) -> Result<(), String> {
        let to = row.to.as_deref().unwrap_or_default();
        let [(from, from_wall), (to, to_wall)] = [self.end(&row.from)?, self.end(to)?];
        let leg = self.settings.flags.leg(from_wall || to_wall);
        let walls_m = self.settings.instruments.walls(row, false);
        self.centreline.section(Section { station: from, looking: [from, to], walls_m })?;
        let measured = self.settings.instruments.shot(style, row)?;
        self.centreline.doubt(file_position, self.settings.instruments.doubts(style, row));
        self.centreline.leg([from, to], leg, measured)
    }

    fn cross_section(&mut self, row: &Row) -> Result<(), String> {
        let station = self.station(&row.from)?;
        self.centreline.add_to_tube(station, self.settings.instruments.walls(row, false))
    }

    /// The end of a leg, and whether it is a point on a wall or in the open instead of a station.
    fn end(&mut self, word: &str) -> Result<(Name, bool), String> {
        if self.settings.dash_is_wall && word == "-" {
            return Ok((self.centreline.names.add()?, true));
        }
        match self.settings.marks.dots(word) {
            Some(dots @ 1..=3) => Ok((self.centreline.names.add()?, dots < 3)),
            _ => Ok((self.station(word)?, false)),
        }
    }

    /// The station of this name in the open survey.
    fn station(&mut self, name: &str) -> Result<Name, String> {
        self.named(self.settings.survey, name)
    }

    /// The named thing in a survey, or from the root if the name starts there.
    fn named(&mut self, survey: Name, name: &str) -> Result<Name, String> {
        let marks = Rc::clone(&self.settings.marks);
        let (mut at, name) = marks.behind_root(name).map_or((survey, name), |name| (Names::ROOT, name));
        for part in marks.parts(name)? {
            at = self.centreline.names.below(at, &self.settings.spelled(part))?;
        }
        Ok(at)
    }

    fn begin(&mut self, file_position: FilePosition, name: Option<&str>) -> Result<(), String> {
        if self.blocks.len() >= MAX_DEPTH {
            return Err(format!("blocks are nested more than {MAX_DEPTH} deep"));
        }
        let survey = match name {
            Some(name) => self.named(self.settings.survey, name)?,
            None => self.settings.survey,
        };
        let kept = self.settings.clone();
        self.blocks.push(Block { name: name.map(|name| kept.spelled(name)), settings: kept, file_position });
        self.settings.survey = survey;
        Ok(())
    }

    /// Closes a block opened in this file; `outer` blocks were open before it.
    fn end_block(&mut self, name: Option<&str>, outer: usize) -> Result<(), String> {
        let Some(block) = self.blocks.pop().filter(|_| self.blocks.len() >= outer) else {
            return Err("no block is open in this file".to_owned());
        };
        let name = name.map(|name| block.settings.spelled(name));
        if name != block.name {
            let name = shown(&block.name.unwrap_or_default());
            return Err(format!("this does not close the block {name} of line {}", block.file_position.line));
        }
        self.settings = block.settings;
        Ok(())
    }

    fn include(&mut self, file_position: FilePosition, name: &str) -> Result<(), ReadError> {
        let bytes = self.files.open(file_position, name, ".svx")?;
        let survey = self.settings.survey;
        self.read(&bytes)?;
        self.settings.survey = survey;
        self.files.close();
        Ok(())
    }
}

impl Settings {
    /// A name reduced to its significant characters.
    fn spelled(&self, name: &str) -> String {
        let kept = name.chars().take(self.significant.unwrap_or(usize::MAX));
        match self.case {
            Case::Lower => kept.map(|letter| letter.to_ascii_lowercase()).collect(),
            Case::Upper => kept.map(|letter| letter.to_ascii_uppercase()).collect(),
            Case::Kept => kept.collect(),
        }
    }
}

//! `.dat` files: surveys separated by form feeds, each with a header and a line per shot.
//!
//! Lengths are in feet and angles in degrees, whatever `FORMAT` says; that describes the original notes, whether there are
//! backsights, and at which end of a shot the walls were measured.

use super::Reader;
use crate::ReadError;
use crate::centreline::Section;
use crate::files::{self, FilePosition};
use crate::measure::{Cell, Columns, Instruments, Measured, Order, Quantity, Reading, Style};
use crate::survey::Leg;
use plume_graph::echo::shown;

/// Angles up to this value stand for a missing one (-999).
const MISSING_DEG: f64 = -900.0;
/// Factor on the variance of shots that are not to be adjusted. Tuned.
const RIGID: f64 = 1e-4;
const TABLE_HINT: &str = "each survey has a line of column headings that starts with FROM and TO";
const HEADER_HINT: &str = "DECLINATION:, CORRECTIONS: and CORRECTIONS2: are followed by numbers";
const SHOT_HINT: &str =
    "a shot is FROM TO LENGTH BEARING INC LEFT UP DOWN RIGHT, followed by AZM2 INC2 if FORMAT has backsights";

/// The columns of every shot.
const COLUMNS: [Reading; 9] = [
    Reading::From,
    Reading::To,
    Reading::Of(Quantity::Length),
    Reading::Of(Quantity::Bearing),
    Reading::Of(Quantity::Gradient),
    Reading::Of(Quantity::Left),
    Reading::Of(Quantity::Up),
    Reading::Of(Quantity::Down),
    Reading::Of(Quantity::Right),
];
const INCLINATIONS: [Reading; 2] = [Reading::Of(Quantity::Gradient), Reading::Of(Quantity::BackGradient)];
/// The columns after them if there are backsights.
const BACKSIGHTS: [Reading; 2] = [Reading::Of(Quantity::BackBearing), Reading::Of(Quantity::BackGradient)];

impl Reader<'_> {
    /// Reads the shots of a file.
    pub(super) fn read_book(&mut self, bytes: &[u8]) -> Result<(), ReadError> {
        let text = files::text(bytes);
        let mut table = Table::default();
        let (mut in_shots, mut has_table) = (false, false);
        for (index, line) in text.split('\n').enumerate() {
            let line = self.files.line(index + 1, line)?;
            let file_position = self.files.file_position(index + 1);
            if line.contains('\x0c') || line.trim_ascii().starts_with('\x1a') {
                (table, in_shots) = (Table::default(), false);
                continue;
            }
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                [] => {}
                [..] if in_shots => {
                    self.shot(file_position, &table, &words)
                        .map_err(|message| self.files.fault(file_position, message, SHOT_HINT))?;
                }
                ["DECLINATION:", ref settings @ ..] => {
                    let read = Table::read(settings);
                    table = read.map_err(|message| self.files.fault(file_position, message, HEADER_HINT))?;
                }
                ["FROM", "TO", ..] => (in_shots, has_table) = (true, true),
                _ => {}
            }
        }
        if has_table { Ok(()) } else { Err(self.files.fault_of_file("has no table of shots", TABLE_HINT)) }
    }

    /// Adds a shot, unless its flags exclude it.
    fn shot(&mut self, file_position: FilePosition, table: &Table, words: &[&str]) -> Result<(), String> {
        let flags = table.flags(words);
        if flags.contains('X') {
            return Ok(());
        }
        let Some(row) = Columns::default().take(&table.order, words, &cell)? else { return Ok(()) };
        let ends = [self.station(&row.from)?, self.station(row.to.as_deref().unwrap_or_default())?];
        let walls_m = table.instruments.walls(&row, false);
        let station = ends[usize::from(table.walls_at_end)];
        self.centreline.section(Section { station, looking: ends, walls_m })?;
        let mut measured = table.instruments.shot(Style::Normal, &row)?;
        self.centreline.doubt(file_position, table.instruments.doubts(Style::Normal, &row));
        if let Measured::Shot { covariance, .. } = &mut measured {
            if !INCLINATIONS.iter().any(|&column| row.number(column).is_some()) {
                return Err("there is no inclination".to_owned());
            }
            if flags.contains('C') {
                *covariance *= RIGID;
            }
        }
        self.centreline.leg(ends, leg(flags), measured)
    }
}

fn leg(flags: &str) -> Leg {
    match flags {
        flags if flags.contains('S') => Leg::Splay,
        flags if flags.contains('P') => Leg::Surface,
        flags if flags.contains('L') => Leg::Duplicate,
        _ => Leg::Passage,
    }
}

/// Settings of a survey for all its shots.
struct Table {
    instruments: Instruments,
    order: Order,
    /// Number of columns before the flags.
    columns: usize,
    walls_at_end: bool,
}

impl Default for Table {
    fn default() -> Self {
        Self::new(Instruments::of_compass(), "")
    }
}

impl Table {
    /// `FORMAT` with 11 letters has no backsight flag, with 12 none for the end; with 15, two more letters precede both.
    fn new(instruments: Instruments, format: &str) -> Self {
        let format = format.as_bytes();
        let at = if format.len() >= 15 { 13 } else { 11 };
        let mut columns = COLUMNS.to_vec();
        if format.get(at) == Some(&b'B') {
            columns.extend(BACKSIGHTS);
        }
        let count = columns.len();
        columns.push(Reading::IgnoreAll);
        let order = Order::new(Style::Normal, &columns).expect("a shot has these columns");
        Self { instruments, order, columns: count, walls_at_end: format.get(at + 1) == Some(&b'T') }
    }

    /// Reads what follows `DECLINATION:`.
    fn read(words: &[&str]) -> Result<Self, String> {
        let mut words = words.iter().copied();
        let mut instruments = Instruments::of_compass();
        instruments.set_declination_rad(number(words.next().unwrap_or_default())?.to_radians());
        let mut format = "";
        while let Some(word) = words.next() {
            let corrected: &[Quantity] = match word {
                "CORRECTIONS:" => &[Quantity::Bearing, Quantity::Gradient, Quantity::Length],
                "CORRECTIONS2:" => &[Quantity::BackBearing, Quantity::BackGradient],
                "FORMAT:" => {
                    format = words.next().unwrap_or_default();
                    &[]
                }
                _ => &[],
            };
            for &quantity in corrected {
                instruments.correct(quantity, number(words.next().unwrap_or_default())?);
            }
        }
        Ok(Self::new(instruments, format))
    }

    /// The flags between `#|` and `#` after the columns.
    fn flags<'a>(&self, words: &[&'a str]) -> &'a str {
        let flags = words.get(self.columns).and_then(|word| word.strip_prefix("#|")).unwrap_or_default();
        flags.split('#').next().unwrap_or_default()
    }
}

/// The value of a column.
fn cell(reading: Reading, word: &str) -> Result<Cell, String> {
    let number = number(word)?;
    match reading {
        Reading::Of(Quantity::Length) if number < 0.0 => Err(format!("a shot has the length {} feet", shown(word))),
        Reading::Of(quantity) if quantity.is_angle() && number <= MISSING_DEG => Ok(Cell::Omitted),
        _ => Ok(Cell::Number(number)),
    }
}

fn number(word: &str) -> Result<f64, String> {
    let number = word.parse().ok().filter(|number: &f64| number.abs() < 1e9);
    number.ok_or_else(|| format!("{} is not a number", shown(word)))
}

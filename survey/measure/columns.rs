//! From lines to legs: the content of each column, and stations shared by two legs.

use super::{Order, Quantity, Reading, Style};
use plume_graph::echo::shown;

/// The content of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Cell {
    /// Explicitly no reading.
    Omitted,
    Number(f64),
    /// Plumbed upwards.
    Up,
    /// Plumbed downwards.
    Down,
    /// Level, over water.
    Level,
    /// Two numbers: at the start and at the end of the leg.
    Pair(f64, f64),
}

/// The readings of a leg or a station.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in super::super) struct Row {
    /// Station names as written: two of a leg, one of a cross-section.
    pub(in super::super) from: String,
    pub(in super::super) to: Option<String>,
    cells: Vec<(Reading, Cell)>,
}

impl Row {
    /// Readings of a leg whose stations are kept elsewhere.
    pub(in super::super) fn of(cells: Vec<(Reading, Cell)>) -> Self {
        Self { cells, ..Self::default() }
    }

    /// A number, if there is a reading.
    pub(in super::super) fn number(&self, reading: Reading) -> Option<f64> {
        match self.cell(reading) {
            Some(Cell::Number(number)) => Some(number),
            _ => None,
        }
    }

    pub(in super::super) fn cell(&self, reading: Reading) -> Option<Cell> {
        self.cells.iter().find(|(known, _)| *known == reading).map(|&(_, cell)| cell)
    }

    /// The same with its ends and their depths exchanged. Counter readings stay.
    fn reversed(mut self) -> Self {
        if let Some(to) = &mut self.to {
            std::mem::swap(&mut self.from, to);
        }
        for (reading, _) in &mut self.cells {
            *reading = match *reading {
                Reading::FromDepth => Reading::ToDepth,
                Reading::ToDepth => Reading::FromDepth,
                other => other,
            };
        }
        self
    }
}

/// Assembles lines according to an order of columns.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Columns {
    /// The previous station, if legs share stations.
    before: Option<Row>,
    /// The leg from it, once its line has been read.
    leg: Option<(Row, bool)>,
}

impl Columns {
    /// Takes the words of a line, and returns the rows that they complete. `cell` parses a word.
    ///
    /// # Errors
    /// If the words do not match the columns.
    pub(in super::super) fn take(
        &mut self,
        order: &Order,
        words: &[&str],
        cell: &dyn Fn(Reading, &str) -> Result<Cell, String>,
    ) -> Result<Option<Row>, String> {
        if words.is_empty() || order.style == Style::Ignore {
            *self = Self::default();
            return Ok(None);
        }
        let between = self.before.is_some() && self.leg.is_none() && order.lines.len() == 2;
        let (row, backwards) = read(&order.lines[usize::from(between)], words, cell)?;
        if !order.by_station || order.style == Style::Passage {
            return Ok(Some(row));
        }
        if between {
            self.leg = Some((row, backwards));
            return Ok(None);
        }
        Ok(self.arrive(row))
    }

    /// The leg that ends at this station.
    fn arrive(&mut self, here: Row) -> Option<Row> {
        let before = self.before.replace(here.clone())?;
        let (mut row, backwards) = self.leg.take().unwrap_or_default();
        row.from = before.from;
        row.to = Some(here.from);
        let ends = [
            (before.cells, [Reading::FromDepth, Reading::FromCount]),
            (here.cells, [Reading::ToDepth, Reading::ToCount]),
        ];
        for (cells, [depth, count]) in ends {
            row.cells.extend(cells.into_iter().map(|(reading, cell)| match reading {
                Reading::Of(Quantity::Depth) => (depth, cell),
                Reading::Of(Quantity::Count) => (count, cell),
                other => (other, cell),
            }));
        }
        Some(if backwards { row.reversed() } else { row })
    }
}

/// The readings of a line, and whether the leg was measured backwards.
fn read(
    columns: &[Reading],
    words: &[&str],
    cell: &dyn Fn(Reading, &str) -> Result<Cell, String>,
) -> Result<(Row, bool), String> {
    let mut row = Row::default();
    let mut backwards = false;
    let mut words = words.iter();
    for &column in columns {
        if column == Reading::IgnoreAll {
            return Ok((row, backwards));
        }
        let Some(&word) = words.next() else {
            return Err(format!("the line ends before {}", told(column)));
        };
        match column {
            Reading::Ignore => {}
            Reading::From | Reading::Station => row.from = word.to_owned(),
            Reading::To => row.to = Some(word.to_owned()),
            Reading::Direction => backwards = is_backwards(word)?,
            _ => row.cells.push((column, cell(column, word)?)),
        }
    }
    match words.next() {
        Some(word) => Err(format!("{} follows the last column", shown(word))),
        None => Ok((row, backwards)),
    }
}

fn is_backwards(word: &str) -> Result<bool, String> {
    match word {
        "F" | "f" => Ok(false),
        "B" | "b" => Ok(true),
        _ => Err(format!("{} is not a direction, which is F or B", shown(word))),
    }
}

fn told(column: Reading) -> String {
    match column {
        Reading::Of(quantity) => format!("a reading of the {quantity:?}").to_lowercase(),
        other => format!("`{other:?}`").to_lowercase(),
    }
}

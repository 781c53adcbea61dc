//! From lines to legs: what each column holds, and stations that two legs share.

use super::{Order, Quantity, Reading, Style};
use plume_graph::echo::shown;

/// What stands in a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Cell {
    /// Nothing was read, and a sign says so.
    Omitted,
    Number(f64),
    /// Plumbed upwards.
    Up,
    /// Plumbed downwards.
    Down,
    /// Over water.
    Level,
    /// Two numbers: at the beginning and at the end of the leg.
    Pair(f64, f64),
}

/// The readings of a leg or a station.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in super::super) struct Row {
    /// Stations, as they stand there: of a leg both, of a cross-section one.
    pub(in super::super) from: String,
    pub(in super::super) to: Option<String>,
    cells: Vec<(Reading, Cell)>,
}

impl Row {
    /// A number, where one was read.
    pub(in super::super) fn number(&self, reading: Reading) -> Option<f64> {
        match self.cell(reading) {
            Some(Cell::Number(number)) => Some(number),
            _ => None,
        }
    }

    pub(in super::super) fn cell(&self, reading: Reading) -> Option<Cell> {
        self.cells.iter().find(|(known, _)| *known == reading).map(|&(_, cell)| cell)
    }

    /// The same with its ends exchanged, and their depths. What was counted between them stays.
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

/// Puts lines together as an order says.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Columns {
    /// The station before, where legs share them.
    before: Option<Row>,
    /// The leg from it, once its line was read.
    leg: Option<(Row, bool)>,
}

impl Columns {
    /// Takes the words of a line, and gives what they complete. `cell` reads a word.
    ///
    /// # Errors
    /// When the words are not what the columns ask for.
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
            return Err(format!("the line ends where {} should stand", told(column)));
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
        Some(word) => Err(format!("{} stands behind the last column", shown(word))),
        None => Ok((row, backwards)),
    }
}

fn is_backwards(word: &str) -> Result<bool, String> {
    match word {
        "F" | "f" => Ok(false),
        "B" | "b" => Ok(true),
        _ => Err(format!("{} is no direction; it is F or B", shown(word))),
    }
}

fn told(column: Reading) -> String {
    match column {
        Reading::Of(quantity) => format!("a reading of the {quantity:?}").to_lowercase(),
        other => format!("`{other:?}`").to_lowercase(),
    }
}

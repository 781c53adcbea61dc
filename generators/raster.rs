//! Plans of square cells, and the centrelines in them.
//!
//! A [`Mask`] says which cells are open. Its open regions can be filtered and joined ([`regions`]), the distance of every
//! cell to rock measured ([`distance`]), and the open cells thinned to lines one cell wide ([`thin`]) that become a
//! [`CentrelineBuilder`](super::centreline::CentrelineBuilder) ([`trace`]). Everything up to the tracing is integer
//! arithmetic, in time linear in the number of cells.

mod distance;
mod regions;
mod thin;
mod trace;

pub(super) use regions::{joined, without_pillars, without_pockets};
pub(super) use trace::traced;

/// Cells of a plan, row by row. Those on the border are rock, so that every open cell has eight neighbours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mask {
    pub(super) columns: usize,
    pub(super) open: Vec<bool>,
}

impl Mask {
    /// All rock; at least three cells each way.
    pub(super) fn rock(columns: usize, rows: usize) -> Self {
        let (columns, rows) = (columns.max(3), rows.max(3));
        Self { columns, open: vec![false; columns * rows] }
    }

    pub(super) fn rows(&self) -> usize {
        self.open.len() / self.columns
    }

    /// Column and row of a cell.
    pub(super) fn place(&self, cell: usize) -> [usize; 2] {
        [cell % self.columns, cell / self.columns]
    }

    /// The inner cells.
    pub(super) fn inner(&self) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows());
        (1..rows - 1).flat_map(move |row| row * columns + 1..row * columns + columns - 1)
    }

    fn is_inner(&self, cell: usize) -> bool {
        let [column, row] = self.place(cell);
        (1..self.columns - 1).contains(&column) && (1..self.rows() - 1).contains(&row)
    }

    /// Turns the border into rock again.
    pub(super) fn close_border(&mut self) {
        let (columns, len) = (self.columns, self.open.len());
        self.open[..columns].fill(false);
        self.open[len - columns..].fill(false);
        self.open.chunks_exact_mut(columns).for_each(|row| {
            row[0] = false;
            row[columns - 1] = false;
        });
    }

    /// Opens the cells within `radius` cells of one, except the border.
    pub(super) fn dig(&mut self, [column, row]: [usize; 2], radius: usize) {
        let last = [self.columns - 2, self.rows() - 2];
        for y in row.saturating_sub(radius).max(1)..=(row + radius).min(last[1]) {
            for x in column.saturating_sub(radius).max(1)..=(column + radius).min(last[0]) {
                let (dx, dy) = (x.abs_diff(column), y.abs_diff(row));
                if dx * dx + dy * dy <= radius * radius {
                    self.open[y * self.columns + x] = true;
                }
            }
        }
    }

    /// Index offsets of the eight neighbours of a cell, in circular order from the east; to be added with `wrapping_add`.
    fn round(&self) -> [usize; 8] {
        let c = self.columns;
        let back = usize::wrapping_neg;
        [1, c + 1, c, c - 1, back(1), back(c + 1), back(c), back(c - 1)]
    }
}

#[cfg(test)]
impl Mask {
    /// Parses a plan drawn with `#` for rock.
    fn drawn(rows: &[&str]) -> Self {
        let open = rows.iter().flat_map(|row| row.bytes().map(|cell| cell != b'#')).collect();
        Self { columns: rows[0].len(), open }
    }

    fn picture(&self) -> Vec<String> {
        let row = |row: &[bool]| row.iter().map(|&open| if open { '.' } else { '#' }).collect();
        self.open.chunks_exact(self.columns).map(row).collect()
    }
}

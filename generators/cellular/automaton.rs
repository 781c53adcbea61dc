//! The automaton: cells filled at random, and the rule that smooths them.

use crate::raster::Mask;
use plume_graph::rng::Rng;

/// A square of cells, each rock with this probability.
pub(super) fn filled(side: usize, rock: f64, rng: &mut Rng) -> Mask {
    let mut mask = Mask::rock(side, side);
    for cell in mask.inner() {
        mask.open[cell] = !rng.chance(rock);
    }
    mask
}

/// Every cell with at least `least` rock cells among the nine around it becomes rock, the others open.
pub(super) fn step(mask: &mut Mask, least: u8) {
    let (columns, rows) = (mask.columns, mask.rows());
    let most_open = 9 - least;
    let mut above = vec![0; columns];
    let mut here = vec![0; columns];
    let mut below = vec![0; columns];
    sum_threes(&mask.open[..columns], &mut above);
    sum_threes(&mask.open[columns..2 * columns], &mut here);
    for row in 1..rows - 1 {
        sum_threes(&mask.open[(row + 1) * columns..][..columns], &mut below);
        let cells = &mut mask.open[row * columns..][..columns];
        for (column, open) in cells.iter_mut().enumerate() {
            *open = above[column] + here[column] + below[column] > most_open;
        }
        std::mem::swap(&mut above, &mut here);
        std::mem::swap(&mut here, &mut below);
    }
    mask.close_border();
}

/// Number of open cells among each one and its neighbours in the row.
fn sum_threes(row: &[bool], sums: &mut [u8]) {
    let last = row.len() - 1;
    for column in 1..last {
        sums[column] = u8::from(row[column - 1]) + u8::from(row[column]) + u8::from(row[column + 1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_the_rule_of_the_paper() {
        let mut rng = Rng::new(plume_graph::seed::stream(1, "test", 0));
        let before = filled(20, 0.5, &mut rng);
        let mut after = before.clone();
        step(&mut after, 5);
        for cell in before.inner() {
            let rows = [cell - before.columns, cell, cell + before.columns];
            let rock = rows.iter().flat_map(|&at| [at - 1, at, at + 1]).filter(|&at| !before.open[at]).count();
            assert_eq!(after.open[cell], rock < 5, "{cell}");
        }
    }
}

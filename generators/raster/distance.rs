//! Distance of every cell to rock: the exact Euclidean distance transform of Felzenszwalb and Huttenlocher ("Distance
//! Transforms of Sampled Functions", Theory of Computing 8, 2012), in integers.

use super::Mask;

/// Squared distance from the centre of each cell to that of the nearest rock cell, in cells.
pub(super) fn squares(mask: &Mask) -> Vec<u32> {
    let mut square = along_columns(mask);
    let mut envelope = Envelope::default();
    let mut line = vec![0; mask.columns];
    for row in square.chunks_exact_mut(mask.columns) {
        line.copy_from_slice(row);
        envelope.lower(&line, row);
    }
    square
}

/// Squared distances to rock in the same column.
fn along_columns(mask: &Mask) -> Vec<u32> {
    let (columns, len) = (mask.columns, mask.open.len());
    let mut far = vec![0_u32; len];
    for cell in columns..len {
        far[cell] = if mask.open[cell] { far[cell - columns] + 1 } else { 0 };
    }
    for cell in (0..len - columns).rev() {
        far[cell] = far[cell].min(far[cell + columns] + 1);
    }
    far.iter_mut().for_each(|far| *far *= *far);
    far
}

/// The lower envelope of parabolas, one over each cell of a row.
#[derive(Default)]
struct Envelope {
    /// Cells whose parabolas contribute.
    feet: Vec<usize>,
    /// Start of each part.
    starts: Vec<i64>,
}

impl Envelope {
    /// Writes into `row` the minimum of `heights[foot] + (cell - foot)²` over all feet.
    fn lower(&mut self, heights: &[u32], row: &mut [u32]) {
        self.feet.clear();
        self.starts.clear();
        for foot in 0..heights.len() {
            let start = loop {
                let Some(&last) = self.feet.last() else { break i64::MIN };
                let start = first_below(heights, last, foot);
                if start > self.starts[self.starts.len() - 1] {
                    break start;
                }
                self.feet.pop();
                self.starts.pop();
            };
            self.feet.push(foot);
            self.starts.push(start);
        }
        let mut part = 0;
        for (cell, value) in row.iter_mut().enumerate() {
            while self.starts.get(part + 1).is_some_and(|&start| start <= cell as i64) {
                part += 1;
            }
            let foot = self.feet[part];
            let aside = cell.abs_diff(foot) as u32;
            *value = heights[foot] + aside * aside;
        }
    }
}

/// The first cell at which the parabola over `right` is not above that over `left`.
fn first_below(heights: &[u32], left: usize, right: usize) -> i64 {
    let at = |foot: usize| i64::from(heights[foot]) + (foot * foot) as i64;
    let (rise, run) = (at(right) - at(left), 2 * (right - left) as i64);
    rise.div_euclid(run) + i64::from(rise.rem_euclid(run) > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_to_the_nearest_rock() {
        let mut mask = Mask::rock(31, 23);
        let mut rng = plume_graph::rng::Rng::new(plume_graph::seed::stream(1, "test", 0));
        for cell in mask.inner() {
            mask.open[cell] = rng.chance(0.93);
        }
        let rock: Vec<[usize; 2]> = (0..mask.open.len()).filter(|&c| !mask.open[c]).map(|c| mask.place(c)).collect();
        for (cell, &found) in squares(&mask).iter().enumerate() {
            let [x, y] = mask.place(cell);
            let apart = |[a, b]: &[usize; 2]| (a.abs_diff(x) * a.abs_diff(x) + b.abs_diff(y) * b.abs_diff(y)) as u32;
            assert_eq!(Some(found), rock.iter().map(apart).min());
        }
    }
}

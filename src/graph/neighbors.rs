//! Which knots are joined to which, in one piece of memory.

use std::ops::Index;

/// The neighbours of every knot, each list ascending.
pub(crate) struct Neighbors {
    /// Where those of each knot start in `others`, and the end of the last ones.
    starts: Vec<usize>,
    others: Vec<usize>,
}

impl Neighbors {
    /// The neighbours of so many knots along these lines.
    pub(crate) fn of(knots: usize, lines: &[[usize; 2]]) -> Self {
        let mut starts = vec![0; knots + 1];
        lines.iter().flatten().for_each(|&knot| starts[knot + 1] += 1);
        for knot in 1..starts.len() {
            starts[knot] += starts[knot - 1];
        }
        let mut next = starts.clone();
        let mut others = vec![0; 2 * lines.len()];
        for &[a, b] in lines {
            for [from, to] in [[a, b], [b, a]] {
                others[next[from]] = to;
                next[from] += 1;
            }
        }
        starts.windows(2).for_each(|ends| others[ends[0]..ends[1]].sort_unstable());
        Self { starts, others }
    }

    /// Knots, with neighbours or without.
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of neighbours of each knot.
    pub(crate) fn degrees(&self) -> impl Iterator<Item = usize> {
        self.starts.windows(2).map(|ends| ends[1] - ends[0])
    }
}

impl Index<usize> for Neighbors {
    type Output = [usize];

    fn index(&self, knot: usize) -> &[usize] {
        &self.others[self.starts[knot]..self.starts[knot + 1]]
    }
}

//! Removes spurs: bumps in a wall, and dead ends without room.

use super::Neighbors;
use super::centreline::{Branch, CentrelineBuilder, Vertex, VertexId};

/// A spur that extends less than this many half-widths beyond the passage it leaves is a bump in a wall (tuned).
const SPUR_REACH: f64 = 0.7;

impl CentrelineBuilder {
    /// Removes spurs that are mere bumps in the wall of the passage they leave.
    pub fn without_spurs(mut self) -> Self {
        loop {
            let neighbors = self.neighbors();
            let branches = self.branches_among(&neighbors);
            let spurs = branches.iter().filter_map(|branch| Spur::of(branch, &neighbors));
            let bumps = spurs.filter(|spur| self.is_bump(spur)).collect();
            let Some(gone) = shortest(bumps, usize::MAX, &neighbors) else { return self };
            self = self.without(&gone);
        }
    }

    /// Removes the shortest spurs among its branches, at most this many; `None` if none can be removed.
    pub(super) fn pruned(self, branches: &[Branch], neighbors: &Neighbors<Vertex>, most: usize) -> Option<Self> {
        let spurs = branches.iter().filter_map(|branch| Spur::of(branch, neighbors)).collect();
        shortest(spurs, most, neighbors).map(|gone| self.without(&gone))
    }

    fn is_bump(&self, spur: &Spur) -> bool {
        let [foot, tip] = [spur.foot, spur.tip].map(|end| self[end].half_width_m());
        spur.branch.length_m + tip < foot + SPUR_REACH * foot.max(tip)
    }
}

/// A branch from a junction to a dead end.
struct Spur<'a> {
    branch: &'a Branch,
    foot: VertexId,
    tip: VertexId,
}

impl<'a> Spur<'a> {
    fn of(branch: &'a Branch, neighbors: &Neighbors<Vertex>) -> Option<Self> {
        let [first, last] = [branch.first(), branch.last()];
        match (neighbors[first].len(), neighbors[last].len()) {
            (3.., 1) => Some(Self { branch, foot: first, tip: last }),
            (1, 3..) => Some(Self { branch, foot: last, tip: first }),
            _ => None,
        }
    }
}

/// The vertices of the shortest spurs, at most this many spurs; `None` if none can be removed. A junction keeps two passages,
/// so that the rest does not degenerate to points.
fn shortest(mut spurs: Vec<Spur>, most: usize, neighbors: &Neighbors<Vertex>) -> Option<Vec<bool>> {
    spurs.sort_by(|a, b| a.branch.shorter_first(b.branch));
    let mut left: Vec<usize> = neighbors.degrees().collect();
    let mut gone = vec![false; neighbors.len()];
    let mut lost = 0;
    for Spur { branch, foot, .. } in spurs {
        if lost < most && left[foot.index()] > 2 {
            left[foot.index()] -= 1;
            lost += 1;
            branch.vertices.iter().filter(|&&vertex| vertex != foot).for_each(|&vertex| gone[vertex.index()] = true);
        }
    }
    (lost > 0).then_some(gone)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn centreline(places: &[[f64; 2]], lines: &[[usize; 2]]) -> CentrelineBuilder {
        CentrelineBuilder::flat(places, lines).hollow(4.0)
    }

    #[test]
    fn bumps_are_removed_and_side_passages_stay() {
        let places = [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [10.0, 1.0], [30.0, 0.0], [20.0, 9.0]];
        let rough = centreline(&places, &[[0, 1], [1, 2], [1, 3], [2, 4], [2, 5]]);
        assert_eq!(rough.without_spurs().lines, VertexId::pairs([[0, 1], [1, 2], [2, 4], [2, 5]]));
    }
}

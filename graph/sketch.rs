//! Centrelines while they are drawn, and how they become a graph.
//!
//! Generators and readers add knots and lines in any order; the sketch rounds, welds, numbers and finishes them, so that
//! the laws of a graph hold for all of them.

use std::cmp::Ordering;

use nalgebra::Point3;
use rustc_hash::FxHashMap;

use super::branches::Branches;
use super::{Graph, Neighbors, Node, Section, millimetres};

/// A point on a centreline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// Position in metres.
    pub position: Point3<f64>,
    /// Width and height of the passage, where they are known.
    pub section: Option<Section>,
    /// Storey, 0 at the top.
    pub level: u32,
}

impl Knot {
    /// To either side; 0 where it is not known.
    pub fn half_width_m(&self) -> f64 {
        self.section.map_or(0.0, |section| 0.5 * section.width_m)
    }
}

/// Knots and the lines between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// The points.
    pub knots: Vec<Knot>,
    /// Pairs of indices into `knots`; may repeat.
    pub lines: Vec<[usize; 2]>,
}

impl Sketch {
    /// Adds a knot that hangs on nothing yet.
    pub fn add(&mut self, knot: Knot) -> usize {
        self.knots.push(knot);
        self.knots.len() - 1
    }

    /// Draws a line.
    pub fn join(&mut self, a: usize, b: usize) {
        self.lines.push([a, b]);
    }

    /// The graph: rounded to 1 mm, knots in one place welded, numbered by breadth from the first knot of each part, so
    /// that parents come before their children. The radius of a node is the way to its first child, or back to its parent
    /// at a dead end. Knots without a line are left out.
    pub fn into_graph(self) -> Graph {
        let Self { knots, lines } = self.welded();
        Graph::new(knots.into_iter().map(Node::from).collect(), lines).numbered_by_breadth().with_reaches()
    }

    /// Knots rounded to 1 mm, those in the same place made one; lines sorted, without repeats and lines from a knot to
    /// itself.
    pub fn welded(self) -> Self {
        let mut of_place: FxHashMap<[u64; 3], usize> = FxHashMap::default();
        let mut welded = Self::default();
        let mut new = Vec::with_capacity(self.knots.len());
        for knot in self.knots {
            let position = knot.position.map(millimetres);
            let key = position.coords.map(f64::to_bits).into();
            let next = welded.knots.len();
            let index = *of_place.entry(key).or_insert(next);
            if index == next {
                welded.knots.push(Knot { position, ..knot });
            }
            new.push(index);
        }
        let lines = self.lines.into_iter().map(|line| line.map(|knot| new[knot]));
        welded.lines = lines.filter(|[a, b]| a != b).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        welded.lines.sort_unstable();
        welded.lines.dedup();
        welded
    }

    /// The knots that lines join to each knot, ascending.
    pub fn neighbors(&self) -> Neighbors {
        Neighbors::of(self.knots.len(), &self.lines)
    }

    /// The branches between junctions and dead ends.
    pub fn branches(&self) -> Vec<Branch> {
        self.branches_among(&self.neighbors())
    }

    /// [`branches`](Self::branches) of a sketch whose neighbours are known.
    pub fn branches_among(&self, neighbors: &Neighbors) -> Vec<Branch> {
        let leg = |pair: &[usize]| self.distance_m(pair[0], pair[1]);
        let branch = |knots: &[usize]| Branch { knots: knots.to_vec(), length_m: knots.windows(2).map(leg).sum() };
        Branches::of(neighbors).iter().map(branch).collect()
    }

    /// The distance between two knots, in metres.
    pub fn distance_m(&self, a: usize, b: usize) -> f64 {
        (self.knots[a].position - self.knots[b].position).norm()
    }

    /// Without these knots and what hangs on them.
    pub fn without(self, gone: &[bool]) -> Self {
        let lines = self.lines.into_iter().filter(|line| line.iter().all(|&knot| !gone[knot])).collect();
        Self { knots: self.knots, lines }
    }
}

/// One of the [`Branches`] of a sketch.
pub struct Branch {
    /// Its knots in their order, the ends among them.
    pub knots: Vec<usize>,
    /// Its length in metres.
    pub length_m: f64,
}

impl Branch {
    /// Its ends, ascending.
    pub fn ends(&self) -> [usize; 2] {
        let [a, b] = [self.first(), self.last()];
        [a.min(b), a.max(b)]
    }

    /// The knot that it starts from.
    pub fn first(&self) -> usize {
        self.knots[0]
    }

    /// The knot that it ends in.
    pub fn last(&self) -> usize {
        self.knots[self.knots.len() - 1]
    }

    /// The order of lengths; of equals, that of their knots.
    pub fn shorter_first(&self, other: &Self) -> Ordering {
        self.length_m.total_cmp(&other.length_m).then_with(|| self.knots.cmp(&other.knots))
    }
}

/// A node that tells all of itself but its place in the graph and its radius.
impl From<Knot> for Node {
    fn from(Knot { position, section, level }: Knot) -> Self {
        Self {
            id: 0,
            parent: None,
            position,
            radius: 0.0,
            active: true,
            level,
            section: section.map(|section| section.map(millimetres)),
        }
    }
}

#[cfg(test)]
impl Sketch {
    /// Knots without sections at these places of the plan.
    pub fn flat(places: &[[f64; 2]], lines: &[[usize; 2]]) -> Self {
        let knot = |&[x, y]: &[f64; 2]| Knot { position: Point3::new(x, y, 0.0), section: None, level: 0 };
        Self { knots: places.iter().map(knot).collect(), lines: lines.to_vec() }
    }

    /// The same with passages of this width.
    pub fn hollow(mut self, width_m: f64) -> Self {
        let section = Section { width_m, height_m: 0.75 * width_m, shape: crate::Shape::Cave };
        self.knots.iter_mut().for_each(|knot| knot.section = Some(section));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_in_one_place_are_one_and_lone_ones_are_none() {
        let graph =
            Sketch::flat(&[[0.0, 0.0], [5.0, 0.0], [5.0001, 0.0], [9.0, 0.0], [50.0, 0.0]], &[[0, 1], [2, 3], [1, 2]])
                .into_graph();
        assert_eq!(graph.nodes.len(), 3);
        assert_eq!(graph.edges, [[0, 1], [1, 2]]);
    }
}

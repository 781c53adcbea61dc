//! Centrelines while they are drawn, and how they become a graph.
//!
//! Generators and readers add vertices and lines in any order; the centreline rounds, welds, numbers and finishes them, so that
//! the laws of a graph hold for all of them.

use std::cmp::Ordering;

use nalgebra::Point3;
use rustc_hash::FxHashMap;

use super::branches::Branches;
use super::{Graph, Neighbors, Node, Section, millimetres};

/// A point on a centreline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position in metres.
    pub position: Point3<f64>,
    /// Width and height of the passage, where they are known.
    pub section: Option<Section>,
    /// Storey, 0 at the top.
    pub level: u32,
}

impl Vertex {
    /// To either side; 0 where it is not known.
    pub fn half_width_m(&self) -> f64 {
        self.section.map_or(0.0, |section| 0.5 * section.width_m)
    }
}

/// Vertices and the lines between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CentrelineBuilder {
    /// The points.
    pub vertices: Vec<Vertex>,
    /// Pairs of indices into `vertices`; may repeat.
    pub lines: Vec<[usize; 2]>,
}

impl CentrelineBuilder {
    /// Adds a vertex that hangs on nothing yet.
    pub fn add(&mut self, vertex: Vertex) -> usize {
        self.vertices.push(vertex);
        self.vertices.len() - 1
    }

    /// Draws a line.
    pub fn join(&mut self, a: usize, b: usize) {
        self.lines.push([a, b]);
    }

    /// The graph: rounded to 1 mm, vertices in one place welded, numbered by breadth from the first vertex of each part, so
    /// that parents come before their children. The radius of a node is the way to its first child, or back to its parent
    /// at a dead end. Vertices without a line are left out.
    pub fn into_graph(self) -> Graph {
        let Self { vertices, lines } = self.welded();
        Graph::new(vertices.into_iter().map(Node::from).collect(), lines).numbered_by_breadth().with_reaches()
    }

    /// Vertices rounded to 1 mm, those in the same place made one; lines sorted, without repeats and lines from a vertex to
    /// itself.
    pub fn welded(self) -> Self {
        let mut of_place: FxHashMap<[u64; 3], usize> = FxHashMap::default();
        let mut welded = Self::default();
        let mut new = Vec::with_capacity(self.vertices.len());
        for vertex in self.vertices {
            let position = vertex.position.map(millimetres);
            let key = position.coords.map(f64::to_bits).into();
            let next = welded.vertices.len();
            let index = *of_place.entry(key).or_insert(next);
            if index == next {
                welded.vertices.push(Vertex { position, ..vertex });
            }
            new.push(index);
        }
        let lines = self.lines.into_iter().map(|line| line.map(|vertex| new[vertex]));
        welded.lines = lines.filter(|[a, b]| a != b).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        welded.lines.sort_unstable();
        welded.lines.dedup();
        welded
    }

    /// The vertices that lines join to each vertex, ascending.
    pub fn neighbors(&self) -> Neighbors {
        Neighbors::of(self.vertices.len(), &self.lines)
    }

    /// The branches between junctions and dead ends.
    pub fn branches(&self) -> Vec<Branch> {
        self.branches_among(&self.neighbors())
    }

    /// [`branches`](Self::branches) of a centreline whose neighbours are known.
    pub fn branches_among(&self, neighbors: &Neighbors) -> Vec<Branch> {
        let leg = |pair: &[usize]| self.distance_m(pair[0], pair[1]);
        let branch =
            |vertices: &[usize]| Branch { vertices: vertices.to_vec(), length_m: vertices.windows(2).map(leg).sum() };
        Branches::of(neighbors).iter().map(branch).collect()
    }

    /// The distance between two vertices, in metres.
    pub fn distance_m(&self, a: usize, b: usize) -> f64 {
        (self.vertices[a].position - self.vertices[b].position).norm()
    }

    /// Without these vertices and what hangs on them.
    pub fn without(self, gone: &[bool]) -> Self {
        let lines = self.lines.into_iter().filter(|line| line.iter().all(|&vertex| !gone[vertex])).collect();
        Self { vertices: self.vertices, lines }
    }
}

/// One of the [`Branches`] of a centreline.
pub struct Branch {
    /// Its vertices in their order, the ends among them.
    pub vertices: Vec<usize>,
    /// Its length in metres.
    pub length_m: f64,
}

impl Branch {
    /// Its ends, ascending.
    pub fn ends(&self) -> [usize; 2] {
        let [a, b] = [self.first(), self.last()];
        [a.min(b), a.max(b)]
    }

    /// The vertex that it starts from.
    pub fn first(&self) -> usize {
        self.vertices[0]
    }

    /// The vertex that it ends in.
    pub fn last(&self) -> usize {
        self.vertices[self.vertices.len() - 1]
    }

    /// The order of lengths; of equals, that of their vertices.
    pub fn shorter_first(&self, other: &Self) -> Ordering {
        self.length_m.total_cmp(&other.length_m).then_with(|| self.vertices.cmp(&other.vertices))
    }
}

/// A node that tells all of itself but its place in the graph and its radius.
impl From<Vertex> for Node {
    fn from(Vertex { position, section, level }: Vertex) -> Self {
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
impl CentrelineBuilder {
    /// Vertices without sections at these places of the plan.
    pub fn flat(places: &[[f64; 2]], lines: &[[usize; 2]]) -> Self {
        let vertex = |&[x, y]: &[f64; 2]| Vertex { position: Point3::new(x, y, 0.0), section: None, level: 0 };
        Self { vertices: places.iter().map(vertex).collect(), lines: lines.to_vec() }
    }

    /// The same with passages of this width.
    pub fn hollow(mut self, width_m: f64) -> Self {
        let section = Section { width_m, height_m: 0.75 * width_m, shape: crate::Shape::Cave };
        self.vertices.iter_mut().for_each(|vertex| vertex.section = Some(section));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_in_one_place_are_one_and_lone_ones_are_none() {
        let graph = CentrelineBuilder::flat(
            &[[0.0, 0.0], [5.0, 0.0], [5.0001, 0.0], [9.0, 0.0], [50.0, 0.0]],
            &[[0, 1], [2, 3], [1, 2]],
        )
        .into_graph();
        assert_eq!(graph.nodes.len(), 3);
        assert_eq!(graph.edges, [[0, 1], [1, 2]]);
    }
}

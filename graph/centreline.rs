//! Builds centrelines and turns them into a graph.
//!
//! Generators and readers add vertices and lines in any order; the builder rounds, welds and numbers them, so that the laws of
//! graphs hold for all of them.
//!
//! ```
//! use plume_graph::centreline::{CentrelineBuilder, Vertex};
//!
//! let mut centreline = CentrelineBuilder::default();
//! let corners = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0]];
//! let vertices = corners.map(|[x, y]| centreline.add(Vertex { position: [x, y, 0.0].into(), section: None, level: 0 }));
//! for i in 0..3 {
//!     centreline.join(vertices[i], vertices[(i + 1) % 3]);
//! }
//! assert_eq!(centreline.into_graph().loops(), 1);
//! ```

use std::cmp::Ordering;
use std::ops::{Index, IndexMut};

use nalgebra::Point3;
use rustc_hash::FxHashMap;

use super::branches::Branches;
use super::{Graph, Id, Neighbors, Node, Section, StationId, millimetres};

/// A point on a centreline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position in metres.
    pub position: Point3<f64>,
    /// Width and height of the passage, if known.
    pub section: Option<Section>,
    /// Storey, 0 at the top.
    pub level: u32,
}

impl Vertex {
    /// Height of the floor in metres; that of the axis if the section is unknown.
    pub fn floor_z(&self) -> f64 {
        self.position.z - self.section.map_or(0.0, |section| section.axis_height_m())
    }

    /// Half the width; 0 if unknown.
    pub fn half_width_m(&self) -> f64 {
        self.section.map_or(0.0, |section| 0.5 * section.width_m)
    }
}

/// A vertex of a centreline: its place among the vertices.
pub type VertexId = Id<Vertex>;

/// Vertices and the lines between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CentrelineBuilder {
    /// The points.
    pub vertices: Vec<Vertex>,
    /// Pairs of vertices; may repeat.
    pub lines: Vec<[VertexId; 2]>,
}

impl CentrelineBuilder {
    /// Adds an isolated vertex.
    pub fn add(&mut self, vertex: Vertex) -> VertexId {
        let id = VertexId::new(self.vertices.len());
        self.vertices.push(vertex);
        id
    }

    /// Adds a line.
    pub fn join(&mut self, a: VertexId, b: VertexId) {
        self.lines.push([a, b]);
    }

    /// The graph: rounded to 1 mm, vertices in one place welded, numbered breadth-first from the first vertex of each part, so
    /// that parents precede their children. The radius of a node is the distance to its first child, or to its parent at a
    /// dead end. Isolated vertices are dropped.
    pub fn into_graph(self) -> Graph {
        let Self { vertices, lines } = self.welded();
        // Each vertex becomes the station of the same place.
        let edges = lines.into_iter().map(|line| line.map(|vertex| StationId::new(vertex.index()))).collect();
        Graph::new(vertices.into_iter().map(Node::from).collect(), edges).numbered_by_breadth().with_reaches()
    }

    /// Rounds vertices to 1 mm and welds those in the same place; sorts lines, without duplicates and loops from a vertex to
    /// itself.
    pub fn welded(self) -> Self {
        let mut of_place: FxHashMap<[u64; 3], VertexId> = FxHashMap::default();
        let mut welded = Self::default();
        let mut new = Vec::with_capacity(self.vertices.len());
        for vertex in self.vertices {
            let position = vertex.position.map(millimetres);
            let key = position.coords.map(f64::to_bits).into();
            let next = VertexId::new(welded.vertices.len());
            let id = *of_place.entry(key).or_insert(next);
            if id == next {
                welded.vertices.push(Vertex { position, ..vertex });
            }
            new.push(id);
        }
        let lines = self.lines.into_iter().map(|line| line.map(|vertex| new[vertex.index()]));
        welded.lines = lines.filter(|[a, b]| a != b).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        welded.lines.sort_unstable();
        welded.lines.dedup();
        welded
    }

    /// Every vertex.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = VertexId> + ExactSizeIterator + Clone + use<> {
        VertexId::all(self.vertices.len())
    }

    /// The neighbours of each vertex, ascending.
    pub fn neighbors(&self) -> Neighbors<Vertex> {
        Neighbors::of(self.vertices.len(), &self.lines)
    }

    /// The branches between junctions and dead ends.
    pub fn branches(&self) -> Vec<Branch> {
        self.branches_among(&self.neighbors())
    }

    /// [`branches`](Self::branches) of a centreline whose neighbours are known.
    pub fn branches_among(&self, neighbors: &Neighbors<Vertex>) -> Vec<Branch> {
        let leg = |pair: &[VertexId]| self.distance_m(pair[0], pair[1]);
        let branch = |vertices: &[VertexId]| Branch {
            vertices: vertices.to_vec(),
            length_m: vertices.windows(2).map(leg).sum(),
        };
        Branches::of(neighbors).iter().map(branch).collect()
    }

    /// The distance between two vertices, in metres.
    pub fn distance_m(&self, a: VertexId, b: VertexId) -> f64 {
        (self[a].position - self[b].position).norm()
    }

    /// Drops these vertices and their lines.
    pub fn without(self, gone: &[bool]) -> Self {
        let lines = self.lines.into_iter().filter(|line| line.iter().all(|&vertex| !gone[vertex.index()])).collect();
        Self { vertices: self.vertices, lines }
    }
}

impl Index<VertexId> for CentrelineBuilder {
    type Output = Vertex;

    fn index(&self, vertex: VertexId) -> &Vertex {
        &self.vertices[vertex.index()]
    }
}

impl IndexMut<VertexId> for CentrelineBuilder {
    fn index_mut(&mut self, vertex: VertexId) -> &mut Vertex {
        &mut self.vertices[vertex.index()]
    }
}

/// One of the branches of a centreline.
pub struct Branch {
    /// Its vertices in order, including the ends.
    pub vertices: Vec<VertexId>,
    /// Its length in metres.
    pub length_m: f64,
}

impl Branch {
    /// Its ends, ascending.
    pub fn ends(&self) -> [VertexId; 2] {
        let [a, b] = [self.first(), self.last()];
        [a.min(b), a.max(b)]
    }

    /// The vertex where it starts.
    pub fn first(&self) -> VertexId {
        self.vertices[0]
    }

    /// The vertex where it ends.
    pub fn last(&self) -> VertexId {
        self.vertices[self.vertices.len() - 1]
    }

    /// Order by length, then by vertices.
    pub fn shorter_first(&self, other: &Self) -> Ordering {
        self.length_m.total_cmp(&other.length_m).then_with(|| self.vertices.cmp(&other.vertices))
    }
}

/// A node without its connections and its radius.
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
            name: None,
        }
    }
}

#[cfg(test)]
impl CentrelineBuilder {
    /// Vertices without sections at these horizontal positions.
    pub fn flat(places: &[[f64; 2]], lines: &[[usize; 2]]) -> Self {
        let vertex = |&[x, y]: &[f64; 2]| Vertex { position: Point3::new(x, y, 0.0), section: None, level: 0 };
        Self { vertices: places.iter().map(vertex).collect(), lines: VertexId::pairs(lines.iter().copied()) }
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
    fn vertices_in_one_place_are_welded_and_isolated_ones_dropped() {
        let graph = CentrelineBuilder::flat(
            &[[0.0, 0.0], [5.0, 0.0], [5.0001, 0.0], [9.0, 0.0], [50.0, 0.0]],
            &[[0, 1], [2, 3], [1, 2]],
        )
        .into_graph();
        assert_eq!(graph.nodes.len(), 3);
        assert_eq!(graph.edges, StationId::pairs([[0, 1], [1, 2]]));
    }
}

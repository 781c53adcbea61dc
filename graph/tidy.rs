//! Cleans up rough centrelines: merges crowded junctions, smooths bends, limits slopes, cuts to length.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Graph;
use super::centreline::{Branch, CentrelineBuilder, Vertex, VertexId};

/// Most passages at a node; no real cave has more (Collon et al. 2017).
pub const MOST_PASSAGES: usize = 5;
/// Passes over all lines that are too steep; each propagates a few lines further.
const SLOPE_ROUNDS: usize = 300;
/// Slope relative to the maximum to which lines that are too steep are reduced.
const GENTLER: f64 = 0.95;

impl CentrelineBuilder {
    /// Merges junctions joined by a passage shorter than `part` of the width there, as long as at most five passages meet
    /// there.
    pub fn with_junctions_merged(self, part: f64) -> Self {
        let neighbors = self.neighbors();
        let mut branches = self.branches_among(&neighbors);
        branches.sort_by(Branch::shorter_first);
        let mut degrees: Vec<usize> = neighbors.degrees().collect();
        let mut into: Vec<VertexId> = self.ids().collect();
        let mut gone = vec![false; self.vertices.len()];
        for branch in &branches {
            let [a, b] = [branch.first(), branch.last()].map(|end| root(&into, end));
            let width = 2.0 * self[a].half_width_m().min(self[b].half_width_m());
            let sum = degrees[a.index()] + degrees[b.index()];
            let crowded = degrees[a.index()] > 2 && degrees[b.index()] > 2 && branch.length_m < part * width;
            if !crowded || a == b || sum - 2 > MOST_PASSAGES {
                continue;
            }
            let [kept, lost] = if self[b].half_width_m() > self[a].half_width_m() { [b, a] } else { [a, b] };
            into[lost.index()] = kept;
            degrees[kept.index()] = sum - 2;
            branch.vertices[1..branch.vertices.len() - 1].iter().for_each(|&vertex| gone[vertex.index()] = true);
        }
        let lines = self.lines.iter().filter(|line| line.iter().all(|&vertex| !gone[vertex.index()]));
        let lines = lines.map(|line| line.map(|vertex| root(&into, vertex))).filter(|[a, b]| a != b).collect();
        Self { lines, vertices: self.vertices }
    }

    /// Rounds bends: in each pass, every vertex between junctions moves to the mean of itself and its neighbours, and takes the
    /// width there. Junctions and dead ends stay.
    pub fn smoothed(mut self, rounds: usize) -> Self {
        for branch in self.branches() {
            let mut vertices: Vec<Vertex> = branch.vertices.iter().map(|&vertex| self[vertex]).collect();
            for _ in 0..rounds {
                let mut before = vertices[0];
                for at in 1..vertices.len() - 1 {
                    let here = vertices[at];
                    vertices[at] = middle(&before, &here, &vertices[at + 1]);
                    before = here;
                }
            }
            let inner = 1..vertices.len() - 1;
            branch.vertices[inner.clone()].iter().zip(&vertices[inner]).for_each(|(&at, vertex)| self[at] = *vertex);
        }
        self
    }

    /// Evens out heights until the floor along hardly any line rises more than `most` per horizontal metre: each one along which
    /// it does pulls its ends towards each other, in turn.
    fn with_slopes_under(mut self, most: f64) -> Self {
        for _ in 0..SLOPE_ROUNDS {
            let mut steep = false;
            // Overcorrects steep lines, otherwise the passes would converge too slowly.
            for line in 0..self.lines.len() {
                let [a, b] = self.lines[line];
                let plan = (self[b].position - self[a].position).xy().norm();
                let rise = self[b].floor_z() - self[a].floor_z();
                if rise.abs() > most * plan + 0.001 {
                    steep = true;
                    let excess = rise.abs() - GENTLER * most * plan;
                    let each = 0.5 * excess.copysign(rise);
                    self[a].position.z += each;
                    self[b].position.z -= each;
                }
            }
            if !steep {
                break;
            }
        }
        self
    }

    /// Keeps one in `step` vertices between junctions, and drops isolated ones.
    pub fn with_every(self, step: usize) -> Self {
        let mut sparse = Self::default();
        let mut new = vec![None; self.vertices.len()];
        for branch in self.branches() {
            let last = branch.vertices.len() - 1;
            // A ring keeps two vertices between its ends, which coincide.
            let step = step.min(last / 3).max(1);
            let kept = (0..last).step_by(step).chain([last]);
            let mut before = None;
            for old in kept.map(|place| branch.vertices[place]) {
                let at = *new[old.index()].get_or_insert_with(|| sparse.add(self[old]));
                if let Some(before) = before.replace(at) {
                    sparse.join(before, at);
                }
            }
        }
        sparse
    }

    /// Makes this vertex the first one.
    fn rooted(mut self, root: VertexId) -> Self {
        let first = VertexId::new(0);
        let moved = |vertex: VertexId| match vertex {
            vertex if vertex == first => root,
            vertex if vertex == root => first,
            vertex => vertex,
        };
        self.lines.iter_mut().for_each(|line| *line = line.map(moved));
        self.vertices.swap(first.index(), root.index());
        self
    }

    /// Makes the vertex nearest to the origin the first one, among junctions and dead ends.
    pub fn rooted_in_the_middle(self) -> Self {
        let neighbors = self.neighbors();
        let away = |&vertex: &VertexId| {
            let passages = neighbors[vertex].len();
            (passages == 0, passages == 2, self[vertex].position.coords.norm_squared().to_bits())
        };
        let root = self.ids().min_by_key(away);
        root.map_or(Self::default(), |root| self.rooted(root))
    }

    /// Keeps what is nearest to the first vertex along the passages, up to `most_m` of them. Other components are dropped.
    pub fn cut_to(self, most_m: f64) -> Self {
        if self.vertices.is_empty() {
            return self;
        }
        let neighbors = self.neighbors();
        let mut distances = vec![f64::INFINITY; self.vertices.len()];
        let mut near = vec![false; self.vertices.len()];
        // Distances are not negative, so the order of their bits is their order.
        let mut front = BinaryHeap::from([Reverse((0_u64, VertexId::new(0)))]);
        distances[0] = 0.0;
        let mut sum_m = 0.0;
        while let Some(Reverse((bits, vertex))) = front.pop() {
            if near[vertex.index()] || sum_m > most_m {
                continue;
            }
            near[vertex.index()] = true;
            for &other in &neighbors[vertex] {
                let length = self.distance_m(vertex, other);
                if near[other.index()] {
                    sum_m += length;
                } else if f64::from_bits(bits) + length < distances[other.index()] {
                    distances[other.index()] = f64::from_bits(bits) + length;
                    front.push(Reverse((distances[other.index()].to_bits(), other)));
                }
            }
        }
        let gone: Vec<bool> = near.into_iter().map(|near| !near).collect();
        self.without(&gone)
    }

    /// A graph of exactly `nodes` nodes, the first one nearest to the first vertex, no passage rising more than `slope_max` per
    /// metre as far as possible; `None` if there are no lines. If there are too few nodes to keep all loops distinct, loops are
    /// opened.
    pub fn with_nodes(self, nodes: usize, slope_max: f64) -> Option<Graph> {
        let root = self.vertices.first()?.position;
        let fit = |centreline: Self| {
            let stations = centreline.with_stations(nodes)?;
            let away = |&vertex: &VertexId| (stations[vertex].position - root).norm_squared().to_bits();
            let first = stations.ids().min_by_key(away)?;
            let graph = stations.rooted(first).with_slopes_under(slope_max).into_graph();
            (graph.nodes.len() == nodes).then_some(graph)
        };
        fit(self.clone()).or_else(|| fit(self.opened()))
    }

    /// A breadth-first spanning tree from the first vertex.
    fn opened(mut self) -> Self {
        let neighbors = self.neighbors();
        let walk = neighbors.by_breadth(neighbors.nodes());
        self.lines = walk.filter_map(|(vertex, parent)| Some([parent?, vertex])).collect();
        self
    }
}

/// The vertex into which a vertex was merged. Chains are short: more than three junctions have too many passages to merge.
fn root(into: &[VertexId], mut vertex: VertexId) -> VertexId {
    while into[vertex.index()] != vertex {
        vertex = into[vertex.index()];
    }
    vertex
}

/// A vertex moved half way to the mean of its neighbours.
fn middle(before: &Vertex, here: &Vertex, after: &Vertex) -> Vertex {
    let blend = |a: f64, b: f64, c: f64| 0.25 * a + 0.5 * b + 0.25 * c;
    let coords = before.position.coords.zip_zip_map(&here.position.coords, &after.position.coords, blend);
    let mut vertex = Vertex { position: coords.into(), ..*here };
    if let (Some(a), Some(b), Some(c)) = (before.section, &mut vertex.section, after.section) {
        b.width_m = blend(a.width_m, b.width_m, c.width_m);
        b.height_m = blend(a.height_m, b.height_m, c.height_m);
    }
    vertex
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::StationId;

    fn centreline(places: &[[f64; 2]], lines: &[[usize; 2]]) -> CentrelineBuilder {
        CentrelineBuilder::flat(places, lines).hollow(4.0)
    }

    #[test]
    fn crowded_junctions_are_merged() {
        let places = [[0.0, 0.0], [1.0, 0.0], [-9.0, 5.0], [-9.0, -5.0], [9.0, 5.0], [9.0, -5.0]];
        let lines = [[0, 1], [0, 2], [0, 3], [1, 4], [1, 5]];
        let degrees = |centreline: CentrelineBuilder| centreline.neighbors().degrees().max();
        assert_eq!(degrees(centreline(&places, &lines).with_junctions_merged(0.5)), Some(4));
        assert_eq!(degrees(centreline(&places, &lines).with_junctions_merged(0.1)), Some(3));
    }

    #[test]
    fn what_is_farthest_from_the_first_vertex_is_cut() {
        let chain =
            centreline(&[[0.0, 0.0], [4.0, 0.0], [8.0, 0.0], [-4.0, 0.0], [50.0, 0.0]], &[[0, 1], [1, 2], [0, 3]]);
        assert_eq!(chain.cut_to(7.0).lines, VertexId::pairs([[0, 1], [0, 3]]));
    }

    #[test]
    fn a_bend_is_rounded_and_its_ends_stay() {
        let bend = centreline(&[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], &[[0, 1], [1, 2]]).smoothed(1);
        assert_eq!(bend.vertices[1].position, Point3::new(3.75, 1.25, 0.0));
        assert_eq!(bend.vertices[2].position, Point3::new(5.0, 5.0, 0.0));
    }

    #[test]
    fn steep_passages_are_flattened() {
        let mut stairs = centreline(&[[0.0, 0.0], [4.0, 0.0], [8.0, 0.0], [12.0, 0.0]], &[[0, 1], [1, 2], [2, 3]]);
        stairs.vertices[2].position.z = 3.0;
        let graph = stairs.with_nodes(4, 0.25).expect("there is a line");
        let way = |&[a, b]: &[StationId; 2]| graph[b].position - graph[a].position;
        assert!(graph.edges.iter().map(way).all(|way| way.z.abs() <= 0.25 * way.x.abs() + 0.003), "{:?}", graph.nodes);
    }

    #[test]
    fn loops_are_opened_if_there_are_too_few_nodes() {
        let square = centreline(&[[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]], &[[0, 1], [1, 2], [2, 3], [0, 3]]);
        let two = square.with_nodes(2, 1.0).expect("a line is left");
        assert_eq!((two.nodes.len(), two.edges.len()), (2, 1));
    }
}

//! Centrelines while they are drawn, and how they become a graph.
//!
//! Generators and readers add knots and lines in any order; the sketch rounds, welds, numbers and finishes them, so that
//! the laws of a graph hold for all of them.

use std::collections::BinaryHeap;

use nalgebra::Point3;
use rustc_hash::FxHashMap;

use super::neighbors::Neighbors;
use super::shape::millimetres;
use super::{Graph, Node, Section};

/// A point on a centreline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Knot {
    /// Position in metres.
    pub(crate) position: Point3<f64>,
    /// Width and height of the passage, where they are known.
    pub(crate) section: Option<Section>,
    /// Storey, 0 at the top.
    pub(crate) level: u32,
}

/// Knots and the lines between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sketch {
    pub(crate) knots: Vec<Knot>,
    /// Pairs of indices into `knots`; may repeat.
    pub(crate) lines: Vec<[usize; 2]>,
}

impl Sketch {
    /// Adds a knot that hangs on nothing yet.
    pub(crate) fn add(&mut self, knot: Knot) -> usize {
        self.knots.push(knot);
        self.knots.len() - 1
    }

    /// Draws a line.
    pub(crate) fn join(&mut self, a: usize, b: usize) {
        self.lines.push([a, b]);
    }

    /// The graph: rounded to 1 mm, knots in one place welded, numbered by breadth from the first knot of each part, so
    /// that parents come before their children. The radius of a node is the way to its first child, or back to its parent
    /// at a dead end. Knots without a line are left out.
    pub(crate) fn into_graph(self) -> Graph {
        let welded = self.welded();
        let neighbors = welded.neighbors();
        let (order, parents) = by_breadth(&neighbors);
        let mut place = vec![usize::MAX; welded.knots.len()];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        let node = |(id, &old): (usize, &usize)| Node {
            id: id as u64,
            parent: parents[old].map(|parent| place[parent]),
            position: welded.knots[old].position,
            radius: 0.0,
            active: neighbors[old].len() == 1,
            level: welded.knots[old].level,
            section: welded.knots[old].section.map(|section| section.map(millimetres)),
        };
        let nodes = order.iter().enumerate().map(node).collect();
        let edges = welded.lines.iter().map(|line| line.map(|knot| place[knot])).collect();
        with_reaches(Graph::new(nodes, edges))
    }

    /// Knots rounded to 1 mm, those in the same place made one; lines sorted, without repeats and lines from a knot to
    /// itself.
    fn welded(self) -> Self {
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
    pub(crate) fn neighbors(&self) -> Neighbors {
        Neighbors::of(self.knots.len(), &self.lines)
    }

    pub(super) fn distance(&self, a: usize, b: usize) -> f64 {
        (self.knots[a].position - self.knots[b].position).norm()
    }
}

/// A graph of these stations and the neighbours of each, numbered by breadth from the first one, so that parents come before
/// their children. Stations without neighbours are left out; those with several are not active.
pub(super) fn rooted(nodes: Vec<Node>, neighbors: Vec<Vec<usize>>) -> Graph {
    let edges = neighbors.iter().enumerate().flat_map(|(a, others)| others.iter().map(move |&b| [a, b]));
    let edges: Vec<[usize; 2]> = edges.filter(|[a, b]| a < b).collect();
    let neighbors = Neighbors::of(nodes.len(), &edges);
    let (order, parents) = by_breadth(&neighbors);
    let mut place = vec![usize::MAX; nodes.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
    let node = |(id, &old): (usize, &usize)| Node {
        id: id as u64,
        parent: parents[old].map(|parent: usize| place[parent]),
        active: nodes[old].active && neighbors[old].len() == 1,
        ..nodes[old].clone()
    };
    let edges = edges.into_iter().map(|ends| ends.map(|old| place[old])).collect();
    Graph::new(order.iter().enumerate().map(node).collect(), edges)
}

/// Knots that have neighbours, each after the one it was reached from, and that one.
fn by_breadth(neighbors: &Neighbors) -> (Vec<usize>, Vec<Option<usize>>) {
    let mut order = Vec::with_capacity(neighbors.len());
    let mut parents = vec![None; neighbors.len()];
    let mut seen = vec![false; neighbors.len()];
    let mut next = 0;
    for start in 0..neighbors.len() {
        if seen[start] || neighbors[start].is_empty() {
            continue;
        }
        seen[start] = true;
        order.push(start);
        while let Some(&knot) = order.get(next) {
            next += 1;
            for &other in &neighbors[knot] {
                if !seen[other] {
                    seen[other] = true;
                    parents[other] = Some(knot);
                    order.push(other);
                }
            }
        }
    }
    (order, parents)
}

/// Fills in the radii.
fn with_reaches(mut graph: Graph) -> Graph {
    for index in (0..graph.nodes.len()).rev() {
        let Some(parent) = graph.nodes[index].parent else { continue };
        let reach = millimetres(graph.distance_m(index, parent)).max(0.001);
        if graph.nodes[index].radius == 0.0 {
            graph.nodes[index].radius = reach;
        }
        graph.nodes[parent].radius = reach;
    }
    graph
}

/// A run of lines between two knots that do not have exactly two neighbours.
pub(super) struct Strand {
    pub(super) knots: Vec<usize>,
    pub(super) length: f64,
}

/// A strand on the way to its share of stations, the one that lacks most first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Lack {
    /// Length by stations, in micrometres.
    gap_um: u64,
    strand: std::cmp::Reverse<usize>,
}

impl Sketch {
    /// The same centrelines with exactly `count` knots, spread as evenly along them as junctions allow. Where junctions
    /// alone are more, the shortest dead ends go first. `None` if fewer than `count` can be had or they cannot be lost.
    pub(crate) fn with_stations(self, count: usize) -> Option<Self> {
        let mut sketch = self.welded();
        loop {
            let strands = sketch.strands();
            let fixed = sketch.junctions(&strands);
            let shares = least_inside(&strands);
            let least: usize = shares.iter().sum();
            if fixed + least <= count {
                return Some(sketch.spread(&strands, shares, count - fixed - least));
            }
            sketch = sketch.pruned(&strands, fixed + least - count)?;
        }
    }

    /// Strands in order of their first knot. A ring without junctions is a strand from its lowest knot to itself.
    pub(super) fn strands(&self) -> Vec<Strand> {
        self.strands_among(&self.neighbors())
    }

    /// [`strands`](Self::strands) of a sketch whose neighbours are known.
    pub(super) fn strands_among(&self, neighbors: &Neighbors) -> Vec<Strand> {
        let mut seen = vec![false; self.knots.len()];
        let mut strands = Vec::new();
        let is_end = |knot: usize| neighbors[knot].len() != 2;
        for start in (0..self.knots.len()).filter(|&knot| is_end(knot)) {
            for &first in &neighbors[start] {
                // A strand is walked from its first end; one of two knots has no inner knot to tell by.
                if seen[first] || (is_end(first) && first < start) {
                    continue;
                }
                strands.push(self.walk(neighbors, &mut seen, start, first));
            }
        }
        for start in 0..self.knots.len() {
            if !is_end(start) && !seen[start] {
                seen[start] = true;
                strands.push(self.walk(neighbors, &mut seen, start, neighbors[start][0]));
            }
        }
        strands
    }

    fn walk(&self, neighbors: &Neighbors, seen: &mut [bool], start: usize, first: usize) -> Strand {
        let mut strand = Strand { knots: vec![start, first], length: self.distance(start, first) };
        let (mut before, mut at) = (start, first);
        while let (&[a, b], true) = (&neighbors[at], at != start) {
            seen[at] = true;
            (before, at) = (at, if a == before { b } else { a });
            strand.length += self.distance(before, at);
            strand.knots.push(at);
        }
        strand
    }

    fn junctions(&self, strands: &[Strand]) -> usize {
        let mut ends: Vec<usize> = strands.iter().flat_map(|strand| [strand.first(), strand.last()]).collect();
        ends.sort_unstable();
        ends.dedup();
        ends.len()
    }

    /// Without the shortest dead ends, at most `surplus` of them.
    fn pruned(self, strands: &[Strand], surplus: usize) -> Option<Self> {
        let neighbors = self.neighbors();
        let is_spur = |strand: &&Strand| {
            let degrees = [strand.first(), strand.last()].map(|end| neighbors[end].len());
            degrees[0].min(degrees[1]) == 1 && degrees[0].max(degrees[1]) > 2
        };
        let mut spurs: Vec<&Strand> = strands.iter().filter(is_spur).collect();
        spurs.sort_by(|a, b| a.length.total_cmp(&b.length).then(a.knots.cmp(&b.knots)));
        let mut taken = vec![0_usize; self.knots.len()];
        let mut gone = vec![false; self.knots.len()];
        let mut lost = 0;
        for spur in spurs {
            let [foot, _] = foot_and_tip(spur, &neighbors);
            // A junction keeps two passages, so that no spur turns what is left into points.
            if lost < surplus && taken[foot] + 2 < neighbors[foot].len() {
                taken[foot] += 1;
                lost += 1;
                spur.knots.iter().filter(|&&knot| knot != foot).for_each(|&knot| gone[knot] = true);
            }
        }
        (lost > 0).then(|| self.without(&gone))
    }

    /// Without these knots and what hangs on them.
    pub(super) fn without(self, gone: &[bool]) -> Self {
        let lines = self.lines.into_iter().filter(|line| line.iter().all(|&knot| !gone[knot])).collect();
        Self { knots: self.knots, lines }
    }

    /// Puts `more` stations on the strands beside their `shares`, always where the gaps are longest.
    fn spread(&self, strands: &[Strand], mut shares: Vec<usize>, more: usize) -> Self {
        let gap = |strand: usize, share: usize| Lack {
            gap_um: (strands[strand].length * 1e6 / (share + 1) as f64) as u64,
            strand: std::cmp::Reverse(strand),
        };
        let mut lacks: BinaryHeap<Lack> =
            shares.iter().enumerate().map(|(strand, &share)| gap(strand, share)).collect();
        for _ in 0..more {
            let Some(Lack { strand, .. }) = lacks.pop() else { break };
            shares[strand.0] += 1;
            lacks.push(gap(strand.0, shares[strand.0]));
        }
        let mut sketch = Self::default();
        let mut ends: FxHashMap<usize, usize> = FxHashMap::default();
        for (strand, share) in strands.iter().zip(shares) {
            let mut end = |knot: usize| *ends.entry(knot).or_insert_with(|| sketch.add(self.knots[knot]));
            let (first, last) = (end(strand.first()), end(strand.last()));
            let mut before = first;
            for station in self.along(strand, share) {
                let next = sketch.add(station);
                sketch.join(before, next);
                before = next;
            }
            sketch.join(before, last);
        }
        sketch
    }

    /// `count` knots between the ends of a strand, evenly along it.
    fn along<'a>(&'a self, strand: &'a Strand, count: usize) -> impl Iterator<Item = Knot> + 'a {
        let step = strand.length / (count + 1) as f64;
        let (mut leg, mut start) = (0, 0.0);
        (1..=count).map(move |place| {
            let at = step * place as f64;
            loop {
                let [a, b] = [strand.knots[leg], strand.knots[leg + 1]];
                let length = self.distance(a, b);
                if at <= start + length || leg + 2 == strand.knots.len() {
                    let share = if length > 0.0 { ((at - start) / length).min(1.0) } else { 0.0 };
                    return between(&self.knots[a], &self.knots[b], share);
                }
                start += length;
                leg += 1;
            }
        })
    }
}

impl Strand {
    pub(super) fn first(&self) -> usize {
        self.knots[0]
    }

    pub(super) fn last(&self) -> usize {
        self.knots[self.knots.len() - 1]
    }
}

/// The ends of a strand, the one with fewer passages last.
pub(super) fn foot_and_tip(strand: &Strand, neighbors: &Neighbors) -> [usize; 2] {
    let [first, last] = [strand.first(), strand.last()];
    if neighbors[first].len() < neighbors[last].len() { [last, first] } else { [first, last] }
}

/// Knots that each strand keeps inside: a ring two, and one where another strand has the same ends, lest two become one.
fn least_inside(strands: &[Strand]) -> Vec<usize> {
    let ends = |strand: &Strand| {
        let [a, b] = [strand.first(), strand.last()];
        [a.min(b), a.max(b)]
    };
    let mut alike: FxHashMap<[usize; 2], usize> = FxHashMap::default();
    strands.iter().for_each(|strand| *alike.entry(ends(strand)).or_default() += 1);
    let least = |strand: &Strand| match ends(strand) {
        [a, b] if a == b => 2,
        both => usize::from(alike[&both] > 1 && strand.knots.len() > 2),
    };
    strands.iter().map(least).collect()
}

/// The knot this share of the way from one to the next.
fn between(a: &Knot, b: &Knot, share: f64) -> Knot {
    let section = match (a.section, b.section) {
        (Some(a), Some(b)) => Some(a.towards(b, share)),
        (one, other) => one.or(other),
    };
    let position = a.position + (b.position - a.position) * share;
    Knot { position, section, level: if share < 0.5 { a.level } else { b.level } }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sketch(places: &[[f64; 2]], lines: &[[usize; 2]]) -> Sketch {
        let knot = |&[x, y]: &[f64; 2]| Knot { position: Point3::new(x, y, 0.0), section: None, level: 0 };
        Sketch { knots: places.iter().map(knot).collect(), lines: lines.to_vec() }
    }

    #[test]
    fn stations_are_spread_evenly_and_exactly() {
        let line = sketch(&[[0.0, 0.0], [1.0, 0.0], [10.0, 0.0]], &[[0, 1], [1, 2]]);
        let graph = line.with_stations(5).expect("it is long enough").into_graph();
        let x: Vec<f64> = graph.nodes.iter().map(|node| node.position.x).collect();
        assert_eq!(x, [0.0, 2.5, 5.0, 7.5, 10.0]);
        assert_eq!(graph.nodes[4].parent, Some(3));
        assert!(graph.nodes.iter().all(|node| node.radius == 2.5));
    }

    #[test]
    fn rings_and_parallel_passages_stay_apart() {
        let ring = sketch(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]], &[[0, 1], [1, 2], [2, 3], [3, 0]]);
        let graph = ring.with_stations(3).expect("a triangle").into_graph();
        assert_eq!((graph.nodes.len(), graph.loops()), (3, 1));
        let eight = [[0.0, 0.0], [8.0, 0.0], [4.0, 3.0], [4.0, -3.0], [-5.0, 0.0], [13.0, 0.0]];
        let eight = sketch(&eight, &[[0, 2], [2, 1], [0, 3], [3, 1], [4, 0], [5, 1]]);
        let graph = eight.with_stations(20).expect("long enough").into_graph();
        assert_eq!((graph.nodes.len(), graph.loops()), (20, 1));
    }

    #[test]
    fn the_shortest_dead_ends_go_first() {
        let star = [[0.0, 0.0], [9.0, 0.0], [0.0, 8.0], [-7.0, 0.0], [0.0, -1.0]];
        let star = sketch(&star, &[[0, 1], [0, 2], [0, 3], [0, 4]]);
        let graph = star.clone().with_stations(4).expect("one may go").into_graph();
        assert_eq!(graph.nodes.len(), 4);
        assert!(graph.nodes.iter().all(|node| node.position.y >= 0.0));
        assert_eq!(star.with_stations(2).expect("two go").into_graph().nodes.len(), 2);
    }

    #[test]
    fn knots_in_one_place_are_one_and_lone_ones_are_none() {
        let graph =
            sketch(&[[0.0, 0.0], [5.0, 0.0], [5.0001, 0.0], [9.0, 0.0], [50.0, 0.0]], &[[0, 1], [2, 3], [1, 2]])
                .into_graph();
        assert_eq!(graph.nodes.len(), 3);
        assert_eq!(graph.edges, [[0, 1], [1, 2]]);
    }
}

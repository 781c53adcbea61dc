//! Centrelines while they are drawn, and how they become a graph.
//!
//! Generators and readers add knots and lines in any order; the sketch rounds, welds, numbers and finishes them, so that
//! the laws of a graph hold for all of them.

use std::collections::BinaryHeap;

use nalgebra::Point3;
use rustc_hash::FxHashMap;

use super::branches::Branches;
use super::{Graph, Neighbors, Node, Section, millimetres};

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
        let Self { knots, lines } = self.welded();
        with_reaches(Graph::new(knots.into_iter().map(Node::from).collect(), lines).numbered_by_breadth())
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

/// One of the [`Branches`] of a sketch.
pub(super) struct Branch {
    pub(super) knots: Vec<usize>,
    pub(super) length: f64,
}

/// A branch on the way to its share of stations, the one that lacks most first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Lack {
    /// Length by stations, in micrometres.
    gap_um: u64,
    branch: std::cmp::Reverse<usize>,
}

impl Sketch {
    /// The same centrelines with exactly `count` knots, spread as evenly along them as junctions allow. Where junctions
    /// alone are more, the shortest dead ends go first. `None` if fewer than `count` can be had or they cannot be lost.
    pub(crate) fn with_stations(self, count: usize) -> Option<Self> {
        let mut sketch = self.welded();
        loop {
            let branches = sketch.branches();
            let fixed = sketch.junctions(&branches);
            let shares = least_inside(&branches);
            let least: usize = shares.iter().sum();
            if fixed + least <= count {
                return Some(sketch.spread(&branches, shares, count - fixed - least));
            }
            sketch = sketch.pruned(&branches, fixed + least - count)?;
        }
    }

    /// The branches between junctions and dead ends.
    pub(super) fn branches(&self) -> Vec<Branch> {
        self.branches_among(&self.neighbors())
    }

    /// [`branches`](Self::branches) of a sketch whose neighbours are known.
    pub(super) fn branches_among(&self, neighbors: &Neighbors) -> Vec<Branch> {
        let leg = |pair: &[usize]| self.distance(pair[0], pair[1]);
        let branch = |knots: &[usize]| Branch { knots: knots.to_vec(), length: knots.windows(2).map(leg).sum() };
        Branches::of(neighbors).iter().map(branch).collect()
    }

    fn junctions(&self, branches: &[Branch]) -> usize {
        let mut ends: Vec<usize> = branches.iter().flat_map(|branch| [branch.first(), branch.last()]).collect();
        ends.sort_unstable();
        ends.dedup();
        ends.len()
    }

    /// Without the shortest dead ends, at most `surplus` of them.
    fn pruned(self, branches: &[Branch], surplus: usize) -> Option<Self> {
        let neighbors = self.neighbors();
        let is_spur = |branch: &&Branch| {
            let degrees = [branch.first(), branch.last()].map(|end| neighbors[end].len());
            degrees[0].min(degrees[1]) == 1 && degrees[0].max(degrees[1]) > 2
        };
        let mut spurs: Vec<&Branch> = branches.iter().filter(is_spur).collect();
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

    /// Puts `more` stations on the branches beside their `shares`, always where the gaps are longest.
    fn spread(&self, branches: &[Branch], mut shares: Vec<usize>, more: usize) -> Self {
        let gap = |branch: usize, share: usize| Lack {
            gap_um: (branches[branch].length * 1e6 / (share + 1) as f64) as u64,
            branch: std::cmp::Reverse(branch),
        };
        let mut lacks: BinaryHeap<Lack> =
            shares.iter().enumerate().map(|(branch, &share)| gap(branch, share)).collect();
        for _ in 0..more {
            let Some(Lack { branch, .. }) = lacks.pop() else { break };
            shares[branch.0] += 1;
            lacks.push(gap(branch.0, shares[branch.0]));
        }
        let mut sketch = Self::default();
        let mut ends: FxHashMap<usize, usize> = FxHashMap::default();
        for (branch, share) in branches.iter().zip(shares) {
            let mut end = |knot: usize| *ends.entry(knot).or_insert_with(|| sketch.add(self.knots[knot]));
            let (first, last) = (end(branch.first()), end(branch.last()));
            let mut before = first;
            for station in self.along(branch, share) {
                let next = sketch.add(station);
                sketch.join(before, next);
                before = next;
            }
            sketch.join(before, last);
        }
        sketch
    }

    /// `count` knots between the ends of a branch, evenly along it.
    fn along<'a>(&'a self, branch: &'a Branch, count: usize) -> impl Iterator<Item = Knot> + 'a {
        let step = branch.length / (count + 1) as f64;
        let (mut leg, mut start) = (0, 0.0);
        (1..=count).map(move |place| {
            let at = step * place as f64;
            loop {
                let [a, b] = [branch.knots[leg], branch.knots[leg + 1]];
                let length = self.distance(a, b);
                if at <= start + length || leg + 2 == branch.knots.len() {
                    let share = if length > 0.0 { ((at - start) / length).min(1.0) } else { 0.0 };
                    return between(&self.knots[a], &self.knots[b], share);
                }
                start += length;
                leg += 1;
            }
        })
    }
}

impl Branch {
    pub(super) fn first(&self) -> usize {
        self.knots[0]
    }

    pub(super) fn last(&self) -> usize {
        self.knots[self.knots.len() - 1]
    }
}

/// The ends of a branch, the one with fewer passages last.
pub(super) fn foot_and_tip(branch: &Branch, neighbors: &Neighbors) -> [usize; 2] {
    let [first, last] = [branch.first(), branch.last()];
    if neighbors[first].len() < neighbors[last].len() { [last, first] } else { [first, last] }
}

/// Knots that each branch keeps inside: a ring two, and one where another branch has the same ends, lest two become one.
fn least_inside(branches: &[Branch]) -> Vec<usize> {
    let ends = |branch: &Branch| {
        let [a, b] = [branch.first(), branch.last()];
        [a.min(b), a.max(b)]
    };
    let mut alike: FxHashMap<[usize; 2], usize> = FxHashMap::default();
    branches.iter().for_each(|branch| *alike.entry(ends(branch)).or_default() += 1);
    let least = |branch: &Branch| match ends(branch) {
        [a, b] if a == b => 2,
        both => usize::from(alike[&both] > 1 && branch.knots.len() > 2),
    };
    branches.iter().map(least).collect()
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

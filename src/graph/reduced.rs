//! The reduced graph: branches in place of chains of stations.

use rustc_hash::FxHashMap;

use super::Graph;

/// The branches of a graph: paths of stations whose ends do not have exactly two passages, and whose inner ones do.
pub(super) struct Branches {
    stations: Vec<usize>,
    /// Where each branch starts in `stations`, and the end of the last one.
    starts: Vec<usize>,
}

impl Branches {
    pub(super) fn of(graph: &Graph) -> Self {
        let neighbors = graph.neighbors();
        let mut walked = vec![Vec::new(); graph.nodes.len()];
        let mut branches = Self { stations: Vec::new(), starts: vec![0] };
        for (knot, others) in neighbors.iter().enumerate() {
            if others.len() == 2 {
                continue;
            }
            for &first in others {
                if !walked[knot].contains(&first) {
                    let before_end = branches.walk(&neighbors, knot, first);
                    let end = branches.stations[branches.stations.len() - 1];
                    walked[end].push(before_end);
                }
            }
        }
        branches
    }

    /// Follows a branch to its end and returns the station before that.
    fn walk(&mut self, neighbors: &[Vec<usize>], knot: usize, first: usize) -> usize {
        let (mut before, mut at) = (knot, first);
        self.stations.extend([before, at]);
        while let &[a, b] = neighbors[at].as_slice() {
            let next = if a == before { b } else { a };
            (before, at) = (at, next);
            self.stations.push(at);
        }
        self.starts.push(self.stations.len());
        before
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[usize]> {
        self.starts.windows(2).map(|ends| &self.stations[ends[0]..ends[1]])
    }

    /// The length of each branch in metres.
    pub(super) fn lengths(&self, graph: &Graph) -> Vec<f64> {
        let leg = |pair: &[usize]| graph.distance_m(pair[0], pair[1]);
        self.iter().map(|branch| branch.windows(2).map(leg).sum()).collect()
    }
}

/// A simple graph of branch ends. Rings keep two and parallel branches one of their inner stations, so that neither
/// collapses.
pub(super) struct Reduced {
    neighbors: Vec<Vec<usize>>,
}

impl Reduced {
    pub(super) fn of(branches: &Branches) -> Self {
        let mut parallel: FxHashMap<[usize; 2], u32> = FxHashMap::default();
        for branch in branches.iter() {
            *parallel.entry(ends(branch)).or_default() += 1;
        }
        let mut builder = Builder::default();
        for branch in branches.iter() {
            let last = branch.len() - 1;
            let [first, end] = ends(branch);
            if first == end {
                let third = branch.len() / 3;
                builder.join(branch[0], branch[third]);
                builder.join(branch[third], branch[2 * third]);
                builder.join(branch[2 * third], branch[last]);
            } else if parallel[&[first, end]] > 1 && branch.len() > 2 {
                let half = branch.len() / 2;
                builder.join(branch[0], branch[half]);
                builder.join(branch[half], branch[last]);
            } else {
                builder.join(branch[0], branch[last]);
            }
        }
        Self { neighbors: builder.neighbors }
    }

    pub(super) fn degree(&self, node: usize) -> usize {
        self.neighbors[node].len()
    }

    pub(super) fn degrees(&self) -> impl Iterator<Item = usize> {
        self.neighbors.iter().map(Vec::len)
    }

    pub(super) fn directed_edges(&self) -> impl Iterator<Item = (usize, usize)> {
        let of_one = |(a, others): (usize, &Vec<usize>)| {
            let pairs: Vec<_> = others.iter().map(|&b| (a, b)).collect();
            pairs
        };
        self.neighbors.iter().enumerate().flat_map(of_one)
    }

    /// The part of shortest paths between other nodes that lead over each node (Brandes 2001).
    pub(super) fn betweenness(&self) -> Vec<f64> {
        let len = self.neighbors.len();
        let mut between = vec![0.0; len];
        let mut search = Search::new(len);
        for source in 0..len {
            search.run(&self.neighbors, source);
            search.add_to(&self.neighbors, source, &mut between);
        }
        let pairs = match len {
            0..=2 => 1.0,
            _ => ((len - 1) * (len - 2)) as f64,
        };
        between.iter().map(|b| b / pairs).collect()
    }
}

fn ends(branch: &[usize]) -> [usize; 2] {
    let (first, last) = (branch[0], branch[branch.len() - 1]);
    [first.min(last), first.max(last)]
}

/// Gives stations their place in the reduced graph as they come.
#[derive(Default)]
struct Builder {
    places: FxHashMap<usize, usize>,
    neighbors: Vec<Vec<usize>>,
}

impl Builder {
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.place(a), self.place(b));
        self.neighbors[a].push(b);
        self.neighbors[b].push(a);
    }

    fn place(&mut self, station: usize) -> usize {
        let next = self.neighbors.len();
        let place = *self.places.entry(station).or_insert(next);
        if place == next {
            self.neighbors.push(Vec::new());
        }
        place
    }
}

/// Shortest paths from one source.
struct Search {
    distance: Vec<u32>,
    paths: Vec<f64>,
    dependency: Vec<f64>,
    order: Vec<usize>,
}

impl Search {
    fn new(len: usize) -> Self {
        Self {
            distance: vec![u32::MAX; len],
            paths: vec![0.0; len],
            dependency: vec![0.0; len],
            order: Vec::with_capacity(len),
        }
    }

    fn run(&mut self, neighbors: &[Vec<usize>], source: usize) {
        self.distance.fill(u32::MAX);
        self.paths.fill(0.0);
        self.dependency.fill(0.0);
        self.order.clear();
        self.distance[source] = 0;
        self.paths[source] = 1.0;
        self.order.push(source);
        let mut next = 0;
        while let Some(&node) = self.order.get(next) {
            next += 1;
            for &other in &neighbors[node] {
                if self.distance[other] == u32::MAX {
                    self.distance[other] = self.distance[node] + 1;
                    self.order.push(other);
                }
                if self.distance[other] == self.distance[node] + 1 {
                    self.paths[other] += self.paths[node];
                }
            }
        }
    }

    fn add_to(&mut self, neighbors: &[Vec<usize>], source: usize, between: &mut [f64]) {
        for &node in self.order.iter().rev() {
            let share = (1.0 + self.dependency[node]) / self.paths[node];
            for &other in &neighbors[node] {
                if self.distance[other] + 1 == self.distance[node] {
                    self.dependency[other] += self.paths[other] * share;
                }
            }
            if node != source {
                between[node] += self.dependency[node];
            }
        }
    }
}

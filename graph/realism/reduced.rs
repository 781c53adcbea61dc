//! The reduced graph: an edge for each branch.

use rustc_hash::FxHashMap;
use serde::Serialize;

use crate::branches::Branches;
use crate::rng::Rng;
use crate::seed;
use crate::{Node, Rows, StationId};

/// Minimum number of sampled sources.
const FEWEST_SOURCES: usize = 64;

/// A simple graph of branch ends. Rings keep two and parallel branches one of their inner stations, so that they do not
/// collapse.
pub(super) struct Reduced {
    neighbors: Rows<usize>,
}

impl Reduced {
    pub(super) fn of(branches: &Branches<Node>) -> Self {
        let mut parallel: FxHashMap<[StationId; 2], u32> = FxHashMap::default();
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
        Self { neighbors: builder.into_neighbors() }
    }

    pub(super) fn degree(&self, node: usize) -> usize {
        self.neighbors[node].len()
    }

    pub(super) fn degrees(&self) -> impl Iterator<Item = usize> {
        self.neighbors.iter().map(<[usize]>::len)
    }

    pub(super) fn directed_edges(&self) -> impl Iterator<Item = (usize, usize)> {
        self.neighbors.iter().enumerate().flat_map(|(a, others)| others.iter().map(move |&b| (a, b)))
    }

    /// Statistics of shortest paths: from all nodes if there are at most `exact_to`, otherwise from enough for about this
    /// number of visits.
    pub(super) fn paths(&self, exact_to: usize, visits: usize) -> Paths {
        let len = self.neighbors.len();
        if len <= exact_to {
            return self.paths_from(&(0..len).collect::<Vec<_>>());
        }
        let count = (visits / len).clamp(FEWEST_SOURCES, len);
        // Stratified: one source from each of `count` sections of the list; deterministic.
        let mut rng = Rng::new(seed::stream(0, "path-sources", len as u64));
        let starts: Vec<usize> = (0..=count).map(|i| i * len / count).collect();
        let sources: Vec<usize> = starts.windows(2).map(|pair| pair[0] + rng.index(pair[1] - pair[0])).collect();
        self.paths_from(&sources)
    }

    fn paths_from(&self, sources: &[usize]) -> Paths {
        let len = self.neighbors.len();
        let mut sums = BetweennessSums { between: vec![0.0; len], squares: vec![0.0; len] };
        let mut search = Search::new(len);
        let mut means = Vec::with_capacity(sources.len());
        for &source in sources {
            search.run(&self.neighbors, source);
            means.push(search.mean_distance());
            search.add_to(&self.neighbors, source, &mut sums);
        }
        let count = sources.len() as f64;
        // Each source represents its share of all nodes.
        let pairs = count / len as f64 * (len.max(3) - 1) as f64 * (len.max(3) - 2) as f64;
        let central = sums.most_central();
        let sampling = (sources.len() < len).then(|| Sampling {
            sources: sources.len(),
            average_path_error: standard_error(count, means.iter().sum(), means.iter().map(|m| m * m).sum()),
            dominance_error: standard_error(count, sums.between[central], sums.squares[central]) * count / pairs,
        });
        Paths {
            average: means.iter().sum::<f64>() / count,
            dominance: dominance(&sums.between, sums.between[central]) / pairs,
            sampling,
        }
    }
}

/// Statistics of the shortest paths of a reduced graph.
pub(super) struct Paths {
    /// Mean over the nodes of the mean distance to the others in their part, in branches.
    pub(super) average: f64,
    /// Freeman's centralization of betweenness.
    pub(super) dominance: f64,
    pub(super) sampling: Option<Sampling>,
}

/// Standard errors of sampled shortest paths, estimated from the variation between sources. The dominance also has an
/// upward bias of at most the same size, being the maximum of many sampled numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sampling {
    /// Number of nodes from which paths were counted.
    pub sources: usize,
    /// Standard error of the average path.
    pub average_path_error: f64,
    /// Standard error of the central point dominance.
    pub dominance_error: f64,
}

/// Shortest paths through each node, summed over sources (Brandes 2001), and the sum of squares of the contributions.
struct BetweennessSums {
    between: Vec<f64>,
    squares: Vec<f64>,
}

impl BetweennessSums {
    fn most_central(&self) -> usize {
        let by = |a: &usize, b: &usize| self.between[*a].total_cmp(&self.between[*b]);
        (0..self.between.len()).max_by(by).unwrap_or_default()
    }
}

/// Mean difference to the most central node.
fn dominance(between: &[f64], most: f64) -> f64 {
    let others = between.len().max(2) - 1;
    between.iter().map(|b| most - b).sum::<f64>() / others as f64
}

/// Standard error of the mean of `count` numbers with this sum and sum of squares.
fn standard_error(count: f64, sum: f64, squares: f64) -> f64 {
    let mean = sum / count;
    ((squares / count - mean * mean).max(0.0) / count).sqrt()
}

fn ends(branch: &[StationId]) -> [StationId; 2] {
    let (first, last) = (branch[0], branch[branch.len() - 1]);
    [first.min(last), first.max(last)]
}

/// Assigns indices in the reduced graph to stations on first use.
#[derive(Default)]
struct Builder {
    places: FxHashMap<StationId, usize>,
    edges: Vec<[usize; 2]>,
}

impl Builder {
    fn join(&mut self, a: StationId, b: StationId) {
        let edge = [a, b].map(|station| self.place(station));
        self.edges.push(edge);
    }

    fn place(&mut self, station: StationId) -> usize {
        let next = self.places.len();
        *self.places.entry(station).or_insert(next)
    }

    /// The neighbours of each place, in the order in which they were joined.
    fn into_neighbors(self) -> Rows<usize> {
        Rows::from_pairs(self.places.len(), self.edges.iter().flat_map(|&[a, b]| [(a, b), (b, a)]))
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

    fn run(&mut self, neighbors: &Rows<usize>, source: usize) {
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

    /// Mean distance to the other reachable nodes.
    fn mean_distance(&self) -> f64 {
        let sum: f64 = self.order.iter().map(|&node| f64::from(self.distance[node])).sum();
        sum / (self.order.len().max(2) - 1) as f64
    }

    fn add_to(&mut self, neighbors: &Rows<usize>, source: usize, sums: &mut BetweennessSums) {
        for &node in self.order.iter().rev() {
            let share = (1.0 + self.dependency[node]) / self.paths[node];
            for &other in &neighbors[node] {
                if self.distance[other] + 1 == self.distance[node] {
                    self.dependency[other] += self.paths[other] * share;
                }
            }
            if node != source {
                sums.between[node] += self.dependency[node];
                sums.squares[node] += self.dependency[node] * self.dependency[node];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Graph;
    use crate::centreline::CentrelineBuilder;

    /// A street grid, a fifth of it blocked.
    fn maze(side: usize) -> Graph {
        let mut rng = Rng::new(crate::seed::stream(1, "maze", 0));
        let places: Vec<[f64; 2]> =
            (0..side * side).map(|at| [10.0 * (at / side) as f64, 10.0 * (at % side) as f64]).collect();
        let along = (0..side * side).filter(|at| at % side + 1 < side).map(|at| [at, at + 1]);
        let across = (0..side * (side - 1)).map(|at| [at, at + side]);
        let lines: Vec<[usize; 2]> = along.chain(across).filter(|_| rng.chance(0.8)).collect();
        CentrelineBuilder::flat(&places, &lines).into_graph()
    }

    #[test]
    fn a_sample_is_near_the_whole() {
        let graph = maze(78);
        let reduced = Reduced::of(&Branches::of(&graph.neighbors()));
        let len = reduced.neighbors.len();
        let (whole, sample) = (reduced.paths(len, 0), reduced.paths(0, 200 * len));
        assert_eq!(whole.sampling, None);
        let said = sample.sampling.expect("it was sampled");
        assert_eq!(said.sources, 200);
        let off = (sample.average - whole.average).abs();
        assert!(off <= 3.0 * said.average_path_error && said.average_path_error < 0.05 * whole.average, "{off}");
        let off = (sample.dominance - whole.dominance).abs();
        assert!(off <= 4.0 * said.dominance_error && said.dominance_error < 0.05, "{off}");
    }
}

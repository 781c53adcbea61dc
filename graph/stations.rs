//! Distributes a given number of stations along the centrelines.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::centreline::{Branch, CentrelineBuilder, Vertex, VertexId};

impl CentrelineBuilder {
    /// The same centrelines with exactly `count` vertices, spread as evenly as junctions allow. If there are more junctions
    /// than that, the shortest dead ends are removed first. `None` if there would be fewer than `count`, or dead ends do not
    /// suffice.
    pub fn with_stations(self, count: usize) -> Option<Self> {
        let mut centreline = self.welded();
        loop {
            let neighbors = centreline.neighbors();
            let branches = centreline.branches_among(&neighbors);
            let fixed = ends(&branches);
            let shares = least_inside(&branches);
            let least: usize = shares.iter().sum();
            if fixed + least <= count {
                let shares = with_more(shares, &branches, count - fixed - least);
                return Some(centreline.spread(&branches, &shares));
            }
            centreline = centreline.pruned(&branches, &neighbors, fixed + least - count)?;
        }
    }

    /// The branches with their numbers of inner stations.
    fn spread(&self, branches: &[Branch], shares: &[usize]) -> Self {
        let mut centreline = Self::default();
        let mut ends: FxHashMap<VertexId, VertexId> = FxHashMap::default();
        for (branch, &share) in branches.iter().zip(shares) {
            let mut end = |vertex: VertexId| *ends.entry(vertex).or_insert_with(|| centreline.add(self[vertex]));
            let (first, last) = (end(branch.first()), end(branch.last()));
            let mut before = first;
            for station in self.along(branch, share) {
                let next = centreline.add(station);
                centreline.join(before, next);
                before = next;
            }
            centreline.join(before, last);
        }
        centreline
    }

    /// `count` vertices evenly spaced between the ends of a branch.
    fn along<'a>(&'a self, branch: &'a Branch, count: usize) -> impl Iterator<Item = Vertex> + 'a {
        let step = branch.length_m / (count + 1) as f64;
        let (mut leg, mut start) = (0, 0.0);
        (1..=count).map(move |place| {
            let at = step * place as f64;
            loop {
                let [a, b] = [branch.vertices[leg], branch.vertices[leg + 1]];
                let length = self.distance_m(a, b);
                if at <= start + length || leg + 2 == branch.vertices.len() {
                    let share = if length > 0.0 { ((at - start) / length).min(1.0) } else { 0.0 };
                    return between(&self[a], &self[b], share);
                }
                start += length;
                leg += 1;
            }
        })
    }
}

/// Vertices at the ends of branches.
fn ends(branches: &[Branch]) -> usize {
    let mut ends: Vec<VertexId> = branches.iter().flat_map(|branch| [branch.first(), branch.last()]).collect();
    ends.sort_unstable();
    ends.dedup();
    ends.len()
}

/// Minimum number of inner vertices of each branch: two for a ring, one if another branch has the same ends, so that
/// branches do not coincide.
fn least_inside(branches: &[Branch]) -> Vec<usize> {
    let mut alike: FxHashMap<[VertexId; 2], usize> = FxHashMap::default();
    branches.iter().for_each(|branch| *alike.entry(branch.ends()).or_default() += 1);
    let least = |branch: &Branch| match branch.ends() {
        [a, b] if a == b => 2,
        both => usize::from(alike[&both] > 1 && branch.vertices.len() > 2),
    };
    branches.iter().map(least).collect()
}

/// Distributes this many additional stations, each where the gaps are longest at that point.
fn with_more(mut shares: Vec<usize>, branches: &[Branch], more: usize) -> Vec<usize> {
    let lack = |branch: usize, share: usize| Lack {
        gap_um: (branches[branch].length_m * 1e6 / (share + 1) as f64) as u64,
        branch: Reverse(branch),
    };
    let mut lacks: BinaryHeap<Lack> = shares.iter().enumerate().map(|(branch, &share)| lack(branch, share)).collect();
    for _ in 0..more {
        let Some(Lack { branch: Reverse(branch), .. }) = lacks.pop() else { break };
        shares[branch] += 1;
        lacks.push(lack(branch, shares[branch]));
    }
    shares
}

/// A branch in the queue, the one with the longest gaps first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Lack {
    /// Length per gap, in micrometres.
    gap_um: u64,
    branch: Reverse<usize>,
}

/// The vertex interpolated between two by this fraction.
fn between(a: &Vertex, b: &Vertex, share: f64) -> Vertex {
    let section = match (a.section, b.section) {
        (Some(a), Some(b)) => Some(a.towards(b, share)),
        (one, other) => one.or(other),
    };
    let position = a.position + (b.position - a.position) * share;
    Vertex { position, section, level: if share < 0.5 { a.level } else { b.level } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_are_spread_evenly_and_exactly() {
        let line = CentrelineBuilder::flat(&[[0.0, 0.0], [1.0, 0.0], [10.0, 0.0]], &[[0, 1], [1, 2]]);
        let graph = line.with_stations(5).expect("it is long enough").into_graph();
        let x: Vec<f64> = graph.nodes.iter().map(|node| node.position.x).collect();
        assert_eq!(x, [0.0, 2.5, 5.0, 7.5, 10.0]);
        assert_eq!(graph.nodes[4].parent, Some(crate::StationId::new(3)));
        assert!(graph.nodes.iter().all(|node| node.radius == 2.5));
    }

    #[test]
    fn rings_and_parallel_passages_stay_apart() {
        let ring = CentrelineBuilder::flat(
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]],
            &[[0, 1], [1, 2], [2, 3], [3, 0]],
        );
        let graph = ring.with_stations(3).expect("a triangle").into_graph();
        assert_eq!((graph.nodes.len(), graph.loops()), (3, 1));
        let eight = [[0.0, 0.0], [8.0, 0.0], [4.0, 3.0], [4.0, -3.0], [-5.0, 0.0], [13.0, 0.0]];
        let eight = CentrelineBuilder::flat(&eight, &[[0, 2], [2, 1], [0, 3], [3, 1], [4, 0], [5, 1]]);
        let graph = eight.with_stations(20).expect("long enough").into_graph();
        assert_eq!((graph.nodes.len(), graph.loops()), (20, 1));
    }

    #[test]
    fn the_shortest_dead_ends_are_removed_first() {
        let star = [[0.0, 0.0], [9.0, 0.0], [0.0, 8.0], [-7.0, 0.0], [0.0, -1.0]];
        let star = CentrelineBuilder::flat(&star, &[[0, 1], [0, 2], [0, 3], [0, 4]]);
        let graph = star.clone().with_stations(4).expect("one may go").into_graph();
        assert_eq!(graph.nodes.len(), 4);
        assert!(graph.nodes.iter().all(|node| node.position.y >= 0.0));
        assert_eq!(star.with_stations(2).expect("two go").into_graph().nodes.len(), 2);
    }
}

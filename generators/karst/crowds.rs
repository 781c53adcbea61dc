//! Drops passages without enough room, if they are dispensable.

use rustc_hash::{FxHashMap, FxHashSet};

use plume_graph::centreline::{Branch, CentrelineBuilder, VertexId};
use plume_graph::sets::Sets;

/// Drops passages with a vertex in one of these pairs of vertices that are too close. They are tried again after all
/// others, longest first: dead ends are kept if they are clear of what is there by then, others also if nothing else
/// connects their ends. Passages through the vertices of `kept` stay.
pub(super) fn drop_crowds(centreline: &mut CentrelineBuilder, crowds: &[[VertexId; 2]], kept: &FxHashSet<VertexId>) {
    let degrees: Vec<usize> = centreline.neighbors().degrees().collect();
    let mut cave = Cave::empty(centreline.vertices.len(), crowds);
    let (mut crowded, clear): (Vec<Branch>, Vec<Branch>) = centreline
        .branches()
        .into_iter()
        .partition(|branch| cave.is_crowded(branch) && !branch.vertices.iter().any(|vertex| kept.contains(vertex)));
    crowded.sort_by(|a, b| b.length_m.total_cmp(&a.length_m).then(a.vertices.cmp(&b.vertices)));
    let is_dead_end = |branch: &Branch| [branch.first(), branch.last()].iter().any(|&end| degrees[end.index()] == 1);
    let (dead_ends, inner): (Vec<Branch>, Vec<Branch>) = crowded.into_iter().partition(is_dead_end);
    clear.iter().for_each(|branch| cave.lay(branch));
    for branch in &inner {
        if cave.has_room(branch) || !cave.joins_ends(branch) {
            cave.lay(branch);
        }
    }
    for branch in &dead_ends {
        if cave.has_room(branch) {
            cave.lay(branch);
        }
    }
    centreline.lines = cave.lines;
}

/// The passages kept so far.
struct Cave {
    lines: Vec<[VertexId; 2]>,
    is_laid: Vec<bool>,
    /// Union-find of vertices connected so far.
    parts: Sets,
    /// For each vertex, those that are too close to it.
    against: FxHashMap<VertexId, Vec<VertexId>>,
}

impl Cave {
    fn empty(vertices: usize, crowds: &[[VertexId; 2]]) -> Self {
        let mut against: FxHashMap<VertexId, Vec<VertexId>> = FxHashMap::default();
        for &[a, b] in crowds {
            against.entry(a).or_default().push(b);
            against.entry(b).or_default().push(a);
        }
        Self { lines: Vec::new(), is_laid: vec![false; vertices], parts: Sets::new(vertices), against }
    }

    fn is_crowded(&self, branch: &Branch) -> bool {
        branch.vertices.iter().any(|vertex| self.against.contains_key(vertex))
    }

    /// Whether nothing kept so far is too close.
    fn has_room(&self, branch: &Branch) -> bool {
        let others = branch.vertices.iter().filter_map(|vertex| self.against.get(vertex)).flatten();
        others.filter(|other| !branch.vertices.contains(other)).all(|&other| !self.is_laid[other.index()])
    }

    /// Whether its two ends are connected already.
    fn joins_ends(&mut self, branch: &Branch) -> bool {
        self.parts.find(branch.first().index()) == self.parts.find(branch.last().index())
    }

    fn lay(&mut self, branch: &Branch) {
        self.lines.extend(branch.vertices.windows(2).map(|line| [line[0], line[1]]));
        branch.vertices.iter().for_each(|&vertex| self.is_laid[vertex.index()] = true);
        self.parts.unite(branch.first().index(), branch.last().index());
    }
}

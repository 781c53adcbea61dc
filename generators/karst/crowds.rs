//! Passages that have no room, dropped where the cave does without them.

use rustc_hash::{FxHashMap, FxHashSet};

use plume_graph::centreline::{Branch, CentrelineBuilder, VertexId};
use plume_graph::sets::Sets;

/// Drops passages of which a vertex is too near to another one, as these pairs say. They are laid anew after all others, the
/// longest first: dead ends where they are clear of what is there by then, the others also where nothing else joins their
/// ends. Passages through the vertices of `kept` stay.
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

/// Passages while they are laid.
struct Cave {
    lines: Vec<[VertexId; 2]>,
    is_laid: Vec<bool>,
    /// Vertices that are joined by what is laid.
    parts: Sets,
    /// Which vertices are too near to each one that has any.
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

    /// Whether nothing that is laid is too near.
    fn has_room(&self, branch: &Branch) -> bool {
        let others = branch.vertices.iter().filter_map(|vertex| self.against.get(vertex)).flatten();
        others.filter(|other| !branch.vertices.contains(other)).all(|&other| !self.is_laid[other.index()])
    }

    /// Whether one comes from one end to the other already.
    fn joins_ends(&mut self, branch: &Branch) -> bool {
        self.parts.find(branch.first().index()) == self.parts.find(branch.last().index())
    }

    fn lay(&mut self, branch: &Branch) {
        self.lines.extend(branch.vertices.windows(2).map(|line| [line[0], line[1]]));
        branch.vertices.iter().for_each(|&vertex| self.is_laid[vertex.index()] = true);
        self.parts.unite(branch.first().index(), branch.last().index());
    }
}

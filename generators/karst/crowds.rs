//! Passages that have no room, dropped where the cave does without them.

use rustc_hash::{FxHashMap, FxHashSet};

use plume_graph::sets::Sets;
use plume_graph::sketch::{Branch, Sketch};

/// Drops passages of which a knot is too near to another one, as these pairs say. They are laid anew after all others, the
/// longest first: dead ends where they are clear of what is there by then, the others also where nothing else joins their
/// ends. Passages through the knots of `kept` stay.
pub(super) fn drop_crowds(sketch: &mut Sketch, crowds: &[[u32; 2]], kept: &FxHashSet<usize>) {
    let degrees: Vec<usize> = sketch.neighbors().degrees().collect();
    let mut cave = Cave::empty(sketch.knots.len(), crowds);
    let (mut crowded, clear): (Vec<Branch>, Vec<Branch>) = sketch
        .branches()
        .into_iter()
        .partition(|branch| cave.is_crowded(branch) && !branch.knots.iter().any(|knot| kept.contains(knot)));
    crowded.sort_by(|a, b| b.length_m.total_cmp(&a.length_m).then(a.knots.cmp(&b.knots)));
    let is_dead_end = |branch: &Branch| [branch.first(), branch.last()].iter().any(|&end| degrees[end] == 1);
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
    sketch.lines = cave.lines;
}

/// Passages while they are laid.
struct Cave {
    lines: Vec<[usize; 2]>,
    is_laid: Vec<bool>,
    /// Knots that are joined by what is laid.
    parts: Sets,
    /// Which knots are too near to each one that has any.
    against: FxHashMap<usize, Vec<usize>>,
}

impl Cave {
    fn empty(knots: usize, crowds: &[[u32; 2]]) -> Self {
        let mut against: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
        for [a, b] in crowds.iter().map(|pair| pair.map(|knot| knot as usize)) {
            against.entry(a).or_default().push(b);
            against.entry(b).or_default().push(a);
        }
        Self { lines: Vec::new(), is_laid: vec![false; knots], parts: Sets::new(knots), against }
    }

    fn is_crowded(&self, branch: &Branch) -> bool {
        branch.knots.iter().any(|knot| self.against.contains_key(knot))
    }

    /// Whether nothing that is laid is too near.
    fn has_room(&self, branch: &Branch) -> bool {
        let others = branch.knots.iter().filter_map(|knot| self.against.get(knot)).flatten();
        others.filter(|other| !branch.knots.contains(other)).all(|&other| !self.is_laid[other])
    }

    /// Whether one comes from one end to the other already.
    fn joins_ends(&mut self, branch: &Branch) -> bool {
        self.parts.find(branch.first()) == self.parts.find(branch.last())
    }

    fn lay(&mut self, branch: &Branch) {
        self.lines.extend(branch.knots.windows(2).map(|line| [line[0], line[1]]));
        branch.knots.iter().for_each(|&knot| self.is_laid[knot] = true);
        self.parts.unite(branch.first(), branch.last());
    }
}

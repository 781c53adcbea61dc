//! Passages that have no room, dropped where the cave does without them.

use rustc_hash::FxHashMap;

use crate::graph::sketch::{Branch, Sketch};

/// Drops passages of which a knot is too near to another one, as these pairs say. They are laid anew after all others, the
/// longest first: dead ends where they are clear of what is there by then, the others also where nothing else joins their
/// ends. Passages through the knots of `kept` stay.
pub(super) fn drop_crowds(sketch: &mut Sketch, crowds: &[[u32; 2]], kept: &[usize]) {
    let mut against: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    for [a, b] in crowds.iter().map(|pair| pair.map(|knot| knot as usize)) {
        against.entry(a).or_default().push(b);
        against.entry(b).or_default().push(a);
    }
    let degrees: Vec<usize> = sketch.neighbors().degrees().collect();
    let mut is_kept = vec![false; sketch.knots.len()];
    kept.iter().for_each(|&knot| is_kept[knot] = true);
    let is_tip = |knot: usize| degrees[knot] == 1;
    let is_crowded = |branch: &Branch| {
        branch.knots.iter().any(|knot| against.contains_key(knot)) && !branch.knots.iter().any(|&knot| is_kept[knot])
    };
    let (mut crowded, clear): (Vec<Branch>, Vec<Branch>) = sketch.branches().into_iter().partition(is_crowded);
    crowded.sort_by(|a, b| b.length_m.total_cmp(&a.length_m).then(a.knots.cmp(&b.knots)));
    let (ends, inner): (Vec<Branch>, Vec<Branch>) =
        crowded.into_iter().partition(|branch| is_tip(branch.first()) || is_tip(branch.last()));
    let mut laid = Laid { is_laid: vec![false; sketch.knots.len()], parts: (0..sketch.knots.len()).collect() };
    let mut lines = Vec::new();
    clear.iter().for_each(|branch| laid.lay(branch, &mut lines));
    let clears = |branch: &Branch, laid: &Laid| {
        let others = branch.knots.iter().filter_map(|knot| against.get(knot)).flatten();
        others.filter(|other| !branch.knots.contains(other)).all(|&other| !laid.is_laid[other])
    };
    for branch in &inner {
        if clears(branch, &laid) || laid.part(branch.first()) != laid.part(branch.last()) {
            laid.lay(branch, &mut lines);
        }
    }
    for branch in &ends {
        if clears(branch, &laid) {
            laid.lay(branch, &mut lines);
        }
    }
    sketch.lines = lines;
}

/// What has been laid.
struct Laid {
    is_laid: Vec<bool>,
    /// A knot of the same part of the cave, for each knot; itself where it stands for its part.
    parts: Vec<usize>,
}

impl Laid {
    fn lay(&mut self, branch: &Branch, lines: &mut Vec<[usize; 2]>) {
        lines.extend(branch.knots.windows(2).map(|line| [line[0], line[1]]));
        branch.knots.iter().for_each(|&knot| self.is_laid[knot] = true);
        let [first, last] = [branch.first(), branch.last()].map(|end| self.part(end));
        self.parts[first] = last;
    }

    /// The knot that stands for the part of the cave in which this one is.
    fn part(&mut self, mut knot: usize) -> usize {
        while self.parts[knot] != knot {
            self.parts[knot] = self.parts[self.parts[knot]];
            knot = self.parts[knot];
        }
        knot
    }
}

//! Passages that have no room, dropped where the cave does without them.

use rustc_hash::FxHashMap;

use crate::graph::sketch::{Sketch, Strand};

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
    let is_crowded = |strand: &Strand| {
        strand.knots.iter().any(|knot| against.contains_key(knot)) && !strand.knots.iter().any(|&knot| is_kept[knot])
    };
    let (mut crowded, clear): (Vec<Strand>, Vec<Strand>) = sketch.strands().into_iter().partition(is_crowded);
    crowded.sort_by(|a, b| b.length.total_cmp(&a.length).then(a.knots.cmp(&b.knots)));
    let (ends, inner): (Vec<Strand>, Vec<Strand>) =
        crowded.into_iter().partition(|strand| is_tip(strand.first()) || is_tip(strand.last()));
    let mut laid = Laid { is_laid: vec![false; sketch.knots.len()], parts: (0..sketch.knots.len()).collect() };
    let mut lines = Vec::new();
    clear.iter().for_each(|strand| laid.lay(strand, &mut lines));
    let clears = |strand: &Strand, laid: &Laid| {
        let others = strand.knots.iter().filter_map(|knot| against.get(knot)).flatten();
        others.filter(|other| !strand.knots.contains(other)).all(|&other| !laid.is_laid[other])
    };
    for strand in &inner {
        if clears(strand, &laid) || laid.part(strand.first()) != laid.part(strand.last()) {
            laid.lay(strand, &mut lines);
        }
    }
    for strand in &ends {
        if clears(strand, &laid) {
            laid.lay(strand, &mut lines);
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
    fn lay(&mut self, strand: &Strand, lines: &mut Vec<[usize; 2]>) {
        lines.extend(strand.knots.windows(2).map(|line| [line[0], line[1]]));
        strand.knots.iter().for_each(|&knot| self.is_laid[knot] = true);
        let [first, last] = [strand.first(), strand.last()].map(|end| self.part(end));
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

//! Passages that cross meet.

use nalgebra::{Point3, center};
use rustc_hash::FxHashSet;

use super::room::least_m;
use plume_graph::sketch::{Knot, Sketch};

/// Lines are looked for in cells of this size, in metres; lines are hardly longer.
const CELL_M: f64 = 4.0;
/// Shorter passages beside each other are one, in metres.
const BRAID_M: f64 = 10.0;

/// A point of a line that becomes a knot.
struct Split {
    line: usize,
    share: f64,
    knot: usize,
}

/// Joins lines that cross in the plan with too little rock between the upper and the lower one, half way between them.
/// Passages through the knots of `kept` stay.
pub(super) fn join_crossings(sketch: &mut Sketch, kept: &FxHashSet<usize>) {
    let mut splits = Vec::new();
    for pair in pairs_of_cells(sketch) {
        let [first, second] = pair.map(|line| sketch.lines[line].map(|knot| sketch.knots[knot]));
        let Some(shares) = crossing(first.map(|end| end.position), second.map(|end| end.position)) else { continue };
        let [upper, lower] = [(first, shares[0]), (second, shares[1])]
            .map(|([start, end], share)| start.position + (end.position - start.position) * share);
        if (upper.z - lower.z).abs() < least_m(&first[0], &second[0]) {
            let knot = sketch.add(Knot { position: center(&upper, &lower), ..first[0] });
            splits.extend([0, 1].map(|which| Split { line: pair[which], share: shares[which], knot }));
        }
    }
    split(sketch, splits);
    drop_braids(sketch, kept);
}

/// Of short passages between the same two junctions only the shortest stays, and none that leads back to where it begins;
/// those through the knots of `kept` stay anyway.
fn drop_braids(sketch: &mut Sketch, kept: &FxHashSet<usize>) {
    let mut branches = sketch.branches();
    branches.retain(|branch| branch.length_m < BRAID_M && !branch.knots.iter().any(|knot| kept.contains(knot)));
    branches.sort_by(|a, b| a.ends().cmp(&b.ends()).then(a.length_m.total_cmp(&b.length_m)));
    let mut gone = FxHashSet::default();
    for alike in branches.chunk_by(|a, b| a.ends() == b.ends()) {
        let shortest = usize::from(alike[0].first() != alike[0].last());
        for branch in &alike[shortest..] {
            gone.extend(branch.knots.windows(2).map(|line| [line[0].min(line[1]), line[0].max(line[1])]));
        }
    }
    sketch.lines.retain(|&[a, b]| !gone.contains(&[a.min(b), a.max(b)]));
}

/// How far along each of two lines, from 0 to 1, they cross in the plan.
fn crossing(first: [Point3<f64>; 2], second: [Point3<f64>; 2]) -> Option<[f64; 2]> {
    let [along, other, between] =
        [first[1] - first[0], second[1] - second[0], second[0] - first[0]].map(|way| way.xy());
    let slant = along.perp(&other);
    let shares = [between.perp(&other) / slant, between.perp(&along) / slant];
    shares.iter().all(|share| (0.0..=1.0).contains(share)).then_some(shares)
}

fn split(sketch: &mut Sketch, mut splits: Vec<Split>) {
    splits.sort_by(|a, b| a.line.cmp(&b.line).then(a.share.total_cmp(&b.share)));
    for along in splits.chunk_by(|a, b| a.line == b.line) {
        let [mut start, end] = sketch.lines[along[0].line];
        for split in along {
            sketch.join(start, split.knot);
            start = split.knot;
        }
        sketch.lines[along[0].line] = [start, end];
    }
}

/// Pairs of lines in the same cells of the plan that share no end, in order.
fn pairs_of_cells(sketch: &Sketch) -> Vec<[usize; 2]> {
    let mut in_cells: Vec<([i32; 2], u32)> = Vec::with_capacity(2 * sketch.lines.len());
    for (line, ends) in sketch.lines.iter().enumerate() {
        let [a, b] = ends.map(|knot| sketch.knots[knot].position.xy().map(|at| (at / CELL_M).floor() as i32));
        for x in a.x.min(b.x)..=a.x.max(b.x) {
            in_cells.extend((a.y.min(b.y)..=a.y.max(b.y)).map(|y| ([x, y], line as u32)));
        }
    }
    in_cells.sort_unstable();
    let mut pairs = Vec::new();
    for cell in in_cells.chunk_by(|a, b| a.0 == b.0) {
        for (place, &(_, first)) in cell.iter().enumerate() {
            let ends = sketch.lines[first as usize];
            let others = cell[place + 1..].iter().map(|&(_, second)| second as usize);
            let apart = others.filter(|&second| !sketch.lines[second].iter().any(|end| ends.contains(end)));
            pairs.extend(apart.map(|second| [first as usize, second]));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

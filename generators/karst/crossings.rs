//! Joins passages that cross.

use nalgebra::{Point3, center};
use rustc_hash::FxHashSet;

use super::room::least_m;
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};

/// Cell size for finding lines, in metres; lines are hardly longer.
const CELL_M: f64 = 4.0;
/// Shorter parallel passages are merged, in metres.
const BRAID_M: f64 = 10.0;

/// A point of a line that becomes a vertex.
struct Split {
    line: usize,
    share: f64,
    vertex: VertexId,
}

/// Joins lines that cross in the plan with too little rock between the upper and the lower one, at mid-height. Passages
/// through the vertices of `kept` stay.
pub(super) fn join_crossings(centreline: &mut CentrelineBuilder, kept: &FxHashSet<VertexId>) {
    let mut splits = Vec::new();
    for pair in pairs_of_cells(centreline) {
        let [first, second] = pair.map(|line| centreline.lines[line].map(|vertex| centreline[vertex]));
        let Some(shares) = crossing(first.map(|end| end.position), second.map(|end| end.position)) else { continue };
        let [upper, lower] = [(first, shares[0]), (second, shares[1])]
            .map(|([start, end], share)| start.position + (end.position - start.position) * share);
        if (upper.z - lower.z).abs() < least_m(&first[0], &second[0]) {
            let vertex = centreline.add(Vertex { position: center(&upper, &lower), ..first[0] });
            splits.extend([0, 1].map(|which| Split { line: pair[which], share: shares[which], vertex }));
        }
    }
    split(centreline, splits);
    drop_braids(centreline, kept);
}

/// Of short passages between the same two junctions only the shortest is kept, and none that returns to its start; those
/// through the vertices of `kept` stay anyway.
fn drop_braids(centreline: &mut CentrelineBuilder, kept: &FxHashSet<VertexId>) {
    let mut branches = centreline.branches();
    branches.retain(|branch| branch.length_m < BRAID_M && !branch.vertices.iter().any(|vertex| kept.contains(vertex)));
    branches.sort_by(|a, b| a.ends().cmp(&b.ends()).then(a.length_m.total_cmp(&b.length_m)));
    let mut gone = FxHashSet::default();
    for alike in branches.chunk_by(|a, b| a.ends() == b.ends()) {
        let shortest = usize::from(alike[0].first() != alike[0].last());
        for branch in &alike[shortest..] {
            gone.extend(branch.vertices.windows(2).map(|line| [line[0].min(line[1]), line[0].max(line[1])]));
        }
    }
    centreline.lines.retain(|&[a, b]| !gone.contains(&[a.min(b), a.max(b)]));
}

/// Where two lines cross in the plan, as a parameter from 0 to 1 on each.
fn crossing(first: [Point3<f64>; 2], second: [Point3<f64>; 2]) -> Option<[f64; 2]> {
    let [along, other, between] =
        [first[1] - first[0], second[1] - second[0], second[0] - first[0]].map(|way| way.xy());
    let slant = along.perp(&other);
    let shares = [between.perp(&other) / slant, between.perp(&along) / slant];
    shares.iter().all(|share| (0.0..=1.0).contains(share)).then_some(shares)
}

fn split(centreline: &mut CentrelineBuilder, mut splits: Vec<Split>) {
    splits.sort_by(|a, b| a.line.cmp(&b.line).then(a.share.total_cmp(&b.share)));
    for along in splits.chunk_by(|a, b| a.line == b.line) {
        let [mut start, end] = centreline.lines[along[0].line];
        for split in along {
            centreline.join(start, split.vertex);
            start = split.vertex;
        }
        centreline.lines[along[0].line] = [start, end];
    }
}

/// Pairs of lines in the same cells of the plan that share no end, in order.
fn pairs_of_cells(centreline: &CentrelineBuilder) -> Vec<[usize; 2]> {
    let mut in_cells: Vec<([i32; 2], u32)> = Vec::with_capacity(2 * centreline.lines.len());
    for (line, ends) in centreline.lines.iter().enumerate() {
        let [a, b] = ends.map(|vertex| centreline[vertex].position.xy().map(|at| (at / CELL_M).floor() as i32));
        for x in a.x.min(b.x)..=a.x.max(b.x) {
            in_cells.extend((a.y.min(b.y)..=a.y.max(b.y)).map(|y| ([x, y], line as u32)));
        }
    }
    in_cells.sort_unstable();
    let mut pairs = Vec::new();
    for cell in in_cells.chunk_by(|a, b| a.0 == b.0) {
        for (place, &(_, first)) in cell.iter().enumerate() {
            let ends = centreline.lines[first as usize];
            let others = cell[place + 1..].iter().map(|&(_, second)| second as usize);
            let apart = others.filter(|&second| !centreline.lines[second].iter().any(|end| ends.contains(end)));
            pairs.extend(apart.map(|second| [first as usize, second]));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

//! Passages drawn along the ways that water found: narrow forks opened later, what would run through each other joined, and
//! everything between made to wind.

use std::f64::consts::FRAC_PI_6;

use nalgebra::{Point3, Vector3};
use rustc_hash::FxHashMap;

use super::Karst;
use super::cloud::Cloud;
use super::rock::Rock;
use crate::graph::dice::Dice;
use crate::graph::sketch::{Knot, Sketch};
use crate::graph::{Section, Shape};

/// Passages fork at this angle or a wider one.
const LEAST_FORK: f64 = FRAC_PI_6;
const FORK_ROUNDS: usize = 64;
/// What opens a fork may cross something else.
const CROSSING_ROUNDS: usize = 2;
/// Most passages at a point.
const MOST_PASSAGES: usize = 5;
/// Rock between passages that do not meet, beside what winding takes, in metres.
const ROCK_M: f64 = 1.0;
/// A crossing nearer to the end of a passage than this part of it is at its end.
const AT_END: f64 = 0.25;
/// Most of the way between two points that a dead end falls short of (tuned for short branches beside long ones).
const MOST_SHORTENED: f64 = 0.7;
/// Midpoints are moved until what is left is shorter than this, in metres.
const WINDING_M: f64 = 3.0;
/// Part of what a midpoint is moved aside that it is moved up or down.
const UPS_AND_DOWNS: f64 = 0.08;

/// The passages along `lines`, that at `root` first.
pub(super) fn drawn(
    settings: &Karst,
    rock: &Rock,
    cloud: &Cloud,
    lines: &[[usize; 2]],
    root: usize,
    dice: &mut Dice,
) -> Sketch {
    let mut sketch = Sketch::default();
    let mut knots: FxHashMap<usize, usize> = FxHashMap::default();
    for point in std::iter::once(root).chain(lines.iter().flatten().copied()) {
        let position = cloud.points[point];
        knots.entry(point).or_insert_with(|| sketch.add(Knot { position, section: None, level: 0 }));
    }
    sketch.lines = lines.iter().map(|line| line.map(|point| knots[&point])).collect();
    open_all_forks(&mut sketch);
    let apart_m = settings.width_m + ROCK_M + settings.roughness * settings.sample_spacing_m;
    for _ in 0..CROSSING_ROUNDS {
        join_crossings(&mut sketch, apart_m);
        open_all_forks(&mut sketch);
    }
    shorten_tips(&mut sketch, dice);
    let mut winding = wound(settings, sketch, dice).smoothed(1);
    for knot in &mut winding.knots {
        let width_m = rock.width_m(knot.position);
        let height_m = (width_m * settings.height_ratio).max(1.0);
        knot.section = Some(Section { width_m, height_m, shape: Shape::Cave });
        knot.position = rock.in_world(knot.position);
    }
    winding
}

/// Every fork opened. What is moved gets shorter each time, so there is an end to it.
fn open_all_forks(sketch: &mut Sketch) {
    for _ in 0..FORK_ROUNDS {
        if !open_forks(sketch) {
            break;
        }
    }
}

/// Where two passages leave a knot in nearly the same direction, or too many do, the longer one leaves from the end of the
/// shorter one instead. Whether there was such a place.
fn open_forks(sketch: &mut Sketch) -> bool {
    sketch.lines.iter_mut().for_each(|line| line.sort_unstable());
    sketch.lines.sort_unstable();
    sketch.lines.dedup();
    let mut at_knot: Vec<Vec<usize>> = vec![Vec::new(); sketch.knots.len()];
    for (line, ends) in sketch.lines.iter().enumerate() {
        ends.iter().for_each(|&end| at_knot[end].push(line));
    }
    let mut touched = vec![false; sketch.lines.len()];
    for (knot, lines) in at_knot.iter().enumerate() {
        let mut left: Vec<usize> = lines.iter().copied().filter(|&line| !touched[line]).collect();
        while let Some((angle, short, long)) = narrowest(sketch, knot, &left) {
            if angle >= LEAST_FORK && left.len() <= MOST_PASSAGES {
                break;
            }
            sketch.lines[long] = [other_end(sketch, short, knot), other_end(sketch, long, knot)];
            touched[long] = true;
            touched[short] = true;
            left.retain(|&line| line != long);
        }
    }
    touched.contains(&true)
}

/// The two of these lines with the least angle between them, the shorter one first.
fn narrowest(sketch: &Sketch, knot: usize, lines: &[usize]) -> Option<(f64, usize, usize)> {
    let way = |line: usize| sketch.knots[other_end(sketch, line, knot)].position - sketch.knots[knot].position;
    let mut least: Option<(f64, usize, usize)> = None;
    for (place, &a) in lines.iter().enumerate() {
        for &b in &lines[place + 1..] {
            let (first, second) = (way(a), way(b));
            let cosine = first.dot(&second) / (first.norm() * second.norm());
            let angle = libm::acos(cosine.clamp(-1.0, 1.0));
            if least.is_none_or(|(other, ..)| angle < other) {
                let [short, long] = if second.norm_squared() < first.norm_squared() { [b, a] } else { [a, b] };
                least = Some((angle, short, long));
            }
        }
    }
    least
}

fn other_end(sketch: &Sketch, line: usize, knot: usize) -> usize {
    let [a, b] = sketch.lines[line];
    if a == knot { b } else { a }
}

/// Lets dead ends end anywhere between the two points they lie between; the root stays.
fn shorten_tips(sketch: &mut Sketch, dice: &mut Dice) {
    let neighbors = sketch.neighbors();
    for tip in 1..sketch.knots.len() {
        if let &[before] = &neighbors[tip] {
            let to = sketch.knots[before].position;
            let way = to - sketch.knots[tip].position;
            sketch.knots[tip].position += way * dice.between(0.0, MOST_SHORTENED);
        }
    }
}

/// A point of a line that becomes a knot.
struct Split {
    line: usize,
    share: f64,
    knot: usize,
}

/// Joins lines that pass nearer to each other than `apart_m` without meeting, where they are nearest.
fn join_crossings(sketch: &mut Sketch, apart_m: f64) {
    let mut splits = Vec::new();
    for pair in near_pairs(sketch, apart_m) {
        let [first, second] = pair.map(|line| sketch.lines[line].map(|knot| sketch.knots[knot].position));
        let (shares, gap) = nearest_shares(first, second);
        let ends = [0, 1].map(|which| end_at(sketch.lines[pair[which]], shares[which]));
        // Points are apart already: where both are at an end, winding alone brings them no nearer.
        if gap >= apart_m || ends.iter().all(Option::is_some) {
            continue;
        }
        let crossing = first[0] + (first[1] - first[0]) * shares[0];
        let knot = ends[0].or(ends[1]);
        let knot = knot.unwrap_or_else(|| sketch.add(Knot { position: crossing, section: None, level: 0 }));
        for which in [0, 1].into_iter().filter(|&which| ends[which].is_none()) {
            splits.push(Split { line: pair[which], share: shares[which], knot });
        }
    }
    split(sketch, splits);
}

/// The end of a line that lies at this part of it.
fn end_at([start, end]: [usize; 2], share: f64) -> Option<usize> {
    if share < AT_END {
        return Some(start);
    }
    (share > 1.0 - AT_END).then_some(end)
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
    sketch.lines.retain(|[a, b]| a != b);
}

/// Pairs of lines in the same cells of the plan that share no end.
fn near_pairs(sketch: &Sketch, apart_m: f64) -> Vec<[usize; 2]> {
    let cell_m = 4.0 * apart_m;
    let mut cells: FxHashMap<[i64; 2], Vec<usize>> = FxHashMap::default();
    let mut pairs = Vec::new();
    for (line, ends) in sketch.lines.iter().enumerate() {
        let [a, b] = ends.map(|knot| sketch.knots[knot].position);
        let range = |a: f64, b: f64| {
            let cell = |at: f64| (at / cell_m).floor() as i64;
            cell(a.min(b) - apart_m)..=cell(a.max(b) + apart_m)
        };
        for x in range(a.x, b.x) {
            for y in range(a.y, b.y) {
                let others = cells.entry([x, y]).or_default();
                let apart = others.iter().filter(|&&other| sketch.lines[other].iter().all(|end| !ends.contains(end)));
                pairs.extend(apart.map(|&other| [other, line]));
                others.push(line);
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Where two lines are nearest to each other, as parts of them, and how far apart they are there.
fn nearest_shares(first: [Point3<f64>; 2], second: [Point3<f64>; 2]) -> ([f64; 2], f64) {
    let (u, v, w) = (first[1] - first[0], second[1] - second[0], first[0] - second[0]);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let square = uu * vv - uv * uv;
    let s = if square > 1e-9 * uu * vv { ((uv * vw - vv * uw) / square).clamp(0.0, 1.0) } else { 0.0 };
    let t = ((uv * s + vw) / vv).clamp(0.0, 1.0);
    let s = ((uv * t - uw) / uu).clamp(0.0, 1.0);
    ([s, t], (w + u * s - v * t).norm())
}

/// The same lines with midpoints moved aside, again and again (Fournier, Fussell, Carpenter: "Computer rendering of
/// stochastic models", 1982).
fn wound(settings: &Karst, mut sketch: Sketch, dice: &mut Dice) -> Sketch {
    let lines = std::mem::take(&mut sketch.lines);
    let mut left: Vec<[usize; 2]> = Vec::new();
    for line in lines {
        left.push(line);
        while let Some([a, b]) = left.pop() {
            let way = sketch.knots[b].position - sketch.knots[a].position;
            if way.norm() <= WINDING_M {
                sketch.join(a, b);
                continue;
            }
            let aside = settings.roughness * dice.gauss().clamp(-2.0, 2.0);
            let up = UPS_AND_DOWNS * aside.abs() * dice.sign();
            let moved = Vector3::new(-way.y * aside, way.x * aside, way.xy().norm() * up);
            let position = sketch.knots[a].position + 0.5 * way + moved;
            let middle = sketch.add(Knot { position, section: None, level: 0 });
            left.push([middle, b]);
            left.push([a, middle]);
        }
    }
    sketch
}

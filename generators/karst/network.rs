//! Passages drawn along the ways that water found: narrow forks opened later, everything between made to wind, and room
//! made where passages then cross or crowd.

use nalgebra::Vector3;
use rustc_hash::FxHashSet;

use super::Karst;
use super::cloud::Cloud;
use super::crossings::join_crossings;
use super::crowds::drop_crowds;
use super::forks::open_forks;
use super::rock::Rock;
use super::room::{crowds, give_way, watched};
use plume_graph::dice::Dice;
use plume_graph::sketch::{Knot, Sketch};
use plume_graph::{Section, Shape};

/// Most of the way between two points that a dead end falls short of (tuned for short branches beside long ones).
const MOST_SHORTENED: f64 = 0.7;
/// Midpoints are moved until what is left is shorter than this, in metres.
const WINDING_M: f64 = 4.0;
/// Part of what a midpoint is moved aside that it is moved up or down.
const UPS_AND_DOWNS: f64 = 0.08;

/// The passages along `lines`, that at the first key point which they reach first.
pub(super) fn drawn(
    settings: &Karst,
    rock: &Rock,
    cloud: &Cloud,
    lines: &[[usize; 2]],
    keys: &[usize],
    dice: &mut Dice,
) -> Sketch {
    let (mut sketch, at_keys) = traced(cloud, lines, keys);
    open_forks(&mut sketch);
    shorten_tips(&mut sketch, dice);
    let mut sketch = wound(settings, sketch, dice).smoothed(1);
    for knot in &mut sketch.knots {
        let width_m = rock.width_m(knot.position);
        let height_m = (width_m * settings.height_ratio).max(1.0);
        knot.section = Some(Section { width_m, height_m, shape: Shape::Cave });
    }
    join_crossings(&mut sketch, &at_keys);
    let watched = watched(&sketch);
    let crowds = crowds(&sketch, &watched);
    drop_crowds(&mut sketch, &crowds, &at_keys);
    give_way(&mut sketch, &watched);
    sketch.knots.iter_mut().for_each(|knot| knot.position = rock.in_world(knot.position));
    sketch
}

/// A knot for each point of the lines, and which of them are at key points, the first of these first of all.
fn traced(cloud: &Cloud, lines: &[[usize; 2]], keys: &[usize]) -> (Sketch, FxHashSet<usize>) {
    let mut points: Vec<usize> = lines.iter().flatten().copied().collect();
    points.sort_unstable();
    points.dedup();
    let place = |point: usize| points.binary_search(&point).ok();
    let root = keys.iter().find_map(|&key| place(key)).unwrap_or(0);
    // It changes places with the first point.
    let knot_of = |point: usize| match place(point)? {
        0 => Some(root),
        at if at == root => Some(0),
        at => Some(at),
    };
    let knot = |&point: &usize| Knot { position: cloud.point(point), section: None, level: 0 };
    let mut sketch = Sketch { knots: points.iter().map(knot).collect(), lines: Vec::with_capacity(lines.len()) };
    if !sketch.knots.is_empty() {
        sketch.knots.swap(0, root);
    }
    for ends in lines {
        let [a, b] = ends.map(|point| knot_of(point).expect("it is a point of a line"));
        sketch.join(a, b);
    }
    (sketch, keys.iter().filter_map(|&key| knot_of(key)).collect())
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

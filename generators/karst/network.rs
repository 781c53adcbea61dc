//! Turns the paths of water into passages: opens narrow forks, makes passages wind, and makes room where they then cross
//! or are too close.

use nalgebra::Vector3;
use rustc_hash::FxHashSet;

use super::Karst;
use super::cloud::Cloud;
use super::crossings::join_crossings;
use super::crowds::drop_crowds;
use super::forks::open_forks;
use super::host_rock::HostRock;
use super::room::{crowds, give_way, watched};
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};
use plume_graph::rng::Rng;
use plume_graph::{Section, Shape};

/// Largest fraction of its last segment by which a dead end is shortened (tuned for short branches besides long ones).
const MOST_SHORTENED: f64 = 0.7;
/// Midpoints are displaced until segments are shorter than this, in metres.
const WINDING_M: f64 = 4.0;
/// Vertical displacement of midpoints relative to the horizontal one.
const UPS_AND_DOWNS: f64 = 0.08;

/// The passages along `lines`, starting with the one at the first key point that they reach.
pub(super) fn drawn(
    settings: &Karst,
    rock: &HostRock,
    cloud: &Cloud,
    lines: &[[usize; 2]],
    keys: &[usize],
    rng: &mut Rng,
) -> CentrelineBuilder {
    let (mut centreline, at_keys) = traced(cloud, lines, keys);
    open_forks(&mut centreline);
    shorten_tips(&mut centreline, rng);
    let mut centreline = wound(settings, centreline, rng).smoothed(1);
    for vertex in &mut centreline.vertices {
        let width_m = rock.width_m(vertex.position);
        let height_m = (width_m * settings.height_ratio).max(1.0);
        vertex.section = Some(Section { width_m, height_m, shape: Shape::Cave });
    }
    join_crossings(&mut centreline, &at_keys);
    let watched = watched(&centreline);
    let crowds = crowds(&centreline, &watched);
    drop_crowds(&mut centreline, &crowds, &at_keys);
    give_way(&mut centreline, &watched);
    centreline.vertices.iter_mut().for_each(|vertex| vertex.position = rock.in_world(vertex.position));
    centreline
}

/// A vertex for each point of the lines, and those at key points; the first of these is the first vertex.
fn traced(cloud: &Cloud, lines: &[[usize; 2]], keys: &[usize]) -> (CentrelineBuilder, FxHashSet<VertexId>) {
    let mut points: Vec<usize> = lines.iter().flatten().copied().collect();
    points.sort_unstable();
    points.dedup();
    let place = |point: usize| points.binary_search(&point).ok();
    let root = keys.iter().find_map(|&key| place(key)).unwrap_or(0);
    // Swapped with the first point.
    let knot_of = |point: usize| match place(point)? {
        0 => Some(VertexId::new(root)),
        at if at == root => Some(VertexId::new(0)),
        at => Some(VertexId::new(at)),
    };
    let vertex = |&point: &usize| Vertex { position: cloud.point(point), section: None, level: 0 };
    let mut centreline =
        CentrelineBuilder { vertices: points.iter().map(vertex).collect(), lines: Vec::with_capacity(lines.len()) };
    if !centreline.vertices.is_empty() {
        centreline.vertices.swap(0, root);
    }
    for ends in lines {
        let [a, b] = ends.map(|point| knot_of(point).expect("it is a point of a line"));
        centreline.join(a, b);
    }
    (centreline, keys.iter().filter_map(|&key| knot_of(key)).collect())
}

/// Shortens dead ends to end anywhere on their last segment; the root stays.
fn shorten_tips(centreline: &mut CentrelineBuilder, rng: &mut Rng) {
    let neighbors = centreline.neighbors();
    for tip in centreline.ids().skip(1) {
        if let &[before] = &neighbors[tip] {
            let to = centreline[before].position;
            let way = to - centreline[tip].position;
            centreline[tip].position += way * rng.between(0.0, MOST_SHORTENED);
        }
    }
}

/// The same lines after midpoint displacement (Fournier, Fussell, Carpenter: "Computer rendering of stochastic models",
/// 1982).
fn wound(settings: &Karst, mut centreline: CentrelineBuilder, rng: &mut Rng) -> CentrelineBuilder {
    let lines = std::mem::take(&mut centreline.lines);
    let mut left: Vec<[VertexId; 2]> = Vec::new();
    for line in lines {
        left.push(line);
        while let Some([a, b]) = left.pop() {
            let way = centreline[b].position - centreline[a].position;
            if way.norm() <= WINDING_M {
                centreline.join(a, b);
                continue;
            }
            let aside = settings.roughness * rng.normal().clamp(-2.0, 2.0);
            let up = UPS_AND_DOWNS * aside.abs() * rng.sign();
            let moved = Vector3::new(-way.y * aside, way.x * aside, way.xy().norm() * up);
            let position = centreline[a].position + 0.5 * way + moved;
            let middle = centreline.add(Vertex { position, section: None, level: 0 });
            left.push([middle, b]);
            left.push([a, middle]);
        }
    }
    centreline
}

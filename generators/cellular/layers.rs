//! Layers joined by ramps.
//!
//! A ramp leaves the outermost passage of a layer outwards, runs alongside both layers and returns to the outermost
//! passage of the next one. Each ramp is on a different side than the previous one.

use std::ops::Range;

use nalgebra::Vector2;

use super::Cellular;
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};

/// Fewest nodes of a layer with its passages and ramp.
pub(super) const LEAST_NODES: u32 = 12;
/// Distance between the two legs of a ramp, in widths.
const LEGS_APART: f64 = 3.0;
/// Inclination of a ramp relative to the maximum: stations that cut its corners make it steeper.
const GENTLER: f64 = 0.7;
/// Outward directions of the sides of the plan.
const SIDES: [[f64; 2]; 4] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];

/// The centrelines of all layers, from the top down.
pub(super) fn joined(settings: &Cellular, layers: Vec<CentrelineBuilder>) -> CentrelineBuilder {
    let mut layers = layers.into_iter();
    let mut whole = layers.next().unwrap_or_default();
    let mut above = 0..whole.vertices.len();
    let mut side = None;
    for layer in layers {
        let start = whole.vertices.len();
        whole.vertices.extend(layer.vertices);
        whole.lines.extend(layer.lines.iter().map(|line| line.map(|vertex| VertexId::new(start + vertex.index()))));
        let below = start..whole.vertices.len();
        let neighbors = whole.neighbors();
        let passages = |layer: &Range<usize>| {
            layer.clone().map(VertexId::new).filter(|&vertex| !neighbors[vertex].is_empty()).collect()
        };
        let ramp = Ramp::choose(settings, &whole, [passages(&above), passages(&below)], side);
        side = Some(ramp.side);
        ramp.build(settings, &mut whole);
        above = below;
    }
    whole
}

/// Start and end of a ramp.
struct Ramp {
    side: usize,
    ends: [VertexId; 2],
}

impl Ramp {
    /// On the side, other than the last one, where its legs are farthest apart.
    fn choose(
        settings: &Cellular,
        centreline: &CentrelineBuilder,
        layers: [Vec<VertexId>; 2],
        last: Option<usize>,
    ) -> Self {
        let at = |vertex: VertexId, way: [f64; 2]| centreline[vertex].position.coords.xy().dot(&Vector2::from(way));
        let outermost = |layer: &[VertexId], way: [f64; 2], may: &dyn Fn(VertexId) -> bool| {
            let vertices = layer.iter().copied().filter(|&vertex| may(vertex));
            vertices.max_by(|&a, &b| at(a, way).total_cmp(&at(b, way)))
        };
        let least = LEGS_APART * settings.width_min_m;
        let on = |side: usize| {
            let (way, along) = (SIDES[side], [SIDES[side][1], SIDES[side][0]]);
            let head = outermost(&layers[0], way, &|_| true)?;
            let apart = |vertex: VertexId| (at(vertex, along) - at(head, along)).abs();
            let far = |vertex: VertexId| apart(vertex) >= least;
            let foot = outermost(&layers[1], way, &far).or_else(|| outermost(&layers[1], way, &|_| true))?;
            Some((apart(foot), Self { side, ends: [head, foot] }))
        };
        let sides = (0..SIDES.len()).filter(|&side| Some(side) != last).filter_map(on);
        let best = sides.max_by(|a, b| a.0.total_cmp(&b.0));
        best.expect("every layer has a passage, which is outermost").1
    }

    /// Adds the ramp, as long as its inclination requires.
    fn build(&self, settings: &Cellular, centreline: &mut CentrelineBuilder) {
        let [head, foot] = self.ends.map(|vertex| centreline[vertex]);
        let out = Vector2::from(SIDES[self.side]);
        let [head_out, foot_out] = [head, foot].map(|vertex| vertex.position.coords.xy().dot(&out));
        let across = (foot.position - head.position).xy();
        let along_m = (across - out * across.dot(&out)).norm();
        let slope = GENTLER * libm::tan(settings.ramp_max_deg.to_radians());
        let needed_m = (head.position.z - foot.position.z).abs() / slope;
        let beyond_m =
            (0.5 * (needed_m - along_m - (head_out - foot_out).abs())).max(LEGS_APART * settings.width_min_m);
        let reach = head_out.max(foot_out) + beyond_m;
        let corner = |vertex: &Vertex, from: f64| vertex.position.coords.xy() + out * (reach - from);
        let legs = [reach - head_out, along_m, reach - foot_out];
        let mut before = self.ends[0];
        let mut walked = 0.0;
        for (plan, leg) in [corner(&head, head_out), corner(&foot, foot_out)].into_iter().zip(legs) {
            walked += leg;
            let part = walked / legs.iter().sum::<f64>();
            let z = head.position.z + (foot.position.z - head.position.z) * part;
            let vertex = centreline.add(settings.vertex([plan.x, plan.y, z].into(), settings.width_min_m, foot.level));
            centreline.join(before, vertex);
            before = vertex;
        }
        centreline.join(before, self.ends[1]);
    }
}

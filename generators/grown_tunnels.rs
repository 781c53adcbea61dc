//! Tunnels that branch off each other, and connectors between them.
//!
//! Cano, Tardioli, Mosteo: "Procedural generation of tunnel networks for unsupervised training and testing in
//! underground applications", 2023. From the paper and its program: a tunnel starts at a station away from other
//! junctions; from segment to segment its yaw changes by a tendency and noise, and so does its inclination; a spline runs
//! through the segments; a tunnel that is too steep, branches off too sharply, or comes near itself or another one is
//! rejected and drawn again. Connectors run straight between two stations, their inner segments shifted by lateral and
//! vertical noise. Added here: connectors go to places that are near in space and far along the network, and the number of
//! stations is exact.
//!
//! Promised: exactly the asked number of nodes, one component, at most four passages at a node, and the rules of
//! `network`. Not promised: the statistics of natural caves, which have more short branches.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::network::{self, Growth, Network, PassagePoint, Rules, Size, ahead, in_order};
use super::{GenerateError, Generator};
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::rng::Rng;

/// Attempts to draw a tunnel at one station; every station is tried once, while the paper tries ten random ones.
const TRIES: usize = 3;
/// Attempts to draw a start of a connector.
const CONNECTOR_TRIES: usize = 8;
/// Samples of the spline in each segment; stations are spread along the polyline through them.
const SAMPLES: usize = 8;
/// Shortest segment of a tunnel relative to the mean: the program draws from 0.05–0.15 to 0.15–0.3 of its length.
const SHORTEST: f64 = 0.6;

/// Settings of the generator of grown tunnels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct GrownTunnels {
    /// Number of nodes (stations on the centreline); tunnels grow until they are used up.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Distance between stations along a tunnel, in metres.
    #[schemars(range(min = 2.0, max = 30.0))]
    pub station_spacing_m: f64,
    /// Length of the shortest tunnel, in metres. The paper's program: 50.
    #[schemars(range(min = 10.0, max = 1000.0))]
    pub length_min_m: f64,
    /// Length of the longest tunnel, in metres; lengths are distributed log-uniformly, so that short ones prevail as in
    /// caves. The paper's program: 300, uniformly.
    #[schemars(range(min = 10.0, max = 1000.0))]
    pub length_max_m: f64,
    /// Number of straight segments of a tunnel's plan; its spline runs through their ends.
    #[schemars(range(min = 2, max = 30))]
    pub segments: u32,
    /// Maximum turn per segment common to all segments of a tunnel, to either side, in degrees. From the paper's program.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub yaw_tendency_deg: f64,
    /// Maximum random turn that each segment adds, to either side, in degrees. The paper's program: 20.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub yaw_noise_deg: f64,
    /// Maximum inclination common to all segments of a tunnel, up or down, in degrees. The paper's program: 20.
    #[schemars(range(min = 0.0, max = 45.0))]
    pub inclination_tendency_deg: f64,
    /// Maximum random inclination that each segment adds, in degrees. The paper's program: 10.
    #[schemars(range(min = 0.0, max = 30.0))]
    pub inclination_noise_deg: f64,
    /// Maximum inclination anywhere, in degrees. The paper's program: 30.
    #[schemars(range(min = 2.0, max = 60.0))]
    pub max_inclination_deg: f64,
    /// Minimum angle between tunnels at a junction, in degrees. The paper's program: 30.
    #[schemars(range(min = 30.0, max = 85.0))]
    pub junction_angle_deg: f64,
    /// Minimum distance between junctions along the network, in metres. The paper's program: 30.
    #[schemars(range(min = 0.0, max = 200.0))]
    pub junction_spacing_m: f64,
    /// Connectors per grown tunnel. The paper's example: 5 to 10 tunnels.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub connectors: f64,
    /// Maximum straight-line length of a connector, in metres.
    #[schemars(range(min = 10.0, max = 300.0))]
    pub connector_max_m: f64,
    /// Length of the segments of a connector, in metres. From the paper's program.
    #[schemars(range(min = 5.0, max = 100.0))]
    pub connector_segment_m: f64,
    /// Maximum shift of a connector's inner segments along each axis of the plan, in metres. From the paper's program.
    #[schemars(range(min = 0.0, max = 30.0))]
    pub connector_lateral_noise_m: f64,
    /// Maximum shift of a connector's inner segments up or down, in metres. The paper's program: 5.
    #[schemars(range(min = 0.0, max = 15.0))]
    pub connector_vertical_noise_m: f64,
    /// Width of the narrowest tunnel, in metres; a tunnel keeps its width.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_min_m: f64,
    /// Width of the widest tunnel, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_max_m: f64,
    /// Height of a tunnel above its floor relative to its width.
    #[schemars(range(min = 0.4, max = 2.0))]
    pub height_ratio: f64,
    /// Minimum rock between tunnels that do not meet, in metres. The paper's program keeps axes 10 m apart.
    #[schemars(range(min = 0.5, max = 50.0))]
    pub rock_m: f64,
}

impl Default for GrownTunnels {
    fn default() -> Self {
        Self {
            nodes: 150,
            station_spacing_m: 6.0,
            length_min_m: 10.0,
            length_max_m: 250.0,
            segments: 8,
            yaw_tendency_deg: 40.0,
            yaw_noise_deg: 30.0,
            inclination_tendency_deg: 10.0,
            inclination_noise_deg: 5.0,
            max_inclination_deg: 20.0,
            junction_angle_deg: 50.0,
            junction_spacing_m: 10.0,
            connectors: 0.7,
            connector_max_m: 80.0,
            connector_segment_m: 20.0,
            connector_lateral_noise_m: 7.0,
            connector_vertical_noise_m: 2.0,
            width_min_m: 3.0,
            width_max_m: 5.0,
            height_ratio: 0.75,
            rock_m: 6.0,
        }
    }
}

impl Generator for GrownTunnels {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        in_order(["length_min_m", "length_max_m"], [self.length_min_m, self.length_max_m])?;
        in_order(["width_min_m", "width_max_m"], [self.width_min_m, self.width_max_m])?;
        network::grown(&self.rules(), seed, "grown-tunnels", |rng, _| {
            let tunnels = Tunnels { settings: self, connectors_due: 0.0 };
            (self.passage_point(Point3::origin(), self.draw_width(rng)), tunnels)
        })
    }
}

impl GrownTunnels {
    fn rules(&self) -> Rules {
        Rules {
            nodes: self.nodes as usize,
            rock_m: self.rock_m,
            widest: Size::new(self.width_max_m, self.height_ratio),
            steepest_rad: self.max_inclination_deg.to_radians(),
            junction: self.junction_angle_deg.to_radians(),
            // This generator makes its own loops: the connectors.
            loop_closure: 0.0,
            spacing_m: self.station_spacing_m,
        }
    }

    fn draw_width(&self, rng: &mut Rng) -> f64 {
        rng.between(self.width_min_m, self.width_max_m)
    }

    fn passage_point(&self, position: Point3<f64>, width_m: f64) -> PassagePoint {
        PassagePoint { position, size: Size::new(width_m, self.height_ratio) }
    }
}

/// The tunnels of one network.
struct Tunnels<'a> {
    settings: &'a GrownTunnels,
    connectors_due: f64,
}

impl Growth for Tunnels<'_> {
    fn dig(&mut self, network: &mut Network, rng: &mut Rng) {
        while network.room() > 0 {
            let Some(from) = network.draw_opening(rng) else { return };
            if network.is_near_junction(from, self.settings.junction_spacing_m) {
                continue;
            }
            if (0..TRIES).any(|_| self.grow(network, from, rng)) {
                self.connectors_due += self.settings.connectors;
                self.connect_some(network, rng);
            }
        }
    }
}

impl Tunnels<'_> {
    /// Draws a tunnel from a station and adds it, as far as there are stations left.
    fn grow(&self, network: &mut Network, from: usize, rng: &mut Rng) -> bool {
        let corners = self.draw_corners(*network.position(from), rng);
        let mut way = spaced(&spline(&corners), self.settings.station_spacing_m);
        way.truncate(network.room());
        let width = self.settings.draw_width(rng);
        let passage_points: Vec<PassagePoint> =
            way.into_iter().map(|at| self.settings.passage_point(at, width)).collect();
        network.lay(from, &passage_points, None).is_some()
    }

    /// The ends of a tunnel's segments.
    fn draw_corners(&self, from: Point3<f64>, rng: &mut Rng) -> Vec<Point3<f64>> {
        let settings = self.settings;
        let length = settings.length_min_m * libm::pow(settings.length_max_m / settings.length_min_m, rng.unit());
        // Segments shorter than the station spacing would curl up a short tunnel.
        let segments = f64::from(settings.segments).min(length / settings.station_spacing_m).max(1.0);
        let mean = length / segments;
        let mut part = |most_deg: f64| most_deg.to_radians() * rng.between(-1.0, 1.0);
        let (turn, turn_noise) = (part(settings.yaw_tendency_deg), part(settings.yaw_noise_deg));
        let (rise, rise_noise) = (part(settings.inclination_tendency_deg), part(settings.inclination_noise_deg));
        let mut yaw_rad = rng.between(0.0, TAU);
        let mut corners = vec![from];
        let mut at = from;
        let mut drawn = 0.0;
        while drawn < length {
            let step = mean * rng.between(SHORTEST, 2.0 - SHORTEST);
            let pitch_rad = rise + rise_noise * rng.between(-1.0, 1.0);
            at += step * ahead(yaw_rad, pitch_rad);
            corners.push(at);
            drawn += step;
            yaw_rad += turn + turn_noise * rng.between(-1.0, 1.0);
        }
        corners
    }

    /// Adds the connectors that are due, as far as places for them are found.
    fn connect_some(&mut self, network: &mut Network, rng: &mut Rng) {
        while self.connectors_due >= 1.0 {
            self.connectors_due -= 1.0;
            let _is_found = (0..CONNECTOR_TRIES).any(|_| self.connect(network, rng));
        }
    }

    fn connect(&self, network: &mut Network, rng: &mut Rng) -> bool {
        let from = rng.index(network.len());
        let spacing = self.settings.junction_spacing_m;
        if network.is_near_junction(from, spacing) {
            return false;
        }
        let reach = [2.0 * self.settings.station_spacing_m, self.settings.connector_max_m];
        let goals = network.goals(from, reach, rng);
        goals.into_iter().any(|to| !network.is_near_junction(to, spacing) && self.lay_connector(network, from, to, rng))
    }

    fn lay_connector(&self, network: &mut Network, from: usize, to: usize, rng: &mut Rng) -> bool {
        let corners = self.draw_connector(*network.position(from), *network.position(to), rng);
        let mut way = spaced(&spline(&corners), self.settings.station_spacing_m);
        way.pop();
        let width = self.settings.draw_width(rng);
        let passage_points: Vec<PassagePoint> =
            way.into_iter().map(|at| self.settings.passage_point(at, width)).collect();
        network.lay(from, &passage_points, Some(to)).is_some()
    }

    /// The ends of a connector's segments; the first and the last inner ones are not shifted, as in the paper's program.
    fn draw_connector(&self, from: Point3<f64>, to: Point3<f64>, rng: &mut Rng) -> Vec<Point3<f64>> {
        let way = to - from;
        let segments = (way.norm() / self.settings.connector_segment_m).ceil().max(1.0) as usize;
        let mut corners = vec![from];
        for inner in 1..segments {
            let mut at = from + way * (inner as f64 / segments as f64);
            if inner > 1 && inner + 1 < segments {
                let mut off = |most: f64| rng.between(-most, most);
                let lateral = self.settings.connector_lateral_noise_m;
                at += Vector3::new(off(lateral), off(lateral), off(self.settings.connector_vertical_noise_m));
            }
            corners.push(at);
        }
        corners.push(to);
        corners
    }
}

/// Points on the Catmull-Rom spline through these, including the first and the last (Catmull & Rom 1974).
fn spline(corners: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let last = corners.len() - 1;
    let before = corners[0] - (corners[1] - corners[0]);
    let after = corners[last] + (corners[last] - corners[last - 1]);
    let corner = |index: usize| match index.checked_sub(1) {
        None => before,
        Some(index) => corners.get(index).copied().unwrap_or(after),
    };
    let mut points = vec![corners[0]];
    for segment in 0..last {
        let [a, b, c, d] = [0, 1, 2, 3].map(|place| corner(segment + place));
        points.extend((1..=SAMPLES).map(|sample| curve([a, b, c, d], sample as f64 / SAMPLES as f64)));
    }
    points
}

/// The point at this fraction between the second and the third of four control points.
fn curve([a, b, c, d]: [Point3<f64>; 4], t: f64) -> Point3<f64> {
    let [leave, arrive] = [(c - a) * 0.5, (d - b) * 0.5];
    let along = t * t * (3.0 - 2.0 * t);
    let bend = leave * (t * (1.0 - t) * (1.0 - t)) - arrive * (t * t * (1.0 - t));
    b + (c - b) * along + bend
}

/// Evenly spaced points along a polyline, as near to the spacing as possible: without the first point, with the last.
fn spaced(points: &[Point3<f64>], spacing: f64) -> Vec<Point3<f64>> {
    let lengths: Vec<f64> = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
    let length: f64 = lengths.iter().sum();
    let count = (length / spacing).round().max(1.0);
    let mut spaced = Vec::with_capacity(count as usize);
    let (mut place, mut start) = (0, 0.0);
    for step in 1..count as usize {
        let at = length * step as f64 / count;
        while at > start + lengths[place] && place + 1 < lengths.len() {
            start += lengths[place];
            place += 1;
        }
        spaced.push(points[place] + (points[place + 1] - points[place]) * ((at - start) / lengths[place]));
    }
    spaced.extend(points.last());
    spaced
}

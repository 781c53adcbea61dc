//! Space colonization: passages that branch towards free space until it is filled.
//!
//! Runions, Lane, Prusinkiewicz: "Modeling trees with a space colonization algorithm", 2007. Attractors are scattered in a
//! region. Each of them pulls the station nearest to it, if it is near enough; every station that is pulled grows one step
//! in the mean direction; attractors near a station are removed. Widths follow the pipe model (Murray 1926 has exponent
//! 3): the width of a passage is determined by those that it feeds. Added here: a flat region, since caves are flat, a slope
//! limit, wander, loops, and rock between passages.
//!
//! Promised: exactly the asked number of nodes, one component, at most four passages at a node, and the rules of
//! `network`. Not promised: that the whole region is filled, since growth ends with the last node.

mod attractors;

use nalgebra::{Point3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::network::{self, Growth, Network, PassagePoint, Rules, Size, ahead, in_order};
use super::{GenerateError, Generator};
use attractors::Attractors;
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::rng::Rng;

/// Area per station, relative to the step times the distance at which attractors are removed. Tuned so that the region is
/// about filled.
const GROUND: f64 = 2.6;
/// Growth factor of the region if it was too small.
const LARGER: f64 = 1.3;
/// Minimum half axis of the region relative to the distance at which attractors are removed, so that some are beyond it.
const LEAST_REGION: f64 = 3.0;
/// Turns that a station tries if it is blocked, in degrees, and shares of the slope.
const DODGES: [(f64, f64); 8] =
    [(0.0, 1.0), (0.0, 0.5), (25.0, 1.0), (-25.0, 1.0), (25.0, 0.3), (-25.0, 0.3), (50.0, 0.3), (-50.0, 0.3)];

/// The outline of the region that is colonized.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Region {
    /// A box.
    Box,
    /// An ellipsoid.
    #[default]
    Ellipsoid,
}

/// Settings of the space colonization generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct SpaceColonization {
    /// Number of nodes (stations on the centreline); the size of the region follows from it.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Outline of the region: `ellipsoid` or `box`.
    pub region: Region,
    /// Length of the region, west to east, relative to its width.
    #[schemars(range(min = 0.1, max = 10.0))]
    pub elongation: f64,
    /// Height of the region, in metres; 0 is level. With tens of metres, passages run above one another.
    #[schemars(range(min = 0.0, max = 200.0))]
    pub height_m: f64,
    /// Mean distance between attractors, in metres: sparse ones make long bare passages.
    #[schemars(range(min = 2.0, max = 50.0))]
    pub attractor_spacing_m: f64,
    /// Distance from which an attractor pulls, in metres. From the paper.
    #[schemars(range(min = 4.0, max = 150.0))]
    pub influence_m: f64,
    /// Distance at which an attractor is removed, in metres. From the paper: two steps and more.
    #[schemars(range(min = 2.0, max = 50.0))]
    pub kill_m: f64,
    /// Length of a step, which is the distance between stations, in metres. From the paper.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub step_m: f64,
    /// Strength of a common pull in one direction, relative to that of the attractors; the paper's tropism.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub tropism: f64,
    /// Azimuth of that direction, clockwise from north (+Y), in degrees.
    #[schemars(range(min = 0.0, max = 360.0))]
    pub tropism_azimuth_deg: f64,
    /// Random wander of a passage: standard deviation of the angle of each step from its pull, in degrees.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub wander_deg: f64,
    /// Maximum inclination of the floor of a passage, in degrees.
    #[schemars(range(min = 1.0, max = 45.0))]
    pub max_slope_deg: f64,
    /// Width of a passage at its end, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_min_m: f64,
    /// Maximum width of a passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_max_m: f64,
    /// Exponent of the pipe model: widths to this power add up where passages join.
    #[schemars(range(min = 1.5, max = 4.0))]
    pub pipe_exponent: f64,
    /// Height of a passage above its floor relative to its width.
    #[schemars(range(min = 0.4, max = 2.0))]
    pub height_ratio: f64,
    /// Number of loops: 0 for none, 1 for as many as in real caves.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub loop_closure: f64,
    /// Minimum rock between passages that do not meet, in metres.
    #[schemars(range(min = 0.5, max = 20.0))]
    pub rock_m: f64,
}

impl Default for SpaceColonization {
    fn default() -> Self {
        Self {
            nodes: 150,
            region: Region::Ellipsoid,
            elongation: 1.6,
            height_m: 16.0,
            attractor_spacing_m: 12.0,
            influence_m: 40.0,
            kill_m: 8.0,
            step_m: 4.0,
            tropism: 0.2,
            tropism_azimuth_deg: 60.0,
            wander_deg: 40.0,
            max_slope_deg: 20.0,
            width_min_m: 2.0,
            width_max_m: 5.0,
            pipe_exponent: 2.5,
            height_ratio: 0.75,
            loop_closure: 1.0,
            rock_m: 1.0,
        }
    }
}

impl Generator for SpaceColonization {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        in_order(["width_min_m", "width_max_m"], [self.width_min_m, self.width_max_m])?;
        in_order(["step_m", "kill_m"], [self.step_m, self.kill_m])?;
        in_order(["kill_m", "influence_m"], [self.kill_m, self.influence_m])?;
        in_order(["attractor_spacing_m", "influence_m"], [self.attractor_spacing_m, self.influence_m])?;
        network::grown(&self.rules(), seed, "space-colonization", |rng, attempt| {
            let scattered = self.scatter(attempt, rng);
            let attractors = Attractors::new(scattered, [self.kill_m, self.influence_m]);
            let first = PassagePoint { position: Point3::origin(), size: self.widest() };
            (first, Colony { settings: self, attractors, met: 0 })
        })
    }
}

impl SpaceColonization {
    fn rules(&self) -> Rules {
        Rules {
            nodes: self.nodes as usize,
            rock_m: self.rock_m,
            widest: self.widest(),
            steepest_rad: self.max_slope_deg.to_radians(),
            junction: network::JUNCTION,
            loop_closure: self.loop_closure,
            spacing_m: self.step_m,
        }
    }

    fn widest(&self) -> Size {
        Size::new(self.width_max_m, self.height_ratio)
    }

    /// Uniformly random attractors in a region for all nodes, larger with each attempt.
    fn scatter(&self, attempt: u64, rng: &mut Rng) -> Vec<Point3<f64>> {
        let growth = (0..attempt).fold(1.0, |growth, _| growth * LARGER);
        let ground = GROUND * growth * f64::from(self.nodes) * self.step_m * self.kill_m;
        let least = LEAST_REGION * self.kill_m;
        let half_breadth = (0.5 * (ground / self.elongation).sqrt()).max(least);
        let half = Vector3::new((half_breadth * self.elongation).max(least), half_breadth, 0.5 * self.height_m);
        let storeys = (self.height_m / self.attractor_spacing_m).max(1.0);
        let count = 4.0 * half.x * half.y * storeys / (self.attractor_spacing_m * self.attractor_spacing_m);
        let mut place = || Vector3::from_fn(|_, _| rng.between(-1.0, 1.0));
        let drawn = (0..count.ceil() as usize).map(|_| place());
        let inside = drawn.filter(|place| self.region == Region::Box || place.norm_squared() <= 1.0);
        inside.map(|place| Point3::from(place.component_mul(&half))).collect()
    }

    /// The common pull on all passages; its length is its strength.
    fn tropism(&self) -> Vector3<f64> {
        let azimuth = self.tropism_azimuth_deg.to_radians();
        self.tropism * Vector3::new(libm::sin(azimuth), libm::cos(azimuth), 0.0)
    }
}

/// A network that grows towards attractors.
struct Colony<'a> {
    settings: &'a SpaceColonization,
    attractors: Attractors,
    /// Number of stations that the attractors have seen.
    met: usize,
}

impl Growth for Colony<'_> {
    fn dig(&mut self, network: &mut Network, rng: &mut Rng) {
        self.meet(network);
        loop {
            let pulls = self.attractors.pulls(network);
            if pulls.is_empty() {
                return;
            }
            for (station, pull) in pulls {
                if network.room() == 0 {
                    return;
                }
                if !self.grow(network, station, pull, rng) {
                    self.attractors.give_up(station);
                }
            }
            self.meet(network);
        }
    }

    fn finish(&self, network: &mut Network) {
        let power = self.settings.pipe_exponent;
        let tip = libm::pow(self.settings.width_min_m, power);
        let mut fed = vec![0.0; network.len()];
        for station in (1..network.len()).rev() {
            // A station that feeds nothing is an end.
            fed[station] = f64::max(fed[station], tip);
            if let Some(parent) = network.parent(station) {
                fed[parent] += fed[station];
            }
        }
        let width = |station: usize| libm::pow(fed[station], 1.0 / power).min(self.settings.width_max_m);
        network.resize(|station| Size::new(width(station), self.settings.height_ratio));
    }
}

impl Colony<'_> {
    /// Shows the new stations to the attractors.
    fn meet(&mut self, network: &Network) {
        for station in self.met..network.len() {
            self.attractors.meet(station, network.position(station));
        }
        self.met = network.len();
    }

    /// Adds a step from a station in the direction of its pull, or in a nearby direction.
    fn grow(&self, network: &mut Network, station: usize, pull: Vector3<f64>, rng: &mut Rng) -> bool {
        let way = pull + self.settings.tropism();
        let steepest = self.settings.max_slope_deg.to_radians();
        let pitch_rad = libm::atan2(way.z, way.xy().norm()).clamp(-steepest, steepest);
        let yaw_rad = libm::atan2(way.y, way.x) + (self.settings.wander_deg * rng.normal()).to_radians();
        let from = *network.position(station);
        DODGES.into_iter().any(|(turn_deg, share)| {
            let position = from + self.settings.step_m * ahead(yaw_rad + turn_deg.to_radians(), share * pitch_rad);
            network.lay(station, &[PassagePoint { position, size: self.settings.widest() }], None).is_some()
        })
    }
}

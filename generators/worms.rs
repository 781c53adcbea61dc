//! Perlin worms: passages that follow noise.
//!
//! The method of voxel games and hobby generators, without a single paper to cite; the noise is that of Perlin: "Improving
//! noise", 2002. A worm takes steps of constant length. Noise along its path turns its yaw from its bearing, raises and
//! lowers it within a slope and a range of depths, and varies its width. Where rock is too thin it dodges, or ends. Other
//! worms branch off earlier ones at an angle. Dead ends join nearby passages until there are enough loops.
//!
//! Promised: exactly the asked number of nodes, one component, at most four passages at a node, and the rules of
//! `network`. Not promised: the statistics of real caves, although lengths have the same distribution (log-normal).

use std::f64::consts::TAU;

use nalgebra::Point3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::network::{self, Growth, Network, PassagePoint, Rules, Size, ahead};
use super::{GenerateError, Generator};
use crate::perlin::Perlin;
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::rng::Rng;

/// Bearings that a worm tries at its start.
const STARTS: usize = 4;
/// Turns that a worm tries if it is blocked, in degrees, to either side.
const DODGES_DEG: [f64; 3] = [0.0, 30.0, 60.0];
/// Wavelength of the drift of a worm relative to that of its swing, and that of its rise and fall.
const DRIFT_LENGTH: f64 = 4.0;
/// Typical maximum of the noise, by which it is scaled so that amplitudes match the settings.
const NOISE_REACH: f64 = 0.5;
/// Shortest worm in steps.
const SHORTEST: f64 = 2.0;

/// Settings of the generator of worms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Worms {
    /// Number of nodes (stations on the centreline); worms are added until they are used up.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Length of a step, which is the distance between stations, in metres.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub step_m: f64,
    /// Median length of worms, in metres, if nothing stops them.
    #[schemars(range(min = 4.0, max = 1000.0))]
    pub length_m: f64,
    /// Spread of lengths: standard deviation of their logarithm. Tuned; branches of real caves have about 1 (Collon et al.
    /// 2017), but worms are divided into branches by those that branch off.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub length_spread: f64,
    /// Amplitude of a worm's swing from its bearing, to either side, in degrees.
    #[schemars(range(min = 0.0, max = 120.0))]
    pub swing_deg: f64,
    /// Wavelength of the swing, in metres.
    #[schemars(range(min = 5.0, max = 200.0))]
    pub swing_length_m: f64,
    /// Amplitude of the drift of its bearing over four such wavelengths, to either side, in degrees.
    #[schemars(range(min = 0.0, max = 180.0))]
    pub drift_deg: f64,
    /// Maximum inclination of a passage, in degrees.
    #[schemars(range(min = 1.0, max = 45.0))]
    pub max_slope_deg: f64,
    /// Height between the lowest and the highest passages, in metres; a larger one lets worms pass over each other.
    #[schemars(range(min = 0.0, max = 200.0))]
    pub depth_m: f64,
    /// Width of the narrowest passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_min_m: f64,
    /// Width of the widest passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_max_m: f64,
    /// Wavelength of the width of a worm, in metres. Widths in caves are similar over about 30 m.
    #[schemars(range(min = 5.0, max = 200.0))]
    pub girth_length_m: f64,
    /// Height of a passage above its floor relative to its width.
    #[schemars(range(min = 0.4, max = 2.0))]
    pub height_ratio: f64,
    /// Minimum distance between branching points along the cave, in metres.
    #[schemars(range(min = 0.0, max = 100.0))]
    pub branch_spacing_m: f64,
    /// Number of loops: 0 for none, 1 for as many as in real caves.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub loop_closure: f64,
    /// Minimum rock between passages that do not meet, in metres.
    #[schemars(range(min = 0.5, max = 20.0))]
    pub rock_m: f64,
}

impl Default for Worms {
    fn default() -> Self {
        Self {
            nodes: 150,
            step_m: 4.0,
            length_m: 20.0,
            length_spread: 1.4,
            swing_deg: 110.0,
            swing_length_m: 24.0,
            drift_deg: 120.0,
            max_slope_deg: 20.0,
            depth_m: 20.0,
            width_min_m: 2.0,
            width_max_m: 5.0,
            girth_length_m: 30.0,
            height_ratio: 0.75,
            branch_spacing_m: 4.0,
            loop_closure: 1.0,
            rock_m: 1.0,
        }
    }
}

impl Generator for Worms {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        network::in_order(["width_min_m", "width_max_m"], [self.width_min_m, self.width_max_m])?;
        network::grown(&self.rules(), seed, "worms", |rng, _| {
            let crawl = Crawl { settings: self, noise: Perlin::new(rng) };
            let size = Size::new(0.5 * (self.width_min_m + self.width_max_m), self.height_ratio);
            (PassagePoint { position: Point3::origin(), size }, crawl)
        })
    }
}

impl Worms {
    fn rules(&self) -> Rules {
        Rules {
            nodes: self.nodes as usize,
            rock_m: self.rock_m,
            widest: Size::new(self.width_max_m, self.height_ratio),
            steepest_rad: self.max_slope_deg.to_radians(),
            junction: network::JUNCTION,
            loop_closure: self.loop_closure,
            spacing_m: self.step_m,
        }
    }

    fn draw_length_m(&self, rng: &mut Rng) -> f64 {
        let drawn = self.length_m * libm::exp(self.length_spread * rng.normal());
        drawn.max(SHORTEST * self.step_m)
    }
}

/// The worms of a cave, and the noise that guides all of them.
struct Crawl<'a> {
    settings: &'a Worms,
    noise: Perlin,
}

/// A growing worm: where in the noise each of its motions is read.
struct Worm {
    bearing_rad: f64,
    swing: f64,
    drift: f64,
    rise: f64,
    passage_size: f64,
}

impl Growth for Crawl<'_> {
    fn dig(&mut self, network: &mut Network, rng: &mut Rng) {
        while network.room() > 0 {
            let Some(from) = network.draw_opening(rng) else { return };
            if network.is_near_junction(from, self.settings.branch_spacing_m) {
                continue;
            }
            let length = self.settings.draw_length_m(rng);
            for _ in 0..STARTS {
                let mut lane = || rng.between(0.0, 256.0);
                let [swing, drift, rise, passage_size] = [lane(), lane(), lane(), lane()];
                let mut worm = Worm { bearing_rad: rng.between(0.0, TAU), swing, drift, rise, passage_size };
                if self.crawl(network, &mut worm, from, length) {
                    break;
                }
            }
        }
    }
}

impl Crawl<'_> {
    /// Moves a worm until its length is used up or it is blocked; whether it took any step.
    fn crawl(&self, network: &mut Network, worm: &mut Worm, from: usize, length_m: f64) -> bool {
        let mut tip = from;
        let mut crawled = 0.0;
        while crawled < length_m && network.room() > 0 {
            let Some(next) = self.step(network, worm, tip, crawled) else { break };
            crawled += self.settings.step_m;
            tip = next;
        }
        tip != from
    }

    /// The next station of a worm, straight on or dodging to a side, which turns its bearing.
    fn step(&self, network: &mut Network, worm: &mut Worm, tip: usize, crawled_m: f64) -> Option<usize> {
        let at = *network.position(tip);
        let size = self.size(worm, crawled_m);
        let pitch_rad = self.pitch_rad(worm, crawled_m, at.z);
        let sides = DODGES_DEG.into_iter().flat_map(|dodge| [dodge, -dodge]);
        for dodge in sides.map(f64::to_radians).skip(1) {
            let yaw_rad = self.yaw_rad(worm, crawled_m) + dodge;
            let passage_point = PassagePoint { position: at + self.settings.step_m * ahead(yaw_rad, pitch_rad), size };
            if let Some(next) = network.lay(tip, &[passage_point], None) {
                worm.bearing_rad += dodge;
                return Some(next);
            }
        }
        None
    }

    fn yaw_rad(&self, worm: &Worm, crawled_m: f64) -> f64 {
        let swing_length = self.settings.swing_length_m;
        let swing = self.settings.swing_deg * self.noise(crawled_m / swing_length, worm.swing);
        let drift = self.settings.drift_deg * self.noise(crawled_m / (DRIFT_LENGTH * swing_length), worm.drift);
        worm.bearing_rad + (swing + drift).to_radians()
    }

    /// Vertical motion by noise, reversed at the limits of the range of depths.
    fn pitch_rad(&self, worm: &Worm, crawled_m: f64, z: f64) -> f64 {
        let steepest = self.settings.max_slope_deg.to_radians();
        let half = 0.5 * self.settings.depth_m;
        let rise = self.noise(crawled_m / self.settings.swing_length_m, worm.rise);
        let wanted = steepest * (rise - if half > 0.0 { z / half } else { 0.0 });
        // A step always ends inside the range.
        let most = |room: f64| libm::asin((room / self.settings.step_m).clamp(0.0, 1.0));
        wanted.clamp(-most(z + half).min(steepest), most(half - z).min(steepest))
    }

    fn size(&self, worm: &Worm, crawled_m: f64) -> Size {
        let part = 0.5 + 0.5 * self.noise(crawled_m / self.settings.girth_length_m, worm.passage_size).clamp(-1.0, 1.0);
        let (least, most) = (self.settings.width_min_m, self.settings.width_max_m);
        Size::new(least + (most - least) * part, self.settings.height_ratio)
    }

    /// Noise along a line of the plane, about -1 to 1.
    fn noise(&self, along: f64, lane: f64) -> f64 {
        // Off the lattice, where the noise is 0, and shifted so that the starts of lines differ.
        self.noise.at(along + 0.37 * lane, lane) / NOISE_REACH
    }
}

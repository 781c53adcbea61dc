//! Perlin worms: passages that crawl where noise leads them.
//!
//! The method of voxel games and of hobby generators, without one paper to cite; the noise is that of Perlin: "Improving
//! noise", 2002. A worm takes steps of one length. Noise along the way turns its yaw from its bearing, raises and lowers it within
//! a slope and a range of depths, and makes it wide and narrow. Where rock is too thin it dodges, or ends. Other worms
//! start along the way of earlier ones, at an angle. Dead ends join passages near by until there are loops enough.
//!
//! Promised: exactly the asked number of nodes, one component, at most four passages at a node, and the law of
//! `network`. Not promised: the statistics of real caves, although lengths are drawn as theirs are (log-normal).

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

/// Bearings that a worm tries where it starts.
const STARTS: usize = 4;
/// Turns that a worm tries where its way is blocked, in degrees, to either side.
const DODGES_DEG: [f64; 3] = [0.0, 30.0, 60.0];
/// Wavelength of the drift of a worm by that of its swing, and that of its rise and fall.
const DRIFT_LENGTH: f64 = 4.0;
/// The noise is seldom farther than this from 0; it is scaled so that settings mean what they say.
const NOISE_REACH: f64 = 0.5;
/// Shortest worm in steps.
const SHORTEST: f64 = 2.0;

/// Settings of the generator of worms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Worms {
    /// Number of nodes (stations on the centreline); worms crawl until they are used up.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Length of a step, which is the distance between stations, in metres.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub step_m: f64,
    /// Length that half of the worms exceed, in metres, if nothing stops them.
    #[schemars(range(min = 4.0, max = 1000.0))]
    pub length_m: f64,
    /// Spread of lengths: standard deviation of their logarithm. Tuned; near 1 is what branches of real caves have (Collon et
    /// al. 2017), and worms are cut to pieces by those that branch off.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub length_spread: f64,
    /// How far a worm swings from its bearing, to either side, in degrees.
    #[schemars(range(min = 0.0, max = 120.0))]
    pub swing_deg: f64,
    /// Length over which it swings there and back, in metres.
    #[schemars(range(min = 5.0, max = 200.0))]
    pub swing_length_m: f64,
    /// How far its bearing drifts over four times that length, to either side, in degrees.
    #[schemars(range(min = 0.0, max = 180.0))]
    pub drift_deg: f64,
    /// Greatest inclination of a passage, in degrees.
    #[schemars(range(min = 1.0, max = 45.0))]
    pub max_slope_deg: f64,
    /// Height between the lowest and the highest passages, in metres; more of it lets worms pass over each other.
    #[schemars(range(min = 0.0, max = 200.0))]
    pub depth_m: f64,
    /// Width of the narrowest passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_min_m: f64,
    /// Width of the widest passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_max_m: f64,
    /// Length over which a worm grows wide and narrow again, in metres. Widths in caves are alike over about 30 m.
    #[schemars(range(min = 5.0, max = 200.0))]
    pub girth_length_m: f64,
    /// Height of a passage above its floor in units of its width.
    #[schemars(range(min = 0.4, max = 2.0))]
    pub height_ratio: f64,
    /// Least distance between the places where worms branch off, along the cave, in metres.
    #[schemars(range(min = 0.0, max = 100.0))]
    pub branch_spacing_m: f64,
    /// How many loops are closed: 0 for none, 1 for as many as in real caves.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub loop_closure: f64,
    /// Least rock between passages that do not meet, in metres.
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

/// The worms of one cave, and the noise that leads all of them.
struct Crawl<'a> {
    settings: &'a Worms,
    noise: Perlin,
}

/// A worm on its way: where in the noise each of its motions is read.
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
    /// Moves a worm on until its length is used up or its way is blocked; whether it took a step at all.
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

    /// Up or down by noise, and back where the range of depths ends.
    fn pitch_rad(&self, worm: &Worm, crawled_m: f64, z: f64) -> f64 {
        let steepest = self.settings.max_slope_deg.to_radians();
        let half = 0.5 * self.settings.depth_m;
        let rise = self.noise(crawled_m / self.settings.swing_length_m, worm.rise);
        let wanted = steepest * (rise - if half > 0.0 { z / half } else { 0.0 });
        // A step ends inside the range, wherever the noise would lead.
        let most = |room: f64| libm::asin((room / self.settings.step_m).clamp(0.0, 1.0));
        wanted.clamp(-most(z + half).min(steepest), most(half - z).min(steepest))
    }

    fn size(&self, worm: &Worm, crawled_m: f64) -> Size {
        let part = 0.5 + 0.5 * self.noise(crawled_m / self.settings.girth_length_m, worm.passage_size).clamp(-1.0, 1.0);
        let (least, most) = (self.settings.width_min_m, self.settings.width_max_m);
        Size::new(least + (most - least) * part, self.settings.height_ratio)
    }

    /// Noise along a lane of the plane, about -1 to 1.
    fn noise(&self, along: f64, lane: f64) -> f64 {
        // Between the lattice points of the noise, where it is 0, starts are as different as lanes.
        self.noise.at(along + 0.37 * lane, lane) / NOISE_REACH
    }
}

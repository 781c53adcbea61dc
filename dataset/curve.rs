//! What the key `difficulty` makes of a recipe, for each task.
//!
//! Each task has a curve: keys of the recipe with their values where it is easiest and where it is hardest. Between, a value follows
//! a straight line, or one in the logarithm for what is counted. Keys that the generator or the rock of a recipe does not have are
//! left out, and values beyond what they allow are the next that they do.
//!
//! The ends are tuned: the easy one by what a Husky or a drone passes anywhere, the hard one by what ranges of recipes and
//! certificates still allow.

use std::ops::RangeInclusive;

use plume::recipe::Recipe;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::draw::rounded;

/// What robots are to do in the caves of a dataset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// To drive: longer, steeper, narrower, stonier and wetter floors are harder.
    #[default]
    Drive,
    /// To fly: longer, steeper, narrower passages with more hanging from the ceiling are harder.
    Fly,
    /// To map: longer and darker passages with fewer loops and marks, and wetter walls, are harder.
    Slam,
}

/// A key of a curve.
#[derive(Clone, Copy, Debug)]
pub struct Knob {
    /// The key of the recipe.
    pub key: &'static str,
    /// Its value at difficulty 0.
    pub easy: f64,
    /// Its value at difficulty 1.
    pub hard: f64,
    /// How it gets from one to the other.
    pub law: Law,
}

/// How a value follows difficulty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// A straight line.
    Linear,
    /// A straight line in the logarithm, to whole numbers.
    Count,
}

const fn linear(key: &'static str, easy: f64, hard: f64) -> Knob {
    Knob { key, easy, hard, law: Law::Linear }
}

const fn count(key: &'static str, easy: f64, hard: f64) -> Knob {
    Knob { key, easy, hard, law: Law::Count }
}

const DRIVE: [Knob; 10] = [
    count("graph.nodes", 12.0, 100.0),
    linear("graph.relief_m", 1.2, 3.6),
    linear("graph.max_slope_deg", 6.0, 16.0),
    linear("graph.ramp_max_deg", 6.0, 16.0),
    linear("passage.width_min_m", 2.6, 1.4),
    linear("passage.floor_flatness", 0.9, 0.2),
    linear("passage.floor_roughness_m", 0.02, 0.1),
    linear("things.difficulty", 0.0, 0.3),
    linear("look.humidity", 0.1, 0.9),
    linear("world.friction", 0.8, 0.6),
];

const FLY: [Knob; 9] = [
    count("graph.nodes", 12.0, 150.0),
    count("graph.layers", 1.0, 3.0),
    linear("graph.relief_m", 1.2, 12.0),
    linear("graph.max_slope_deg", 6.0, 40.0),
    linear("graph.ramp_max_deg", 15.0, 80.0),
    linear("passage.width_min_m", 3.0, 1.2),
    linear("passage.height_ratio", 1.3, 0.8),
    linear("things.dripstone", 0.2, 2.0),
    linear("things.headroom_m", 2.0, 0.5),
];

const SLAM: [Knob; 7] = [
    count("graph.nodes", 20.0, 200.0),
    linear("graph.loop_closure", 1.5, 0.3),
    linear("look.humidity", 0.1, 1.0),
    linear("look.stain", 1.2, 0.3),
    linear("rock.relief", 1.1, 0.5),
    linear("things.cover", 0.08, 0.01),
    linear("world.light_spacing_m", 6.0, 40.0),
];

impl Task {
    /// Its name in a specification.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Fly => "fly",
            Self::Slam => "slam",
        }
    }

    /// Its curve.
    pub fn curve(self) -> &'static [Knob] {
        match self {
            Self::Drive => &DRIVE,
            Self::Fly => &FLY,
            Self::Slam => &SLAM,
        }
    }

    /// The keys that this recipe has, at a difficulty from 0 to 1, within their ranges there.
    pub(crate) fn settings(self, difficulty: f64, recipe: &Recipe) -> Vec<(String, Value)> {
        let setting = |knob: &Knob| {
            let range = recipe.range(knob.key)?;
            Some((knob.key.to_owned(), knob.at(difficulty, &range)))
        };
        self.curve().iter().filter_map(setting).collect()
    }
}

impl Knob {
    fn at(&self, difficulty: f64, range: &RangeInclusive<f64>) -> Value {
        let Self { easy, hard, .. } = *self;
        let within = |value: f64| value.clamp(*range.start(), *range.end());
        match self.law {
            Law::Linear => rounded(within(easy + (hard - easy) * difficulty)),
            Law::Count => json!(within((easy * libm::pow(hard / easy, difficulty)).round()) as u64),
        }
    }
}

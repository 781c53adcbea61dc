//! How the values of a key are drawn.

use plume_graph::rng::Rng;
use plume_graph::seed::stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A key that varies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Vary {
    /// A key of the recipe, such as `graph.nodes`; `difficulty`, from 0 to 1, which sets several (see `task`); or `recipe`, for
    /// several presets or files.
    pub key: String,
    /// How its values are drawn.
    pub draw: Draw,
    /// Low and high for `uniform`, `log` and `sobol`, and all values for `choice` and `grid`.
    pub values: Vec<Value>,
}

/// How values are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Draw {
    /// Evenly between two numbers; whole ones if both are whole.
    Uniform,
    /// Evenly in the logarithm between two positive numbers; whole ones if both are whole.
    Log,
    /// As `uniform`, but spread more evenly over all keys that are drawn so: a scrambled Sobol sequence in the order of seeds.
    Sobol,
    /// One of the values, each as often.
    Choice,
    /// Each of the values for every seed.
    Grid,
}

impl Draw {
    /// Its name in a specification.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Log => "log",
            Self::Sobol => "sobol",
            Self::Choice => "choice",
            Self::Grid => "grid",
        }
    }
}

/// Most keys that are drawn by `sobol`: the dimensions of the sequence.
pub const MOST_SOBOL: usize = sobol_burley::NUM_DIMENSIONS as usize;
/// Most points of the sequence.
pub const MOST_POINTS: usize = 1 << 16;
/// Scrambles the sequence.
const SCRAMBLE: u32 = 0x5EED;

impl Vary {
    /// What is wrong with the values, if anything.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        match self.draw {
            Draw::Uniform | Draw::Sobol if self.ends().is_none() => Some("must be two numbers, the lower one first"),
            Draw::Log if self.ends().is_none_or(|[low, _]| low <= 0.0) => {
                Some("must be two numbers above 0, the lower one first")
            }
            Draw::Choice | Draw::Grid if self.values.is_empty() => Some("must not be empty"),
            _ => None,
        }
    }

    fn ends(&self) -> Option<[f64; 2]> {
        let [low, high] = self.values.as_slice() else { return None };
        let ends = [low.as_f64()?, high.as_f64()?];
        (ends[0] <= ends[1]).then_some(ends)
    }

    /// The value for a seed that is the `place`-th of its dataset; `dimension` counts the keys before this one that are drawn by
    /// `sobol`, and `step` is the place among the values of a grid.
    pub(crate) fn value(&self, seed: u64, place: usize, dimension: usize, step: usize) -> Value {
        let lot = || Rng::new(stream(seed, &self.key, 0)).unit();
        match self.draw {
            Draw::Uniform => self.between(lot(), |x| x, |x| x),
            Draw::Log => self.between(lot(), libm::log, libm::exp),
            Draw::Sobol => {
                let lot = sobol_burley::sample(place as u32, dimension as u32, SCRAMBLE);
                self.between(lot.into(), |x| x, |x| x)
            }
            Draw::Choice => self.values[(lot() * self.values.len() as f64) as usize].clone(),
            Draw::Grid => self.values[step].clone(),
        }
    }

    /// The value at a share of the way from low to high, evenly in what `scale` makes of it.
    fn between(&self, share: f64, scale: fn(f64) -> f64, unscale: fn(f64) -> f64) -> Value {
        let [low, high] = self.ends().expect("the values were checked");
        if !self.values.iter().all(is_whole) {
            return rounded(unscale(scale(low) + (scale(high) - scale(low)) * share));
        }
        // Every whole number has an interval around it.
        let [from, to] = [scale(low - 0.5), scale(high + 0.5)];
        json!((unscale(from + (to - from) * share).round() as i64).clamp(low as i64, high as i64))
    }
}

/// A number that reads well in a recipe: to a millionth.
pub(crate) fn rounded(value: f64) -> Value {
    json!((value * 1e6).round() / 1e6)
}

fn is_whole(value: &Value) -> bool {
    value.is_i64() || value.is_u64()
}

//! Layers one below the other, each laid out by a generator of its own, joined by links within a range of slopes.
//!
//! Multi-layer caves are the subject of the PLUME paper (Garcia, Richard, Olivares-Mendez: "PLUME: Procedural Layer
//! Underground Modeling Engine", 2025), which joins layers by passages at an interconnection angle. Here a layer is
//! whatever another generator makes, put at a depth. Links run between stations of neighbouring layers, straight where the
//! slope allows and else along a helix; shafts drop where passages cross above each other.
//!
//! Promised: the asked number of links between each pair of neighbouring layers, each of its steps within the slopes;
//! least distances between their heads and between their feet; the asked rock between passages of different layers and
//! round links but where a short way joins them, which makes layers lie deeper than asked where they must. What finds no
//! room is an error. Not promised: the slopes inside a layer, which are its generator's.

mod layer;
mod link;
mod stack;

use rand::Rng as _;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use layer::Layer;

use super::{GenerateError, Generator};
use crate::ramp::Slopes;
use link::Law;
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::rng::Rng;
use plume_graph::seed;
use stack::Stack;

/// Name of this generator in recipes.
pub(super) const NAME: &str = "layers";
/// Times that all layers and links are drawn. Tuned: a fifth of the pairs of default caves has no room for two shafts.
const ATTEMPTS: u64 = 8;
/// How much deeper than the time before layers without a depth of their own lie, in metres: ramps between level layers need
/// room to pass under passages. Tuned.
const DEEPER_M: f64 = 2.5;

/// What becomes of rock between layers that is too thin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ThinRock {
    /// Layers are moved down until there is none.
    #[default]
    Avoid,
    /// Layers stay at the depth that was asked for, and `plume measure` tells where rock is thin.
    Allow,
}

/// Settings of the layers generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Layers {
    /// Number of links between each pair of neighbouring layers.
    #[schemars(range(min = 1, max = 50))]
    pub link_count: u32,
    /// Least inclination of a link, in degrees.
    #[schemars(range(min = 1.0, max = 90.0))]
    pub link_min_deg: f64,
    /// Greatest inclination of a link, in degrees: about 15 for wheels, 90 for shafts.
    #[schemars(range(min = 1.0, max = 90.0))]
    pub link_max_deg: f64,
    /// Least distance in the plan between the heads of two links of a pair of layers, and between their feet, in metres.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub link_spacing_m: f64,
    /// Least rock between passages of different layers, and between links and passages they do not meet, in metres; the
    /// roughness of the rock takes a part of it.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub rock_min_m: f64,
    /// What becomes of rock between layers that is thinner: `avoid` moves layers down until there is none, `allow` leaves
    /// them at their depth. Links avoid it always.
    pub thin_rock: ThinRock,
    /// The layers, the highest first: each a generator, its settings, and where it lies.
    #[schemars(length(min = 2, max = 20))]
    pub layer: Vec<Layer>,
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            link_count: 2,
            link_min_deg: 5.0,
            link_max_deg: 25.0,
            link_spacing_m: 15.0,
            rock_min_m: 2.0,
            thin_rock: ThinRock::Avoid,
            layer: vec![Layer::default(), Layer::default()],
        }
    }
}

impl Generator for Layers {
    fn generate(&self, seed: u64, outside: &dyn Outside) -> Result<Graph, GenerateError> {
        self.check()?;
        let law = Law {
            slopes: Slopes::of_degrees(self.link_min_deg, self.link_max_deg),
            spacing_m: self.link_spacing_m,
            rock_m: self.rock_min_m,
        };
        let mut fault = None;
        for attempt in 0..ATTEMPTS {
            let mut stack = self.pile(seed, attempt, outside)?;
            let mut rng = Rng::new(seed::stream(seed, "layer-links", attempt));
            match self.link(&mut stack, &law, &mut rng) {
                Ok(()) => return Ok(stack.passages.into_graph().numbered_by_breadth()),
                Err(error) => fault = Some(error),
            }
        }
        Err(fault.expect("there was an attempt"))
    }
}

impl Layers {
    /// Relations between settings.
    fn check(&self) -> Result<(), GenerateError> {
        if self.layer.len() < 2 {
            let message = format!("`layer` names {} layers", self.layer.len());
            return Err(GenerateError::new(message, "write at least two [[graph.layer]] sections"));
        }
        let mut above = None;
        for (place, layer) in self.layer.iter().enumerate() {
            if let (Some(above_m), Some(depth_m)) = (above, layer.depth_m)
                && depth_m <= above_m
            {
                let message = format!("layer {place} has a `depth_m` of {depth_m}, but one above it {above_m}");
                return Err(GenerateError::new(message, "write the layers in the order of their depth"));
            }
            above = layer.depth_m.or(above);
        }
        if self.link_min_deg > self.link_max_deg {
            let message =
                format!("`link_min_deg` is {} but `link_max_deg` is {}", self.link_min_deg, self.link_max_deg);
            return Err(GenerateError::new(message, "the least inclination may not exceed the greatest"));
        }
        Ok(())
    }

    /// The layers at their depths, without links.
    fn pile(&self, seed: u64, attempt: u64, outside: &dyn Outside) -> Result<Stack, GenerateError> {
        let mut stack = Stack::default();
        let rock_m = (self.thin_rock == ThinRock::Avoid).then_some(self.rock_min_m);
        for (place, layer) in self.layer.iter().enumerate() {
            let seed = seed::stream(seed, &format!("layer-{place}"), attempt).next_u64();
            let told = |error: GenerateError| GenerateError::new(format!("layer {place}: {error}"), error.hint);
            let graph = layer.generator().and_then(|generator| generator.generate(seed, outside)).map_err(told)?;
            stack.lay(graph, layer, rock_m, DEEPER_M * attempt as f64);
        }
        Ok(stack)
    }

    /// Joins each pair of neighbouring layers.
    fn link(&self, stack: &mut Stack, law: &Law, rng: &mut Rng) -> Result<(), GenerateError> {
        for upper in 0..self.layer.len() - 1 {
            let mut links = Vec::new();
            while links.len() < self.link_count as usize {
                let Some(link) = stack.link(upper, &links, law, rng) else {
                    return Err(self.too_few(upper, links.len()));
                };
                links.push(link);
            }
        }
        Ok(())
    }

    fn too_few(&self, upper: usize, found: usize) -> GenerateError {
        let (lower, asked) = (upper + 1, self.link_count);
        GenerateError::new(
            format!("{found} of {asked} links between layers {upper} and {lower} found room"),
            format!(
                "ask for fewer by `link_count`, lower `link_spacing_m` or `rock_min_m`, widen the range from \
                 `link_min_deg` to `link_max_deg`, or give layer {lower} another `depth_m`"
            ),
        )
    }
}

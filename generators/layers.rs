//! Layers one below another, each made by its own generator, joined by links within a range of slopes.
//!
//! Multi-layer caves are the subject of the PLUME paper (Garcia, Richard, Olivares-Mendez: "PLUME: Procedural Layer
//! Underground Modeling Engine", 2025), which joins layers by passages at an interconnection angle. Here a layer is
//! the result of another generator, placed at a depth. Links run between stations of neighbouring layers, straight if the
//! slope allows it, otherwise along a helix; shafts drop where passages cross above each other.
//!
//! Promised: the asked number of links between each pair of neighbouring layers, all steps within the range of slopes;
//! minimum distances between their heads and between their feet; the asked rock between passages of different layers and
//! around links, except where a short path connects them, for which layers are moved deeper if necessary. A lack of room is
//! an error. Not promised: slopes inside a layer, which are up to its generator.

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
/// Attempts to draw all layers and links. Tuned: a fifth of the pairs of default caves have no room for two shafts.
const ATTEMPTS: u64 = 8;
/// How much deeper layers without an explicit depth are placed at each attempt, in metres: ramps between level layers
/// need room to pass under passages. Tuned.
const DEEPER_M: f64 = 2.5;

/// What to do if the rock between layers is too thin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ThinRock {
    /// Move layers down until there is enough rock.
    #[default]
    Avoid,
    /// Keep layers at their depth; `plume measure` shows where rock is thin.
    Allow,
}

/// Settings of the layers generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Layers {
    /// Number of links between each pair of neighbouring layers.
    #[schemars(range(min = 1, max = 50))]
    pub link_count: u32,
    /// Minimum inclination of a link, in degrees.
    #[schemars(range(min = 1.0, max = 90.0))]
    pub link_min_deg: f64,
    /// Maximum inclination of a link, in degrees: about 15 for wheels, 90 for shafts.
    #[schemars(range(min = 1.0, max = 90.0))]
    pub link_max_deg: f64,
    /// Minimum horizontal distance between the heads of two links of a pair of layers, and between their feet, in metres.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub link_spacing_m: f64,
    /// Minimum rock between passages of different layers, and between links and passages they do not meet, in metres; the
    /// roughness of the rock uses up part of it.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub rock_min_m: f64,
    /// What to do if the rock between layers is thinner: `avoid` moves layers down until it is not, `allow` keeps them at
    /// their depth. Links always avoid it.
    pub thin_rock: ThinRock,
    /// The layers from the top down: each a generator, its settings, and its position.
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
            let message = format!("`layer` has {} layers", self.layer.len());
            return Err(GenerateError::new(message, "write at least two [[graph.layer]] sections"));
        }
        let mut above = None;
        for (place, layer) in self.layer.iter().enumerate() {
            if let (Some(above_m), Some(depth_m)) = (above, layer.depth_m)
                && depth_m <= above_m
            {
                let message = format!("layer {place} has a `depth_m` of {depth_m}, but one above it has {above_m}");
                return Err(GenerateError::new(message, "list the layers in order of depth"));
            }
            above = layer.depth_m.or(above);
        }
        if self.link_min_deg > self.link_max_deg {
            let message =
                format!("`link_min_deg` is {} but `link_max_deg` is {}", self.link_min_deg, self.link_max_deg);
            return Err(GenerateError::new(message, "the minimum must not exceed the maximum"));
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
            format!("there is room for only {found} of {asked} links between layers {upper} and {lower}"),
            format!(
                "reduce `link_count`, `link_spacing_m` or `rock_min_m`, widen the range from \
                 `link_min_deg` to `link_max_deg`, or give layer {lower} another `depth_m`"
            ),
        )
    }
}

//! The look of a rock; nothing here changes geometry.

use super::site::BLOCK;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the look, which do not change the geometry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Look {
    /// Wetness of the rock: 0 bone dry, 1 dripping. Water makes it darker and glossier, first in hollows and streaks.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub humidity: f32,
    /// Strength of mineral stains (iron, manganese, sulphates, calcite); 1 is natural.
    #[schemars(range(min = 0.0, max = 1.5))]
    pub stain: f32,
    /// Factors on the base colour of the rock, as linear red, green and blue, each 0 to 2: [1, 1, 1] leaves it as it is. Stones
    /// and dripstone, which are of that rock, are tinted too; equipment, objects and models are not.
    #[schemars(inner(range(min = 0.0, max = 2.0)))]
    pub tint: [f32; 3],
}

impl Default for Look {
    fn default() -> Self {
        Self { humidity: 0.3, stain: 1.0, tint: [1.0; 3] }
    }
}

impl Look {
    /// Tints colours, linear RGB, and keeps them within 0–1.
    pub(super) fn tint(&self, colors: &mut [[f32; BLOCK]; 3]) {
        for (channel, factor) in colors.iter_mut().zip(self.tint) {
            channel.iter_mut().for_each(|value| *value = (*value * factor).clamp(0.0, 1.0));
        }
    }
}

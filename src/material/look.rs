//! The look of a rock; nothing here changes geometry.

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
}

impl Default for Look {
    fn default() -> Self {
        Self { humidity: 0.3, stain: 1.0 }
    }
}

//! Limits on what is written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Limits on what is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputSettings {
    /// Limit on the size of the cave folder, in gigabytes (10⁹ bytes). A cave that would need more is refused before the
    /// work begins. The size is estimated from the graph, within a factor of two.
    #[schemars(range(min = 0.001, max = 1_000_000.0))]
    pub max_gb: f64,
}

impl Default for OutputSettings {
    fn default() -> Self {
        Self { max_gb: 20.0 }
    }
}

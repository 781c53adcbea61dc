use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Zone;

/// Convex pieces of the rock behind the wall, for simulators that collide convex shapes only. Made if a target needs them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct PieceSettings {
    /// How far a piece may reach into the air beyond the floor of the visual mesh, in metres. Half of it means about twice
    /// as many pieces.
    #[schemars(range(min = 0.005, max = 1.0))]
    pub floor_tolerance_m: f32,
    /// How far a piece may reach into the air beyond a wall, in metres.
    #[schemars(range(min = 0.005, max = 1.0))]
    pub wall_tolerance_m: f32,
    /// How far a piece may reach into the air beyond the ceiling, in metres.
    #[schemars(range(min = 0.005, max = 1.0))]
    pub ceiling_tolerance_m: f32,
    /// Thickness of the pieces in metres, where the rock is that thick.
    #[schemars(range(min = 0.05, max = 2.0))]
    pub thickness_m: f32,
}

impl Default for PieceSettings {
    fn default() -> Self {
        Self { floor_tolerance_m: 0.02, wall_tolerance_m: 0.05, ceiling_tolerance_m: 0.05, thickness_m: 0.3 }
    }
}

impl PieceSettings {
    /// The tolerance of a zone in metres.
    pub fn tolerance_m(&self, zone: Zone) -> f32 {
        match zone {
            Zone::Floor => self.floor_tolerance_m,
            Zone::Wall => self.wall_tolerance_m,
            Zone::Ceiling => self.ceiling_tolerance_m,
        }
    }
}

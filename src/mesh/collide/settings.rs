use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Zone;

/// Convex pieces of the rock behind the wall, for simulators that collide convex shapes only. Made when a target asks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct PieceSettings {
    /// How far a piece may reach into the open beyond the floor that cameras see, in metres. Half of it means about twice
    /// as many pieces.
    #[schemars(range(min = 0.005, max = 1.0))]
    pub floor_tolerance_m: f32,
    /// The same of walls.
    #[schemars(range(min = 0.005, max = 1.0))]
    pub wall_tolerance_m: f32,
    /// The same of ceilings.
    #[schemars(range(min = 0.005, max = 1.0))]
    pub ceiling_tolerance_m: f32,
    /// How far pieces reach into the rock, in metres, where the rock is that thick.
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

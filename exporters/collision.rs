//! What robots touch, for targets that leave the choice.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which shapes robots touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Collision {
    /// A concave mesh per chunk: the wall itself, to the triangle, and the fastest to load.
    #[default]
    Triangles,
    /// Convex pieces of the rock behind the wall, for engines that make every mesh convex.
    Pieces,
}

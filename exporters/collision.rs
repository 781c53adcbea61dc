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

/// Collision meshes that an importer knows by their names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NamedCollision {
    /// None: every mesh is one to see.
    #[default]
    None,
    /// Convex pieces of the rock behind the wall, named `UCX_<mesh>_<NN>` as Unreal wants them.
    Pieces,
}

//! Collision shapes, for targets that offer a choice.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Collision shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Collision {
    /// A concave mesh per chunk: exactly the collision mesh of the wall, and the fastest to load.
    #[default]
    Triangles,
    /// Convex pieces of the rock behind the wall, for engines that only support convex meshes.
    Pieces,
}

/// Collision meshes recognised by importers by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NamedCollision {
    /// No collision meshes.
    #[default]
    None,
    /// Convex pieces of the rock behind the wall, named `UCX_<mesh>_<NN>` as Unreal expects.
    Pieces,
}

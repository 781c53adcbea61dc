//! Numbers worth keeping of a unit of work.
//!
//! They are told to users, and never relied on but for how many coarser levels there are: what a folder that came from
//! somewhere else says in another form is taken for nothing.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Stage;
use crate::mesh::ChunkMeshes;
use crate::texture::{Level, Textured};
use plume_graph::Graph;

/// What a unit says of what was made, by its stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Facts {
    /// Of a graph.
    Graph(GraphFacts),
    /// Of maps there is nothing to say.
    Preview {},
    /// Of a chunk.
    Mesh(MeshFacts),
    /// Of the things in a chunk, or of their prototypes.
    Things(ThingFacts),
    /// Of a textured chunk.
    Texture(TextureFacts),
    /// Of the rock behind a chunk.
    Pieces(PieceFacts),
}

impl Facts {
    /// The facts of a unit of this stage, as they stand in a file.
    pub(super) fn read(stage: Stage, facts: Value) -> Self {
        match stage {
            Stage::Graph => Self::Graph(read(facts)),
            Stage::Preview => Self::Preview {},
            Stage::Mesh => Self::Mesh(read(facts)),
            Stage::Things => Self::Things(read(facts)),
            Stage::Texture => Self::Texture(read(facts)),
            Stage::Pieces => Self::Pieces(read(facts)),
        }
    }
}

fn read<T: DeserializeOwned + Default>(facts: Value) -> T {
    serde_json::from_value(facts).unwrap_or_default()
}

/// What the unit of the graph says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GraphFacts {
    /// Number of stations.
    pub nodes: usize,
    /// Number of passages.
    pub passages: usize,
    /// Number of independent loops.
    pub loops: usize,
    /// Total length of all passages in metres.
    pub length_m: f64,
}

impl From<&Graph> for GraphFacts {
    fn from(graph: &Graph) -> Self {
        Self { nodes: graph.nodes.len(), passages: graph.edges.len(), loops: graph.loops(), length_m: graph.length_m() }
    }
}

/// What the unit of a chunk says; in rock and in air there are no triangles, and nothing else to be said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MeshFacts {
    /// Number of triangles of the wall.
    pub triangles: usize,
    /// Number of triangles to collide with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collision_triangles: Option<usize>,
    /// Area of the wall in square metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_m2: Option<f64>,
}

impl From<&ChunkMeshes> for MeshFacts {
    fn from(meshes: &ChunkMeshes) -> Self {
        Self {
            triangles: meshes.visual.triangles.len(),
            collision_triangles: Some(meshes.collision.triangles.len()),
            area_m2: Some(meshes.visual.area_m2()),
        }
    }
}

/// What the unit of a textured chunk says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TextureFacts {
    /// Texels per metre of wall; what is not known is not told.
    pub texels_per_m: Option<f64>,
    /// The share of the atlas that charts cover.
    pub utilisation: f64,
    /// The coarser levels, the finest first.
    pub lods: Vec<LodFacts>,
}

impl TextureFacts {
    /// What is to be said of a textured chunk and its coarser levels.
    pub fn new(textured: &Textured, levels: &[Level]) -> Self {
        Self {
            texels_per_m: Some(textured.texels_per_m.into()),
            utilisation: textured.utilisation.into(),
            lods: levels.iter().map(LodFacts::from).collect(),
        }
    }
}

/// Facts about a coarser level in the unit of a textured chunk.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LodFacts {
    /// Number of its triangles.
    pub triangles: usize,
    /// Upper bound of its distance from full detail, in both directions, in metres.
    pub error_m: f64,
}

impl From<&Level> for LodFacts {
    fn from(level: &Level) -> Self {
        Self { triangles: level.triangles.len(), error_m: level.error_m.into() }
    }
}

/// What the unit of the things in a chunk says, or that of the prototypes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ThingFacts {
    /// The number of things, or of prototypes.
    pub things: usize,
    /// The number of stones of gravel, which is beside them.
    #[serde(skip_serializing_if = "is_none")]
    pub gravel: usize,
    /// How many of them move when pushed.
    #[serde(skip_serializing_if = "is_none")]
    pub movable: usize,
    /// The coarser levels of the prototypes, the finest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lods: Vec<LodFacts>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_none(count: &usize) -> bool {
    *count == 0
}

/// What the unit of the convex pieces of a chunk says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PieceFacts {
    /// Their number.
    pub pieces: usize,
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn read_and_written(stage: Stage, facts: Value) -> String {
        serde_json::to_string(&Facts::read(stage, facts)).unwrap_or_default()
    }

    #[test]
    fn facts_are_written_as_they_were_read() {
        for (stage, facts) in [
            (Stage::Graph, json!({"nodes": 50, "passages": 50, "loops": 1, "length_m": 190.38809365143294})),
            (Stage::Preview, json!({})),
            (Stage::Mesh, json!({"triangles": 0})),
            (Stage::Mesh, json!({"triangles": 116, "collision_triangles": 58, "area_m2": 187.5447167972643})),
            (
                Stage::Texture,
                json!({
                    "texels_per_m": 14.079015731811523,
                    "utilisation": 0.49740368127822876,
                    "lods": [{"triangles": 754, "error_m": 0.21701033413410187}],
                }),
            ),
            (Stage::Things, json!({"things": 340})),
            (Stage::Pieces, json!({"pieces": 12})),
        ] {
            assert_eq!(read_and_written(stage, facts.clone()), facts.to_string());
        }
    }

    #[test]
    fn what_has_another_form_is_nothing() {
        for facts in [json!(3), json!({}), json!({"lods": -1}), json!({"lods": [{"triangles": -4, "error_m": "no"}]})] {
            assert_eq!(Facts::read(Stage::Texture, facts), Facts::Texture(TextureFacts::default()));
        }
    }
}

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct MeshSettings {
    /// Edge of a voxel in metres. The wall is accurate down to about twice this length.
    #[schemars(range(min = 0.05, max = 1.0))]
    pub voxel_m: f32,
    /// Edges of a chunk along x, y and z in metres, rounded to whole cells. 16 to 32 m cost least.
    #[schemars(inner(range(min = 1.0, max = 512.0)))]
    pub chunk_m: [f32; 3],
    /// Number of chunks along x, y and z, as in the original PLUME. Overrides `chunk_m`.
    #[schemars(inner(range(min = 1, max = 1024)))]
    pub divisions: Option<[u32; 3]>,
    /// How far simplification may move the visual mesh, in metres: about the distance exceeded by one point of the wall in a
    /// thousand; the maximum is within three times that. 0 keeps every triangle.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub simplify_error_m: f32,
    /// Target for the number of visual triangles in the whole cave, whatever the error. 0 sets no limit.
    #[schemars(range(min = 0, max = 4_000_000_000_u32))]
    pub max_triangles: u32,
    /// How far simplification may move the collision mesh, in metres, measured like `simplify_error_m`.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub collision_error_m: f32,
}

impl Default for MeshSettings {
    fn default() -> Self {
        Self {
            voxel_m: 0.12,
            chunk_m: [16.0; 3],
            divisions: None,
            simplify_error_m: 0.012,
            max_triangles: 0,
            collision_error_m: 0.05,
        }
    }
}

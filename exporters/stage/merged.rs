//! One collision mesh for the whole scene, for readers that take a single mesh: the ray caster of Isaac Lab.

use std::path::Path;

use serde_json::{Value, json};

use super::colliders::collider;
use super::{Library, layer_path, place_layer};
use crate::error::ExportError;
use crate::package::Package;
use crate::scene::Mesh;
use crate::split_nonmanifold::split_nonmanifold_vertices;

/// Name of the layer, beside those of the chunks.
const NAME: &str = "collision";

/// The collision meshes of the chunks so far, one after the other. Neighbours have the same vertices on their border, so
/// nothing falls through the seams.
#[derive(Default)]
pub(super) struct Merged(Mesh);

impl Merged {
    /// Adds the collision mesh of a chunk.
    ///
    /// # Errors
    /// If there are more vertices than USD can count.
    pub fn add(&mut self, mut mesh: Mesh) -> Result<(), ExportError> {
        split_nonmanifold_vertices(&mut mesh);
        let before = self.0.positions.len();
        self.0.positions.append(&mut mesh.positions);
        if i32::try_from(self.0.positions.len()).is_err() {
            let bytes = 12 * (self.0.positions.len() + self.0.indices.len()) as u64;
            return Err(ExportError::TooLarge { path: format!("chunks/{NAME}.usdc"), format: "USD", bytes });
        }
        self.0.indices.extend(mesh.indices.iter().map(|&index| before as u32 + index));
        Ok(())
    }

    /// Number of triangles.
    pub fn triangles(&self) -> u64 {
        self.0.triangles()
    }

    /// Writes the layer; returns its description for the root layer.
    pub fn write(self, library: &dyn Library, scratch: &Path, out: &mut dyn Package) -> Result<Value, ExportError> {
        let (extent, mut arrays) = (self.0.bounds(), Vec::new());
        let collider = collider("Collision".to_owned(), "none", self.0, &mut arrays);
        let spec = json!({ "path": layer_path(NAME, scratch), "collider": collider });
        library.call("write_collision", &spec, arrays)?;
        place_layer(NAME, extent, scratch, out)
    }
}

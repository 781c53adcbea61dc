//! The surface of a scene as ground truth takes it: everything but gravel, with which nothing collides.

use plume_truth::{Columns, Floor, Thin};

use crate::error::ExportError;
use crate::scene::{Chunk, Content, Mesh, Scene};

/// The floor in cells of this side in metres, and the things that are thinner.
///
/// # Errors
/// As [`Scene::chunk`].
pub fn floor(scene: &Scene, cell_m: f64) -> Result<Floor, ExportError> {
    let (mut columns, mut thin) = (Columns::new(cell_m), Thin::new(cell_m));
    for chunk in chunks(scene) {
        let Chunk { content, visual: Mesh { positions, indices, .. }, .. } = chunk?;
        columns.add(&positions, &indices);
        if matches!(content, Content::Things { .. }) {
            thin.add(&positions, &indices);
        }
    }
    Ok(Floor::new(columns).with_thin(thin))
}

/// Its meshes in full detail, loaded one at a time; an error as by [`Scene::chunk`].
pub fn meshes<'a>(scene: &'a Scene) -> impl Iterator<Item = Result<Mesh, ExportError>> + use<'a> {
    chunks(scene).map(|chunk| Ok(chunk?.visual))
}

/// The chunks with which something collides.
fn chunks<'a>(scene: &'a Scene) -> impl Iterator<Item = Result<Chunk, ExportError>> + use<'a> {
    let chunks = (0..scene.chunks.len()).map(|index| scene.chunk(index));
    chunks.filter(|chunk| chunk.as_ref().map_or(true, Chunk::collides))
}

//! The surface of a scene as ground truth takes it: everything but gravel, with which nothing collides.

use plume_truth::{Columns, Floor};

use crate::error::ExportError;
use crate::scene::{Chunk, Mesh, Scene};

/// The floor in cells of this side in metres.
///
/// # Errors
/// As [`Scene::chunk`].
pub fn floor(scene: &Scene, cell_m: f64) -> Result<Floor, ExportError> {
    let mut columns = Columns::new(cell_m);
    for mesh in meshes(scene) {
        let mesh = mesh?;
        columns.add(&mesh.positions, &mesh.indices);
    }
    Ok(Floor::new(columns))
}

/// Its meshes in full detail, loaded one at a time; an error as by [`Scene::chunk`].
pub fn meshes<'a>(scene: &'a Scene) -> impl Iterator<Item = Result<Mesh, ExportError>> + use<'a> {
    let chunks = (0..scene.chunks.len()).map(|index| scene.chunk(index));
    chunks.filter(|chunk| chunk.as_ref().map_or(true, Chunk::collides)).map(|chunk| Ok(chunk?.visual))
}

//! The surface of a scene as ground truth takes it: everything but gravel, with which nothing collides.

use plume_truth::{Columns, Floor, Thin};

use crate::error::ExportError;
use crate::scene::{Chunk, Content, Mesh, Scene};

/// The floor in cells of this side in metres, and the things that are thinner.
///
/// # Errors
/// As [`Scene::chunk`].
pub fn floor(scene: &Scene, cell_m: f64) -> Result<Floor, ExportError> {
    let mut builder = FloorBuilder::new(cell_m);
    chunks(scene).try_for_each(|chunk| chunk.map(|chunk| builder.add(&chunk)))?;
    Ok(builder.finish())
}

/// A floor that is made chunk by chunk.
pub struct FloorBuilder {
    columns: Columns,
    thin: Thin,
}

impl FloorBuilder {
    /// Nothing yet, in cells of this side in metres.
    pub fn new(cell_m: f64) -> Self {
        Self { columns: Columns::new(cell_m), thin: Thin::new(cell_m) }
    }

    /// Adds a chunk with which something collides.
    pub fn add(&mut self, chunk: &Chunk) {
        let Mesh { positions, indices, .. } = &chunk.visual;
        self.columns.add(positions, indices);
        if matches!(chunk.content, Content::Things { .. }) {
            self.thin.add(positions, indices);
        }
    }

    /// The floor of all chunks.
    pub fn finish(self) -> Floor {
        Floor::new(self.columns).with_thin(self.thin)
    }
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

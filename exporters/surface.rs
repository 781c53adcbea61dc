//! The surface of a scene as ground truth takes it: everything but gravel, with which nothing collides.

use plume_truth::{Columns, Floor};

use crate::error::ExportError;
use crate::scene::Scene;

/// The floor in cells of this side in metres.
///
/// # Errors
/// As [`Scene::chunk`].
pub fn floor(scene: &Scene, cell_m: f64) -> Result<Floor, ExportError> {
    let mut columns = Columns::new(cell_m);
    for index in 0..scene.chunks.len() {
        let chunk = scene.chunk(index)?;
        if chunk.collides() {
            columns.add(&chunk.visual.positions, &chunk.visual.indices);
        }
    }
    Ok(Floor::new(columns))
}

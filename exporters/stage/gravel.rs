//! Gravel: a layer per chunk with one point instancer, which suits what nothing collides with.

use std::path::Path;

use serde_json::{Value, json};

use super::{Library, describe_pose, layer_path, place_layer, textures, unlabelled};
use crate::error::ExportError;
use crate::package::Package;
use crate::scene::{Chunk, Gravel};

/// Writes the layer of a chunk of gravel; returns its description for the root layer.
pub(super) fn write(
    chunk: &Chunk,
    gravel: Gravel,
    library: &dyn Library,
    scratch: &Path,
    out: &mut dyn Package,
) -> Result<Value, ExportError> {
    let extent = chunk.visual.bounds();
    let stones: Vec<Value> = gravel
        .stones
        .iter()
        .map(|stone| {
            let mut described = describe_pose(&stone.pose);
            described["shape"] = stone.shape.into();
            described["scale"] = stone.scale.into();
            described
        })
        .collect();
    let (mut arrays, mut shapes) = (Vec::new(), Vec::new());
    for (number, mesh) in gravel.shapes.into_iter().enumerate() {
        let name = format!("stone_{number}");
        shapes.push(unlabelled(name.clone(), &name, mesh, &mut arrays));
    }
    let levels: Vec<Value> = gravel
        .shown
        .iter()
        .zip(chunk.levels())
        .enumerate()
        .map(|(level, (shown, (_, error_m)))| {
            json!({ "name": format!("LOD{level}"), "shown": shown, "error_m": error_m })
        })
        .collect();
    let spec = json!({
        "path": layer_path(&chunk.name, scratch),
        "textures": textures(&chunk.material, out)?,
        "extent": extent,
        "shapes": shapes,
        "stones": stones,
        "levels": levels,
    });
    library.call("write_gravel", &spec, arrays)?;
    place_layer(&chunk.name, extent, scratch, out)
}

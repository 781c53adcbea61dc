//! The files of a recipe: what models may be called, and how a cave folder names models and maps.

use serde_json::{Value, json};

use super::fault::{Fault, Faults};
use super::read::Draft;
use crate::model::Format;
use crate::texture::{KEPT_MAPS, TextureSettings};
use crate::things::{FileSettings, KINDS};
use plume_graph::echo::{plain, shown};

/// Refuses names that other kinds have, and files that are no models by their extension.
///
/// # Errors
/// All faults.
pub fn check(files: &[FileSettings], draft: &Draft) -> Result<(), Faults> {
    let mut faults = Faults::default();
    for (place, file) in files.iter().enumerate() {
        let mut fault = |key: &str, message: String, hint: String| {
            let key = format!("things.files[{place}].{key}");
            faults.add(|| Fault { origin: draft.origin(&key), message: format!("{key} {message}"), hint });
        };
        let name = shown(&file.name);
        if KINDS.find(&file.name).is_some() {
            let hint = "`plume list things` shows the names that are taken";
            fault("name", format!("cannot be {name}: that is a built-in kind"), hint.to_owned());
        }
        if files[..place].iter().any(|other| other.name == file.name) {
            fault(
                "name",
                format!("cannot be {name}: another file has this name"),
                "give each a name of its own".to_owned(),
            );
        }
        if Format::of(&file.path).is_none() {
            let path = plain(&file.path.display().to_string());
            fault("path", format!("cannot be {path}"), "models are GLB or OBJ files: .glb, .obj".to_owned());
        }
    }
    faults.or(())
}

/// A recipe that names the copies in its cave folder instead of its files.
pub fn kept(recipe: &Value, files: &[FileSettings], texture: &TextureSettings) -> Value {
    let mut kept = recipe.clone();
    for (place, file) in files.iter().enumerate() {
        kept["things"]["files"][place]["path"] = json!(file.kept_path());
    }
    if texture.own.is_some() {
        kept["texture"]["own"] = json!(KEPT_MAPS);
    }
    kept
}

//! The things of a scene as ground truth: `instances.json`, a JSON object with one thing a line.

use serde_json::{Value, json};

use crate::Target;
use crate::error::ExportError;
use crate::manifest::{Count, ThingsEntry};
use crate::package::Package;
use crate::scene::{Instance, Scene};

/// Name of the file.
pub const INSTANCES: &str = "instances.json";

/// Writes the file, if the scene has things, and counts them: those that the package of `target` has as parts of the static world
/// are not movable. Only those of one chunk are in memory.
///
/// # Errors
/// If the things of a chunk cannot be read; those of the package.
pub fn write(target: &dyn Target, scene: &Scene, out: &mut dyn Package) -> Result<Option<ThingsEntry>, ExportError> {
    let Some(first) = first_with_things(scene)? else {
        return Ok(None);
    };
    let mut count = Count::default();
    out.write(INSTANCES, |file| {
        let (generator, frame) = (json!(scene.generator), json!("right-handed, Z up, metres"));
        writeln!(file, r#"{{"generator": {generator}, "frame": {frame}, "things": ["#)?;
        let mut separator = "";
        for index in first..scene.chunks.len() {
            for thing in scene.instances(index)? {
                count.add(&thing.class, &thing.prototype);
                let movable = thing.movable && target.moves_things();
                write!(file, "{separator}{}", entry(&Instance { movable, ..thing }))?;
                separator = ",\n";
            }
        }
        Ok(writeln!(file, "\n]}}")?)
    })?;
    Ok(count.finish())
}

fn first_with_things(scene: &Scene) -> Result<Option<usize>, ExportError> {
    for index in 0..scene.chunks.len() {
        if !scene.instances(index)?.is_empty() {
            return Ok(Some(index));
        }
    }
    Ok(None)
}

/// Counts things of the file, without those that lack a class or a prototype; `None` if there are none.
pub(crate) fn count(things: &[Value]) -> Option<ThingsEntry> {
    let mut count = Count::default();
    for thing in things {
        if let (Some(class), Some(prototype)) = (thing["class"].as_str(), thing["prototype"].as_str()) {
            count.add(class, prototype);
        }
    }
    count.finish()
}

/// How many things of a scene move when they are pushed.
///
/// # Errors
/// If the things of a chunk cannot be read.
pub(crate) fn movable(scene: &Scene) -> Result<usize, ExportError> {
    let mut count = 0;
    for index in 0..scene.chunks.len() {
        count += scene.instances(index)?.iter().filter(|thing| thing.movable).count();
    }
    Ok(count)
}

/// The things of a scene as JSON objects.
///
/// # Errors
/// If the things of a chunk cannot be read.
pub fn list(scene: &Scene) -> Result<Vec<Value>, ExportError> {
    let mut things = Vec::new();
    for index in 0..scene.chunks.len() {
        things.extend(scene.instances(index)?.iter().map(entry));
    }
    Ok(things)
}

fn entry(thing: &Instance) -> Value {
    let turn = thing.pose.rotation.quaternion();
    json!({
        "id": format!("{:016x}", thing.id),
        "class": thing.class,
        "prototype": thing.prototype,
        "chunk": thing.chunk,
        "position": thing.pose.translation.vector.as_slice(),
        "orientation_wxyz": [turn.w, turn.i, turn.j, turn.k],
        "scale": thing.scale,
        "mass_kg": thing.mass_kg,
        "embedding_m": thing.embedding_m,
        "movable": thing.movable,
    })
}

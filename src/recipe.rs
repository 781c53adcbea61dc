//! The recipe: what a cave is made from.
//!
//! A recipe is TOML with a default for every key. It is checked against the JSON Schema of the settings structs next to the
//! code that uses them, so one doc comment and one range serve the reader, the editor and `plume new`.

mod check;
mod fault;
mod files;
mod output;
mod print;
mod read;
mod schema;
mod setting;
mod world;

use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

pub use self::check::did_you_mean;
pub use self::fault::{Fault, Faults, Origin};
pub use self::output::OutputSettings;
pub use self::read::MAX_BYTES;
pub use self::schema::{SCHEMA_ADDRESS, editor_schema};
pub use self::setting::{Setting, settings_of};
pub use self::world::WorldSettings;
use crate::field::PassageSettings;
use crate::material::{Look, MATERIALS, Material};
use crate::mesh::{MeshSettings, PieceSettings};
use crate::preset::Preset;
use crate::texture::{LodSettings, TextureSettings};
use crate::things::{Kinds, ThingSettings};
use plume_graph::Generator;
use plume_graph::realism::RealismSettings;

/// A complete recipe: every key has a value, every value is in range.
///
/// It is immutable: fingerprints, cave folders and packages follow from its text, and settings that differ from the text
/// would describe another cave. [`Recipe::with`] makes a changed copy.
///
/// ```
/// use plume::recipe::Recipe;
///
/// let recipe = Recipe::from_overrides(&["graph.nodes=12".to_owned()])?;
/// let coarse = recipe.with("mesh.voxel_m", 0.5)?;
/// assert_eq!((recipe.mesh().voxel_m, coarse.mesh().voxel_m), (0.12, 0.5));
/// assert_eq!(coarse.to_json()["mesh"]["voxel_m"], 0.5);
/// # Ok::<(), plume::recipe::Faults>(())
/// ```
///
/// ```compile_fail
/// let mut recipe = plume::recipe::Recipe::from_overrides(&[]).unwrap();
/// recipe.mesh.voxel_m = 0.5;
/// ```
#[derive(Debug)]
pub struct Recipe {
    name: String,
    seed: u64,
    graph: Box<dyn Generator>,
    realism: RealismSettings,
    passage: PassageSettings,
    rock: Arc<dyn Material>,
    look: Look,
    mesh: MeshSettings,
    things: ThingSettings,
    texture: TextureSettings,
    lod: LodSettings,
    pieces: PieceSettings,
    world: WorldSettings,
    output: OutputSettings,
    resolved: Value,
    /// The same, with paths as they are from the current folder.
    placed: Value,
    /// What it was read from.
    draft: read::Draft,
}

impl Recipe {
    /// Reads TOML. `file` names it in faults; `overrides` are `key=value` pairs that take precedence.
    ///
    /// # Errors
    /// Every fault found, each with its line, key and hint.
    pub fn from_toml(text: &str, file: &Path, overrides: &[String]) -> Result<Self, Faults> {
        let mut draft = read::toml(text, file)?;
        read::overrides(&mut draft, overrides)?;
        Self::from_draft(draft)
    }

    /// Reads a preset as [`Recipe::from_base`] does.
    ///
    /// # Errors
    /// Faults of the overrides.
    pub fn from_preset(preset: &Preset, overrides: &[String]) -> Result<Self, Faults> {
        Self::from_base(preset.text, Path::new(preset.name), overrides)
    }

    /// Reads TOML to start from. Where `overrides` choose another generator or rock than it does, its section starts from the
    /// defaults of that one, since its keys are those of another.
    ///
    /// # Errors
    /// As [`Recipe::from_toml`].
    pub fn from_base(text: &str, file: &Path, overrides: &[String]) -> Result<Self, Faults> {
        let mut asked = read::Draft::new(json!({}), file);
        read::overrides(&mut asked, overrides)?;
        let mut draft = read::toml(text, file)?;
        for (section, key) in [("graph", "generator"), ("rock", "kind")] {
            let choice = &asked.value[section][key];
            if !choice.is_null() && *choice != draft.value[section][key] {
                draft.forget(section);
            }
        }
        read::overrides(&mut draft, overrides)?;
        Self::from_draft(draft)
    }

    /// Reads the JSON form found in graph files.
    ///
    /// # Errors
    /// As [`Recipe::from_toml`].
    pub fn from_json(value: Value, file: &Path, overrides: &[String]) -> Result<Self, Faults> {
        let mut draft = read::Draft::new(value, file);
        read::overrides(&mut draft, overrides)?;
        Self::from_draft(draft)
    }

    /// The default recipe with `overrides`.
    ///
    /// # Errors
    /// Faults of the overrides.
    pub fn from_overrides(overrides: &[String]) -> Result<Self, Faults> {
        Self::from_json(json!({}), Path::new("default recipe"), overrides)
    }

    fn from_draft(draft: read::Draft) -> Result<Self, Faults> {
        let schema = schema::of(&draft.value);
        check::against(&schema, &draft)?;
        let resolved = schema::filled(&schema, &draft.value);
        let mut placed = resolved.clone();
        anchor(&schema, &mut placed, "", &draft)?;
        let graph = generator(&placed["graph"], &draft)?;
        let rock = rock(&placed["rock"], &draft)?;
        let things: ThingSettings = typed(&placed, "things", &draft)?;
        files::check(&things.files, &draft)?;
        Ok(Self {
            name: typed(&resolved, "name", &draft)?,
            seed: typed(&resolved, "seed", &draft)?,
            graph,
            realism: typed(&resolved, "realism", &draft)?,
            passage: typed(&resolved, "passage", &draft)?,
            rock,
            look: typed(&resolved, "look", &draft)?,
            mesh: typed(&resolved, "mesh", &draft)?,
            things,
            texture: typed(&placed, "texture", &draft)?,
            lod: typed(&resolved, "lod", &draft)?,
            pieces: typed(&resolved, "pieces", &draft)?,
            world: typed(&resolved, "world", &draft)?,
            output: typed(&resolved, "output", &draft)?,
            resolved,
            placed,
            draft,
        })
    }

    /// The same recipe with another value for one key, such as `mesh.voxel_m`. The key must exist for the chosen
    /// `graph.generator` or `rock.kind`.
    ///
    /// # Errors
    /// If there is no such key, or the value is out of range.
    pub fn with(&self, key: &str, value: impl Serialize) -> Result<Self, Faults> {
        let mut draft = self.draft.clone();
        let value = serde_json::to_value(value).map_err(|error| draft.fault(key, error.to_string()))?;
        let pair = format!("{key}={value}");
        read::set(&mut draft, key, value, &pair)?;
        Self::from_draft(draft)
    }

    /// Name of the cave and of what is made from it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The seed of everything random.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// What lays out the passages.
    pub fn graph(&self) -> &dyn Generator {
        &*self.graph
    }

    /// Whether the graph has to resemble those of real caves.
    pub fn realism(&self) -> &RealismSettings {
        &self.realism
    }

    /// Width and height of the passages.
    pub fn passage(&self) -> &PassageSettings {
        &self.passage
    }

    /// The version of what makes walls and images: that of Plume, and the revision of the rock if it has one.
    pub fn version(&self) -> String {
        let row = MATERIALS.find(self.rock_name());
        match row.map_or(0, |row| row.revision) {
            0 => crate::VERSION.to_owned(),
            revision => format!("{} revision {revision}", crate::VERSION),
        }
    }

    /// Shape of the rock.
    pub fn rock(&self) -> &Arc<dyn Material> {
        &self.rock
    }

    /// Colour and wetness of the rock.
    pub fn look(&self) -> &Look {
        &self.look
    }

    /// Mesh settings.
    pub fn mesh(&self) -> &MeshSettings {
        &self.mesh
    }

    /// Stones and dripstone.
    pub fn things(&self) -> &ThingSettings {
        &self.things
    }

    /// Name of the rock.
    pub fn rock_name(&self) -> &str {
        self.resolved["rock"]["kind"].as_str().unwrap_or_default()
    }

    /// The kinds of things that occur.
    pub fn kinds(&self) -> Kinds<'_> {
        Kinds { rock: self.rock_name(), has_artefacts: self.things.artefacts > 0, files: &self.things.files }
    }

    /// Texture settings.
    pub fn texture(&self) -> &TextureSettings {
        &self.texture
    }

    /// Levels of detail.
    pub fn lod(&self) -> &LodSettings {
        &self.lod
    }

    /// Convex pieces for collision.
    pub fn pieces(&self) -> &PieceSettings {
        &self.pieces
    }

    /// Light, friction, gravity.
    pub fn world(&self) -> &WorldSettings {
        &self.world
    }

    /// Limits on what is written.
    pub fn output(&self) -> &OutputSettings {
        &self.output
    }

    /// The range of a number, such as that of `mesh.voxel_m`, for the chosen generator and rock; `None` if there is no such number.
    pub fn range(&self, key: &str) -> Option<RangeInclusive<f64>> {
        let (section, name) = key.split_once('.')?;
        let schema = &schema::of(&self.resolved)["properties"][section]["properties"][name];
        let is_number = ["integer", "number"].iter().any(|kind| schema["type"] == *kind);
        let end = |name: &str, without: f64| schema[name].as_f64().unwrap_or(without);
        is_number.then(|| end("minimum", f64::NEG_INFINITY)..=end("maximum", f64::INFINITY))
    }

    /// The recipe as commented TOML that reads back as itself.
    pub fn to_toml(&self) -> String {
        print::commented(&schema::of(&self.resolved), &self.resolved)
    }

    /// That with paths as they are from the current folder, for a recipe that is to be kept there.
    pub fn to_placed_toml(&self) -> String {
        print::commented(&schema::of(&self.placed), &self.placed)
    }

    /// The recipe as JSON that names files of models and maps as a cave folder keeps them: the same wherever they came from.
    pub fn to_kept_json(&self) -> Value {
        files::kept(&self.resolved, &self.things.files, &self.texture)
    }

    /// That as commented TOML.
    pub fn to_portable_toml(&self) -> String {
        let kept = self.to_kept_json();
        print::commented(&schema::of(&kept), &kept)
    }

    /// The recipe as stored in a cave folder: with a last line that proves it is complete.
    pub fn to_kept_toml(&self) -> String {
        format!("{}\n{LAST_LINE}\n", self.to_portable_toml())
    }

    /// Reads the recipe of a cave folder, which may be edited but must have every key and its last line: a truncated one
    /// would make another cave.
    ///
    /// # Errors
    /// As [`Recipe::from_toml`]; if a key or the last line is missing.
    pub fn from_kept_toml(text: &str, file: &Path) -> Result<Self, Faults> {
        if text.trim_end().lines().next_back() != Some(LAST_LINE) {
            return Err(incomplete(file, "is truncated: its last line is missing".to_owned()));
        }
        let recipe = Self::from_toml(text, file, &[])?;
        match missing_key("", &recipe.resolved, &read::toml(text, file)?.value) {
            Some(key) => Err(incomplete(file, format!("is incomplete: {key} is missing"))),
            None => Ok(recipe),
        }
    }

    /// The recipe as JSON, every key with its value.
    pub fn to_json(&self) -> &Value {
        &self.resolved
    }
}

/// The differences from `before` to `now`, key by key: `graph.nodes: 8 → 9`.
pub fn differences(before: &Value, now: &Value) -> Vec<String> {
    let mut found = Vec::new();
    collect_differences("", before, now, &mut found);
    found
}

fn collect_differences(path: &str, before: &Value, now: &Value, found: &mut Vec<String>) {
    match (before, now) {
        (Value::Object(old), Value::Object(new)) => {
            let keys = old.keys().chain(new.keys().filter(|key| !old.contains_key(*key)));
            for key in keys {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                collect_differences(&path, &before[key], &now[key], found);
            }
        }
        _ if before != now => found.push(format!("{path}: {before} → {now}")),
        _ => {}
    }
}

/// The last line of the recipe of a cave folder.
const LAST_LINE: &str = "# End of the recipe: keep this line.";

fn incomplete(file: &Path, message: String) -> Faults {
    let hint = format!("`plume new` prints every key; the last line of a cave folder's recipe is {LAST_LINE:?}");
    Fault { origin: Origin::File(file.to_path_buf()), message, hint }.into()
}

/// The first key of `whole` that is missing in `part`. Keys without a value and empty lists may be missing.
fn missing_key(path: &str, whole: &Value, part: &Value) -> Option<String> {
    let keys = whole.as_object()?.iter().filter(|(_, value)| !value.is_null() && **value != json!([]));
    keys.map(|(key, value)| (if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, value, &part[key]))
        .find_map(|(path, value, part)| if part.is_null() { Some(path) } else { missing_key(&path, value, part) })
}

/// Settings from `key=value` pairs alone, checked against their schema and completed with defaults.
///
/// # Errors
/// Every fault found.
pub fn options(schema: &Value, pairs: &[String]) -> Result<Value, Faults> {
    let schema = schema::plain(schema.clone());
    let mut draft = read::Draft::new(json!({}), Path::new("options"));
    read::overrides(&mut draft, pairs)?;
    check::against(&schema, &draft)?;
    Ok(schema::filled(&schema, &draft.value))
}

/// Settings in a TOML file of their own, checked against their schema and completed with defaults.
///
/// # Errors
/// Every fault found.
pub fn from_toml<T: DeserializeOwned + JsonSchema>(text: &str, file: &Path) -> Result<T, Faults> {
    let schema = schema::schema_of::<T>();
    let draft = read::toml(text, file)?;
    check::against(&schema, &draft)?;
    serde_json::from_value(schema::filled(&schema, &draft.value))
        .map_err(|error| draft.fault("file", error.to_string()))
}

/// A fault of a key in a TOML file that no schema can express.
pub fn fault_in(text: &str, file: &Path, key: &str, message: &str) -> Faults {
    match read::toml(text, file) {
        Ok(draft) => draft.fault(key, message.to_owned()),
        Err(faults) => faults,
    }
}

/// Whether a TOML file has a key at its top.
///
/// # Errors
/// If it is not TOML.
pub fn has_key(text: &str, file: &Path, key: &str) -> Result<bool, Faults> {
    Ok(!read::toml(text, file)?.value[key].is_null())
}

fn generator(section: &Value, draft: &read::Draft) -> Result<Box<dyn Generator>, Faults> {
    let (name, settings) = split_choice(section, "generator");
    let row = plume_generators::GENERATORS.find(name).expect("the schema admits only rows of the table");
    (row.read)(Value::Object(settings)).map_err(|e| draft.fault("graph", e.to_string()))
}

/// Resolves the paths in settings relative to the recipe.
fn anchor(schema: &Value, settings: &mut Value, key: &str, draft: &read::Draft) -> Result<(), Faults> {
    let schema = schema::chosen(schema, settings);
    match settings {
        Value::String(path) if schema["format"] == "path" => *path = draft.beside(key, path)?,
        Value::Array(items) => {
            for (place, item) in items.iter_mut().enumerate() {
                anchor(&schema["items"], item, &format!("{key}[{place}]"), draft)?;
            }
        }
        Value::Object(map) => {
            for (name, setting) in map {
                anchor(&schema["properties"][name], setting, &check::below(key, name), draft)?;
            }
        }
        _ => {}
    }
    Ok(())
}

fn rock(section: &Value, draft: &read::Draft) -> Result<Arc<dyn Material>, Faults> {
    let (name, settings) = split_choice(section, "kind");
    let row = MATERIALS.find(name).expect("the schema admits only rows of the table");
    (row.read)(Value::Object(settings)).map_err(|e| draft.fault("rock", e.to_string()))
}

/// Splits `{kind: "a", …settings}` into the chosen row's name and its settings.
fn split_choice<'a>(section: &'a Value, key: &str) -> (&'a str, Map<String, Value>) {
    let mut settings = section.as_object().cloned().unwrap_or_default();
    settings.remove(key);
    (section[key].as_str().unwrap_or_default(), settings)
}

fn typed<T: DeserializeOwned>(all: &Value, key: &str, draft: &read::Draft) -> Result<T, Faults> {
    serde_json::from_value(all[key].clone()).map_err(|e| draft.fault(key, e.to_string()))
}

//! The JSON Schema of recipes, assembled from the tables of generators and rocks.

use plume_registry::settings_schema;
use schemars::JsonSchema;
use serde_json::{Map, Value, json};

use super::{OutputSettings, WorldSettings};
use crate::field::PassageSettings;
use crate::material::{Look, MATERIALS};
use crate::mesh::{MeshSettings, PieceSettings};
use crate::texture::{LodSettings, TextureSettings};
use crate::things::ThingSettings;
use plume_generators::GENERATORS;
use plume_graph::realism::RealismSettings;

/// Where the schema of this version is published: in the repository, under the tag of the version.
pub const SCHEMA_ADDRESS: &str =
    concat!(env!("CARGO_PKG_REPOSITORY"), "/raw/v", env!("CARGO_PKG_VERSION"), "/docs/recipe.schema.json");

/// The format of a string that becomes a file or folder name.
pub const FILE_NAME: &str = "file-name";

/// The schema for this recipe: with the settings of its generator and rock, or of the default ones.
pub fn of(recipe: &Value) -> Value {
    let generator = recipe["graph"]["generator"].as_str().unwrap_or(GENERATORS.default_row().name);
    let kind = recipe["rock"]["kind"].as_str().unwrap_or(MATERIALS.default_row().name);
    let row = GENERATORS.find(generator).unwrap_or_else(|| GENERATORS.default_row());
    let settings = plain((row.schema)().to_value());
    let graph =
        choice("generator", &GENERATORS.names_for(generator), "The algorithm that lays out the passages.", settings);
    let rock_row = MATERIALS.find(kind).unwrap_or_else(|| MATERIALS.default_row());
    let rock = choice("kind", &MATERIALS.names_for(kind), "The kind of rock.", plain((rock_row.schema)().to_value()));
    whole(graph, rock)
}

/// One schema for every choice, for editors.
pub fn editor_schema() -> Value {
    let generators = generator_names();
    let rocks = rock_names();
    let graph_of = |name: &&str| of(&json!({"graph": {"generator": name}}))["properties"]["graph"].clone();
    let rock_of = |name: &&str| of(&json!({"rock": {"kind": name}}))["properties"]["rock"].clone();
    let graph = union("generator", only(generators.iter().map(graph_of), "generator", &generators));
    let rock = union("kind", only(rocks.iter().map(rock_of), "kind", &rocks));
    let mut schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": SCHEMA_ADDRESS,
        "title": "Plume recipe",
    });
    let whole = whole(graph, rock);
    whole.as_object().into_iter().flatten().for_each(|(key, value)| schema[key] = value.clone());
    schema
}

/// Variants that differ by the value of a key. Editors that know discriminators report faults of the chosen variant only.
fn union(key: &str, variants: Vec<Value>) -> Value {
    json!({"discriminator": {"propertyName": key}, "oneOf": variants})
}

/// Fixes the choice of each variant to its own name; the first, being the default, may be omitted.
fn only(variants: impl Iterator<Item = Value>, key: &str, names: &[&str]) -> Vec<Value> {
    let pin = |(i, mut variant): (usize, Value)| {
        variant["title"] = json!(format!("{key} = \"{}\"", names[i]));
        variant["properties"][key]["enum"] = json!([names[i]]);
        variant["properties"][key]["default"] = json!(names[i]);
        if i > 0 {
            variant["required"] = json!([key]);
        }
        variant
    };
    variants.enumerate().map(pin).collect()
}

fn generator_names() -> Vec<&'static str> {
    GENERATORS.iter().map(|row| row.name).collect()
}

fn rock_names() -> Vec<&'static str> {
    MATERIALS.iter().map(|row| row.name).collect()
}

fn whole(graph: Value, rock: Value) -> Value {
    let name = json!({
        "type": "string", "format": FILE_NAME, "default": "cave", "pattern": "^[a-z][a-z0-9_-]*$", "maxLength": 60,
        "description": "Name of the cave and of every model made from it: lower-case letters, digits, - and _."
    });
    let seed = json!({
        "type": "integer", "default": 7, "minimum": 0, "maximum": i64::MAX,
        "description": "Seed of everything random: the same recipe, seed and version give the same bytes."
    });
    json!({
        "type": "object",
        "additionalProperties": false,
        "properties": {
            "name": name,
            "seed": seed,
            "graph": graph,
            "realism": schema_of::<RealismSettings>(),
            "passage": schema_of::<PassageSettings>(),
            "rock": rock,
            "look": schema_of::<Look>(),
            "mesh": schema_of::<MeshSettings>(),
            "things": schema_of::<ThingSettings>(),
            "texture": schema_of::<TextureSettings>(),
            "lod": schema_of::<LodSettings>(),
            "pieces": schema_of::<PieceSettings>(),
            "world": schema_of::<WorldSettings>(),
            "output": schema_of::<OutputSettings>(),
        }
    })
}

/// Schema of a settings struct, without references.
pub fn schema_of<T: JsonSchema>() -> Value {
    plain(settings_schema::<T>().to_value())
}

/// Replaces numbers that passed through `f32` (0.20000000298) by the intended decimal (0.2).
pub fn plain(value: Value) -> Value {
    match value {
        Value::Number(n) if n.is_f64() => {
            let x = n.as_f64().unwrap_or_default();
            let narrow = x as f32;
            let meant = if f64::from(narrow) == x { narrow.to_string().parse().unwrap_or(x) } else { x };
            json!(meant)
        }
        Value::Array(items) => items.into_iter().map(plain).collect(),
        Value::Object(map) => map.into_iter().map(|(k, v)| (k, plain(v))).collect(),
        other => other,
    }
}

/// Puts the key that chooses a row before the row's own settings.
fn choice(key: &str, names: &[&str], about: &str, settings: Value) -> Value {
    let selector = json!({"type": "string", "enum": names, "default": names[0], "description": about});
    let mut properties = Map::new();
    properties.insert(key.to_owned(), selector);
    if let Some(own) = settings["properties"].as_object() {
        properties.extend(own.clone());
    }
    let mut schema = settings;
    schema["properties"] = Value::Object(properties);
    schema["additionalProperties"] = json!(false);
    schema
}

/// The variant that a value selects by its discriminating key, or else the first; a schema without variants is returned
/// as it is.
pub fn chosen<'a>(schema: &'a Value, value: &Value) -> &'a Value {
    let Some(key) = choosing_key(schema) else { return schema };
    let variants = schema["oneOf"].as_array().map_or(&[][..], Vec::as_slice);
    let is_chosen = |variant: &&Value| variant["properties"][key]["default"] == value[key];
    variants.iter().find(is_chosen).or(variants.first()).unwrap_or(schema)
}

/// The discriminating key of a schema, if it has variants with different keys.
pub fn choosing_key(schema: &Value) -> Option<&str> {
    schema["discriminator"]["propertyName"].as_str()
}

/// `value` completed with defaults, in the order of the schema.
pub fn filled(schema: &Value, value: &Value) -> Value {
    let schema = chosen(schema, value);
    let Some(properties) = schema["properties"].as_object() else {
        let value = if value.is_null() { &schema["default"] } else { value };
        let items = value.as_array().filter(|_| schema["items"].is_object());
        return items
            .map_or_else(|| value.clone(), |items| items.iter().map(|item| filled(&schema["items"], item)).collect());
    };
    let fill = |(key, schema): (&String, &Value)| (key.clone(), filled(schema, &value[key]));
    Value::Object(properties.iter().map(fill).collect())
}

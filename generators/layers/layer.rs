//! One layer: a generator, its settings, and the position of its graph.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::super::{GENERATORS, GenerateError, Generator, GeneratorRow};
use super::NAME;
use plume_graph::echo::{sentence, shown};

/// A layer of the stack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Its generator: any except `layers`.
    #[serde(default = "first")]
    pub generator: String,
    /// Depth of its origin below that of the first layer, in metres; by default right below the layer above.
    #[serde(default)]
    pub depth_m: Option<f64>,
    /// Offset of its middle east of the middle of the first layer, in metres.
    #[serde(default)]
    pub east_m: f64,
    /// Offset to the north, in metres.
    #[serde(default)]
    pub north_m: f64,
    /// The settings of its generator.
    #[serde(flatten)]
    pub settings: Map<String, Value>,
}

impl Default for Layer {
    fn default() -> Self {
        Self { generator: first(), depth_m: None, east_m: 0.0, north_m: 0.0, settings: Map::new() }
    }
}

impl Layer {
    /// The generator with its settings.
    pub(super) fn generator(&self) -> Result<Box<dyn Generator>, GenerateError> {
        let Some(row) = rows().find(|row| row.name == self.generator) else {
            let known: Vec<&str> = rows().map(|row| row.name).collect();
            let hint = format!("known: {}", known.join(", "));
            return Err(GenerateError::new(format!("`generator` cannot be {}", shown(&self.generator)), hint));
        };
        let told = |error: serde_json::Error| {
            GenerateError::new(sentence(&error.to_string()), "see `plume schema` for its keys")
        };
        (row.read)(Value::Object(self.settings.clone())).map_err(told)
    }
}

/// Generators for layers.
fn rows() -> impl Iterator<Item = &'static GeneratorRow> {
    GENERATORS.iter().filter(|row| row.name != NAME)
}

fn first() -> String {
    GENERATORS.default_row().name.to_owned()
}

/// One variant per generator, selected by `generator`, which may be omitted for the first.
impl JsonSchema for Layer {
    fn schema_name() -> Cow<'static, str> {
        "Layer".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let variants: Vec<Value> = rows().enumerate().map(|(place, row)| variant(row, place == 0)).collect();
        json_schema!({ "oneOf": variants, "discriminator": { "propertyName": "generator" } })
    }

    fn inline_schema() -> bool {
        true
    }
}

fn variant(row: &GeneratorRow, is_first: bool) -> Value {
    let mut schema = (row.schema)().to_value();
    let mut properties = Map::new();
    properties.insert(
        "generator".into(),
        json!({
            "type": "string", "enum": [row.name], "default": row.name,
            "description": "The algorithm that lays out the passages of this layer: any generator except `layers`."
        }),
    );
    properties.insert("depth_m".into(), json!({
        "type": ["number", "null"], "default": null, "minimum": 0.0, "maximum": 10_000.0,
        "description": "Depth of the layer's origin below that of the first layer, in metres; by default, the layer \
        is as close below the one above as the rock between them allows."
    }));
    let aside = |about: &str| {
        json!({
            "type": "number", "default": 0.0, "minimum": -10_000.0, "maximum": 10_000.0, "description": about
        })
    };
    let east = "Offset of the middle of this layer east of the middle of the first one, in metres.";
    properties.insert("east_m".into(), aside(east));
    properties.insert("north_m".into(), aside("Offset to the north, in metres."));
    if let Some(own) = schema["properties"].as_object() {
        properties.extend(own.clone());
    }
    schema["properties"] = Value::Object(properties);
    if let Some(schema) = schema.as_object_mut() {
        schema.remove("$schema");
    }
    if !is_first {
        schema["required"] = json!(["generator"]);
    }
    schema
}

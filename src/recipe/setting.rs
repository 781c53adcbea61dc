//! Settings as lists show them.

use serde_json::Value;

use super::check::{type_name, unwrap_optional, words};
use super::print::literal;
use super::schema::plain;

/// A setting of a target, as `plume list options` and the documentation show it.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Its key.
    pub key: String,
    /// What it does.
    pub meaning: String,
    /// The values that it takes, such as `0.0 to 1.0`.
    pub range: String,
    /// Its value unless set; null if it has none.
    pub default: Value,
}

impl Setting {
    /// The default as it is written in a recipe; `none` if there is none.
    pub fn default_text(&self) -> String {
        literal(&self.default).unwrap_or_else(|| "none".to_owned())
    }
}

/// The settings that a schema describes, in its order.
pub fn settings_of(schema: &Value) -> Vec<Setting> {
    let schema = plain(schema.clone());
    let properties = schema["properties"].as_object();
    properties.into_iter().flatten().map(|(key, schema)| setting(key, schema)).collect()
}

fn setting(key: &str, schema: &Value) -> Setting {
    let meaning = schema["description"].as_str().unwrap_or_default();
    Setting {
        key: key.to_owned(),
        meaning: meaning.split_whitespace().collect::<Vec<_>>().join(" "),
        range: range(schema),
        default: schema["default"].clone(),
    }
}

fn range(schema: &Value) -> String {
    let (schema, _) = unwrap_optional(schema);
    if let Some(words) = words(schema) {
        return words.join(", ");
    }
    match type_name(schema) {
        "boolean" => "true, false".to_owned(),
        "integer" | "number" => numbers(schema),
        "array" => format!("list of: {}", range(&schema["items"])),
        "object" => "section".to_owned(),
        _ => "text".to_owned(),
    }
}

fn numbers(schema: &Value) -> String {
    match (literal(&schema["minimum"]), literal(&schema["maximum"])) {
        (Some(low), Some(high)) => format!("{low} to {high}"),
        (Some(low), None) => format!("at least {low}"),
        (None, Some(high)) => format!("at most {high}"),
        (None, None) => "number".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::settings_of;

    #[test]
    fn ranges_are_put_into_words() {
        let schema = json!({"properties": {
            "lights": {"type": "boolean", "description": "Include\nlights.", "default": true},
            "ambient": {"type": "number", "minimum": 0.0, "maximum": 1.0, "default": 0.1},
            "collision": {"oneOf": [{"const": "triangles"}, {"const": "pieces"}], "default": "triangles"},
            "robot": {"type": ["string", "null"], "default": null},
            "levels": {"type": "array", "items": {"type": "integer", "minimum": 1}},
        }});
        let settings = settings_of(&schema);
        let said = |key: &str| {
            let setting = settings.iter().find(|setting| setting.key == key).unwrap();
            format!("{} [{}] {}", setting.meaning, setting.range, setting.default_text())
        };
        assert_eq!(said("lights"), "Include lights. [true, false] true");
        assert_eq!(said("ambient"), " [0.0 to 1.0] 0.1");
        assert_eq!(said("collision"), " [triangles, pieces] \"triangles\"");
        assert_eq!(said("robot"), " [text] none");
        assert_eq!(said("levels"), " [list of: at least 1] none");
    }
}

//! The recipe reference: the JSON Schema of recipes as tables.

use serde_json::{Map, Value};

use crate::strips::SETTINGS;
use crate::tools::Result;

/// A table for each section of recipes, and for each generator and rock.
pub fn tables(schema: &str) -> Result<String> {
    let schema: Value = serde_json::from_str(schema).map_err(|error| format!("the schema of recipes: {error}"))?;
    let keys = schema["properties"].as_object().ok_or("the schema of recipes has no `properties`")?;
    let (sections, single): (Vec<_>, Vec<_>) = keys.iter().partition(|(_, value)| is_section(value));
    let single: Map<String, Value> = single.into_iter().map(|(key, value)| (key.clone(), value.clone())).collect();
    let top = format!("### Before all sections\n\n{}", table(&single, &schema));
    let sections = sections.into_iter().map(|(name, section)| of_section(name, section));
    Ok(std::iter::once(top).chain(sections).collect::<Vec<_>>().join("\n"))
}

fn is_section(value: &Value) -> bool {
    value.get("properties").is_some() || value.get("oneOf").is_some()
}

fn of_section(name: &str, section: &Value) -> String {
    let heading = format!("### `[{name}]`\n\n");
    let Some(alternatives) = section["oneOf"].as_array() else {
        return heading + &keys_of(section) + &pictures(name, None);
    };
    let (chooser, usual) = alternatives.first().and_then(choice).unwrap_or_default();
    let tables = alternatives.iter().map(|alternative| {
        let (_, value) = choice(alternative).unwrap_or_default();
        format!("#### `{value}`\n\n{}{}", keys_of(alternative), pictures(name, Some(value)))
    });
    let tables = tables.collect::<Vec<_>>().join("\n");
    format!("{heading}The keys depend on `{chooser}`, which is `\"{usual}\"` by default.\n\n{tables}")
}

/// What the settings of a section change, as far as that can be seen; `rock` is the kind whose settings they are.
fn pictures(section: &str, rock: Option<&str>) -> String {
    let is_here = |key: &str, of: &str| key.split('.').next() == Some(section) && rock.is_none_or(|rock| rock == of);
    let here = SETTINGS.iter().filter(|(key, _, [of, _])| is_here(key, of));
    let shown = here.map(|(key, values, _)| {
        let (_, name) = key.split_once('.').unwrap_or(("", key));
        format!("\n`{name}` = {}:\n\n![](pictures/{key}.jpg)\n", values.join(", "))
    });
    shown.collect()
}

/// The key that tells alternatives apart, with its value.
fn choice(alternative: &Value) -> Option<(&str, &str)> {
    let keys = alternative["properties"].as_object()?;
    keys.iter().find_map(|(key, value)| Some((key.as_str(), only(value)?)))
}

/// The only value that a key allows.
fn only(value: &Value) -> Option<&str> {
    match value["enum"].as_array()?.as_slice() {
        [only] => only.as_str(),
        _ => None,
    }
}

fn keys_of(section: &Value) -> String {
    section["properties"].as_object().map(|keys| table(keys, section)).unwrap_or_default()
}

fn table(keys: &Map<String, Value>, of: &Value) -> String {
    let keys = keys.iter().filter(|(_, value)| only(value).is_none());
    let rows = keys.flat_map(|(key, value)| rows(key, &resolved(value, of), of)).collect::<String>();
    format!("| key | meaning | range | default |\n|---|---|---|---|\n{rows}")
}

/// The row of a key, and those of the table that it is or of the tables that it lists.
fn rows(key: &str, value: &Value, of: &Value) -> Vec<String> {
    let cells = [format!("`{key}`"), one_line(&value["description"]), range(value), default(value)];
    let inner = [("", value), ("[]", &value["items"])].into_iter().flat_map(|(suffix, table)| {
        let keys = table["properties"].as_object().into_iter().flatten();
        keys.flat_map(move |(inner, value)| rows(&format!("{key}{suffix}.{inner}"), &resolved(value, of), of))
    });
    std::iter::once(format!("| {} |\n", cells.join(" | "))).chain(inner).collect()
}

/// The value together with what its `$ref` stands for.
fn resolved(value: &Value, of: &Value) -> Value {
    let path = value["$ref"].as_str().and_then(|path| path.strip_prefix('#'));
    let meant = path.and_then(|path| of.pointer(path)).and_then(Value::as_object);
    let own = value.as_object().into_iter().flatten();
    let all = meant.into_iter().flatten().chain(own).map(|(key, value)| (key.clone(), value.clone()));
    Value::Object(all.collect())
}

fn one_line(text: &Value) -> String {
    let words: Vec<&str> = text.as_str().unwrap_or_default().split_whitespace().collect();
    words.join(" ").replace('|', "\\|")
}

fn range(value: &Value) -> String {
    let named = value["oneOf"].as_array().into_iter().flatten().map(|one| &one["const"]);
    let names: Vec<String> = named.chain(value["enum"].as_array().into_iter().flatten()).map(code).collect();
    if !names.is_empty() {
        return names.join(", ");
    }
    if let (Some(low), Some(high)) = (value.get("minimum"), value.get("maximum")) {
        return format!("{} to {}", plain(low), plain(high));
    }
    match kind(value) {
        "boolean" => "`true`, `false`".to_owned(),
        "array" => list(value),
        "object" => "a table".to_owned(),
        "string" if value["format"] == "path" => "a path".to_owned(),
        _ => "text".to_owned(),
    }
}

fn list(value: &Value) -> String {
    let items = &value["items"];
    if kind(items) == "object" || items.get("oneOf").is_some() {
        return "tables".to_owned();
    }
    match (value["minItems"].as_u64(), value["maxItems"].as_u64()) {
        (Some(least), Some(most)) if least == most => format!("{most} numbers, each {}", range(items)),
        _ => format!("a list of {}", range(items)),
    }
}

/// The type; that of an optional key is the first of two.
fn kind(value: &Value) -> &str {
    let kind = &value["type"];
    kind.as_str().or_else(|| kind[0].as_str()).unwrap_or_default()
}

fn default(value: &Value) -> String {
    match value.get("default") {
        None => "required".to_owned(),
        Some(Value::Null) => "none".to_owned(),
        Some(_) if value["properties"].is_object() => "as below".to_owned(),
        Some(Value::Array(tables)) if tables.iter().any(Value::is_object) => format!("{} tables", tables.len()),
        Some(value) => code(value),
    }
}

fn code(value: &Value) -> String {
    format!("`{}`", value.to_string().replace('|', "\\|"))
}

fn plain(number: &Value) -> String {
    let text = number.to_string();
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_is_a_table_for_each_value_of_the_key_that_chooses() {
        let schema = r##"{"properties": {
            "seed": {"type": "integer", "default": 7, "minimum": 0, "maximum": 9, "description": "Seed of\nall."},
            "rock": {"oneOf": [
                {"properties": {
                    "kind": {"enum": ["salt"], "default": "salt"},
                    "bands": {"$ref": "#/$defs/Bands", "default": "a|b"}
                }, "$defs": {"Bands": {"oneOf": [{"const": "a|b"}, {"const": "c"}], "description": "How."}}}
            ]},
            "mesh": {"properties": {"chunk_m": {
                "type": "array", "items": {"type": "number", "minimum": 1.0, "maximum": 2.5}, "minItems": 3, "maxItems": 3
            }}},
            "pieces": {"properties": {"of": {"type": "object", "description": "Inner.", "default": {"n": 1}, "properties": {
                "n": {"type": "integer", "minimum": 1, "maximum": 3, "default": 1}
            }}, "free": {"type": "object", "default": {}}}}
        }}"##;
        let tables = tables(schema).expect("the schema is one");
        let rows: Vec<&str> = tables.lines().filter(|line| line.starts_with("| `") || line.starts_with('#')).collect();
        assert_eq!(
            rows,
            [
                "### Before all sections",
                "| `seed` | Seed of all. | 0 to 9 | `7` |",
                "### `[rock]`",
                "#### `salt`",
                r#"| `bands` | How. | `"a\|b"`, `"c"` | `"a\|b"` |"#,
                "### `[mesh]`",
                "| `chunk_m` |  | 3 numbers, each 1 to 2.5 | required |",
                "### `[pieces]`",
                "| `of` | Inner. | a table | as below |",
                "| `of.n` |  | 1 to 3 | `1` |",
                "| `free` |  | a table | `{}` |",
            ]
        );
    }
}

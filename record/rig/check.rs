//! Holds a value to the ranges of its schema, so that each is written once.

use serde_json::Value;

/// The first number that is out of its range, with its key.
pub fn first_fault(value: &Value, schema: &Value) -> Option<String> {
    fault("", value, schema, schema)
}

fn fault(key: &str, value: &Value, schema: &Value, root: &Value) -> Option<String> {
    if let Some(name) = schema["$ref"].as_str() {
        let of = &root["$defs"][name.rsplit('/').next()?];
        return fault(key, value, of, root);
    }
    for choices in [&schema["anyOf"], &schema["oneOf"]] {
        let fitting = choices.as_array().into_iter().flatten().find(|choice| fits(value, choice));
        if let Some(found) = fitting.and_then(|choice| fault(key, value, choice, root)) {
            return Some(found);
        }
    }
    match value {
        Value::Object(map) => map.iter().find_map(|(name, inner)| {
            let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            fault(&key, inner, &schema["properties"][name], root)
        }),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .find_map(|(number, item)| fault(&format!("{key}[{number}]"), item, &schema["items"], root)),
        Value::Number(number) => {
            let number = number.as_f64()?;
            let [low, high] = ["minimum", "maximum"].map(|bound| schema[bound].as_f64());
            let is_within = low.is_none_or(|low| number >= low) && high.is_none_or(|high| number <= high);
            (!is_within).then(|| format!("{key}: {number} is not from {} to {}", shown(low), shown(high)))
        }
        // JSON has no infinite numbers.
        Value::Null if schema["type"] == "number" => Some(format!("{key}: is not a finite number")),
        _ => None,
    }
}

/// Whether a value is of the variant of a schema that its tag names.
fn fits(value: &Value, choice: &Value) -> bool {
    let Some(properties) = choice["properties"].as_object() else { return !value.is_null() };
    properties.iter().all(|(name, of)| of["const"].is_null() || of["const"] == value[name])
}

fn shown(bound: Option<f64>) -> String {
    bound.map_or_else(|| "any".to_owned(), |bound| bound.to_string())
}

/// The names of all keys.
#[cfg(test)]
pub fn keys(schema: &Value) -> std::collections::BTreeSet<String> {
    let own = schema["properties"].as_object().into_iter().flatten().map(|(name, _)| name.clone());
    let inner: Vec<&Value> = match schema {
        Value::Object(map) => map.values().collect(),
        Value::Array(items) => items.iter().collect(),
        _ => Vec::new(),
    };
    own.chain(inner.into_iter().flat_map(keys)).collect()
}

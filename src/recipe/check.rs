//! Checks a draft against a JSON Schema and explains what is wrong.
//!
//! Covers the part of JSON Schema that settings structs use: objects with known keys, numbers in ranges, strings from a list
//! or matching a pattern, booleans, arrays of limited length, `null` for optional values, and objects whose keys depend on
//! the value of one of them.

use regex_lite::Regex;
use serde_json::Value;

use super::fault::{Fault, Faults};
use super::read::Draft;
use super::schema::{FILE_NAME, choosing_key, chosen};
use plume_graph::echo::{plain, shown};

/// Checks the whole draft.
///
/// # Errors
/// All faults, in the order of the draft.
pub fn against(schema: &Value, draft: &Draft) -> Result<(), Faults> {
    let mut checker = Checker { draft, faults: Faults::default() };
    checker.check(schema, &draft.value, "");
    checker.faults.or(())
}

struct Checker<'a> {
    draft: &'a Draft,
    faults: Faults,
}

impl Checker<'_> {
    fn check(&mut self, schema: &Value, value: &Value, key: &str) {
        let (schema, optional) = unwrap_optional(schema);
        if value.is_null() && optional {
            return;
        }
        if let (Some(by), true) = (choosing_key(schema), value.is_object()) {
            return self.choice(schema, by, value, key);
        }
        if let Some(words) = words(schema) {
            return self.word(&words, value, key);
        }
        match type_name(schema) {
            "object" => self.object(schema, value, key),
            "array" => self.array(schema, value, key),
            "integer" | "number" => self.number(schema, value, key),
            "boolean" if !value.is_boolean() => self.mistyped("true or false", value, key),
            "string" => self.string(schema, value, key),
            _ => {}
        }
    }

    /// An object whose keys depend on the value of one of them.
    fn choice(&mut self, schema: &Value, by: &str, value: &Value, key: &str) {
        let variants = schema["oneOf"].as_array().into_iter().flatten();
        let names: Vec<&str> = variants.filter_map(|variant| variant["properties"][by]["default"].as_str()).collect();
        match &value[by] {
            Value::Null => {}
            Value::String(name) if names.contains(&name.as_str()) => {}
            other => return self.word(&names, other, &format!("{key}.{by}")),
        }
        self.object(chosen(schema, value), value, key);
    }

    fn object(&mut self, schema: &Value, value: &Value, key: &str) {
        let Some(map) = value.as_object() else {
            return self.mistyped("a section", value, key);
        };
        let known = &schema["properties"];
        if known.is_null() && schema["additionalProperties"] != false {
            return;
        }
        for (name, value) in map {
            let path = below(key, name);
            match known.get(name) {
                Some(schema) => self.check(schema, value, &path),
                None => self.unknown(&path, name, known),
            }
        }
        let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        for name in required.filter(|name| !map.contains_key(*name)) {
            self.fault(key, |key| (format!("{} is missing", below(key, name)), String::new()));
        }
    }

    fn array(&mut self, schema: &Value, value: &Value, key: &str) {
        let Some(items) = value.as_array() else {
            return self.mistyped("a list", value, key);
        };
        let length = items.len() as u64;
        let least = schema["minItems"].as_u64().unwrap_or(0);
        let most = schema["maxItems"].as_u64().unwrap_or(u64::MAX);
        if !(least..=most).contains(&length) {
            let want = if least == most { least.to_string() } else { format!("{least} to {most}") };
            return self.fault(key, |key| (format!("{key} must have {want} values, found {length}"), String::new()));
        }
        for (place, item) in items.iter().enumerate() {
            self.check(&schema["items"], item, &format!("{key}[{place}]"));
        }
    }

    fn number(&mut self, schema: &Value, value: &Value, key: &str) {
        let whole = type_name(schema) == "integer";
        let Some(x) = value.as_f64().filter(|_| !whole || value.is_i64() || value.is_u64()) else {
            return self.mistyped(if whole { "a whole number" } else { "a number" }, value, key);
        };
        if schema["format"] == "uint32" && value.as_u64().is_some_and(|x| x > u32::MAX.into()) {
            return self
                .fault(key, |key| (format!("{key} must be at most {}, found {value}", u32::MAX), hint_from(schema)));
        }
        let (low, high) = (schema["minimum"].as_f64(), schema["maximum"].as_f64());
        if low.is_some_and(|low| x < low) {
            return self.fault(key, |key| {
                (format!("{key} must be at least {}, found {value}", show(&schema["minimum"])), hint_from(schema))
            });
        }
        if high.is_some_and(|high| x > high) {
            self.fault(key, |key| {
                (format!("{key} must be at most {}, found {value}", show(&schema["maximum"])), hint_from(schema))
            });
        }
    }

    fn string(&mut self, schema: &Value, value: &Value, key: &str) {
        let Some(text) = value.as_str() else {
            return self.mistyped("a string in quotes", value, key);
        };
        let too_long = schema["maxLength"].as_u64().is_some_and(|max| text.chars().count() as u64 > max);
        let too_short = schema["minLength"].as_u64().is_some_and(|min| (text.chars().count() as u64) < min);
        let is_unlike = schema["pattern"].as_str().is_some_and(|pattern| !matches(pattern, text));
        if schema["format"] == FILE_NAME && plume_disk::is_device_name(text) {
            let hint = "Windows reserves this name for a device: choose another".to_owned();
            return self.fault(key, |key| (format!("{key} must not be {}", shown(text)), hint));
        }
        if too_long || too_short || is_unlike {
            self.fault(key, |key| (format!("{key} must not be {}", shown(text)), hint_from(schema)));
        }
    }

    fn word(&mut self, words: &[&str], value: &Value, key: &str) {
        let Some(text) = value.as_str() else {
            return self.mistyped(&format!("one of {}", words.join(", ")), value, key);
        };
        if words.contains(&text) {
            return;
        }
        self.fault(key, |key| {
            let hint = format!("{}known: {}", did_you_mean(text, words.iter().copied()), words.join(", "));
            (format!("{key} cannot be {}", shown(text)), hint)
        });
    }

    fn unknown(&mut self, path: &str, name: &str, known: &Value) {
        self.fault(path, |path| {
            let names: Vec<&str> = known.as_object().into_iter().flatten().map(|(k, _)| k.as_str()).collect();
            let meant = match sections_with(name, known) {
                keys if keys.is_empty() => did_you_mean(name, names.iter().copied()),
                keys => format!("did you mean {}? ", keys.join(" or ")),
            };
            (format!("{path} is not a key"), format!("{meant}known: {}", names.join(", ")))
        });
    }

    fn mistyped(&mut self, wanted: &str, found: &Value, key: &str) {
        self.fault(key, |key| {
            let subject = if key.is_empty() { "the recipe" } else { key };
            (format!("{subject} must be {wanted}, found {}", plain(&found.to_string())), String::new())
        });
    }

    /// Adds a fault; `said` gives its message and hint for a key that may be clipped, and is called only if it is listed.
    fn fault(&mut self, key: &str, said: impl FnOnce(&str) -> (String, String)) {
        let draft = self.draft;
        self.faults.add(|| {
            let (message, hint) = said(&plain(key));
            Fault { origin: draft.origin(key), message, hint }
        });
    }
}

/// The same key in sections, such as `graph.nodes`.
fn sections_with(name: &str, sections: &Value) -> Vec<String> {
    let sections = sections.as_object().into_iter().flatten();
    let has_key = |(_, section): &(&String, &Value)| section["properties"].get(name).is_some();
    sections.filter(has_key).map(|(section, _)| format!("`{section}.{name}`")).collect()
}

/// The path of a key in a section, which has none at the top.
pub fn below(section: &str, key: &str) -> String {
    if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") }
}

/// The schema inside `anyOf [X, null]` or `type [x, null]`, and whether `null` is allowed.
pub fn unwrap_optional(schema: &Value) -> (&Value, bool) {
    let is_null = |s: &Value| s["type"] == "null";
    if let Some(variants) = schema["anyOf"].as_array().filter(|v| v.iter().any(is_null)) {
        return (variants.iter().find(|v| !is_null(v)).unwrap_or(schema), true);
    }
    let optional = schema["type"].as_array().is_some_and(|types| types.iter().any(|t| t == "null"));
    (schema, optional)
}

/// The type that a schema names, apart from `null`.
pub fn type_name(schema: &Value) -> &str {
    match &schema["type"] {
        Value::Array(types) => types.iter().filter_map(Value::as_str).find(|t| *t != "null").unwrap_or(""),
        other => other.as_str().unwrap_or(""),
    }
}

/// The words of an `enum`, or of a `oneOf` of constants (documented variants).
pub fn words(schema: &Value) -> Option<Vec<&str>> {
    if let Some(words) = schema["enum"].as_array() {
        return Some(words.iter().filter_map(Value::as_str).collect());
    }
    let variants = schema["oneOf"].as_array()?;
    let words = variants.iter().flat_map(|v| match words(v) {
        Some(words) => words,
        None => v["const"].as_str().into_iter().collect(),
    });
    Some(words.collect())
}

/// Whether a text matches a regular expression; false if the expression is invalid.
fn matches(pattern: &str, text: &str) -> bool {
    Regex::new(pattern).is_ok_and(|pattern| pattern.is_match(text))
}

fn hint_from(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn show(number: &Value) -> String {
    match number.as_f64() {
        Some(x) if x == x.trunc() && x.abs() < 1e15 => format!("{x:.0}"),
        _ => number.to_string(),
    }
}

/// `"did you mean …? "` if a known word is near, else nothing.
pub fn did_you_mean<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> String {
    // What is much longer than any name is none of them misspelled, and comparing takes time.
    let nearest = known.filter(|k| word.len() <= 2 * k.len() + 2).map(|k| (strsim::levenshtein(word, k), k)).min();
    match nearest {
        Some((distance, k)) if distance <= word.len().div_ceil(3) => format!("did you mean `{k}`? "),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::did_you_mean;

    #[test]
    fn only_near_names_are_suggested() {
        let presets = ["cave", "lava-tube", "mine", "layers"];
        let meant = |word: &str| did_you_mean(word, presets.into_iter());
        assert_eq!(["ice", "tube", "salt", ""].map(meant), [""; 4]);
        assert_eq!(
            ["mines", "cav", "lavatube"].map(meant),
            ["mine", "cave", "lava-tube"].map(|k| format!("did you mean `{k}`? "))
        );
    }
}

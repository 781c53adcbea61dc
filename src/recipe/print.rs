//! Prints a recipe as TOML in which every key is documented.

use std::fmt::Write;

use serde_json::Value;

use super::check::words;
use super::schema::chosen;

const WIDTH: usize = 96;

/// The recipe `value` with the descriptions, ranges and defaults of its `schema` as comments.
pub fn commented(schema: &Value, value: &Value) -> String {
    let mut out = String::new();
    let properties = schema["properties"].as_object();
    let (sections, keys): (Vec<_>, Vec<_>) =
        properties.into_iter().flatten().partition(|(key, _)| value[key.as_str()].is_object());
    for (key, schema) in keys {
        entry(&mut out, key, schema, &value[key.as_str()]);
    }
    for (section, schema) in sections {
        out.push('\n');
        table(&mut out, &format!("[{section}]"), section, schema, &value[section.as_str()]);
    }
    out
}

/// A section: its own keys, the sections in it, then its lists of sections.
fn table(out: &mut String, heading: &str, path: &str, schema: &Value, value: &Value) {
    let _ = writeln!(out, "{heading}");
    let properties = chosen(schema, value)["properties"].as_object();
    let (lists, others): (Vec<_>, Vec<_>) =
        properties.into_iter().flatten().partition(|(_, schema)| is_list_of_sections(schema));
    let (sections, keys): (Vec<_>, Vec<_>) = others.into_iter().partition(|(_, schema)| is_section(schema));
    for (key, schema) in keys {
        entry(out, key, schema, &value[key.as_str()]);
    }
    for (key, schema) in sections {
        let path = format!("{path}.{key}");
        out.push('\n');
        comment(out, &about(schema));
        table(out, &format!("[{path}]"), &path, schema, &value[key.as_str()]);
    }
    for (key, schema) in lists {
        let (path, items) = (format!("{path}.{key}"), value[key.as_str()].as_array().map_or(&[][..], Vec::as_slice));
        out.push('\n');
        comment(out, &about(schema));
        if items.is_empty() {
            let _ = writeln!(out, "# [[{path}]]");
        }
        for item in items {
            out.push('\n');
            table(out, &format!("[[{path}]]"), &path, &schema["items"], item);
        }
    }
}

fn is_section(schema: &Value) -> bool {
    schema["properties"].is_object()
}

fn is_list_of_sections(schema: &Value) -> bool {
    chosen(&schema["items"], &Value::Null)["properties"].is_object()
}

fn entry(out: &mut String, key: &str, schema: &Value, value: &Value) {
    comment(out, &about(schema));
    match literal(value) {
        Some(text) => writeln!(out, "{key} = {text}"),
        None => writeln!(out, "# {key} ="),
    }
    .expect("writing to a string cannot fail");
}

fn comment(out: &mut String, text: &str) {
    for line in wrapped(text) {
        let _ = writeln!(out, "# {line}");
    }
}

fn about(schema: &Value) -> String {
    let mut text = schema["description"].as_str().unwrap_or_default().to_owned();
    if let Some(words) = words(schema) {
        let _ = write!(text, " One of: {}.", words.join(", "));
    }
    match (literal(&schema["minimum"]), literal(&schema["maximum"])) {
        (Some(low), Some(high)) => write!(text, " Range {low} to {high}."),
        (Some(low), None) => write!(text, " At least {low}."),
        (None, Some(high)) => write!(text, " At most {high}."),
        (None, None) => Ok(()),
    }
    .expect("writing to a string cannot fail");
    if let Some(default) = literal(&schema["default"]).filter(|_| !is_section(schema) && !is_list_of_sections(schema)) {
        let _ = write!(text, " Default {default}.");
    }
    text
}

/// A value in TOML; `None` if it is null.
pub fn literal(value: &Value) -> Option<String> {
    match value {
        Value::Null => None,
        Value::Object(table) => {
            let entry = |(key, value): (&String, &Value)| Some(format!("{} = {}", quoted(key), literal(value)?));
            Some(format!("{{ {} }}", table.iter().filter_map(entry).collect::<Vec<_>>().join(", ")))
        }
        Value::Number(n) if n.is_f64() => n.as_f64().map(float),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().filter_map(literal).collect();
            Some(format!("[{}]", items.join(", ")))
        }
        other => Some(other.to_string()),
    }
}

/// A key in quotes, which TOML allows for any key.
fn quoted(key: &str) -> String {
    Value::from(key).to_string()
}

/// A decimal that TOML reads as a float, not an integer.
fn float(x: f64) -> String {
    let text = x.to_string();
    if text.contains('.') { text } else { format!("{text}.0") }
}

fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("there is always a line");
        if !line.is_empty() && line.len() + 1 + word.len() > WIDTH {
            lines.push(word.to_owned());
            continue;
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.retain(|line| !line.is_empty());
    lines
}

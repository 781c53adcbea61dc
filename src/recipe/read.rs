//! From text to a draft: a JSON value that remembers where each key was written.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};
use toml_edit::{Document, Item, TableLike};

use super::fault::{Fault, Faults, Origin};

/// An unchecked recipe.
pub struct Draft {
    /// What was written.
    pub value: Value,
    file: PathBuf,
    origins: BTreeMap<String, Origin>,
}

impl Draft {
    /// A draft whose values all come from `file` as a whole.
    pub fn new(value: Value, file: &Path) -> Self {
        Self { value, file: file.to_path_buf(), origins: BTreeMap::new() }
    }

    /// Where `key`, or the nearest table around it, was written.
    pub fn origin(&self, key: &str) -> Origin {
        let mut key = key;
        loop {
            if let Some(origin) = self.origins.get(key) {
                return origin.clone();
            }
            match key.rfind('.') {
                Some(dot) => key = &key[..dot],
                None => return Origin::File(self.file.clone()),
            }
        }
    }

    /// A fault at `key`.
    pub fn fault(&self, key: &str, message: String) -> Faults {
        let message = format!("{key}: {message}");
        Fault { origin: self.origin(key), message, hint: String::new() }.into()
    }

    /// The path at `key`, which is meant relative to the recipe where it stands in one.
    pub fn beside(&self, key: &str, path: &str) -> Result<String, Faults> {
        let Some(folder) = self.file.parent().filter(|_| matches!(self.origin(key), Origin::Line(..))) else {
            return Ok(path.to_owned());
        };
        let joined = folder.join(path).into_os_string().into_string();
        joined.map_err(|_| self.fault(key, "lies in a folder whose name is not UTF-8".to_owned()))
    }
}

/// Reads TOML, remembering lines.
pub fn toml(text: &str, file: &Path) -> Result<Draft, Faults> {
    let line_at = |offset: usize| 1 + text[..offset.min(text.len())].matches('\n').count();
    let document = Document::parse(text).map_err(|error| {
        let line = error.span().map_or(1, |span| line_at(span.start));
        Fault {
            origin: Origin::Line(file.to_path_buf(), line),
            message: error.message().trim().replace('\n', ", "),
            hint: "recipes are TOML: key = value lines under [section] headings".into(),
        }
    })?;
    let mut draft = Draft::new(Value::Null, file);
    let mut faults = Vec::new();
    let mut lines = Lines { draft: &mut draft, line_at: &line_at, faults: &mut faults };
    let value = lines.table(document.as_table(), "");
    draft.value = value;
    if faults.is_empty() { Ok(draft) } else { Err(Faults(faults)) }
}

struct Lines<'a> {
    draft: &'a mut Draft,
    line_at: &'a dyn Fn(usize) -> usize,
    faults: &'a mut Vec<Fault>,
}

impl Lines<'_> {
    fn table(&mut self, table: &dyn TableLike, path: &str) -> Value {
        let mut map = Map::new();
        for (key, item) in table.iter() {
            let path = join(path, key);
            let span = table.key(key).and_then(|k| k.span()).or_else(|| item.span());
            let line = span.map_or(1, |span| (self.line_at)(span.start));
            let origin = Origin::Line(self.draft.file.clone(), line);
            self.draft.origins.insert(path.clone(), origin);
            let value = self.item(item, &path);
            map.insert(key.to_owned(), value);
        }
        Value::Object(map)
    }

    fn item(&mut self, item: &Item, path: &str) -> Value {
        if let Some(table) = item.as_table_like() {
            return self.table(table, path);
        }
        match item.as_value() {
            Some(value) => self.value(value, path),
            None => self.refuse(path, "must be a value, not a list of tables"),
        }
    }

    fn value(&mut self, value: &toml_edit::Value, path: &str) -> Value {
        use toml_edit::Value as Toml;
        match value {
            Toml::String(s) => Value::from(s.value().as_str()),
            Toml::Integer(i) => Value::from(*i.value()),
            Toml::Boolean(b) => Value::from(*b.value()),
            Toml::Float(x) if x.value().is_finite() => Value::from(*x.value()),
            Toml::Float(_) => self.refuse(path, "must be a finite number"),
            Toml::Datetime(_) => self.refuse(path, "must not be a date"),
            Toml::Array(items) => items.iter().map(|item| self.value(item, path)).collect(),
            Toml::InlineTable(table) => self.table(table, path),
        }
    }

    fn refuse(&mut self, path: &str, what: &str) -> Value {
        let origin = self.draft.origin(path);
        self.faults.push(Fault { origin, message: format!("{path} {what}"), hint: String::new() });
        Value::Null
    }
}

/// Lays `key=value` pairs over a draft. Values are TOML; a bare word is a string.
pub fn overrides(draft: &mut Draft, pairs: &[String]) -> Result<(), Faults> {
    for pair in pairs {
        let Some((key, text)) = pair.split_once('=').filter(|(key, _)| !key.trim().is_empty()) else {
            return Err(Fault {
                origin: Origin::Override(pair.clone()),
                message: "not of the form key=value".into(),
                hint: "write the key, = and the value without spaces: graph.nodes=100".into(),
            }
            .into());
        };
        let key = key.trim();
        let value = override_value(text.trim(), pair)?;
        note_origin(draft, key, pair);
        put(&mut draft.value, key, value).map_err(|at| Fault {
            origin: Origin::Override(pair.clone()),
            message: format!("{at} is a value and holds no keys"),
            hint: format!("set {at} itself, or mend it where it is written"),
        })?;
    }
    Ok(())
}

fn override_value(text: &str, pair: &str) -> Result<Value, Faults> {
    let line = format!("x = {text}");
    let line = if Document::parse(line.as_str()).is_ok() { line } else { format!("x = {text:?}") };
    let mut draft = toml(&line, Path::new("")).map_err(|faults| {
        let key = pair.split('=').next().unwrap_or_default().trim();
        let of_pair = |fault: Fault| Fault {
            origin: Origin::Override(pair.to_owned()),
            message: fault.message.replacen('x', key, 1),
            ..fault
        };
        Faults(faults.0.into_iter().map(of_pair).collect())
    })?;
    Ok(draft.value["x"].take())
}

/// The pair is the origin of its key and of every section that exists through it alone.
fn note_origin(draft: &mut Draft, key: &str, pair: &str) {
    let origin = || Origin::Override(pair.to_owned());
    draft.origins.retain(|other, _| !other.starts_with(&format!("{key}.")));
    draft.origins.insert(key.to_owned(), origin());
    for (dot, _) in key.match_indices('.') {
        if draft.value.pointer(&format!("/{}", key[..dot].replace('.', "/"))).is_none() {
            draft.origins.entry(key[..dot].to_owned()).or_insert_with(origin);
        }
    }
}

/// Sets a key, making the sections above it; `Err` is the key of a value that stands in the way.
fn put(value: &mut Value, key: &str, new: Value) -> Result<(), String> {
    let mut at = value;
    let mut end = 0;
    for part in key.split('.') {
        if at.is_null() {
            *at = Value::Object(Map::new());
        }
        if !at.is_object() {
            return Err(if end == 0 { "the recipe".to_owned() } else { key[..end - 1].to_owned() });
        }
        end += part.len() + 1;
        at = &mut at[part];
    }
    *at = new;
    Ok(())
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

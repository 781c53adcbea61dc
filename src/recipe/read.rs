//! From text to a draft: a JSON value that remembers where each key was written.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};
use toml_edit::{ArrayOfTables, Document, Item, Table, TableLike};

use super::fault::{Fault, Faults, Origin};
use plume_graph::echo::{plain, sentence};

/// Largest size of a recipe.
pub const MAX_BYTES: u64 = 1 << 20;
/// Most keys of a recipe, including sections.
const MAX_KEYS: usize = 20_000;
/// Longest key, and deepest nesting: each key is stored with its full path.
const MAX_KEY: usize = 100;
const MAX_DEPTH: usize = 16;

/// An unchecked recipe.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The value as written.
    pub value: Value,
    file: PathBuf,
    origins: BTreeMap<String, Origin>,
}

impl Draft {
    /// A draft whose values all come from `file` as a whole.
    pub fn new(value: Value, file: &Path) -> Self {
        Self { value, file: file.to_path_buf(), origins: BTreeMap::new() }
    }

    /// Where `key`, or the innermost table around it, was written.
    pub fn origin(&self, key: &str) -> Origin {
        let mut key = key;
        loop {
            if let Some(origin) = self.origins.get(key) {
                return origin.clone();
            }
            match key.rfind(['.', '[']) {
                Some(end) => key = &key[..end],
                None => return Origin::File(self.file.clone()),
            }
        }
    }

    /// Removes a section.
    pub fn forget(&mut self, section: &str) {
        if let Some(sections) = self.value.as_object_mut() {
            sections.remove(section);
        }
        self.origins.retain(|key, _| key.split('.').next() != Some(section));
    }

    /// A fault at `key`.
    pub fn fault(&self, key: &str, message: String) -> Faults {
        let message = format!("{key}: {}", sentence(&message));
        Fault { origin: self.origin(key), message, hint: String::new() }.into()
    }

    /// The path at `key`, resolved relative to the recipe if it was written in one.
    pub fn beside(&self, key: &str, path: &str) -> Result<String, Faults> {
        let Some(folder) = self.file.parent().filter(|_| matches!(self.origin(key), Origin::Line(..))) else {
            return Ok(path.to_owned());
        };
        let joined = folder.join(path).into_os_string().into_string();
        joined.map_err(|_| self.fault(key, "is relative to a folder whose name is not UTF-8".to_owned()))
    }
}

/// Reads TOML, remembering lines.
pub fn toml(text: &str, file: &Path) -> Result<Draft, Faults> {
    if text.len() as u64 > MAX_BYTES {
        let message = format!("is larger than {} MiB", MAX_BYTES >> 20);
        return Err(Fault { origin: Origin::File(file.to_path_buf()), message, hint: String::new() }.into());
    }
    let ends: Vec<usize> = text.match_indices('\n').map(|(end, _)| end).collect();
    let document = Document::parse(text).map_err(|error| {
        let line = error.span().map_or(1, |span| line_of(span.start, &ends));
        Fault {
            origin: Origin::Line(file.to_path_buf(), line),
            message: sentence(&error.message().trim().replace('\n', ", ")),
            hint: "recipes are TOML: `key = value` lines under [section] headings".into(),
        }
    })?;
    let mut draft = Draft::new(Value::Null, file);
    let mut lines = Lines { draft: &mut draft, ends: &ends, depth: 0, faults: Faults::default() };
    let value = lines.table(document.as_table(), "");
    let faults = lines.faults;
    draft.value = value;
    if draft.origins.len() > MAX_KEYS {
        let message = format!("has more than {MAX_KEYS} keys");
        return Err(Fault { origin: Origin::File(file.to_path_buf()), message, hint: String::new() }.into());
    }
    faults.or(draft)
}

/// The line of a byte, counted from 1, given the ends of all lines.
fn line_of(byte: usize, ends: &[usize]) -> usize {
    1 + ends.partition_point(|&end| end < byte)
}

struct Lines<'a> {
    draft: &'a mut Draft,
    /// Where lines end.
    ends: &'a [usize],
    /// Tables that are open.
    depth: usize,
    faults: Faults,
}

impl Lines<'_> {
    fn table(&mut self, table: &dyn TableLike, path: &str) -> Value {
        let mut map = Map::new();
        if self.depth == MAX_DEPTH {
            return self.refuse(path, "is nested too deeply");
        }
        self.depth += 1;
        for (key, item) in table.iter() {
            let span = table.key(key).and_then(|k| k.span()).or_else(|| item.span());
            if self.draft.origins.len() > MAX_KEYS {
                break;
            }
            if key.len() > MAX_KEY {
                let (origin, message) = (self.origin_of(span), format!("{} is not a key", plain(key)));
                self.faults.add(|| Fault { origin, message, hint: String::new() });
                continue;
            }
            let path = join(path, key);
            self.note(&path, span);
            let value = self.item(item, &path);
            map.insert(key.to_owned(), value);
        }
        self.depth -= 1;
        Value::Object(map)
    }

    fn note(&mut self, path: &str, span: Option<Range<usize>>) {
        let origin = self.origin_of(span);
        self.draft.origins.insert(path.to_owned(), origin);
    }

    fn origin_of(&self, span: Option<Range<usize>>) -> Origin {
        Origin::Line(self.draft.file.clone(), span.map_or(1, |span| line_of(span.start, self.ends)))
    }

    fn item(&mut self, item: &Item, path: &str) -> Value {
        if let Some(table) = item.as_table_like() {
            return self.table(table, path);
        }
        if let Some(tables) = item.as_array_of_tables() {
            return self.tables(tables, path);
        }
        item.as_value().map_or(Value::Null, |value| self.value(value, path))
    }

    fn tables(&mut self, tables: &ArrayOfTables, path: &str) -> Value {
        let table = |(place, table): (usize, &Table)| {
            let path = format!("{path}[{place}]");
            self.note(&path, table.span());
            self.table(table, &path)
        };
        tables.iter().enumerate().map(table).collect()
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
            Toml::Array(items) => {
                let value = |(place, item)| self.value(item, &format!("{path}[{place}]"));
                items.iter().enumerate().map(value).collect()
            }
            Toml::InlineTable(table) => self.table(table, path),
        }
    }

    fn refuse(&mut self, path: &str, what: &str) -> Value {
        let draft = &*self.draft;
        self.faults.add(|| Fault {
            origin: draft.origin(path),
            message: format!("{} {what}", plain(path)),
            hint: String::new(),
        });
        Value::Null
    }
}

/// Applies `key=value` pairs to a draft. Values are TOML; a bare word is a string.
pub fn overrides(draft: &mut Draft, pairs: &[String]) -> Result<(), Faults> {
    for pair in pairs {
        let Some((key, text)) = pair.split_once('=').filter(|(key, _)| !key.trim().is_empty()) else {
            return Err(Fault {
                origin: Origin::Override(pair.clone()),
                message: "not of the form key=value".into(),
                hint: "write it without spaces, for example graph.nodes=100".into(),
            }
            .into());
        };
        let value = override_value(text.trim(), pair)?;
        set(draft, key, value, pair)?;
    }
    Ok(())
}

/// Sets one value of a draft; `pair` names it in faults.
pub fn set(draft: &mut Draft, key: &str, value: Value, pair: &str) -> Result<(), Faults> {
    let key = key.trim().replace('[', ".").replace(']', "");
    note_origin(draft, &key, pair);
    put(&mut draft.value, &key, value).map_err(|Obstacle { at, what }| Fault {
        origin: Origin::Override(pair.to_owned()),
        message: format!("{} {what}", plain(&at)),
        hint: format!("set {} itself, or fix it where it is written", plain(&at)),
    })?;
    Ok(())
}

fn override_value(text: &str, pair: &str) -> Result<Value, Faults> {
    let line = format!("x = {text}");
    let line = if Document::parse(line.as_str()).is_ok() { line } else { format!("x = {text:?}") };
    let mut draft = toml(&line, Path::new("")).map_err(|faults| {
        let key = pair.split('=').next().unwrap_or_default().trim();
        let of_pair = |fault: Fault| Fault {
            origin: Origin::Override(pair.to_owned()),
            message: match fault.message.strip_prefix('x') {
                Some(rest) => format!("{}{rest}", plain(key)),
                None => fault.message,
            },
            ..fault
        };
        Faults { told: faults.told.into_iter().map(of_pair).collect(), more: faults.more }
    })?;
    Ok(draft.value["x"].take())
}

/// Records the pair as the origin of its key and of every section that it creates.
fn note_origin(draft: &mut Draft, key: &str, pair: &str) {
    let origin = || Origin::Override(pair.to_owned());
    let path = path_of(&draft.value, key);
    draft.origins.retain(|other, _| !other.starts_with(&path) || !other[path.len()..].starts_with(['.', '[']));
    draft.origins.insert(path, origin());
    for (dot, _) in key.match_indices('.') {
        if draft.value.pointer(&format!("/{}", key[..dot].replace('.', "/"))).is_none() {
            draft.origins.entry(path_of(&draft.value, &key[..dot])).or_insert_with(origin);
        }
    }
}

/// The name of a key in faults, with list indices in brackets.
fn path_of(value: &Value, key: &str) -> String {
    let (mut at, mut path) = (value, String::new());
    for part in key.split('.') {
        if at.is_array() {
            path = format!("{path}[{part}]");
            at = part.parse().map_or(&Value::Null, |place: usize| &at[place]);
        } else {
            path = join(&path, part);
            at = &at[part];
        }
    }
    path
}

/// What keeps a key from being set.
struct Obstacle {
    at: String,
    what: &'static str,
}

/// Sets a key, creating the sections above it.
fn put(value: &mut Value, key: &str, new: Value) -> Result<(), Obstacle> {
    let mut at = value;
    let mut end = 0;
    for part in key.split('.') {
        if at.is_null() {
            *at = Value::Object(Map::new());
        }
        let held = if end == 0 { "the recipe" } else { &key[..end - 1] };
        let obstacle = |what| Obstacle { at: held.to_owned(), what };
        end += part.len() + 1;
        at = match at {
            Value::Object(map) => map.entry(part).or_insert(Value::Null),
            Value::Array(items) => {
                let item = part.parse().ok().and_then(|place: usize| items.get_mut(place));
                item.ok_or_else(|| obstacle("has no item with this number; items are counted from 0"))?
            }
            _ => return Err(obstacle("is a value and cannot have keys")),
        };
    }
    *at = new;
    Ok(())
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

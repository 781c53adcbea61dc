//! References between files, and whether they resolve.

use std::collections::{BTreeMap, BTreeSet};

use super::Fault;
use crate::instances;
use crate::manifest::ThingsEntry;
use crate::package::{Files, MANIFEST};
use serde_json::Value;

/// What all readers have found.
#[derive(Default)]
pub struct Found {
    references: Vec<Reference>,
    /// Files inside archives, with paths below that of the archive.
    inside: BTreeSet<String>,
    guids: Vec<Guid>,
    things: Option<ThingsEntry>,
}

struct Reference {
    from: String,
    to: String,
    least_bytes: u64,
}

/// A Unity GUID: of the file itself, or of one that it refers to.
struct Guid {
    file: String,
    guid: String,
    is_own: bool,
}

impl Found {
    /// The file `from` refers to `to`: a path relative to it, or a `model:` or `package:` URI.
    pub fn reference(&mut self, from: &str, to: impl Into<String>) {
        self.buffer(from, to, 0);
    }

    /// The same, for a file that must have at least `least_bytes` bytes.
    pub fn buffer(&mut self, from: &str, to: impl Into<String>, least_bytes: u64) {
        self.references.push(Reference { from: from.to_owned(), to: to.into(), least_bytes });
    }

    /// The archive `archive` holds a file.
    pub fn inside(&mut self, path: String) {
        self.inside.insert(path);
    }

    /// The file described by `file`, a `.meta`, is known to Unity as `guid`.
    pub fn own_guid(&mut self, file: &str, guid: &str) {
        self.guids.push(Guid { file: file.to_owned(), guid: guid.to_owned(), is_own: true });
    }

    /// The file `file` refers to another by its `guid`.
    pub fn named_guid(&mut self, file: &str, guid: &str) {
        self.guids.push(Guid { file: file.to_owned(), guid: guid.to_owned(), is_own: false });
    }

    /// The package lists these things.
    pub fn things(&mut self, listed: &[Value]) {
        self.things = instances::count(listed);
    }

    /// How many things the package lists.
    pub fn counted_things(&self) -> Option<&ThingsEntry> {
        self.things.as_ref()
    }

    /// References that do not resolve.
    pub fn faults(&self, files: &Files) -> Vec<Fault> {
        let there = There::new(files, &self.inside);
        let dangling = self.references.iter().filter_map(|reference| {
            let what = there.resolve(reference).err()?;
            Some(Fault { path: reference.from.clone(), what })
        });
        dangling.chain(self.guid_faults()).collect()
    }

    fn guid_faults(&self) -> Vec<Fault> {
        let mut owners: BTreeMap<&str, &str> = BTreeMap::new();
        let mut faults = Vec::new();
        for own in self.guids.iter().filter(|guid| guid.is_own) {
            if let Some(other) = owners.insert(&own.guid, &own.file) {
                faults.push(Fault {
                    path: own.file.clone(),
                    what: format!("has the same GUID as {other}: {}", own.guid),
                });
            }
        }
        let dangling = self.guids.iter().filter(|guid| !guid.is_own && !owners.contains_key(&*guid.guid));
        faults.extend(dangling.map(|named| Fault {
            path: named.file.clone(),
            what: format!("refers to GUID {}, which no file of the package has", named.guid),
        }));
        faults
    }
}

/// What is in a package: files with their sizes, and folders.
struct There<'a> {
    files: &'a Files,
    inside: &'a BTreeSet<String>,
    folders: BTreeSet<&'a str>,
}

impl<'a> There<'a> {
    fn new(files: &'a Files, inside: &'a BTreeSet<String>) -> Self {
        let paths = files.0.keys().chain(inside);
        let above = |path: &'a String| path.match_indices('/').map(|(end, _)| &path[..end]);
        Self { files, inside, folders: paths.flat_map(above).collect() }
    }

    fn resolve(&self, reference: &Reference) -> Result<(), String> {
        let to = reference.to.as_str();
        let searched = to.strip_prefix("model://").or_else(|| to.strip_prefix("package://"));
        let path = match searched {
            Some(rest) => {
                self.search(&reference.from, rest).ok_or_else(|| format!("refers to `{to}`, which does not exist"))?
            }
            None => self.beside(&reference.from, to)?,
        };
        match self.files.0.get(&path) {
            Some(entry) if entry.bytes < reference.least_bytes => {
                Err(format!("needs {} bytes of `{to}`, which has {}", reference.least_bytes, entry.bytes))
            }
            _ => Ok(()),
        }
    }

    /// A path relative to the file that refers to it. Files in an archive cannot refer to files outside.
    fn beside(&self, from: &str, to: &str) -> Result<String, String> {
        let is_absolute = to.starts_with('/') || to.contains(':');
        if is_absolute || to.contains('\\') {
            return Err(format!("refers to `{to}`, which is not a relative path with forward slashes"));
        }
        let root = from.rfind(".usdz/").filter(|_| self.inside.contains(from)).map_or(0, |end| end + ".usdz/".len());
        let folder = from[root..].rsplit_once('/').map_or("", |(folder, _)| folder);
        let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
        for part in to.split('/') {
            match part {
                "" | "." => {}
                ".." => {
                    parts.pop().ok_or_else(|| format!("refers to `{to}`, which is outside the package"))?;
                }
                part => parts.push(part),
            }
        }
        let path = format!("{}{}", &from[..root], parts.join("/"));
        if self.holds(&path) { Ok(path) } else { Err(format!("refers to `{to}`, which does not exist")) }
    }

    /// The model or ROS package of a URI: a folder of that name next to the file or further up, or in a `models` folder
    /// there.
    fn search(&self, from: &str, rest: &str) -> Option<String> {
        let ends = from.match_indices('/').map(|(end, _)| end + 1);
        let folders = std::iter::once(0).chain(ends).map(|end| &from[..end]);
        let places = folders.flat_map(|folder| [format!("{folder}{rest}"), format!("{folder}models/{rest}")]);
        places.map(|place| place.trim_end_matches('/').to_owned()).find(|place| self.holds(place))
    }

    fn holds(&self, path: &str) -> bool {
        // The manifest lists every file except itself.
        path == MANIFEST || self.files.0.contains_key(path) || self.inside.contains(path) || self.folders.contains(path)
    }
}

//! Files and their `.meta`, without which Unity ignores an asset of a package.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

use minijinja::{Value, context};
use sha2::{Digest, Sha256};

use super::identity::Guid;
use crate::error::ExportError;
use crate::package::Package;
use crate::template;

/// The importer of a file.
#[derive(Clone, Copy)]
pub enum Importer {
    /// Unity's native YAML; the id of the main object.
    Native(u32),
    /// A prefab.
    Prefab,
    /// A text.
    Text,
    /// The `package.json` of a package.
    Manifest,
    /// None: a folder.
    Folder,
}

impl Importer {
    fn name(self) -> &'static str {
        match self {
            Self::Native(_) => "NativeFormatImporter",
            Self::Prefab => "PrefabImporter",
            Self::Text => "TextScriptImporter",
            Self::Manifest => "PackageManifestImporter",
            Self::Folder => "DefaultImporter",
        }
    }

    fn main_object(self) -> Option<u32> {
        match self {
            Self::Native(object) => Some(object),
            _ => None,
        }
    }
}

/// A package for Unity's Package Manager being written.
pub struct Assets<'a> {
    /// The files.
    pub out: &'a mut dyn Package,
    name: String,
}

impl<'a> Assets<'a> {
    /// An empty package with its name for the Package Manager.
    pub fn new(out: &'a mut dyn Package, name: String) -> Self {
        Self { out, name }
    }

    /// The GUID of a written file.
    pub fn guid(&mut self, path: &str) -> Guid {
        let content = &self.out.files().0[path].sha256;
        Guid::new(&self.name, path, content)
    }

    /// Writes a text and its `.meta`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn text(&mut self, path: &str, text: &str, importer: Importer) -> Result<Guid, ExportError> {
        self.write(path, importer, |file| Ok(file.write_all(text.as_bytes())?))
    }

    /// Writes a file with the content from `fill`, and its `.meta`.
    ///
    /// # Errors
    /// If a file cannot be written, and those of `fill`.
    pub fn write(
        &mut self,
        path: &str,
        importer: Importer,
        fill: impl FnOnce(&mut dyn Write) -> Result<(), ExportError>,
    ) -> Result<Guid, ExportError> {
        self.out.write(path, fill)?;
        let guid = self.guid(path);
        self.write_meta(path, guid, importer)?;
        Ok(guid)
    }

    /// Writes the `.meta` of a written file, filled in from `template`, which also gets its `guid`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn fill_meta(&mut self, path: &str, template: &str, values: &Value) -> Result<Guid, ExportError> {
        let (guid, meta) = (self.guid(path), format!("{path}.meta"));
        let values = context! { guid => guid.to_string(), ..values.clone() };
        self.out.text(&meta, &template::fill(&meta, template, &values))?;
        Ok(guid)
    }

    /// Writes the `.meta` of every folder and of the files that are added `later`, which depend on all others: the last step.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(mut self, later: &[&str]) -> Result<(), ExportError> {
        let contents: BTreeMap<String, String> =
            self.out.files().0.iter().map(|(path, entry)| (path.clone(), entry.sha256.clone())).collect();
        let folders: BTreeSet<&str> = contents.keys().flat_map(|path| parents(path)).collect();
        for folder in folders {
            let guid = Guid::new(&self.name, folder, &digest(&contents, &format!("{folder}/")));
            self.write_meta(folder, guid, Importer::Folder)?;
        }
        later.iter().try_for_each(|path| {
            let guid = Guid::new(&self.name, path, &digest(&contents, ""));
            self.write_meta(path, guid, Importer::Text)
        })
    }

    fn write_meta(&mut self, path: &str, guid: Guid, importer: Importer) -> Result<(), ExportError> {
        let path = format!("{path}.meta");
        let values = context! {
            guid => guid.to_string(),
            folder => matches!(importer, Importer::Folder),
            importer => importer.name(),
            main_object => importer.main_object(),
        };
        self.out.text(&path, &template::fill(&path, include_str!("../../templates/unity/asset.meta.jinja"), &values))
    }
}

/// The parent folders of a file.
fn parents(path: &str) -> impl Iterator<Item = &str> {
    path.match_indices('/').map(|(end, _)| &path[..end])
}

/// SHA-256 of all files whose path begins with `prefix`, in hexadecimal.
fn digest(contents: &BTreeMap<String, String>, prefix: &str) -> String {
    let mut hash = Sha256::new();
    for (path, content) in contents.iter().filter(|(path, _)| path.starts_with(prefix)) {
        hash.update(format!("{path}\0{content}\0"));
    }
    plume_disk::sealed::hex(&hash.finalize())
}

//! `cargo xtask licences`: the licences of the crates inside the command and the Python module, as one file that is shipped with them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::plume::cargo;
use crate::tools::{Result, root, run};

/// The file, in the root of the workspace, where wheels take all that is called `LICENSE-*`.
const FILE: &str = "LICENSE-THIRD-PARTY";
/// What is shipped.
const SHIPPED: [&str; 2] = ["plume-cli", "plume-python"];
/// Beginnings of the names of files with licences.
const NAMES: [&str; 6] = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"];
/// Extensions of such files, besides none.
const EXTENSIONS: [&str; 2] = ["md", "txt"];
/// Who holds the rights to crates that carry neither a text nor all names in their manifest.
const HOLDERS: [(&str, &str); 1] = [("meshopt", "Graham Wihlidal, Arseny Kapoulkine (meshoptimizer)")];

/// What else is inside, and its licence.
const FONT: (&str, &str) = ("DejaVu Sans 2.37, the letters of maps", "templates/preview/LICENSE-DejaVu.txt");

const MIT: &str = include_str!("../../LICENSE-MIT");
const ZLIB: &str = "\
This software is provided 'as-is', without any express or implied warranty. In no event will the authors be held liable for any
damages arising from the use of this software.

Permission is granted to anyone to use this software for any purpose, including commercial applications, and to alter it and
redistribute it freely, subject to the following restrictions:

1. The origin of this software must not be misrepresented; you must not claim that you wrote the original software. If you use this
   software in a product, an acknowledgment in the product documentation would be appreciated but is not required.

2. Altered source versions must be plainly marked as such, and must not be misrepresented as being the original software.

3. This notice may not be removed or altered from any source distribution.
";

/// Writes the file. Crates come from the registry, so cargo must have downloaded them.
pub fn write(_arguments: &[String]) -> Result<()> {
    let metadata = run(cargo().args(["metadata", "--locked", "--format-version", "1"]))?;
    let metadata: Value = serde_json::from_str(&metadata).map_err(|error| error.to_string())?;
    let mut texts = BTreeMap::<String, BTreeSet<String>>::new();
    for package in shipped(&metadata) {
        for text in licences(package)? {
            texts.entry(text).or_default().insert(name(package));
        }
    }
    let (font, licence) = FONT;
    texts.entry(text(&root().join(licence))?).or_default().insert(font.to_owned());
    let path = root().join(FILE);
    fs::write(&path, document(&texts)).map_err(|error| format!("{}: {error}", path.display()))?;
    println!("{FILE}: {} texts", texts.len());
    Ok(())
}

/// The packages of others that are compiled into what is shipped, on any system.
fn shipped(metadata: &Value) -> Vec<&Value> {
    let (packages, nodes) = (by_id(&metadata["packages"]), by_id(&metadata["resolve"]["nodes"]));
    let own: BTreeSet<&str> = items(&metadata["workspace_members"]).map(string).collect();
    let mut waiting: Vec<&str> =
        own.iter().copied().filter(|id| SHIPPED.contains(&string(&packages[id]["name"]))).collect();
    let mut found = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if found.insert(id) {
            let dependencies = items(&nodes[id]["deps"]).filter(|dependency| is_compiled_in(dependency));
            waiting.extend(dependencies.map(|dependency| string(&dependency["pkg"])));
        }
    }
    found.difference(&own).map(|id| packages[id]).collect()
}

fn by_id(list: &Value) -> BTreeMap<&str, &Value> {
    items(list).map(|item| (string(&item["id"]), item)).collect()
}

/// Not only for tests or build scripts.
fn is_compiled_in(dependency: &Value) -> bool {
    items(&dependency["dep_kinds"]).any(|kind| kind["kind"].is_null())
}

/// The texts that a crate carries, also of the C libraries inside it, or else the standard text of its licence.
fn licences(package: &Value) -> Result<Vec<String>> {
    let manifest = Path::new(string(&package["manifest_path"]));
    let mut files = Vec::new();
    find(manifest.parent().unwrap_or(manifest), &mut files)?;
    if files.is_empty() {
        return standard(package).map(|text| vec![text]);
    }
    files.sort();
    files.iter().map(|file| text(file)).collect()
}

fn text(file: &Path) -> Result<String> {
    let bytes = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(String::from_utf8_lossy(&bytes).replace("\r\n", "\n").trim_end().to_owned())
}

/// Adds the files with licences in this folder and below.
fn find(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let told = |error: std::io::Error| format!("{}: {error}", folder.display());
    for entry in fs::read_dir(folder).map_err(told)? {
        let path = entry.map_err(told)?.path();
        match path.is_dir() {
            true => find(&path, files)?,
            false if is_licence(&path) => files.push(path),
            false => (),
        }
    }
    Ok(())
}

fn is_licence(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
    let is_text = match path.extension() {
        None => true,
        // Such as `LICENSE.BSD-3-Clause`.
        Some(extension) if name.starts_with("LICEN") => extension != "rs" && extension != "toml",
        Some(extension) => EXTENSIONS.iter().any(|text| extension.eq_ignore_ascii_case(text)),
    };
    is_text && NAMES.iter().any(|beginning| name.starts_with(beginning))
}

fn standard(package: &Value) -> Result<String> {
    let (crate_name, licence) = (string(&package["name"]), string(&package["license"]));
    let named = HOLDERS.iter().find(|row| row.0 == crate_name).map(|row| row.1.to_owned());
    let authors: Vec<&str> = items(&package["authors"]).map(string).collect();
    let authors = if authors.is_empty() { format!("the authors of {crate_name}") } else { authors.join(", ") };
    let copyright = format!("Copyright (c) {}", named.unwrap_or(authors));
    let words = |text: &str| licence.split([' ', '/', '(', ')']).any(|word| word == text);
    if words("MIT") {
        let own = MIT.lines().find(|line| line.starts_with("Copyright")).unwrap_or_default();
        return Ok(MIT.replace(own, &copyright).trim_end().to_owned());
    }
    if words("Zlib") {
        return Ok(format!("{copyright}\n\n{}", ZLIB.trim_end()));
    }
    Err(format!("{crate_name} carries no licence, and of {licence} xtask/src/licences.rs has no text"))
}

/// The texts by the first crate that they belong to.
fn document(texts: &BTreeMap<String, BTreeSet<String>>) -> String {
    let mut sections: Vec<_> = texts.iter().map(|(text, crates)| (crates, text)).collect();
    sections.sort();
    let line = "=".repeat(80);
    let head = "The command `plume` and the Python module `plume` contain what is listed here, under these licences.\n"
        .to_owned();
    sections.into_iter().fold(head, |document, (crates, text)| {
        let crates = crates.iter().cloned().collect::<Vec<_>>().join("\n");
        format!("{document}\n{line}\n{crates}\n{line}\n\n{text}\n")
    })
}

fn name(package: &Value) -> String {
    let [name, version, licence] = ["name", "version", "license"].map(|key| string(&package[key]));
    format!("{name} {version} ({licence})")
}

fn items(list: &Value) -> impl Iterator<Item = &Value> {
    list.as_array().into_iter().flatten()
}

fn string(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

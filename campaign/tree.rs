//! A snapshot of a folder, byte for byte.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Everything below a folder by its path. Links are named, never followed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tree(BTreeMap<PathBuf, Entry>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Entry {
    Folder,
    File(String),
    Link(PathBuf),
    Other,
}

impl Tree {
    /// The content of `root`; empty if there is no such folder.
    pub fn of(root: &Path) -> Self {
        let mut tree = Self::default();
        tree.add(root, Path::new(""));
        tree
    }

    fn add(&mut self, root: &Path, below: &Path) {
        for entry in fs::read_dir(root.join(below)).into_iter().flatten().flatten() {
            let path = below.join(entry.file_name());
            let found = look(&entry.path());
            let is_folder = found == Entry::Folder;
            self.0.insert(path.clone(), found);
            if is_folder {
                self.add(root, &path);
            }
        }
    }

    /// The same without what is at or below `path`.
    pub fn without(mut self, path: &str) -> Self {
        self.0.retain(|found, _| !found.starts_with(path));
        self
    }

    /// Only what is at or below `path`.
    pub fn at(&self, path: &str) -> Self {
        let inside = self.0.iter().filter(|(found, _)| found.starts_with(path));
        Self(inside.map(|(found, entry)| (found.clone(), entry.clone())).collect())
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether there is something at `path`.
    pub fn has(&self, path: &str) -> bool {
        self.0.contains_key(Path::new(path))
    }

    /// Paths of the regular files.
    pub fn files(&self) -> Vec<PathBuf> {
        self.0.iter().filter(|(_, entry)| matches!(entry, Entry::File(_))).map(|(path, _)| path.clone()).collect()
    }

    /// Files that only a running or killed process may leave: temporary names, hidden staging folders.
    pub fn temporaries(&self) -> Vec<&Path> {
        self.0.keys().map(PathBuf::as_path).filter(|path| is_temporary(path)).collect()
    }

    /// Fails unless `now` is the same.
    pub fn expect(&self, now: &Self) -> Result<(), String> {
        let gone =
            self.0.keys().filter(|path| !now.0.contains_key(*path)).map(|path| format!("{} is gone", show(path)));
        let new = now.0.keys().filter(|path| !self.0.contains_key(*path)).map(|path| format!("{} is new", show(path)));
        let differs = |(path, entry): &(&PathBuf, &Entry)| now.0.get(*path).is_some_and(|found| found != *entry);
        let changed = self.0.iter().filter(differs).map(|(path, _)| format!("{} has changed", show(path)));
        let all: Vec<String> = gone.chain(changed).chain(new).collect();
        match all.len() {
            0 => Ok(()),
            1..=SHOWN => Err(all.join(", ")),
            more => Err(format!("{} and {} more differences", all[..SHOWN].join(", "), more - SHOWN)),
        }
    }

    /// Fails unless `now` has every entry unchanged; it may have more.
    pub fn expect_within(&self, now: &Self) -> Result<(), String> {
        let kept = now.0.iter().filter(|(path, _)| self.0.contains_key(*path));
        self.expect(&Self(kept.map(|(path, entry)| (path.clone(), entry.clone())).collect()))
    }
}

/// How many differences a report names.
const SHOWN: usize = 4;

fn show(path: &Path) -> String {
    path.display().to_string()
}

fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let hidden =
        name.starts_with(".plume-") || name.starts_with(".tmp") || (name.starts_with('.') && name.ends_with(".cave"));
    hidden || name.ends_with(".partial") || name == "journal.jsonl"
}

fn look(path: &Path) -> Entry {
    let Ok(kind) = path.symlink_metadata().map(|data| data.file_type()) else { return Entry::Other };
    match kind {
        kind if kind.is_dir() => Entry::Folder,
        kind if kind.is_symlink() => Entry::Link(fs::read_link(path).unwrap_or_default()),
        kind if kind.is_file() => Entry::File(fs::read(path).map(|bytes| sha256(&bytes)).unwrap_or_default()),
        _ => Entry::Other,
    }
}

/// SHA-256 in lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Copies a folder with all it holds; links stay links.
pub fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (kind, place) = (entry.file_type()?, to.join(entry.file_name()));
        if kind.is_dir() {
            copy(&entry.path(), &place)?;
        } else if kind.is_symlink() {
            std::os::unix::fs::symlink(fs::read_link(entry.path())?, place)?;
        } else {
            fs::copy(entry.path(), place)?;
        }
    }
    Ok(())
}

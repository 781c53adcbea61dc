//! The cave folder on disk.
//!
//! ```text
//! my-cave/
//! ├─ cave.toml        the whole recipe
//! ├─ graph.json       the graph, recipe inside: alone it makes the cave again
//! ├─ plan.png         the graph seen from above
//! ├─ profile.png      and from the side
//! ├─ chunks/          the wall, one PLY a chunk
//! ├─ collision/       the same with fewer triangles
//! ├─ textures/        the unwrapped wall in levels of detail (PLY) and its images, per chunk
//! ├─ pieces/          the rock behind the wall in convex pieces, when a target has asked for them
//! └─ manifest.json    what is finished: SHA-256 of every file
//! ```
//!
//! Work is done in [`Unit`]s (one stage of one chunk). A unit's files are written under temporary names and renamed;
//! then one line in a journal says that the unit is done. A process killed at any moment leaves whole units and at most
//! some `*.partial` files, and the next run goes on from there to the same bytes. Power loss is not covered: nothing
//! waits for the disk. The journal is the first file there, and locked, where the file system can: one run at a time.

mod chunk;
mod file;
mod piece;
pub mod ply;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use self::chunk::{
    ChunkError, IMAGES, LodFacts, Written, adjacent, image_path, lod_path, read_mesh, read_ply, textured_path,
    write_mesh, write_textured,
};
pub use self::file::{FileRecord, Sink, sha256, write as write_file};
pub use self::piece::{read_pieces, write_pieces};

const MANIFEST: &str = "manifest.json";
const JOURNAL: &str = "journal.jsonl";
/// The recipe inside a cave folder.
pub const RECIPE: &str = "cave.toml";
/// The graph inside a cave folder.
pub const GRAPH: &str = "graph.json";

/// A stage of the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Stations and passages.
    Graph,
    /// Plan and profile.
    Preview,
    /// Triangles.
    Mesh,
    /// Images.
    Texture,
    /// Convex pieces, made when a target asks for them.
    Pieces,
}

impl Stage {
    /// Its name; but for `preview`, as in the command that makes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Graph => "graph",
            Self::Preview => "preview",
            Self::Mesh => "mesh",
            Self::Texture => "texture",
            Self::Pieces => "pieces",
        }
    }
}

/// A finished piece of work: one stage of one chunk (or of the whole cave).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// Which stage.
    pub stage: Stage,
    /// Chunk name, or `cave`.
    pub name: String,
    /// Hash of everything the unit follows from.
    pub fingerprint: String,
    /// What was written.
    pub files: Vec<FileRecord>,
    /// Numbers worth keeping: triangles, areas, texels.
    pub facts: Value,
}

#[derive(Serialize, Deserialize)]
struct Manifest {
    plume: String,
    units: Vec<Unit>,
}

/// Something went wrong between us and the disk.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What it said.
        source: std::io::Error,
    },
    /// A file of the folder is not what we wrote.
    #[error("{}: {message}", path.display())]
    Damaged {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// The folder is in use for something else.
    #[error("{}: the folder exists and holds no cave", path.display())]
    Occupied {
        /// Which folder.
        path: PathBuf,
    },
    /// Another process is at work in the folder.
    #[error("{}: another run is at work in this folder", path.display())]
    InUse {
        /// Which folder.
        path: PathBuf,
    },
}

impl StoreError {
    /// An I/O error at `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), source }
    }
}

/// An open cave folder.
pub struct CaveFolder {
    root: PathBuf,
    work: Mutex<Work>,
}

struct Work {
    units: BTreeMap<(Stage, String), Unit>,
    /// Files of units that another has taken the place of; it may have the same.
    replaced: Vec<FileRecord>,
    journal: Option<File>,
}

impl Work {
    fn insert(&mut self, unit: Unit) {
        let before = self.units.insert((unit.stage, unit.name.clone()), unit);
        self.replaced.extend(before.into_iter().flat_map(|unit| unit.files));
    }
}

impl CaveFolder {
    /// Whether `root` is a cave folder, finished or not. Others have a `manifest.json` too, packages among them.
    pub fn is_at(root: &Path) -> bool {
        root.join(JOURNAL).is_file() || (root.join(MANIFEST).is_file() && root.join(RECIPE).is_file())
    }

    /// Opens the cave folder at `root`, which may be yet to make; nothing is written before [`begin`](Self::begin).
    ///
    /// # Errors
    /// When `root` holds something else, cannot be read, or its manifest is damaged.
    pub fn open_or_new(root: &Path) -> Result<Self, StoreError> {
        if !Self::is_at(root) && !file::is_vacant(root)? {
            return Err(StoreError::Occupied { path: root.to_path_buf() });
        }
        Self::open(root)
    }

    /// Makes the folder if need be and keeps other runs out of it, until it is settled.
    ///
    /// # Errors
    /// When the disk refuses, or another run is at work there.
    pub fn begin(&self) -> Result<(), StoreError> {
        fs::create_dir_all(&self.root).map_err(|e| StoreError::io(&self.root, e))?;
        let path = self.root.join(JOURNAL);
        let opened = OpenOptions::new().create(true).append(true).open(&path);
        let mut journal = opened.map_err(|e| StoreError::io(&path, e))?;
        // File systems without locks are served all the same.
        if let Err(TryLockError::WouldBlock) = journal.try_lock() {
            return Err(StoreError::InUse { path: self.root.clone() });
        }
        // A kill may have torn the last line: what follows starts on a line of its own.
        journal.write_all(b"\n").map_err(|e| StoreError::io(&path, e))?;
        self.work().journal = Some(journal);
        Ok(())
    }

    /// Whether another run is at work in the folder, as far as the file system can tell.
    pub fn is_in_use(&self) -> bool {
        let journal = OpenOptions::new().append(true).open(self.root.join(JOURNAL));
        journal.is_ok_and(|journal| matches!(journal.try_lock(), Err(TryLockError::WouldBlock)))
    }

    /// Opens the cave folder at `root`.
    ///
    /// # Errors
    /// When it cannot be read or its manifest is damaged.
    pub fn open(root: &Path) -> Result<Self, StoreError> {
        let mut work = Work { units: read_manifest(&root.join(MANIFEST))?, replaced: Vec::new(), journal: None };
        read_journal(&root.join(JOURNAL))?.into_iter().for_each(|unit| work.insert(unit));
        Ok(Self { root: root.to_path_buf(), work: Mutex::new(work) })
    }

    /// The folder itself.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The unit, if it is finished, follows from `fingerprint`, and all its files are intact.
    ///
    /// # Errors
    /// When a file exists but cannot be read.
    pub fn finished(&self, stage: Stage, name: &str, fingerprint: &str) -> Result<Option<Unit>, StoreError> {
        let unit = self.work().units.get(&(stage, name.to_owned())).cloned();
        let Some(unit) = unit.filter(|unit| unit.fingerprint == fingerprint) else {
            return Ok(None);
        };
        for record in &unit.files {
            if !record.is_intact(&self.root)? {
                return Ok(None);
            }
        }
        Ok(Some(unit))
    }

    /// The units of a stage, in order of their names.
    pub fn units(&self, stage: Stage) -> Vec<Unit> {
        self.work().units.values().filter(|unit| unit.stage == stage).cloned().collect()
    }

    /// Writes a file of the folder; it appears whole or not at all.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write(
        &self,
        path: &str,
        content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<FileRecord, StoreError> {
        file::write(&self.root, path, content)
    }

    /// Starts a file of the folder; it appears when finished.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn create(&self, path: &str) -> Result<Sink, StoreError> {
        Sink::create(&self.root, path)
    }

    /// Notes that a unit is done; its files have been written. For folders that have [begun](Self::begin).
    ///
    /// # Errors
    /// When the journal cannot be written.
    pub fn commit(&self, unit: Unit) -> Result<(), StoreError> {
        let path = self.root.join(JOURNAL);
        let mut line = serde_json::to_vec(&unit).expect("a unit is plain data");
        line.push(b'\n');
        let mut work = self.work();
        let journal = work.journal.as_mut().expect("a folder begins before its units");
        journal.write_all(&line).map_err(|e| StoreError::io(&path, e))?;
        work.insert(unit);
        Ok(())
    }

    /// Folds the journal into the manifest, keeping the units that `keep` approves and deleting the files of the others and
    /// of those that were replaced.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn settle(&self, keep: impl Fn(&Unit) -> bool) -> Result<(), StoreError> {
        let mut work = self.work();
        let (kept, stale): (BTreeMap<_, _>, BTreeMap<_, _>) =
            std::mem::take(&mut work.units).into_iter().partition(|(_, unit)| keep(unit));
        let wanted: BTreeSet<&str> =
            kept.values().flat_map(|unit| unit.files.iter().map(|f| f.path.as_str())).collect();
        for record in stale.values().flat_map(|unit| &unit.files).chain(&work.replaced) {
            if !wanted.contains(record.path.as_str()) {
                let _ = fs::remove_file(self.root.join(&record.path));
            }
        }
        let manifest = Manifest { plume: crate::VERSION.into(), units: kept.values().cloned().collect() };
        self.write(MANIFEST, |out| {
            serde_json::to_writer_pretty(&mut *out, &manifest)?;
            out.write_all(b"\n")
        })?;
        work.units = kept;
        work.replaced.clear();
        work.journal = None;
        let _ = fs::remove_file(self.root.join(JOURNAL));
        Ok(())
    }

    fn work(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn read_manifest(path: &Path) -> Result<BTreeMap<(Stage, String), Unit>, StoreError> {
    let Some(text) = file::read_if_there(path)? else {
        return Ok(BTreeMap::new());
    };
    let manifest: Manifest = serde_json::from_slice(&text)
        .map_err(|e| StoreError::Damaged { path: path.to_path_buf(), message: e.to_string() })?;
    Ok(manifest.units.into_iter().map(|unit| ((unit.stage, unit.name.clone()), unit)).collect())
}

/// The journal's units, without lines that a kill tore.
fn read_journal(path: &Path) -> Result<Vec<Unit>, StoreError> {
    let text = file::read_if_there(path)?.unwrap_or_default();
    let lines = text.split(|byte| *byte == b'\n');
    Ok(lines.filter_map(|line| serde_json::from_slice(line).ok()).collect())
}

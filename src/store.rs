//! The cave folder on disk.
//!
//! ```text
//! my-cave/
//! ├─ cave.toml        the complete recipe
//! ├─ graph.json       the graph with the recipe: enough to make the cave again
//! ├─ plan.png         the graph seen from above
//! ├─ profile.png      and from the side
//! ├─ models/          the model files that the recipe names, a folder each
//! ├─ chunks/          the wall, one PLY per chunk
//! ├─ collision/       the same with fewer triangles
//! ├─ things/          stones and dripstone: kind, shape, size and pose of each, per chunk
//! ├─ textures/        the unwrapped wall in levels of detail (PLY) and its images, per chunk; and the shapes of things
//! ├─ pieces/          convex pieces of the rock behind the wall, if a target needs them
//! └─ manifest.json    what is finished: SHA-256 of every file
//! ```
//!
//! Work is done in [`Unit`]s (one stage of one chunk). A unit's files are written in a staging folder, synced and renamed;
//! then a line in a journal records the unit as done. A process killed at any moment leaves complete units and at most a
//! staging folder, and the next run resumes with the same bytes as result. After power loss a file is as it was written, or
//! its unit is made again. The journal is the first file there, and locked if the file system supports it: one run at a
//! time.
//!
//! A folder is untrusted. Manifest and journal are validated ([`Unit`]), symbolic links are refused, and a file
//! counts only if its hash matches its record. The user's changes are not overwritten: see [`CaveFolder::changes`].

mod chunk;
mod error;
mod facts;
mod file;
mod piece;
pub mod ply;
mod prototype;
mod records;
mod temporary;
mod thing;
mod unit;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

pub use plume_disk::sealed::sha256;
use plume_disk::{Staging, regular};
use rayon::prelude::*;

pub use self::chunk::{ChunkError, IMAGES, Written, read_mesh, read_ply, write_mesh, write_textured};
pub use self::error::StoreError;
pub use self::facts::{Facts, GraphFacts, LodFacts, MeshFacts, PieceFacts, TextureFacts, ThingFacts};
use self::file::FileState;
pub use self::file::{FileRecord, Sink};
pub use self::piece::{read_pieces, write_pieces};
pub use self::prototype::{Prototypes, read_prototypes};
use self::records::Event;
pub use self::temporary::TemporaryFolder;
pub use self::thing::{read_things, write_things};
pub use self::unit::{
    PROTOTYPES, Stage, Unit, WHOLE_CAVE, adjacent, chunk_index, chunk_name, collision_path, image_path, is_copy_path,
    is_plain_name, lod_path, pieces_path, textured_path, things_path, wall_path,
};

const MANIFEST: &str = "manifest.json";
const JOURNAL: &str = "journal.jsonl";
/// The recipe inside a cave folder.
pub const RECIPE: &str = "cave.toml";
/// The graph inside a cave folder.
pub const GRAPH: &str = "graph.json";
/// The map seen from above.
pub const PLAN: &str = "plan.png";
/// The map seen from the side.
pub const PROFILE: &str = "profile.png";

/// An open cave folder.
pub struct CaveFolder {
    root: PathBuf,
    /// A folder whose finished units are reused where they fit.
    base: Option<Box<CaveFolder>>,
    /// Folders that have parts of this cave.
    parts: Vec<CaveFolder>,
    /// Whether it is removed once its packages are made.
    is_ephemeral: bool,
    work: Mutex<Work>,
}

#[derive(Default)]
struct Work {
    units: BTreeMap<(Stage, String), Unit>,
    /// The files of all units by path; no two have one of the same.
    files: BTreeMap<String, FileRecord>,
    /// Files of replaced units; the replacement may have the same.
    replaced: Vec<FileRecord>,
    /// Cached states of files, by path.
    states: BTreeMap<String, FileState>,
    run: Option<Run>,
}

/// State of a run that works in the folder.
struct Run {
    journal: File,
    staging: Staging,
    /// Number of temporary files so far.
    temporary: usize,
}

impl Work {
    /// The content of manifest and journal.
    fn read(root: &Path) -> Result<Self, StoreError> {
        let mut work = Self::default();
        for unit in records::read_manifest(&root.join(MANIFEST))? {
            work.insert(unit);
        }
        for event in records::read_journal(&root.join(JOURNAL))? {
            match event {
                Event::Begun { stage, name } => work.remove(stage, &name),
                Event::Done(unit) => work.insert(unit),
            }
        }
        Ok(work)
    }

    fn insert(&mut self, unit: Unit) {
        self.remove(unit.stage, &unit.name);
        for file in &unit.files {
            self.files.insert(file.path.clone(), file.clone());
        }
        self.units.insert((unit.stage, unit.name.clone()), unit);
    }

    fn remove(&mut self, stage: Stage, name: &str) {
        let Some(before) = self.units.remove(&(stage, name.to_owned())) else { return };
        for file in &before.files {
            self.files.remove(&file.path);
            self.states.remove(&file.path);
        }
        self.replaced.extend(before.files);
    }

    fn run(&mut self) -> &mut Run {
        self.run.as_mut().expect("a folder begins before it is written to")
    }
}

impl CaveFolder {
    /// Whether `root` is a cave folder, finished or not. Other folders, such as packages, have a `manifest.json` too.
    pub fn is_at(root: &Path) -> bool {
        root.join(JOURNAL).is_file() || (root.join(MANIFEST).is_file() && root.join(RECIPE).is_file())
    }

    /// Opens the cave folder at `root`, which need not exist; nothing is written before [`begin`](Self::begin).
    ///
    /// # Errors
    /// If `root` contains something else, cannot be read, or its manifest is damaged.
    pub fn open_or_new(root: &Path) -> Result<Self, StoreError> {
        if !Self::is_at(root) && !file::is_vacant(root)? {
            return Err(StoreError::Occupied { path: root.to_path_buf() });
        }
        Self::open(root)
    }

    /// Opens the cave folder at `root`.
    ///
    /// # Errors
    /// If it cannot be read or its manifest is damaged.
    pub fn open(root: &Path) -> Result<Self, StoreError> {
        Ok(Self {
            root: root.to_path_buf(),
            base: None,
            parts: Vec::new(),
            is_ephemeral: false,
            work: Mutex::new(Work::read(root)?),
        })
    }

    /// The same folder, which reuses finished units of `base` where they fit.
    #[must_use]
    pub fn based_on(self, base: Self) -> Self {
        Self { base: Some(Box::new(base)), ..self }
    }

    /// The same folder, which takes finished units of these, which have parts of the same cave.
    #[must_use]
    pub fn with_parts(self, parts: Vec<Self>) -> Self {
        Self { parts, ..self }
    }

    /// The folders that have parts of this cave.
    pub fn parts(&self) -> &[Self] {
        &self.parts
    }

    /// The same folder, which will be removed once its packages are made: maps for people are not drawn.
    #[must_use]
    pub fn ephemeral(self) -> Self {
        Self { is_ephemeral: true, ..self }
    }

    /// Whether it will be removed once its packages are made.
    pub fn is_ephemeral(&self) -> bool {
        self.is_ephemeral
    }

    /// Makes the folder if necessary and locks it until it is settled. Must be called before writing to it.
    ///
    /// # Errors
    /// If the disk fails, or another run is using it.
    pub fn begin(&self) -> Result<(), StoreError> {
        let mut work = self.work();
        if work.run.is_some() {
            return Ok(());
        }
        fs::create_dir_all(&self.root).map_err(|e| StoreError::io(&self.root, e))?;
        let journal = self.locked_journal()?;
        // Another run may have changed the folder since it was opened.
        *work = Work::read(&self.root)?;
        let staging = Staging::new(&self.root).map_err(|e| StoreError::io(&self.root, e))?;
        work.run = Some(Run { journal, staging, temporary: 0 });
        Ok(())
    }

    /// Opens and locks the journal, and terminates its last line.
    fn locked_journal(&self) -> Result<File, StoreError> {
        let path = self.root.join(JOURNAL);
        let named = |error| StoreError::io(&path, error);
        let mut journal = regular::append_no_follow(&path).map_err(named)?;
        // File systems without locks are supported too.
        if let Err(TryLockError::WouldBlock) = journal.try_lock() {
            return Err(StoreError::InUse { path: self.root.clone() });
        }
        // A kill may have truncated the last line, so continue on a new one.
        journal.write_all(b"\n").map_err(named)?;
        Ok(journal)
    }

    /// Whether another run is using the folder, as far as the file system can tell.
    pub fn is_in_use(&self) -> bool {
        let journal = regular::open_no_follow(&self.root.join(JOURNAL));
        journal.is_ok_and(|journal| matches!(journal.try_lock(), Err(TryLockError::WouldBlock)))
    }

    /// The folder itself.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The unit, if it is finished, follows from `fingerprint`, and all its files are intact.
    ///
    /// # Errors
    /// If a file exists but cannot be read.
    pub fn finished(&self, stage: Stage, name: &str, fingerprint: &str) -> Result<Option<Unit>, StoreError> {
        let unit = self.work().units.get(&(stage, name.to_owned())).cloned();
        let Some(unit) = unit.filter(|unit| unit.fingerprint == fingerprint) else {
            return Ok(None);
        };
        for record in &unit.files {
            if self.state(record)? != FileState::Intact {
                return Ok(None);
            }
        }
        Ok(Some(unit))
    }

    /// The state of a file, which is checked once.
    fn state(&self, record: &FileRecord) -> Result<FileState, StoreError> {
        if let Some(&state) = self.work().states.get(&record.path) {
            return Ok(state);
        }
        let state = record.state(&self.root)?;
        self.work().states.insert(record.path.clone(), state);
        Ok(state)
    }

    /// Whether a file was replaced by something else.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn is_changed(&self, record: &FileRecord) -> Result<bool, StoreError> {
        Ok(self.state(record)? == FileState::Changed)
    }

    /// The files of finished units, except recipe, graph and models, that exist but differ from what was written: edited or damaged.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn changes(&self) -> Result<Vec<String>, StoreError> {
        let files: Vec<FileRecord> = self.work().files.values().cloned().collect();
        let files: Vec<&FileRecord> = files
            .iter()
            .filter(|file| ![RECIPE, GRAPH].contains(&file.path.as_str()) && !is_copy_path(&file.path))
            .collect();
        let states: Result<Vec<FileState>, StoreError> = files.par_iter().map(|record| self.state(record)).collect();
        let changed = files.iter().zip(states?).filter(|(_, state)| *state == FileState::Changed);
        Ok(changed.map(|(record, _)| record.path.clone()).collect())
    }

    /// The units of a stage, in order of their names.
    pub fn units(&self, stage: Stage) -> Vec<Unit> {
        self.work().units.values().filter(|unit| unit.stage == stage).cloned().collect()
    }

    /// The content of a file of a finished unit, verified.
    ///
    /// # Errors
    /// [`StoreError::Changed`] if it was changed; if it cannot be read.
    pub fn read(&self, path: &str) -> Result<Vec<u8>, StoreError> {
        self.record(path)?.read(&self.root)
    }

    /// Verifies a file of a finished unit, for callers that read it themselves.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn verify(&self, path: &str) -> Result<(), StoreError> {
        match self.state(&self.record(path)?)? {
            FileState::Intact => Ok(()),
            FileState::Missing => Err(StoreError::io(&self.root.join(path), ErrorKind::NotFound.into())),
            FileState::Changed => Err(StoreError::Changed { path: self.root.join(path) }),
        }
    }

    fn record(&self, path: &str) -> Result<FileRecord, StoreError> {
        let record = self.work().files.get(path).cloned();
        record.ok_or_else(|| StoreError::damaged(&self.root.join(path), "belongs to no finished unit"))
    }

    /// Writes a file of the folder; it appears whole or not at all. For folders that have [begun](Self::begin).
    ///
    /// # Errors
    /// If the disk fails.
    pub fn write(
        &self,
        path: &str,
        content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<FileRecord, StoreError> {
        let mut sink = self.create(path)?;
        content(&mut sink).map_err(|e| StoreError::io(&self.root.join(path), e))?;
        sink.finish()
    }

    /// Starts a file of the folder; it appears when finished. For folders that have [begun](Self::begin).
    ///
    /// # Errors
    /// If the disk fails.
    pub fn create(&self, path: &str) -> Result<Sink, StoreError> {
        let partial = self.temporary_path();
        Sink::create(&self.root, path, partial)
    }

    fn temporary_path(&self) -> PathBuf {
        let mut work = self.work();
        let run = work.run();
        run.temporary += 1;
        run.staging.path().join(run.temporary.to_string())
    }

    /// Records that the files of a unit are about to be written, which invalidates earlier records.
    ///
    /// # Errors
    /// If the disk fails, or another run is using the folder.
    pub fn begin_unit(&self, stage: Stage, name: &str) -> Result<(), StoreError> {
        self.begin()?;
        let mut work = self.work();
        if work.units.contains_key(&(stage, name.to_owned())) {
            self.note(&mut work, &Event::Begun { stage, name: name.to_owned() })?;
            let journal = &work.run().journal;
            journal.sync_data().map_err(|e| StoreError::io(&self.root.join(JOURNAL), e))?;
            work.remove(stage, name);
        }
        Ok(())
    }

    /// Records that a unit is done; its files have been written. For folders that have [begun](Self::begin).
    ///
    /// # Errors
    /// If the journal cannot be written.
    pub fn commit(&self, unit: Unit) -> Result<(), StoreError> {
        let mut work = self.work();
        let event = Event::Done(unit);
        self.note(&mut work, &event)?;
        if let Event::Done(unit) = event {
            work.insert(unit);
        }
        Ok(())
    }

    fn note(&self, work: &mut Work, event: &Event) -> Result<(), StoreError> {
        records::append(&mut work.run().journal, event).map_err(|e| StoreError::io(&self.root.join(JOURNAL), e))
    }

    /// Reuses a finished unit of the folder that this one is [based on](Self::based_on) or of one of its
    /// [parts](Self::with_parts), if it is intact and follows from `fingerprint`.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn take_over(&self, stage: Stage, name: &str, fingerprint: &str) -> Result<bool, StoreError> {
        for other in self.base.iter().map(Box::as_ref).chain(&self.parts) {
            let Some(unit) = other.finished(stage, name, fingerprint)? else { continue };
            for record in &unit.files {
                self.copy_from(other, record)?;
            }
            self.commit(unit)?;
            return Ok(true);
        }
        Ok(false)
    }

    /// A hard link where the file system supports it, since no file of a cave folder is ever written in place.
    fn copy_from(&self, base: &Self, record: &FileRecord) -> Result<(), StoreError> {
        let (from, partial) = (base.root.join(&record.path), self.temporary_path());
        if fs::hard_link(&from, &partial).is_err() {
            fs::copy(&from, &partial).map_err(|e| StoreError::io(&from, e))?;
        }
        let to = self.root.join(&record.path);
        file::refuse_link_above(&self.root, &to)?;
        fs::create_dir_all(to.parent().unwrap_or(&self.root)).map_err(|e| StoreError::io(&to, e))?;
        fs::rename(&partial, &to).map_err(|e| StoreError::io(&to, e))
    }

    /// Merges the journal into the manifest, keeping the units that `keep` approves and deleting the files of all others. A
    /// folder with nothing to merge or delete is not touched.
    ///
    /// # Errors
    /// If the disk fails, or another run is using the folder.
    pub fn settle(&self, keep: impl Fn(&Unit) -> bool) -> Result<(), StoreError> {
        if self.is_settled(&keep) {
            return Ok(());
        }
        self.begin()?;
        let (kept, stale): (BTreeMap<_, _>, BTreeMap<_, _>) =
            std::mem::take(&mut self.work().units).into_iter().partition(|(_, unit)| keep(unit));
        let replaced = std::mem::take(&mut self.work().replaced);
        self.remove_all(stale.values().flat_map(|unit| &unit.files).chain(&replaced), &kept)?;
        let manifest = records::manifest(kept.values().cloned().collect());
        self.write(MANIFEST, |out| out.write_all(manifest.as_bytes()))?;
        plume_disk::sync_folder(&self.root).map_err(|e| StoreError::io(&self.root, e))?;
        let mut work = self.work();
        work.units = kept;
        if let Some(Run { journal, staging, .. }) = work.run.take() {
            // As long as there is a journal, the next run cleans up after this one.
            drop(staging);
            let _ = fs::remove_file(self.root.join(JOURNAL));
            drop(journal);
        }
        Ok(())
    }

    /// Whether nothing has changed since the folder was settled, and all units are to be kept.
    fn is_settled(&self, keep: impl Fn(&Unit) -> bool) -> bool {
        let work = self.work();
        work.run.is_none() && !self.root.join(JOURNAL).exists() && work.units.values().all(keep)
    }

    /// Removes files that no unit of `kept` has.
    fn remove_all<'a>(
        &self,
        files: impl Iterator<Item = &'a FileRecord>,
        kept: &BTreeMap<(Stage, String), Unit>,
    ) -> Result<(), StoreError> {
        let wanted: BTreeSet<&str> =
            kept.values().flat_map(|unit| unit.files.iter().map(|f| f.path.as_str())).collect();
        for record in files.filter(|record| !wanted.contains(record.path.as_str())) {
            let path = self.root.join(&record.path);
            file::refuse_link_above(&self.root, &path)?;
            // Already removed.
            let _ = fs::remove_file(path);
        }
        Ok(())
    }

    fn work(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

//! The folder of a dataset: whose it is, what is done in it.
//!
//! ```text
//! caves/
//! ├─ dataset.json      the specification, and what the caves follow from
//! ├─ items/000000/     a cave: its record, recipe, packages, certificate
//! ├─ index.csv         a line per cave; index.json has the same
//! ├─ failed.csv        caves that could not be made, and why
//! ├─ costs.csv         CPU seconds per cave, which differ from run to run
//! ├─ README.md         the data card, with sheet.png
//! └─ SHA256SUMS        of all files but costs.csv, for `sha256sum -c`
//! ```

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use plume::cave::CaveError;
use plume::store::StoreError;
use plume_disk::{Existing, regular, sealed, write_file};
use serde::{Deserialize, Serialize};

use crate::item::{self, RECORD, Record};
use crate::plan::Plan;
use crate::spec::Spec;

/// What says that a folder is a dataset.
pub const DATASET: &str = "dataset.json";
/// Locked while a run works in the folder.
pub const LOCK: &str = "dataset.lock";
/// Largest size of a record.
const MOST_BYTES: u64 = 64 << 20;

/// What the caves of a folder follow from.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Identity {
    version: String,
    fingerprint: String,
    caves: usize,
    pub spec: Spec,
}

/// The folder of a dataset, locked until this is dropped.
#[derive(Debug)]
pub struct Folder {
    root: PathBuf,
    _lock: File,
}

impl Folder {
    /// Opens or makes the folder of a plan.
    ///
    /// # Errors
    /// If another run works in it, it has caves of another plan or something else, or the disk fails.
    pub fn open(root: &Path, plan: &Plan) -> Result<Self, CaveError> {
        // A run that was killed at once has left nothing else.
        plume_disk::sweep(root);
        let is_new = || !root.join(DATASET).is_file();
        if is_new() && !is_vacant(root)? {
            return Err(CaveError::Usage {
                message: format!("{}: the folder is not empty and has no dataset", root.display()),
                hint: "choose a new or empty folder".into(),
            });
        }
        fs::create_dir_all(root).map_err(|error| StoreError::io(root, error))?;
        let path = root.join(LOCK);
        let lock = regular::append_no_follow(&path).map_err(|error| StoreError::io(&path, error))?;
        if let Err(TryLockError::WouldBlock) = lock.try_lock() {
            return Err(StoreError::InUse { path: root.to_owned() }.into());
        }
        let folder = Self { root: root.to_owned(), _lock: lock };
        // Asked again, as another run may have begun before the lock was taken.
        if is_new() {
            let identity = Identity {
                version: plume::VERSION.to_owned(),
                fingerprint: plan.fingerprint().to_owned(),
                caves: plan.len(),
                spec: plan.spec().clone(),
            };
            let text = serde_json::to_string_pretty(&identity).expect("it is plain data");
            folder.write(DATASET, sealed::seal(&text).as_bytes())?;
        } else if identity(root)?.fingerprint != plan.fingerprint() {
            return Err(CaveError::Usage {
                message: format!(
                    "{}: has caves of another specification, or of another version of Plume",
                    root.display()
                ),
                hint: "choose another folder, or go back to what these caves were made from".into(),
            });
        }
        Ok(folder)
    }

    /// Where it is.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Whether the cave of this number is done.
    pub fn has(&self, number: usize) -> bool {
        self.root.join(item::path(number)).join(RECORD).is_file()
    }

    /// What is known about a cave that is done.
    ///
    /// # Errors
    /// If its record cannot be read, or is damaged.
    pub fn record(&self, number: usize) -> Result<Record, CaveError> {
        read(&self.root.join(item::path(number)).join(RECORD))
    }

    /// The bytes of a file of the folder.
    ///
    /// # Errors
    /// I/O errors.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, CaveError> {
        let path = self.root.join(name);
        Ok(regular::read(&path, MOST_BYTES).map_err(|error| StoreError::io(&path, error))?)
    }

    /// Writes a file of the folder, which appears whole or stays as it was.
    ///
    /// # Errors
    /// I/O errors.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), CaveError> {
        let path = self.root.join(name);
        Ok(write_file(&path, Existing::Replace, bytes).map_err(|error| StoreError::io(&path, error))?)
    }
}

pub(crate) fn identity(root: &Path) -> Result<Identity, CaveError> {
    let path = root.join(DATASET);
    let sealed = regular::read(&path, MOST_BYTES).map_err(|error| StoreError::io(&path, error))?;
    let damaged = || StoreError::damaged(&path, "was changed since it was written");
    let text = sealed::unseal(&sealed).ok_or_else(damaged)?;
    Ok(serde_json::from_slice(&text).map_err(|error| StoreError::damaged(&path, error))?)
}

fn read<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, CaveError> {
    let bytes = regular::read(path, MOST_BYTES).map_err(|error| StoreError::io(path, error))?;
    Ok(serde_json::from_slice(&bytes).map_err(|error| StoreError::damaged(path, error))?)
}

fn is_vacant(root: &Path) -> Result<bool, StoreError> {
    match fs::read_dir(root) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(true),
        Err(error) => Err(StoreError::io(root, error)),
        Ok(entries) => Ok(entries.flatten().all(|entry| entry.file_name() == LOCK)),
    }
}

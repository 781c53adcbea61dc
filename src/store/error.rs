//! What can go wrong with a cave folder.

use std::path::{Path, PathBuf};

/// A cave folder could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// An I/O error.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A file of the folder is not what a stage has written: it was edited or damaged.
    #[error("{}: was changed since it was written: its SHA-256 does not match", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// Something in the folder cannot have been written by Plume.
    #[error("{}: {message}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// The folder contains something else.
    #[error("{}: the folder is not empty and does not contain a cave", path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
    },
    /// Another process is using the folder.
    #[error("{}: another run is using this folder", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
    },
}

impl StoreError {
    /// An I/O error at `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), source }
    }

    /// Something is wrong with the file or folder at `path`.
    pub fn damaged(path: &Path, message: impl ToString) -> Self {
        Self::Damaged { path: path.to_path_buf(), message: message.to_string() }
    }
}

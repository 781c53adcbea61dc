//! What can go wrong with a cave folder.

use std::path::{Path, PathBuf};

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
    /// A file of the folder is not what a stage has written: it was edited, or the disk has lost it.
    #[error("{}: is not the file that was written: its SHA-256 is another", path.display())]
    Changed {
        /// Which file.
        path: PathBuf,
    },
    /// Something in the folder cannot be what we wrote.
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

    /// Something is wrong with what is at `path`.
    pub fn damaged(path: &Path, message: impl ToString) -> Self {
        Self::Damaged { path: path.to_path_buf(), message: message.to_string() }
    }
}

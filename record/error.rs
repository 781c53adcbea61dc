//! What can go wrong in a recording.

use std::path::{Path, PathBuf};

use plume_exporters::ExportError;

/// A failed recording. The output folder is unchanged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// An input file cannot be read.
    #[error("{}: {source}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The path of the body is not one.
    #[error("path: {fault}")]
    Path {
        /// What is wrong with it.
        fault: String,
        /// What to do.
        hint: &'static str,
    },
    /// The file of the path is not one.
    #[error("{}: {fault}", file.display())]
    PathFile {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        fault: String,
        /// What to do.
        hint: &'static str,
    },
    /// The rig is faulty.
    #[error("{}: {fault}", file.display())]
    Rig {
        /// The file.
        file: PathBuf,
        /// What is wrong with it, and where.
        fault: String,
        /// What to do.
        hint: String,
    },
    /// The rig does not have what a layout needs.
    #[error("layout `{layout}` {fault}")]
    Layout {
        /// The layout.
        layout: &'static str,
        /// What it misses.
        fault: String,
        /// What to do.
        hint: &'static str,
    },
    /// There is no layout of this name.
    #[error("unknown layout {name}")]
    UnknownLayout {
        /// The requested name, quoted.
        name: String,
        /// The names of all layouts.
        known: String,
    },
    /// The scene cannot be read, or the output not be written.
    #[error(transparent)]
    Scene(#[from] ExportError),
    /// The disk failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The observer stopped it.
    #[error("interrupted")]
    Interrupted,
}

impl RecordError {
    pub(crate) fn path(fault: impl Into<String>, hint: &'static str) -> Self {
        Self::Path { fault: fault.into(), hint }
    }

    /// The same with the file of the path, if it is about that.
    pub(crate) fn in_file(self, file: &Path) -> Self {
        match self {
            Self::Path { fault, hint } => Self::PathFile { file: file.to_owned(), fault, hint },
            other => other,
        }
    }

    /// What to do about it; may be empty.
    pub fn hint(&self) -> String {
        match self {
            Self::Path { hint, .. } | Self::PathFile { hint, .. } | Self::Layout { hint, .. } => (*hint).to_owned(),
            Self::Rig { hint, .. } => hint.clone(),
            Self::UnknownLayout { known, .. } => format!("known: {known}"),
            Self::Scene(error) => error.hint().unwrap_or_default().to_owned(),
            _ => String::new(),
        }
    }
}

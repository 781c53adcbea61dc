//! What can go wrong in an export.

use std::io;
use std::path::PathBuf;

use crate::image_format::ImageFormat;

/// An export that did not happen. The output folder is as it was before.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// No row of the table has this name.
    #[error("unknown target `{name}`; known targets are {known}")]
    UnknownTarget {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The library that a target is written by has no format of this name.
    #[error("target `{target}` has no format `{name}`; known formats are {}", known.join(", "))]
    UnknownFormat {
        /// The target.
        target: &'static str,
        /// The format asked for; empty if none was.
        name: String,
        /// The formats there are.
        known: Vec<String>,
    },
    /// The settings of a target cannot be read.
    #[error("settings of target `{target}`: {source}")]
    Settings {
        /// Whose settings.
        target: &'static str,
        /// What is wrong with them.
        source: serde_json::Error,
    },
    /// The output folder holds something that a package must not replace.
    #[error("output folder is not empty: {}", path.display())]
    NotEmpty {
        /// The folder.
        path: PathBuf,
    },
    /// The output was to be replaced, but no export of ours has made it.
    #[error("output was not written by an export and is left alone: {}", path.display())]
    NotOurs {
        /// The folder or file.
        path: PathBuf,
    },
    /// A file that no export has written has the name of one of the package.
    #[error("output has a file of yours where the package has one of its own: {}", path.display())]
    InTheWay {
        /// The file.
        path: PathBuf,
    },
    /// There is a file where the output folder should be.
    #[error("output is not a folder: {}", path.display())]
    NotAFolder {
        /// The file.
        path: PathBuf,
    },
    /// There is a folder where the output file should be.
    #[error("output is not a file: {}", path.display())]
    NotAFile {
        /// The folder.
        path: PathBuf,
    },
    /// The output file is there already.
    #[error("output file exists: {}", path.display())]
    FileExists {
        /// The file.
        path: PathBuf,
    },
    /// A path inside the package is absolute, climbs out of it, or is taken.
    #[error("package path {fault}: `{path}`")]
    BadPath {
        /// The path inside the package.
        path: String,
        /// What is wrong with it.
        fault: &'static str,
    },
    /// The scene breaks a promise of the scene module.
    #[error("scene `{scene}`: {fault}")]
    BadScene {
        /// Name of the scene.
        scene: String,
        /// What is wrong and where.
        fault: String,
    },
    /// A chunk cannot be loaded.
    #[error("cannot load chunk {index} of scene `{scene}`: {source}")]
    Load {
        /// Name of the scene.
        scene: String,
        /// Index of the chunk.
        index: usize,
        /// What happened.
        source: io::Error,
    },
    /// A file is larger than its format can say.
    #[error("{path} would be {bytes} bytes, more than {format} can hold")]
    TooLarge {
        /// The path inside the package.
        path: String,
        /// The format.
        format: &'static str,
        /// Bytes the file would have.
        bytes: u64,
    },
    /// An image is of a kind that the simulator does not read.
    #[error("target `{target}` takes {} images only: {}", names(wanted), path.display())]
    UnfitImage {
        /// Name of the target.
        target: &'static str,
        /// The image.
        path: PathBuf,
        /// The kinds that it reads.
        wanted: &'static [ImageFormat],
    },
    /// A library that the target is written by is not there, or not the right one.
    #[error("{message}")]
    MissingPart {
        /// What is missing, and for what.
        message: String,
        /// How to get it.
        hint: String,
    },
    /// A library that writes for us refused.
    #[error("{library} could not write {path}: {message}")]
    Library {
        /// Its name.
        library: &'static str,
        /// What it was to write.
        path: String,
        /// What it said.
        message: String,
    },
    /// A file cannot be read or written. The text names the file, the kind says why, e.g. a full disk.
    #[error(transparent)]
    Io(#[from] io::Error),
}

impl ExportError {
    pub(crate) fn no_usd(target: &str) -> Self {
        Self::MissingPart {
            message: format!("target `{target}` is written by the Python package usd-core, which this program has not"),
            hint: "use the `plume` command of the Python package plume-caves".to_owned(),
        }
    }

    /// What to do about it, where there is something to do.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::MissingPart { hint, .. } => Some(hint),
            Self::NotEmpty { .. } => Some("name a new folder, or replace the package with `--force`"),
            Self::FileExists { .. } => Some("name a new file, or replace this one with `--force`"),
            Self::InTheWay { .. } => Some("move it out of the package, then export again"),
            Self::NotOurs { .. } => Some("name a new place, or empty this one yourself"),
            Self::TooLarge { .. } => Some("write one file per chunk: `per_chunk = true`"),
            Self::UnfitImage { .. } => Some("make the cave with other images: `--set texture.format=png`"),
            Self::Io(source) if source.kind() == io::ErrorKind::StorageFull => {
                Some("free some space, or make smaller textures")
            }
            _ => None,
        }
    }

    /// Whether the user asked for something that cannot be, as opposed to a machine that failed.
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::UnknownTarget { .. }
                | Self::UnknownFormat { .. }
                | Self::Settings { .. }
                | Self::NotEmpty { .. }
                | Self::NotOurs { .. }
                | Self::InTheWay { .. }
                | Self::NotAFolder { .. }
                | Self::NotAFile { .. }
                | Self::FileExists { .. }
                | Self::TooLarge { .. }
                | Self::UnfitImage { .. }
        )
    }
}

fn names(formats: &[ImageFormat]) -> String {
    formats.iter().map(|format| format.name()).collect::<Vec<_>>().join(" and ")
}

/// The same error, its text led by the file it is about.
pub(crate) fn at(path: impl std::fmt::Display, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{path}: {error}"))
}

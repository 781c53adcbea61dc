//! What can go wrong in an export.
//!
//! ```
//! use plume_exporters::target;
//!
//! let error = target("gazebi").err().unwrap();
//! assert!(error.is_usage() && error.to_string().starts_with("unknown target `gazebi`"));
//! ```

use std::io;
use std::path::PathBuf;

use crate::image_format::ImageFormat;

/// A failed export. The output folder is unchanged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// There is no target of this name.
    #[error("unknown target `{name}`; known targets are {known}")]
    UnknownTarget {
        /// The requested name.
        name: String,
        /// The names of all targets.
        known: String,
    },
    /// The library that writes a target has no format of this name.
    #[error("target `{target}` has no format `{name}`; known formats are {}", known.join(", "))]
    UnknownFormat {
        /// The target.
        target: &'static str,
        /// The requested format; empty if there was none.
        name: String,
        /// The formats of the library.
        known: Vec<String>,
    },
    /// The settings of a target cannot be read.
    #[error("settings of target `{target}`: {source}")]
    Settings {
        /// The target.
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
    /// The output was to be replaced, but was not written by an export.
    #[error("output was not written by an export and is not replaced: {}", path.display())]
    NotOurs {
        /// The folder or file.
        path: PathBuf,
    },
    /// A file that was not written by an export has the name of a file of the package.
    #[error("output contains a file of yours with the name of a file of the package: {}", path.display())]
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
    /// The output file exists already.
    #[error("output file already exists: {}", path.display())]
    FileExists {
        /// The file.
        path: PathBuf,
    },
    /// A path inside the package is absolute, leads out of it, or is taken.
    #[error("package path {fault}: `{path}`")]
    BadPath {
        /// The path inside the package.
        path: String,
        /// What is wrong with it.
        fault: &'static str,
    },
    /// The scene violates an invariant of the scene module.
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
        /// The cause.
        source: io::Error,
    },
    /// A file exceeds the size limit of its format.
    #[error("{path} would have {bytes} bytes, more than {format} allows")]
    TooLarge {
        /// The path inside the package.
        path: String,
        /// The format.
        format: &'static str,
        /// Bytes the file would have.
        bytes: u64,
    },
    /// A format does not reach as far as the scene.
    #[error("{path}: {format} reaches {reach_m} m from the origin, and the scene is larger")]
    TooFar {
        /// The path inside the package.
        path: String,
        /// The format.
        format: &'static str,
        /// How far it reaches, in metres.
        reach_m: f64,
    },
    /// A height field cannot hold the floors of a chunk.
    #[error("a height field holds one floor, and {area_m2:.0} m² of the floors of {chunk} are above another")]
    StackedFloors {
        /// The chunk.
        chunk: String,
        /// How much of them, in square metres.
        area_m2: f64,
    },
    /// An image has a format that the simulator does not read.
    #[error("target `{target}` supports only {} images: {}", names(wanted), path.display())]
    UnfitImage {
        /// Name of the target.
        target: &'static str,
        /// The image.
        path: PathBuf,
        /// The formats that it reads.
        wanted: &'static [ImageFormat],
    },
    /// A library needed to write the target is missing or unsuitable.
    #[error("{message}")]
    MissingPart {
        /// What is missing, and what for.
        message: String,
        /// How to get it.
        hint: String,
    },
    /// A library failed to write a file.
    #[error("{library} could not write {path}: {message}")]
    Library {
        /// Its name.
        library: &'static str,
        /// The file.
        path: String,
        /// Its error message.
        message: String,
    },
    /// A file cannot be read or written. The text names the file, the kind tells the cause, e.g. a full disk.
    #[error(transparent)]
    Io(#[from] io::Error),
}

impl ExportError {
    pub(crate) fn no_usd(target: &str) -> Self {
        Self::MissingPart {
            message: format!("target `{target}` needs the Python package usd-core, which this program does not have"),
            hint: "use the `plume` command of the Python package plume-caves".to_owned(),
        }
    }

    /// What to do about it, where there is something to do.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::MissingPart { hint, .. } => Some(hint),
            Self::NotEmpty { .. } => Some("choose a new folder, or replace the package with `--force`"),
            Self::FileExists { .. } => Some("choose a new file, or replace this one with `--force`"),
            Self::InTheWay { .. } => Some("move it out of the package, then export again"),
            Self::NotOurs { .. } => Some("choose another path, or remove this one yourself"),
            Self::TooLarge { format: "USD", .. } => Some("choose other collision shapes: `collision=triangles`"),
            Self::TooLarge { .. } => Some("write one file per chunk: `per_chunk = true`"),
            Self::TooFar { .. } => Some("choose larger cells (`voxel_m`), or leave the file out (`files`)"),
            Self::StackedFloors { .. } => Some("choose other collision shapes: `collision=pieces`"),
            Self::UnfitImage { .. } => Some("make the cave with another image format: `--set texture.format=png`"),
            Self::Io(source) if source.kind() == io::ErrorKind::StorageFull => {
                Some("free some space, or make smaller textures")
            }
            _ => None,
        }
    }

    /// Whether the user asked for something impossible, as opposed to a failure of the machine.
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
                | Self::TooFar { .. }
                | Self::StackedFloors { .. }
                | Self::UnfitImage { .. }
        )
    }
}

fn names(formats: &[ImageFormat]) -> String {
    formats.iter().map(|format| format.name()).collect::<Vec<_>>().join(" and ")
}

/// The same error, prefixed with the file.
pub(crate) fn at(path: impl std::fmt::Display, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{path}: {error}"))
}

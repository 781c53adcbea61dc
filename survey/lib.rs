//! Graphs and cave surveys as files: one file and one row for each format.
//!
//! Readers treat their input as hostile: they respect the limits in [`limits`], open only files that the format requires,
//! and report where an error is.
//!
//! ```
//! use std::path::Path;
//!
//! use plume_graph::NoOutside;
//! use plume_survey::{FORMATS, Parts, format_of};
//!
//! assert!(FORMATS.iter().any(|row| row.name == "therion"));
//! let row = format_of(Path::new("cave.svx"), |row| row.read.is_some()).ok_or("no such format")?;
//! assert_eq!(row.name, "svx");
//! assert!(plume_survey::read(Path::new("cave.svx"), Parts::Keep, &NoOutside).is_err(), "there is no such file");
//! # Ok::<(), &str>(())
//! ```

mod centreline;
mod compass;
mod csv;
mod dot;
mod draft;
mod fields;
mod files;
mod graphml;
pub mod json;
mod karst;
#[doc(hidden)]
pub mod limits;
mod measure;
mod origin;
mod parts;
mod survex3d;
mod survey;
mod svx;
#[cfg(test)]
mod tests;
mod text;
mod therion;
mod traverse;
mod unplaced;
mod walls;

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use survey::Tally;

use self::draft::Draft;
use plume_graph::{Graph, Node, Outside};

/// What to do with disconnected parts of a graph.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Parts {
    /// Report an error.
    #[default]
    Refuse,
    /// Join them where they are nearest to each other.
    Join,
    /// Keep them as they are.
    Keep,
    /// Keep only the part with the greatest length of passages.
    Longest,
}

/// The content of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The graph: at least two nodes, unique ids, finite lengths.
    pub graph: Graph,
    /// The recipe it was made from, if the file has one.
    pub recipe: Option<Value>,
    /// What was dropped or filled in.
    pub tally: Tally,
    /// Readings that are probably mistakes, in the order of the file: the first hundred of [`Tally::doubtful`].
    pub warnings: Vec<Warning>,
}

/// Something that can be read, but is probably a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where it is.
    pub place: Place,
    /// What is doubtful, lower case.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl Import {
    /// What is probably a mistake, as lines for the user; the last one counts what is not listed.
    pub fn doubts(&self) -> impl Iterator<Item = String> {
        let more = self.tally.doubtful.saturating_sub(self.warnings.len());
        let more = (more > 0).then(|| format!("{more} more doubtful readings are not listed"));
        self.warnings.iter().map(ToString::to_string).chain(more)
    }

    /// The same with all lengths multiplied by a factor. Nodes that end up in one place, to 1 mm, are welded.
    ///
    /// # Errors
    /// If nothing is left of it, or it reaches too far from the origin.
    pub fn scaled(self, factor: f64, path: &Path) -> Result<Self, ReadError> {
        let Self { graph, recipe, tally, warnings } = self;
        let Graph { nodes, edges, georeference } = graph.scaled(factor);
        let is_near = |node: &Node| node.position.iter().all(|x| x.abs() <= limits::MAX_LENGTH_M);
        if !nodes.iter().all(is_near) {
            return Err(ReadError::whole(path, "is too far from the origin after scaling", text::LENGTH_HINT));
        }
        let finished = Draft { nodes, edges, georeference }.finished(Parts::Keep);
        let name = |node: usize| format!("node {node}");
        let (graph, lost) = finished.map_err(|error| error.into_error(path, name))?;
        Ok(Self { graph, recipe, tally: Tally { left_out: tally.left_out + lost.left_out, ..tally }, warnings })
    }
}

/// A file to be read, with access to files that it includes.
pub struct Source<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its content.
    pub bytes: &'a [u8],
    /// Provides included files.
    pub outside: &'a dyn Outside,
}

impl Source<'_> {
    /// Whether a file that this one includes is outside its folder.
    fn is_outside_file(&self, path: &Path) -> bool {
        !self.outside.is_below(self.path.parent().unwrap_or(Path::new("")), path)
    }

    /// Whether such a file may be read.
    fn refuses(&self, is_outside_file: bool) -> bool {
        is_outside_file && !self.outside.allows_outside_files()
    }
}

/// Messages about an included file outside the folder, and about its lines if it may be read: its text is never shown,
/// since the author of the including file may not be the user.
const OUTSIDE_FILE: &str = "is outside the folder of the imported file";
const OUTSIDE_HINT: &str = "if you trust the file that includes it, add --allow-outside";
const OUTSIDE_LINE: &str = "cannot be read";
const OUTSIDE_READING: &str = "has an implausible reading";
const OUTSIDE_LINE_HINT: &str = "this file is outside the folder of the imported one, so none of its text is shown";

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The part of the name between the requested name and the extension: empty, or `_nodes`.
    pub suffix: &'static str,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Reads a file and treats its parts as asked.
pub type Reader = fn(&Source, Parts) -> Result<Import, ReadError>;

/// A row of [`FORMATS`].
pub struct FormatRow {
    /// Name on the command line.
    pub name: &'static str,
    /// Extensions, lower case; the first is used for writing.
    pub endings: &'static [&'static str],
    /// One line for `plume list`.
    pub summary: &'static str,
    /// The reader, if the format can be read.
    pub read: Option<Reader>,
    /// The writer, if the format can be written.
    pub write: Option<fn(&Graph) -> Vec<Written>>,
}

/// All formats, the lossless one first. An extension that ends with another comes before that one.
pub static FORMATS: &[FormatRow] = &[
    FormatRow {
        name: "json",
        endings: &[".json"],
        summary: "graph JSON, or data.json of the original PLUME",
        read: Some(json::import),
        write: Some(json::export),
    },
    FormatRow {
        name: "graphml",
        endings: &[".graphml"],
        summary: "GraphML of networkx, igraph, Gephi, yEd",
        read: Some(graphml::import),
        write: Some(graphml::export),
    },
    FormatRow {
        name: "karstnet",
        endings: &["_nodes.dat", "_links.dat"],
        summary: "pair of files of karstnet: X_nodes.dat and X_links.dat",
        read: Some(karst::import),
        write: Some(karst::export),
    },
    FormatRow {
        name: "csv",
        endings: &[".csv"],
        summary: "a table of passages: x1,y1,z1,x2,y2,z2",
        read: Some(csv::import),
        write: Some(csv::export),
    },
    FormatRow {
        name: "survex-3d",
        endings: &[".3d"],
        summary: "a survey processed by Survex, with its cross-sections",
        read: Some(survex3d::import),
        write: None,
    },
    FormatRow {
        name: "svx",
        endings: &[".svx"],
        summary: "raw survey data of Survex",
        read: Some(svx::import),
        write: None,
    },
    FormatRow {
        name: "therion",
        endings: &[".th"],
        summary: "raw centreline data of Therion",
        read: Some(therion::import),
        write: None,
    },
    FormatRow {
        name: "compass",
        endings: &[".dat", ".mak"],
        summary: "survey data and projects of Compass",
        read: Some(compass::import),
        write: None,
    },
    FormatRow {
        name: "walls",
        endings: &[".srv"],
        summary: "survey data of Walls",
        read: Some(walls::import),
        write: None,
    },
    FormatRow {
        name: "dot",
        endings: &[".dot", ".gv"],
        summary: "the plan for Graphviz: neato -n -Tsvg",
        read: None,
        write: Some(dot::export),
    },
];

/// The format called `name`.
pub fn format(name: &str) -> Option<&'static FormatRow> {
    FORMATS.iter().find(|row| row.name == name)
}

/// The format of this file name's extension. Of several, the first for which `has` is true.
pub fn format_of(path: &Path, has: fn(&FormatRow) -> bool) -> Option<&'static FormatRow> {
    let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
    FORMATS.iter().find(|row| has(row) && row.endings.iter().any(|ending| name.ends_with(ending)))
}

/// Reads the file at `path` by its extension.
///
/// # Errors
/// If the extension is unknown, the file cannot be read, or it is not a cave.
pub fn read(path: &Path, parts: Parts, outside: &dyn Outside) -> Result<Import, ReadError> {
    let Some(row) = format_of(path, |row| row.read.is_some()) else {
        // What does not exist is not said to have an unknown extension.
        if let Some(error) = outside.read(path).err().filter(|error| error.kind() == ErrorKind::NotFound) {
            return Err(ReadError::whole(path, error.to_string(), ""));
        }
        let known = FORMATS.iter().filter(|row| row.read.is_some()).flat_map(|row| row.endings);
        let known: Vec<&str> = known.copied().collect();
        let hint = format!("known extensions: {}", known.join(", "));
        return Err(ReadError::whole(path, "has no known graph format", hint));
    };
    read_as(row, path, parts, outside)
}

/// Reads the file at `path` in this format.
///
/// # Errors
/// If the format cannot be read, the file cannot be read, or it is not a cave.
pub fn read_as(row: &FormatRow, path: &Path, parts: Parts, outside: &dyn Outside) -> Result<Import, ReadError> {
    let Some(reader) = row.read else {
        return Err(ReadError::whole(
            path,
            format!("{} can be written but not read", row.name),
            "see `plume list formats`",
        ));
    };
    let bytes = outside.read(path).map_err(|error| ReadError::whole(path, error.to_string(), ""))?;
    reader(&Source { path, bytes: &bytes, outside }, parts)
}

/// A file that could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {message}")]
pub struct ReadError {
    /// Where the error is.
    pub place: Place,
    /// What is wrong, lower case.
    pub message: String,
    /// What to do; may be empty.
    pub hint: String,
}

impl ReadError {
    /// An error of the whole file.
    pub fn whole(path: &Path, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { place: Place::File(path.to_path_buf()), message: message.into(), hint: hint.into() }
    }

    /// An error in a line, counted from 1.
    pub fn line(path: &Path, line: usize, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { place: Place::Line(path.to_path_buf(), line), message: message.into(), hint: hint.into() }
    }

    /// An error at a byte, counted from 0.
    pub fn byte(path: &Path, byte: usize, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { place: Place::Byte(path.to_path_buf(), byte), message: message.into(), hint: hint.into() }
    }
}

/// Where an error is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a file.
    File(PathBuf),
    /// In a line of a text file, counted from 1.
    Line(PathBuf, usize),
    /// At a byte, counted from 0.
    Byte(PathBuf, usize),
}

impl Place {
    /// The file it is in.
    pub fn path(&self) -> &Path {
        match self {
            Self::File(path) | Self::Line(path, _) | Self::Byte(path, _) => path,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Line(path, line) => write!(f, "{}:{line}", path.display()),
            Self::Byte(path, byte) => write!(f, "{} at byte {byte}", path.display()),
        }
    }
}

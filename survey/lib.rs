//! Graphs and cave surveys as files: one file and one row for each format.
//!
//! A reader takes what it is given for hostile: it holds to the limits in [`limits`], follows no link that the format does
//! not need, and says where a fault is.

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
mod text;
mod therion;
mod traverse;

use std::fmt;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use survey::Tally;

use self::draft::Draft;
use plume_graph::{Graph, Node, Outside};

/// What becomes of parts of a graph that no passage joins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Parts {
    /// They are an error.
    #[default]
    Refuse,
    /// They are joined where they are nearest to each other.
    Join,
    /// They stay as they are.
    Keep,
    /// The one with the longest passages stays.
    Longest,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The graph: at least two nodes, unique ids, all lengths finite.
    pub graph: Graph,
    /// The recipe it was made from, where the file has one.
    pub recipe: Option<Value>,
    /// What was left out or filled in.
    pub tally: Tally,
}

impl Import {
    /// The same with every length times a factor. What comes to lie in one place, to 1 mm, is welded.
    ///
    /// # Errors
    /// When nothing is left of it, or it reaches too far from the origin.
    pub fn scaled(self, factor: f64, path: &Path) -> Result<Self, ReadError> {
        let Self { graph, recipe, tally } = self;
        let Graph { nodes, edges } = graph.scaled(factor);
        let is_near = |node: &Node| node.position.iter().all(|x| x.abs() <= limits::MAX_LENGTH_M);
        if !nodes.iter().all(is_near) {
            return Err(ReadError::whole(path, "is too far away, scaled", text::LENGTH_HINT));
        }
        let finished = Draft { nodes, edges }.finished(Parts::Keep);
        let name = |node: usize| format!("node {node}");
        let (graph, lost) = finished.map_err(|error| error.into_error(path, name))?;
        Ok(Self { graph, recipe, tally: Tally { left_out: tally.left_out + lost.left_out, ..tally } })
    }
}

/// A file to be read, and the world it may ask for others.
pub struct Source<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its content.
    pub bytes: &'a [u8],
    /// Answers when the file names another.
    pub outside: &'a dyn Outside,
}

impl Source<'_> {
    /// Whether a file that this one leads to lies elsewhere than below its folder.
    fn is_stray(&self, path: &Path) -> bool {
        !self.outside.is_below(self.path.parent().unwrap_or(Path::new("")), path)
    }

    /// Whether such a file is read.
    fn refuses(&self, is_stray: bool) -> bool {
        is_stray && !self.outside.allows_strays()
    }
}

/// What is said of a file that lies elsewhere, and of its lines where it is read all the same: nothing of it is shown, since
/// whoever wrote the file that names it may not be who asks for it.
const STRAY: &str = "lies outside the folder of the file that was named";
const STRAY_HINT: &str = "if you trust the file that names it, add --allow-outside";
const STRAY_LINE: &str = "cannot be read";
const STRAY_LINE_HINT: &str =
    "this file lies outside the folder of the one that was named, so none of its text is shown";

/// A file that a format writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// What stands between the name that was asked for and the extension: nothing, or `_nodes`.
    pub suffix: &'static str,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Reads a file and does with its parts as asked.
pub type Reader = fn(&Source, Parts) -> Result<Import, ReadError>;

/// A row of [`FORMATS`].
pub struct FormatRow {
    /// Name on the command line.
    pub name: &'static str,
    /// What file names end with, lower case; the first is the one that is written.
    pub endings: &'static [&'static str],
    /// One line for `plume list`.
    pub summary: &'static str,
    /// Reads a file, where the format is read.
    pub read: Option<Reader>,
    /// Writes a graph, where the format is written.
    pub write: Option<fn(&Graph) -> Vec<Written>>,
}

/// Every format, the one that holds all of a graph first. Endings that others end with come before them.
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
        summary: "karstnet's pair of X_nodes.dat and X_links.dat",
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
        summary: "a survey that Survex has processed, with its cross-sections",
        read: Some(survex3d::import),
        write: None,
    },
    FormatRow {
        name: "svx",
        endings: &[".svx"],
        summary: "survey data of Survex, as it was measured",
        read: Some(svx::import),
        write: None,
    },
    FormatRow {
        name: "therion",
        endings: &[".th"],
        summary: "the centreline of a Therion survey, as it was measured",
        read: Some(therion::import),
        write: None,
    },
    FormatRow {
        name: "compass",
        endings: &[".dat", ".mak"],
        summary: "survey books of Compass and their projects",
        read: Some(compass::import),
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

/// The format that this file name's ending tells. Of several, the first that `has` what is wanted.
pub fn format_of(path: &Path, has: fn(&FormatRow) -> bool) -> Option<&'static FormatRow> {
    let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
    FORMATS.iter().find(|row| has(row) && row.endings.iter().any(|ending| name.ends_with(ending)))
}

/// Reads the file at `path` as its name says.
///
/// # Errors
/// When the name tells no format, the file cannot be read, or no cave can be made of it.
pub fn read(path: &Path, parts: Parts, outside: &dyn Outside) -> Result<Import, ReadError> {
    let Some(row) = format_of(path, |row| row.read.is_some()) else {
        let known = FORMATS.iter().filter(|row| row.read.is_some()).flat_map(|row| row.endings);
        let known: Vec<&str> = known.copied().collect();
        let hint = format!("known names end with {}", known.join(", "));
        return Err(ReadError::whole(path, "is of no known graph format", hint));
    };
    read_as(row, path, parts, outside)
}

/// Reads the file at `path` in this format.
///
/// # Errors
/// When the format is not read, the file cannot be read, or no cave can be made of it.
pub fn read_as(row: &FormatRow, path: &Path, parts: Parts, outside: &dyn Outside) -> Result<Import, ReadError> {
    let Some(reader) = row.read else {
        return Err(ReadError::whole(path, format!("{} is written, not read", row.name), "see `plume list formats`"));
    };
    let bytes = outside.read(path).map_err(|error| ReadError::whole(path, error.to_string(), ""))?;
    reader(&Source { path, bytes: &bytes, outside }, parts)
}

/// A file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {message}")]
pub struct ReadError {
    /// Where the fault is.
    pub place: Place,
    /// What is wrong, lower case.
    pub message: String,
    /// What to do; may be empty.
    pub hint: String,
}

impl ReadError {
    /// A fault of the whole file.
    pub fn whole(path: &Path, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { place: Place::File(path.to_path_buf()), message: message.into(), hint: hint.into() }
    }

    /// A fault in a line, counted from 1.
    pub fn line(path: &Path, line: usize, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { place: Place::Line(path.to_path_buf(), line), message: message.into(), hint: hint.into() }
    }

    /// A fault at a byte, counted from 0.
    pub fn byte(path: &Path, byte: usize, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { place: Place::Byte(path.to_path_buf(), byte), message: message.into(), hint: hint.into() }
    }
}

/// Where a fault is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Somewhere in a file.
    File(PathBuf),
    /// In a line of a text, counted from 1.
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

//! Errors in graph files.

use crate::draft::{self, DraftError};
use crate::parts;

/// A graph file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The text is not JSON.
    #[error("line {line} column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The message of the parser.
        message: String,
    },
    /// A literal that Python writes for numbers that are not finite.
    #[error("line {line} column {column}: `{literal}` is not a JSON number")]
    NotANumber {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// `NaN` or `Infinity`.
        literal: &'static str,
    },
    /// The file is JSON but not a graph.
    #[error("{what}")]
    Shape {
        /// What was expected and what was found.
        what: String,
    },
    /// A faulty node.
    #[error("{node}: `{key}` {fault}")]
    Node {
        /// `node` and its id, or its index in the file.
        node: String,
        /// Path of the key inside the node.
        key: &'static str,
        /// What is wrong with it.
        fault: String,
    },
    /// A duplicate id.
    #[error("two nodes have the id {id}")]
    DuplicateId {
        /// The id.
        id: u64,
    },
    /// No passages.
    #[error("a graph with {nodes} is not a cave")]
    TooFew {
        /// The number of nodes, in words.
        nodes: &'static str,
    },
    /// Too many nodes or edges.
    #[error("the graph has more than {most} {what}")]
    TooMany {
        /// Nodes or edges.
        what: &'static str,
        /// The limit.
        most: usize,
    },
    /// A cycle of parents.
    #[error("node {id} is its own ancestor")]
    ParentCircle {
        /// One of them.
        id: u64,
    },
    /// A node without passages.
    #[error("{node} has no passages")]
    Lone {
        /// `node` and its id.
        node: String,
    },
    /// Disconnected parts.
    #[error("{what}")]
    Disconnected {
        /// Number of parts and a node of each, at most ten.
        what: String,
    },
}

impl ReadError {
    pub(super) fn of_draft(error: DraftError, name: impl Fn(usize) -> String) -> Self {
        match error {
            DraftError::TooFew(nodes) => Self::TooFew { nodes },
            DraftError::Lone(node) => Self::Lone { node: name(node) },
            DraftError::Disconnected(error) => Self::Disconnected { what: error.message(name) },
        }
    }

    /// What to do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Syntax { .. } => "a graph file is JSON as written by `plume graph`",
            Self::NotANumber { .. } => {
                "Python writes this for a coordinate that is not finite; fix the program that made the file"
            }
            Self::Shape { .. } => "a graph file is an object with a list of nodes under `nodes`",
            Self::Node { key, .. } => node_hint(key),
            Self::DuplicateId { .. } => "give every node a unique id",
            Self::TooFew { .. } => draft::TOO_FEW_HINT,
            Self::TooMany { .. } => "split the graph into several caves",
            Self::ParentCircle { .. } => "`parent` is the node it grew from, and null at the origin",
            Self::Lone { .. } => draft::LONE_HINT,
            Self::Disconnected { .. } => parts::HINT,
        }
    }
}

fn node_hint(key: &str) -> &'static str {
    match key {
        "id" => "ids are non-negative whole numbers",
        "radius" => "the radius is the distance to the nearest node, in metres",
        "edges" | "parent" => "edges and parents refer to other nodes by id",
        key if key.starts_with("coordinates") => {
            "coordinates are `x`, `y` and `z` in metres, at most 1000 km from the origin"
        }
        key if key.starts_with("section") => "a section has a `width_m` and a `height_m`, in metres",
        _ => "omit the key to use its default",
    }
}

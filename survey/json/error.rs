//! What can be wrong with a graph file.

use crate::draft::{self, DraftError};
use crate::parts;

/// A graph file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The text is no JSON.
    #[error("line {line} column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the parser says.
        message: String,
    },
    /// A number that is none, as Python writes it.
    #[error("line {line} column {column}: `{literal}` is not a JSON number")]
    NotANumber {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// `NaN` or `Infinity`.
        literal: &'static str,
    },
    /// The file is JSON but no graph.
    #[error("{what}")]
    Shape {
        /// What was expected and what was found.
        what: String,
    },
    /// Something about one node.
    #[error("{node}: `{key}` {fault}")]
    Node {
        /// `node` and its id, or its place in the file.
        node: String,
        /// Path of the key inside the node.
        key: &'static str,
        /// What is wrong there.
        fault: String,
    },
    /// An id that is not unique.
    #[error("two nodes have the id {id}")]
    DuplicateId {
        /// The id.
        id: u64,
    },
    /// No passage anywhere.
    #[error("a graph of {nodes} makes no cave")]
    TooFew {
        /// How many nodes there are, in words.
        nodes: &'static str,
    },
    /// More than can be handled.
    #[error("the graph has more than {most} {what}")]
    TooMany {
        /// Nodes or edges.
        what: &'static str,
        /// How many there may be.
        most: usize,
    },
    /// Nodes that descend from themselves.
    #[error("the parents of node {id} lead back to it")]
    ParentCircle {
        /// One of them.
        id: u64,
    },
    /// A node that no passage leads to.
    #[error("{node} is on no passage")]
    Lone {
        /// `node` and its id.
        node: String,
    },
    /// Parts that no passage joins.
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
            Self::Syntax { .. } => "a graph file is JSON, as `plume graph` writes it",
            Self::NotANumber { .. } => {
                "Python writes this for a coordinate that is not finite; mend the program that made the file"
            }
            Self::Shape { .. } => "a graph file is an object with a list of nodes under `nodes`",
            Self::Node { key, .. } => node_hint(key),
            Self::DuplicateId { .. } => "give every node an id of its own",
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
        "id" => "ids are whole numbers from 0 on",
        "radius" => "the radius is the distance to the next node, in metres",
        "edges" | "parent" => "edges and parents name other nodes by their ids",
        key if key.starts_with("coordinates") => {
            "coordinates are `x`, `y` and `z` in metres, at most 1000 km from the origin"
        }
        key if key.starts_with("section") => "a section has a `width_m` and a `height_m`, in metres",
        _ => "leave the key out to have its default",
    }
}

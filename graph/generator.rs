//! What every generator of graphs is.

use crate::{Graph, Outside};

/// Makes a graph from a seed. Its settings are its fields.
pub trait Generator: std::fmt::Debug + Send + Sync {
    /// The graph of this seed: the same for the same settings, seed and answers from outside on every machine.
    ///
    /// # Errors
    /// When the settings leave no room for what was asked, or the outside refuses a file or a program.
    fn generate(&self, seed: u64, outside: &dyn Outside) -> Result<Graph, GenerateError>;
}

/// A generator could not reach what was asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct GenerateError {
    /// What could not be reached, lower case.
    pub message: String,
    /// What to change.
    pub hint: String,
}

impl GenerateError {
    /// What could not be reached, and what to change.
    pub fn new(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { message: message.into(), hint: hint.into() }
    }
}

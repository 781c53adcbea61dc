//! The trait of all graph generators.

use crate::{Graph, Outside};

/// Makes a graph from a seed. The fields are the settings.
pub trait Generator: std::fmt::Debug + Send + Sync {
    /// The graph of this seed: the same on every machine for the same settings, seed and answers of `outside`.
    ///
    /// # Errors
    /// If the settings leave no room for what was asked, or `outside` refuses a file or a program.
    fn generate(&self, seed: u64, outside: &dyn Outside) -> Result<Graph, GenerateError>;
}

/// A generator could not make the requested graph.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct GenerateError {
    /// What is not possible, lower case.
    pub message: String,
    /// What to change.
    pub hint: String,
}

impl GenerateError {
    /// What is not possible, and what to change.
    pub fn new(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { message: message.into(), hint: hint.into() }
    }
}

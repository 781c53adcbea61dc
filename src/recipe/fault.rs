//! What is wrong with a recipe, where, and what to do about it.

use std::fmt;
use std::path::PathBuf;

use plume_graph::echo::shown;

/// Where a value was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A line of a file, counted from 1.
    Line(PathBuf, usize),
    /// A file as a whole.
    File(PathBuf),
    /// A `key=value` pair from the command line.
    Override(String),
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(file, line) => write!(f, "{}:{line}", file.display()),
            Self::File(file) => write!(f, "{}", file.display()),
            Self::Override(text) => f.write_str(&shown(text)),
        }
    }
}

/// One fault: where, what, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where.
    pub origin: Origin,
    /// What, naming the key.
    pub message: String,
    /// What to do; may be empty.
    pub hint: String,
}

/// Number of faults listed; the others are counted.
const MOST_TOLD: usize = 20;

/// The faults of a recipe.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error)]
pub struct Faults {
    /// The first faults.
    pub told: Vec<Fault>,
    /// The number of further faults.
    pub more: usize,
}

impl Faults {
    /// Adds a fault; `said` is called only if it is listed.
    pub(super) fn add(&mut self, said: impl FnOnce() -> Fault) {
        if self.told.len() < MOST_TOLD {
            self.told.push(said());
        } else {
            self.more += 1;
        }
    }

    /// # Errors
    /// These faults, if there are any.
    pub(super) fn or<T>(self, value: T) -> Result<T, Self> {
        if self.told.is_empty() { Ok(value) } else { Err(self) }
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.told.iter().enumerate() {
            if i > 0 {
                f.write_str("\nerror: ")?;
            }
            write!(f, "{}: {}", fault.origin, fault.message)?;
            if !fault.hint.is_empty() {
                write!(f, "\n hint: {}", fault.hint)?;
            }
        }
        if self.more > 0 {
            write!(f, "\nerror: and {} more", self.more)?;
        }
        Ok(())
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self { told: vec![fault], more: 0 }
    }
}

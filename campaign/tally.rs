//! What an attack has tried and what came of it.

use std::collections::BTreeMap;

/// Number of failures reported in full; the rest are counted.
const SHOWN: usize = 12;

/// The count of one attack.
#[derive(Default)]
pub struct Tally {
    /// Tries.
    pub tried: usize,
    /// Tries that the product did not withstand.
    pub failed: usize,
    /// The first of them, each so that a person can repeat it.
    pub failures: Vec<String>,
    /// Tries that neither held nor failed, by what became of them: `slow`, `aborted by the allocator`.
    pub apart: BTreeMap<&'static str, usize>,
    /// What could not be tried here, and why.
    pub skipped: Vec<String>,
    /// What is worth knowing of the tries.
    pub notes: Vec<String>,
}

impl Tally {
    /// Counts an attempt; `what` describes it, a failure its result.
    pub fn enter(&mut self, what: &str, held: Result<(), String>) {
        self.tried += 1;
        let Err(reason) = held else { return };
        self.failed += 1;
        if self.failures.len() < SHOWN {
            let failure = format!("{what}: {reason}");
            // A long campaign is watched.
            eprintln!("FAILED {failure}");
            self.failures.push(failure);
        }
    }

    /// Counts a try that neither held nor failed.
    pub fn set_apart(&mut self, kind: &'static str) {
        self.tried += 1;
        *self.apart.entry(kind).or_default() += 1;
    }

    /// Notes that something could not be tried.
    pub fn skip(&mut self, what: impl Into<String>) {
        self.skipped.push(what.into());
    }

    /// Adds a note for readers of the table.
    pub fn note(&mut self, what: impl Into<String>) {
        self.notes.push(what.into());
    }
}

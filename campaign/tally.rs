//! Tries of an attack and their outcomes.

use std::collections::BTreeMap;

/// Number of failures reported in full; the rest are counted.
const SHOWN: usize = 12;

/// Tries and failures of one attack.
#[derive(Default)]
pub struct Tally {
    /// Tries.
    pub tried: usize,
    /// Failed tries.
    pub failed: usize,
    /// The first failures, each with the command to reproduce it.
    pub failures: Vec<String>,
    /// Inconclusive tries by outcome: `slow`, `aborted by the runtime`.
    pub apart: BTreeMap<&'static str, usize>,
    /// Tries skipped on this machine, with reasons.
    pub skipped: Vec<String>,
    /// Remarks on the tries.
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
            // Someone may be watching a long campaign.
            eprintln!("FAILED {failure}");
            self.failures.push(failure);
        }
    }

    /// Counts an inconclusive try.
    pub fn set_apart(&mut self, kind: &'static str) {
        self.tried += 1;
        *self.apart.entry(kind).or_default() += 1;
    }

    /// Records a skipped try.
    pub fn skip(&mut self, what: impl Into<String>) {
        self.skipped.push(what.into());
    }

    /// Adds a note for readers of the table.
    pub fn note(&mut self, what: impl Into<String>) {
        self.notes.push(what.into());
    }
}

//! How many things a package has.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

/// The things of a package.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThingsEntry {
    /// Number of prototypes of which they are copies.
    pub prototypes: u64,
    /// Number of things of each class, such as `boulder`.
    pub classes: BTreeMap<String, u64>,
}

/// Things that are counted one after the other.
#[derive(Default)]
pub(crate) struct Count {
    prototypes: BTreeSet<String>,
    classes: BTreeMap<String, u64>,
}

impl Count {
    /// Counts one more, of a class and a prototype.
    pub fn add(&mut self, class: &str, prototype: &str) {
        if !self.prototypes.contains(prototype) {
            self.prototypes.insert(prototype.to_owned());
        }
        match self.classes.get_mut(class) {
            Some(count) => *count += 1,
            None => drop(self.classes.insert(class.to_owned(), 1)),
        }
    }

    /// All of them; `None` if there are none.
    pub fn finish(self) -> Option<ThingsEntry> {
        let Self { prototypes, classes } = self;
        (!classes.is_empty()).then_some(ThingsEntry { prototypes: prototypes.len() as u64, classes })
    }
}

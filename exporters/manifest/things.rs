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

impl ThingsEntry {
    /// Counts things, given the class and the prototype of each; `None` if there are none.
    pub(crate) fn count<'a>(things: impl Iterator<Item = (&'a str, &'a str)>) -> Option<Self> {
        let (mut prototypes, mut classes) = (BTreeSet::new(), BTreeMap::new());
        for (class, prototype) in things {
            prototypes.insert(prototype);
            *classes.entry(class.to_owned()).or_default() += 1;
        }
        (!classes.is_empty()).then_some(Self { prototypes: prototypes.len() as u64, classes })
    }
}

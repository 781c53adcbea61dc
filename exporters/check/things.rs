//! Whether there are as many things as the manifest says.

use std::collections::{BTreeMap, BTreeSet};

use super::Fault;
use crate::instances::INSTANCES;
use crate::manifest::ThingsEntry;

/// Classes of which there are more or fewer things than in the manifest, and another number of prototypes.
pub fn faults(wanted: Option<&ThingsEntry>, found: Option<&ThingsEntry>) -> Vec<Fault> {
    let none = BTreeMap::new();
    let [wanted_classes, found_classes] = [wanted, found].map(|things| things.map_or(&none, |things| &things.classes));
    let classes: BTreeSet<&String> = wanted_classes.keys().chain(found_classes.keys()).collect();
    let classes = classes.into_iter().filter_map(|class| {
        let [wanted, found] = [wanted_classes, found_classes].map(|classes| classes.get(class).copied().unwrap_or(0));
        (wanted != found).then(|| format!("lists {found} things of class `{class}`, the manifest {wanted}"))
    });
    let [wanted, found] = [wanted, found].map(|things| things.map_or(0, |things| things.prototypes));
    let prototypes = (wanted != found).then(|| format!("lists things of {found} prototypes, the manifest of {wanted}"));
    classes.chain(prototypes).map(|what| Fault { path: INSTANCES.to_owned(), what }).collect()
}

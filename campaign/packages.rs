//! The kinds of packages that need no Python, as `plume list targets --json` has them.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// What can be exported.
pub struct Packages {
    /// Every target.
    pub targets: Vec<String>,
    /// Every kind of archive, each with a target that has it.
    pub bundles: Vec<(String, String)>,
}

impl Packages {
    /// Those of this program.
    pub fn of(plume: &Path) -> Self {
        let listed = Command::new(plume).args(["list", "targets", "--json"]).output().expect("the program can be run");
        let table: Value = serde_json::from_slice(&listed.stdout).expect("the list is JSON");
        let rows = table["targets"].as_array().expect("the list holds targets");
        let mut packages = Self { targets: Vec::new(), bundles: Vec::new() };
        for row in rows.iter().filter(|row| row["needs_usd"] == false && row["needs_format"] == false) {
            let target = text(&row["target"]);
            for bundle in row["bundles"].as_array().into_iter().flatten().map(text) {
                match packages.bundles.iter_mut().find(|(known, _)| *known == bundle) {
                    // The last targets of the table are the quickest to write.
                    Some((_, by)) => by.clone_from(&target),
                    None => packages.bundles.push((bundle, target.clone())),
                }
            }
            packages.targets.push(target);
        }
        packages
    }
}

fn text(value: &Value) -> String {
    value.as_str().expect("a name is a text").to_owned()
}

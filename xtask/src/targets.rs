//! The table of targets from `plume list targets --json`. Tasks choose their targets by the facts in it.

use serde_json::Value;

use crate::plume::Plume;
use crate::tools::Result;

/// A row of the table.
pub struct Target {
    row: Value,
}

impl Target {
    /// Every target of this `plume`.
    pub fn all(plume: &Plume) -> Result<Vec<Self>> {
        let text = plume.output(&["list", "targets", "--json"])?;
        let table: Value = serde_json::from_str(&text).map_err(|error| format!("plume list targets: {error}"))?;
        let rows = table["targets"].as_array().ok_or("plume list targets: no table")?;
        Ok(rows.iter().map(|row| Self { row: row.clone() }).collect())
    }

    /// Its name on the command line.
    pub fn name(&self) -> &str {
        self.row["target"].as_str().unwrap_or_default()
    }

    /// Whether the target needs no format argument.
    pub fn is_complete(&self) -> bool {
        !self.is("needs_format")
    }

    /// Whether the binary writes it, without Python.
    pub fn is_in_binary(&self) -> bool {
        self.is_complete() && !self.is("needs_usd")
    }

    /// Whether robots touch convex pieces, always or with the setting `collision = "pieces"`.
    pub fn has_pieces(&self) -> bool {
        self.is("has_pieces")
    }

    /// The interop checks that open its packages.
    pub fn checks(&self) -> impl Iterator<Item = &str> + Clone {
        self.row["checks"].as_array().into_iter().flatten().filter_map(Value::as_str)
    }

    fn is(&self, fact: &str) -> bool {
        self.row[fact] == true
    }
}

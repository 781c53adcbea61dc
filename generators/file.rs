//! Graphs and cave surveys from files.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GenerateError, Generator};
use plume_graph::Graph;
use plume_graph::Outside;
use plume_survey::Parts;

/// Settings of the file generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct File {
    /// The file, relative to the recipe; its extension determines the format (see `plume list formats`).
    #[schemars(extend("format" = "path", "minLength" = 1))]
    pub path: PathBuf,
    /// Factor on all lengths of the file. Passages of the original PLUME are about 1 m wide: 2 to 3 suits robots.
    #[schemars(range(min = 0.001, max = 1000.0))]
    pub scale: f64,
    /// What to do with disconnected parts: `refuse` them, `join` them by the shortest passages, `keep` all, or keep only
    /// the `longest`.
    pub parts: Parts,
}

impl Default for File {
    fn default() -> Self {
        Self { path: "graph.json".into(), scale: 1.0, parts: Parts::Refuse }
    }
}

impl Generator for File {
    fn generate(&self, _: u64, outside: &dyn Outside) -> Result<Graph, GenerateError> {
        let import = plume_survey::read(&self.path, self.parts, outside)
            .and_then(|import| import.scaled(self.scale, &self.path));
        let import = import.map_err(|error| GenerateError::new(error.to_string(), error.hint))?;
        import.doubts().for_each(|doubt| outside.warn(&doubt));
        Ok(import.graph)
    }
}

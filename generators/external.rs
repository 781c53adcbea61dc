//! A graph from any program, in any language.
//!
//! The program gets one JSON object on standard input, `{"plume": version, "seed": …, "settings": {…}}`, and writes graph
//! JSON ([`format::json`](mod@plume_survey::json)) to standard output; `id`, `coordinates` and `edges` are enough. What
//! it writes to standard error is shown if it fails. It runs only if the user allows programs, in the folder of the
//! recipe, and is stopped if it takes too long or writes too much.
//!
//! Promised: the result is a valid graph. Not promised: that the same seed gives the same graph; that is up to the program.

use std::path::PathBuf;
use std::time::Duration;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::{GenerateError, Generator};
use plume_graph::Graph;
use plume_graph::echo::plain;
use plume_graph::{Outside, Task};
use plume_survey::{Parts, json};

/// Settings of the external generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct External {
    /// The program and its arguments, for example `["python3", "my_generator.py"]`.
    pub command: Vec<String>,
    /// The folder in which it runs, relative to the recipe.
    #[schemars(extend("format" = "path", "minLength" = 1))]
    pub folder: PathBuf,
    /// Names of environment variables that it sees in addition to `PATH`, `HOME`, `USER`, `LANG`, `LC_*`, `TZ` and `TMPDIR`:
    /// `environment = ["LICENSE_SERVER"]`.
    pub environment: Vec<String>,
    /// Settings for the program, passed on with the seed: `settings = { branches = 4, style = "maze" }`.
    pub settings: Map<String, Value>,
    /// Time limit, in seconds.
    #[schemars(range(min = 0.1, max = 86_400.0))]
    pub time_limit_s: f64,
    /// Limit on its output, in megabytes.
    #[schemars(range(min = 0.001, max = 1_000.0))]
    pub size_limit_mb: f64,
    /// What to do with disconnected parts: `refuse` them, `join` them by the shortest passages, `keep` all, or keep only
    /// the `longest`.
    pub parts: Parts,
}

impl Default for External {
    fn default() -> Self {
        Self {
            command: vec!["./generator".to_owned()],
            folder: ".".into(),
            environment: Vec::new(),
            settings: Map::new(),
            time_limit_s: 60.0,
            size_limit_mb: 100.0,
            parts: Parts::Refuse,
        }
    }
}

impl Generator for External {
    fn generate(&self, seed: u64, outside: &dyn Outside) -> Result<Graph, GenerateError> {
        let task = self.task(seed)?;
        let told = outside.run(&task);
        let told =
            told.map_err(|error| GenerateError::new(format!("{}: {error}", plain(&self.command[0])), error.hint))?;
        let misled = |what: String, hint: &str| {
            GenerateError::new(format!("{} did not write a graph: {what}", plain(&self.command[0])), hint.to_owned())
        };
        let text =
            String::from_utf8(told).map_err(|_| misled("the output is not UTF-8 text".to_owned(), "write JSON"))?;
        let read = json::read_parts(&text, self.parts);
        let (document, _) = read.map_err(|error| misled(error.to_string(), error.hint()))?;
        Ok(document.graph)
    }
}

impl External {
    fn task(&self, seed: u64) -> Result<Task, GenerateError> {
        let [program, arguments @ ..] = self.command.as_slice() else {
            return Err(GenerateError::new("`command` is empty", "name a program and its arguments"));
        };
        let told = json!({ "plume": plume_graph::VERSION, "seed": seed, "settings": self.settings });
        Ok(Task {
            program: program.into(),
            arguments: arguments.to_vec(),
            folder: self.folder.clone(),
            environment: self.environment.clone(),
            input: format!("{told}\n").into_bytes(),
            limit: Duration::from_secs_f64(self.time_limit_s),
            most_bytes: (self.size_limit_mb * 1e6) as usize,
        })
    }
}

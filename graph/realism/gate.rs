//! A gate for graphs of any generator that only passes graphs like real caves.
//!
//! It judges finished graphs, however they were made. `reject` promises a graph like a real cave or an error, so that a data
//! set of thousands of worlds has no outliers; seeds that fail can be skipped. `repair` promises a graph, but not its
//! likeness: it is as good as the search can make it, see `plume measure`. With 250 nodes all of 20 mines, grown tunnels and
//! cellular caves passed; with 1000 nodes all mines and grown tunnels, but few cellular caves, which have many branches
//! close to each other. Both are deterministic: same recipe, same graph.

use rand::Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::repair::{LARGEST, repaired};
use super::{LEAST_STATIONS, Likeness, Verdict};
use crate::seed;
use crate::{GenerateError, Generator, Graph, Outside};

/// What to do with graphs that are not like real caves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Gate {
    /// Accept them.
    #[default]
    Off,
    /// Try again with other seeds.
    Reject,
    /// Try other seeds; if none is like a real cave, modify the nearest one step by step.
    Repair,
}

/// Whether graphs have to be like real caves, for any generator.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct RealismSettings {
    /// What to do with a graph that is not like the 34 caves of Collon et al. 2017 (see `plume measure`): `off` accepts it,
    /// `reject` tries other seeds and fails if none passes, `repair` modifies the nearest one step by step, including its
    /// number of nodes. The default generator has its own gate.
    pub gate: Gate,
    /// Maximum number of graphs to try, the first with the seed of the recipe.
    #[schemars(range(min = 1, max = 10_000))]
    pub tries: u32,
}

impl Default for RealismSettings {
    fn default() -> Self {
        Self { gate: Gate::Off, tries: 20 }
    }
}

/// A graph that did not pass, and its number.
struct Attempt {
    graph: Graph,
    likeness: Likeness,
    place: u32,
}

impl RealismSettings {
    /// The graph of this seed that passes the gate. Seeds after the first that make no graph are skipped.
    ///
    /// # Errors
    /// If the generator fails for the first seed, none passes, or the graphs are too small or too large for the gate.
    pub fn generate(
        &self,
        generator: &dyn Generator,
        seed: u64,
        outside: &dyn Outside,
    ) -> Result<Graph, GenerateError> {
        if self.gate == Gate::Off {
            return generator.generate(seed, outside);
        }
        let nearest = match self.search(generator, seed, outside)? {
            Found::Passes(graph) => return Ok(graph),
            Found::Nearest(attempt) => attempt,
        };
        match self.gate {
            _ if nearest.likeness.verdict == Verdict::TooSmall => Err(too_small(&nearest)),
            Gate::Repair if nearest.graph.nodes.len() > LARGEST => Err(too_large(&nearest)),
            Gate::Repair => Ok(repaired(nearest.graph, seed)),
            Gate::Off | Gate::Reject => Err(self.none_passes(&nearest)),
        }
    }

    /// The first graph that passes, or the nearest. A generator that ignores the seed is called only once.
    fn search(&self, generator: &dyn Generator, seed: u64, outside: &dyn Outside) -> Result<Found, GenerateError> {
        let mut nearest: Option<Attempt> = None;
        for place in 0..self.tries {
            let graph = match generator.generate(seed_of(seed, place), outside) {
                Ok(graph) => graph,
                Err(error) if place == 0 => return Err(error),
                Err(_) => continue,
            };
            let Some(likeness) = Likeness::of(&graph) else { continue };
            if likeness.verdict == Verdict::Real {
                return Ok(Found::Passes(graph));
            }
            if nearest.as_ref().is_some_and(|known| known.graph == graph) {
                break;
            }
            let distance = likeness.metrics.distance();
            if nearest.as_ref().is_none_or(|known| distance < known.likeness.metrics.distance()) {
                nearest = Some(Attempt { graph, likeness, place });
            }
        }
        let none = || GenerateError::new("there is no passage to judge", "ask for more nodes");
        nearest.map(Found::Nearest).ok_or_else(none)
    }

    fn none_passes(&self, nearest: &Attempt) -> GenerateError {
        let failing = nearest.likeness.failing().join(", ");
        GenerateError::new(
            format!(
                "none of {} graphs is like a real cave; the nearest, number {}, differs in {failing}",
                self.tries,
                nearest.place + 1
            ),
            "set `realism.gate` to \"repair\" or \"off\", increase `realism.tries`, or use another generator",
        )
    }
}

enum Found {
    Passes(Graph),
    Nearest(Attempt),
}

/// The seed of each try, the first being that of the recipe. The others are below 2^53, so that every program can read
/// them.
fn seed_of(seed: u64, place: u32) -> u64 {
    match place {
        0 => seed,
        _ => seed::stream(seed, "realism-try", u64::from(place)).next_u64() >> 11,
    }
}

fn too_small(nearest: &Attempt) -> GenerateError {
    GenerateError::new(
        format!("a graph with {} stations is too small to be like a real cave", nearest.likeness.stations),
        format!("ask for at least {LEAST_STATIONS} nodes and a junction, or set `realism.gate` to \"off\""),
    )
}

fn too_large(nearest: &Attempt) -> GenerateError {
    GenerateError::new(
        format!("a graph with {} stations is too large to be repaired", nearest.likeness.stations),
        format!("ask for at most {LARGEST} nodes, or set `realism.gate` to \"reject\""),
    )
}

//! Makes a graph more like a real cave, step by step.
//!
//! Hill climbing: a random move is kept if [`Metrics::distance`] decreases, no additional passages come too close, every
//! level keeps a passage and the size stays within limits. Successful moves are drawn more often. It ends when the graph
//! passes, or when its effort is spent, so that the time is bounded. Stations that no move touches are unchanged; new ones
//! inherit section, radius and level. The number of stations changes.

mod moves;
mod plan;

use super::{LEAST_STATIONS, Metrics};
use crate::Graph;
use crate::clearance::{PassageSize, thin_rock};
use crate::rng::Rng;
use crate::seed;
use moves::{MAX_DEGREE, MOVES};
use plan::Plan;

/// Largest number of stations: beyond, a step takes too long.
pub(super) const LARGEST: usize = 20_000;
/// Limits of the number of stations, relative to the graph.
const SIZE: [f64; 2] = [0.6, 1.6];
/// Total number of nodes that the shortest paths of all trials may visit, which bounds the time to seconds.
const EFFORT: usize = 150_000_000;
/// Minimum and maximum number of trials. Tuned: graphs that have not passed by then hardly ever do.
const TRIALS: [usize; 2] = [100, 3000];
/// Rock to be kept between passages, in metres, where there was as much before.
const ROCK_M: f64 = 0.8;

/// The graph, as like a real cave as the search can make it.
pub(super) fn repaired(graph: Graph, seed: u64) -> Graph {
    let Some(mut state) = State::new(&graph) else { return graph };
    let mut rng = Rng::new(seed::stream(seed, "realism-repair", 0));
    let mut record = Record::default();
    for _ in 0..state.trials() {
        if state.metrics.realism(0.0).is_real() {
            break;
        }
        let chosen = record.draw(&mut rng);
        let next = MOVES[chosen](&state.plan, &mut rng).and_then(|graph| state.better(graph));
        record.enter(chosen, next.is_some());
        state = next.unwrap_or(state);
    }
    Graph { georeference: graph.georeference, ..state.plan.graph.numbered_by_breadth() }
}

/// The graph of a step, with the data for judging it. Removed stations stay without passages.
struct State {
    plan: Plan,
    metrics: Metrics,
    thin_places: usize,
    /// Levels that must be kept.
    levels: usize,
    /// Minimum and maximum number of stations.
    size: [usize; 2],
}

impl State {
    fn new(graph: &Graph) -> Option<Self> {
        let size = SIZE.map(|factor| ((factor * graph.nodes.len() as f64) as usize).max(LEAST_STATIONS));
        Some(Self {
            metrics: Metrics::of(graph)?,
            thin_places: thin_places(graph),
            levels: levels(graph),
            size,
            plan: Plan::of(graph.clone()),
        })
    }

    /// Number of trials within the effort.
    fn trials(&self) -> usize {
        let places = self.metrics.branches.max(1);
        (EFFORT / (places * places)).clamp(TRIALS[0], TRIALS[1])
    }

    /// The state with this graph, if it is better; cheap tests come first.
    fn better(&self, graph: Graph) -> Option<Self> {
        let metrics = Metrics::of_nearer(&graph, self.metrics.distance())?;
        if metrics.distance() >= self.metrics.distance() || metrics.max_degree > MAX_DEGREE.max(self.metrics.max_degree)
        {
            return None;
        }
        let plan = Plan::of(graph);
        if !(self.size[0]..=self.size[1]).contains(&plan.stations) || levels(&plan.graph) < self.levels {
            return None;
        }
        let thin_places = thin_places(&plan.graph);
        (thin_places <= self.thin_places).then_some(Self { plan, metrics, thin_places, ..*self })
    }
}

/// Levels with a passage.
fn levels(graph: &Graph) -> usize {
    let mut levels: Vec<u32> = graph.edges.iter().flatten().map(|&node| graph[node].level).collect();
    levels.sort_unstable();
    levels.dedup();
    levels.len()
}

fn thin_places(graph: &Graph) -> usize {
    thin_rock(graph, PassageSize::default(), ROCK_M).len()
}

/// How often each move was tried recently, and how often it helped.
struct Record([(u32, u32); MOVES.len()]);

impl Default for Record {
    fn default() -> Self {
        Self([(0, 0); MOVES.len()])
    }
}

impl Record {
    /// Number of trials after which counts are halved: old successes may no longer be relevant.
    const MEMORY: u32 = 60;

    /// A random move, weighted by its success rate, with a minimum weight.
    fn draw(&self, rng: &mut Rng) -> usize {
        let weights = self.0.map(|(tried, helped)| u64::from(1000 * (helped + 1) / (tried + 4) + 20));
        let mut left = rng.below(weights.iter().sum());
        for (place, weight) in weights.into_iter().enumerate() {
            if left < weight {
                return place;
            }
            left -= weight;
        }
        0
    }

    fn enter(&mut self, chosen: usize, has_helped: bool) {
        let (tried, helped) = &mut self.0[chosen];
        *tried += 1;
        *helped += u32::from(has_helped);
        if *tried > Self::MEMORY {
            (*tried, *helped) = (*tried / 2, *helped / 2);
        }
    }
}

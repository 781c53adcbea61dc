//! Makes a graph more like a real cave, step by step.
//!
//! A search that only climbs: a move is drawn, and kept if [`Metrics::distance`] falls, no more passages come near each other
//! than before, every level keeps a passage and the size stays within limits. Moves that have helped are drawn more often.
//! It ends when the graph passes, or when its effort is spent, so that the time is bounded. Stations that no move touches keep
//! all they have; new ones take section, radius and level from where they begin. Their number changes.

mod moves;
mod plan;

use super::{LEAST_STATIONS, Metrics};
use crate::Graph;
use crate::clearance::{PassageSize, thin_rock};
use crate::rng::Rng;
use crate::seed;
use moves::{MAX_DEGREE, MOVES};
use plan::Plan;

/// Stations above which a step takes too long.
pub(super) const LARGEST: usize = 20_000;
/// Stations that may be left, and that there may be, per station of the graph.
const SIZE: [f64; 2] = [0.6, 1.6];
/// Places that the shortest paths of all trials together may visit, which bounds the time to seconds.
const EFFORT: usize = 150_000_000;
/// Fewest and most trials. Tuned: what does not pass by then hardly ever does.
const TRIALS: [usize; 2] = [100, 3000];
/// Rock that passages keep between them, in metres, where they did before.
const ROCK_M: f64 = 0.8;

/// The graph, as like a real cave as the search gets it.
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
    state.plan.graph.numbered_by_breadth()
}

/// The graph of one step, with what it is judged by. Stations that were taken away stay behind without passages.
struct State {
    plan: Plan,
    metrics: Metrics,
    thin_places: usize,
    /// Levels that must not be lost.
    levels: usize,
    /// Fewest and most stations.
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

    /// Trials that the effort is enough for.
    fn trials(&self) -> usize {
        let places = self.metrics.branches.max(1);
        (EFFORT / (places * places)).clamp(TRIALS[0], TRIALS[1])
    }

    /// The state with this graph, if it is better; what is cheap is asked first.
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

/// How often each move has been tried of late, and has helped.
struct Record([(u32, u32); MOVES.len()]);

impl Default for Record {
    fn default() -> Self {
        Self([(0, 0); MOVES.len()])
    }
}

impl Record {
    /// Trials after which half of them are forgotten: what has helped long ago may not help now.
    const MEMORY: u32 = 60;

    /// A move, by its part of trials that have helped and a little for hope.
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

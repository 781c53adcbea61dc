//! Comparison of graphs with real caves.
//!
//! [`Metrics`] measures what Collon et al. 2017 measured on real caves, [`METRICS`] holds their ranges, and [`Likeness`]
//! locates a graph in them. A graph is like a real cave if all eight metrics that do not depend on size are between the
//! minimum and the maximum of real caves, and six of them between the tenth and the ninetieth percentile. The rule is ours
//! and is stricter than being a cave: of the 31 caves with all eight metrics it accepts 21, and calls ten unusual. It judges
//! the layout of passages, not their walls.
//!
//! ```
//! use plume_graph::centreline::{CentrelineBuilder, Vertex};
//! use plume_graph::realism::Likeness;
//!
//! let mut centreline = CentrelineBuilder::default();
//! let vertices: Vec<_> = (0..40)
//!     .map(|i| centreline.add(Vertex { position: [5.0 * f64::from(i), 0.0, 0.0].into(), section: None, level: 0 }))
//!     .collect();
//! vertices.windows(2).for_each(|pair| centreline.join(pair[0], pair[1]));
//! let likeness = Likeness::of(&centreline.into_graph()).ok_or("too few stations")?;
//! assert!(!likeness.failing().is_empty(), "a straight tunnel is unlike a cave");
//! # Ok::<(), &str>(())
//! ```

mod gate;
mod metrics;
mod reduced;
mod reference;
mod repair;

use serde::Serialize;

pub use gate::{Gate, RealismSettings};
pub use metrics::{EXACT_TO, Metrics};
pub use reduced::Sampling;
pub use reference::{CAVES, METRICS, Metric, Range, SCALE_FREE, percentile};

use super::Graph;

/// Minimum number of stations: smaller graphs have too few branches for statistics.
pub const LEAST_STATIONS: usize = 25;
/// Required number of metrics between the tenth and the ninetieth percentile.
pub const CORE_NEEDED: usize = 6;
/// Index of the mean degree in [`METRICS`]: a ratio of integers that needs no inset.
const MEAN_DEGREE: usize = 4;

impl Metrics {
    /// Number of metrics in the range of real caves, each range shortened at both ends by `inset` of its length.
    pub fn realism(&self, inset: f64) -> Realism {
        let mut realism = Realism { inside: 0, core: 0 };
        for (place, (value, Metric { range, .. })) in self.scale_free().into_iter().zip(&METRICS).enumerate() {
            let hold = if place == MEAN_DEGREE { 0.0 } else { inset * (range.max - range.min) };
            let within = |low: f64, high: f64| (low + hold..=high - hold).contains(&value);
            realism.inside += usize::from(within(range.min, range.max));
            realism.core += usize::from(within(range.p10, range.p90));
        }
        realism
    }

    /// How far the metrics are outside, 0 if all are in the core; for choosing the best of several graphs.
    pub fn distance(&self) -> f64 {
        let excess = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
        let of_one = |(value, Metric { range, .. }): (f64, &Metric)| {
            let core = excess(value, range.p10, range.p90);
            let whole = excess(value, range.min, range.max);
            (core + 10.0 * whole) / (range.p90 - range.p10)
        };
        self.scale_free().into_iter().zip(&METRICS).map(of_one).sum()
    }
}

/// Number of metrics, of eight, that are like those of real caves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Realism {
    /// Metrics between the minimum and the maximum of real caves.
    pub inside: usize,
    /// Metrics between the tenth and the ninetieth percentile.
    pub core: usize,
}

impl Realism {
    /// Whether the graph passes for a real cave.
    pub fn is_real(self) -> bool {
        self.inside == SCALE_FREE && self.core >= CORE_NEEDED
    }
}

/// The verdict on a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It has the statistics of a real cave.
    Real,
    /// Every metric is within the range of real caves, but too many are outside the core.
    Unusual,
    /// Some metric is outside the range of real caves.
    Unreal,
    /// It has fewer than [`LEAST_STATIONS`], or no junction, so there are no statistics.
    TooSmall,
}

/// Position of a value among real caves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// Between the tenth and the ninetieth percentile.
    Core,
    /// Between the minimum and the maximum.
    Inside,
    /// Outside the range.
    Outside,
}

/// A graph compared with real caves.
#[derive(Clone, Debug, PartialEq)]
pub struct Likeness {
    /// The metrics.
    pub metrics: Metrics,
    /// Number of stations.
    pub stations: usize,
    /// The overall result.
    pub verdict: Verdict,
}

/// One metric of a graph compared with real caves.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The metric.
    pub metric: &'static Metric,
    /// Its value for the graph.
    pub value: f64,
    /// The percentage of real caves with a lower value.
    pub percentile: f64,
    /// Its position among real caves.
    pub standing: Standing,
    /// Whether it counts for the verdict.
    pub counts: bool,
}

impl Likeness {
    /// Measures and judges a graph; `None` if it has no passages.
    pub fn of(graph: &Graph) -> Option<Self> {
        let metrics = Metrics::of(graph)?;
        let stations = graph.nodes.len();
        let realism = metrics.realism(0.0);
        let verdict = match realism {
            _ if stations < LEAST_STATIONS || metrics.max_degree < 3 => Verdict::TooSmall,
            _ if realism.is_real() => Verdict::Real,
            Realism { inside: SCALE_FREE, .. } => Verdict::Unusual,
            _ => Verdict::Unreal,
        };
        Some(Self { metrics, stations, verdict })
    }

    /// All metrics, in the order of [`METRICS`].
    pub fn rows(&self) -> impl Iterator<Item = Row> {
        METRICS.iter().enumerate().map(|(place, metric)| {
            let value = (metric.of)(&self.metrics);
            let standing = match metric.range {
                range if range.has_in_core(value) => Standing::Core,
                range if range.holds(value) => Standing::Inside,
                _ => Standing::Outside,
            };
            Row { metric, value, percentile: percentile(place, value), standing, counts: place < SCALE_FREE }
        })
    }

    /// Names of the failing metrics: those outside the range of real caves or, if there are none, those outside the core.
    pub fn failing(&self) -> Vec<&'static str> {
        let those = |wanted: Standing| {
            self.rows().filter(move |row| row.counts && row.standing == wanted).map(|row| row.metric.name)
        };
        let outside: Vec<_> = those(Standing::Outside).collect();
        if outside.is_empty() && self.verdict != Verdict::Real { those(Standing::Inside).collect() } else { outside }
    }
}

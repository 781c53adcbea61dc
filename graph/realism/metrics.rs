//! Metrics of cave graphs.
//!
//! Collon, Bernasconi, Vuilleumier, Renard: "Statistical metrics for the characterization of karst network geometry and
//! topology", Geomorphology 283, 2017. The definitions are those of their program karstnet, down to the class boundaries;
//! both give the same values (`tests/interop/graph/karstnet_agrees.py`). Shortest paths take quadratic time in the size of
//! the reduced graph; above [`EXACT_TO`] nodes they are sampled, see [`Metrics::sampling`].

use serde::Serialize;

use super::reduced::{Paths, Reduced, Sampling};
use super::{METRICS, SCALE_FREE};
use crate::branches::Branches;
use crate::{Graph, Node, StationId};

/// Largest reduced graph for which all shortest paths are counted.
pub const EXACT_TO: usize = 20_000;
/// Total number of nodes visited by the searches of a sample, which bounds the time to seconds.
const VISITS: usize = 40_000_000;

/// Index of the central point dominance in [`METRICS`].
const DOMINANCE: usize = 7;

/// The metrics of a graph. A branch runs between two stations that do not have exactly two passages; the reduced graph has
/// those stations as nodes and the branches as edges. Dimensionless metrics, except counts, do not depend on the size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Entropy of branch lengths in ten classes up to the longest, 0 to 1.
    pub length_entropy: f64,
    /// Coefficient of variation of branch lengths.
    pub length_variation: f64,
    /// Mean of branch length divided by the distance between its ends, over branches that are not rings.
    pub tortuosity: f64,
    /// Entropy of azimuths in eighteen classes, weighted by length, 0 to 1.
    pub orientation_entropy: f64,
    /// Mean degree in the reduced graph.
    pub mean_degree: f64,
    /// Coefficient of variation of degrees in the reduced graph.
    pub degree_variation: f64,
    /// Correlation of the degrees at the two ends of the edges of the reduced graph, -1 to 1.
    pub degree_correlation: f64,
    /// Central point dominance of betweenness in the reduced graph, 0 to 1.
    pub central_point_dominance: f64,
    /// Mean length of a branch in metres.
    pub mean_length_m: f64,
    /// Mean number of branches on the shortest path between two nodes of the reduced graph, within each part.
    pub average_path: f64,
    /// Number of independent loops.
    pub loops: usize,
    /// Number of branches.
    pub branches: usize,
    /// Most passages at a station; no real cave has more than 5.
    pub max_degree: usize,
    /// How shortest paths were sampled; `None` if all were counted.
    pub sampling: Option<Sampling>,
}

impl Metrics {
    /// Measures a graph; `None` if it has no passages.
    pub fn of(graph: &Graph) -> Option<Self> {
        Self::of_nearer(graph, f64::INFINITY)
    }

    /// Measures a graph, but stops before the shortest paths, which take longest, if [`distance`](Self::distance) cannot be
    /// less than `most`.
    pub(super) fn of_nearer(graph: &Graph, most: f64) -> Option<Self> {
        let branches = Branches::of(&graph.neighbors());
        let lengths = lengths(&branches, graph);
        let longest = lengths.iter().copied().reduce(f64::max)?;
        let reduced = Reduced::of(&branches);
        let degrees: Vec<f64> = reduced.degrees().map(|degree| degree as f64).collect();
        let pathless = Self {
            length_entropy: length_entropy(&lengths, longest),
            length_variation: variation(&lengths),
            tortuosity: tortuosity(&branches, &lengths, graph),
            orientation_entropy: orientation_entropy(graph),
            mean_degree: mean(&degrees),
            degree_variation: variation(&degrees),
            degree_correlation: degree_correlation(&reduced),
            // No metric counts.
            central_point_dominance: METRICS[DOMINANCE].range.median,
            mean_length_m: mean(&lengths),
            average_path: 0.0,
            loops: graph.loops(),
            branches: lengths.len(),
            max_degree: max_degree(graph),
            sampling: None,
        };
        (pathless.distance() < most).then(|| pathless.with(&reduced.paths(EXACT_TO, VISITS)))
    }

    fn with(self, paths: &Paths) -> Self {
        Self { central_point_dominance: paths.dominance, average_path: paths.average, sampling: paths.sampling, ..self }
    }

    /// The metrics that do not depend on size, in the order of [`METRICS`].
    pub fn scale_free(&self) -> [f64; SCALE_FREE] {
        std::array::from_fn(|place| (METRICS[place].of)(self))
    }
}

fn max_degree(graph: &Graph) -> usize {
    graph.degrees().into_iter().max().unwrap_or_default()
}

/// Classes of a tenth of the longest branch; zero-length branches are in none.
fn length_entropy(lengths: &[f64], longest: f64) -> f64 {
    let mut classes = [0.0; 10];
    for length in lengths.iter().filter(|&&length| length > 0.0) {
        classes[class(length / longest * 100.0, classes.len())] += 1.0;
    }
    entropy(&classes)
}

/// Classes of ten degrees.
fn orientation_entropy(graph: &Graph) -> f64 {
    let mut classes = [0.0; 18];
    for &[a, b] in &graph.edges {
        let way = (graph[b].position - graph[a].position).xy();
        if way.norm() > 0.0 {
            classes[class(azimuth_deg(way.x, way.y), classes.len())] += way.norm();
        }
    }
    entropy(&classes)
}

/// The class of width ten of a number; the last one includes its upper end.
fn class(number: f64, classes: usize) -> usize {
    ((number / 10.0) as usize).min(classes - 1)
}

/// The azimuth of an undirected line as in karstnet: clockwise from north, below 180.
fn azimuth_deg(x: f64, y: f64) -> f64 {
    let across = (x.abs() / (x * x + y * y).sqrt()).min(1.0);
    let angle = if x * y > 0.0 { libm::asin(across).to_degrees() } else { 90.0 + libm::acos(across).to_degrees() };
    angle % 180.0
}

/// Shannon entropy to the base of the number of classes.
fn entropy(classes: &[f64]) -> f64 {
    let sum: f64 = classes.iter().sum();
    let parts = classes.iter().filter(|&&class| class > 0.0);
    let nats: f64 = parts.map(|class| -class / sum * libm::log(class / sum)).sum();
    // Adding zero turns the -0.0 of a single class into 0.0.
    nats / libm::log(classes.len() as f64) + 0.0
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Coefficient of variation of a sample; 0 for a single value.
fn variation(values: &[f64]) -> f64 {
    let mean = mean(values);
    if values.len() < 2 || mean == 0.0 {
        return 0.0;
    }
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (squares / (values.len() - 1) as f64).sqrt() / mean
}

/// The length of each branch in metres.
fn lengths(branches: &Branches<Node>, graph: &Graph) -> Vec<f64> {
    let leg = |pair: &[StationId]| graph.distance_m(pair[0], pair[1]);
    branches.iter().map(|branch| branch.windows(2).map(leg).sum()).collect()
}

/// 1 if every branch is a ring.
fn tortuosity(branches: &Branches<Node>, lengths: &[f64], graph: &Graph) -> f64 {
    let ratios: Vec<f64> = branches
        .iter()
        .zip(lengths)
        .filter_map(|(branch, length)| {
            let [first, last] = [branch[0], branch[branch.len() - 1]];
            let apart = graph.distance_m(first, last);
            (apart > 0.0).then(|| length / apart)
        })
        .collect();
    if ratios.is_empty() { 1.0 } else { mean(&ratios) }
}

/// Pearson's correlation of degrees over edges in both directions; 1 if all degrees are the same.
fn degree_correlation(reduced: &Reduced) -> f64 {
    let (mut count, mut sum, mut squares, mut products) = (0.0, 0.0, 0.0, 0.0);
    for (a, b) in reduced.directed_edges() {
        let (a, b) = (reduced.degree(a) as f64, reduced.degree(b) as f64);
        count += 1.0;
        sum += a;
        squares += a * a;
        products += a * b;
    }
    // All sums are integers, so this is exactly 0 if there is no variance.
    let variance = squares * count - sum * sum;
    if variance <= 0.0 {
        return 1.0;
    }
    (products * count - sum * sum) / variance
}

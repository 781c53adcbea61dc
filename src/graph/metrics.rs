//! Eight numbers that tell a cave from a drawing of one, and the range of each in real caves.
//!
//! Collon, Bernasconi, Vuilleumier, Renard: "Statistical metrics for the characterization of karst network geometry and
//! topology", Geomorphology 283, 2017: the scale-free ones of their metrics, with the ranges of their 34 caves (31 for
//! geometry). The definitions are those of their program karstnet, which a graph measured here and there agrees with.

use std::f64::consts::PI;

use super::Graph;
use super::reduced::{Branches, Reduced};

/// The range of one metric over real caves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// What is measured.
    pub name: &'static str,
    /// Least value of any cave.
    pub min: f64,
    /// Value that one cave in ten stays under.
    pub p10: f64,
    /// Value that one cave in ten exceeds.
    pub p90: f64,
    /// Greatest value of any cave.
    pub max: f64,
}

const fn range(name: &'static str, [min, p10, p90, max]: [f64; 4]) -> Range {
    Range { name, min, p10, p90, max }
}

/// The ranges of Collon et al. 2017, in the order of [`Metrics::values`]; quantiles interpolated linearly.
pub static REAL_CAVES: [Range; 8] = [
    range("length entropy", [0.070054, 0.205123, 0.598302, 0.66739]),
    range("length variation", [0.903288, 0.940227, 1.85322, 2.559806]),
    range("tortuosity", [1.121287, 1.183497, 1.415125, 1.535434]),
    range("orientation entropy", [0.745735, 0.906844, 0.99586, 0.996994]),
    range("mean degree", [1.75, 2.0, 2.330473, 2.569231]),
    range("degree variation", [0.352617, 0.459572, 0.590435, 0.602927]),
    range("degree correlation", [-0.555556, -0.440682, -0.182334, -0.150444]),
    range("central point dominance", [0.022457, 0.205422, 0.541385, 0.571717]),
];

/// Metrics inside their whole range that a realistic graph has: all of them.
const INSIDE_NEEDED: usize = 8;
/// Metrics between the tenth and the ninetieth percentile that it has.
const CORE_NEEDED: usize = 6;
/// Place of the mean degree, a ratio of whole numbers that needs no inset.
const MEAN_DEGREE: usize = 4;

/// The metrics of one graph, all without unit. A branch runs between two stations that do not have exactly two
/// passages; the reduced graph has those stations as nodes and the branches as edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// Entropy of branch lengths in ten classes of the longest, 0 to 1.
    pub length_entropy: f64,
    /// Standard deviation of branch lengths by their mean.
    pub length_variation: f64,
    /// Mean of branch length by distance between its ends, over branches that are no rings.
    pub tortuosity: f64,
    /// Entropy of azimuths in eighteen classes, weighted by length, 0 to 1.
    pub orientation_entropy: f64,
    /// Mean degree in the reduced graph.
    pub mean_degree: f64,
    /// Standard deviation of degrees in the reduced graph by their mean.
    pub degree_variation: f64,
    /// Correlation of the degrees at the two ends of the edges of the reduced graph, -1 to 1.
    pub degree_correlation: f64,
    /// How much the most central node of the reduced graph stands out in betweenness, 0 to 1.
    pub central_point_dominance: f64,
}

impl Metrics {
    /// Measures a graph in time proportional to the square of its size; `None` if it has no branch, as a ring has none.
    pub fn of(graph: &Graph) -> Option<Self> {
        let branches = Branches::of(graph);
        let lengths = branches.lengths(graph);
        let longest = lengths.iter().copied().reduce(f64::max)?;
        let reduced = Reduced::of(&branches);
        let degrees: Vec<f64> = reduced.degrees().map(|degree| degree as f64).collect();
        Some(Self {
            length_entropy: length_entropy(&lengths, longest),
            length_variation: variation(&lengths),
            tortuosity: tortuosity(&branches, &lengths, graph),
            orientation_entropy: orientation_entropy(graph),
            mean_degree: mean(&degrees),
            degree_variation: variation(&degrees),
            degree_correlation: degree_correlation(&reduced),
            central_point_dominance: dominance(&reduced.betweenness()),
        })
    }

    /// The metrics in the order of [`REAL_CAVES`].
    pub fn values(&self) -> [f64; 8] {
        [
            self.length_entropy,
            self.length_variation,
            self.tortuosity,
            self.orientation_entropy,
            self.mean_degree,
            self.degree_variation,
            self.degree_correlation,
            self.central_point_dominance,
        ]
    }

    /// How many metrics lie in the range of real caves, each range shortened at both ends by `inset` of its length.
    pub fn realism(&self, inset: f64) -> Realism {
        let mut realism = Realism { inside: 0, core: 0 };
        for (place, (value, range)) in self.values().iter().zip(&REAL_CAVES).enumerate() {
            let hold = if place == MEAN_DEGREE { 0.0 } else { inset * (range.max - range.min) };
            let within = |low: f64, high: f64| (low + hold..=high - hold).contains(value);
            realism.inside += usize::from(within(range.min, range.max));
            realism.core += usize::from(within(range.p10, range.p90));
        }
        realism
    }

    /// How far the metrics lie outside, 0 when all are in the core; for choosing the least unreal of several graphs.
    pub fn distance(&self) -> f64 {
        let excess = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
        let of_one = |(value, range): (f64, &Range)| {
            let core = excess(value, range.p10, range.p90);
            let whole = excess(value, range.min, range.max);
            (core + 10.0 * whole) / (range.p90 - range.p10)
        };
        self.values().into_iter().zip(&REAL_CAVES).map(of_one).sum()
    }
}

/// How many of the eight metrics are like those of real caves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Realism {
    /// Metrics between the least and the greatest value of any real cave.
    pub inside: usize,
    /// Metrics between the tenth and the ninetieth percentile.
    pub core: usize,
}

impl Realism {
    /// Whether the graph passes for a real cave: all metrics inside, and six of eight in the core.
    pub fn is_real(self) -> bool {
        self.inside >= INSIDE_NEEDED && self.core >= CORE_NEEDED
    }
}

fn length_entropy(lengths: &[f64], longest: f64) -> f64 {
    let mut classes = [0.0; 10];
    for length in lengths {
        classes[((10.0 * length / longest) as usize).min(9)] += 1.0;
    }
    entropy(&classes)
}

fn orientation_entropy(graph: &Graph) -> f64 {
    let mut classes = [0.0; 18];
    for &[a, b] in &graph.edges {
        let way = (graph.nodes[b].position - graph.nodes[a].position).xy();
        if way.norm() > 0.0 {
            let class = azimuth(way.x, way.y) / PI * 18.0;
            classes[(class as usize).min(17)] += way.norm();
        }
    }
    entropy(&classes)
}

/// The azimuth of an undirected line as karstnet measures it: clockwise from north, below π.
fn azimuth(x: f64, y: f64) -> f64 {
    let across = (x.abs() / libm::hypot(x, y)).min(1.0);
    let angle = if x * y > 0.0 { libm::asin(across) } else { 0.5 * PI + libm::acos(across) };
    angle % PI
}

/// Shannon entropy to the base of the number of classes.
fn entropy(classes: &[f64]) -> f64 {
    let sum: f64 = classes.iter().sum();
    let parts = classes.iter().filter(|&&class| class > 0.0);
    let nats: f64 = parts.map(|class| -class / sum * libm::log(class / sum)).sum();
    nats / libm::log(classes.len() as f64)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation of a sample by its mean; 0 for a single value.
fn variation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let mean = mean(values);
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (squares / (values.len() - 1) as f64).sqrt() / mean
}

fn tortuosity(branches: &Branches, lengths: &[f64], graph: &Graph) -> f64 {
    let ratios: Vec<f64> = branches
        .iter()
        .zip(lengths)
        .filter_map(|(branch, length)| {
            let [first, last] = [branch[0], branch[branch.len() - 1]];
            let apart = (graph.nodes[first].position - graph.nodes[last].position).norm();
            (apart > 0.0).then(|| length / apart)
        })
        .collect();
    if ratios.is_empty() {
        return 1.0;
    }
    mean(&ratios)
}

/// Pearson's correlation of degrees over edges taken both ways; 1 where all degrees are the same.
fn degree_correlation(reduced: &Reduced) -> f64 {
    let (mut count, mut sum, mut squares, mut products) = (0.0, 0.0, 0.0, 0.0);
    for (a, b) in reduced.directed_edges() {
        let (a, b) = (reduced.degree(a) as f64, reduced.degree(b) as f64);
        count += 1.0;
        sum += a;
        squares += a * a;
        products += a * b;
    }
    let mean = sum / count;
    let variance = squares / count - mean * mean;
    if variance <= 1e-12 {
        return 1.0;
    }
    (products / count - mean * mean) / variance
}

/// Freeman's centralization of betweenness.
fn dominance(betweenness: &[f64]) -> f64 {
    let Some(others) = betweenness.len().checked_sub(1).filter(|&n| n > 0) else {
        return 0.0;
    };
    let most = betweenness.iter().copied().fold(0.0, f64::max);
    betweenness.iter().map(|b| most - b).sum::<f64>() / others as f64
}

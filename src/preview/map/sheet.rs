//! A graph projected onto paper, in metres.

use std::ops::Index;

use crate::preview::Subject;
use plume_graph::{Aabb, Graph, Node, StationId};

/// If there are more storeys than this, they are drawn over each other.
const MOST_PANELS: usize = 12;
/// Target height of a profile, relative to the paper. Tuned.
const LEAST_HEIGHT: f64 = 0.2;
/// Vertical exaggerations.
const STRETCHES: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

/// A projected station, in metres, including vertical exaggeration.
pub struct SheetStation {
    /// To the right and up.
    pub at: [f64; 2],
    /// Depth towards the viewer.
    pub depth: f64,
    /// Elevation, not exaggerated.
    pub height_m: f64,
    /// Extents of the passage sideways, up and down.
    pub reach: [f64; 3],
    /// Its storey.
    pub level: u32,
}

impl SheetStation {
    /// A position on the straight line to another.
    pub fn towards(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Self {
            at: [0, 1].map(|i| mix(self.at[i], other.at[i])),
            depth: mix(self.depth, other.depth),
            height_m: mix(self.height_m, other.height_m),
            reach: [0, 1, 2].map(|i| mix(self.reach[i], other.reach[i])),
            level: self.level,
        }
    }
}

/// Passages that are drawn together.
pub struct Panel {
    /// Its title; may be empty.
    pub label: String,
    /// The storey it shows; `None` for all.
    pub level: Option<u32>,
    /// Passages, as pairs of stations.
    pub edges: Vec<[StationId; 2]>,
}

/// A map before scaling.
pub struct Sheet {
    /// The name of the map.
    pub what: &'static str,
    /// Notes for reading it.
    pub note: String,
    /// Whether up on paper is up in the cave.
    pub is_upright: bool,
    /// Vertical exaggeration.
    pub stretch: f64,
    /// Every station of the graph.
    pub stations: Vec<SheetStation>,
    /// The panels, side by side.
    pub panels: Vec<Panel>,
    /// The bounds of all panels combined.
    pub everything: Panel,
    /// Lowest and highest station.
    pub heights_m: [f64; 2],
}

impl Sheet {
    /// The plan.
    pub fn plan(subject: &Subject) -> Self {
        let station = |node: &Node| {
            let aside = f64::from(subject.passage.reach(node).aside_m);
            let [x, y, z] = node.position.coords.into();
            SheetStation { at: [x, y], depth: z, height_m: z, reach: [aside; 3], level: node.level }
        };
        let stations = subject.graph.nodes.iter().map(station).collect();
        let panels = storeys(subject.graph);
        Self { panels, ..Self::new("plan", subject.graph, stations) }
    }

    /// The profile, on paper with this ratio of height to width.
    pub fn profile(subject: &Subject, ratio: f64) -> Self {
        let [along_x, along_y] = longest_axis(subject.graph);
        let station = |node: &Node| {
            let reach = subject.passage.reach(node);
            let [x, y, z] = node.position.coords.into();
            SheetStation {
                at: [x * along_x + y * along_y, z],
                depth: x * along_y - y * along_x,
                height_m: z,
                reach: [reach.aside_m, reach.up_m, reach.down_m].map(f64::from),
                level: node.level,
            }
        };
        let stations = subject.graph.nodes.iter().map(station).collect();
        let azimuth_deg = libm::round(azimuth_deg(along_x, along_y));
        let note = format!("right is {azimuth_deg:03}°");
        Self { is_upright: true, note, ..Self::new("profile", subject.graph, stations) }.stretched(ratio)
    }

    fn new(what: &'static str, graph: &Graph, stations: Vec<SheetStation>) -> Self {
        let heights = stations.iter().map(|station| station.height_m);
        let heights_m = [heights.clone().fold(f64::INFINITY, f64::min), heights.fold(f64::NEG_INFINITY, f64::max)];
        let everything = || Panel { label: String::new(), level: None, edges: graph.edges.clone() };
        Self {
            what,
            note: String::new(),
            is_upright: false,
            stretch: 1.0,
            stations,
            panels: vec![everything()],
            everything: everything(),
            heights_m,
        }
    }

    /// Exaggerates heights until they are legible.
    fn stretched(mut self, ratio: f64) -> Self {
        let [width_m, height_m] = self.bounds().size();
        let flatness = height_m / width_m / ratio;
        let enough = STRETCHES.into_iter().find(|stretch| stretch * flatness >= LEAST_HEIGHT);
        self.stretch = enough.unwrap_or(STRETCHES[STRETCHES.len() - 1]);
        for station in &mut self.stations {
            station.at[1] *= self.stretch;
            station.reach[1] *= self.stretch;
            station.reach[2] *= self.stretch;
        }
        self
    }

    /// A box round everything.
    pub fn bounds(&self) -> Aabb<f64, 2> {
        let bounds = self.stations.iter().map(|&SheetStation { at: [x, y], reach: [aside, up, down], .. }| Aabb {
            min: [x - aside, y - down],
            max: [x + aside, y + up],
        });
        bounds.reduce(Aabb::union).expect("a sheet has stations")
    }

    /// Relative height between the lowest and the highest station, 0–1.
    pub fn share(&self, height_m: f64) -> f64 {
        let [low, high] = self.heights_m;
        if high > low { ((height_m - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 }
    }
}

impl Index<StationId> for Sheet {
    type Output = SheetStation;

    fn index(&self, station: StationId) -> &SheetStation {
        &self.stations[station.index()]
    }
}

/// A panel for each storey. A passage between two is drawn in both.
fn storeys(graph: &Graph) -> Vec<Panel> {
    let mut levels: Vec<u32> = graph.nodes.iter().map(|node| node.level).collect();
    levels.sort_unstable();
    levels.dedup();
    if levels.len() < 2 || levels.len() > MOST_PANELS {
        return vec![Panel { label: String::new(), level: None, edges: graph.edges.clone() }];
    }
    levels.into_iter().map(|level| storey(graph, level)).collect()
}

fn storey(graph: &Graph, level: u32) -> Panel {
    let is_here = |edge: &&[StationId; 2]| edge.iter().any(|&end| graph[end].level == level);
    let heights = graph.nodes.iter().filter(|node| node.level == level).map(|node| node.position.z);
    let (low, high) = (heights.clone().fold(f64::INFINITY, f64::min), heights.fold(f64::NEG_INFINITY, f64::max));
    let (low, high) = (whole(low), whole(high));
    let heights = if low == high { low } else { format!("{low} to {high}") };
    let label = format!("storey {level}, {heights} m");
    Panel { label, level: Some(level), edges: graph.edges.iter().filter(is_here).copied().collect() }
}

/// A rounded number.
pub fn whole(number: f64) -> String {
    // Adding zero turns -0.0 into 0.0.
    format!("{}", libm::round(number) + 0.0).replace('-', "−")
}

/// Unit vector along the first horizontal principal axis of the stations, pointing east if possible.
fn longest_axis(graph: &Graph) -> [f64; 2] {
    let count = graph.nodes.len() as f64;
    let sum = |of: &dyn Fn(&Node) -> f64| graph.nodes.iter().map(of).sum::<f64>() / count;
    let (x, y) = (sum(&|node| node.position.x), sum(&|node| node.position.y));
    let xx = sum(&|node| (node.position.x - x) * (node.position.x - x));
    let yy = sum(&|node| (node.position.y - y) * (node.position.y - y));
    let xy = sum(&|node| (node.position.x - x) * (node.position.y - y));
    let angle = libm::atan2(2.0 * xy, xx - yy) / 2.0;
    [libm::cos(angle), libm::sin(angle)]
}

/// Clockwise from north (+y), 0–360.
fn azimuth_deg(x: f64, y: f64) -> f64 {
    let degrees = libm::atan2(x, y).to_degrees();
    if degrees < 0.0 { degrees + 360.0 } else { degrees }
}

//! Numbers of a cave, for the index of a dataset.

use plume::cave::Cave;
use plume::store::{Facts, Stage, sha256};
use plume_graph::Graph;
use plume_graph::realism::{Likeness, Verdict};
use plume_truth::{Certificate, Class};
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Numbers of a cave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Number of stations.
    pub stations: usize,
    /// Number of independent loops.
    pub loops: usize,
    /// Length of all passages in metres.
    pub length_m: f64,
    /// From the lowest to the highest station, in metres.
    pub depth_m: f64,
    /// Mean inclination of the passages by length, in degrees.
    pub slope_mean_deg: f64,
    /// Largest inclination of a passage, in degrees.
    pub slope_max_deg: f64,
    /// Whether the graph is like that of a real cave.
    pub realism: String,
    /// Number of chunks.
    pub chunks: usize,
    /// Number of triangles of the wall.
    pub triangles: usize,
    /// Number of triangles to collide with.
    pub collision_triangles: usize,
    /// Number of convex pieces, if a target has them.
    pub pieces: usize,
    /// Number of stones, dripstones, equipment and other things.
    pub things: usize,
    /// Area of the wall in square metres.
    pub wall_m2: f64,
    /// Width of the narrowest passage for the robot of the certificate, in metres.
    pub width_min_m: Option<f64>,
    /// Share of the stations that the robot surely reaches and leaves again.
    pub reached: Option<f64>,
    /// Share of the passages that are called go both ways.
    pub go: Option<f64>,
}

impl Measures {
    /// Of a finished cave.
    pub fn of(cave: &Cave, certificate: Option<&Certificate>) -> Self {
        let graph = cave.graph();
        let heights = || graph.nodes.iter().map(|node| node.position.z);
        let [mean, max] = slopes_deg(graph);
        let verdict = Likeness::of(graph).map_or(Verdict::TooSmall, |likeness| likeness.verdict);
        let mut measures = Self {
            stations: graph.nodes.len(),
            loops: graph.loops(),
            length_m: rounded(graph.length_m()),
            depth_m: rounded(heights().fold(f64::MIN, f64::max) - heights().fold(f64::MAX, f64::min)),
            slope_mean_deg: rounded(mean),
            slope_max_deg: rounded(max),
            realism: json!(verdict).as_str().unwrap_or_default().to_owned(),
            chunks: 0,
            triangles: 0,
            collision_triangles: 0,
            pieces: 0,
            things: 0,
            wall_m2: 0.0,
            width_min_m: None,
            reached: None,
            go: None,
        };
        measures.count(cave);
        if let Some(certificate) = certificate {
            measures.certify(certificate);
        }
        measures
    }

    fn count(&mut self, cave: &Cave) {
        let stages = [Stage::Mesh, Stage::Things, Stage::Pieces];
        let mut wall_m2 = 0.0;
        for unit in stages.into_iter().flat_map(|stage| cave.folder().units(stage)) {
            match unit.facts {
                Facts::Mesh(facts) => {
                    self.chunks += usize::from(facts.triangles > 0);
                    self.triangles += facts.triangles;
                    self.collision_triangles += facts.collision_triangles.unwrap_or_default();
                    wall_m2 += facts.area_m2.unwrap_or_default();
                }
                Facts::Things(facts) if unit.name != plume::store::WHOLE_CAVE => self.things += facts.things,
                Facts::Pieces(facts) => self.pieces += facts.pieces,
                _ => {}
            }
        }
        self.wall_m2 = rounded(wall_m2);
    }

    fn certify(&mut self, certificate: &Certificate) {
        let share = |part: usize, whole: usize| rounded(part as f64 / whole.max(1) as f64);
        let Certificate { stations, passages, .. } = certificate;
        let is_go = |class: Class| class == Class::Go;
        let go = passages.iter().filter(|through| is_go(through.there.class) && is_go(through.back.class)).count();
        self.width_min_m = passages.iter().map(|through| rounded(through.widest_m)).reduce(f64::min);
        self.reached = Some(share(stations.iter().filter(|reach| reach.is_sure()).count(), stations.len()));
        self.go = Some(share(go, passages.len()));
    }
}

/// SHA-256 of the stations and passages of a graph: two caves with the same have the same layout.
pub fn graph_sha256(graph: &Graph) -> String {
    let stations = graph.nodes.iter().flat_map(|node| {
        let [x, y, z] = node.position.into();
        [x, y, z, node.radius].into_iter().flat_map(f64::to_le_bytes)
    });
    let passages = graph.edges.iter().flatten().flat_map(|end| graph[*end].id.to_le_bytes());
    sha256(&stations.chain(passages).collect::<Vec<u8>>())
}

/// The mean inclination by length, and the largest.
fn slopes_deg(graph: &Graph) -> [f64; 2] {
    let (mut sum, mut length_m, mut max) = (0.0, 0.0, 0.0_f64);
    for [a, b] in &graph.edges {
        let way = graph[*b].position - graph[*a].position;
        let slope = libm::atan2(way.z.abs(), way.xy().norm()).to_degrees();
        (sum, length_m, max) = (sum + slope * way.norm(), length_m + way.norm(), max.max(slope));
    }
    [if length_m > 0.0 { sum / length_m } else { 0.0 }, max]
}

/// To a thousandth.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

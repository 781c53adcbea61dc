//! Places layers at their depths.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::layer::Layer;
use plume_graph::clearance::{Body, PassageIndex, PassageSize};
use plume_graph::{Graph, StationId, millimetres};

/// Minimum step when a layer is moved down, in metres, so that the search terminates.
const LEAST_MOVE_M: f64 = 0.25;

/// Layers with the rock around them.
#[derive(Clone)]
pub(super) struct Stack {
    pub(super) passages: PassageIndex,
    /// The stations of each layer. Stations of links, and those inserted into passages for links, come after all of them.
    pub(super) layers: Vec<Range<usize>>,
    /// Number of levels so far.
    levels: u32,
    /// Middle of the first layer, horizontally.
    middle: Option<Point3<f64>>,
}

impl Default for Stack {
    fn default() -> Self {
        let passages = PassageIndex::new(&Graph::default(), PassageSize::default());
        Self { passages, layers: Vec::new(), levels: 0, middle: None }
    }
}

impl Stack {
    /// Places a layer below the existing ones: at its depth, or as far below as needed for `rock_m` of rock to all of them.
    /// A layer without a depth is placed deeper by the given extra amount.
    pub(super) fn lay(&mut self, mut graph: Graph, layer: &Layer, rock_m: Option<f64>, deeper_m: f64) {
        let own = PassageIndex::new(&graph, PassageSize::default());
        let bodies: Vec<Body> = own.all_bodies().into_iter().map(|body| own.body(body)).collect();
        let mut by = self.start(&graph, layer);
        while let Some(lacking_m) = rock_m.and_then(|rock_m| self.lacking(&bodies, &by, rock_m)) {
            by.z = millimetres(by.z - lacking_m.max(LEAST_MOVE_M));
        }
        if layer.depth_m.is_none() && !self.layers.is_empty() {
            by.z -= deeper_m;
        }
        for node in &mut graph.nodes {
            node.position = (node.position + by).map(millimetres);
            node.level += self.levels;
        }
        self.append(graph);
    }

    /// The initial shift of a layer: its middle below that of the first layer, its origin at its depth, or its top at the
    /// bottom of the layer above.
    fn start(&mut self, graph: &Graph, layer: &Layer) -> Vector3<f64> {
        let Some(bounds) = graph.bounds() else { return Vector3::zeros() };
        let middle = Point3::from(bounds.center());
        let first = *self.middle.get_or_insert(middle);
        let aside = Vector3::new(layer.east_m, layer.north_m, 0.0);
        let bottom = self.layers.last().map(|above| {
            let heights = self.passages.nodes[above.clone()].iter().map(|node| node.position.z);
            heights.fold(f64::INFINITY, f64::min) - bounds.max[2]
        });
        let z = layer.depth_m.map(|depth_m| -depth_m).or(bottom).unwrap_or(0.0);
        let mut by = first - middle + aside;
        by.z = z;
        by.map(millimetres)
    }

    /// How much rock is missing between a layer shifted like this and those above.
    fn lacking(&self, bodies: &[Body], by: &Vector3<f64>, rock_m: f64) -> Option<f64> {
        let rocks = bodies.iter().filter_map(|body| self.passages.thinnest(&body.moved(by), rock_m));
        rocks.min_by(f64::total_cmp).map(|least_m| rock_m - least_m)
    }

    fn append(&mut self, graph: Graph) {
        let start = self.passages.nodes.len();
        self.levels = graph.nodes.iter().map(|node| node.level + 1).max().unwrap_or(self.levels);
        let joined = |edge: &[StationId; 2]| edge.map(|station| StationId::new(start + station.index()));
        for node in graph.nodes {
            self.passages.add(node);
        }
        graph.edges.iter().map(joined).for_each(|[a, b]| self.passages.join(a, b));
        self.layers.push(start..self.passages.nodes.len());
        let is_new = |body: &[StationId; 2]| body[0].index() >= start;
        let new: Vec<[StationId; 2]> = self.passages.all_bodies().into_iter().filter(is_new).collect();
        self.passages.settle(&new);
    }
}

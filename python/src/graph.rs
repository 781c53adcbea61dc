//! Graphs.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use plume::{cave, pipeline};
use pyo3::prelude::*;

use crate::array;

/// A graph: stations, and the passages between them.
///
/// The arrays are copies, made when `Cave.graph` is accessed.
#[pyclass(module = "plume", frozen)]
pub struct Graph {
    cave: Arc<cave::Cave>,
    positions: Py<PyArray2<f64>>,
    radii: Py<PyArray1<f64>>,
    edges: Py<PyArray2<u32>>,
}

impl Graph {
    /// The graph of a cave.
    pub fn new(py: Python<'_>, cave: Arc<cave::Cave>) -> PyResult<Self> {
        let graph = cave.graph();
        let positions = graph.nodes.iter().map(|node| node.position.coords.into()).collect::<Vec<[f64; 3]>>();
        let radii = graph.nodes.iter().map(|node| node.radius).collect();
        let edges = graph.edges.iter().map(|edge| edge.map(|node| node.index() as u32)).collect();
        Ok(Self {
            positions: array::rows(py, positions)?.unbind(),
            radii: PyArray1::from_vec(py, radii).unbind(),
            edges: array::rows(py, edges)?.unbind(),
            cave,
        })
    }
}

#[pymethods]
impl Graph {
    /// The stations, points on the centrelines of passages: (n, 3) float64, m.
    ///
    /// >>> cave.graph.positions.shape, str(cave.graph.positions.dtype)
    /// ((12, 3), 'float64')
    #[getter]
    fn positions(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.positions.clone_ref(py)
    }

    /// Reach of each station to the next: (n,) float64, m. Passage widths are proportional to it.
    #[getter]
    fn radii(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.radii.clone_ref(py)
    }

    /// The passages as pairs of rows of `positions`: (m, 2) uint32, smaller row first, sorted, unique.
    #[getter]
    fn edges(&self, py: Python<'_>) -> Py<PyArray2<u32>> {
        self.edges.clone_ref(py)
    }

    /// What a survey calls each station, in the order of `positions`; `None` where it has no name.
    ///
    /// >>> set(cave.graph.names)
    /// {None}
    #[getter]
    fn names(&self) -> Vec<Option<&str>> {
        self.cave.graph().nodes.iter().map(|node| node.name.as_deref()).collect()
    }

    /// Where the origin of the cave lies in the coordinates of its survey: east, north and up in metres, and the coordinate
    /// system as the survey names it, such as `EPSG:32633`, if it does. `None` if that is unknown.
    ///
    /// >>> cave.graph.georeference is None
    /// True
    #[getter]
    fn georeference(&self) -> Option<([f64; 3], Option<&str>)> {
        let place = self.cave.graph().georeference.as_ref()?;
        Some((place.origin_m.into(), place.system.as_deref()))
    }

    /// The text of the graph file with its recipe: `graph.json` of the cave folder, from which alone `generate` can make
    /// the same cave again.
    fn to_json(&self) -> String {
        pipeline::graph_text(self.cave.recipe(), self.cave.graph())
    }

    /// The content of the graph file as a new dict.
    ///
    /// >>> sorted(cave.graph.to_dict())
    /// ['nodes', 'plume', 'recipe']
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (self.to_json(),))
    }

    fn __repr__(&self) -> String {
        let graph = self.cave.graph();
        format!("<plume.Graph: {} stations, {} passages>", graph.nodes.len(), graph.edges.len())
    }
}

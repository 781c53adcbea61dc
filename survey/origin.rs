//! The origin of a graph in the coordinates of its file.
//!
//! Caves are exact only near their origin, and national grids have their origins thousands of kilometres away. A survey is
//! always moved so that its entrance is the origin. A graph keeps the coordinates of its file, unless it reaches beyond the
//! limit of graphs: then its first node with a passage becomes the origin. This is done in double precision and before
//! anything is rounded, so millimetres are kept; [`Tally::origin_m`] is the offset.

use std::path::Path;

use nalgebra::Point3;

use super::draft::Draft;
use super::limits::MAX_LENGTH_M;
use super::{Import, Parts, ReadError, Tally};
use plume_graph::Georeference;

impl Draft {
    /// The graph of the file at `path`, with the file's names of nodes.
    ///
    /// # Errors
    /// If its nodes are too far from each other, or it is not a valid graph.
    pub(super) fn into_import(
        mut self,
        path: &Path,
        parts: Parts,
        name: impl Fn(usize) -> String,
    ) -> Result<Import, ReadError> {
        let origin = self.origin();
        if origin != Point3::origin() {
            let (known_m, system) = match self.georeference.take() {
                Some(known) => (known.origin_m, known.system),
                None => (Point3::origin(), None),
            };
            self.georeference = Georeference::of(known_m + origin.coords, system);
        }
        self.nodes.iter_mut().for_each(|node| node.position = counted_from(origin, node.position));
        check_reach(path, self.nodes.iter().map(|node| node.position))?;
        let (graph, tally) = self.finished(parts).map_err(|error| error.into_error(path, name))?;
        Ok(Import { graph, recipe: None, tally: Tally { origin_m: origin, ..tally }, warnings: Vec::new() })
    }

    /// The origin of the file, if all nodes are near it.
    fn origin(&self) -> Point3<f64> {
        let is_near = self.nodes.iter().all(|node| is_near(node.position));
        let first = self.edges.iter().flatten().min().filter(|_| !is_near);
        first.map_or_else(Point3::origin, |first| self.nodes[first.index()].position)
    }
}

/// A position relative to another.
pub(super) fn counted_from(origin: Point3<f64>, place: Point3<f64>) -> Point3<f64> {
    Point3::from(place - origin)
}

/// Refuses positions that are farther from the origin than a graph may reach.
pub(super) fn check_reach(path: &Path, places: impl Iterator<Item = Point3<f64>>) -> Result<(), ReadError> {
    let Some(far) = places.into_iter().find(|&place| !is_near(place)) else { return Ok(()) };
    let (far_km, most_km) = (far.coords.amax() / 1000.0, MAX_LENGTH_M / 1000.0);
    let message = format!("has stations {far_km:.0} km from each other, more than {most_km:.0} km");
    Err(ReadError::whole(path, message, "use one coordinate system for all stations, in metres"))
}

fn is_near(place: Point3<f64>) -> bool {
    place.coords.amax() <= MAX_LENGTH_M
}

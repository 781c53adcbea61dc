//! Where the origin of a graph lies in the coordinates of its file.
//!
//! Caves are exact only near their origin, and national grids count from thousands of kilometres away. A survey is always
//! counted from its entrance. A graph is where its file puts it; only one that reaches farther than a graph may is counted from
//! the first of its nodes that is on a passage. That is done in double precision and before anything is rounded, so millimetres
//! stay millimetres, and [`Tally::origin_m`] leads back.

use std::path::Path;

use nalgebra::Point3;

use super::draft::Draft;
use super::limits::MAX_LENGTH_M;
use super::{Import, Parts, ReadError, Tally};

impl Draft {
    /// The graph of the file at `path`, which calls its nodes by these names.
    ///
    /// # Errors
    /// When its nodes are too far from each other, or no graph comes of it.
    pub(super) fn into_import(
        mut self,
        path: &Path,
        parts: Parts,
        name: impl Fn(usize) -> String,
    ) -> Result<Import, ReadError> {
        let origin = self.origin();
        self.nodes.iter_mut().for_each(|node| node.position = counted_from(origin, node.position));
        check_reach(path, self.nodes.iter().map(|node| node.position))?;
        let (graph, tally) = self.finished(parts).map_err(|error| error.into_error(path, name))?;
        Ok(Import { graph, recipe: None, tally: Tally { origin_m: origin, ..tally } })
    }

    /// That of the file, as long as all nodes are near it.
    fn origin(&self) -> Point3<f64> {
        let is_near = self.nodes.iter().all(|node| is_near(node.position));
        let first = self.edges.iter().flatten().min().filter(|_| !is_near);
        first.map_or_else(Point3::origin, |first| self.nodes[first.index()].position)
    }
}

/// A place as it is counted from another.
pub(super) fn counted_from(origin: Point3<f64>, place: Point3<f64>) -> Point3<f64> {
    Point3::from(place - origin)
}

/// Refuses places that are farther from the origin than a graph may reach.
pub(super) fn check_reach(path: &Path, places: impl Iterator<Item = Point3<f64>>) -> Result<(), ReadError> {
    let Some(far) = places.into_iter().find(|&place| !is_near(place)) else { return Ok(()) };
    let (far_km, most_km) = (far.coords.amax() / 1000.0, MAX_LENGTH_M / 1000.0);
    let message = format!("has stations {far_km:.0} km from each other, and {most_km:.0} km is the most");
    Err(ReadError::whole(path, message, "give all stations in one coordinate system, in metres"))
}

fn is_near(place: Point3<f64>) -> bool {
    place.coords.amax() <= MAX_LENGTH_M
}

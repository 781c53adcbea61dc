//! Caves from height maps: the void between a relief and its mirror image.
//!
//! Everything above a threshold is open, and its medial axes are the passages: as wide as the open area is there, and twice
//! as high as the relief above the threshold, since floor and ceiling are mirror images about a level plane. So a picture,
//! a digital elevation model of a valley or a noise texture becomes a cave. Without a file, the relief consists of ridges of
//! noise, as large as the number of nodes requires.
//!
//! Promised: exactly the asked number of nodes in one component, at most five passages at a node; disconnected regions are
//! joined by corridors, and specks of a few cells are dropped. Files are treated as hostile: they are read within fixed
//! limits.

mod image;
mod relief;

use std::path::PathBuf;

use nalgebra::Point3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GenerateError, Generator};
use crate::raster::{self, Mask};
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::centreline::CentrelineBuilder;

/// Specks of rock or void smaller than this many cells are dropped (tuned: there is no room for them between stations).
const LEAST_CELLS: usize = 24;

/// Settings of the height map generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Heightmap {
    /// Number of nodes (stations on the centreline), spread over all passages of a file.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// The height map, relative to the recipe: a greyscale PNG of 8 or 16 bits, or an ESRI ASCII grid. None: ridges of
    /// noise.
    #[schemars(extend("format" = "path"))]
    pub path: Option<PathBuf>,
    /// Size of a cell in metres; an ASCII grid has its own.
    #[schemars(range(min = 0.1, max = 100.0))]
    pub metres_per_pixel: f64,
    /// Height of white above black, in metres; an ASCII grid has its own.
    #[schemars(range(min = 0.1, max = 1000.0))]
    pub height_range_m: f64,
    /// Everything above this fraction of the height between the lowest and the highest point is open.
    #[schemars(range(min = 0.02, max = 0.98))]
    pub threshold: f64,
    /// Whether valleys are open instead of ridges.
    pub invert: bool,
    /// Distance between stations in metres, if there is no file.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub station_spacing_m: f64,
    /// Distance between ridges in metres, if there is no file.
    #[schemars(range(min = 8.0, max = 200.0))]
    pub ridge_spacing_m: f64,
    /// Minimum width of a passage, in metres.
    #[schemars(range(min = 1.0, max = 6.0))]
    pub width_min_m: f64,
    /// Maximum width of a passage, in metres.
    #[schemars(range(min = 6.0, max = 40.0))]
    pub width_max_m: f64,
    /// Minimum height of a passage, in metres.
    #[schemars(range(min = 1.0, max = 4.0))]
    pub height_min_m: f64,
    /// Maximum height of a passage, in metres.
    #[schemars(range(min = 4.0, max = 40.0))]
    pub height_max_m: f64,
}

impl Default for Heightmap {
    fn default() -> Self {
        Self {
            nodes: 200,
            path: None,
            metres_per_pixel: 1.0,
            height_range_m: 8.0,
            threshold: 0.76,
            invert: false,
            station_spacing_m: 4.0,
            ridge_spacing_m: 24.0,
            width_min_m: 2.0,
            width_max_m: 8.0,
            height_min_m: 2.0,
            height_max_m: 6.0,
        }
    }
}

/// A relief, row by row from the north.
#[derive(Debug)]
struct Heights {
    columns: usize,
    /// From 0 for the lowest point to 1 for the highest.
    values: Vec<f32>,
    cell_m: f64,
    range_m: f64,
}

impl Generator for Heightmap {
    fn generate(&self, seed: u64, outside: &dyn Outside) -> Result<Graph, GenerateError> {
        let length_m = f64::from(self.nodes) * self.station_spacing_m;
        let (heights, most_m) = match &self.path {
            Some(path) => (image::read(path, self, outside)?, f64::INFINITY),
            None => (relief::ridges(self, length_m, seed), length_m),
        };
        let centreline = self.shaped(raster::traced(&self.open(&heights), heights.cell_m), &heights);
        let cut = centreline.rooted_in_the_middle().cut_to(most_m).without_spurs();
        cut.with_nodes(self.nodes as usize, f64::INFINITY).ok_or_else(|| self.nothing_open())
    }
}

impl Heightmap {
    fn nothing_open(&self) -> GenerateError {
        GenerateError::new(
            format!("the relief above {} of its height is too small for {} nodes", self.threshold, self.nodes),
            "lower `threshold`, or ask for fewer nodes",
        )
    }

    /// Height of the relief here, from 0 to 1, inverted if asked.
    fn value(&self, value: f32) -> f64 {
        if self.invert { 1.0 - f64::from(value) } else { f64::from(value) }
    }

    /// The cells above the threshold, as one region.
    fn open(&self, heights: &Heights) -> Mask {
        let rows = heights.values.len() / heights.columns;
        // A frame of rock closes passages at the edge of the picture.
        let mut mask = Mask::rock(heights.columns + 2, rows + 2);
        for (row, values) in heights.values.chunks_exact(heights.columns).enumerate() {
            let cells = &mut mask.open[(row + 1) * (heights.columns + 2) + 1..];
            cells.iter_mut().zip(values).for_each(|(open, &value)| *open = self.value(value) > self.threshold);
        }
        let half_width = (0.5 * self.width_min_m / heights.cell_m).round().max(1.0) as usize;
        let mask = raster::without_pockets(mask, LEAST_CELLS);
        raster::without_pillars(raster::joined(mask, half_width), LEAST_CELLS)
    }

    /// Passages with the heights of the relief and its mirror image.
    fn shaped(&self, mut centreline: CentrelineBuilder, heights: &Heights) -> CentrelineBuilder {
        let threshold = self.threshold;
        for vertex in &mut centreline.vertices {
            let above = self.value(heights.at(vertex.position)) - threshold;
            if let Some(section) = &mut vertex.section {
                section.width_m = section.width_m.clamp(self.width_min_m, self.width_max_m);
                section.height_m = (2.0 * above * heights.range_m).clamp(self.height_min_m, self.height_max_m);
            }
        }
        centreline
    }
}

impl Heights {
    /// The value of the cell that contains a point; the origin is the middle of the relief.
    fn at(&self, point: Point3<f64>) -> f32 {
        let rows = self.values.len() / self.columns;
        let cell = |from_middle_m: f64, count: usize| {
            let at = from_middle_m / self.cell_m + 0.5 * count as f64;
            (at.max(0.0) as usize).min(count - 1)
        };
        self.values[cell(-point.y, rows) * self.columns + cell(point.x, self.columns)]
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;
    use std::io;
    use std::path::Path;

    use super::*;

    /// A grid with a ring 5 m high.
    struct Ring;

    impl Outside for Ring {
        fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
            let mut grid = "ncols 40\nnrows 40\ncellsize 1\n".to_owned();
            for cell in 0..1600 {
                let [x, y] = [cell % 40, cell / 40].map(|at| f64::from(at) - 19.5);
                let away = (x * x + y * y).sqrt();
                let _ = write!(grid, "{} ", if (10.0..16.0).contains(&away) { 5 } else { 0 });
            }
            Ok(grid.into_bytes())
        }
    }

    #[test]
    fn a_ring_is_a_loop_of_its_width_and_height() {
        let settings = Heightmap { path: Some("ring.asc".into()), nodes: 20, threshold: 0.6, ..Heightmap::default() };
        let graph = settings.generate(1, &Ring).expect("a ring is open");
        assert_eq!((graph.nodes.len(), graph.loops()), (20, 1));
        for node in &graph.nodes {
            let section = node.section.expect("relief has sections");
            assert!((4.5..=6.5).contains(&section.width_m), "{}", section.width_m);
            assert_eq!(section.height_m, 4.0);
            assert!((12.0..=14.0).contains(&node.position.coords.norm()), "{}", node.position);
        }
        assert!(Heightmap { invert: true, ..settings }.generate(1, &Ring).is_ok());
    }
}

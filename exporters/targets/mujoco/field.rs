//! A height field of the floor of a chunk: the lowest upward-facing surface in each column.
//!
//! It has no overhangs, no ceilings, and walls only where they lean back. Of several floors above each other it keeps the
//! lowest, because a height field is solid down to its base and would fill the passage below. Columns without a floor are as
//! low as the lowest sample of the chunk.

use std::io::{self, Write};

use nalgebra::{Point2, Vector2};

use crate::frame::micro;
use crate::scene::{Mesh, Zone};
use crate::slope;

/// Depth of the rock below the lowest sample, metres.
const BASE_M: f64 = 0.5;
/// Minimum height of a field, which MuJoCo requires, metres.
const LEAST_HEIGHT_M: f64 = 0.001;
/// Least height of a floor above another that makes it one of another passage, in metres: ledges are lower.
const STOREY_M: f64 = 1.5;
/// Tolerance for samples outside a triangle, relative to its size, so that neighbours leave no gap.
const SLACK: f64 = 1e-9;

/// Heights on a grid that spans the floor of a chunk.
pub struct Field {
    low: Point2<f64>,
    spacing: Vector2<f64>,
    counts: [usize; 2],
    /// Heights by row from south to north, each from west to east; infinite where there is no floor.
    heights_m: Vec<f64>,
    /// Where the highest floor is there; negative infinite where there is none on which anything could stand.
    tops_m: Vec<f64>,
}

impl Field {
    /// The field of the upward-facing triangles of `mesh`, with samples about `spacing_m` apart. Samples are on its border,
    /// so that the fields of neighbours meet.
    pub fn new(mesh: &Mesh, spacing_m: f64) -> Self {
        let [low, high] = mesh.bounds().map(|[x, y, _]| Point2::new(f64::from(x), f64::from(y)));
        let cells = (high - low).map(|length| (length / spacing_m).ceil().max(1.0));
        let counts = [cells.x as usize + 1, cells.y as usize + 1];
        let spacing = (high - low).component_div(&cells);
        let samples = counts[0] * counts[1];
        let (heights_m, tops_m) = (vec![f64::INFINITY; samples], vec![f64::NEG_INFINITY; samples]);
        let mut field = Self { low, spacing, counts, heights_m, tops_m };
        for (corners, normal) in mesh.indices.chunks_exact(3).zip(slope::face_normals(mesh)) {
            let corners = [0, 1, 2].map(|k| mesh.positions[corners[k] as usize].map(f64::from));
            if normal[2] > 0.0 {
                field.add(corners, slope::zone(normal) == Zone::Floor);
            }
        }
        field
    }

    /// Area of the floors that are above another one, with a passage between them, in square metres: they are lost.
    pub fn stacked_m2(&self) -> f64 {
        let both = self.heights_m.iter().zip(&self.tops_m);
        let stacked = both.filter(|(lowest, highest)| **highest > **lowest + STOREY_M).count();
        stacked as f64 * self.spacing.x * self.spacing.y
    }

    /// Triangles of its surface.
    pub fn triangles(&self) -> u64 {
        2 * (self.counts[0] as u64 - 1) * (self.counts[1] as u64 - 1)
    }

    /// Whether there is any floor.
    pub fn is_empty(&self) -> bool {
        self.heights_m.iter().all(|height| height.is_infinite())
    }

    /// Writes the asset `name`. Rows in MJCF begin in the north.
    ///
    /// # Errors
    /// Those of `file`.
    pub fn write_asset(&self, file: &mut dyn Write, name: &str) -> io::Result<()> {
        let [low_m, height_m] = self.range_m();
        let [x, y] = self.half_size().into();
        let size = [x, y, height_m, BASE_M].map(micro).join(" ");
        let [columns, rows] = self.counts;
        write!(file, r#"    <hfield name="{name}" nrow="{rows}" ncol="{columns}" size="{size}" elevation=""#)?;
        for row in self.heights_m.chunks_exact(columns).rev() {
            for height in row {
                let height = if height.is_finite() { height - low_m } else { 0.0 };
                write!(file, "{} ", micro(height))?;
            }
        }
        writeln!(file, r#""/>"#)
    }

    /// Position of the geom.
    pub fn position(&self) -> [f64; 3] {
        let center = self.low + self.half_size();
        [center.x, center.y, self.range_m()[0]]
    }

    fn half_size(&self) -> Vector2<f64> {
        let [columns, rows] = self.counts.map(|count| (count - 1) as f64);
        self.spacing.component_mul(&Vector2::new(columns, rows)) / 2.0
    }

    /// The lowest sample, and how far the highest is above it.
    fn range_m(&self) -> [f64; 2] {
        let floor = || self.heights_m.iter().copied().filter(|height| height.is_finite());
        let low_m = floor().fold(f64::INFINITY, f64::min);
        [low_m, (floor().fold(low_m, f64::max) - low_m).max(LEAST_HEIGHT_M)]
    }

    /// Adds a triangle that faces upwards, and on which something can stand or not.
    fn add(&mut self, corners: [[f64; 3]; 3], carries: bool) {
        let flat = corners.map(|[x, y, _]| (Point2::new(x, y) - self.low).component_div(&self.spacing));
        let [a, b, c] = flat;
        let area = (b - a).perp(&(c - a));
        let span = |axis: usize| {
            let ends = flat.iter().map(|point| point[axis]);
            let (first, last) = ends.fold((f64::INFINITY, 0.0), |(low, high), x| (low.min(x), f64::max(high, x)));
            (first - SLACK).ceil().max(0.0) as usize..=((last + SLACK).floor() as usize).min(self.counts[axis] - 1)
        };
        for (row, column) in span(1).flat_map(|row| span(0).map(move |column| (row, column))) {
            let at = Vector2::new(column as f64, row as f64);
            let shares = [(b - at).perp(&(c - at)), (c - at).perp(&(a - at)), (a - at).perp(&(b - at))];
            if area > 0.0 && shares.iter().all(|share| share / area >= -SLACK) {
                let height: f64 = shares.iter().zip(corners).map(|(share, [_, _, z])| share / area * z).sum();
                let sample = row * self.counts[0] + column;
                self.heights_m[sample] = self.heights_m[sample].min(height);
                if carries {
                    self.tops_m[sample] = self.tops_m[sample].max(height);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_above_each_other_are_counted() {
        let square = |z: f32| [[0.0, 0.0, z], [2.0, 0.0, z], [2.0, 1.0, z], [0.0, 1.0, z]];
        let stacked_m2 = |height_m: f32| {
            let positions = [square(0.0), square(height_m)].concat();
            let indices = [0, 1, 2, 0, 2, 3, 4, 5, 6].to_vec();
            Field::new(&Mesh { positions, indices, ..Mesh::default() }, 0.01).stacked_m2()
        };
        assert_eq!(stacked_m2(1.4), 0.0);
        assert!((stacked_m2(1.6) - 1.0).abs() < 0.03, "{}", stacked_m2(1.6));
    }

    #[test]
    fn only_the_lowest_floor_is_kept() {
        let square = |z: f32| [[0.0, 0.0, z], [2.0, 0.0, z], [2.0, 1.0, z + 1.0], [0.0, 1.0, z + 1.0]];
        let positions = [square(5.0), square(3.0), square(1.0)].concat();
        let up = |first: u32| [0, 1, 2, 0, 2, 3].map(|k| first + k);
        let down = [8, 10, 9, 8, 11, 10];
        let indices = [up(0), up(4), down].concat();
        let field = Field::new(&Mesh { positions, indices, ..Mesh::default() }, 0.5);
        assert_eq!(field.counts, [5, 3]);
        assert_eq!(field.heights_m, [[3.0; 5], [3.5; 5], [4.0; 5]].concat());
        assert_eq!(field.position(), [1.0, 0.5, 3.0]);
    }
}

//! Worlds made of boxes.

use plume_truth::{Columns, Floor, Thin};

/// Triangles, counter-clockwise from the air.
#[derive(Clone, Default)]
pub struct World {
    pub corners: Vec<[f32; 3]>,
    pub indices: Vec<u32>,
}

impl World {
    /// A convex body between a lower and an upper quadrilateral, given as two opposite corners and the four heights of either;
    /// `inwards` for a room instead of a solid.
    pub fn with(mut self, [low, high]: [[f32; 2]; 2], bottom: [f32; 4], top: [f32; 4], inwards: bool) -> Self {
        let base = self.corners.len() as u32;
        let place = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        for heights in [bottom, top] {
            self.corners.extend(place.iter().zip(heights).map(|(at, z)| [at[0], at[1], z]));
        }
        let sides = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        for [a, b, c, d] in sides {
            for [a, b, c] in [[a, b, c], [a, c, d]] {
                let turned = if inwards { [a, c, b] } else { [a, b, c] };
                self.indices.extend(turned.map(|corner: u32| base + corner));
            }
        }
        self
    }

    /// A room between two corners of the map and two heights.
    pub fn room(low: [f32; 2], high: [f32; 2], floor: f32, ceiling: f32) -> Self {
        Self::default().with([low, high], [floor; 4], [ceiling; 4], true)
    }

    /// Its floor.
    pub fn floor(&self, cell_m: f64) -> Floor {
        let (mut columns, mut thin) = (Columns::new(cell_m), Thin::new(cell_m));
        columns.add(&self.corners, &self.indices);
        thin.add(&self.corners, &self.indices);
        Floor::new(columns).with_thin(thin)
    }
}

//! What is thinner than a cell, so that no vertical line through the centre of a cell meets it: straws that hang, cables.

use rustc_hash::FxHashMap;

use super::columns::Columns;

/// Points that are nearer to each other, as a share of a cell, count as one.
const SAME: f64 = 0.25;

/// Points on triangles that no line of a grid meets, for each cell of the map, in no order.
pub struct Thin {
    cell_m: f64,
    by_cell: FxHashMap<[i32; 2], Vec<f32>>,
}

impl Thin {
    /// Nothing yet, on a grid of cells with this side in metres.
    pub fn new(cell_m: f64) -> Self {
        Self { cell_m, by_cell: FxHashMap::default() }
    }

    /// Adds those of some triangles that no line meets: corners in metres, and three indices a triangle. Between two points on one
    /// of their edges it is half a cell at most.
    pub fn add(&mut self, corners: &[[f32; 3]], indices: &[u32]) {
        for triangle in indices.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|corner| corners[corner as usize].map(f64::from));
            if !Columns::meet(self.cell_m, [a, b, c]) {
                [[a, b], [b, c], [c, a]].into_iter().for_each(|[from, to]| self.add_edge(from, to));
            }
        }
    }

    fn add_edge(&mut self, from: [f64; 3], to: [f64; 3]) {
        let step = [0, 1, 2].map(|axis| to[axis] - from[axis]);
        let length_m = libm::sqrt(step.iter().map(|along_m| along_m * along_m).sum());
        let count = (2.0 * length_m / self.cell_m).ceil().max(1.0);
        // Its end is the start of the next.
        for number in 0..count as usize {
            let [x, y, z] = [0, 1, 2].map(|axis| from[axis] + step[axis] * number as f64 / count);
            let cell = [x, y].map(|along_m| (along_m / self.cell_m).floor() as i32);
            let over = self.by_cell.entry(cell).or_default();
            if !over.iter().any(|other| (f64::from(*other) - z).abs() < SAME * self.cell_m) {
                over.push(z as f32);
            }
        }
    }

    /// Heights in metres of the points over a cell of the map.
    pub fn over(&self, cell: [i32; 2]) -> &[f32] {
        self.by_cell.get(&cell).map_or(&[], Vec::as_slice)
    }
}

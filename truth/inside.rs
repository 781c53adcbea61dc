//! Whether points are in the air or in something solid.

use rustc_hash::FxHashMap;

use super::columns::{holds, side};

/// Side of the squares of the map by which triangles are found, in metres.
const SQUARE_M: f64 = 0.25;

/// Triangles that enclose what is solid, by the squares of the map that they are over.
#[derive(Default)]
pub struct Inside {
    triangles: Vec<[[f32; 3]; 3]>,
    squares: FxHashMap<[i32; 2], Vec<u32>>,
}

impl Inside {
    /// Adds triangles as [`Columns::add`](super::Columns::add) takes them.
    pub fn add(&mut self, corners: &[[f32; 3]], indices: &[u32]) {
        for triangle in indices.as_chunks::<3>().0 {
            let triangle = triangle.map(|corner| corners[corner as usize]);
            let number = self.triangles.len() as u32;
            let bound = |axis: usize, of: fn(f32, f32) -> f32| triangle.iter().map(|corner| corner[axis]).reduce(of);
            let square = |along_m: Option<f32>| square_of(along_m.unwrap_or_default().into());
            let [low, high] =
                [f32::min as fn(f32, f32) -> f32, f32::max].map(|of| [0, 1].map(|axis| square(bound(axis, of))));
            for i in low[0]..=high[0] {
                for j in low[1]..=high[1] {
                    self.squares.entry([i, j]).or_default().push(number);
                }
            }
            self.triangles.push(triangle);
        }
    }

    /// Whether a point in metres is in the air: on its way up it leaves as many bodies as it enters, and the rock once more.
    pub fn is_air(&self, point: [f32; 3]) -> bool {
        let [x, y, z] = point.map(f64::from);
        let over = self.squares.get(&[square_of(x), square_of(y)]);
        let turns =
            |number: &u32| turns(self.triangles[*number as usize].map(|corner| corner.map(f64::from)), [x, y, z]);
        over.into_iter().flatten().map(turns).sum::<i32>() == 1
    }
}

fn square_of(along_m: f64) -> i32 {
    (along_m / SQUARE_M).floor() as i32
}

/// 1 where a line straight up from a point enters something solid through a triangle, −1 where it leaves it, 0 if it misses it.
fn turns([a, b, c]: [[f64; 3]; 3], [x, y, z]: [f64; 3]) -> i32 {
    let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let is_entry = twice_area < 0.0;
    let [b, c] = if is_entry { [c, b] } else { [b, c] };
    let [of_a, of_b, of_c] = [side(b, c, [x, y]), side(c, a, [x, y]), side(a, b, [x, y])];
    let is_hit = twice_area != 0.0 && holds(of_a, b, c) && holds(of_b, c, a) && holds(of_c, a, b);
    let at_m = (a[2] * of_a + b[2] * of_b + c[2] * of_c) / (of_a + of_b + of_c);
    match (is_hit && at_m >= z, is_entry) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    }
}

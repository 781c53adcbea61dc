//! The floor around a cell, side by side: for those who look up most of it many times.

use super::columns::Gap;
use super::floor::Floor;

/// A square of cells of the map.
pub struct Window<'a> {
    floor: &'a Floor,
    size: Size,
    /// The range of cells of the floor over each cell of the map.
    ranges: Vec<[u32; 2]>,
}

/// How many cells a window has from its middle to each side.
#[derive(Clone, Copy)]
pub struct Size {
    reach: i32,
}

/// A place in any window of a size.
#[derive(Clone, Copy)]
pub struct Place(usize);

impl Size {
    /// Holds all within that many cells of the middle.
    pub fn new(reach: i32) -> Self {
        Self { reach }
    }

    /// The place at an offset in cells from the middle, which is within reach.
    pub fn place(self, [i, j]: [i32; 2]) -> Place {
        Place(((i + self.reach) * self.side() + j + self.reach) as usize)
    }

    fn side(self) -> i32 {
        2 * self.reach + 1
    }
}

impl<'a> Window<'a> {
    /// The window around a cell of the map.
    pub fn around(floor: &'a Floor, size: Size, middle: [i32; 2]) -> Self {
        let mut window = Self { floor, size, ranges: Vec::with_capacity((size.side() * size.side()) as usize) };
        window.move_to(middle);
        window
    }

    /// Makes it the window around another cell.
    pub fn move_to(&mut self, [i, j]: [i32; 2]) {
        let Size { reach } = self.size;
        self.ranges.clear();
        for row in i - reach..=i + reach {
            self.floor.ranges_over(row, j - reach..j + reach + 1, &mut self.ranges);
        }
    }

    /// Floor and ceiling in metres at a place: those whose floor is nearest to a height.
    pub fn gap(&self, Place(place): Place, near_m: f32) -> Option<[f32; 2]> {
        let [first, end] = self.ranges[place];
        let away_m = |gap: &&Gap| (gap.floor_m - near_m).abs();
        let over = &self.floor.cells()[first as usize..end as usize];
        let gap = over.iter().min_by(|a, b| away_m(a).total_cmp(&away_m(b)))?;
        Some([gap.floor_m, gap.ceiling_m])
    }
}

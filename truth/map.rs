//! An occupancy map of a storey.

use super::floor::Floor;
use super::storeys::Storeys;

/// How far from the free floor a map tells what is occupied, in metres; further off it is unknown.
const SEEN_M: f64 = 0.3;

/// What is at a cell of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Floor that the robot reaches.
    Free,
    /// Beside that: a wall, a step or a drop.
    Occupied,
    /// Neither.
    Unknown,
}

/// A storey from above.
pub struct OccupancyMap {
    /// Side of a cell in metres.
    pub cell_m: f64,
    /// The outer corner of the first cell, which is the lowest along both axes, in metres.
    pub origin_m: [f64; 2],
    /// Number of cells along x and y.
    pub size: [usize; 2],
    /// Row by row along y, each along x.
    pub cells: Vec<State>,
    /// Lowest and highest floor in metres.
    pub floor_m: [f32; 2],
}

impl OccupancyMap {
    /// The map of a storey, which is not empty.
    pub fn of(floor: &Floor, storeys: &Storeys, storey: u16) -> Self {
        let own = floor.cells().iter().zip(&storeys.of).filter(|(_, of)| **of == Some(storey)).map(|(gap, _)| gap);
        let margin = (SEEN_M / floor.cell_m()).ceil() as i32 + 1;
        let (mut low, mut high, mut floor_m) = ([i32::MAX; 2], [i32::MIN; 2], [f32::INFINITY, f32::NEG_INFINITY]);
        for gap in own.clone() {
            for axis in 0..2 {
                low[axis] = low[axis].min(gap.cell[axis] - margin);
                high[axis] = high[axis].max(gap.cell[axis] + margin);
            }
            floor_m = [floor_m[0].min(gap.floor_m), floor_m[1].max(gap.floor_m)];
        }
        let size = [0, 1].map(|axis| (high[axis] + 1 - low[axis]) as usize);
        let origin_m = low.map(|n| f64::from(n) * floor.cell_m());
        let cells = vec![State::Unknown; size[0] * size[1]];
        let mut map = Self { cell_m: floor.cell_m(), origin_m, size, cells, floor_m };
        let place = |gap: &crate::Gap| [0, 1].map(|axis| (gap.cell[axis] - low[axis]) as usize);
        for [x, y] in own.clone().map(place) {
            map.surround(x, y, margin as usize);
        }
        for [x, y] in own.map(place) {
            map.cells[y * size[0] + x] = State::Free;
        }
        map
    }

    /// Marks what is within [`SEEN_M`] of a cell.
    fn surround(&mut self, x: usize, y: usize, margin: usize) {
        // A distance that is a whole number of cells is not left to rounding.
        let most = SEEN_M / self.cell_m + 1e-6;
        for other_y in y - margin..=y + margin {
            for other_x in x - margin..=x + margin {
                let away = libm::hypot(other_x as f64 - x as f64, other_y as f64 - y as f64);
                if away <= most {
                    self.cells[other_y * self.size[0] + other_x] = State::Occupied;
                }
            }
        }
    }

    /// The state at a cell, counted from the origin.
    pub fn at(&self, [x, y]: [usize; 2]) -> State {
        self.cells[y * self.size[0] + x]
    }

    /// Number of cells in a state.
    pub fn count(&self, state: State) -> usize {
        self.cells.iter().filter(|own| **own == state).count()
    }
}

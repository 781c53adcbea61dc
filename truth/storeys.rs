//! What a robot reaches, in parts that can be drawn on a flat map.

use std::collections::VecDeque;

use rustc_hash::FxHashSet;

use super::floor::{Floor, NEIGHBORS, Robot};

/// The floor that a robot reaches from its starts, in storeys: no two cells of a storey are over each other, and each is
/// connected.
pub struct Storeys {
    /// The storey of each cell of the floor; `None` where the robot does not get.
    pub of: Vec<Option<u16>>,
    /// Number of cells of each storey.
    pub sizes: Vec<usize>,
}

impl Storeys {
    /// Grows a storey from the first start in all directions at once, and another one wherever it would cover itself; then from
    /// the next start that has not been reached.
    ///
    /// Starts are on the floor, in metres; those with no floor within a metre of them are left out, and so is what would be beyond
    /// 32,767 storeys.
    pub fn reached(floor: &Floor, robot: &Robot, starts_m: &[[f64; 3]]) -> Self {
        let mut storeys = Self { of: vec![None; floor.cells().len()], sizes: Vec::new() };
        let mut seeds: VecDeque<usize> = starts_m.iter().filter_map(|start| under(floor, robot, *start)).collect();
        while let Some(seed) = seeds.pop_front() {
            if storeys.of[seed].is_none() && storeys.sizes.len() < i16::MAX as usize {
                storeys.grow(floor, robot, seed, &mut seeds);
            }
        }
        storeys
    }

    /// Grows a storey from a cell. Where it would cover itself, it leaves a seed.
    fn grow(&mut self, floor: &Floor, robot: &Robot, seed: usize, seeds: &mut VecDeque<usize>) {
        let storey = self.sizes.len() as u16;
        let mut covered = FxHashSet::default();
        let mut front = VecDeque::from([seed]);
        covered.insert(floor.cells()[seed].cell);
        self.of[seed] = Some(storey);
        let mut size = 0;
        while let Some(from) = front.pop_front() {
            size += 1;
            for to in NEIGHBORS.iter().filter_map(|towards| floor.next(from, *towards, robot)) {
                if self.of[to].is_some() {
                    continue;
                }
                if covered.insert(floor.cells()[to].cell) {
                    self.of[to] = Some(storey);
                    front.push_back(to);
                } else {
                    seeds.push_back(to);
                }
            }
        }
        self.sizes.push(size);
    }
}

/// The floor at a start, if there is room for the robot.
fn under(floor: &Floor, robot: &Robot, [x, y, z]: [f64; 3]) -> Option<usize> {
    /// Furthest from the height of a start, in metres.
    const WITHIN_M: f32 = 1.0;
    let number = floor.nearest(floor.cell_at([x, y]), z as f32)?;
    let gap = &floor.cells()[number];
    let is_start = (gap.floor_m - z as f32).abs() < WITHIN_M && floor.carries(number, robot);
    is_start.then_some(number)
}

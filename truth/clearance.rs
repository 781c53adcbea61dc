//! How far it is from the floor to what a robot cannot drive onto.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::floor::{Floor, NEIGHBORS, Robot, beside};

/// The distance on the map from the centre of each cell to the nearest border of the floor on which a robot can be: wall, drop,
/// step, slope or low ceiling.
///
/// Grown from the borders, each cell with the nearest border cell of its neighbours; so it is too far by no more than a
/// fraction of a cell.
pub struct Clearance {
    /// In metres for each cell of the floor; 0 where the robot cannot be.
    pub of_m: Vec<f32>,
}

/// A cell on its way to be known: the square of its distance to a border in cells, its number, the place of the border.
type Candidate = Reverse<(i64, usize, [i32; 2])>;

impl Clearance {
    /// The clearance for this robot.
    pub fn new(floor: &Floor, robot: &Robot) -> Self {
        let mut of_m = vec![0.0; floor.cells().len()];
        let mut is_known = vec![false; of_m.len()];
        let mut front = borders(floor, robot);
        while let Some(Reverse((squared, number, border))) = front.pop() {
            if std::mem::replace(&mut is_known[number], true) {
                continue;
            }
            // The border is half a cell nearer than the centre of the cell beyond it.
            of_m[number] = (libm::sqrt(squared as f64) - 0.5).max(0.0) as f32 * floor.cell_m() as f32;
            for to in NEIGHBORS.iter().filter_map(|towards| floor.next(number, *towards, robot)) {
                if !is_known[to] {
                    front.push(candidate(floor, to, border));
                }
            }
        }
        Self { of_m }
    }
}

/// All cells beside a border.
fn borders(floor: &Floor, robot: &Robot) -> BinaryHeap<Candidate> {
    let mut found = BinaryHeap::new();
    for number in (0..floor.cells().len()).filter(|number| floor.carries(*number, robot)) {
        for towards in NEIGHBORS {
            if floor.next(number, towards, robot).is_none() {
                found.push(candidate(floor, number, beside(floor.cells()[number].cell, towards)));
            }
        }
    }
    found
}

fn candidate(floor: &Floor, number: usize, border: [i32; 2]) -> Candidate {
    let cell = floor.cells()[number].cell;
    let [x, y] = [0, 1].map(|axis| i64::from(cell[axis] - border[axis]));
    Reverse((x * x + y * y, number, border))
}

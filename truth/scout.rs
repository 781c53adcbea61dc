//! A robot in its terrain, and where it is when it is at a place.

use super::air::Air;
use super::floor::{Floor, beside};
use super::ground::Ground;
use super::search::{Pose, State, Terrain};
use super::vehicle::{Class, Profile};

/// Furthest from a place on the map at which a robot is still there, in metres.
pub const AT_PLACE_M: f64 = 1.0;
/// How much further from a place than the nearest others still are at it, in metres.
const AROUND_M: f64 = 0.15;
/// Furthest that the floor around a place is above or below that under it, in metres.
const SAME_FLOOR_M: f64 = 0.5;

/// A robot on a floor. It looks at a place once, however often it is asked.
pub struct Scout<'a> {
    /// The floor.
    pub(super) floor: &'a Floor,
    /// What it is for this robot.
    pub(super) terrain: Box<dyn Terrain + 'a>,
}

impl<'a> Scout<'a> {
    /// A robot on a floor.
    pub fn new(floor: &'a Floor, robot: &'a Profile) -> Self {
        let terrain: Box<dyn Terrain> = match robot {
            Profile::Vehicle(vehicle) => Box::new(Ground::new(floor, vehicle)),
            Profile::Drone(drone) => Box::new(Air::new(floor, drone)),
        };
        Self { floor, terrain }
    }
}

impl Scout<'_> {
    /// The states around the place nearest to a cell, up to a distance on the map, in which the robot can best be.
    pub(super) fn near(&mut self, cell: Option<usize>, most_m: f64) -> Vec<State> {
        let Some(centre) = cell.map(|cell| self.floor.cells()[cell]) else { return Vec::new() };
        let reach = (most_m / self.floor.cell_m()).floor() as i32;
        let mut found: Vec<(Class, f64, State)> = Vec::new();
        for offset in (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| [i, j])) {
            let away_m = libm::hypot(f64::from(offset[0]), f64::from(offset[1])) * self.floor.cell_m();
            let Some(cell) = self.floor.nearest(beside(centre.cell, offset), centre.floor_m) else { continue };
            let rise_m = f64::from((self.floor.cells()[cell].floor_m - centre.floor_m).abs());
            if away_m > most_m || rise_m > away_m.max(SAME_FLOOR_M) {
                continue;
            }
            for direction in 0..self.terrain.directions(cell) {
                let state = State { cell: cell as u32, direction };
                found.push((self.terrain.class(state), away_m, state));
            }
        }
        let order = |a: &&(Class, f64, State), b: &&(Class, f64, State)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        let Some((best, nearest_m, _)) = found.iter().min_by(order).copied() else { return Vec::new() };
        let is_among = |(class, away_m, _): &(Class, f64, State)| *class == best && *away_m <= nearest_m + AROUND_M;
        found.into_iter().filter(is_among).map(|(.., state)| state).collect()
    }

    /// The states around a start pose in metres, which is on the floor.
    pub(super) fn at_start(&mut self, [x, y, z]: [f64; 3]) -> Vec<State> {
        self.near(self.floor.nearest(self.floor.cell_at([x, y]), z as f32), AT_PLACE_M)
    }

    /// The states around a place in the air in metres.
    pub(super) fn at_place(&mut self, place_m: [f64; 3]) -> Vec<State> {
        self.near(self.floor.under(place_m), AT_PLACE_M)
    }

    /// The poses of a way.
    pub(super) fn poses(&self, way: &[State]) -> Vec<Pose> {
        way.iter().map(|state| self.terrain.pose(*state)).collect()
    }
}

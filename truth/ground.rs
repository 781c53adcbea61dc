//! The ground as a vehicle sees it: where it can stand, which way it can face there, and where it gets from there.

use std::f64::consts::FRAC_PI_8;

use super::clearance::Clearance;
use super::floor::{Floor, NEIGHBORS, Robot};
use super::lattice::Lattice;
use super::search::{Move, Pose, Rest, Sense, State, Terrain};
use super::stance::{Footprint, Stance};
use super::vehicle::{Cause, Class, Fault, Vehicle};
use super::window::Window;

/// Directions in which it moves; and as many between them, through which it turns.
const DIRECTIONS: usize = 8;
const TURNS: usize = 2 * DIRECTIONS;
/// What a turn on the spot by an eighth costs, in tenths of a millimetre: tuned so that it does not wiggle.
const TURN_COST: u64 = 1_500;
/// How much further from the wall than it needs a vehicle would like to be, in metres.
const COMFORT_M: f64 = 0.5;
/// How much dearer a way along the wall is.
const DISCOMFORT: f64 = 1.5;
/// Highest step over which a way that is no way is followed, in metres.
const HOPELESS_STEP_M: f32 = 1.0;

/// The order of [`NEIGHBORS`] in which each is an eighth of a turn to the left of the last.
const AROUND: [usize; DIRECTIONS] = [0, 4, 1, 5, 2, 6, 3, 7];

/// The ground for a vehicle, which drives forwards and turns on the spot.
pub struct Ground<'a> {
    floor: &'a Floor,
    vehicle: &'a Vehicle,
    /// The vehicle as a point.
    point: Robot,
    clearance: Clearance,
    /// For each sixteenth of a turn.
    footprints: Vec<Footprint<'a>>,
    lattice: Lattice,
    /// For each cell, once it is known.
    known: Vec<Option<Classes>>,
    /// The floor around the cell that was looked at last.
    window: Window<'a>,
}

impl<'a> Ground<'a> {
    /// The ground of a floor.
    pub fn new(floor: &'a Floor, vehicle: &'a Vehicle) -> Self {
        let point = robot(vehicle);
        let footprint = |turn: usize| Footprint::new(vehicle, turn as f64 * FRAC_PI_8, floor);
        let footprints: Vec<Footprint> = (0..TURNS).map(footprint).collect();
        Self {
            floor,
            vehicle,
            point,
            clearance: Clearance::new(floor, &point),
            lattice: Lattice::new(floor),
            known: vec![None; floor.cells().len()],
            window: footprints[0].window(floor, [0; 2]),
            footprints,
        }
    }

    fn stance(&self, cell: usize, turn: usize) -> Option<Stance> {
        let (gap, footprint) = (&self.floor.cells()[cell], &self.footprints[turn]);
        footprint.stand(&footprint.window(self.floor, gap.cell), gap.floor_m.into())
    }

    fn class_of(&mut self, cell: usize, turn: usize) -> Class {
        let classes = self.known[cell].unwrap_or_else(|| self.classes_of(cell));
        self.known[cell].insert(classes).get(turn)
    }

    /// All at once, as most are asked for in the end.
    fn classes_of(&mut self, cell: usize) -> Classes {
        let gap = &self.floor.cells()[cell];
        self.window.move_to(gap.cell);
        let class = |footprint: &Footprint| {
            footprint.stand(&self.window, gap.floor_m.into()).map_or(Class::NoGo, |stance| stance.class)
        };
        Classes::of(self.footprints.iter().map(class))
    }

    fn is_too_steep_to_turn(&self, cell: usize) -> bool {
        self.slope_rad(cell) > self.vehicle.turn_rad
    }

    fn slope_rad(&self, cell: usize) -> f64 {
        self.floor.reliefs()[cell].slope_rad.into()
    }

    /// The place next to a cell.
    fn next(&self, from: usize, towards: [i32; 2]) -> Option<usize> {
        let here = &self.floor.cells()[from];
        let to = self.floor.nearest(self.lattice.beside(here.cell, towards), here.floor_m)?;
        let there = &self.floor.cells()[to];
        let is_connected = there.floor_m < here.ceiling_m && here.floor_m < there.ceiling_m;
        // The way back is the same.
        let is_mutual = self.floor.nearest(here.cell, there.floor_m) == Some(from);
        let is_near = (there.floor_m - here.floor_m).abs() <= HOPELESS_STEP_M;
        (is_connected && is_mutual && is_near).then_some(to)
    }

    fn cost(&self, to: usize, towards: [i32; 2]) -> u64 {
        let spare_m = f64::from(self.clearance.of_m[to]) - self.vehicle.width_m / 2.0 - self.vehicle.margin_m;
        let dearer = 1.0 + DISCOMFORT * (1.0 - spare_m / COMFORT_M).clamp(0.0, 1.0);
        (self.lattice.stride_m(towards) * dearer * 1e4).round() as u64
    }
}

/// How well a vehicle stands in each sixteenth of a turn, in two bits each.
#[derive(Clone, Copy)]
struct Classes(u32);

impl Classes {
    fn of(classes: impl Iterator<Item = Class>) -> Self {
        Self(classes.zip(0..).fold(0, |all, (class, turn)| all | (class as u32) << (2 * turn)))
    }

    fn get(self, turn: usize) -> Class {
        [Class::Go, Class::Marginal, Class::NoGo][(self.0 >> (2 * turn) & 3) as usize]
    }
}

impl Terrain for Ground<'_> {
    fn moves(&mut self, state: State, sense: Sense, found: &mut Vec<Move>) {
        let (cell, direction) = parts(state);
        let here = self.class_of(cell, 2 * direction);
        let turning = if self.is_too_steep_to_turn(cell) { Class::Marginal } else { Class::Go };
        for other in [(direction + 1) % DIRECTIONS, (direction + DIRECTIONS - 1) % DIRECTIONS] {
            let class = turning
                .max(here)
                .max(self.class_of(cell, between(direction, other)))
                .max(self.class_of(cell, 2 * other));
            found.push(Move { to: state_of(cell, other), cost: TURN_COST, class });
        }
        let ahead = NEIGHBORS[AROUND[direction]];
        let towards = if sense == Sense::Ahead { ahead } else { ahead.map(|n| -n) };
        let Some(next) = self.next(cell, towards) else { return };
        let class = here.max(self.class_of(next, 2 * direction));
        found.push(Move { to: state_of(next, direction), cost: self.cost(next, towards), class });
    }

    fn why(&self, from: State, to: State) -> Option<Fault> {
        let [one, other] = [from, to].map(parts);
        let turns = if one.0 == other.0 { vec![between(one.1, other.1), 2 * other.1] } else { vec![2 * other.1] };
        for turn in turns {
            let Some(stance) = self.stance(other.0, turn) else {
                let limit = self.vehicle.width_m + 2.0 * self.vehicle.margin_m;
                let value = 2.0 * f64::from(self.clearance.of_m[other.0]);
                return Some(Fault { cause: Cause::Width, value, limit });
            };
            if stance.fault.is_some() {
                return stance.fault;
            }
        }
        let is_steep_turn = one.0 == other.0 && self.is_too_steep_to_turn(other.0);
        let value = self.slope_rad(other.0);
        is_steep_turn.then_some(Fault { cause: Cause::Slope, value, limit: self.vehicle.turn_rad })
    }

    fn why_no_stop(&self, cell: usize) -> Option<Fault> {
        let (value, limit) = (self.slope_rad(cell), self.vehicle.stop_rad);
        (value > limit).then_some(Fault { cause: Cause::Slope, value, limit })
    }

    fn class(&mut self, state: State) -> Class {
        let (cell, direction) = parts(state);
        self.class_of(cell, 2 * direction)
    }

    fn directions(&self, cell: usize) -> u8 {
        if self.lattice.holds(self.floor.cells()[cell].cell) { DIRECTIONS as u8 } else { 0 }
    }

    fn pose(&self, state: State) -> Pose {
        let (cell, direction) = parts(state);
        let [x, y, near_m] = self.place_m(cell);
        let z = self.stance(cell, 2 * direction).map_or(near_m, |stance| stance.ground_m);
        Pose { position_m: [x, y, z], heading_rad: (2 * direction) as f64 * FRAC_PI_8 }
    }

    fn rest(&self, pose: &Pose) -> Option<Rest> {
        let [x, y, near_m] = pose.position_m;
        let stance = Footprint::stand_at(self.vehicle, pose.heading_rad, self.floor, [x, y], near_m)?;
        let Stance { class, ground_m, climb_rad, lean_rad, .. } = stance;
        Some(Rest { class, height_m: ground_m, climb_rad, lean_rad })
    }

    fn place_m(&self, cell: usize) -> [f64; 3] {
        let gap = &self.floor.cells()[cell];
        let [x, y] = self.floor.centre_m(gap.cell);
        [x, y, f64::from(gap.floor_m)]
    }

    fn room_m(&mut self, cell: usize) -> f32 {
        self.clearance.of_m[cell]
    }

    fn beside(&self, cell: usize, found: &mut Vec<usize>) {
        found.extend(NEIGHBORS.iter().filter_map(|towards| self.floor.next(cell, *towards, &self.point)));
    }
}

fn state_of(cell: usize, direction: usize) -> State {
    State { cell: cell as u32, direction: direction as u8 }
}

fn parts(state: State) -> (usize, usize) {
    (state.cell as usize, usize::from(state.direction))
}

/// The sixteenth of a turn between two directions that are next to each other.
fn between(one: usize, other: usize) -> usize {
    let is_left = other == (one + 1) % DIRECTIONS;
    (2 * one + if is_left { 1 } else { TURNS - 1 }) % TURNS
}

/// What this vehicle gets over at a point.
fn robot(vehicle: &Vehicle) -> Robot {
    let slope_rad = vehicle.climb_rad.max(vehicle.side_slope_rad);
    Robot { height_m: vehicle.height_m as f32, step_m: vehicle.step_m as f32, slope_rad: slope_rad as f32 }
}

//! Shortest ways over any terrain, by the algorithm of Dijkstra (1959).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashSet;

use super::by_state::ByState;
use super::vehicle::{Class, Fault};

/// Where a robot can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct State {
    /// Number of the cell of the floor.
    pub cell: u32,
    /// Which way it faces, in parts of a turn.
    pub direction: u8,
}

/// In which sense moves are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// From where a robot is to where it gets.
    Ahead,
    /// From where it gets to where it may come from.
    Back,
}

/// A move between two states.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// The state at its other end.
    pub to: State,
    /// What it costs: about its length in tenths of a millimetre.
    pub cost: u64,
    /// Whether the robot can make it.
    pub class: Class,
}

/// Where a robot can be on a floor, and how it moves there.
pub trait Terrain {
    /// The moves from or to a state, in a fixed order.
    fn moves(&mut self, state: State, sense: Sense, found: &mut Vec<Move>);

    /// Why a move along a way is not [`Class::Go`], or its first state.
    fn why(&self, from: State, to: State) -> Option<Fault>;

    /// Why a robot does not surely turn by about a right angle or more at a cell.
    fn why_no_stop(&self, cell: usize) -> Option<Fault>;

    /// Whether a robot gets through a state.
    fn class(&mut self, state: State) -> Class;

    /// In how many directions a robot can face at a cell of the floor; 0 if the cell is not one of the places.
    fn directions(&self, cell: usize) -> u8;

    /// Where the robot is, and which way it faces.
    fn pose(&self, state: State) -> Pose;

    /// How the robot would be at a place in metres that is not one of the states; `None` if it cannot be there.
    fn rest(&self, pose: &Pose) -> Option<Rest>;

    /// Where something small is at a cell, in metres: on the floor, or in the air for a drone.
    fn place_m(&self, cell: usize) -> [f64; 3];

    /// Radius in metres of what there is room for at a cell.
    fn room_m(&mut self, cell: usize) -> f32;

    /// The cells beside one onto which something gets that is small enough, in a fixed order.
    fn beside(&self, cell: usize, found: &mut Vec<usize>);
}

/// How a robot is at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rest {
    /// Whether it gets through.
    pub class: Class,
    /// Its height in metres.
    pub height_m: f64,
    /// How it is pitched up, in radians.
    pub climb_rad: f64,
    /// How much higher its left is, in radians.
    pub lean_rad: f64,
}

/// Where a robot is, and which way it faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Its place in metres: on the floor, or in the air for a drone.
    pub position_m: [f64; 3],
    /// From +x towards +y, in radians.
    pub heading_rad: f64,
}

/// How much dearer a move is that may fail; so the best way has as few of the worst moves as possible, and is short only then.
fn weight(class: Class) -> u64 {
    match class {
        Class::Go => 1,
        Class::Marginal => 1_000,
        Class::NoGo => 1_000_000,
    }
}

/// The states that were reached, each by its best way.
#[derive(Default)]
pub struct Routes {
    arrivals: ByState<Arrival>,
    /// The goal, if it was reached.
    pub goal: Option<State>,
}

/// How a state was reached. The state that it was reached from is not a [`State`]: next to it, the class would take more room.
#[derive(Clone, Copy)]
struct Arrival {
    /// [`u64::MAX`] if the state was not reached.
    cost: u64,
    from_cell: u32,
    from_direction: u8,
    class: Class,
}

impl Arrival {
    const NONE: Self = Self { cost: u64::MAX, from_cell: 0, from_direction: 0, class: Class::NoGo };

    fn new(cost: u64, from: State, class: Class) -> Self {
        Self { cost, from_cell: from.cell, from_direction: from.direction, class }
    }

    fn from(&self) -> State {
        State { cell: self.from_cell, direction: self.from_direction }
    }
}

impl Routes {
    /// Searches from all starts at once until it comes to a goal; without goals, everywhere. Moves worse than `worst` are left out, and so are states that
    /// are not `within` bounds.
    pub fn search(
        terrain: &mut dyn Terrain,
        starts: &[State],
        goals: &[State],
        sense: Sense,
        worst: Class,
        within: &dyn Fn(State) -> bool,
    ) -> Self {
        let goals: FxHashSet<State> = goals.iter().copied().collect();
        let mut routes = Self::default();
        let mut front = BinaryHeap::new();
        for start in starts {
            let class = terrain.class(*start);
            if class <= worst {
                *routes.arrivals.entry(*start, terrain, Arrival::NONE) = Arrival::new(0, *start, class);
                front.push(Reverse((0, *start)));
            }
        }
        let mut moves = Vec::new();
        while let Some(Reverse((cost, state))) = front.pop() {
            let Some(here) = routes.arrival(state).copied().filter(|here| cost <= here.cost) else { continue };
            if goals.contains(&state) {
                routes.goal = Some(state);
                return routes;
            }
            moves.clear();
            terrain.moves(state, sense, &mut moves);
            for Move { to, cost: more, class } in
                moves.iter().copied().filter(|one| one.class <= worst && within(one.to))
            {
                let arrival = Arrival::new(here.cost + more * weight(class), state, class.max(here.class));
                let known = routes.arrivals.entry(to, terrain, Arrival::NONE);
                if arrival.cost < known.cost {
                    *known = arrival;
                    front.push(Reverse((arrival.cost, to)));
                }
            }
        }
        routes
    }

    fn arrival(&self, state: State) -> Option<&Arrival> {
        self.arrivals.get(state).filter(|arrival| arrival.cost < u64::MAX)
    }

    /// The worst class on the way to a state; `None` if it was not reached.
    pub fn class(&self, state: State) -> Option<Class> {
        self.arrival(state).map(|arrival| arrival.class)
    }

    /// The cheapest to reach of some states.
    pub fn cheapest(&self, states: &[State]) -> Option<State> {
        let cost = |state: &State| Some((self.arrival(*state)?.cost, *state));
        Some(states.iter().filter_map(cost).min()?.1)
    }

    /// The states on the way to one that was reached, from its start.
    pub fn way(&self, goal: State) -> Vec<State> {
        let from = |state: &State| self.arrival(*state).map(Arrival::from).filter(|from| from != state);
        let mut way: Vec<State> = std::iter::successors(Some(goal), from).collect();
        way.reverse();
        way
    }
}

/// The widest way from any of some cells to a goal: the room in metres at its narrowest place, 0 if there is none.
pub fn widest_m(
    terrain: &mut dyn Terrain,
    starts: &[usize],
    within: &dyn Fn(usize) -> bool,
    is_goal: &dyn Fn(usize) -> bool,
) -> f32 {
    // Room is never negative, so its bits are in its order.
    let room = |terrain: &mut dyn Terrain, cell: usize| terrain.room_m(cell).to_bits();
    let mut front: BinaryHeap<(u32, Reverse<usize>)> =
        starts.iter().map(|start| (room(terrain, *start), Reverse(*start))).collect();
    let mut is_known = FxHashSet::default();
    let mut found = Vec::new();
    while let Some((narrowest, Reverse(cell))) = front.pop() {
        if !is_known.insert(cell) {
            continue;
        }
        if is_goal(cell) {
            return f32::from_bits(narrowest);
        }
        found.clear();
        terrain.beside(cell, &mut found);
        for to in found.iter().copied().filter(|to| within(*to)) {
            front.push((room(terrain, to).min(narrowest), Reverse(to)));
        }
    }
    0.0
}

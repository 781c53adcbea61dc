//! Where a robot surely gets from its start and comes back from, and how far it is there.
//!
//! Places are those of the certificate: every tenth of a metre of the floor. They are joined by its moves, as far as all of them
//! are [`Class::Go`], and lengths are those of lines from place to place: at a drone's height, or else along the floor. Shortest
//! ways are found by the algorithm of Dijkstra (1959). Moves go in eight directions, so in the open a way is up to 8 % longer
//! than the straight line.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::by_state::ByState;
use super::scout::Scout;
use super::search::{Move, Pose, Sense, State};
use super::vector::away;
use super::vehicle::Class;

/// Lengths are counted in hundredths of a millimetre.
const PER_M: f64 = 1e5;
/// What a turn by an eighth counts, so that of ways of the same length that with the fewest turns is taken.
const TURN: u32 = 1;

/// The number of no state.
const NONE: u32 = u32::MAX;

/// The places that a robot surely reaches and leaves again. From any of them it gets to any other.
pub struct Territory {
    /// The cells of the places, ascending.
    cells: Vec<u32>,
    /// Where places are, in metres.
    at_m: Vec<[f64; 3]>,
    /// All states, by place and direction.
    states: Vec<State>,
    /// The place of each state.
    place_of: Vec<u32>,
    ahead: Links,
    back: Links,
    /// The states of the start.
    starts: Vec<u32>,
}

/// How far it is from the start to everywhere, or from everywhere to a goal.
pub struct Geodesic {
    /// For each place, in hundredths of a millimetre.
    lengths: Vec<u32>,
    /// For each state the next one towards the start or the goal, which is its own.
    next: Vec<u32>,
    /// For each place, the state from which it is nearest.
    nearest: Vec<u32>,
}

/// Where moves from each state lead.
struct Links {
    first: Vec<u32>,
    moves: Vec<u32>,
}

impl Territory {
    /// What a robot reaches that starts at a place in metres, which is within a metre of its floor. Empty if it is not sure to
    /// stand there.
    pub fn of(scout: &mut Scout, start_m: [f64; 3]) -> Self {
        let explored = Explored::from(scout, start_m);
        let (is_own, starts) = explored.core();
        let mut own: Vec<u32> = (0..explored.states.len() as u32).filter(|state| is_own[*state as usize]).collect();
        own.sort_unstable_by_key(|state| explored.states[*state as usize]);
        let mut number = vec![NONE; explored.states.len()];
        own.iter().zip(0..).for_each(|(old, new)| number[*old as usize] = new);
        let states: Vec<State> = own.iter().map(|state| explored.states[*state as usize]).collect();
        let mut cells: Vec<u32> = states.iter().map(|state| state.cell).collect();
        cells.dedup();
        let mut place_of = Vec::with_capacity(states.len());
        states
            .chunk_by(|a, b| a.cell == b.cell)
            .zip(0..)
            .for_each(|(of, place)| place_of.extend(of.iter().map(|_| place)));
        let moves = own.iter().map(|from| {
            explored.ahead.of(*from).iter().filter(|to| is_own[**to as usize]).map(|to| number[*to as usize])
        });
        let ahead = Links::new(moves);
        let starts = starts.into_iter().map(|state| number[state as usize]).collect();
        // Each is as large as all that stays.
        drop((explored, number, is_own, own));
        let back = ahead.reversed();
        let at_m = cells.iter().map(|cell| scout.terrain.place_m(*cell as usize)).collect();
        Self { cells, at_m, states, place_of, ahead, back, starts }
    }

    /// The numbers of the cells of the floor on which its places are, ascending.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// Where its places are, in metres: on the floor, or in the air for a drone.
    pub fn at_m(&self) -> &[[f64; 3]] {
        &self.at_m
    }

    /// The place that is nearest to a point in metres, in a straight line.
    pub fn nearest(&self, point_m: [f64; 3]) -> Option<usize> {
        let away_m = |place: &usize| away(self.at_m[*place], point_m);
        (0..self.cells.len()).min_by(|a, b| away_m(a).total_cmp(&away_m(b)))
    }

    /// How far it is from the start to everywhere.
    pub fn from_start(&self) -> Geodesic {
        self.search(Sense::Ahead, &self.starts)
    }

    /// How far it is from everywhere to a place.
    pub fn to(&self, place: usize) -> Geodesic {
        self.search(Sense::Back, &self.states_at(place).collect::<Vec<u32>>())
    }

    /// As many goals as that, far from the start and from each other: each is where the way from the start or to the nearest of the
    /// others is longest. Fewer if there are not as many places.
    pub fn goals(&self, from_start: &Geodesic, count: usize) -> Vec<(usize, Geodesic)> {
        let mut left_m: Vec<f64> = (0..self.cells.len()).map(|place| from_start.length_m(place)).collect();
        let mut goals = Vec::new();
        while goals.len() < count.min(self.cells.len()) {
            let furthest = (0..left_m.len()).max_by(|a, b| left_m[*a].total_cmp(&left_m[*b]).then(b.cmp(a)));
            let Some(place) = furthest.filter(|place| left_m[*place] > 0.0) else { break };
            let to_goal = self.to(place);
            left_m.iter_mut().enumerate().for_each(|(other, left_m)| *left_m = left_m.min(to_goal.length_m(other)));
            goals.push((place, to_goal));
        }
        goals
    }

    /// The states at a place.
    pub(super) fn states_at(&self, place: usize) -> std::ops::Range<u32> {
        let [first, end] = [place, place + 1].map(|place| self.place_of.partition_point(|of| (*of as usize) < place));
        first as u32..end as u32
    }

    /// Where a robot is in a state, and which way it faces.
    pub(super) fn pose(&self, scout: &Scout, state: u32) -> Pose {
        scout.terrain.pose(self.states[state as usize])
    }

    /// The states on the way from one to the goal.
    pub(super) fn way(&self, to_goal: &Geodesic, state: u32) -> Vec<State> {
        to_goal.chain(state).map(|state| self.states[state as usize]).collect()
    }

    /// How long a move between two states is.
    fn length(&self, one: u32, other: u32) -> u32 {
        let [one, other] = [one, other].map(|state| self.place_of[state as usize] as usize);
        if one == other { TURN } else { (away(self.at_m[one], self.at_m[other]) * PER_M).round() as u32 }
    }

    fn search(&self, sense: Sense, from: &[u32]) -> Geodesic {
        let links = if sense == Sense::Ahead { &self.ahead } else { &self.back };
        let mut lengths = vec![u32::MAX; self.states.len()];
        let mut next: Vec<u32> = (0..self.states.len() as u32).collect();
        let mut front = BinaryHeap::new();
        for state in from {
            lengths[*state as usize] = 0;
            front.push(Reverse((0, *state)));
        }
        while let Some(Reverse((length, state))) = front.pop() {
            if length > lengths[state as usize] {
                continue;
            }
            for to in links.of(state) {
                let length = length.saturating_add(self.length(state, *to));
                if length < lengths[*to as usize] {
                    (lengths[*to as usize], next[*to as usize]) = (length, state);
                    front.push(Reverse((length, *to)));
                }
            }
        }
        let by_length = |a: &u32, b: &u32| lengths[*a as usize].cmp(&lengths[*b as usize]);
        let nearest: Vec<u32> =
            (0..self.cells.len()).filter_map(|place| self.states_at(place).min_by(by_length)).collect();
        let lengths = nearest.iter().map(|state| lengths[*state as usize]).collect();
        Geodesic { lengths, next, nearest }
    }
}

impl Geodesic {
    /// Length in metres from the start to a place, or from there to the goal, whichever way the robot faces.
    pub fn length_m(&self, place: usize) -> f64 {
        f64::from(self.lengths[place]) / PER_M
    }

    /// A state and those after it, to the start or the goal.
    pub(super) fn chain(&self, state: u32) -> impl Iterator<Item = u32> + '_ {
        let after = |state: &u32| Some(self.next[*state as usize]).filter(|next| next != state);
        std::iter::successors(Some(state), after)
    }

    /// The state of a place that is nearest to the start or the goal.
    pub(super) fn nearest(&self, place: usize) -> u32 {
        self.nearest[place]
    }
}

impl Links {
    fn new(moves: impl Iterator<Item = impl Iterator<Item = u32>>) -> Self {
        let mut links = Self { first: vec![0], moves: Vec::new() };
        for of in moves {
            links.moves.extend(of);
            links.first.push(links.moves.len() as u32);
        }
        links
    }

    fn of(&self, state: u32) -> &[u32] {
        &self.moves[self.first[state as usize] as usize..self.first[state as usize + 1] as usize]
    }

    fn reversed(&self) -> Self {
        let mut first = vec![0_u32; self.first.len()];
        self.moves.iter().for_each(|to| first[*to as usize + 1] += 1);
        (1..first.len()).for_each(|state| first[state] += first[state - 1]);
        let mut place = first.clone();
        let mut moves = vec![0; self.moves.len()];
        for from in 0..self.first.len() as u32 - 1 {
            for to in self.of(from) {
                moves[place[*to as usize] as usize] = from;
                place[*to as usize] += 1;
            }
        }
        Self { first, moves }
    }

    /// The states that are reached from one.
    fn reach(&self, from: u32) -> Vec<bool> {
        let mut is_reached = vec![false; self.first.len() - 1];
        let mut left = vec![from];
        is_reached[from as usize] = true;
        while let Some(state) = left.pop() {
            for to in self.of(state) {
                if !std::mem::replace(&mut is_reached[*to as usize], true) {
                    left.push(*to);
                }
            }
        }
        is_reached
    }
}

/// All states that are surely reached from those at a start.
struct Explored {
    /// The first of them are those at the start.
    states: Vec<State>,
    starts: u32,
    ahead: Links,
}

impl Explored {
    fn from(scout: &mut Scout, start_m: [f64; 3]) -> Self {
        let mut states: Vec<State> = scout.at_start(start_m);
        states.retain(|state| scout.terrain.class(*state) == Class::Go);
        let starts = states.len() as u32;
        let mut numbers = ByState::default();
        states.iter().zip(0..).for_each(|(state, number)| *numbers.entry(*state, &*scout.terrain, NONE) = number);
        let (mut ahead, mut found) = (Links { first: vec![0], moves: Vec::new() }, Vec::new());
        let mut next = 0;
        while let Some(state) = states.get(next).copied() {
            found.clear();
            scout.terrain.moves(state, Sense::Ahead, &mut found);
            for Move { to, .. } in found.iter().filter(|one| one.class == Class::Go) {
                let number = numbers.entry(*to, &*scout.terrain, NONE);
                if *number == NONE {
                    *number = states.len() as u32;
                    states.push(*to);
                }
                ahead.moves.push(*number);
            }
            ahead.first.push(ahead.moves.len() as u32);
            next += 1;
        }
        Self { states, starts, ahead }
    }

    /// Of the states among which there is a way from any to any other, the most that hold some of the start, and these.
    fn core(&self) -> (Vec<bool>, Vec<u32>) {
        let back = self.ahead.reversed();
        let (mut best, mut most) = ((vec![false; self.states.len()], Vec::new()), 0);
        let mut is_known = vec![false; self.starts as usize];
        for start in 0..self.starts {
            if is_known[start as usize] {
                continue;
            }
            let (there, home) = (self.ahead.reach(start), back.reach(start));
            let is_own: Vec<bool> = there.into_iter().zip(home).map(|(there, home)| there && home).collect();
            let starts: Vec<u32> = (0..self.starts).filter(|state| is_own[*state as usize]).collect();
            starts.iter().for_each(|state| is_known[*state as usize] = true);
            let size = is_own.iter().filter(|is_own| **is_own).count();
            if size > most {
                (best, most) = ((is_own, starts), size);
            }
        }
        best
    }
}

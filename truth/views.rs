//! From where a robot sees all places that it reaches.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::{FxHashMap, FxHashSet};

use super::floor::{Floor, Lookup};
use super::territory::{Geodesic, Territory};
use super::vector::away;

/// Side of the cubes of which each gets one candidate for a view, in metres: tuned.
const APART_M: f64 = 1.0;

/// What sees, and what it has to see.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    /// Its height over the floor in metres; where that is more than half the headroom, it is there.
    pub height_m: f64,
    /// How far it sees, in metres.
    pub range_m: f64,
    /// Height over the floor of what it has to see of a place, in metres, or half the headroom there.
    pub sight_m: f64,
}

/// A place to look around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The place.
    pub place: usize,
    /// Number of places that are seen from there.
    pub sees: usize,
}

/// Views that together see every place of a territory: in range, and in a straight line through the air, which is known at the centres
/// of cells.
///
/// Greedy: each is the candidate that sees most of what no other one does. Candidates are a metre apart; what none of them sees gets
/// some of its own. So there are no more than about ln n times as many views as are needed of these candidates, if a view sees n
/// places (Chvátal 1979). They come in the order in which one meets them who walks the tree of shortest ways from the start, along no
/// part of it more than twice, and comes to the longest branch of each fork last.
pub fn views(floor: &Floor, territory: &Territory, from_start: &Geodesic, eye: Eye) -> Vec<View> {
    let sights = Sights::new(floor, territory, eye);
    let found = chosen(&sights.candidates(from_start), territory.cells().len());
    let places: Vec<usize> = found.iter().map(|view| view.place).collect();
    walked(from_start, &places).into_iter().map(|number| found[number]).collect()
}

/// A place, and the places that are seen from there.
type Candidate = (usize, Vec<u32>);

/// Who sees whom.
struct Sights<'a> {
    floor: &'a Floor,
    eye: Eye,
    /// Of each place: where it is looked from and at, in metres.
    eyes_m: Vec<[f64; 3]>,
    sights_m: Vec<[f64; 3]>,
    /// Places by cubes of the range.
    near: FxHashMap<[i32; 3], Vec<u32>>,
}

impl<'a> Sights<'a> {
    fn new(floor: &'a Floor, territory: &Territory, eye: Eye) -> Self {
        let over = |height_m: f64| {
            let at = |cell: &u32| {
                let gap = &floor.cells()[*cell as usize];
                let [x, y] = floor.centre_m(gap.cell);
                [x, y, f64::from(gap.floor_m) + height_m.min(f64::from(gap.height_m()) / 2.0)]
            };
            territory.cells().iter().map(at).collect::<Vec<[f64; 3]>>()
        };
        let (eyes_m, sights_m) = (over(eye.height_m), over(eye.sight_m));
        let mut near: FxHashMap<[i32; 3], Vec<u32>> = FxHashMap::default();
        for (place, at_m) in (0..).zip(&sights_m) {
            near.entry(cube(*at_m, eye.range_m)).or_default().push(place);
        }
        Self { floor, eye, eyes_m, sights_m, near }
    }

    /// Candidates that together see everything.
    fn candidates(&self, from_start: &Geodesic) -> Vec<Candidate> {
        let mut places: Vec<usize> = (0..self.eyes_m.len()).collect();
        places.sort_by(|a, b| from_start.length_m(*a).total_cmp(&from_start.length_m(*b)));
        let (mut cubes, mut is_seen) = (FxHashSet::default(), vec![false; places.len()]);
        let mut candidates = Vec::new();
        let mut add = |place: usize, is_seen: &mut Vec<bool>| {
            let seen = self.seen(place);
            seen.iter().for_each(|other| is_seen[*other as usize] = true);
            candidates.push((place, seen));
        };
        for place in &places {
            if cubes.insert(cube(self.eyes_m[*place], APART_M)) {
                add(*place, &mut is_seen);
            }
        }
        for place in places {
            if !is_seen[place] {
                add(place, &mut is_seen);
            }
        }
        candidates
    }

    /// The places that are seen from one, itself included, ascending.
    fn seen(&self, from: usize) -> Vec<u32> {
        let (eye_m, mut lookup) = (self.eyes_m[from], Lookup::new(self.floor));
        let own = cube(eye_m, self.eye.range_m);
        let beside = (0..27).map(|n| [own[0] + n / 9 - 1, own[1] + n / 3 % 3 - 1, own[2] + n % 3 - 1]);
        let near = beside.filter_map(|cube| self.near.get(&cube)).flatten();
        let mut is_seen = |place: &u32| {
            let sight_m = self.sights_m[*place as usize];
            *place as usize == from || away(eye_m, sight_m) <= self.eye.range_m && is_free(&mut lookup, eye_m, sight_m)
        };
        let mut seen: Vec<u32> = near.copied().filter(|place| is_seen(place)).collect();
        seen.sort_unstable();
        // There are many, which stay.
        seen.shrink_to_fit();
        seen
    }
}

/// The cube of this side that holds a point.
fn cube(at_m: [f64; 3], side_m: f64) -> [i32; 3] {
    at_m.map(|along_m| (along_m / side_m).floor() as i32)
}

/// Whether a straight line is in the air in each cell over which it passes, at points no further from each other than a cell.
fn is_free(lookup: &mut Lookup, from_m: [f64; 3], to_m: [f64; 3]) -> bool {
    let along_m = libm::hypot(to_m[0] - from_m[0], to_m[1] - from_m[1]);
    let steps = (along_m / lookup.cell_m()).ceil() as i32;
    (1..steps).all(|step| {
        let share = f64::from(step) / f64::from(steps);
        let [x, y, z] = [0, 1, 2].map(|axis| from_m[axis] + share * (to_m[axis] - from_m[axis]));
        lookup.holding([x, y], z as f32).is_some()
    })
}

/// The greedy choice of candidates until each of so many places is seen.
fn chosen(candidates: &[Candidate], places: usize) -> Vec<View> {
    let mut is_seen = vec![false; places];
    // What is new to a candidate only becomes less, so one that is still ahead of the next needs no other to be looked at.
    let mut front: BinaryHeap<(usize, Reverse<usize>)> =
        candidates.iter().enumerate().map(|(number, (_, seen))| (seen.len(), Reverse(number))).collect();
    let mut views = Vec::new();
    while let Some((gain, Reverse(number))) = front.pop() {
        let (place, seen) = &candidates[number];
        let new = seen.iter().filter(|other| !is_seen[**other as usize]).count();
        if new == 0 {
            continue;
        }
        if new < gain {
            front.push((new, Reverse(number)));
            continue;
        }
        seen.iter().for_each(|other| is_seen[*other as usize] = true);
        views.push(View { place: *place, sees: seen.len() });
    }
    views
}

/// The order in which places are met on a walk of the tree of shortest ways from the start.
fn walked(from_start: &Geodesic, places: &[usize]) -> Vec<usize> {
    let mut tree = Tree::default();
    for (number, place) in places.iter().enumerate() {
        tree.add(number, from_start.chain(from_start.nearest(*place)), from_start.length_m(*place));
    }
    tree.walk()
}

/// The ways to some places, without the rest of the tree.
#[derive(Default)]
struct Tree {
    /// By state.
    nodes: FxHashMap<u32, Node>,
    roots: Vec<u32>,
}

#[derive(Default)]
struct Node {
    number: Option<usize>,
    /// Length in metres from the start to the furthest place beyond.
    furthest_m: f64,
    children: Vec<u32>,
}

impl Tree {
    /// Adds a way from a place to the start.
    fn add(&mut self, number: usize, way: impl Iterator<Item = u32>, length_m: f64) {
        let mut child = None;
        for state in way {
            let is_new = !self.nodes.contains_key(&state);
            let node = self.nodes.entry(state).or_default();
            node.furthest_m = node.furthest_m.max(length_m);
            match child {
                None => node.number = Some(number),
                Some((child, true)) => node.children.push(child),
                Some((_, false)) => {}
            }
            child = Some((state, is_new));
        }
        if let Some((root, true)) = child {
            self.roots.push(root);
        }
    }

    /// The numbers of places, nearer branches first.
    fn walk(&self) -> Vec<usize> {
        let sorted = |states: &[u32]| {
            let mut states = states.to_vec();
            // The last is taken first.
            states.sort_by(|a, b| self.nodes[b].furthest_m.total_cmp(&self.nodes[a].furthest_m).then(b.cmp(a)));
            states
        };
        let (mut left, mut found) = (sorted(&self.roots), Vec::new());
        while let Some(state) = left.pop() {
            let node = &self.nodes[&state];
            found.extend(node.number);
            left.extend(sorted(&node.children));
        }
        found
    }
}

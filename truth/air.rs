//! The air as a drone sees it: how high it can fly over each place of the floor, and where it gets from there.

use super::floor::{Floor, NEIGHBORS, beside};
use super::lattice::Lattice;
use super::search::{Move, Pose, Rest, Sense, State, Terrain};
use super::vehicle::{Cause, Class, Drone, Fault};

/// How finely the room for other drones is measured, and up to which radius, in metres.
const ROOM_STEP_M: f64 = 0.05;
const MOST_ROOM_M: f64 = 1.0;

/// The air for a drone. Where it could fly at several heights over a place, it does so at that with the most room up and down.
pub struct Air<'a> {
    floor: &'a Floor,
    drone: &'a Drone,
    lattice: Lattice,
    /// The drone with its margin and without.
    spheres: [Sphere; 2],
    /// Drones of other sizes, the smallest first.
    others: Vec<Sphere>,
    /// For each cell, the heights in metres at which it surely can be and at which it just can be; `None` if not known yet.
    known: Vec<Option<[Heights; 2]>>,
    /// For each cell, the radius in metres of the largest drone; `None` if not known yet.
    rooms: Vec<Option<f32>>,
}

/// Lowest and highest; `None` if there is none.
type Heights = Option<[f32; 2]>;

impl<'a> Air<'a> {
    /// The air over a floor.
    pub fn new(floor: &'a Floor, drone: &'a Drone) -> Self {
        let Drone { radius_m, margin_m } = *drone;
        let sphere = |radius_m: f64| Sphere::new(radius_m, floor.cell_m());
        let sizes = (MOST_ROOM_M / ROOM_STEP_M) as usize;
        Self {
            floor,
            drone,
            lattice: Lattice::new(floor),
            spheres: [radius_m + margin_m, radius_m].map(sphere),
            others: (1..=sizes).map(|size| sphere(size as f64 * ROOM_STEP_M)).collect(),
            known: vec![None; floor.cells().len()],
            rooms: vec![None; floor.cells().len()],
        }
    }

    fn heights(&mut self, cell: usize) -> [Heights; 2] {
        let (floor, spheres) = (self.floor, &self.spheres);
        *self.known[cell].get_or_insert_with(|| spheres.each_ref().map(|sphere| sphere.heights(floor, cell)))
    }

    /// Radius in metres of the largest drone over the middle of a cell.
    fn widest_m(&self, cell: usize) -> f64 {
        let fitting = self.others.partition_point(|sphere| sphere.heights(self.floor, cell).is_some());
        fitting as f64 * ROOM_STEP_M
    }

    /// The best class in which it can move between two cells.
    fn class_between(&mut self, one: usize, other: usize) -> Class {
        let classes = self.heights(one).into_iter().zip(self.heights(other)).zip([Class::Go, Class::Marginal]);
        let meet = |one: Heights, other: Heights| one.zip(other).is_some_and(|(a, b)| a[0] <= b[1] && b[0] <= a[1]);
        classes.into_iter().find(|((one, other), _)| meet(*one, *other)).map_or(Class::NoGo, |(_, class)| class)
    }
}

impl Terrain for Air<'_> {
    fn moves(&mut self, state: State, _: Sense, found: &mut Vec<Move>) {
        let cell = state.cell as usize;
        let here = self.floor.cells()[cell].cell;
        let mut cells = Vec::new();
        self.beside(cell, &mut cells);
        for next in cells {
            let there = self.floor.cells()[next].cell;
            let length_m = libm::hypot((there[0] - here[0]).into(), (there[1] - here[1]).into()) * self.floor.cell_m();
            let to = State { cell: next as u32, direction: 0 };
            found.push(Move { to, cost: (length_m * 1e4).round() as u64, class: self.class_between(cell, next) });
        }
    }

    fn why_no_stop(&self, _: usize) -> Option<Fault> {
        None
    }

    fn why(&self, _: State, to: State) -> Option<Fault> {
        let gap = &self.floor.cells()[to.cell as usize];
        let limit = 2.0 * (self.drone.radius_m + self.drone.margin_m);
        let height_m = f64::from(gap.height_m());
        if height_m < limit {
            return Some(Fault { cause: Cause::Headroom, value: height_m, limit });
        }
        Some(Fault { cause: Cause::Width, value: 2.0 * self.widest_m(to.cell as usize), limit })
    }

    fn class(&mut self, state: State) -> Class {
        let [surely, just] = self.heights(state.cell as usize);
        match [surely, just] {
            [Some(_), _] => Class::Go,
            [None, Some(_)] => Class::Marginal,
            [None, None] => Class::NoGo,
        }
    }

    fn directions(&self, cell: usize) -> u8 {
        if self.lattice.holds(self.floor.cells()[cell].cell) { 1 } else { 0 }
    }

    fn pose(&self, state: State) -> Pose {
        Pose { position_m: self.place_m(state.cell as usize), heading_rad: 0.0 }
    }

    fn place_m(&self, cell: usize) -> [f64; 3] {
        let gap = &self.floor.cells()[cell];
        let [x, y] = self.floor.centre_m(gap.cell);
        let known = self.known[cell].unwrap_or_default();
        let [low, high] = known[0].or(known[1]).unwrap_or([gap.floor_m, gap.ceiling_m]);
        [x, y, f64::from(low + high) / 2.0]
    }

    fn rest(&self, pose: &Pose) -> Option<Rest> {
        let cell = self.floor.under(pose.position_m)?;
        let height_m = pose.position_m[2];
        let holds = |heights: Heights| heights.is_some_and(|[low, high]| (low..=high).contains(&(height_m as f32)));
        let class = match self.spheres.each_ref().map(|sphere| holds(sphere.heights(self.floor, cell))) {
            [true, _] => Class::Go,
            [_, true] => Class::Marginal,
            _ => Class::NoGo,
        };
        Some(Rest { class, height_m, ..Rest::default() })
    }

    fn beside(&self, cell: usize, found: &mut Vec<usize>) {
        let (cells, here) = (self.floor.cells(), &self.floor.cells()[cell]);
        let meets = |other: &usize| cells[*other].floor_m < here.ceiling_m && here.floor_m < cells[*other].ceiling_m;
        for towards in NEIGHBORS {
            let over = self.floor.over(self.lattice.beside(here.cell, towards));
            found.extend(over.filter(meets));
        }
    }

    fn room_m(&mut self, cell: usize) -> f32 {
        let room_m = self.rooms[cell].unwrap_or_else(|| self.widest_m(cell) as f32);
        *self.rooms[cell].insert(room_m)
    }
}

/// A sphere in columns.
struct Sphere {
    radius_m: f64,
    /// The columns that it fills and half its height there, from the outside: that is where rock is met first.
    columns: Vec<([i32; 2], f64)>,
}

impl Sphere {
    fn new(radius_m: f64, cell_m: f64) -> Self {
        let reach = (radius_m / cell_m).ceil() as i32;
        let column = |offset: [i32; 2]| {
            let squared_m2 = f64::from(offset[0] * offset[0] + offset[1] * offset[1]) * cell_m * cell_m;
            let half_m = libm::sqrt(radius_m * radius_m - squared_m2);
            (!half_m.is_nan()).then_some((offset, half_m))
        };
        let offsets = (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| [i, j]));
        let mut columns: Vec<([i32; 2], f64)> = offsets.filter_map(column).collect();
        columns.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        Self { radius_m, columns }
    }

    /// The heights in metres at which it is in the air over the middle of a cell; of several ranges the longest.
    fn heights(&self, floor: &Floor, cell: usize) -> Heights {
        let gap = &floor.cells()[cell];
        let own = [f64::from(gap.floor_m) + self.radius_m, f64::from(gap.ceiling_m) - self.radius_m];
        let mut free = Vec::from_iter((own[0] <= own[1]).then_some(own));
        let mut narrowed = Vec::new();
        for (offset, half_m) in &self.columns {
            let column = beside(gap.cell, *offset);
            narrowed.clear();
            for other in &floor.cells()[floor.over(column)] {
                let [low, high] = [f64::from(other.floor_m) + half_m, f64::from(other.ceiling_m) - half_m];
                let both = free.iter().map(|range: &[f64; 2]| [range[0].max(low), range[1].min(high)]);
                narrowed.extend(both.filter(|[low, high]| low <= high));
            }
            std::mem::swap(&mut free, &mut narrowed);
            for z in floor.thin().over(column).iter().copied().map(f64::from) {
                narrowed.clear();
                let around =
                    free.iter().flat_map(|[low, high]| [[*low, high.min(z - half_m)], [low.max(z + half_m), *high]]);
                narrowed.extend(around.filter(|[low, high]| low <= high));
                std::mem::swap(&mut free, &mut narrowed);
            }
            if free.is_empty() {
                return None;
            }
        }
        let length = |heights: &[f64; 2]| heights[1] - heights[0];
        let longest = free.into_iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
        Some(longest.map(|height| height as f32))
    }
}

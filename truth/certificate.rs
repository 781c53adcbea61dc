//! Where a robot gets in a network of passages, and what stops it.
//!
//! A way is searched along every passage in both directions, and from the start to every station, over poses in which the whole
//! footprint was compared with the floor, walls and ceiling. What is called [`Class::Go`] keeps the limits of the robot and its
//! margin in every pose of its way. Not promised: that no other way exists where this finds none, or dynamics.

use super::floor::{Floor, NEIGHBORS, beside};
use super::route::{Route, length_m};
use super::scout::{AT_PLACE_M, Scout};
use super::search::{self, Routes, Sense, State};
use super::vehicle::{Cause, Class, Fault, Profile};

/// Furthest from the end of a passage at which a way along it may begin, as a share of the passage: so every way has a length.
const AT_END_SHARE: f64 = 0.25;
/// How far beside the walls of a passage a way along it may go, in metres: passages are wider at junctions.
const BESIDE_M: f64 = 1.0;

/// Stations, and the passages between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Network {
    /// Places in the air of the passages, in metres.
    pub stations: Vec<[f64; 3]>,
    /// Pairs of different stations.
    pub passages: Vec<Passage>,
}

/// A passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Its stations.
    pub ends: [usize; 2],
    /// How far it may reach from the straight line between them on the map, in metres.
    pub reach_m: f64,
}

/// Where a robot gets.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Area of the floor in square metres.
    pub floor_m2: f64,
    /// Area of the floor that the middle of the robot reaches from the start and from which it comes back, in square metres.
    pub reached_m2: f64,
    /// For each station, how well the robot gets there.
    pub stations: Vec<Reach>,
    /// For each passage, whether it gets through.
    pub passages: Vec<Through>,
    /// The furthest station that it surely reaches, and the path there.
    pub furthest: Option<(usize, Route)>,
}

/// How well a robot gets to a station.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// From the start; `None` if not at all.
    pub there: Option<Class>,
    /// Back to the start; `None` if not at all.
    pub back: Option<Class>,
    /// Length of the way there in metres; 0 if there is none.
    pub length_m: f64,
}

impl Reach {
    /// Whether the robot surely gets there and back.
    pub fn is_sure(&self) -> bool {
        (self.there, self.back) == (Some(Class::Go), Some(Class::Go))
    }
}

/// How well a robot gets through a passage.
#[derive(Clone, Debug, PartialEq)]
pub struct Through {
    /// From its first station to its second.
    pub there: Verdict,
    /// From its second station to its first.
    pub back: Verdict,
    /// Width in metres of the widest robot with the same limits of step, slope and height that gets through.
    pub widest_m: f64,
}

/// Whether a robot gets through a passage in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Whether it does.
    pub class: Class,
    /// What is in its way, and where, in metres.
    pub fault: Option<(Fault, [f64; 3])>,
    /// Its path from near the first station to near the second; none if it does not get through.
    pub route: Route,
}

impl Certificate {
    /// Certifies a robot that starts at a place in metres, which is within a metre of its floor.
    pub fn of(floor: &Floor, robot: &Profile, network: &Network, start_m: [f64; 3]) -> Self {
        Scout::new(floor, robot).certify(network, start_m)
    }
}

impl Scout<'_> {
    /// Certifies the robot, which starts at a place in metres within a metre of its floor.
    pub fn certify(&mut self, network: &Network, start_m: [f64; 3]) -> Certificate {
        let starts = self.at_start(start_m);
        // One after the other, as each has every state of the floor.
        let out = self.everywhere(&starts, Sense::Ahead);
        let mut stations: Vec<Reach> = network.stations.iter().map(|station| self.there(*station, &out)).collect();
        let furthest = self.furthest(network, &stations, &out);
        let sure = self.sure(&out);
        drop(out);
        let home = self.everywhere(&starts, Sense::Back);
        for (reach, station) in stations.iter_mut().zip(&network.stations) {
            let state = home.cheapest(&self.at_place(*station));
            reach.back = state.and_then(|state| Some(self.class_with_stops(&home.way(state), home.class(state)?)));
        }
        let is_back = |state: &State| home.class(*state) == Some(Class::Go);
        let reached = sure.chunk_by(|a, b| a.cell == b.cell).filter(|states| states.iter().any(is_back)).count();
        drop(home);
        let places = (0..self.floor.cells().len()).filter(|cell| self.terrain.directions(*cell) > 0).count();
        let passages = network.passages.iter().map(|passage| self.through(network, passage)).collect();
        let cell_m2 = self.floor.cell_m() * self.floor.cell_m();
        let floor_m2 = self.floor.cells().len() as f64 * cell_m2;
        let reached_m2 = floor_m2 * reached as f64 / places.max(1) as f64;
        Certificate { floor_m2, reached_m2, stations, passages, furthest }
    }

    /// The ways between the start and everywhere.
    fn everywhere(&mut self, starts: &[State], sense: Sense) -> Routes {
        Routes::search(&mut *self.terrain, starts, &[], sense, Class::Marginal, &|_| true)
    }

    /// The states that are surely reached, by cell.
    fn sure(&self, routes: &Routes) -> Vec<State> {
        let of_cell = |cell: usize| {
            (0..self.terrain.directions(cell)).map(move |direction| State { cell: cell as u32, direction })
        };
        let all = (0..self.floor.cells().len()).flat_map(of_cell);
        all.filter(|state| routes.class(*state) == Some(Class::Go)).collect()
    }

    /// How well the robot gets to a station.
    fn there(&mut self, station_m: [f64; 3], out: &Routes) -> Reach {
        let there = out.cheapest(&self.at_place(station_m));
        let way = there.map(|goal| out.way(goal)).unwrap_or_default();
        let length_m = length_m(self.poses(&way).iter().map(|pose| pose.position_m));
        let class = there.and_then(|state| out.class(state)).map(|class| self.class_with_stops(&way, class));
        Reach { there: class, back: None, length_m }
    }

    fn furthest(&mut self, network: &Network, stations: &[Reach], out: &Routes) -> Option<(usize, Route)> {
        let is_sure = |number: &usize| stations[*number].there == Some(Class::Go);
        let by_length = |a: &usize, b: &usize| stations[*a].length_m.total_cmp(&stations[*b].length_m).then(b.cmp(a));
        let number = (0..stations.len()).filter(is_sure).max_by(by_length)?;
        let goal = out.cheapest(&self.at_place(network.stations[number]))?;
        Some((number, Route::along(self, &out.way(goal), Class::Go)))
    }

    /// How well the robot gets through a passage, either way.
    fn through(&mut self, network: &Network, passage: &Passage) -> Through {
        let ends = passage.ends.map(|end| network.stations[end]);
        let line = ends.map(|[x, y, _]| [x, y]);
        let at_m = AT_PLACE_M.min(AT_END_SHARE * libm::hypot(line[1][0] - line[0][0], line[1][1] - line[0][1]));
        let [one, other] = ends.map(|end| {
            let under = self.floor.under(end);
            let near = self.near(under, at_m);
            if near.is_empty() { self.at_place(end) } else { near }
        });
        let [low_m, high_m] = [ends[0][2].min(ends[1][2]), ends[0][2].max(ends[1][2])];
        let (floor, most_m) = (self.floor, passage.reach_m + BESIDE_M);
        let is_in_passage = |cell: usize| {
            let gap = &floor.cells()[cell];
            let is_level = f64::from(gap.floor_m) <= high_m + most_m && f64::from(gap.ceiling_m) >= low_m - most_m;
            is_level && from_line_m(floor.centre_m(gap.cell), line) <= most_m
        };
        let is_inside = |state: State| is_in_passage(state.cell as usize);
        let there = self.verdict(&one, &other, ends[0], &is_inside);
        let back = self.verdict(&other, &one, ends[1], &is_inside);
        let ends = ends.map(|end| self.around(end));
        let is_end = |cell: usize| ends[1].contains(&cell);
        let widest_m = 2.0 * search::widest_m(&mut *self.terrain, &ends[0], &is_in_passage, &is_end);
        Through { there, back, widest_m: widest_m.into() }
    }

    /// The cell of the floor under a place in metres, and those beside it.
    fn around(&self, place_m: [f64; 3]) -> Vec<usize> {
        let Some(under) = self.floor.under(place_m) else { return Vec::new() };
        let gap = &self.floor.cells()[under];
        let beside = NEIGHBORS.iter().filter_map(|towards| self.floor.nearest(beside(gap.cell, *towards), gap.floor_m));
        [under].into_iter().chain(beside).collect()
    }

    /// Whether the robot gets from one of some states to one of others.
    fn verdict(
        &mut self,
        starts: &[State],
        goals: &[State],
        from_m: [f64; 3],
        is_inside: &dyn Fn(State) -> bool,
    ) -> Verdict {
        let routes = Routes::search(&mut *self.terrain, starts, goals, Sense::Ahead, Class::NoGo, is_inside);
        let Some(goal) = routes.goal else {
            let fault = Fault { cause: Cause::NoFloor, value: 0.0, limit: 0.0 };
            return Verdict { class: Class::NoGo, fault: Some((fault, from_m)), route: Route::default() };
        };
        let way = routes.way(goal);
        let class = routes.class(goal).unwrap_or(Class::NoGo);
        if let (Class::Go, Some(fault)) = (class, self.steep_stop(&way)) {
            let class = Class::Marginal;
            return Verdict { class, fault: Some(fault), route: Route::along(self, &way, class) };
        }
        if class == Class::Go {
            return Verdict { class, fault: None, route: Route::along(self, &way, class) };
        }
        let worst = (0..way.len()).find(|place| routes.class(way[*place]) == Some(class)).unwrap_or(0);
        let fault = self.terrain.why(way[worst.saturating_sub(1)], way[worst]);
        let fault = fault.map(|fault| (fault, self.terrain.pose(way[worst]).position_m));
        let route = if class == Class::NoGo { Route::default() } else { Route::along(self, &way, class) };
        Verdict { class, fault, route }
    }
}

/// Distance of a point from a straight line between two others.
fn from_line_m([x, y]: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = if squared > 0.0 { ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / squared } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    libm::hypot(x - a[0] - share * along[0], y - a[1] - share * along[1])
}

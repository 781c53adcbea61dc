//! Paths through a finished cave.

use std::str::FromStr;

use nalgebra::Point3;
use plume_exporters::scene::Scene;
use plume_graph::{Graph, Neighbors, Node, StationId};
use plume_truth::{Certificate, Floor, Network, Profile, Route};

use super::certify::NamedRobot;
use super::{Cave, CaveError};

/// Which way a path goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Journey {
    /// From the start to the station that is furthest from it.
    Longest,
    /// From the start around the longest loop of passages, and back.
    Loop,
    /// From the start through every passage that the robot gets through, and back.
    Tour,
    /// Between two stations with these ids.
    Between(u64, u64),
}

impl FromStr for Journey {
    type Err = CaveError;

    fn from_str(text: &str) -> Result<Self, CaveError> {
        let ids = text.split_once("..").and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
        match (text, ids) {
            ("longest", _) => Ok(Self::Longest),
            ("loop", _) => Ok(Self::Loop),
            ("tour", _) => Ok(Self::Tour),
            (_, Some((from, to))) => Ok(Self::Between(from, to)),
            _ => {
                let known = ["longest", "loop", "tour", "A..B"].into_iter();
                Err(CaveError::unknown("kind of path", text, known))
            }
        }
    }
}

impl Cave {
    /// A path for a robot.
    ///
    /// # Errors
    /// If there is no such station or loop, the robot does not get there, or a chunk cannot be read.
    pub fn route(&self, scene: &Scene, robot: &NamedRobot, journey: Journey) -> Result<Route, CaveError> {
        let (floor, start_m) = self.floor(scene)?;
        let world = World { graph: &self.graph, floor, start_m, robot: robot.settings.profile(scene.friction.floor) };
        match journey {
            Journey::Longest => world.longest(),
            Journey::Loop => world.around(),
            Journey::Tour => world.tour(),
            Journey::Between(from, to) => world.between(from, to),
        }
    }
}

/// A robot in a cave.
struct World<'a> {
    graph: &'a Graph,
    floor: Floor,
    start_m: [f64; 3],
    robot: Profile,
}

impl World<'_> {
    fn longest(&self) -> Result<Route, CaveError> {
        let (_, route) = self.reach().furthest.ok_or_else(|| self.stuck())?;
        Ok(route)
    }

    /// To where the longest loop begins, around it, and back.
    fn around(&self) -> Result<Route, CaveError> {
        let tree = Tree::of(self.graph, self.first());
        let longest = tree.chords.iter().max_by(|a, b| tree.loop_m(**a).total_cmp(&tree.loop_m(**b)));
        let [a, b] = *longest.ok_or_else(|| CaveError::Usage {
            message: "the passages that begin at the start have no loop".into(),
            hint: "`--kind tour` goes through all of them".into(),
        })?;
        let there = tree.branch_to(a);
        let back = tree.branch_to(b).into_iter().rev();
        self.via(&there.into_iter().chain(back).collect::<Vec<_>>())
    }

    /// Down every branch to the last station that the robot reaches and comes back from.
    fn tour(&self) -> Result<Route, CaveError> {
        let reach = self.reach();
        let is_sure = |station: StationId| reach.stations[station.index()].is_sure();
        if !self.graph.stations().any(is_sure) {
            return Err(self.stuck());
        }
        self.via(&Tree::of(self.graph, self.first()).tour(&is_sure))
    }

    fn between(&self, from: u64, to: u64) -> Result<Route, CaveError> {
        let station = |id: u64| {
            let found = self.graph.stations().find(|station| self.graph[*station].id == id);
            found.ok_or_else(|| CaveError::Usage {
                message: format!("there is no station {id}"),
                hint: "`plume graph` exports the stations with their ids".into(),
            })
        };
        let (from, to) = (self.position(station(from)?), self.position(station(to)?));
        let cell = self.floor.under(from).ok_or_else(|| self.stuck())?;
        let start_m = [from[0], from[1], self.floor.cells()[cell].floor_m.into()];
        Route::via(&self.floor, &self.robot, start_m, &[to]).map_err(|_| self.stuck())
    }

    fn via(&self, stations: &[StationId]) -> Result<Route, CaveError> {
        let places: Vec<[f64; 3]> = stations.iter().map(|station| self.position(*station)).collect();
        Route::via(&self.floor, &self.robot, self.start_m, &places).map_err(|place| CaveError::Usage {
            message: format!("the robot does not get to station {}", self.graph[stations[place]].id),
            hint: HINT.into(),
        })
    }

    /// How well the robot gets to every station.
    fn reach(&self) -> Certificate {
        let stations = self.graph.stations().map(|station| self.position(station)).collect();
        let network = Network { stations, passages: Vec::new() };
        Certificate::of(&self.floor, &self.robot, &network, self.start_m)
    }

    /// The station nearest to the start.
    fn first(&self) -> StationId {
        let away_m = |station: &StationId| {
            let position = self.graph[*station].position;
            (position - Point3::from(self.start_m)).norm()
        };
        let nearest = self.graph.stations().min_by(|a, b| away_m(a).total_cmp(&away_m(b)));
        nearest.expect("a finished cave has stations")
    }

    fn position(&self, station: StationId) -> [f64; 3] {
        self.graph[station].position.coords.into()
    }

    fn stuck(&self) -> CaveError {
        CaveError::Usage { message: "the robot does not get there".into(), hint: HINT.into() }
    }
}

/// What to do about a robot that does not get through.
const HINT: &str = "`plume certify` tells what stops it and where";

/// The passages from a station, breadth-first.
struct Tree<'a> {
    graph: &'a Graph,
    neighbors: Neighbors<Node>,
    root: StationId,
    parents: Vec<Option<StationId>>,
    /// Passages of which neither end was reached from the other.
    chords: Vec<[StationId; 2]>,
}

impl<'a> Tree<'a> {
    fn of(graph: &'a Graph, root: StationId) -> Self {
        let neighbors = graph.neighbors();
        let mut parents = vec![None; graph.nodes.len()];
        let mut is_reached = vec![false; graph.nodes.len()];
        for (station, parent) in neighbors.by_breadth([root]) {
            parents[station.index()] = parent;
            is_reached[station.index()] = true;
        }
        let joins = |[a, b]: &[StationId; 2]| parents[a.index()] == Some(*b) || parents[b.index()] == Some(*a);
        let is_chord = |edge: &&[StationId; 2]| is_reached[edge[0].index()] && !joins(edge);
        let chords = graph.edges.iter().filter(is_chord).copied().collect();
        Self { graph, neighbors, root, parents, chords }
    }

    /// The stations from the root to one, both included.
    fn branch_to(&self, station: StationId) -> Vec<StationId> {
        let up = std::iter::successors(Some(station), |station| self.parents[station.index()]);
        let mut way: Vec<StationId> = up.collect();
        way.reverse();
        way
    }

    /// Length in metres of the loop that a chord closes.
    fn loop_m(&self, [a, b]: [StationId; 2]) -> f64 {
        let ways = [a, b].map(|end| self.branch_to(end));
        let shared = ways[0].iter().zip(&ways[1]).take_while(|(one, other)| one == other).count();
        let length_m =
            |way: &[StationId]| way.windows(2).map(|pair| self.graph.distance_m(pair[0], pair[1])).sum::<f64>();
        self.graph.distance_m(a, b) + ways.iter().map(|way| length_m(&way[shared - 1..])).sum::<f64>()
    }

    /// A walk from the root and back through all passages between good stations that hang together with it, each branch in turn.
    fn tour(&self, is_good: &dyn Fn(StationId) -> bool) -> Vec<StationId> {
        let mut walk = Vec::new();
        // Whether each is to be explored, or only passed.
        let mut ahead = vec![(self.root, true)];
        while let Some((station, is_new)) = ahead.pop() {
            walk.push(station);
            for other in self.neighbors[station].iter().rev().filter(|other| is_new && is_good(**other)) {
                let is_below = self.parents[other.index()] == Some(station);
                // A loop is closed from one of its ends, and left the way it was entered.
                if is_below || self.chords.contains(&[station, *other]) {
                    ahead.extend([(station, false), (*other, is_below)]);
                }
            }
        }
        walk.dedup();
        walk
    }
}

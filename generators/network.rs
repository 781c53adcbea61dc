//! A growing cave, for the generators that dig passage by passage.
//!
//! A [`Network`] accepts chains of stations and refuses those that break its rules (see `law`): too steep, too sharp at a
//! junction, or too near a passage that is far along the cave. It is always one component with at most [`DEGREE`] passages
//! at a station. `loops` joins dead ends afterwards.

mod cells;
mod law;
mod loops;
mod ways;

use nalgebra::{Point3, Vector3};

pub(super) use cells::Cells;

use super::GenerateError;
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};
use plume_graph::rng::Rng;
use plume_graph::section::clearance_radius_m;
use plume_graph::seed;
use plume_graph::{Graph, Section, Shape, millimetres};

/// Default minimum angle between passages at a station: 50 degrees.
pub(super) const JUNCTION: f64 = 50.0 * std::f64::consts::PI / 180.0;
/// Most passages at a station.
pub(super) const DEGREE: usize = 4;
/// Attempts before the settings are considered too tight.
const ATTEMPTS: u64 = 6;
/// Share of nodes reserved for connectors, for as many loops as in real caves. Tuned.
const HELD_FOR_LOOPS: f64 = 0.06;

/// The rules for all passages.
#[derive(Clone, Debug)]
pub(super) struct Rules {
    /// Number of stations of the finished graph.
    pub(super) nodes: usize,
    /// Minimum rock between passages that do not meet, in metres.
    pub(super) rock_m: f64,
    /// The largest section of a passage.
    pub(super) widest: Size,
    /// Maximum inclination of a passage.
    pub(super) steepest_rad: f64,
    /// Minimum angle between two passages at a station.
    pub(super) junction: f64,
    /// Number of loops; 1 for as many as in real caves.
    pub(super) loop_closure: f64,
    /// Distance between the stations of a connector, in metres.
    pub(super) spacing_m: f64,
}

/// Size of a passage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    pub(super) width_m: f64,
    /// From floor to ceiling.
    pub(super) height_m: f64,
}

impl Size {
    /// A section of this width, with its height relative to it.
    pub(super) fn new(width_m: f64, height_ratio: f64) -> Self {
        Self { width_m, height_m: width_m * height_ratio }
    }

    /// Its section.
    fn section(self) -> Section {
        Section { width_m: self.width_m, height_m: self.height_m, shape: Shape::Cave }
    }

    fn clearance_radius(self) -> f64 {
        clearance_radius_m(self.width_m, self.height_m)
    }
}

/// Position of a station, and size of the passage there.
#[derive(Clone, Copy, Debug)]
pub(super) struct PassagePoint {
    pub(super) position: Point3<f64>,
    pub(super) size: Size,
}

#[derive(Clone, Debug)]
struct NetworkStation {
    passage_point: PassagePoint,
    neighbors: [u32; DEGREE],
    degree: u8,
}

/// Stations, and passages between them that keep the rules.
pub(super) struct Network {
    rules: Rules,
    /// Maximum rise of a passage per horizontal metre.
    steepest_slope: f64,
    /// Cosine of the minimum angle between passages at a station.
    sharpest: f64,
    stations: Vec<NetworkStation>,
    passages: Cells<[u32; 2]>,
    places: Cells<u32>,
    /// Stations from which nothing was started yet.
    openings: Vec<usize>,
    /// Number of stations reserved for connectors.
    held: usize,
}

impl Network {
    /// A network of one station.
    pub(super) fn new(rules: Rules, first: PassagePoint) -> Self {
        let side_m = rules.spacing_m.max(4.0 * rules.widest.clearance_radius() + 2.0 * rules.rock_m);
        let mut network = Self {
            stations: Vec::new(),
            passages: Cells::new(side_m),
            places: Cells::new(side_m),
            openings: Vec::new(),
            held: 0,
            steepest_slope: libm::tan(rules.steepest_rad),
            sharpest: libm::cos(rules.junction),
            rules,
        };
        let first = network.place(first);
        let at = network.stations[first].passage_point.position;
        network.places.add(first as u32, [&at; 2]);
        network.openings.push(first);
        network
    }

    pub(super) fn passage_point(&self, station: usize) -> &PassagePoint {
        &self.stations[station].passage_point
    }

    pub(super) fn position(&self, station: usize) -> &Point3<f64> {
        &self.stations[station].passage_point.position
    }

    /// The neighbours of a station.
    pub(super) fn neighbors(&self, station: usize) -> impl Iterator<Item = usize> + use<'_> {
        let station = &self.stations[station];
        station.neighbors[..usize::from(station.degree)].iter().map(|&other| other as usize)
    }

    pub(super) fn degree(&self, station: usize) -> usize {
        usize::from(self.stations[station].degree)
    }

    pub(super) fn len(&self) -> usize {
        self.stations.len()
    }

    /// Number of stations that may still be placed.
    pub(super) fn room(&self) -> usize {
        (self.rules.nodes - self.held).saturating_sub(self.stations.len())
    }

    /// Takes a random station from which nothing was started yet.
    pub(super) fn draw_opening(&mut self, rng: &mut Rng) -> Option<usize> {
        let last = self.openings.len();
        (last > 0).then(|| self.openings.swap_remove(rng.index(last)))
    }

    /// The unit direction in which the cave reached a dead end; `None` at a junction or at the first station.
    pub(super) fn heading(&self, tip: usize) -> Option<Vector3<f64>> {
        let mut others = self.neighbors(tip);
        let before = others.next().filter(|_| self.degree(tip) == 1)?;
        (self.position(tip) - self.position(before)).try_normalize(0.0)
    }

    /// Adds a chain of new stations to one station, and connects it to another if it is to end there. All or nothing: the
    /// last station, or `None` if the chain breaks the rules or there is no room.
    pub(super) fn lay(&mut self, from: usize, way: &[PassagePoint], to: Option<usize>) -> Option<usize> {
        if way.len() > self.room() || !self.is_open(from, to, way.is_empty()) {
            return None;
        }
        let first = self.stations.len();
        let mut chain = vec![from];
        chain.extend(way.iter().map(|passage_point| self.place(*passage_point)));
        chain.extend(to);
        chain.windows(2).for_each(|leg| self.link(leg[0], leg[1]));
        for (laid, leg) in chain.windows(2).enumerate() {
            if !self.is_lawful(leg[0], leg[1]) {
                self.rollback(&chain, laid, first);
                return None;
            }
            let ends = [0, 1].map(|end| &self.stations[leg[end]].passage_point.position);
            self.passages.add([leg[0] as u32, leg[1] as u32], ends);
        }
        for station in first..self.stations.len() {
            self.places.add(station as u32, [&self.stations[station].passage_point.position; 2]);
            self.openings.push(station);
        }
        chain.last().copied()
    }

    /// Whether the ends of a chain can take one more passage.
    fn is_open(&self, from: usize, to: Option<usize>, is_direct: bool) -> bool {
        let takes = |station: usize| self.degree(station) < DEGREE;
        let joins =
            |to: usize| to != from && takes(to) && !(is_direct && self.neighbors(from).any(|other| other == to));
        takes(from) && to.is_none_or(joins) && !(is_direct && to.is_none())
    }

    fn place(&mut self, passage_point: PassagePoint) -> usize {
        let passage_point = PassagePoint { position: passage_point.position.map(millimetres), ..passage_point };
        self.stations.push(NetworkStation { passage_point, neighbors: [0; DEGREE], degree: 0 });
        self.stations.len() - 1
    }

    fn link(&mut self, a: usize, b: usize) {
        for [one, other] in [[a, b], [b, a]] {
            let station = &mut self.stations[one];
            station.neighbors[usize::from(station.degree)] = other as u32;
            station.degree += 1;
        }
    }

    /// Undoes a chain of which this many legs are in the grid, and whose own stations begin at `first`.
    fn rollback(&mut self, chain: &[usize], laid: usize, first: usize) {
        for leg in chain.windows(2).take(laid) {
            let ends = [0, 1].map(|end| &self.stations[leg[end]].passage_point.position);
            self.passages.remove([leg[0] as u32, leg[1] as u32], ends);
        }
        for end in [chain[0], chain[chain.len() - 1]] {
            // The newest neighbour is that of this chain.
            if end < first {
                self.stations[end].degree -= 1;
            }
        }
        self.stations.truncate(first);
    }

    /// The station from which this one was added; `None` for the first.
    pub(super) fn parent(&self, station: usize) -> Option<usize> {
        self.neighbors(station).next().filter(|&other| other < station)
    }

    /// Sets the sizes of passages, given by station. Floors stay where they are: ceilings and axes follow.
    pub(super) fn resize(&mut self, size: impl Fn(usize) -> Size) {
        for (index, station) in self.stations.iter_mut().enumerate() {
            let PassagePoint { position, size: before } = &mut station.passage_point;
            let after = size(index);
            position.z = millimetres(position.z + after.section().axis_height_m() - before.section().axis_height_m());
            *before = after;
        }
    }

    fn into_graph(self) -> Graph {
        let vertex = |station: &NetworkStation| {
            let PassagePoint { position, size } = station.passage_point;
            Vertex { position, section: Some(size.section()), level: 0 }
        };
        let mut centreline =
            CentrelineBuilder { vertices: self.stations.iter().map(vertex).collect(), lines: Vec::new() };
        for station in 0..self.len() {
            let older = self.neighbors(station).filter(|&other| other < station);
            older.for_each(|other| centreline.join(VertexId::new(other), VertexId::new(station)));
        }
        centreline.into_graph()
    }
}

/// How a generator grows its network.
pub(super) trait Growth {
    /// Digs until there is no room left or nowhere to continue.
    fn dig(&mut self, network: &mut Network, rng: &mut Rng);

    /// Final steps when the network has all its stations.
    fn finish(&self, _network: &mut Network) {}
}

/// The first network that reaches its number of nodes: dug, its loops closed, and dug on with the nodes left over.
///
/// # Errors
/// If no attempt has room for all nodes.
pub(super) fn grown<G: Growth>(
    rules: &Rules,
    seed: u64,
    name: &str,
    begin: impl Fn(&mut Rng, u64) -> (PassagePoint, G),
) -> Result<Graph, GenerateError> {
    let mut most = 0;
    for attempt in 0..ATTEMPTS {
        let mut rng = Rng::new(seed::stream(seed, name, attempt));
        let (first, mut growth) = begin(&mut rng, attempt);
        let mut network = Network::new(rules.clone(), first);
        network.fill(&mut growth, &mut rng);
        if network.room() == 0 {
            growth.finish(&mut network);
            return Ok(network.into_graph());
        }
        most = most.max(network.len());
    }
    Err(GenerateError::new(
        format!("no room for {} nodes", rules.nodes),
        format!("{most} were placed; ask for fewer nodes, narrower or steeper passages, or less rock"),
    ))
}

impl Network {
    fn fill(&mut self, growth: &mut impl Growth, rng: &mut Rng) {
        self.held = (self.rules.nodes as f64 * HELD_FOR_LOOPS * self.rules.loop_closure) as usize;
        growth.dig(self, rng);
        self.held = 0;
        self.close_loops(rng);
        growth.dig(self, rng);
    }
}

/// The unit direction of this yaw and inclination.
pub(super) fn ahead(yaw_rad: f64, pitch_rad: f64) -> Vector3<f64> {
    let level = libm::cos(pitch_rad);
    Vector3::new(level * libm::cos(yaw_rad), level * libm::sin(yaw_rad), libm::sin(pitch_rad))
}

/// Refuses a minimum setting above its maximum.
pub(super) fn in_order([least, most]: [&str; 2], [low, high]: [f64; 2]) -> Result<(), GenerateError> {
    if low <= high {
        return Ok(());
    }
    Err(GenerateError::new(
        format!("`{least}` is {low} but `{most}` is {high}"),
        "the minimum must not exceed the maximum",
    ))
}

//! Links between two layers: where they may start and end, how they run, and whether there is room.

use std::ops::Range;

use nalgebra::{Point2, Point3, Vector3};

use super::stack::Stack;
use crate::ramp::{Course, Helix, Slopes, slope_rad, way_down};
use plume_graph::rng::Rng;
use plume_graph::{Node, StationId, millimetres};

/// Rules for all links.
pub(super) struct Law {
    pub(super) slopes: Slopes,
    pub(super) spacing_m: f64,
    pub(super) rock_m: f64,
}

/// Head and foot of a link.
pub(super) type Link = [Point3<f64>; 2];

/// Stations drawn, of which the one farthest from other links is tried, and the number of such rounds. Tuned: at the
/// defaults one link in a hundred needs more than two rounds.
const DRAWN: usize = 32;
const DRAWS: usize = 8;
/// Stations of the other layer tried for one of this layer.
const GOALS: usize = 4;
/// Cosine of the minimum angle between a link and a passage at its ends: 50 degrees.
const SHARPEST_COS: f64 = 0.643;
/// Slope from which shafts are sunk where passages cross above each other: 75 degrees.
const SHAFT: f64 = 1.309;
/// Crossings this near to a station are ignored, in metres.
const STUB_M: f64 = 0.3;
/// Minimum height of a link, in metres.
const LEAST_DROP_M: f64 = 1.0;
/// Most passages at a station where a link may end.
const MOST_PASSAGES: usize = 3;
/// Most whole turns of a helix.
const MOST_TURNS: u32 = 4;
/// Distances between stations of a link, in metres.
const STEP_M: Range<f64> = 2.0..6.0;

/// Where a link may start or end.
#[derive(Clone, Copy)]
enum Place {
    Station(StationId),
    /// Inside the passage between two stations, at this parameter and this point of the plan.
    Passage([StationId; 2], f64, Point2<f64>),
}

impl Stack {
    /// Makes one more link between a layer and the one below it, far from the `others` there; `None` if there is no room.
    pub(super) fn link(&mut self, upper: usize, others: &[Link], law: &Law, rng: &mut Rng) -> Option<Link> {
        let pair = [self.layers[upper].clone(), self.layers[upper + 1].clone()];
        // Starts from the smaller layer, since all of it may be under or over a small part of the other.
        let from = usize::from(pair[1].len() < pair[0].len());
        for _ in 0..DRAWS {
            let mut station = || StationId::new(pair[from].start + rng.index(pair[from].len()));
            let mut drawn: Vec<StationId> = (0..DRAWN).map(|_| station()).collect();
            drawn.sort_by_cached_key(|&station| {
                let at = self.passages.node(station).position.xy();
                let away_um = others.iter().map(|link| ((link[from].xy() - at).norm() * 1e6) as u64);
                std::cmp::Reverse(away_um.min())
            });
            for station in drawn {
                let link = self.link_from(station, &pair, from, others, law, rng);
                if link.is_some() {
                    return link;
                }
            }
        }
        None
    }

    /// A link from or to a station, which is in the first or the second layer of the `pair`.
    fn link_from(
        &mut self,
        station: StationId,
        pair: &[Range<usize>; 2],
        from: usize,
        others: &[Link],
        law: &Law,
        rng: &mut Rng,
    ) -> Option<Link> {
        let mut ends = Vec::new();
        if law.slopes.greatest_rad >= SHAFT {
            ends.extend(self.crossings(station, &pair[1 - from]));
        }
        ends.extend(self.goals(station, &pair[1 - from], law, rng));
        for [this, other] in ends {
            let ends = if from == 0 { [this, other] } else { [other, this] };
            let [head, foot] = ends.map(|place| self.node(place).position);
            let is_spaced = |end: usize, at: &Point3<f64>| {
                others.iter().all(|link| (link[end].xy() - at.xy()).norm() >= law.spacing_m)
            };
            if head.z - foot.z < LEAST_DROP_M || !is_spaced(0, &head) || !is_spaced(1, &foot) {
                continue;
            }
            if self.run(ends, law, rng) {
                return Some([head, foot]);
            }
        }
        None
    }

    /// Where passages at a station cross above or below those of the other layer.
    fn crossings(&self, station: StationId, other: &Range<usize>) -> Vec<[Place; 2]> {
        let at = |node: StationId| self.passages.node(node).position;
        let mut found = Vec::new();
        for &next in self.passages.neighbors_of(station) {
            let ends = [at(station), at(next)];
            for [a, b] in self.passages.under(ends.map(|end| end.xy())) {
                if ![a, b].iter().all(|end| other.contains(&end.index())) {
                    continue;
                }
                let Some([s, t]) = crossing(ends, [at(a), at(b)]) else { continue };
                let is_inside = |share: f64, length: f64| share * length > STUB_M && (1.0 - share) * length > STUB_M;
                if is_inside(s, (ends[1] - ends[0]).norm()) && is_inside(t, (at(b) - at(a)).norm()) {
                    let plan = (ends[0] + (ends[1] - ends[0]) * s).xy().map(millimetres);
                    found.push([Place::Passage([station, next], s, plan), Place::Passage([a, b], t, plan)]);
                }
            }
        }
        found
    }

    /// Stations of the other layer that a link could lead to; first those that a straight one of medium slope would reach.
    fn goals(&self, station: StationId, other: &Range<usize>, law: &Law, rng: &mut Rng) -> Vec<[Place; 2]> {
        if self.passages.neighbors_of(station).len() > MOST_PASSAGES {
            return Vec::new();
        }
        let from = self.passages.node(station).position;
        let middling = libm::tan(0.5 * (law.slopes.least_rad + law.slopes.greatest_rad));
        let mut near = Vec::new();
        for goal in other.clone().map(StationId::new) {
            let way = self.passages.node(goal).position - from;
            let (drop, apart) = (way.z.abs(), way.xy().norm());
            if apart * libm::tan(law.slopes.least_rad) > drop + 0.001
                || self.passages.neighbors_of(goal).len() > MOST_PASSAGES
            {
                continue;
            }
            let off_m = (apart - drop / middling).abs();
            near.push(((off_m * 1e6) as u64, goal));
        }
        near.sort_unstable();
        near.truncate(4 * GOALS);
        let mut goals = Vec::new();
        while goals.len() < GOALS && !near.is_empty() {
            // One of the better half, for variety.
            let (_, goal) = near.remove(rng.index(near.len().div_ceil(2)));
            goals.push([Place::Station(station), Place::Station(goal)]);
        }
        goals
    }

    /// Makes the link along the first course that has room.
    fn run(&mut self, ends: [Place; 2], law: &Law, rng: &mut Rng) -> bool {
        let [head, foot] = ends.map(|place| self.node(place));
        let points = [head.position, foot.position];
        let step_m = (0.5 * (head.radius + foot.radius)).clamp(STEP_M.start, STEP_M.end);
        courses(points, &law.slopes, rng).into_iter().any(|course| {
            let Some(way) = way_down(points, course, &law.slopes, step_m) else { return false };
            self.leaves(ends[0], &way[0], &way[1])
                && self.leaves(ends[1], &way[way.len() - 1], &way[way.len() - 2])
                && self.settle_link(ends, &way, law.rock_m)
        })
    }

    /// Whether a link turns away from all passages at its end.
    fn leaves(&self, place: Place, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let others = match place {
            Place::Station(station) => self.passages.neighbors_of(station).to_vec(),
            Place::Passage(ends, ..) => ends.to_vec(),
        };
        let way: Vector3<f64> = (to - from).normalize();
        others.iter().all(|&other| {
            let passage = self.passages.node(other).position - from;
            passage.dot(&way) <= SHARPEST_COS * passage.norm()
        })
    }

    /// Adds the stations of a link, unless there is too little rock around it.
    fn settle_link(&mut self, ends: [Place; 2], way: &[Point3<f64>], rock_m: f64) -> bool {
        let len = self.passages.nodes.len();
        let [head, foot] = ends.map(|place| self.open(place));
        let mut stations = vec![head];
        for (place, &position) in way[1..way.len() - 1].iter().enumerate() {
            let share = (place + 1) as f64 / (way.len() - 1) as f64;
            let [head, foot] = [head, foot].map(|end| self.passages.node(end));
            let node = Node { position, level: foot.level, ..blend(head, foot, share) };
            stations.push(self.passages.add(node));
        }
        stations.push(foot);
        let passages: Vec<[StationId; 2]> =
            stations.windows(2).map(|leg| [leg[0].min(leg[1]), leg[0].max(leg[1])]).collect();
        passages.iter().for_each(|&[a, b]| self.passages.join(a, b));
        if !self.has_rock(&passages, rock_m) {
            passages.iter().for_each(|&[a, b]| self.passages.part(a, b));
            self.passages.truncate(len);
            ends.into_iter().for_each(|place| self.close(place));
            return false;
        }
        self.passages.settle(&passages);
        for (place, end) in ends.into_iter().zip([head, foot]) {
            self.settle_end(place, end);
        }
        true
    }

    /// Whether new passages keep their distance from existing ones, and from each other.
    fn has_rock(&self, passages: &[[StationId; 2]], rock_m: f64) -> bool {
        let apart =
            |one: [StationId; 2], other: [StationId; 2]| self.passages.thin_between(one, other, rock_m).is_none();
        passages.iter().all(|&passage| self.passages.thin(passage, rock_m).next().is_none())
            && (passages.iter().enumerate())
                .all(|(place, &one)| passages[..place].iter().all(|&other| apart(one, other)))
    }

    /// The station at a place, inserted into its passage if there is none.
    fn open(&mut self, place: Place) -> StationId {
        match place {
            Place::Station(station) => station,
            Place::Passage([a, b], ..) => {
                let station = self.passages.add(self.node(place));
                self.passages.part(a, b);
                self.passages.join(a, station);
                self.passages.join(station, b);
                station
            }
        }
    }

    /// Restores a passage whose inserted station was removed.
    fn close(&mut self, place: Place) {
        if let Place::Passage([a, b], ..) = place {
            self.passages.join(a, b);
        }
    }

    /// The change at the end of a link: a passage split in two, or a room.
    fn settle_end(&mut self, place: Place, station: StationId) {
        match place {
            Place::Station(_) if self.passages.is_room(station) && self.passages.neighbors_of(station).len() == 3 => {
                self.passages.settle(&[[station, station]]);
            }
            Place::Station(_) => {}
            Place::Passage([a, b], ..) => {
                self.passages.unsettle([a.min(b), a.max(b)]);
                self.passages.settle(&[[a, station], [b, station]]);
                if self.passages.is_room(station) {
                    self.passages.settle(&[[station, station]]);
                }
            }
        }
    }

    /// The station at a place, as it is or would be.
    fn node(&self, place: Place) -> Node {
        match place {
            Place::Station(station) => self.passages.node(station).clone(),
            Place::Passage([a, b], share, plan) => {
                let [a, b] = [a, b].map(|end| self.passages.node(end));
                let z = millimetres(a.position.z + (b.position.z - a.position.z) * share);
                let level = if share < 0.5 { a.level } else { b.level };
                Node { position: Point3::new(plan.x, plan.y, z), level, ..blend(a, b, share) }
            }
        }
    }
}

/// A station between two others, except for its position and level.
fn blend(a: &Node, b: &Node, share: f64) -> Node {
    let section = a.section.zip(b.section).map(|(a, b)| a.towards(b, share).map(millimetres));
    let radius = millimetres(a.radius + (b.radius - a.radius) * share);
    Node { parent: None, active: false, radius, section, name: None, ..a.clone() }
}

/// Where two passages cross in the plan, as parameters on each.
fn crossing([a, b]: [Point3<f64>; 2], [c, d]: [Point3<f64>; 2]) -> Option<[f64; 2]> {
    let (this, other, between) = ((b - a).xy(), (d - c).xy(), (c - a).xy());
    let area = this.perp(&other);
    if area.abs() < 1e-6 {
        return None;
    }
    let shares = [between.perp(&other) / area, between.perp(&this) / area];
    shares.iter().all(|share| (0.0..=1.0).contains(share)).then_some(shares)
}

/// Possible courses of a link, simplest first: straight, bent, helical.
fn courses([head, foot]: [Point3<f64>; 2], slopes: &Slopes, rng: &mut Rng) -> Vec<Course> {
    let (side, bearing_rad) = (rng.sign(), rng.between(0.0, std::f64::consts::TAU));
    let gentle = 0.5 * (slopes.least_rad + slopes.greatest_rad);
    let steep = slopes.greatest_rad - 0.05 * (slopes.greatest_rad - slopes.least_rad);
    let arc = |slope_rad: f64, turns: u32| {
        [side, -side].map(|side| Course::Round(Helix { slope_rad, turns, side, bearing_rad }))
    };
    let natural = slope_rad(&head, &foot);
    let mut courses = vec![Course::Straight];
    if natural <= slopes.greatest_rad {
        courses.extend(arc(0.5 * (slopes.least_rad + natural), 0));
        return courses;
    }
    for turns in 0..=MOST_TURNS {
        courses.extend(arc(gentle, turns));
        courses.extend(arc(steep, turns));
    }
    courses
}

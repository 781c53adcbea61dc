//! Roof falls and muck piles: heaps on the floor and, above those that fell, a higher ceiling.
//!
//! Each is made of capsules of zero length beside the axis of a passage, which blend with it as rooms do, so the field has no
//! term of its own for them. Natural passages have roof falls, which bank against one wall; drifts have muck in front of their
//! faces. Where they are is drawn for each edge of the graph by itself.
//!
//! Promised: they reach no passage that is not a neighbour of theirs, and measured sections of caves stay as measured. Not
//! promised: a volume that balances; no measured law of the sizes of roof falls was found, so all shares are tuned by eye.

use nalgebra::Vector3;
use plume_graph::rng::Rng;
use plume_graph::seed::stream;
use plume_graph::{Aabb, Graph, Neighbors, Node, StationId};

use super::{BLEND_M, Capsule, PassageSettings, Profile, warp_weight};
use crate::material::DomainWarp;

/// Passages longer than this have more than one place for a roof fall, in metres.
const PLACE_M: f32 = 5.0;
/// Share of the places at which the roof fell, for a `collapse` of 1.
const SHARE: f64 = 0.3;
/// Steepest passage with a roof fall: rise over length.
const STEEPEST: f32 = 0.35;
/// Rock that remains between a roof fall and passages that are not its neighbours, in metres.
pub(in crate::field) const ROCK_M: f32 = 1.5;
/// Half the width in metres below which a heap would block a passage.
const NARROWEST_M: f32 = 1.0;
/// Height of a muck pile relative to that of its drift.
const MUCK: f32 = 0.5;

/// A heap of rock on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heap {
    /// Its middle, on the floor around it; metres, cave frame.
    pub at: [f32; 3],
    /// How far it reaches, in metres.
    pub radius_m: f32,
}

/// A heap with the capsules that shape it.
pub(in crate::field) struct Collapse {
    pub heap: Heap,
    pub capsules: Vec<Capsule>,
}

/// Every heap of a graph, in the order of its edges. `near` gives the passages, numbered as the edges, whose walls are within
/// [`ROCK_M`] of a box, and possibly some more.
pub(in crate::field) fn collapses<'a>(
    graph: &Graph,
    settings: &PassageSettings,
    domain_warp: DomainWarp,
    seed: u64,
    near: impl Fn(Aabb<f32>) -> Vec<(usize, &'a Capsule)>,
) -> Vec<Collapse> {
    let (degrees, neighbors) = (graph.degrees(), graph.neighbors());
    let mut found = Vec::new();
    for (number, ends) in (0..).zip(&graph.edges) {
        let mut rng = Rng::new(stream(seed, "collapse", number));
        let place = Place::new(graph, settings, *ends, domain_warp);
        if place.is_natural(graph) {
            let falls: Vec<Collapse> = place.roof_falls(settings.collapse, &mut rng).collect();
            let known = if falls.is_empty() { Vec::new() } else { around(&neighbors, *ends) };
            let is_beyond = |edge: usize| !graph.edges[edge].iter().any(|end| known.binary_search(end).is_ok());
            found.extend(falls.into_iter().filter(|fall| fall.is_apart(&near, is_beyond)));
        } else {
            let faces = [0, 1].into_iter().filter(|end| degrees[ends[*end].index()] == 1);
            found.extend(faces.filter(|_| settings.collapse > 0.0).filter_map(|end| place.muck(graph, end)));
        }
    }
    found
}

/// A passage that may have heaps.
struct Place {
    ends: [StationId; 2],
    at: [Vector3<f32>; 2],
    profiles: [Profile; 2],
    warp_weight: f32,
}

impl Place {
    fn new(graph: &Graph, settings: &PassageSettings, ends: [StationId; 2], domain_warp: DomainWarp) -> Self {
        let profiles = ends.map(|end| Profile::at(&graph[end], settings));
        let at = ends.map(|end| graph[end].position.coords.map(|c| c as f32));
        Self { ends, at, profiles, warp_weight: warp_weight(profiles, domain_warp) }
    }

    fn is_natural(&self, graph: &Graph) -> bool {
        self.ends.iter().all(|end| graph[*end].section.is_none())
    }

    fn span(&self) -> Vector3<f32> {
        self.at[1] - self.at[0]
    }

    /// The places along the passage where the roof fell.
    fn roof_falls(&self, collapse: f32, rng: &mut Rng) -> impl Iterator<Item = Collapse> + use<'_> {
        let length_m = self.span().norm();
        let is_level = self.span().z.abs() <= STEEPEST * length_m;
        let count = if is_level { (length_m / PLACE_M).ceil() as u32 } else { 0 };
        let chance = SHARE * f64::from(collapse);
        let draws: Vec<(bool, f32)> = (0..count).map(|_| (rng.chance(chance), rng.sign() as f32)).collect();
        let places = (0..).zip(draws).filter(|(_, (fell, _))| *fell);
        places.filter_map(move |(n, (_, side))| self.roof_fall((n as f32 + 0.5) / count as f32, side))
    }

    /// A roof fall at this share of the length, against the wall on one side: 1 left, -1 right.
    fn roof_fall(&self, share: f32, side: f32) -> Option<Collapse> {
        let between = |of: fn(&Profile) -> f32| {
            let [start, end] = self.profiles.each_ref().map(of);
            start + share * (end - start)
        };
        let [wide, high, drop] =
            [between(|own| own.half_width), between(|own| own.half_height), between(|own| own.drop)];
        let aside = Vector3::z().cross(&self.span()).try_normalize(1e-6)? * side;
        let axis = self.at[0] + self.span() * share;
        let dome = Pocket { wide: 1.1 * wide, high: 1.2 * high, warp_weight: self.warp_weight };
        let heap = Pocket { wide: 0.6 * wide + 0.7, high: 0.9 * high, warp_weight: self.warp_weight };
        let floor_z = axis.z - drop;
        // Beside the way that wheels need, in a niche of its own where the passage is narrow.
        let middle = axis + aside * (0.55 * wide + 0.9);
        let capsules = vec![
            dome.at(axis + aside * (0.3 * wide) + Vector3::z() * (0.4 * high), floor_z),
            heap.at(middle, floor_z + 1.1 * drop),
        ];
        let heap = Heap { at: [middle.x, middle.y, floor_z], radius_m: heap.wide + 0.5 * BLEND_M };
        (wide >= NARROWEST_M).then_some(Collapse { heap, capsules })
    }

    /// The muck pile in front of the face at an end.
    fn muck(&self, graph: &Graph, end: usize) -> Option<Collapse> {
        let Profile { half_width, half_height, drop, square } = self.profiles[end];
        let outwards = (self.at[end] - self.at[1 - end]).try_normalize(1e-6)?;
        let middle = self.at[end] + outwards * (0.5 * half_width);
        let pile = Pocket { wide: half_width, high: half_height, warp_weight: self.warp_weight };
        let floor_z = middle.z - drop;
        let heap = Heap { at: [middle.x, middle.y, floor_z], radius_m: half_width };
        let capsules = vec![pile.at(middle, floor_z + MUCK * (half_height + drop))];
        let is_drift = square > 0.0 && graph[self.ends[end]].section.is_some();
        is_drift.then_some(Collapse { heap, capsules })
    }
}

/// A capsule of zero length.
struct Pocket {
    wide: f32,
    high: f32,
    warp_weight: f32,
}

impl Pocket {
    fn at(&self, centre: Vector3<f32>, floor_z: f32) -> Capsule {
        Capsule {
            start: centre.into(),
            span: [0.0; 3],
            inverse: 0.0,
            half_width: [self.wide; 2],
            drop: [centre.z - floor_z; 2],
            squash: [self.wide / self.high; 2],
            square: 0.0,
            flow: [0.0; 3],
            warp_weight: self.warp_weight,
        }
    }
}

impl Collapse {
    /// Whether it reaches none of the passages that count.
    fn is_apart<'a>(
        &self,
        near: impl Fn(Aabb<f32>) -> Vec<(usize, &'a Capsule)>,
        counts: impl Fn(usize) -> bool,
    ) -> bool {
        self.capsules.iter().all(|pocket| {
            let radius = pocket.widest_m() / pocket.flattest().min(1.0);
            let others = near(Aabb::from(pocket.start).padded(radius)).into_iter().filter(|(edge, _)| counts(*edge));
            others.map(|(_, other)| other.near(pocket.start, radius, 0.0).nearest).all(|gap_m| gap_m > ROCK_M)
        })
    }
}

/// The stations of which passages may touch an edge anyway, sorted: those a few stations away from it.
fn around(neighbors: &Neighbors<Node>, ends: [StationId; 2]) -> Vec<StationId> {
    /// Stations on the way to them.
    const HOPS: usize = 2;
    let mut near = ends.to_vec();
    for _ in 0..HOPS {
        let reached: Vec<StationId> = near.iter().flat_map(|station| neighbors[*station].to_vec()).collect();
        near.extend(reached);
        near.sort_unstable();
        near.dedup();
    }
    near
}

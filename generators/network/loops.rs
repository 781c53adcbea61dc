//! Loop closure: connectors from dead ends to places that are near in space and far along the cave.

use nalgebra::Vector3;

use super::{Network, PassagePoint, Size};
use plume_graph::rng::Rng;

/// Loops of a real cave per end and junction, plus one (Collon et al. 2017: a mean degree of 2.13). Tuned.
const LOOPS_PER_END: f64 = 0.07;
/// Longest span of a connector, in steps of its own spacing.
const REACH: f64 = 7.0;
/// Shortest span, in steps.
const LEAST_REACH: f64 = 1.2;
/// Minimum detour relative to the length of a connector.
const DETOUR: f64 = 4.0;
/// Largest turn of a connector from the heading of its dead end: the cosine of 100 degrees.
const TURN: f64 = -0.17;
/// Number of places measured along the cave.
const CONSIDERED: usize = 24;
/// Growth factor of the rings in which places are searched.
const RING: f64 = 2.0;
/// Number of places that a dead end tries to reach.
const TRIES: usize = 6;
/// Maximum random factor on the cost of a connector.
const DEAREST: f64 = 2.0;
/// Lateral swing of the middle of a connector relative to its length.
const SWING: f64 = 0.22;

impl Network {
    /// Closes as many loops as the rules ask for, or as there is room for. Dead ends come first, then other stations.
    pub(super) fn close_loops(&mut self, rng: &mut Rng) {
        let ends = (0..self.len()).filter(|&station| self.degree(station) != 2).count();
        let wanted = self.rules.loop_closure * (1.0 + LOOPS_PER_END * ends as f64);
        let mut missing = (wanted + rng.unit()) as usize;
        for from in self.sources(missing, rng) {
            if missing == 0 {
                return;
            }
            missing -= usize::from(self.join(from, rng));
        }
    }

    /// Starts of connectors: the dead ends in random order, and as many stations inside passages as may be needed.
    fn sources(&self, loops: usize, rng: &mut Rng) -> Vec<usize> {
        let mut sources: Vec<usize> = (1..self.len()).filter(|&station| self.degree(station) == 1).collect();
        for last in (1..sources.len()).rev() {
            sources.swap(last, rng.index(last + 1));
        }
        sources.extend((0..TRIES * loops).map(|_| rng.index(self.len())));
        sources
    }

    /// Joins a station to a nearby place that is far along the cave, if there is one.
    pub(crate) fn join(&mut self, from: usize, rng: &mut Rng) -> bool {
        let spacing = self.rules.spacing_m;
        let goals = self.goals(from, [LEAST_REACH * spacing, REACH * spacing], rng);
        goals.into_iter().take(TRIES).any(|to| self.connect(from, to, rng))
    }

    /// Places worth joining within the range of distances, cheapest first.
    pub(crate) fn goals(&self, from: usize, [nearest, farthest]: [f64; 2], rng: &mut Rng) -> Vec<usize> {
        let at = self.position(from);
        let found = self.cheapest(from, [nearest, farthest], rng);
        // Only the remaining ones are worth measuring along the cave.
        let Some(most) = found.iter().map(|&to| (self.position(to) - at).norm()).reduce(f64::max) else {
            return Vec::new();
        };
        let ways = self.ways(from, None, DETOUR * most);
        let is_far = |&to: &usize| ways.to(to) >= DETOUR * (self.position(to) - at).norm();
        found.into_iter().filter(is_far).collect()
    }

    /// The cheapest places between two distances, searched in rings. A place costs at least its distance, so none beyond a
    /// ring is cheaper than places that cost less than its radius.
    fn cheapest(&self, from: usize, [nearest, farthest]: [f64; 2], rng: &mut Rng) -> Vec<usize> {
        let mut found: Vec<(f64, usize)> = Vec::new();
        let mut outer = nearest;
        while outer < farthest && found.iter().filter(|(cost, _)| *cost <= outer).count() < CONSIDERED {
            let inner = outer;
            outer = (RING * inner).min(farthest);
            found.extend(self.ring(from, [inner, outer]).map(|(apart, to)| (apart * rng.between(1.0, DEAREST), to)));
        }
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(_, to)| to).take(CONSIDERED).collect()
    }

    /// Places in a ring around a station to which a connector is neither too steep nor turned back, by distance.
    fn ring(&self, from: usize, [inner, outer]: [f64; 2]) -> impl Iterator<Item = (f64, usize)> {
        let at = *self.position(from);
        let heading = self.heading(from);
        let reach = Vector3::new(outer, outer, self.greatest_rise(outer).min(outer));
        self.places.near([&(at - reach), &(at + reach)], 0.0).filter_map(move |to| {
            let to = to as usize;
            let way = self.position(to) - at;
            let apart = way.norm();
            let turns = || heading.is_some_and(|heading| heading.dot(&way) < TURN * apart);
            let fits = (inner..outer).contains(&apart) && self.is_walkable(way) && !turns() && self.degree(to) <= 2;
            fits.then_some((apart, to))
        })
    }

    /// Adds a connector that leaves a dead end in its heading and curves to its goal.
    fn connect(&mut self, from: usize, to: usize, rng: &mut Rng) -> bool {
        let way = self.position(to) - self.position(from);
        let inner = ((way.norm() / self.rules.spacing_m).round() as usize).saturating_sub(1);
        if inner > self.room() {
            return false;
        }
        let across = Vector3::new(-way.y, way.x, 0.0) * (SWING * rng.between(-1.0, 1.0));
        let swing = match self.heading(from) {
            Some(heading) => across + heading * (SWING * way.norm()),
            None => across,
        };
        let chain: Vec<PassagePoint> = (1..=inner).map(|step| self.between(from, to, step, inner + 1, swing)).collect();
        self.lay(from, &chain, Some(to)).is_some()
    }

    /// A station of a connector: on a parabola over the straight line with the offset `swing` in the middle.
    fn between(&self, from: usize, to: usize, step: usize, steps: usize, swing: Vector3<f64>) -> PassagePoint {
        let part = step as f64 / steps as f64;
        let [a, b] = [self.passage_point(from), self.passage_point(to)];
        let blend = |a: f64, b: f64| a + (b - a) * part;
        let level = Vector3::new(swing.x, swing.y, 0.0);
        PassagePoint {
            position: a.position + (b.position - a.position) * part + level * (4.0 * part * (1.0 - part)),
            size: Size {
                width_m: blend(a.size.width_m, b.size.width_m),
                height_m: blend(a.size.height_m, b.size.height_m),
            },
        }
    }
}

//! Loop closure: connectors between places that are near in space and far along the cave.
//!
//! A connector grows like any branch, with its Gaussian turned towards the goal, and must keep the clearance rule. One that
//! cannot arrive is undone.

use super::cave::{Cave, PassageKind};
use super::circle::Spread;
use super::clearance::Goal;
use super::hops::Hops;
use super::step::{Floor, Step};
use super::tuning::{
    BEND_DECAY, DEAREST, DEGREE, JOIN_TRIES, KEEP_MAIN, LAST_LEG, LAYER_DISCOUNT, LINK_STEPS, LOOP_BIAS, LOOP_HOPS,
    LOOP_SLACK, MID_TRIES, TIP_COST_M,
};
use plume_graph::millimetres;

/// A pair worth joining. The field order is the order of preference; costs are whole micrometres, to avoid comparing floats.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    cost_um: u64,
    from: usize,
    to: usize,
}

impl Cave<'_> {
    /// Whether the cave has too few loops.
    pub(super) fn is_loop_due(&self) -> bool {
        self.missing_loops() >= LOOP_SLACK
    }

    /// Joins a tip, or otherwise a node inside a passage, to another part of the cave.
    pub(super) fn close_loop(&mut self, hops: &mut Hops) -> bool {
        let mut candidates = Vec::new();
        for from in self.sources() {
            hops.count(from, &self.stations);
            self.find_goals(from, hops, &mut candidates);
        }
        candidates.sort_unstable();
        candidates.iter().take(JOIN_TRIES).any(|candidate| self.connect(candidate.from, candidate.to))
    }

    /// Where a connector may start.
    fn sources(&mut self) -> Vec<usize> {
        let mut sources = if self.tips.len() <= JOIN_TRIES {
            self.tips.clone()
        } else {
            (0..JOIN_TRIES).map(|_| self.tips[self.rng.index(self.tips.len())]).collect()
        };
        let mut mids = 0;
        for _ in 0..4 * MID_TRIES {
            let drawn = self.rng.index(self.stations.len());
            let station = &self.stations[drawn];
            let plain = !matches!(station.kind, PassageKind::Ramp | PassageKind::Main);
            if mids < MID_TRIES && plain && station.degree() == 2 {
                sources.push(drawn);
                mids += 1;
            }
        }
        sources.sort_unstable();
        sources.dedup();
        sources
    }

    fn find_goals(&mut self, from: usize, hops: &Hops, found: &mut Vec<Candidate>) {
        let near: Vec<usize> = self.grid.stations_near(self.position(from), self.derived.join_distance).collect();
        for to in near {
            let way_round = hops.to(to);
            if way_round < LOOP_HOPS || !self.is_joinable(from, to) {
                continue;
            }
            if self.stations[to].kind == PassageKind::Main && self.rng.chance(KEEP_MAIN) {
                continue;
            }
            let cost = self.cost_m(from, to) / libm::pow(f64::from(way_round), LOOP_BIAS);
            found.push(Candidate { cost_um: (cost * 1e6) as u64, from, to });
        }
    }

    /// The cost of a connector in metres of passage: random within limits, lower between layers, higher at a tip.
    fn cost_m(&mut self, from: usize, to: usize) -> f64 {
        let drawn = self.distance(from, to) * self.rng.between(1.0, DEAREST);
        let (a, b) = (&self.stations[from], &self.stations[to]);
        let layers = if a.level == b.level { 1.0 } else { LAYER_DISCOUNT };
        let tip = if b.degree() == 1 { TIP_COST_M } else { 0.0 };
        layers * drawn + tip
    }

    /// Whether a connector between the two could keep the rules and enough nodes are left.
    pub(super) fn is_joinable(&self, from: usize, to: usize) -> bool {
        let (a, b) = (&self.stations[from], &self.stations[to]);
        let apart = self.distance(from, to);
        b.degree() <= 2
            && b.kind != PassageKind::Ramp
            && a.level.abs_diff(b.level) <= u32::from(!self.settings.has_links())
            && apart <= self.derived.join_distance
            && apart >= LAST_LEG * self.settings.reach_min_m
            && (a.level == b.level || self.is_walkable(from, to, PassageKind::Ramp))
            && self.legs(apart) - 1.0 <= self.room() as f64
    }

    /// Passages that a connector over this distance is likely to need.
    fn legs(&self, distance: f64) -> f64 {
        0.75 * distance / self.derived.spur_reach
    }

    pub(super) fn connect(&mut self, from: usize, to: usize) -> bool {
        let start = self.stations.len();
        let (radius, alive) = (self.stations[from].radius, self.stations[from].alive);
        if self.is_childless(from) {
            let legs = self.legs(self.distance(from, to)).ceil().max(1.0);
            let even = self.distance(from, to) / legs;
            // A radius only ever shrinks: widths tested before stay clear.
            let shrunk = even.max(self.settings.reach_min_m).min(radius);
            self.stations[from].radius = millimetres(shrunk);
        }
        if self.walk_to(from, to) {
            self.stations[from].alive = false;
            return true;
        }
        self.truncate(start);
        self.stations[from].radius = radius;
        self.stations[from].alive = alive;
        false
    }

    fn walk_to(&mut self, from: usize, to: usize) -> bool {
        let first = self.stations.len();
        let crosses = self.stations[from].level != self.stations[to].level;
        let mut bend = self.rng.sign() * self.rng.between(15.0, 55.0) * DEGREE;
        let mut tip = from;
        for _ in 0..LINK_STEPS {
            if self.can_join(tip, to, crosses) {
                return self.join(from, first, tip, to);
            }
            if self.room() == 0 {
                return false;
            }
            let step = Step {
                heading_rad: self.azimuth_rad(tip, to) + bend,
                spread: Spread::Link,
                radius: self.draw_reach(self.derived.spur_reach, Some(self.stations[tip].radius)),
                kind: if crosses { PassageKind::Ramp } else { PassageKind::Link },
                level: self.stations[tip].level,
                floor: if crosses { Floor::Straight(to) } else { Floor::Surface },
                goal: Goal::Towards(to),
            };
            let Some(next) = self.step(tip, &step) else {
                return false;
            };
            bend *= BEND_DECAY;
            tip = next;
        }
        false
    }

    fn can_join(&self, tip: usize, to: usize, crosses: bool) -> bool {
        let gap = self.distance(tip, to);
        let reach = LAST_LEG * self.settings.reach_min_m..=self.settings.reach_max_m;
        let kind = if crosses { PassageKind::Ramp } else { PassageKind::Link };
        let end = &self.stations[to];
        reach.contains(&gap)
            && self.is_walkable(tip, to, kind)
            && self.opens(tip, self.azimuth_rad(tip, to))
            && self.opens(to, self.azimuth_rad(to, tip))
            && self.is_clear(tip, &end.position, end.half_width(), Goal::Joining(to))
    }

    /// Adds the last leg of a connector, unless this breaks the clearance rule somewhere along it.
    fn join(&mut self, from: usize, first: usize, tip: usize, to: usize) -> bool {
        self.add_passage(tip, to);
        let mut way = vec![from];
        way.extend(first..self.stations.len());
        way.push(to);
        if !way.windows(2).all(|leg| self.is_lawful(leg[0], leg[1])) {
            self.remove_passage(tip, to);
            return false;
        }
        if self.is_childless(tip) {
            let gap = millimetres(self.distance(tip, to));
            let station = &mut self.stations[tip];
            station.radius = station.radius.min(gap);
        }
        true
    }

    fn is_childless(&self, station: usize) -> bool {
        let mut neighbors = self.stations[station].neighbors.iter();
        neighbors.all(|&other| self.stations[other].parent != Some(station))
    }
}

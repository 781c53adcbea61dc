//! The cheapest paths between key points, and which of them become passages.
//!
//! All key points grow simultaneously, each into the rock that it reaches at the lowest cost (Dijkstra). Where the regions
//! of two of them meet, the cheapest path between the two crosses the cheapest boundary edge (Mehlhorn: "A faster
//! approximation algorithm for the Steiner problem in graphs", 1988). So each key point has a few neighbours, among which
//! paths are pruned.

use std::mem;

use rustc_hash::FxHashMap;

use super::Karst;
use super::cloud::{Cloud, Neighbour};
use super::host_rock::HostRock;
use plume_graph::Rows;
use plume_graph::rng::Rng;

const NONE: u32 = u32::MAX;
/// Most steps of a dead end; short ones are more frequent.
const DEAD_END_STEPS: usize = 5;
/// Tips tried for each dead end.
const TIPS_PER_DEAD_END: usize = 60;
/// Dead ends begin only in rock no tighter than this, so that they form clusters and trunks stay long (tuned).
const SOFT: f64 = 0.35;

/// Where the regions of two key points meet.
#[derive(Clone, Copy)]
struct Meeting {
    keys: [u32; 2],
    cost: f32,
    points: [u32; 2],
}

/// The path from every point of the rock to the key point that reaches it first.
pub(super) struct Paths {
    /// The next point on that path; itself at a key point, [`NONE`] if unreached.
    back: Vec<u32>,
    costs: Vec<f32>,
    meetings: Vec<Meeting>,
}

impl Paths {
    pub(super) fn between(keys: &[usize], cloud: &Cloud, rock: &HostRock) -> Self {
        let mut flood = Flood::of(keys, cloud, rock);
        let mut now = 0;
        while now < flood.buckets.len() {
            let mut front = mem::take(&mut flood.buckets[now]);
            front.sort_unstable();
            front.dedup();
            front.into_iter().for_each(|point| flood.leave(point as usize, now));
            now += 1;
        }
        flood.paths
    }

    /// Lines between points that become passages.
    pub(super) fn network(&self, settings: &Karst, cloud: &Cloud, rock: &HostRock, rng: &mut Rng) -> Vec<[usize; 2]> {
        let mut used = vec![false; self.back.len()];
        let mut lines = Vec::new();
        for meeting in self.kept(settings.gamma, settings.cycles, rng) {
            let [a, b] = meeting.points.map(|point| point as usize);
            lines.push([a, b]);
            [a, b].iter().for_each(|&end| self.follow(end, usize::MAX, &mut used, &mut lines));
        }
        let mut missing = (settings.dead_ends * self.keys() as f64) as usize;
        // Tips are drawn at random; most are far from passages or in rock that is too tight.
        for _ in 0..TIPS_PER_DEAD_END * missing {
            if missing == 0 {
                break;
            }
            let tip = rng.index(self.back.len());
            let steps = 1 + rng.index(DEAD_END_STEPS).min(rng.index(DEAD_END_STEPS));
            let arrives = self.arrives(tip, steps, &used);
            if arrives && rock.tightness(cloud.point(tip)) < SOFT {
                self.follow(tip, steps, &mut used, &mut lines);
                missing -= 1;
            }
        }
        lines
    }

    /// Key points that have neighbours, or a single one.
    fn keys(&self) -> usize {
        self.meetings.iter().flat_map(|meeting| meeting.keys).max().map_or(1, |key| key as usize + 1)
    }

    /// Meetings that survive the pruning: no path via a third key point costs less with costs raised to `gamma`.
    fn kept(&self, gamma: f64, cycles: f64, rng: &mut Rng) -> Vec<Meeting> {
        let pairs: Vec<[usize; 2]> = self.meetings.iter().map(|meeting| meeting.keys.map(|key| key as usize)).collect();
        let around = Rows::from_pairs(self.keys(), pairs.iter().flat_map(|&[a, b]| [(a, b), (b, a)])).ascending();
        let raised = |meeting: &Meeting| libm::pow(f64::from(meeting.cost), gamma);
        let costs: FxHashMap<[usize; 2], f64> = pairs.iter().copied().zip(self.meetings.iter().map(raised)).collect();
        let survives = |[a, b]: [usize; 2]| {
            let detour = |&third: &usize| {
                let part = |key: usize| costs.get(&[key.min(third), key.max(third)]).copied().unwrap_or(f64::INFINITY);
                part(a) + part(b)
            };
            let shortest = around[a].iter().map(detour).fold(f64::INFINITY, f64::min);
            shortest >= costs[&[a, b]] || rng.chance(cycles)
        };
        let kept: Vec<bool> = pairs.iter().copied().map(survives).collect();
        self.meetings.iter().zip(kept).filter_map(|(meeting, kept)| kept.then_some(*meeting)).collect()
    }

    /// Walks back from a point until the path is a passage already.
    fn follow(&self, from: usize, steps: usize, used: &mut [bool], lines: &mut Vec<[usize; 2]>) {
        let mut at = from;
        for _ in 0..steps {
            let back = self.back[at] as usize;
            if mem::replace(&mut used[at], true) || back == at {
                break;
            }
            lines.push([at, back]);
            at = back;
        }
    }

    /// Whether the path back from a point outside passages meets one within this many steps.
    fn arrives(&self, tip: usize, steps: usize, used: &[bool]) -> bool {
        if used[tip] || self.back[tip] == NONE {
            return false;
        }
        let mut at = tip;
        (0..steps).any(|_| {
            at = self.back[at] as usize;
            used[at]
        })
    }
}

/// Dijkstra's algorithm with buckets as queue (Dial 1969). No edge costs less than the width of a bucket, so the points
/// of a bucket are settled and may be processed in memory order.
struct Flood<'a> {
    cloud: &'a Cloud,
    rock: &'a HostRock,
    paths: Paths,
    /// The number of the key point that reaches each point first.
    owner: Vec<u32>,
    /// Index of the meeting of two key points.
    place: FxHashMap<[u32; 2], usize>,
    buckets: Vec<Vec<u32>>,
    /// Cost range of a bucket.
    width: f32,
    near: Vec<Neighbour>,
}

impl<'a> Flood<'a> {
    fn of(keys: &[usize], cloud: &'a Cloud, rock: &'a HostRock) -> Self {
        let len = cloud.len();
        let mut paths = Paths { back: vec![NONE; len], costs: vec![f32::INFINITY; len], meetings: Vec::new() };
        let mut owner = vec![NONE; len];
        for (number, &key) in keys.iter().enumerate() {
            (paths.costs[key], paths.back[key], owner[key]) = (0.0, key as u32, number as u32);
        }
        let buckets = vec![keys.iter().map(|&key| key as u32).collect()];
        // Slightly less than the cheapest edge, because of rounding.
        let width = 0.99 * cloud.least_m() as f32;
        Self { cloud, rock, paths, owner, place: FxHashMap::default(), buckets, width, near: Vec::new() }
    }

    /// Expands a point of this bucket, unless it has been reached at lower cost since it was put there.
    fn leave(&mut self, point: usize, now: usize) {
        if self.bucket(self.paths.costs[point]) != now {
            return;
        }
        let mut near = mem::take(&mut self.near);
        self.cloud.neighbours(point, |way| self.rock.is_walkable(way), &mut near);
        for other in near.iter().map(|neighbour| neighbour.point) {
            let is_settled = self.bucket(self.paths.costs[other]) <= now;
            if !is_settled {
                self.reach(other, point);
            } else if self.owner[other] != self.owner[point] {
                self.meet(other, point);
            }
        }
        self.near = near;
    }

    fn bucket(&self, cost: f32) -> usize {
        (cost / self.width) as usize
    }

    /// Relaxes the edge from one point to another.
    fn cost(&self, point: usize, from: usize) -> f32 {
        self.paths.costs[from] + self.rock.cost(self.cloud.point(from), self.cloud.point(point)) as f32
    }

    fn reach(&mut self, point: usize, from: usize) {
        let cost = self.cost(point, from);
        if cost >= self.paths.costs[point] {
            return;
        }
        (self.paths.costs[point], self.paths.back[point]) = (cost, from as u32);
        self.owner[point] = self.owner[from];
        let bucket = self.bucket(cost);
        if bucket >= self.buckets.len() {
            self.buckets.resize_with(bucket + 1, Vec::new);
        }
        self.buckets[bucket].push(point as u32);
    }

    /// Keeps the cheapest meeting of each pair of key points.
    fn meet(&mut self, point: usize, from: usize) {
        let meeting = Meeting {
            keys: sorted([self.owner[from], self.owner[point]]),
            cost: self.cost(point, from) + self.paths.costs[point],
            points: [from as u32, point as u32],
        };
        let meetings = &mut self.paths.meetings;
        let at = *self.place.entry(meeting.keys).or_insert(meetings.len());
        match meetings.get_mut(at) {
            None => meetings.push(meeting),
            Some(known) if meeting.cost < known.cost => *known = meeting,
            Some(_) => {}
        }
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

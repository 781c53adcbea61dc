//! The cheapest ways between key points, and which of them are passages.
//!
//! All key points grow at the same cost, each into the rock that it reaches first (Dijkstra). Where the rock of two of them
//! meets, the cheapest way between the two leads over the cheapest meeting (Mehlhorn: "A faster approximation algorithm
//! for the Steiner problem in graphs", 1988). Each key point so has a few neighbours, among which ways are pruned.

use rustc_hash::FxHashMap;

use super::Karst;
use super::cloud::Cloud;
use super::rock::Rock;
use crate::graph::dice::Dice;
use crate::graph::neighbors::Neighbors;

const NONE: u32 = u32::MAX;
/// Most steps of a dead end; short ones are more.
const DEAD_END_STEPS: usize = 5;
/// Tips tried for each dead end.
const TIPS_PER_DEAD_END: usize = 60;
/// Dead ends begin in rock that is no tighter than this, so that they come in swarms and trunks stay long (tuned).
const SOFT: f64 = 0.35;

/// Where the rock of two key points meets.
#[derive(Clone, Copy)]
struct Meeting {
    keys: [u32; 2],
    cost: f32,
    points: [u32; 2],
}

/// The way from every point of the rock to the key point that reaches it first.
pub(super) struct Paths {
    /// The next point on that way; itself at a key point, [`NONE`] where none arrives.
    back: Vec<u32>,
    costs: Vec<f32>,
    meetings: Vec<Meeting>,
}

impl Paths {
    /// Dijkstra's algorithm with buckets for a queue (Dial 1969): no way between two points costs less than a bucket is
    /// wide, so that what is in one is settled and may be taken in the order of memory.
    pub(super) fn between(keys: &[usize], cloud: &Cloud, rock: &Rock) -> Self {
        let len = cloud.len();
        let mut paths = Self { back: vec![NONE; len], costs: vec![f32::INFINITY; len], meetings: Vec::new() };
        let mut owner = vec![NONE; len];
        let mut place: FxHashMap<[u32; 2], usize> = FxHashMap::default();
        // A little less than the cheapest way, for rounding.
        let width = 0.99 * cloud.least_m() as f32;
        let bucket = |cost: f32| (cost / width) as usize;
        for (number, &key) in keys.iter().enumerate() {
            (paths.costs[key], paths.back[key], owner[key]) = (0.0, key as u32, number as u32);
        }
        let mut buckets: Vec<Vec<u32>> = vec![keys.iter().map(|&key| key as u32).collect()];
        let mut near = Vec::new();
        let mut now = 0;
        while now < buckets.len() {
            let mut front = std::mem::take(&mut buckets[now]);
            front.sort_unstable();
            front.dedup();
            for point in front.into_iter().map(|point| point as usize) {
                if bucket(paths.costs[point]) != now {
                    continue;
                }
                cloud.neighbours(point, |way| rock.is_walkable(way), &mut near);
                for other in near.iter().map(|neighbour| neighbour.point) {
                    let is_settled = paths.costs[other] < f32::INFINITY && bucket(paths.costs[other]) <= now;
                    if is_settled && owner[other] == owner[point] {
                        continue;
                    }
                    let step = rock.cost(cloud.point(point), cloud.point(other));
                    let cost = paths.costs[point] + step as f32;
                    if is_settled {
                        let meeting = Meeting {
                            keys: sorted([owner[point], owner[other]]),
                            cost: cost + paths.costs[other],
                            points: [point as u32, other as u32],
                        };
                        paths.meet(meeting, &mut place);
                    } else if cost < paths.costs[other] {
                        (paths.costs[other], paths.back[other], owner[other]) = (cost, point as u32, owner[point]);
                        let next = bucket(cost);
                        if next >= buckets.len() {
                            buckets.resize_with(next + 1, Vec::new);
                        }
                        buckets[next].push(other as u32);
                    }
                }
            }
            now += 1;
        }
        paths
    }

    /// Keeps the cheapest meeting of each two key points.
    fn meet(&mut self, meeting: Meeting, place: &mut FxHashMap<[u32; 2], usize>) {
        let next = self.meetings.len();
        let at = *place.entry(meeting.keys).or_insert(next);
        if at == next {
            self.meetings.push(meeting);
        } else if meeting.cost < self.meetings[at].cost {
            self.meetings[at] = meeting;
        }
    }

    /// Lines between points that are passages.
    pub(super) fn network(&self, settings: &Karst, cloud: &Cloud, rock: &Rock, dice: &mut Dice) -> Vec<[usize; 2]> {
        let mut used = vec![false; self.back.len()];
        let mut lines = Vec::new();
        for meeting in self.kept(settings.gamma, settings.cycles, dice) {
            let [a, b] = meeting.points.map(|point| point as usize);
            lines.push([a, b]);
            [a, b].iter().for_each(|&end| self.follow(end, usize::MAX, &mut used, &mut lines));
        }
        let mut missing = (settings.dead_ends * self.keys() as f64) as usize;
        // Tips are drawn blindly; most find no passage near or rock too tight.
        for _ in 0..TIPS_PER_DEAD_END * missing {
            if missing == 0 {
                break;
            }
            let tip = dice.index(self.back.len());
            let steps = 1 + dice.index(DEAD_END_STEPS).min(dice.index(DEAD_END_STEPS));
            let arrives = self.arrives(tip, steps, &used);
            if arrives && rock.tightness(cloud.point(tip)) < SOFT {
                self.follow(tip, steps, &mut used, &mut lines);
                missing -= 1;
            }
        }
        lines
    }

    /// Key points that have neighbours, or one.
    fn keys(&self) -> usize {
        self.meetings.iter().flat_map(|meeting| meeting.keys).max().map_or(1, |key| key as usize + 1)
    }

    /// Meetings that survive: no third key point makes for a way that costs less when each part is raised to `gamma`.
    fn kept(&self, gamma: f64, cycles: f64, dice: &mut Dice) -> Vec<Meeting> {
        let pairs: Vec<[usize; 2]> = self.meetings.iter().map(|meeting| meeting.keys.map(|key| key as usize)).collect();
        let around = Neighbors::of(self.keys(), &pairs);
        let raised = |meeting: &Meeting| libm::pow(f64::from(meeting.cost), gamma);
        let costs: FxHashMap<[usize; 2], f64> = pairs.iter().copied().zip(self.meetings.iter().map(raised)).collect();
        let survives = |[a, b]: [usize; 2]| {
            let detour = |&third: &usize| {
                let part = |key: usize| costs.get(&[key.min(third), key.max(third)]).copied().unwrap_or(f64::INFINITY);
                part(a) + part(b)
            };
            let shortest = around[a].iter().map(detour).fold(f64::INFINITY, f64::min);
            shortest >= costs[&[a, b]] || dice.chance(cycles)
        };
        let kept: Vec<bool> = pairs.iter().copied().map(survives).collect();
        self.meetings.iter().zip(kept).filter_map(|(meeting, kept)| kept.then_some(*meeting)).collect()
    }

    /// Walks back from a point until the way is a passage already.
    fn follow(&self, from: usize, steps: usize, used: &mut [bool], lines: &mut Vec<[usize; 2]>) {
        let mut at = from;
        for _ in 0..steps {
            let back = self.back[at] as usize;
            if std::mem::replace(&mut used[at], true) || back == at {
                break;
            }
            lines.push([at, back]);
            at = back;
        }
    }

    /// Whether the way back from a point that is no passage meets one within so many steps.
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

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

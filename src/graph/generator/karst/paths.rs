//! The cheapest ways between key points, and which of them are passages.
//!
//! All key points grow at the same cost, each into the rock that it reaches first (Dijkstra). Where the rock of two of them
//! meets, the cheapest way between the two leads over the cheapest meeting (Mehlhorn: "A faster approximation algorithm
//! for the Steiner problem in graphs", 1988). Each key point so has a few neighbours, among which ways are pruned.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::Karst;
use super::cloud::Cloud;
use super::rock::Rock;
use crate::graph::dice::Dice;

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
    cost: f64,
    points: [u32; 2],
}

/// The way from every point of the rock to the key point that reaches it first.
pub(super) struct Paths {
    /// The next point on that way; itself at a key point, [`NONE`] where none arrives.
    back: Vec<u32>,
    costs: Vec<f64>,
    /// Points in the order in which they were reached.
    reached: Vec<u32>,
    meetings: Vec<Meeting>,
}

impl Paths {
    pub(super) fn between(keys: &[usize], cloud: &Cloud, rock: &Rock) -> Self {
        let len = cloud.points.len();
        let mut paths =
            Self { back: vec![NONE; len], costs: vec![f64::INFINITY; len], reached: Vec::new(), meetings: Vec::new() };
        let mut owner = vec![NONE; len];
        let mut settled = vec![false; len];
        let mut place: FxHashMap<[u32; 2], usize> = FxHashMap::default();
        // Costs are not negative, so their bits are in their order.
        let mut front = BinaryHeap::new();
        for (number, &key) in keys.iter().enumerate() {
            (paths.costs[key], paths.back[key], owner[key]) = (0.0, key as u32, number as u32);
            front.push(Reverse((0_u64, key as u32)));
        }
        let mut near = Vec::new();
        while let Some(Reverse((_, point))) = front.pop() {
            let point = point as usize;
            if std::mem::replace(&mut settled[point], true) {
                continue;
            }
            paths.reached.push(point as u32);
            cloud.neighbours(point, &mut near);
            for &(other, _) in &near {
                let Some(step) = rock.cost(cloud.points[point], cloud.points[other]) else { continue };
                let cost = paths.costs[point] + step;
                if settled[other] {
                    if owner[other] != owner[point] {
                        let meeting = Meeting {
                            keys: sorted([owner[point], owner[other]]),
                            cost: cost + paths.costs[other],
                            points: [point as u32, other as u32],
                        };
                        paths.meet(meeting, &mut place);
                    }
                } else if cost < paths.costs[other] {
                    (paths.costs[other], paths.back[other], owner[other]) = (cost, point as u32, owner[point]);
                    front.push(Reverse((cost.to_bits(), other as u32)));
                }
            }
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
        let keys = self.meetings.iter().flat_map(|meeting| meeting.keys).max().map_or(1, |key| key as usize + 1);
        let mut missing = (settings.dead_ends * keys as f64) as usize;
        // Tips are drawn blindly; most find no passage near or rock too tight.
        for _ in 0..TIPS_PER_DEAD_END * missing {
            let tip = self.reached[dice.index(self.reached.len())] as usize;
            let steps = 1 + dice.index(DEAD_END_STEPS).min(dice.index(DEAD_END_STEPS));
            let is_soft = rock.tightness(cloud.points[tip]) < SOFT;
            if missing > 0 && is_soft && self.follow_if_near(tip, steps, &mut used, &mut lines) {
                missing -= 1;
            }
        }
        lines
    }

    /// Meetings that survive: no third key point makes for a way that costs less when each part is raised to `gamma`.
    fn kept(&self, gamma: f64, cycles: f64, dice: &mut Dice) -> Vec<Meeting> {
        let mut costs: FxHashMap<[u32; 2], f64> = FxHashMap::default();
        let mut around: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for meeting in &self.meetings {
            costs.insert(meeting.keys, libm::pow(meeting.cost, gamma));
            let [a, b] = meeting.keys;
            around.entry(a).or_default().push(b);
            around.entry(b).or_default().push(a);
        }
        let survives = |meeting: &&Meeting| {
            let [a, b] = meeting.keys;
            let detour = |&third: &u32| {
                let part = |key: u32| costs.get(&sorted([key, third])).copied().unwrap_or(f64::INFINITY);
                part(a) + part(b)
            };
            let shortest = around[&a].iter().map(detour).fold(f64::INFINITY, f64::min);
            shortest >= costs[&meeting.keys] || dice.chance(cycles)
        };
        self.meetings.iter().filter(survives).copied().collect()
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

    /// The same for a dead end that meets a passage within so many steps; whether it does.
    fn follow_if_near(&self, tip: usize, steps: usize, used: &mut [bool], lines: &mut Vec<[usize; 2]>) -> bool {
        let mut at = tip;
        let arrives = (0..steps).any(|_| {
            at = self.back[at] as usize;
            used[at]
        });
        let is_new = arrives && !used[tip];
        if is_new {
            self.follow(tip, steps, used, lines);
        }
        is_new
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

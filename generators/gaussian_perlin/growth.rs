//! The whole walk: an origin with its first branches, then branches, loops and layers until every node is placed.

use std::f64::consts::PI;

use nalgebra::Point3;

use super::GaussianPerlin;
use super::branches::Bud;
use super::cave::{Cave, GrowingStation, PassageKind};
use super::hops::Hops;
use super::tuning::{
    DEGREE, EXTRA_CHILD, MAX_DEGREE, PATIENCE, SIDE_TRUNK, SPUR_SPLITS, THIRD_AT_ORIGIN, TRUNK_DIES, TRUNK_FIRST,
    WAKE_TRUNK,
};
use plume_graph::Graph;
use plume_graph::rng::Rng;

/// Nodes tried in search of one to wake.
const WAKE_DRAWS: usize = 64;
/// Loops closed at the end, when no nodes are left.
const LAST_LOOPS: usize = 6;

/// How much was placed, if not everything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Shortfall {
    /// Nodes in all layers that could be opened.
    pub(super) placed: usize,
    /// Links between layers.
    pub(super) links: usize,
}

/// Grows one graph.
pub(super) fn grow(settings: &GaussianPerlin, rng: Rng) -> Result<Graph, Shortfall> {
    let mut growth = Growth::new(Cave::new(settings, rng));
    growth.run();
    let cave = growth.cave;
    let is_whole = cave.room() == 0 && cave.deepest + 1 >= settings.layers;
    if !is_whole || (settings.has_links() && !cave.is_linked()) {
        return Err(Shortfall { placed: cave.stations.len(), links: cave.links.iter().map(Vec::len).sum() });
    }
    Ok(cave.into_graph())
}

/// A cave and the branches that may still grow in its deepest layer.
struct Growth<'a> {
    cave: Cave<'a>,
    trunks: Vec<Bud>,
    spurs: Vec<Bud>,
    /// Branches that may still grow in the layers above.
    above: Vec<Bud>,
    hops: Hops,
    /// First station of the deepest layer.
    layer_start: usize,
    /// Rounds until the next attempt at a loop.
    pause: u32,
    /// Number of stations when a link was last tried.
    linked_at: usize,
}

impl<'a> Growth<'a> {
    fn new(cave: Cave<'a>) -> Self {
        Self {
            cave,
            trunks: Vec::new(),
            spurs: Vec::new(),
            above: Vec::new(),
            hops: Hops::default(),
            layer_start: 0,
            pause: 0,
            linked_at: 0,
        }
    }

    fn run(&mut self) {
        self.plant();
        let mut idle = 0;
        while self.cave.room() > 0 && idle < PATIENCE {
            let progress = self.open_layer() | self.link_layers() | self.advance();
            idle = if progress { 0 } else { idle + 1 };
        }
        for _ in 0..LAST_LOOPS {
            if !self.cave.is_loop_due() || !self.cave.close_loop(&mut self.hops) {
                break;
            }
        }
    }

    /// The origin and its branches.
    fn plant(&mut self) {
        let cave = &mut self.cave;
        let radius = cave.draw_reach(cave.derived.trunk_reach, None);
        let heading_rad = cave.rng.between(0.0, 2.0 * PI);
        let position = Point3::new(0.0, 0.0, cave.surface(0.0, 0.0, 0));
        let origin = cave.add_station(GrowingStation {
            heading_rad,
            ..GrowingStation::new(position, radius, PassageKind::Trunk, 0)
        });
        let opposite = heading_rad + cave.rng.between(130.0, 230.0) * DEGREE;
        let third = cave.rng.chance(THIRD_AT_ORIGIN);
        let aside = cave.rng.sign() * cave.rng.between(60.0, 120.0) * DEGREE;
        let aside_trunk = cave.rng.chance(0.5);
        self.bud(origin, heading_rad, true);
        self.bud(origin, opposite, true);
        if third {
            self.bud(origin, heading_rad + aside, aside_trunk);
        }
    }

    fn bud(&mut self, station: usize, bearing_rad: f64, trunk: bool) {
        let buds = if trunk { &mut self.trunks } else { &mut self.spurs };
        buds.push(Bud { station, bearing_rad, trunk });
    }

    /// Opens the next layer when it is due.
    fn open_layer(&mut self) -> bool {
        if !self.cave.is_layer_due() {
            return false;
        }
        let bottom = self.cave.stations.len();
        let Some(foot) = self.cave.descend(self.layer_start) else {
            return false;
        };
        self.layer_start = bottom;
        self.above.append(&mut self.trunks);
        self.above.append(&mut self.spurs);
        let heading_rad = self.cave.stations[foot].heading_rad;
        self.bud(foot, heading_rad - 50.0 * DEGREE, true);
        self.bud(foot, heading_rad + 50.0 * DEGREE, true);
        true
    }

    /// Makes a link between layers if one is missing.
    fn link_layers(&mut self) -> bool {
        if !self.cave.settings.has_links() || self.linked_at == self.cave.stations.len() {
            return false;
        }
        self.linked_at = self.cave.stations.len();
        let upper = self.cave.unlinked(self.layer_start);
        upper.is_some_and(|upper| self.cave.link(upper, &mut self.hops))
    }

    /// Closes a loop if one is due, or grows a branch.
    fn advance(&mut self) -> bool {
        if self.pause == 0 && self.cave.is_loop_due() {
            let closed = self.cave.close_loop(&mut self.hops);
            self.pause = if closed { 0 } else { 2 };
            return closed;
        }
        self.pause = self.pause.saturating_sub(1);
        let bud = self.next_bud();
        if self.cave.stations[bud.station].degree() >= MAX_DEGREE {
            return false;
        }
        let Some(tip) = self.cave.grow(bud) else {
            return false;
        };
        self.branch(tip, bud.trunk);
        true
    }

    fn next_bud(&mut self) -> Bud {
        let rng = &mut self.cave.rng;
        let trunk_first = rng.chance(TRUNK_FIRST);
        let (trunks, spurs) = (self.trunks.len(), self.spurs.len());
        if trunks + spurs + self.above.len() == 0 {
            return self.wake();
        }
        if trunks + spurs == 0 {
            return self.above.swap_remove(rng.index(self.above.len()));
        }
        let choices = if trunk_first && trunks > 0 { trunks } else { trunks + spurs };
        let drawn = rng.index(choices);
        if drawn < trunks { self.trunks.swap_remove(drawn) } else { self.spurs.swap_remove(drawn - trunks) }
    }

    /// A new branch from a node inside a passage, when no branch is alive.
    fn wake(&mut self) -> Bud {
        let station = self.wakeable();
        let cave = &mut self.cave;
        let aside = cave.rng.sign() * cave.rng.between(60.0, 110.0) * DEGREE;
        let end = cave.stations[station].degree() < 2;
        Bud {
            station,
            bearing_rad: cave.stations[station].heading_rad + if end { 0.0 } else { aside },
            trunk: cave.rng.chance(WAKE_TRUNK),
        }
    }

    /// The children at the end of a branch.
    fn branch(&mut self, tip: usize, trunk: bool) {
        let children = self.children(trunk);
        if children == 0 {
            self.cave.stations[tip].alive = false;
            return;
        }
        let heading_rad = self.cave.stations[tip].heading_rad;
        let rng = &mut self.cave.rng;
        let side = rng.sign();
        let mut turn = |low: f64, high: f64| side * rng.between(low, high) * DEGREE;
        if trunk {
            let ahead = heading_rad - turn(0.0, 25.0);
            let aside = heading_rad + turn(55.0, 100.0);
            let beyond = heading_rad - turn(70.0, 105.0);
            let aside_trunk = self.cave.rng.chance(SIDE_TRUNK);
            let buds = [(ahead, true), (aside, aside_trunk), (beyond, false)];
            for &(bearing_rad, trunk) in &buds[..children] {
                self.bud(tip, bearing_rad, trunk);
            }
        } else {
            let split = turn(25.0, 50.0);
            for &bearing_rad in &[heading_rad - split, heading_rad + split][..children] {
                self.bud(tip, bearing_rad, false);
            }
        }
    }

    /// How many branches continue where one ends.
    fn children(&mut self, trunk: bool) -> usize {
        let rng = &mut self.cave.rng;
        let least = self.cave.settings.children_min as usize;
        let most = self.cave.settings.children_max as usize;
        if !trunk {
            let splits = rng.chance(SPUR_SPLITS);
            return if splits { most.min(2) } else { 0 };
        }
        if rng.chance(TRUNK_DIES) {
            return 0;
        }
        let extra = (least..most).filter(|_| rng.chance(EXTRA_CHILD)).count();
        least + extra
    }

    /// A station inside a passage of the deepest layer, or any station if there is none.
    fn wakeable(&mut self) -> usize {
        let cave = &mut self.cave;
        let deep = cave.stations.len() - self.layer_start;
        let drawn = (0..WAKE_DRAWS).map(|_| self.layer_start + cave.rng.index(deep));
        let open = drawn.into_iter().find(|&drawn| {
            let station = &cave.stations[drawn];
            station.degree() == 2 && matches!(station.kind, PassageKind::Trunk | PassageKind::Spur)
        });
        open.unwrap_or_else(|| cave.rng.index(cave.stations.len()))
    }
}

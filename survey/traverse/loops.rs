//! Closing loops: sparse weighted least squares.
//!
//! Stations on dead ends move with the station they hang on. The rest is reduced like a network of resistors: a station with
//! few neighbours is replaced by direct connections between them (series, parallel and star-mesh transforms, with matrices
//! for resistances), which is Gaussian elimination and exact. For most caves that leaves nothing; a dense remainder is
//! solved by conjugate gradients, whose residual is checked, a large one with a coarse correction.

use std::collections::VecDeque;

use nalgebra::{Matrix3, Vector3};

use super::coarse::Coarse;
use super::{Shot, Tree, stars};

/// Stations with at most this many neighbours are eliminated. Tuned: with fewer, mazes take many iterations, with more,
/// memory grows.
const MOST_NEIGHBORS: usize = 8;
/// Number of passes over all stations in search of ones that have become eliminable.
const SWEEPS: usize = 32;
/// Limit on the work of conjugate gradients, in couplings. Tuned: a grid maze of 100,000 shots takes half.
const WORK: usize = 500_000_000;
/// Number of stations from which a coarse correction pays off. Tuned.
const COARSE_FROM: usize = 4_000;
/// Relative norm of the residual at which the iteration stops.
const GOAL: f64 = 1e-8;
/// Relative norm of the residual that is accepted: a millimetre in a kilometre.
const BEARABLE: f64 = 1e-6;

impl Shot {
    fn other_end(&self, station: usize) -> usize {
        if self.ends[0] == station { self.ends[1] } else { self.ends[0] }
    }
}

/// The stations that loops can move, and the shots between them and to fixed ones.
pub(super) struct Core {
    /// The index of a station among the movable ones.
    place: Vec<Option<usize>>,
    count: usize,
    shots: Vec<usize>,
}

impl Core {
    /// `None` if all shots are part of the tree.
    pub(super) fn of(shots: &[Shot], tree: &Tree) -> Option<Self> {
        let count = tree.positions.len();
        let loose = shots.iter().filter(|shot| shot.ends[0] != shot.ends[1]).count();
        if loose == tree.reached_by.iter().flatten().count() {
            return None;
        }
        let at = stars(count, shots);
        let mut degree: Vec<usize> = at.iter().map(<[usize]>::len).collect();
        let mut gone = vec![false; shots.len()];
        let is_end = |degree: &[usize], station: usize| degree[station] == 1 && !tree.is_root(station);
        let mut ends: Vec<usize> = (0..count).filter(|&station| is_end(&degree, station)).collect();
        while let Some(end) = ends.pop() {
            let Some(&index) = at[end].iter().find(|&&index| !gone[index]) else { continue };
            gone[index] = true;
            degree[end] = 0;
            let foot = shots[index].other_end(end);
            degree[foot] -= 1;
            if is_end(&degree, foot) {
                ends.push(foot);
            }
        }
        let mut core = Self { place: vec![None; count], count: 0, shots: Vec::new() };
        core.shots =
            (0..shots.len()).filter(|&index| !gone[index] && shots[index].ends[0] != shots[index].ends[1]).collect();
        for station in (0..count).filter(|&station| degree[station] > 0 && !tree.is_root(station)) {
            core.place[station] = Some(core.count);
            core.count += 1;
        }
        Some(core)
    }

    /// The displacement of each station that closes the loops, `None` if they cannot be closed.
    pub(super) fn corrections(&self, shots: &[Shot], tree: &Tree) -> Option<Vec<Vector3<f64>>> {
        let mut network = Network::of(self, shots, tree)?;
        network.eliminate(MOST_NEIGHBORS);
        let rest = network.solve()?;
        let mut corrections = vec![Vector3::zeros(); tree.positions.len()];
        for &station in &tree.order {
            let Some(index) = tree.reached_by[station] else { continue };
            corrections[station] = match self.place[station] {
                Some(place) => rest[place],
                None => corrections[shots[index].other_end(station)],
            };
        }
        Some(corrections)
    }
}

/// A coupled station, and the off-diagonal block of the normal equations.
pub(super) type Block = (usize, Matrix3<f64>);

/// The normal equations: coupled stations, and a right-hand side.
///
/// The block of `a` on `b` is the transpose of that of `b` on `a`. The sum of the blocks on a station is its diagonal
/// block, so that no difference of large numbers is ever taken.
pub(super) struct Network {
    blocks: Vec<Vec<Block>>,
    rhs: Vec<Vector3<f64>>,
    /// Most neighbours; parallel connections count separately.
    degree: Vec<usize>,
    /// Inverse diagonal blocks of eliminated stations, and their order.
    inverse: Vec<Option<Matrix3<f64>>>,
    order: Vec<usize>,
}

impl Network {
    /// Uncoupled stations.
    pub(super) fn new(count: usize) -> Self {
        Self {
            blocks: vec![Vec::new(); count],
            rhs: vec![Vector3::zeros(); count],
            degree: vec![0; count],
            inverse: vec![None; count],
            order: Vec::new(),
        }
    }

    /// Couples a station to another, or to the fixed ones, whose index comes after all others.
    pub(super) fn block(&mut self, here: usize, there: usize, block: Matrix3<f64>) {
        self.blocks[here].push((there, block));
        self.degree[here] += 1;
    }

    fn of(core: &Core, shots: &[Shot], tree: &Tree) -> Option<Self> {
        let count = core.count;
        let mut network = Self::new(count);
        for &index in &core.shots {
            let shot = &shots[index];
            let weight = shot.covariance.try_inverse()?;
            let [from, to] = shot.ends;
            let misclosure = shot.vector - (tree.positions[to] - tree.positions[from]);
            let weighted = weight * misclosure;
            let places = [from, to].map(|end| core.place[end].unwrap_or(count));
            for (here, there, weighted) in [(places[0], places[1], -weighted), (places[1], places[0], weighted)] {
                if here < count {
                    network.block(here, there, weight);
                    network.rhs[here] += weighted;
                }
            }
        }
        Some(network)
    }

    /// Drops eliminated stations from the blocks of a station and adds up blocks of the same neighbour.
    fn tidy(&mut self, station: usize) {
        let mut blocks = std::mem::take(&mut self.blocks[station]);
        blocks.retain(|&(other, _)| other == self.inverse.len() || self.inverse[other].is_none());
        blocks.sort_by_key(|&(other, _)| other);
        blocks.dedup_by(|(other, more), (kept, block)| {
            let same = other == kept;
            if same {
                *block += *more;
            }
            same
        });
        self.degree[station] = blocks.len();
        self.blocks[station] = blocks;
    }

    /// The stations that are not eliminated.
    fn left(&self) -> Vec<usize> {
        (0..self.blocks.len()).filter(|&station| self.inverse[station].is_none()).collect()
    }

    fn diagonal(&self, station: usize) -> Matrix3<f64> {
        self.blocks[station].iter().map(|(_, block)| block).sum()
    }

    /// Eliminates stations with at most this many neighbours, fewest first, as long as there are any.
    pub(super) fn eliminate(&mut self, most_neighbors: usize) {
        for _ in 0..SWEEPS {
            let mut queues = vec![VecDeque::new(); most_neighbors + 1];
            for station in
                (0..self.blocks.len()).rev().filter(|&station| self.inverse[station].is_none()).collect::<Vec<_>>()
            {
                self.tidy(station);
                self.enqueue(station, &mut queues);
            }
            if queues.iter().all(VecDeque::is_empty) {
                return;
            }
            while let Some(queue) = queues.iter().position(|queue| !queue.is_empty()) {
                let Some(station) = queues[queue].pop_front() else { continue };
                if self.inverse[station].is_some() {
                    continue;
                }
                self.tidy(station);
                if self.degree[station] > queue {
                    self.enqueue(station, &mut queues);
                } else {
                    self.drop(station, &mut queues);
                }
            }
        }
    }

    fn enqueue(&self, station: usize, queues: &mut [VecDeque<usize>]) {
        if let Some(queue) = queues.get_mut(self.degree[station]) {
            queue.push_back(station);
        }
    }

    /// Replaces a station by connections between its neighbours.
    fn drop(&mut self, station: usize, queues: &mut [VecDeque<usize>]) {
        let Some(inverse) = self.diagonal(station).try_inverse() else { return };
        let blocks = std::mem::take(&mut self.blocks[station]);
        let count = self.inverse.len();
        for &(here, block) in blocks.iter().filter(|&&(here, _)| here < count) {
            let passed_on = block.transpose() * inverse;
            let weighted = passed_on * self.rhs[station];
            self.rhs[here] += weighted;
            self.make_room(here, blocks.len());
            let through = blocks.iter().filter(|&&(there, _)| there != here);
            self.blocks[here].extend(through.map(|&(there, block)| (there, passed_on * block)));
            self.degree[here] = self.degree[here] + blocks.len() - 2;
            self.enqueue(here, queues);
        }
        self.blocks[station] = blocks;
        self.inverse[station] = Some(inverse);
        self.order.push(station);
    }

    /// Makes room for more blocks, by tidying if that is enough, so that memory is proportional to what is left.
    fn make_room(&mut self, station: usize, more: usize) {
        if self.blocks[station].len() + more > self.blocks[station].capacity() {
            self.tidy(station);
            let now = self.blocks[station].len();
            self.blocks[station].reserve(now + more);
        }
    }

    /// Whether all stations are eliminated.
    pub(super) fn is_eliminated(&self) -> bool {
        self.order.len() == self.blocks.len()
    }

    /// The corrections of all eliminated stations for this right-hand side.
    pub(super) fn solved(&self, mut rhs: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
        let passed_on = |station: usize, weighted: Vector3<f64>| {
            self.inverse[station].map_or(weighted, |inverse| inverse * weighted)
        };
        for &station in &self.order {
            let weighted = passed_on(station, rhs[station]);
            for &(here, block) in self.blocks[station].iter().filter(|&&(here, _)| here < self.blocks.len()) {
                rhs[here] += block.transpose() * weighted;
            }
        }
        rhs.push(Vector3::zeros());
        for &station in self.order.iter().rev() {
            let held: Vector3<f64> = self.blocks[station].iter().map(|(other, block)| block * rhs[*other]).sum();
            rhs[station] = passed_on(station, rhs[station] + held);
        }
        rhs
    }

    /// The solution of the system.
    fn solve(mut self) -> Option<Vec<Vector3<f64>>> {
        let count = self.blocks.len();
        let mut rest = vec![Vector3::zeros(); count + 1];
        let left = self.left();
        for &station in &left {
            self.tidy(station);
        }
        self.descend(&left, &mut rest)?;
        for &station in self.order.iter().rev() {
            let held: Vector3<f64> = self.blocks[station].iter().map(|(other, block)| block * rest[*other]).sum();
            rest[station] = self.inverse[station]? * (self.rhs[station] + held);
        }
        rest.iter().all(|by| by.iter().all(|x| x.is_finite())).then_some(rest)
    }

    /// Conjugate gradients (Hestenes & Stiefel 1952) for the remaining stations, preconditioned by their diagonal blocks,
    /// and for many stations by a [coarse correction](Coarse).
    fn descend(&mut self, left: &[usize], rest: &mut [Vector3<f64>]) -> Option<()> {
        let diagonals: Vec<Matrix3<f64>> = left.iter().map(|&station| self.diagonal(station)).collect();
        let inverses: Option<Vec<Matrix3<f64>>> = diagonals.iter().map(|block| block.try_inverse()).collect();
        let inverses = inverses?;
        let rounds = WORK / left.iter().map(|&station| self.blocks[station].len()).sum::<usize>().max(1);
        let firm: Vec<Matrix3<f64>> = left.iter().map(|&station| self.firm_hold(station)).collect();
        let blocks = self.take_blocks_between(left);
        let coarse = if left.len() < COARSE_FROM { None } else { Coarse::of(&blocks, &firm) };
        let eased = |residual: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
            let mut eased: Vec<Vector3<f64>> =
                inverses.iter().zip(residual).map(|(inverse, residual)| inverse * residual).collect();
            if let Some(coarse) = &coarse {
                coarse.add_corrections(residual, &mut eased);
            }
            eased
        };
        let mut residual: Vec<Vector3<f64>> = left.iter().map(|&station| self.rhs[station]).collect();
        let mut way = eased(&residual);
        let mut error = dot(&residual, &way);
        let start = error;
        for _ in 0..rounds {
            if error <= GOAL * GOAL * start {
                return Some(());
            }
            let pull = |(index, blocks): (usize, &Vec<Block>)| {
                let held: Vector3<f64> = blocks.iter().map(|(other, block)| block * way[*other]).sum();
                diagonals[index] * way[index] - held
            };
            let pulls: Vec<Vector3<f64>> = blocks.iter().enumerate().map(pull).collect();
            let step = error / dot(&way, &pulls);
            for (index, &station) in left.iter().enumerate() {
                rest[station] += way[index] * step;
                residual[index] -= pulls[index] * step;
            }
            let next = eased(&residual);
            let before = std::mem::replace(&mut error, dot(&residual, &next));
            let share = error / before;
            way.iter_mut().zip(next).for_each(|(way, next)| *way = next + *way * share);
        }
        (error <= BEARABLE * BEARABLE * start).then_some(())
    }

    /// The coupling of a station to the fixed ones.
    fn firm_hold(&self, station: usize) -> Matrix3<f64> {
        self.blocks[station].iter().filter(|&&(other, _)| other == self.blocks.len()).map(|(_, block)| block).sum()
    }

    /// Takes out the blocks between some stations, by their indices among them.
    fn take_blocks_between(&mut self, stations: &[usize]) -> Vec<Vec<Block>> {
        let mut place = vec![None; self.blocks.len() + 1];
        stations.iter().enumerate().for_each(|(index, &station)| place[station] = Some(index));
        let taken = stations.iter().map(|&station| std::mem::take(&mut self.blocks[station]));
        taken
            .map(|blocks| blocks.into_iter().filter_map(|(other, block)| Some((place[other]?, block))).collect())
            .collect()
    }
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

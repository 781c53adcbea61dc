//! Attractors: which station each of them pulls, and which of them are removed.

use nalgebra::{Point3, Vector3};

use crate::network::{Cells, Network};

struct Attractor {
    at: Point3<f64>,
    /// The nearest station within its influence, and its distance.
    nearest: Option<(usize, f64)>,
    is_taken: bool,
}

/// All attractors, and those that are active.
pub(super) struct Attractors {
    attractors: Vec<Attractor>,
    cells: Cells<u32>,
    pulling: Vec<u32>,
    kill_m: f64,
    influence_m: f64,
    /// Sum of the pulls on each station; zero except while they are summed.
    sums: Vec<Vector3<f64>>,
}

impl Attractors {
    pub(super) fn new(places: Vec<Point3<f64>>, [kill_m, influence_m]: [f64; 2]) -> Self {
        let mut cells = Cells::new(influence_m);
        places.iter().enumerate().for_each(|(index, at)| cells.add(index as u32, [at; 2]));
        let attractors = places.into_iter().map(|at| Attractor { at, nearest: None, is_taken: false }).collect();
        Self { attractors, cells, pulling: Vec::new(), kill_m, influence_m, sums: Vec::new() }
    }

    /// Removes the attractors near a new station, and assigns others to it.
    pub(super) fn meet(&mut self, station: usize, at: &Point3<f64>) {
        self.sums.resize(station + 1, Vector3::zeros());
        let near: Vec<u32> = self.cells.near([at; 2], self.influence_m).collect();
        for index in near {
            let attractor = &mut self.attractors[index as usize];
            let apart = (attractor.at - at).norm();
            if apart <= self.kill_m {
                attractor.is_taken = true;
                self.cells.remove(index, [&attractor.at; 2]);
            } else if apart <= attractor.nearest.map_or(self.influence_m, |(_, nearest)| nearest) {
                if attractor.nearest.is_none() {
                    self.pulling.push(index);
                }
                attractor.nearest = Some((station, apart));
            }
        }
    }

    /// The mean unit direction in which each station is pulled, in the order of the stations.
    pub(super) fn pulls(&mut self, network: &Network) -> Vec<(usize, Vector3<f64>)> {
        let attractors = &self.attractors;
        self.pulling
            .retain(|&index| !attractors[index as usize].is_taken && attractors[index as usize].nearest.is_some());
        let mut pulled = Vec::new();
        for &index in &self.pulling {
            let attractor = &self.attractors[index as usize];
            let Some((station, apart)) = attractor.nearest else { continue };
            if self.sums[station] == Vector3::zeros() {
                pulled.push(station);
            }
            self.sums[station] += (attractor.at - network.position(station)) / apart;
        }
        pulled.sort_unstable();
        pulled.dedup();
        let sums = &mut self.sums;
        let mut mean =
            |station: usize| std::mem::take(&mut sums[station]).try_normalize(1e-9).unwrap_or_else(Vector3::x);
        pulled.into_iter().map(|station| (station, mean(station))).collect()
    }

    /// Detaches the attractors of a station that cannot grow, until another one comes near them.
    pub(super) fn give_up(&mut self, station: usize) {
        for &index in &self.pulling {
            let attractor = &mut self.attractors[index as usize];
            attractor.nearest = attractor.nearest.filter(|&(nearest, _)| nearest != station);
        }
    }
}

//! Computes the positions of stations from shots.
//!
//! Every piece of a survey is laid out along a spanning tree from its fixed stations, or from its first station if nothing is
//! fixed. The misclosures of the other shots are then distributed by least squares, weighted by the covariances of shots,
//! which is how Survex closes loops (Betts: "Loop closure", Compass Points 1995–2000). [`loops`] solves that.
//!
//! Promised: a shot that is neither in a loop nor on a path between two fixed stations keeps its vector; a consistent survey
//! is not changed; the same shots give the same bits. Blunders are not detected.

mod coarse;
mod loops;

use std::collections::VecDeque;

use loops::Core;
use nalgebra::{Matrix3, Point3, Vector3};

use plume_graph::Rows;

/// A measured vector from one station to another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shot {
    pub(super) ends: [usize; 2],
    /// East, north, up, in metres.
    pub(super) vector: Vector3<f64>,
    /// Covariance of the vector, in square metres.
    pub(super) covariance: Matrix3<f64>,
}

/// A fixed station.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fix {
    pub(super) station: usize,
    pub(super) position: Point3<f64>,
    /// Covariance of the position, in square metres; `None` if it is exact.
    pub(super) covariance: Option<Matrix3<f64>>,
}

/// Standard deviations of the components of a shot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Accuracy {
    pub(super) length_m: f64,
    pub(super) bearing_rad: f64,
    pub(super) gradient_rad: f64,
    /// Of plumbed shots, from the vertical.
    pub(super) plumb_rad: f64,
    /// Distance of the instrument from the station.
    pub(super) position_m: f64,
}

/// BCRA grade 5, the default of Survex: its limits are taken as two standard deviations.
impl Default for Accuracy {
    fn default() -> Self {
        Self {
            length_m: 0.05,
            bearing_rad: 0.5_f64.to_radians(),
            gradient_rad: 0.5_f64.to_radians(),
            plumb_rad: 0.25_f64.to_radians(),
            position_m: 0.05,
        }
    }
}

/// Smallest standard deviation of a shot, in metres: with less, loops could not be solved.
const LEAST_SPREAD_M: f64 = 1e-3;

impl Accuracy {
    /// The covariance of a shot with this vector, measured by tape, compass and clino.
    pub(super) fn covariance(&self, vector: &Vector3<f64>) -> Matrix3<f64> {
        let (length, plan) = (vector.norm(), vector.xy().norm());
        let station = self.station();
        if plan <= 1e-6 * length || length == 0.0 {
            let aside = square(length * self.plumb_rad);
            return station + Matrix3::from_diagonal(&Vector3::new(aside, aside, square(self.length_m)));
        }
        let along = vector / length * self.length_m;
        let across = Vector3::new(vector.y, -vector.x, 0.0) * self.bearing_rad;
        let sine = vector.z / plan;
        let over = Vector3::new(-vector.x * sine, -vector.y * sine, plan) * self.gradient_rad;
        station + along * along.transpose() + across * across.transpose() + over * over.transpose()
    }

    /// The variance of the stations themselves, isotropic.
    pub(super) fn station(&self) -> Matrix3<f64> {
        Matrix3::identity() * (square(self.position_m) / 3.0).max(square(LEAST_SPREAD_M))
    }
}

fn square(x: f64) -> f64 {
    x * x
}

/// Stations, shots and fixes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Traverse {
    pub(super) stations: usize,
    pub(super) shots: Vec<Shot>,
    /// At most one for each station.
    pub(super) fixes: Vec<Fix>,
}

/// Vertical distance between disconnected pieces, in metres.
const APART_M: f64 = 10_000.0;

/// The positions of stations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) positions: Vec<Point3<f64>>,
    /// The first station of each piece without a fix. The first piece is at the origin if nothing is fixed, each further one
    /// [`APART_M`] lower, so that no two stations coincide.
    pub(super) adrift: Vec<usize>,
    /// The piece of each station, as a place in `adrift`; `None` if its piece is fixed.
    pub(super) piece_of: Vec<Option<usize>>,
}

/// The stations as a spanning tree: each after the one it is reached from.
struct Tree {
    order: Vec<usize>,
    /// The shot by which a station is reached; none for roots.
    reached_by: Vec<Option<usize>>,
    positions: Vec<Vector3<f64>>,
    adrift: Vec<usize>,
    piece_of: Vec<Option<usize>>,
}

impl Traverse {
    /// The positions, or `None` if the loops cannot be closed because the weights differ too much.
    pub(super) fn place(mut self) -> Option<Placed> {
        self.tie_soft_fixes();
        let mut tree = self.tree();
        if let Some(core) = Core::of(&self.shots, &tree) {
            let corrections = core.corrections(&self.shots, &tree)?;
            tree.positions.iter_mut().zip(corrections).for_each(|(position, by)| *position += by);
        }
        tree.positions.truncate(self.stations);
        tree.piece_of.truncate(self.stations);
        let positions = tree.positions.into_iter().map(Point3::from).collect();
        Some(Placed { positions, adrift: tree.adrift, piece_of: tree.piece_of })
    }

    /// Adds a shot from a virtual station, which comes after all others, to each station that is fixed inexactly.
    fn tie_soft_fixes(&mut self) {
        let soft = self.fixes.iter().filter_map(|fix| {
            let covariance = fix.covariance?;
            Some(Shot { ends: [self.stations, fix.station], vector: fix.position.coords, covariance })
        });
        self.shots.extend(soft);
    }

    fn tree(&self) -> Tree {
        let count = self.stations + 1;
        let at = stars(count, &self.shots);
        let mut tree = Tree {
            order: Vec::with_capacity(count),
            reached_by: vec![None; count],
            positions: vec![Vector3::zeros(); count],
            adrift: Vec::new(),
            piece_of: vec![None; count],
        };
        let mut seen = vec![false; count];
        let mut roots: VecDeque<usize> = VecDeque::new();
        for fix in self.fixes.iter().filter(|fix| fix.covariance.is_none()) {
            tree.positions[fix.station] = fix.position.coords;
            roots.push_back(fix.station);
        }
        roots.push_back(self.stations);
        roots.iter().for_each(|&root| seen[root] = true);
        tree.grow(roots, &self.shots, &at, &mut seen);
        for root in 0..self.stations {
            if !seen[root] {
                seen[root] = true;
                let pieces = tree.adrift.len() + usize::from(!self.fixes.is_empty());
                tree.positions[root].z = 0.0 - APART_M * pieces as f64;
                let begun = tree.order.len();
                tree.grow(VecDeque::from([root]), &self.shots, &at, &mut seen);
                for &station in &tree.order[begun..] {
                    tree.piece_of[station] = Some(tree.adrift.len());
                }
                tree.adrift.push(root);
            }
        }
        tree
    }
}

impl Tree {
    /// Extends the tree to all stations reachable from these.
    fn grow(&mut self, mut tips: VecDeque<usize>, shots: &[Shot], at: &Rows<usize>, seen: &mut [bool]) {
        while let Some(tip) = tips.pop_front() {
            self.order.push(tip);
            for &index in &at[tip] {
                let Shot { ends: [from, to], vector, .. } = shots[index];
                let (next, way) = if from == tip { (to, vector) } else { (from, -vector) };
                if !seen[next] {
                    seen[next] = true;
                    self.reached_by[next] = Some(index);
                    self.positions[next] = self.positions[tip] + way;
                    tips.push_back(next);
                }
            }
        }
    }

    fn is_root(&self, station: usize) -> bool {
        self.reached_by[station].is_none()
    }
}

/// The shots at each station.
fn stars(count: usize, shots: &[Shot]) -> Rows<usize> {
    let at_ends = shots.iter().enumerate().flat_map(|(index, shot)| shot.ends.map(|end| (end, index)));
    Rows::from_pairs(count, at_ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shot(from: usize, to: usize, vector: [f64; 3]) -> Shot {
        let vector = Vector3::from(vector);
        Shot { ends: [from, to], vector, covariance: Accuracy::default().covariance(&vector) }
    }

    fn exactly(station: usize, position: [f64; 3]) -> Fix {
        Fix { station, position: position.into(), covariance: None }
    }

    /// The residual of the least squares: the force on each station, relative to its greatest component.
    fn residual(traverse: &Traverse, placed: &Placed) -> f64 {
        let mut pulls = vec![Vector3::zeros(); traverse.stations];
        let mut greatest: f64 = 0.0;
        for shot in &traverse.shots {
            let [from, to] = shot.ends;
            let misclosure = shot.vector - (placed.positions[to] - placed.positions[from]);
            let pull = shot.covariance.try_inverse().unwrap() * misclosure;
            greatest = greatest.max(pull.norm());
            pulls[from] -= pull;
            pulls[to] += pull;
        }
        traverse.fixes.iter().for_each(|fix| pulls[fix.station] = Vector3::zeros());
        placed.adrift.iter().for_each(|&station| pulls[station] = Vector3::zeros());
        pulls.iter().fold(0.0_f64, |most, pull| most.max(pull.norm())) / greatest.max(1e-300)
    }

    /// A maze of `side` by `side` junctions, measured with periodic errors.
    fn maze(side: usize) -> Traverse {
        let mut traverse = Traverse { stations: side * side, ..Traverse::default() };
        let error = |n: usize| (n * 7919 % 101) as f64 / 500.0 - 0.1;
        for station in 0..side * side {
            if station % side + 1 < side {
                traverse.shots.push(shot(station, station + 1, [10.0 + error(station), error(station + 1), error(3)]));
            }
            if station / side + 1 < side {
                traverse.shots.push(shot(station + side, station, [error(station), -8.0, error(station + 2)]));
            }
        }
        traverse
    }

    #[test]
    fn dead_ends_and_agreeing_loops_are_exact() {
        let shots = vec![
            shot(0, 1, [3.0, 0.0, 0.0]),
            shot(2, 1, [0.0, -4.0, 0.0]),
            shot(2, 0, [-3.0, -4.0, 0.0]),
            shot(3, 2, [0.25, 0.5, 8.0]),
        ];
        let traverse = Traverse { stations: 4, shots, fixes: vec![exactly(3, [100.0, 200.0, 300.0])] };
        let placed = traverse.place().unwrap();
        assert_eq!(placed.positions[2], Point3::new(100.25, 200.5, 308.0));
        assert_eq!(placed.positions[0], Point3::new(97.25, 196.5, 308.0));
        assert!(placed.adrift.is_empty());
    }

    /// The figures are those of cavern 1.4.4 for the same shots between two fixed stations.
    #[test]
    fn a_misclosure_is_distributed_as_in_survex() {
        let polar = |length: f64, bearing: f64, gradient: f64| {
            let (bearing, gradient) = (bearing.to_radians(), gradient.to_radians());
            let plan = length * libm::cos(gradient);
            [plan * libm::sin(bearing), plan * libm::cos(bearing), length * libm::sin(gradient)]
        };
        let shots = vec![shot(0, 1, polar(100.0, 30.0, 20.0)), shot(1, 2, polar(80.0, 130.0, -10.0))];
        let fixes = vec![exactly(0, [0.0; 3]), exactly(2, [150.0, 20.0, 30.0])];
        let placed = Traverse { stations: 3, shots, fixes }.place().unwrap();
        let off = placed.positions[1] - Point3::new(80.08, 61.80, 35.52);
        assert!(off.amax() < 0.0051, "{off}");
    }

    #[test]
    fn every_station_of_a_maze_is_in_equilibrium() {
        for side in [3, 12, 60] {
            let traverse = maze(side);
            let placed = traverse.clone().place().unwrap();
            let residual = residual(&traverse, &placed);
            assert!(residual < 1e-6, "{side}: {residual}");
        }
    }

    /// Conjugate gradients alone do not converge here.
    #[test]
    fn a_large_maze_converges_with_a_coarse_grid() {
        let traverse = maze(300);
        let placed = traverse.clone().place().unwrap();
        let residual = residual(&traverse, &placed);
        assert!(residual < 1e-6, "{residual}");
    }

    #[test]
    fn an_inexact_fix_moves_and_an_exact_one_does_not() {
        let way = shot(0, 1, [10.0, 0.0, 0.0]);
        let soft = Fix { station: 1, position: [10.4, 0.0, 0.0].into(), covariance: Some(way.covariance) };
        let fixes = vec![exactly(0, [0.0; 3]), soft];
        let placed = Traverse { stations: 2, shots: vec![way], fixes }.place().unwrap();
        assert_eq!(placed.positions[0], Point3::origin());
        assert!((placed.positions[1].x - 10.2).abs() < 1e-9, "{}", placed.positions[1]);
    }

    #[test]
    fn floating_pieces_are_kept_apart() {
        let shots = vec![shot(1, 0, [1.0, 2.0, 3.0]), shot(3, 2, [4.0, 5.0, 6.0]), shot(2, 2, [1.0, 0.0, 0.0])];
        let placed = Traverse { stations: 4, shots, fixes: vec![exactly(0, [9.0; 3])] }.place().unwrap();
        assert_eq!(placed.positions[1], Point3::new(8.0, 7.0, 6.0));
        let apart = [Point3::new(0.0, 0.0, -APART_M), Point3::new(-4.0, -5.0, -6.0 - APART_M)];
        assert_eq!(placed.positions[2..], apart);
        assert_eq!(placed.adrift, [2]);
        assert_eq!(placed.piece_of, [None, None, Some(0), Some(0)]);
    }

    /// Hubs with many connections between them, for which naive elimination takes quadratic time.
    #[test]
    fn hubs_are_solved() {
        let many = 20_000;
        let mut traverse = Traverse { stations: many + 2, ..Traverse::default() };
        for way in 0..many {
            let out = way as f64 / many as f64;
            traverse.shots.push(shot(0, way + 2, [5.0, out, 0.0]));
            traverse.shots.push(shot(1, way + 2, [-5.0, out, 0.1]));
        }
        let placed = traverse.clone().place().unwrap();
        assert!((placed.positions[1] - Point3::new(10.0, 0.0, -0.1)).norm() < 1e-9, "{}", placed.positions[1]);
        assert!(residual(&traverse, &placed) < 1e-9);
    }
}

//! Points scattered through the rock, no two of them near each other, more of them on the horizons.

use nalgebra::Point3;

use super::Karst;
use super::rock::Rock;
use crate::graph::dice::Dice;

/// Points are thrown so many times for each cell of the grid (tuned: more of them find no room).
const THROWS_PER_CELL: f64 = 2.5;
/// Part of them that is thrown at a horizon.
const ON_HORIZON: f64 = 0.7;
/// Heights count so much more than lengths: beds are thin.
const FLATNESS: f64 = 2.0;
/// How far off its horizon a point may lie, in metres.
const BED_M: f64 = 0.6;
/// Neighbours lie within so many distances between points, stretched as heights are.
const REACH: f64 = 2.0;
/// Neighbours of a point at most.
const NEIGHBOURS: usize = 16;

/// The points and a grid over them whose cells are as large as points are apart.
pub(super) struct Cloud {
    /// By their height over the dipping plane, cell by cell.
    pub(super) points: Vec<Point3<f64>>,
    /// Where the points of each cell start, and the end of the last ones.
    starts: Vec<u32>,
    grid: Grid,
}

impl Cloud {
    /// Throws points and keeps those that have room (dart throwing: Cook, "Stochastic sampling in computer graphics",
    /// 1986).
    pub(super) fn scatter(settings: &Karst, rock: &Rock, side_m: f64, dice: &mut Dice) -> Self {
        let [bottom, top] = rock.extremes();
        let mut thrown = Thrown::over(Grid::new(settings.sample_spacing_m, side_m, [bottom - BED_M, top + BED_M]));
        for _ in 0..(THROWS_PER_CELL * thrown.heads.len() as f64) as usize {
            let [x, y] = [0, 1].map(|_| dice.between(-0.5, 0.5) * side_m);
            let z = if dice.chance(ON_HORIZON) {
                rock.some_horizon(dice) + dice.between(-BED_M, BED_M)
            } else {
                dice.between(bottom, top)
            };
            thrown.offer(Point3::new(x, y, z));
        }
        thrown.settled()
    }

    /// Points in the cells at most `reach` away, each with the square of its stretched distance.
    fn near(&self, point: Point3<f64>, reach: usize) -> impl Iterator<Item = (usize, f64)> {
        let rows = self.grid.rows(point, reach).map(|[first, last]| {
            let [start, end] = [self.starts[first], self.starts[last + 1]];
            start as usize..end as usize
        });
        rows.flatten().map(move |other| (other, square(self.points[other], point)))
    }

    /// The point nearest to a place, or the first one far from all.
    pub(super) fn nearest(&self, [x, y]: [f64; 2], z: f64) -> usize {
        let place = Point3::new(x, y, z);
        let within = |reach| self.near(place, reach).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        [1, 3, 9].into_iter().find_map(within).map_or(0, |(point, _)| point)
    }

    /// The neighbours of a point, the nearest first, in place of what is in `found`.
    pub(super) fn neighbours(&self, point: usize, found: &mut Vec<(usize, f64)>) {
        let most = REACH * self.grid.apart_m;
        found.clear();
        found.extend(
            self.near(self.points[point], 2).filter(|&(other, square)| other != point && square <= most * most),
        );
        let by_distance = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0));
        if found.len() > NEIGHBOURS {
            found.select_nth_unstable_by(NEIGHBOURS, by_distance);
            found.truncate(NEIGHBOURS);
        }
        found.sort_unstable_by(by_distance);
    }
}

/// The square of a distance that counts heights more.
fn square(a: Point3<f64>, b: Point3<f64>) -> f64 {
    let way = b - a;
    way.x * way.x + way.y * way.y + FLATNESS * FLATNESS * way.z * way.z
}

/// Cells as large as points are apart.
struct Grid {
    cells: [usize; 3],
    low: [f64; 3],
    apart_m: f64,
}

impl Grid {
    fn new(apart_m: f64, side_m: f64, [bottom, top]: [f64; 2]) -> Self {
        let size = [side_m, side_m, FLATNESS * (top - bottom)];
        let cells = size.map(|size| (size / apart_m).floor() as usize + 1);
        Self { cells, low: [-0.5 * side_m, -0.5 * side_m, FLATNESS * bottom], apart_m }
    }

    fn place(&self, point: Point3<f64>) -> [usize; 3] {
        let stretched = [point.x, point.y, FLATNESS * point.z];
        [0, 1, 2].map(|axis| {
            let at = ((stretched[axis] - self.low[axis]) / self.apart_m).max(0.0) as usize;
            at.min(self.cells[axis] - 1)
        })
    }

    fn cell(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.cells[1] + y) * self.cells[0] + x
    }

    /// First and last cell of each row within `reach` cells of a point.
    fn rows(&self, point: Point3<f64>, reach: usize) -> impl Iterator<Item = [usize; 2]> {
        let middle = self.place(point);
        let range = |axis: usize| {
            let last = (middle[axis] + reach).min(self.cells[axis] - 1);
            middle[axis].saturating_sub(reach)..=last
        };
        let ([xs, ys], zs) = ([range(0), range(1)], range(2));
        zs.flat_map(move |z| {
            let ends = [*xs.start(), *xs.end()];
            ys.clone().map(move |y| ends.map(|x| self.cell([x, y, z])))
        })
    }
}

const NONE: u32 = u32::MAX;

/// Points while they are thrown.
struct Thrown {
    points: Vec<Point3<f64>>,
    /// The last point of each cell.
    heads: Vec<u32>,
    /// The point before in the same cell.
    chain: Vec<u32>,
    grid: Grid,
}

impl Thrown {
    fn over(grid: Grid) -> Self {
        let count = grid.cells.iter().product();
        Self { points: Vec::new(), heads: vec![NONE; count], chain: Vec::new(), grid }
    }

    fn offer(&mut self, point: Point3<f64>) {
        let least = self.grid.apart_m * self.grid.apart_m;
        for [first, last] in self.grid.rows(point, 1) {
            for cell in first..=last {
                let mut at = self.heads[cell];
                while at != NONE {
                    if square(self.points[at as usize], point) < least {
                        return;
                    }
                    at = self.chain[at as usize];
                }
            }
        }
        let cell = self.grid.cell(self.grid.place(point));
        self.chain.push(self.heads[cell]);
        self.heads[cell] = self.points.len() as u32;
        self.points.push(point);
    }

    /// The points cell by cell.
    fn settled(self) -> Cloud {
        let mut points = Vec::with_capacity(self.points.len());
        let mut starts = Vec::with_capacity(self.heads.len() + 1);
        for head in self.heads {
            starts.push(points.len() as u32);
            let mut at = head;
            while at != NONE {
                points.push(self.points[at as usize]);
                at = self.chain[at as usize];
            }
        }
        starts.push(points.len() as u32);
        Cloud { points, starts, grid: self.grid }
    }
}

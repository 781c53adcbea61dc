//! The floor: a multi-level surface map.

use std::ops::Range;

use rustc_hash::FxHashMap;

use super::columns::{Columns, Gap};
use super::thin::Thin;

/// Least height of the air over a floor, in metres: lower cracks are left out.
const LEAST_HEIGHT_M: f32 = 0.05;
/// How far around a cell its relief is measured, in metres: about the length of a wheel's footprint.
const RELIEF_M: f64 = 0.25;

/// The eight neighbours of a cell.
pub(super) const NEIGHBORS: [[i32; 2]; 8] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];

/// What a robot gets over and under.
#[derive(Clone, Copy, Debug)]
pub struct Robot {
    /// Height of the air that it needs, in metres.
    pub height_m: f32,
    /// Highest step that it climbs, in metres.
    pub step_m: f32,
    /// Steepest floor on which it stands, in radians.
    pub slope_rad: f32,
}

/// All places on which something can stand, by cell and from below.
pub struct Floor {
    cell_m: f64,
    cells: Vec<Gap>,
    reliefs: Vec<Relief>,
    columns: Tiles,
    thin: Thin,
}

/// The shape of the floor around a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// Angle of the plane fitted within a quarter of a metre, in radians; NaN where fewer than three cells are near.
    pub slope_rad: f32,
    /// Most distance of these cells from that plane along z, in metres; NaN where there is none.
    pub roughness_m: f32,
    /// Largest difference in height to a neighbour, in metres; 0 where there is none.
    pub step_m: f32,
}

impl Floor {
    /// The floor of the air in these columns.
    pub fn new(columns: Columns) -> Self {
        let cell_m = columns.cell_m();
        let mut cells = columns.into_gaps();
        cells.retain(|gap| gap.height_m() >= LEAST_HEIGHT_M);
        let mut columns = Tiles::default();
        let mut first = 0;
        for column in cells.chunk_by(|a, b| a.cell == b.cell) {
            let end = first + column.len() as u32;
            columns.insert(column[0].cell, [first, end]);
            first = end;
        }
        let mut floor = Self { cell_m, cells, reliefs: Vec::new(), columns, thin: Thin::new(cell_m) };
        let window = window(cell_m);
        floor.reliefs = floor.cells.iter().map(|cell| floor.relief_of(cell, &window)).collect();
        floor
    }

    /// The same floor, with what is thinner than its cells in the air over it.
    pub fn with_thin(self, thin: Thin) -> Self {
        Self { thin, ..self }
    }

    /// Side of a cell in metres.
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// What is thinner than its cells.
    pub fn thin(&self) -> &Thin {
        &self.thin
    }

    /// The cells, by place and from below.
    pub fn cells(&self) -> &[Gap] {
        &self.cells
    }

    /// The centre of a cell of the map, in metres.
    pub fn centre_m(&self, cell: [i32; 2]) -> [f64; 2] {
        cell.map(|n| (f64::from(n) + 0.5) * self.cell_m)
    }

    /// The cell of the map that holds a point in metres.
    pub fn cell_at(&self, point_m: [f64; 2]) -> [i32; 2] {
        point_m.map(|along_m| rounded_down(along_m / self.cell_m))
    }

    /// Numbers of the cells over a cell of the map, from below.
    pub fn over(&self, cell: [i32; 2]) -> Range<usize> {
        let [first, end] = self.columns.get(cell);
        first as usize..end as usize
    }

    /// Appends the ranges of numbers over cells of the map whose first coordinate is this.
    pub(super) fn ranges_over(&self, row: i32, columns: Range<i32>, ranges: &mut Vec<[u32; 2]>) {
        let side = TILE as i32;
        let mut from = columns.start;
        while from < columns.end {
            let end = columns.end.min((from.div_euclid(side) + 1) * side);
            let (tile, place) = Tiles::place([row, from]);
            let count = (end - from) as usize;
            match self.columns.0.get(&tile) {
                Some(over) => ranges.extend_from_slice(&over[place..place + count]),
                None => ranges.resize(ranges.len() + count, [0; 2]),
            }
            from = end;
        }
    }

    /// The shape of the floor around each cell.
    pub fn reliefs(&self) -> &[Relief] {
        &self.reliefs
    }

    /// Whether a robot can be on a cell: there is room above it, and it is level enough.
    pub fn carries(&self, number: usize, robot: &Robot) -> bool {
        self.cells[number].height_m() >= robot.height_m && self.reliefs[number].slope_rad <= robot.slope_rad
    }

    /// The cell on the other side of a border onto which a robot can drive from this one: that with the least step.
    pub fn next(&self, from: usize, towards: [i32; 2], robot: &Robot) -> Option<usize> {
        let here = &self.cells[from];
        let run_m = libm::hypot(f64::from(towards[0]), f64::from(towards[1])) * self.cell_m;
        let most_m = robot.step_m.max(libm::tanf(robot.slope_rad) * run_m as f32);
        let rise_m = |to: usize| (self.cells[to].floor_m - here.floor_m).abs();
        let is_passable = |to: &usize| {
            let there = &self.cells[*to];
            let height_m = here.ceiling_m.min(there.ceiling_m) - here.floor_m.max(there.floor_m);
            rise_m(*to) <= most_m && height_m >= robot.height_m && self.carries(*to, robot)
        };
        let passable = self.over(beside(here.cell, towards)).filter(is_passable);
        passable.min_by(|a, b| rise_m(*a).total_cmp(&rise_m(*b)))
    }

    /// The floor over a cell of the map that is nearest to a height in metres.
    pub fn nearest(&self, cell: [i32; 2], z_m: f32) -> Option<usize> {
        let away_m = |number: &usize| (self.cells[*number].floor_m - z_m).abs();
        self.over(cell).min_by(|a, b| away_m(a).total_cmp(&away_m(b)))
    }

    /// The cell of the floor under a point in the air in metres, or else the nearest over the same cell of the map.
    pub fn under(&self, [x, y, z]: [f64; 3]) -> Option<usize> {
        let mut over = self.over(self.cell_at([x, y]));
        let holds = |number: &usize| {
            let gap = &self.cells[*number];
            gap.floor_m <= z as f32 && z as f32 <= gap.ceiling_m
        };
        over.find(holds).or_else(|| self.nearest(self.cell_at([x, y]), z as f32))
    }

    /// The shape of the floor around a cell, of which the cells in the window belong to the plane.
    fn relief_of(&self, own: &Gap, window: &[Offset]) -> Relief {
        let around = NEIGHBORS.iter().filter_map(|towards| self.nearest(beside(own.cell, *towards), own.floor_m));
        let step_m = around.map(|other| (self.cells[other].floor_m - own.floor_m).abs()).fold(0.0, f32::max);
        let point = |offset: &Offset| {
            let number = self.nearest(beside(own.cell, offset.cells), own.floor_m)?;
            let z = f64::from(self.cells[number].floor_m) - f64::from(own.floor_m);
            (z.abs() <= offset.most_rise_m).then_some([offset.place_m[0], offset.place_m[1], z])
        };
        let points: Vec<[f64; 3]> = window.iter().filter_map(point).collect();
        let Some(plane) = Plane::through(&points) else {
            return Relief { slope_rad: f32::NAN, roughness_m: f32::NAN, step_m };
        };
        let roughness_m = points.iter().map(|point| plane.away_m(point).abs()).fold(0.0, f64::max);
        let slope_rad = libm::atan(libm::hypot(plane.slopes[0], plane.slopes[1]));
        Relief { slope_rad: slope_rad as f32, roughness_m: roughness_m as f32, step_m }
    }
}

/// Looks up many points near each other.
pub struct Lookup<'a> {
    floor: &'a Floor,
    /// The last tile with each pair of odd and even numbers: those that meet at a corner have a place each.
    tiles: [Seen<'a>; 4],
}

/// The number of a tile, and the ranges over its cells if it has any.
type Seen<'a> = ([i32; 2], Option<&'a [[u32; 2]; TILE * TILE]>);

impl<'a> Lookup<'a> {
    /// Looks up points of a floor.
    pub fn new(floor: &'a Floor) -> Self {
        // No tile is there.
        Self { floor, tiles: [([i32::MIN; 2], None); 4] }
    }

    /// Side of a cell in metres.
    pub fn cell_m(&self) -> f64 {
        self.floor.cell_m
    }

    /// Floor and ceiling in metres of the air at a point of the map and a height in metres.
    pub fn holding(&mut self, point_m: [f64; 2], z_m: f32) -> Option<[f32; 2]> {
        let gap = self.over(point_m).iter().find(|gap| gap.floor_m <= z_m && z_m <= gap.ceiling_m)?;
        Some([gap.floor_m, gap.ceiling_m])
    }

    /// The cells over a point of the map in metres, from below.
    fn over(&mut self, point_m: [f64; 2]) -> &'a [Gap] {
        let (tile, place) = Tiles::place(self.floor.cell_at(point_m));
        let seen = &mut self.tiles[((tile[0] & 1) << 1 | tile[1] & 1) as usize];
        if seen.0 != tile {
            *seen = (tile, self.floor.columns.0.get(&tile).map(|ranges| &**ranges));
        }
        let [first, end] = seen.1.map_or([0; 2], |ranges| ranges[place]);
        &self.floor.cells[first as usize..end as usize]
    }
}

/// Another cell near one.
struct Offset {
    cells: [i32; 2],
    place_m: [f64; 2],
    /// How much higher or lower it is at most, if it belongs to the same floor.
    most_rise_m: f64,
}

/// All cells within [`RELIEF_M`], the middle one included.
fn window(cell_m: f64) -> Vec<Offset> {
    /// Steepest line from a cell to one that still belongs to the same floor: 56°.
    const STEEPEST: f64 = 1.5;
    let reach = (RELIEF_M / cell_m).floor() as i32;
    let offset = |cells: [i32; 2]| {
        let place_m = cells.map(|n| f64::from(n) * cell_m);
        let away_m = libm::hypot(place_m[0], place_m[1]);
        (away_m <= RELIEF_M).then_some(Offset { cells, place_m, most_rise_m: STEEPEST * away_m })
    };
    (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| [i, j])).filter_map(offset).collect()
}

/// The range of cells over each cell of the map, in tiles: a window of the map is in few of them, so it is in the cache.
#[derive(Default)]
struct Tiles(FxHashMap<[i32; 2], Box<[[u32; 2]; TILE * TILE]>>);

/// Cells along either side of a tile.
const TILE: usize = 32;

impl Tiles {
    fn insert(&mut self, cell: [i32; 2], range: [u32; 2]) {
        let (tile, place) = Self::place(cell);
        self.0.entry(tile).or_insert_with(|| Box::new([[0; 2]; TILE * TILE]))[place] = range;
    }

    /// The range over a cell, which may be empty.
    fn get(&self, cell: [i32; 2]) -> [u32; 2] {
        let (tile, place) = Self::place(cell);
        self.0.get(&tile).map_or([0; 2], |ranges| ranges[place])
    }

    fn place(cell: [i32; 2]) -> ([i32; 2], usize) {
        let [i, j] = cell.map(|n| n.rem_euclid(TILE as i32) as usize);
        (cell.map(|n| n.div_euclid(TILE as i32)), i * TILE + j)
    }
}

/// The largest whole number that is not larger. `f64::floor` is a call where it has to run on every processor.
pub(super) fn rounded_down(value: f64) -> i32 {
    let towards_zero = value as i32;
    towards_zero - i32::from(value < f64::from(towards_zero))
}

pub(super) fn beside(cell: [i32; 2], towards: [i32; 2]) -> [i32; 2] {
    [cell[0] + towards[0], cell[1] + towards[1]]
}

/// A plane as a height over the map.
struct Plane {
    mean: [f64; 3],
    slopes: [f64; 2],
}

impl Plane {
    /// The plane with the least squares of distances along z; `None` if the points are on a line.
    fn through(points: &[[f64; 3]]) -> Option<Self> {
        let mut sum = [0.0; 3];
        points.iter().for_each(|point| (0..3).for_each(|axis| sum[axis] += point[axis]));
        let mean = sum.map(|sum| sum / points.len() as f64);
        let [mut xx, mut xy, mut yy, mut xz, mut yz] = [0.0; 5];
        for point in points {
            let [x, y, z] = [0, 1, 2].map(|axis| point[axis] - mean[axis]);
            xx += x * x;
            xy += x * y;
            yy += y * y;
            xz += x * z;
            yz += y * z;
        }
        let determinant = xx * yy - xy * xy;
        let slopes = [(xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant];
        (points.len() >= 3 && determinant > 1e-9 * (xx + yy) * (xx + yy)).then_some(Self { mean, slopes })
    }

    fn away_m(&self, point: &[f64; 3]) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| point[axis] - self.mean[axis]);
        z - self.slopes[0] * x - self.slopes[1] * y
    }
}

//! The laws of voxels, distances and samples, on any triangles.

use std::cell::Cell;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};

use plume_truth::{Block, Columns, Distances, Gap, Grid, SIDE, Told, Voxels, samples};
use proptest::prelude::*;

type Point = [f64; 3];

const CELL_M: f64 = 0.1;
const REACH_M: f64 = 0.3;
/// The label of a surface.
const ROCK: u8 = 2;

fn minus(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn length(a: Point) -> f64 {
    a.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Cells with their values.
type Cells<T> = Vec<([i32; 3], T)>;

/// All cells of some blocks.
fn cells<T: Copy>(blocks: &[Block<T>]) -> Cells<T> {
    let cell = |place: [i32; 3], n: usize| {
        let within = [n / (SIDE * SIDE), n / SIDE % SIDE, n % SIDE];
        [0, 1, 2].map(|axis| place[axis] * SIDE as i32 + within[axis] as i32)
    };
    blocks
        .iter()
        .flat_map(|block| block.cells.iter().enumerate().map(move |(n, value)| (cell(block.place, n), *value)))
        .collect()
}

fn centre_m(cell: [i32; 3]) -> Point {
    cell.map(|n| (f64::from(n) + 0.5) * CELL_M)
}

/// Points of a triangle on a grid of so many steps.
fn spread(corners: &[[f32; 3]; 3], steps: usize) -> Vec<Point> {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let point = |(u, v): (usize, usize)| {
        let [u, v] = [u, v].map(|n| n as f64 / steps as f64);
        [0, 1, 2].map(|axis| a[axis] + u * (b[axis] - a[axis]) + v * (c[axis] - a[axis]))
    };
    (0..=steps).flat_map(|u| (0..=steps - u).map(move |v| (u, v))).map(point).collect()
}

/// Whether something of a triangle is left when all outside a cube of this half side is cut off (Sutherland and Hodgman 1974).
fn is_cut(corners: &[[f32; 3]; 3], centre: Point, half: f64) -> bool {
    let mut polygon: Vec<Point> = corners.iter().map(|corner| minus(corner.map(f64::from), centre)).collect();
    for (axis, side) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        let mut kept = Vec::new();
        for (number, &from) in polygon.iter().enumerate() {
            let to = polygon[(number + 1) % polygon.len()];
            let beyond = [from, to].map(|point| side * point[axis] - half);
            if beyond[0] <= 0.0 {
                kept.push(from);
            }
            if (beyond[0] <= 0.0) != (beyond[1] <= 0.0) {
                let along = beyond[0] / (beyond[0] - beyond[1]);
                kept.push([0, 1, 2].map(|axis| from[axis] + along * (to[axis] - from[axis])));
            }
        }
        polygon = kept;
    }
    !polygon.is_empty()
}

fn voxels_of(triangles: &[[[f32; 3]; 3]], air: &[Gap]) -> Vec<([i32; 3], u8)> {
    let mut voxels = Voxels::new(CELL_M);
    for corners in triangles {
        voxels.add(corners, &[0, 1, 2], &[ROCK]);
    }
    voxels.fill(air);
    cells(&voxels.into_blocks())
}

fn distances_of(triangles: &[[[f32; 3]; 3]], air: &[Gap]) -> Vec<([i32; 3], f32)> {
    let mut distances = Distances::new(CELL_M, REACH_M);
    for corners in triangles {
        distances.add(corners, &[0, 1, 2]);
    }
    distances.sign(air);
    cells(&distances.into_blocks())
}

/// The sides of a box, seen from inside.
fn room(low: [f32; 3], high: [f32; 3]) -> Vec<[[f32; 3]; 3]> {
    let corner = |n: usize| [0, 1, 2].map(|axis| if n >> axis & 1 == 1 { high[axis] } else { low[axis] });
    let sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c].map(corner), [a, c, d].map(corner)]).collect()
}

fn air_of(triangles: &[[[f32; 3]; 3]]) -> Vec<Gap> {
    let mut columns = Columns::new(CELL_M);
    triangles.iter().for_each(|corners| columns.add(corners, &[0, 1, 2]));
    columns.into_gaps()
}

#[test]
fn a_room_is_free_inside_occupied_around_and_unknown_beyond() {
    // Off the centres and borders of cells, on both sides of the origin.
    let (low, high) = ([-0.53, -0.23, -1.03], [0.47, 0.37, 0.97]);
    let room = room(low, high);
    let air = air_of(&room);
    let depth_m = |at: Point| {
        let depth = |axis: usize| (at[axis] - f64::from(low[axis])).min(f64::from(high[axis]) - at[axis]);
        [0, 1, 2].map(depth).into_iter().fold(f64::INFINITY, f64::min)
    };
    for (cell, state) in voxels_of(&room, &air) {
        let depth = depth_m(centre_m(cell));
        let expected = match depth {
            inside if inside > 0.051 => Voxels::FREE,
            outside if outside < -0.051 => Voxels::UNKNOWN,
            _ => ROCK,
        };
        assert_eq!(state, expected, "{cell:?}, {depth}");
    }
    let distances = distances_of(&room, &air);
    let mut inside = 0;
    for (cell, distance_m) in distances {
        let depth = depth_m(centre_m(cell));
        if depth > 1e-6 {
            inside += 1;
            let expected = if depth > REACH_M { f64::NEG_INFINITY } else { -depth };
            assert!((f64::from(distance_m) - expected).abs() < 1e-6 || f64::from(distance_m) == expected, "{cell:?}");
        } else if depth < -1e-6 {
            assert!(distance_m > 0.0, "{cell:?}");
        }
    }
    assert_eq!(inside, 10 * 6 * 20, "all the air has blocks");
}

/// The states and distances of a world that is added in parts.
fn cells_in_parts<'a>(parts: impl Iterator<Item = &'a [[[f32; 3]; 3]]>) -> (Cells<u8>, Cells<f32>) {
    let told = Told { cell_m: CELL_M, has_states: true, reach_m: Some(REACH_M) };
    let mut grid = Grid::new(told, Cursor::new(Vec::new()));
    for part in parts {
        let indices: Vec<u32> = (0..3 * part.len() as u32).collect();
        grid.add(part.as_flattened(), &indices, &vec![ROCK; part.len()]).expect("it is in memory");
    }
    let (mut states, mut distances) = (Vec::new(), Vec::new());
    let add = |stack: plume_truth::Stack| {
        states.extend(cells(&stack.states));
        distances.extend(cells(&stack.distances_m));
        io::Result::Ok(())
    };
    grid.finish(add).expect("it is in memory");
    (states, distances)
}

/// A file in memory that counts what is written and read.
struct Counted<'a> {
    file: Cursor<Vec<u8>>,
    written: &'a Cell<usize>,
    read: &'a Cell<usize>,
}

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.written.set(self.written.get() + bytes.len());
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Counted<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.read.set(self.read.get() + bytes.len());
        self.file.read(bytes)
    }
}

impl Seek for Counted<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Bytes of a tunnel of so many rooms in a row: those in the file, those that the last room added to it, and the most that are read
/// from it for a square.
fn held(rooms: usize) -> [usize; 3] {
    let [written, read] = [Cell::new(0), Cell::new(0)];
    let file = Counted { file: Cursor::default(), written: &written, read: &read };
    let mut grid = Grid::new(Told { cell_m: CELL_M, has_states: true, reach_m: Some(REACH_M) }, file);
    let mut of_last = 0;
    for number in 0..rooms {
        let x = number as f32 * 2.0;
        let room = room([x, 0.0, 0.0], [x + 1.5, 1.0, 1.0]);
        let (before, indices) = (written.get(), (0..36).collect::<Vec<u32>>());
        grid.add(room.as_flattened(), &indices, &[ROCK; 12]).expect("it is in memory");
        of_last = written.get() - before;
    }
    let (mut most, mut before) = (0, 0);
    let square = |_| {
        most = most.max(read.get() - before);
        before = read.get();
        io::Result::Ok(())
    };
    grid.finish(square).expect("it is in memory");
    [written.get(), of_last, most]
}

/// What is added goes to the file at once, and comes back square by square.
#[test]
fn a_longer_tunnel_is_not_held_longer() {
    let [short, long] = [held(4), held(64)];
    assert_eq!(long[0], 16 * short[0], "a tunnel of 64 rooms is 16 times as long as one of 4");
    assert!(short[1] > 0 && short[2] > 0);
    assert_eq!(long[1..], short[1..], "what waits for the file, and what is read at once");
    assert!(long[2] < long[0] / 64, "less than a room at once");
}

#[test]
fn the_largest_label_is_told() {
    let mut voxels = Voxels::new(1.0);
    let corners = [[0.1, 0.1, 0.1], [0.9, 0.1, 0.1], [0.1, 0.9, 0.1]];
    voxels.add(&corners, &[0, 1, 2, 0, 2, 1, 0, 1, 2], &[3, 7, 5]);
    let told: Vec<_> = cells(&voxels.into_blocks()).into_iter().filter(|(_, state)| *state != 0).collect();
    assert_eq!(told, [([0, 0, 0], 7)]);
}

#[test]
#[should_panic(expected = "is not the label of a surface")]
fn a_surface_cannot_be_free() {
    Voxels::new(1.0).add(&[[0.0; 3]; 3], &[0, 1, 2], &[Voxels::FREE]);
}

fn triangle() -> impl Strategy<Value = [[f32; 3]; 3]> {
    // Also needles and points, at corners of cells.
    let along = || prop_oneof![4 => -0.8_f32..0.8, 1 => (-8..8).prop_map(|n| n as f32 * 0.1)];
    let corner = || [along(), along(), along()];
    prop_oneof![
        4 => [corner(), corner(), corner()],
        1 => (corner(), corner()).prop_map(|(a, b)| [a, b, b]),
        1 => corner().prop_map(|a| [a; 3]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn cells_are_occupied_where_a_triangle_is(corners in triangle()) {
        let mut occupied = 0;
        for (cell, state) in voxels_of(&[corners], &[]) {
            let cut = |half: f64| is_cut(&corners, centre_m(cell), half);
            prop_assert!(state == ROCK || !cut(CELL_M / 2.0), "{cell:?} is missing");
            prop_assert!(state != ROCK || cut(CELL_M / 2.0 + 1e-6), "{cell:?} is too much");
            occupied += usize::from(state == ROCK);
        }
        prop_assert!(occupied > 0);
    }

    #[test]
    fn distances_are_those_of_the_nearest_point(corners in triangle()) {
        const STEPS: usize = 20;
        let points = spread(&corners, STEPS);
        let [a, b, c] = corners.map(|corner| corner.map(f64::from));
        let step_m = [minus(b, a), minus(c, b), minus(a, c)].map(length).into_iter().fold(0.0, f64::max) / STEPS as f64;
        for (cell, distance_m) in distances_of(&[corners], &[]) {
            let sampled = points.iter().map(|point| length(minus(*point, centre_m(cell)))).fold(f64::INFINITY, f64::min);
            if distance_m.is_finite() {
                let distance_m = f64::from(distance_m);
                prop_assert!(distance_m <= sampled + 1e-6 && distance_m >= sampled - step_m - 1e-6, "{cell:?}");
                prop_assert!(distance_m <= REACH_M + 1e-6);
            } else {
                prop_assert!(sampled > REACH_M - 1e-6, "{cell:?} is missing");
            }
        }
    }

    /// The order of triangles changes nothing, to the last bit.
    #[test]
    fn grids_are_functions_of_the_world(mut triangles in prop::collection::vec(triangle(), 1..8), turn in 0_usize..8) {
        let before = (voxels_of(&triangles, &[]), distances_of(&triangles, &[]));
        let count = triangles.len();
        triangles.rotate_left(turn % count);
        triangles.reverse();
        prop_assert!(before == (voxels_of(&triangles, &[]), distances_of(&triangles, &[])));
    }

    /// Nor does the division into parts, or their order.
    #[test]
    fn grids_are_made_in_parts(
        mut triangles in prop::collection::vec(triangle(), 1..12),
        size in 1_usize..6,
        turn in 0_usize..8,
    ) {
        let air = air_of(&triangles);
        let whole = (voxels_of(&triangles, &air), distances_of(&triangles, &air));
        prop_assert!(whole == cells_in_parts(triangles.chunks(size)));
        let count = triangles.len();
        triangles.rotate_left(turn % count);
        prop_assert!(whole == cells_in_parts(triangles.rchunks(size)));
    }

    #[test]
    fn samples_are_as_many_as_are_due(triangles in prop::collection::vec(triangle(), 1..20), seed: [u8; 32]) {
        const PER_M2: f64 = 50.0;
        let corners = triangles.as_flattened();
        let indices: Vec<u32> = (0..corners.len() as u32).collect();
        let found: Vec<_> = samples(corners, &indices, PER_M2, seed).collect();
        let mut due = 0.0;
        for (number, triangle) in triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|corner| corner.map(f64::from));
            let [p, q] = [minus(b, a), minus(c, a)];
            let across = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
            due += length(across) / 2.0 * PER_M2;
            let so_far = found.iter().filter(|sample| sample.triangle <= number).count() as f64;
            prop_assert!((so_far - due).abs() <= 1.0, "{so_far} instead of {due}");
        }
        for sample in found {
            let points = spread(&triangles[sample.triangle], 60);
            let away = points.iter().map(|point| length(minus(*point, sample.at_m.map(f64::from))));
            prop_assert!(away.fold(f64::INFINITY, f64::min) < 0.1, "{sample:?}");
        }
    }
}

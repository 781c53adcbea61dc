//! The laws of convex pieces, on real caves: every generator in every rock.

use crate::common::chunks;
use crate::common::distance::{Near, corners, spread};
use crate::common::world;
use nalgebra::Vector3;
use plume::field::{CaveField, Field, PassageSettings};
use plume::generators::{GENERATORS, GeneratorRow};
use plume::material::{Look, MATERIALS, MaterialRow};
use plume::mesh::measure::weld;
use plume::mesh::{MOST_CORNERS, Mesh, MeshSettings, Piece, PieceSettings, QUANTA_PER_M, Zone, pieces};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde_json::json;
use world::{kinds, small};

type Point = Vector3<f64>;

/// No piece is thinner, in metres.
const LEAST_WIDTH_M: f64 = 0.002;

/// A cave with its pieces, chunk by chunk.
struct Cave {
    name: String,
    field: CaveField,
    walls: Vec<Mesh>,
    pieces: Vec<Vec<Piece>>,
    settings: PieceSettings,
}

impl Cave {
    fn new(generator: &GeneratorRow, material: &MaterialRow, nodes: u32, seed: u64, chunk_m: f32) -> Self {
        let graph = small(generator, nodes, seed);
        let rock = (material.read)(json!({})).unwrap();
        let field = CaveField::new(&graph, &PassageSettings::default(), rock, Look::default(), seed);
        // Coarser than the default, which takes three times as long.
        let mesh =
            MeshSettings { voxel_m: 0.2, simplify_error_m: 0.02, chunk_m: [chunk_m; 3], ..MeshSettings::default() };
        let walls: Vec<Mesh> = chunks(&field, field.bounds(), &mesh).into_iter().map(|chunk| chunk.visual).collect();
        let settings = PieceSettings::default();
        let of_chunk = |index: usize| pieces(&walls[index], &others(&walls, index), &settings);
        let pieces = (0..walls.len()).into_par_iter().map(of_chunk).collect();
        Self { name: format!("{} in {}, seed {seed}", generator.name, material.name), field, walls, pieces, settings }
    }

    fn all_pieces(&self) -> impl Iterator<Item = &Piece> {
        self.pieces.iter().flatten()
    }

    /// Negative in the air.
    fn field_at(&self, points: &[Point]) -> Vec<f32> {
        let points: Vec<[f32; 3]> = points.iter().map(|point| point.map(|c| c as f32).into()).collect();
        self.field.distances_at(&points)
    }
}

fn caves() -> Vec<Cave> {
    kinds()
        .into_iter()
        .zip(1..)
        .map(|((g, m), seed)| Cave::new(g, m, 4, seed, if seed % 2 == 0 { 8.0 } else { 16.0 }))
        .collect()
}

/// All chunks except one. That distant ones make no difference is a separate law.
fn others(walls: &[Mesh], index: usize) -> Vec<Mesh> {
    walls.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, wall)| wall.clone()).collect()
}

fn mesh_of(piece: &Piece) -> Mesh {
    Mesh { positions: piece.positions.clone(), triangles: piece.triangles.clone(), ..Mesh::default() }
}

#[test]
fn pieces_keep_the_laws() {
    for cave in caves() {
        assert!(cave.pieces.iter().zip(&cave.walls).all(|(pieces, wall)| pieces.len() < wall.triangles.len()));
        for piece in cave.all_pieces() {
            assert_convex(piece, &cave.name);
        }
        assert_in_the_rock(&cave);
        assert_covered(&cave);
        assert_no_ray_escapes(&cave);
    }
}

/// Closed, convex, neither flat nor thin, of few corners.
fn assert_convex(piece: &Piece, cave: &str) {
    let Piece { positions, triangles, .. } = piece;
    assert!((4..=MOST_CORNERS).contains(&positions.len()), "{cave}: {} corners", positions.len());
    assert_eq!(triangles.len(), 2 * positions.len() - 4, "{cave}: closed, and every vertex a corner");
    let mut edges: Vec<_> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    edges.sort_unstable();
    assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "{cave}: an edge runs twice the same way");
    assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()), "{cave}: an open edge");
    let place = |corner: u32| Vector3::from(positions[corner as usize].map(i64::from));
    for &[a, b, c] in triangles {
        let normal = (place(b) - place(a)).cross(&(place(c) - place(a)));
        let heights = (0..positions.len() as u32).map(|corner| normal.dot(&(place(corner) - place(a))));
        let (low, high) = heights.fold((0, 0), |(low, high), height| (low.min(height), high.max(height)));
        assert_eq!(high, 0, "{cave}: a corner lies outside of a face");
        let width_m = -low as f64 / normal.map(|c| c as f64).norm() / f64::from(QUANTA_PER_M);
        assert!(width_m >= LEAST_WIDTH_M, "{cave}: {width_m} m wide");
    }
}

/// No point of a piece is in the open and further from floors and from other walls than their tolerances.
fn assert_in_the_rock(cave: &Cave) {
    let whole = weld(&cave.walls);
    let of_zone = |is_floor: bool| {
        let is_wanted = |&&triangle: &&[u32; 3]| {
            let [a, b, c] = corners(&whole, triangle);
            let normal = (b - a).cross(&(c - a)).normalize();
            (normal.z > Zone::STEEPEST_FLOOR) == is_floor
        };
        Mesh { triangles: whole.triangles.iter().filter(is_wanted).copied().collect(), ..whole.clone() }
    };
    let (floor_m, wall_m) = (f64::from(cave.settings.floor_tolerance_m), f64::from(cave.settings.wall_tolerance_m));
    let (floors, walls) = (Near::new(&of_zone(true), 2.0 * floor_m), Near::new(&of_zone(false), 2.0 * wall_m));
    cave.all_pieces().collect::<Vec<_>>().par_iter().for_each(|piece| {
        let mesh = mesh_of(piece);
        let points = mesh.triangles.iter().flat_map(|&face| spread(corners(&mesh, face), 2.0 * floor_m));
        let is_far = |point: &Point| floors.distance(*point) > floor_m && walls.distance(*point) > wall_m;
        // The field answers faster on which side a point is, but in places it is air behind the triangles.
        let mut deep: Vec<Point> = points.filter(is_far).collect();
        let mut values = cave.field_at(&deep).into_iter();
        deep.retain(|_| values.next().is_some_and(|value| value <= 0.0));
        let open = deep.into_iter().find(|&point| is_in_the_air(&whole, point));
        assert!(open.is_none(), "{}: a piece is in the open at {open:?}", cave.name);
    });
}

/// Every point of the wall is in a piece of its chunk, or at most half a tolerance in front of one.
fn assert_covered(cave: &Cave) {
    const SPACING_M: f64 = 0.1;
    let most_m = f64::from(cave.settings.wall_tolerance_m) / 2.0 + 1.0 / f64::from(QUANTA_PER_M);
    for (wall, pieces) in cave.walls.iter().zip(&cave.pieces) {
        let pieces: Vec<Convex> = pieces.iter().map(Convex::of).collect();
        wall.triangles.par_iter().for_each(|&triangle| {
            // Points of a triangle are mostly in the same piece.
            let mut last = 0;
            for point in spread(corners(wall, triangle), SPACING_M) {
                let found = (last..pieces.len()).chain(0..last).find(|i| pieces[*i].is_near(point, most_m));
                let is_covered = found.is_some();
                last = found.unwrap_or(last);
                assert!(is_covered, "{}: no piece is behind {point}", cave.name);
            }
        });
    }
}

/// Whether a ray from a point leaves a closed mesh once more than it enters.
fn is_in_the_air(whole: &Mesh, point: Point) -> bool {
    let towards = Point::new(0.267, 0.534, 0.802);
    let is_crossed = |&&triangle: &&[u32; 3]| {
        let [a, b, c] = corners(whole, triangle).map(|corner| corner - point);
        let side = |from: Point, to: Point| from.cross(&to).dot(&towards) > 0.0;
        let normal = (b - a).cross(&(c - a));
        side(a, b) == side(b, c) && side(b, c) == side(c, a) && normal.dot(&a) * normal.dot(&towards) > 0.0
    };
    whole.triangles.iter().filter(is_crossed).count() % 2 == 1
}

/// A ray from the air meets a piece, and does so near the wall.
fn assert_no_ray_escapes(cave: &Cave) {
    const RAYS: usize = 300;
    let whole = weld(&cave.walls);
    let near = Near::new(&whole, 0.2);
    let all: Vec<Convex> = cave.all_pieces().map(Convex::of).collect();
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let bounds = cave.field.bounds();
    let mut rays = Vec::new();
    while rays.len() < RAYS {
        let from = Point::from_fn(|i, _| rng.random_range(f64::from(bounds.min[i])..f64::from(bounds.max[i])));
        let to = Point::from_fn(|_, _| rng.random_range(-1.0..1.0));
        if cave.field_at(&[from])[0] < -0.5 && (0.1..=1.0).contains(&to.norm()) {
            rays.push((from, to.normalize()));
        }
    }
    let most_m = f64::from(cave.settings.wall_tolerance_m);
    rays.par_iter().for_each(|(from, to)| {
        let met = all.iter().filter_map(|piece| piece.met_by(*from, *to)).fold(f64::INFINITY, f64::min);
        assert!(met.is_finite(), "{}: the ray from {from} towards {to} meets nothing", cave.name);
        let distance_m = near.distance(from + to * met);
        assert!(distance_m <= most_m, "{}: a ray from {from} ends {distance_m} m from the wall", cave.name);
    });
}

/// The planes of a piece: outward normals and offsets.
struct Convex(Vec<(Point, f64)>);

impl Convex {
    fn of(piece: &Piece) -> Self {
        let mesh = mesh_of(piece);
        let plane = |&face: &[u32; 3]| {
            let [a, b, c] = corners(&mesh, face);
            let normal = (b - a).cross(&(c - a)).normalize();
            (normal, normal.dot(&a))
        };
        Self(mesh.triangles.iter().map(plane).collect())
    }

    /// Whether a point is before none of the planes by more than this.
    fn is_near(&self, point: Point, most_m: f64) -> bool {
        self.0.iter().all(|(normal, offset)| normal.dot(&point) - offset <= most_m)
    }

    /// Distance along a ray to where it enters the piece.
    fn met_by(&self, from: Point, to: Point) -> Option<f64> {
        let (mut first, mut last) = (0.0, f64::INFINITY);
        for (normal, offset) in &self.0 {
            let (height, fall) = (normal.dot(&from) - offset, -normal.dot(&to));
            match fall {
                0.0 if height > 0.0 => return None,
                0.0 => {}
                _ if fall > 0.0 => first = f64::max(first, height / fall),
                _ => last = f64::min(last, height / fall),
            }
        }
        (first <= last).then_some(first)
    }
}

#[test]
fn chunks_further_away_change_nothing() {
    let cave = Cave::new(GENERATORS.default_row(), MATERIALS.default_row(), 6, 3, 8.0);
    let reach = ((cave.settings.thickness_m + 8.0) * QUANTA_PER_M as f32) as i32;
    for (index, wall) in cave.walls.iter().enumerate() {
        let touches = |other: &Mesh| {
            let near = |i: usize| {
                let span = |mesh: &Mesh| {
                    mesh.positions.iter().map(|p| p[i]).fold((i32::MAX, i32::MIN), |(l, h), c| (l.min(c), h.max(c)))
                };
                let ((low, high), (other_low, other_high)) = (span(wall), span(other));
                other_low <= high + reach && other_high >= low - reach
            };
            (0..3).all(near)
        };
        let around: Vec<Mesh> = others(&cave.walls, index).into_iter().filter(touches).collect();
        assert!(pieces(wall, &around, &cave.settings) == cave.pieces[index], "chunk {index}");
    }
}

#[test]
fn a_smaller_tolerance_takes_more_pieces() {
    let cave = Cave::new(GENERATORS.default_row(), MATERIALS.default_row(), 6, 1, 16.0);
    let count = |tolerance_m: f32| {
        let settings = PieceSettings {
            floor_tolerance_m: tolerance_m,
            wall_tolerance_m: tolerance_m,
            ceiling_tolerance_m: tolerance_m,
            ..PieceSettings::default()
        };
        pieces(&cave.walls[0], &others(&cave.walls, 0), &settings).len()
    };
    let counts = [0.02, 0.05, 0.1, 0.2].map(count);
    assert!(counts.windows(2).all(|pair| pair[0] > pair[1]), "{counts:?}");
    assert!(counts[3] * 20 < cave.walls[0].triangles.len(), "{counts:?}");
}

#[test]
fn nothing_has_no_pieces() {
    assert!(pieces(&Mesh::default(), &[], &PieceSettings::default()).is_empty());
}

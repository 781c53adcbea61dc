//! The invariants of every mesh, on fields of known shape.

use crate::common::distance::Distances;
use crate::common::fields::{WrongNormals, bubbles, ladder, room, sphere, white_noise};
use crate::common::{assert_lawful, chunks, collisions, triangle_set, visuals};
use plume::field::{Aabb, Field};
use plume::mesh::measure::{Report, Seams, weld};
use plume::mesh::{ChunkMeshes, Grid, Mesh, MeshSettings, chunk};
use proptest::prelude::*;
use rayon::prelude::*;

/// Nothing simplified.
fn whole(voxel_m: f32, chunk_m: f32) -> MeshSettings {
    MeshSettings {
        voxel_m,
        chunk_m: [chunk_m; 3],
        simplify_error_m: 0.0,
        collision_error_m: 0.0,
        ..MeshSettings::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn any_cave_is_lawful(
        seed: u32,
        rungs in 2..4_usize,
        rough_m in 0.0..0.7_f32,
        voxel_m in 0.18..0.4_f32,
        chunk_m in 5.0..20.0_f32,
        error_m in 0.005..0.2_f32,
    ) {
        let (field, bounds) = ladder(rungs, rough_m, seed);
        let settings = MeshSettings {
            simplify_error_m: error_m,
            collision_error_m: 0.0,
            ..whole(voxel_m, chunk_m)
        };
        let made = chunks(&field, bounds, &settings);
        let simple = assert_lawful(&visuals(&made));
        let full = assert_lawful(&collisions(&made));
        prop_assert_eq!(full.components, 1);
        prop_assert_eq!((simple.components, simple.genus), (1, full.genus));
        prop_assert!(simple.triangles < full.triangles);
    }
}

#[test]
fn a_ball_has_its_volume_and_faces_inwards() {
    let ball = sphere([0.3, -0.2, 0.1], 5.0);
    let bounds = Aabb { min: [-6.0; 3], max: [6.0; 3] };
    for settings in [whole(0.2, 8.0), MeshSettings::default()] {
        let made = chunks(&ball, bounds, &settings);
        let report = assert_lawful(&visuals(&made));
        assert_eq!((report.components, report.genus), (1, 0));
        let volume_m3 = 4.0 / 3.0 * std::f64::consts::PI * 125.0;
        assert!((report.volume_m3 / volume_m3 - 1.0).abs() < 0.01, "{report:#?}");
        let mesh = &made[0].visual;
        for (vertex, normal) in mesh.normals.iter().enumerate() {
            let at = mesh.position_m(vertex as u32);
            let outwards: f32 = (0..3).map(|i| (at[i] - [0.3, -0.2, 0.1][i]) * normal[i]).sum();
            assert!(outwards < -4.8, "{outwards}: normals point into the air");
        }
    }
}

#[test]
fn normals_that_oppose_the_triangles_are_replaced_alike_on_both_sides() {
    let (field, bounds) = ladder(2, 0.5, 4);
    let settings = MeshSettings { chunk_m: [5.0; 3], ..MeshSettings::default() };
    let right = chunks(&field, bounds, &settings);
    let wrong = chunks(&WrongNormals(field), bounds, &settings);
    assert_lawful(&visuals(&wrong));
    for (right, wrong) in right.iter().zip(&wrong) {
        for (a, b) in right.visual.normals.iter().zip(&wrong.visual.normals) {
            assert!((0..3).map(|i| a[i] * b[i]).sum::<f32>() > 0.0, "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_cave_far_from_its_origin_is_lawful() {
    let centre = [4080.3, -4081.1, 4079.7];
    let bounds = Aabb { min: centre.map(|c| c - 5.0), max: centre.map(|c| c + 5.0) };
    let made = chunks(&sphere(centre, 4.0), bounds, &MeshSettings::default());
    let report = assert_lawful(&visuals(&made));
    assert_eq!((report.components, report.genus), (1, 0));
    for chunk in &made {
        let mesh = &chunk.visual;
        for (vertex, position) in mesh.positions.iter().enumerate() {
            let exact = mesh.position_m(vertex as u32).map(|m| (f64::from(m) * 4096.0) as i32);
            assert_eq!(exact, *position);
        }
    }
}

#[test]
fn ladders_have_a_handle_per_loop() {
    for (rungs, rough_m, voxel_m) in [(2, 0.0, 0.2), (5, 0.4, 0.25), (10, 0.4, 0.4)] {
        let (field, bounds) = ladder(rungs, rough_m, 7);
        let report = assert_lawful(&visuals(&chunks(&field, bounds, &whole(voxel_m, 16.0))));
        assert_eq!((report.components, report.genus), (1, rungs as i64 - 1));
    }
}

/// Also where every normal has to be replaced.
#[test]
fn chunks_do_not_show_in_the_triangles() {
    let (field, bounds) = ladder(4, 0.6, 3);
    same_in_all_chunks(&field, bounds);
    same_in_all_chunks(&WrongNormals(field), bounds);
}

fn same_in_all_chunks(field: &dyn Field, bounds: Aabb<f32>) {
    let sets = [7.0, 16.0, 40.0].map(|chunk_m| {
        let made = chunks(field, bounds, &whole(0.25, chunk_m));
        (made.len(), triangle_set(&visuals(&made)))
    });
    assert!(sets[0].0 > sets[1].0 && sets[1].0 > sets[2].0);
    assert!(sets[0].1 == sets[1].1 && sets[1].1 == sets[2].1);
}

/// Samples of a wall on the lattice are all zero.
#[test]
fn flat_walls_on_the_lattice_are_lawful() {
    let room = room([5.0, 3.0, 2.0]);
    let bounds = Aabb { min: [-5.0, -3.0, -2.0], max: [5.0, 3.0, 2.0] };
    let settings = whole(0.25, 4.0);
    let full = assert_lawful(&visuals(&chunks(&room, bounds, &settings)));
    assert_eq!(full.genus, 0);
    // The edges are smoothed, and each wall moves by the tenth of a voxel that crossings keep from the lattice.
    let moved_m3 = 0.1 * 0.25 * full.area_m2;
    assert!((full.volume_m3 - 240.0).abs() < 0.03 * 240.0 + moved_m3, "{full:#?}");
    let tiny = MeshSettings { simplify_error_m: 1e-4, ..settings };
    let simple = assert_lawful(&visuals(&chunks(&room, bounds, &tiny)));
    assert!(simple.triangles < full.triangles / 2, "no error at all keeps every triangle");
}

#[test]
fn any_order_on_any_thread_makes_the_same_chunks() {
    let (field, bounds) = ladder(2, 0.6, 5);
    let settings = MeshSettings { chunk_m: [6.0; 3], ..MeshSettings::default() };
    let grid = Grid::new(bounds, &settings).unwrap();
    let straight = chunks(&field, bounds, &settings);
    let indices: Vec<_> = grid.indices().collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let mut threaded: Vec<_> = pool.install(|| {
        let backwards = indices.into_par_iter().rev();
        backwards.filter_map(|index| chunk(&field, &grid, index, &settings)).collect()
    });
    threaded.reverse();
    assert!(straight == threaded);
}

#[test]
fn white_noise_is_manifold() {
    for seed in 0..3 {
        let (field, bounds) = white_noise(0.25, 32, seed);
        let made = chunks(&field, bounds, &whole(0.25, 3.0));
        let seams = Seams::of(visuals(&made));
        assert!(seams.is_clean(), "{seams:#?}");
        let report = Report::of(&weld(visuals(&made)));
        assert!(report.is_clean(), "{report:#?}");
        assert!(report.genus > 1000, "the noise is ragged: {report:#?}");
    }
}

#[test]
fn simplification_keeps_to_its_error() {
    let (field, bounds) = ladder(2, 0.6, 9);
    let full = weld(visuals(&chunks(&field, bounds, &whole(0.2, 16.0))));
    for error_m in [0.01, 0.02, 0.1] {
        let settings = MeshSettings { simplify_error_m: error_m, ..whole(0.2, 16.0) };
        let made = chunks(&field, bounds, &settings);
        assert!(made.iter().all(|chunk| chunk.visual_error_m <= error_m));
        let simple = weld(visuals(&made));
        assert!(simple.triangles.len() < full.triangles.len() / 4);
        let error_m = f64::from(error_m);
        for (from, to) in [(&simple, &full), (&full, &simple)] {
            let distances = Distances::between(from, to, 0.1, 0.4);
            assert!(distances.quantile(0.999) < 1.5 * error_m);
            assert!(distances.greatest() < 3.0 * error_m);
        }
    }
}

#[test]
fn a_budget_is_kept_whatever_the_error() {
    let (field, bounds) = ladder(2, 0.5, 2);
    let free = MeshSettings { simplify_error_m: 0.001, ..MeshSettings::default() };
    let count = |made: &[ChunkMeshes]| -> usize { made.iter().map(|chunk| chunk.visual.triangles.len()).sum() };
    let unlimited = count(&chunks(&field, bounds, &free));
    let limited = chunks(&field, bounds, &MeshSettings { max_triangles: 5000, ..free });
    assert_lawful(&visuals(&limited));
    assert!(unlimited > 10_000 && count(&limited) <= 5000, "{unlimited} {}", count(&limited));
    assert!(limited.iter().any(|chunk| chunk.visual_error_m > 0.001));
}

#[test]
fn small_bubbles_go_and_large_ones_stay() {
    let (field, bounds) = bubbles(&[(0.9, [0.0; 3]), (1.4, [8.1, 0.3, 0.1])]);
    for chunk_m in [4.0, 16.0] {
        let report = assert_lawful(&visuals(&chunks(&field, bounds, &whole(0.2, chunk_m))));
        assert_eq!(report.components, 1, "one is narrower than 10 cells, one is not");
        assert!(report.min_m[0] > 6.0, "the large one stays");
    }
}

#[test]
fn rock_alone_makes_no_chunk() {
    let bounds = Aabb { min: [20.0; 3], max: [30.0; 3] };
    assert!(chunks(&sphere([0.0; 3], 5.0), bounds, &MeshSettings::default()).is_empty());
}

/// The laws must be able to fail: ways to break a mesh, and the check that detects each.
const BREAKS: [(&str, Damage, IsSeen); 8] = [
    ("lost triangle", lose_triangle, |report, _| report.open_edges == 3),
    ("turned triangle", turn_triangle, |report, _| report.inconsistent_winding == 3),
    ("doubled triangle", double_triangle, |report, _| report.nonmanifold_edges == 3),
    ("triangle without area", flatten_triangle, |report, _| report.degenerate_triangles == 1),
    ("two vertices in one place", pinch, |report, _| report.nonmanifold_vertices == 1),
    ("moved border vertex", move_border, |report, seams| seams.unmatched > 0 && report.open_edges > 0),
    ("turned border normal", turn_border_normal, |_, seams| seams.different_normals == 1),
    ("unmarked border", unmark_border, |_, seams| seams.unmarked == 1),
];

type Damage = fn(&mut Mesh);
type IsSeen = fn(&Report, &Seams) -> bool;

#[test]
fn broken_meshes_are_caught() {
    let (field, bounds) = ladder(2, 0.5, 1);
    let sound = chunks(&field, bounds, &whole(0.3, 4.0));
    assert_lawful(&visuals(&sound));
    for (name, damage, is_seen) in BREAKS {
        let mut made = sound.clone();
        let largest = made.iter_mut().max_by_key(|chunk| chunk.visual.triangles.len());
        damage(&mut largest.unwrap().visual);
        let meshes = visuals(&made);
        let report = Report::of(&weld(meshes.iter().copied()));
        let seams = Seams::of(meshes.iter().copied());
        assert!(is_seen(&report, &seams), "{name}: {report:#?} {seams:#?}");
        assert!(std::panic::catch_unwind(|| assert_lawful(&meshes)).is_err(), "{name}");
    }
}

fn lose_triangle(mesh: &mut Mesh) {
    let inner = first_inner_triangle(mesh);
    mesh.triangles.remove(inner);
}

fn turn_triangle(mesh: &mut Mesh) {
    let inner = first_inner_triangle(mesh);
    mesh.triangles[inner].swap(0, 1);
}

fn double_triangle(mesh: &mut Mesh) {
    let inner = first_inner_triangle(mesh);
    mesh.triangles.push(mesh.triangles[inner]);
}

fn flatten_triangle(mesh: &mut Mesh) {
    let inner = first_inner_triangle(mesh);
    mesh.triangles[inner][1] = mesh.triangles[inner][0];
}

fn move_border(mesh: &mut Mesh) {
    let vertex = first_border_vertex(mesh);
    mesh.positions[vertex][0] += 1;
}

fn turn_border_normal(mesh: &mut Mesh) {
    let vertex = first_border_vertex(mesh);
    mesh.normals[vertex][0] += 1e-6;
}

fn unmark_border(mesh: &mut Mesh) {
    let vertex = first_border_vertex(mesh);
    mesh.border[vertex] = false;
}

/// Moves a vertex to the position of another one with unconnected triangles.
fn pinch(mesh: &mut Mesh) {
    let ring = |vertex: u32| {
        let around = mesh.triangles.iter().filter(move |triangle| triangle.contains(&vertex));
        around.flatten().copied().collect::<Vec<u32>>()
    };
    let inner = |vertex: u32| ring(vertex).iter().all(|&v| !mesh.border[v as usize]);
    let mut inside = (0..mesh.positions.len() as u32).filter(|&vertex| inner(vertex));
    let first = inside.next().expect("a vertex inside");
    let near = ring(first);
    let apart = |vertex: &u32| ring(*vertex).iter().all(|v| !near.contains(v));
    let second = inside.find(apart).expect("a vertex further inside");
    mesh.positions[second as usize] = mesh.positions[first as usize];
}

fn first_inner_triangle(mesh: &Mesh) -> usize {
    let inner = |triangle: &[u32; 3]| triangle.iter().all(|&v| !mesh.border[v as usize]);
    mesh.triangles.iter().position(inner).expect("a triangle inside")
}

fn first_border_vertex(mesh: &Mesh) -> usize {
    mesh.border.iter().position(|&border| border).expect("a border")
}

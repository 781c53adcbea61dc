//! What is promised of every mesh, on fields whose shape is known.

mod common;

use common::fields::{ladder, sphere, white_noise};
use common::{assert_lawful, chunks, collisions, triangle_set, visuals};
use plume::field::Bounds;
use plume::mesh::MeshSettings;
use plume::mesh::measure::{Report, weld};

fn whole(voxel_m: f32, chunk_m: f32) -> MeshSettings {
    MeshSettings {
        voxel_m,
        chunk_m: [chunk_m; 3],
        simplify_error_m: 0.0,
        collision_error_m: 0.0,
        ..MeshSettings::default()
    }
}

#[test]
fn sphere_has_its_volume_and_faces_inwards() {
    let settings = whole(0.2, 8.0);
    let made = chunks(
        &sphere([0.3, -0.2, 0.1], 5.0),
        Bounds {
            min: [-6.0; 3],
            max: [6.0; 3],
        },
        &settings,
    );
    let report = assert_lawful(&visuals(&made));
    assert_eq!((report.components, report.genus), (1, 0));
    let volume_m3 = 4.0 / 3.0 * std::f64::consts::PI * 125.0;
    assert!(
        (report.volume_m3 / volume_m3 - 1.0).abs() < 0.01,
        "{report:#?}"
    );
}

#[test]
fn ladders_have_a_handle_per_loop() {
    for (rungs, rough_m, voxel_m, chunk_m) in [
        (2, 0.0, 0.2, 16.0),
        (2, 0.5, 0.3, 8.0),
        (5, 0.5, 0.25, 16.0),
        (10, 0.4, 0.4, 32.0),
    ] {
        let (field, bounds) = ladder(rungs, rough_m, 7);
        let report = assert_lawful(&visuals(&chunks(&field, bounds, &whole(voxel_m, chunk_m))));
        assert_eq!((report.components, report.genus), (1, rungs as i64 - 1));
    }
}
#[test]
fn laws_hold_after_simplification() {
    for seed in 0..2 {
        let (field, bounds) = ladder(3, 0.6, seed);
        let settings = MeshSettings::default();
        let made = chunks(&field, bounds, &settings);
        let full = chunks(&field, bounds, &whole(0.2, 16.0));
        let seen = assert_lawful(&visuals(&made));
        let touched = assert_lawful(&collisions(&made));
        let full = assert_lawful(&visuals(&full));
        eprintln!(
            "{} {} {} {:?}",
            full.triangles, seen.triangles, touched.triangles, seen.min_angle_deg
        );
    }
}
#[test]
fn chunks_do_not_show_in_the_triangles() {
    let (field, bounds) = ladder(3, 0.6, 3);
    let sets = [8.0, 16.0, 64.0].map(|chunk_m| {
        let made = chunks(&field, bounds, &whole(0.25, chunk_m));
        triangle_set(&visuals(&made))
    });
    assert!(sets[0] == sets[1] && sets[1] == sets[2]);
}
#[test]
fn white_noise_is_manifold() {
    for seed in 0..3 {
        let (field, bounds) = white_noise(0.25, 40, seed);
        let settings = whole(0.25, 4.0);
        let made = chunks(&field, bounds, &settings);
        let report = Report::of(&weld(visuals(&made)));
        eprintln!("{report:#?}");
    }
}

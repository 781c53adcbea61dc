//! Laws of an atlas, on meshes that are rough, closed, or overlap themselves.

use std::collections::BTreeSet;

use crate::texture_support::{bubble, cross, dot, rough_passage, spiral, sub};
use plume::mesh::Mesh;
use plume::texture::TextureError;
use plume::texture::settings::Resolution;
use plume::texture::unwrap::{Unwrapped, gutter_px, unwrap};
use proptest::prelude::*;

fn meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("passage", rough_passage(150, 60, 15.0, 3)),
        ("long passage", rough_passage(300, 30, 60.0, 4)),
        ("spiral", spiral(3.0, 240, 30)),
        ("bubble", bubble(40, 60, 4.0)),
    ]
}

fn each_atlas(law: impl Fn(&str, &Mesh, &Unwrapped)) {
    for (name, mesh) in meshes() {
        for size_px in [256, 1000, 2048] {
            let cut = unwrap(&mesh, Resolution::SizePx(size_px)).expect("it fits");
            assert_eq!(cut.size_px, size_px);
            law(name, &mesh, &cut);
        }
    }
}

/// Corners in texels.
fn corners(cut: &Unwrapped, triangle: usize) -> [[f64; 2]; 3] {
    cut.triangles[triangle].map(|v| cut.uvs[v as usize].map(|c| f64::from(c) * f64::from(cut.size_px)))
}

fn doubled_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Texels whose centre is strictly inside, by brute force.
fn texels_inside(corners: [[f64; 2]; 3]) -> Vec<[i64; 2]> {
    let extent = |k: usize| {
        let values = corners.map(|c| c[k]);
        let low = values.into_iter().fold(f64::INFINITY, f64::min).floor() as i64;
        let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max).ceil() as i64;
        low..high
    };
    let inside = |x: i64, y: i64| {
        let p = [x as f64 + 0.5, y as f64 + 0.5];
        (0..3).all(|k| doubled_area([corners[k], corners[(k + 1) % 3], p]) > 1e-6)
    };
    extent(1).flat_map(|y| extent(0).map(move |x| [x, y])).filter(|&[x, y]| inside(x, y)).collect()
}

/// The triangle whose interior holds the centre of each texel, row by row; at most one may.
fn owners(cut: &Unwrapped) -> Vec<Option<u32>> {
    let size = cut.size_px as usize;
    let mut owners = vec![None; size * size];
    for triangle in 0..cut.triangles.len() {
        for [x, y] in texels_inside(corners(cut, triangle)) {
            let other = owners[y as usize * size + x as usize].replace(triangle as u32);
            assert_eq!(other, None, "texel {x} {y} has two triangles");
        }
    }
    owners
}

#[test]
fn no_texel_has_two_triangles_and_charts_keep_their_distance() {
    each_atlas(|name, _, cut| {
        let chart = |owner: &Option<u32>| owner.map(|t| cut.charts[t as usize]);
        let charts: Vec<_> = owners(cut).iter().map(chart).collect();
        let size = cut.size_px as usize;
        let gutter = gutter_px(cut.texels_per_m) as usize;
        for y in 0..size - gutter {
            for x in gutter..size - gutter {
                let at = y * size + x;
                let above = at + gutter * size;
                for near in [at + gutter, above - gutter, above, above + gutter] {
                    let apart = charts[at].is_none() || charts[near].is_none() || charts[at] == charts[near];
                    assert!(apart, "{name}: charts near texel {x} {y}");
                }
            }
        }
    });
}

#[test]
fn the_cut_mesh_is_the_mesh() {
    each_atlas(|name, mesh, cut| {
        assert_eq!(cut.source.len(), cut.uvs.len());
        let back: Vec<_> = cut.triangles.iter().map(|t| t.map(|v| cut.source[v as usize])).collect();
        assert_eq!(back, mesh.triangles, "{name}");
        let used: BTreeSet<u32> = cut.triangles.iter().flatten().copied().collect();
        assert_eq!(used.len(), cut.source.len(), "{name}: a vertex without a triangle");
    });
}

#[test]
fn vertices_are_split_at_seams_only() {
    each_atlas(|name, _, cut| {
        let mut copies = BTreeSet::new();
        for (triangle, &chart) in cut.triangles.iter().zip(&cut.charts) {
            copies.extend(triangle.map(|v| (cut.source[v as usize], chart)));
        }
        assert_eq!(copies.len(), cut.source.len(), "{name}");
    });
}

#[test]
fn coordinates_lie_inside_and_away_from_the_border() {
    each_atlas(|name, _, cut| {
        for &[u, v] in &cut.uvs {
            let margin = 1.0 / cut.size_px as f32;
            let inside = margin..=1.0 - margin;
            assert!(inside.contains(&u) && inside.contains(&v), "{name}: {u} {v}");
        }
    });
}

#[test]
fn every_chart_has_the_same_density_and_little_stretch() {
    each_atlas(|name, mesh, cut| {
        let mut stretches = vec![];
        for t in 0..cut.triangles.len() {
            let [a, b, c] = mesh.triangles[t].map(|v| mesh.position_m(v).map(f64::from));
            let normal = cross(sub(b, a), sub(c, a));
            let texels = doubled_area(corners(cut, t));
            // Seen along an axis, the area is a component of the area vector; a texel is rounded to 1/256.
            let density2 = square(f64::from(cut.texels_per_m));
            let seen = normal.map(|n| (n.abs() * density2 - texels).abs());
            let nearest = seen.into_iter().fold(f64::INFINITY, f64::min);
            let side = dot(normal, normal).sqrt().sqrt() * f64::from(cut.texels_per_m);
            assert!(nearest <= 0.01 * texels + 0.05 * side, "{name}: triangle {t} off by {nearest}");
            assert!(texels >= 0.0, "{name}: triangle {t} is mirrored");
            stretches.push(dot(normal, normal).sqrt() * density2 / texels.max(1e-9));
        }
        stretches.sort_by(f64::total_cmp);
        let p99 = stretches[stretches.len() * 99 / 100];
        assert!(p99 < 2.0, "{name}: p99 of stretch is {p99}");
    });
}

fn square(x: f64) -> f64 {
    x * x
}

#[test]
fn most_of_the_atlas_is_used() {
    for (name, mesh) in meshes() {
        let cut = unwrap(&mesh, Resolution::SizePx(1024)).unwrap();
        let owned = owners(&cut).iter().flatten().count() as f32 / (1024.0 * 1024.0);
        assert!((owned - cut.utilisation).abs() < 0.01, "{name}: {owned} against {}", cut.utilisation);
        assert!(owned >= 0.55, "{name}: {owned}");
    }
}

#[test]
fn a_density_is_kept_exactly_until_the_largest_size() {
    let mesh = rough_passage(150, 60, 15.0, 3);
    for density in [20.0, 60.0] {
        let cut = unwrap(&mesh, Resolution::TexelsPerM(density)).unwrap();
        assert_eq!(cut.texels_per_m, density);
        assert_eq!(cut.size_px % 64, 0);
        assert!(cut.utilisation > 0.5, "{}", cut.utilisation);
    }
    let cut = unwrap(&rough_passage(60, 20, 60.0, 3), Resolution::TexelsPerM(500.0)).unwrap();
    assert_eq!(cut.size_px, 16_384);
    assert!(cut.texels_per_m < 500.0);
}

#[test]
fn nothing_to_unwrap_is_no_error() {
    let cut = unwrap(&Mesh::default(), Resolution::SizePx(256)).unwrap();
    assert_eq!((cut.triangles.len(), cut.size_px), (0, 256));
}

#[test]
fn charts_that_are_all_gutter_are_an_error() {
    // Scattered triangles: as many charts.
    let mut mesh = Mesh::default();
    for k in 0..20_000 {
        let corner = [7000 * k, 0, 0];
        let first = 3 * k as u32;
        mesh.positions.extend([corner, [corner[0] + 400, 0, 0], [corner[0], 400, 0]]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh.normals = vec![[0.0, 0.0, 1.0]; mesh.positions.len()];
    let error = unwrap(&mesh, Resolution::SizePx(256)).unwrap_err();
    assert!(matches!(error, TextureError::TooSmall { charts: 20_000, size_px: 256 }), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn any_passage_unwraps_the_same_way_twice(seed: u64, along in 8..80_usize, around in 6..40_usize, length in 2.0..50.0) {
        let mesh = rough_passage(along, around, length, seed);
        let cut = unwrap(&mesh, Resolution::SizePx(512)).unwrap();
        owners(&cut);
        prop_assert_eq!(unwrap(&mesh, Resolution::SizePx(512)).unwrap(), cut);
    }
}

//! Laws of every rock. They are here and not beside the rocks because unit tests would compile all of them once more.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use nalgebra::Point3;
use plume_graph::{Graph, Node, StationId};
use plume_rock::field::{CaveField, Field, PassageSettings, Surface, Texel};
use plume_rock::material::{Look, MATERIALS};

/// A passage in every rock.
fn caves() -> impl Iterator<Item = (&'static str, CaveField)> {
    MATERIALS.iter().map(|row| {
        let node = |id, x| Node {
            id,
            parent: None,
            position: Point3::new(x, 0.0, 0.0),
            radius: 1.2,
            active: false,
            level: 0,
            section: None,
            name: None,
        };
        let graph = Graph::new(vec![node(0, 0.0), node(1, 12.0)], StationId::pairs([[0, 1]]));
        let rock = (row.read)(serde_json::json!({})).unwrap();
        (row.name, CaveField::new(&graph, &PassageSettings::default(), rock, Look::default(), 3))
    })
}

/// Points in a box around the passage with the distance of each, those that are less than `within_m` from the wall.
fn near_wall(field: &CaveField, within_m: f32) -> Vec<([f32; 3], f32)> {
    // Roberts's sequence, which fills a box evenly.
    let place = |n: u32| [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|step| (f64::from(n) * step).fract() as f32);
    let points: Vec<[f32; 3]> =
        (0..20_000).map(place).map(|[x, y, z]| [2.0 + 8.0 * x, 6.0 * y - 3.0, 5.0 * z - 2.5]).collect();
    let distances_m = field.distances_at(&points);
    points.into_iter().zip(distances_m).filter(|(_, distance_m)| distance_m.abs() < within_m).collect()
}

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values[values.len() / 2]
}

/// Where the wall is along the normals of points, by bisection; `None` where it is not within 12 cm.
fn on_wall(field: &CaveField, points: &[[f32; 3]], normals: &[[f32; 3]]) -> Vec<Option<[f32; 3]>> {
    const REACH_M: f32 = 0.12;
    let at = |places_m: &[f32]| -> Vec<[f32; 3]> {
        let moved = |(n, along_m): (usize, &f32)| [0, 1, 2].map(|axis| points[n][axis] + normals[n][axis] * along_m);
        places_m.iter().enumerate().map(moved).collect()
    };
    let count = points.len();
    // Rock behind, air ahead.
    let (mut rock_m, mut air_m) = (vec![-REACH_M; count], vec![REACH_M; count]);
    let (behind, ahead) = (field.distances_at(&at(&rock_m)), field.distances_at(&at(&air_m)));
    for _ in 0..12 {
        let middle_m: Vec<f32> = rock_m.iter().zip(&air_m).map(|(rock_m, air_m)| 0.5 * (rock_m + air_m)).collect();
        for (n, distance_m) in field.distances_at(&at(&middle_m)).into_iter().enumerate() {
            let end = if distance_m > 0.0 { &mut rock_m[n] } else { &mut air_m[n] };
            *end = middle_m[n];
        }
    }
    let found = at(&air_m).into_iter().enumerate();
    found.map(|(n, point)| (behind[n] > 0.0 && ahead[n] < 0.0).then_some(point)).collect()
}

fn texels(field: &CaveField, points: &[[f32; 3]], normals: &[[f32; 3]]) -> Vec<Texel> {
    let columns = |rows: &[[f32; 3]]| [0, 1, 2].map(|axis| rows.iter().map(|row| row[axis]).collect::<Vec<f32>>());
    let (points, normals) = (columns(points), columns(normals));
    let mut out = vec![Texel::default(); points[0].len()];
    field.dense_texels(0.0078, points.each_ref().map(Vec::as_slice), normals.each_ref().map(Vec::as_slice), &mut out);
    out
}

/// A mesh is some centimetres away from the wall that it stands for.
#[test]
fn texels_are_taken_at_the_wall() {
    for (rock, field) in caves() {
        let (points, distances_m): (Vec<_>, Vec<_>) = near_wall(&field, 0.08).into_iter().unzip();
        let normals = field.normals_at(&points);
        let walls = on_wall(&field, &points, &normals);
        let kept: Vec<usize> = (0..points.len()).filter(|&n| walls[n].is_some()).collect();
        let of = |rows: &[[f32; 3]]| -> Vec<[f32; 3]> { kept.iter().map(|&n| rows[n]).collect() };
        let walls: Vec<[f32; 3]> = walls.into_iter().flatten().collect();
        let (points, normals) = (of(&points), of(&normals));
        let off_m = median(kept.iter().map(|&n| distances_m[n].abs()).collect());
        let seen = texels(&field, &points, &normals);
        let there = texels(&field, &walls, &normals);
        let apart =
            |(one, other): (&Texel, &Texel)| (0..3).map(|n| (one.color[n] - other.color[n]).abs()).fold(0.0, f32::max);
        let differ = median(seen.iter().zip(&there).map(apart).collect());
        assert!(points.len() > 300 && off_m > 0.02, "{rock}: {} points, {off_m} m", points.len());
        assert!(differ < 0.001, "{rock}: colours differ by {differ}");
    }
}

#[cfg(target_arch = "x86_64")]
mod widths {
    use plume_rock::fearless_simd::{Level, Simd};
    use plume_rock::material::{
        BLOCK, CoarseBlock, Footprint, Ground, Look, MATERIALS, Material, Sites, SurfaceSamples,
    };
    use plume_rock::noise::{Source, with_level};

    /// A block along a line from the axis of a passage through its wall and down to its floor.
    fn sites() -> Sites {
        let ground = Ground { roughness_m: 0.08, natural: 0.7 };
        let mut sites = Sites::new(ground, Source::new(11));
        let points: Vec<[f32; 3]> = (0..BLOCK).map(|i| [i as f32 * 0.37, i as f32 * -0.21, i as f32 * 0.03]).collect();
        sites.place(&points);
        for lane in 0..BLOCK {
            let along = lane as f32 / BLOCK as f32;
            sites.wall.value[lane] = along * 2.0 - 1.5;
            sites.wall.gradient[0][lane] = 1.0;
            sites.height.value[lane] = 1.5 - along * 1.6;
            sites.height.gradient[2][lane] = 1.0;
            sites.up.value[lane] = 1.0 - along * 2.0;
            sites.half_width.value[lane] = 1.0 + along;
        }
        sites
    }

    fn everything(rock: &dyn Material) -> (Vec<u32>, Vec<[u32; 3]>, SurfaceSamples) {
        let sites = sites();
        let mut values = vec![0.0; BLOCK];
        rock.distances(&sites, &mut values);
        let mut slopes = vec![[0.0; 3]; BLOCK];
        rock.gradients(&sites, &mut slopes);
        let mut out = SurfaceSamples::default();
        let (look, footprint) = (Look::default(), Footprint { texel_m: 0.007 });
        let mut block = CoarseBlock::new(sites.ground, sites.source);
        rock.coarse(&sites, &mut block);
        rock.surface_samples(&block, &look, footprint, &[[0.6; BLOCK], [0.0; BLOCK], [0.8; BLOCK]], &mut out);
        let bits = values.into_iter().map(f32::to_bits).collect();
        (bits, slopes.into_iter().map(|slope| slope.map(f32::to_bits)).collect(), out)
    }

    #[test]
    fn rocks_are_the_same_on_every_width() {
        let level = Level::new();
        let wide = [level.as_avx2().map(|simd| simd.level()), level.as_avx512().map(|simd| simd.level())];
        for row in MATERIALS.iter() {
            let rock = (row.read)(serde_json::json!({})).unwrap();
            let on = |level: Level| with_level(level, || everything(&*rock));
            let narrow = on(level.as_sse2().expect("part of every x86-64").level());
            for wide in wide.into_iter().flatten() {
                assert_eq!(narrow, on(wide), "{} on {wide:?}", row.name);
            }
        }
    }
}

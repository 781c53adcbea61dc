//! What holds for the field of any cave, whatever its rock.

use std::io::Cursor;
use std::sync::Arc;

use fearless_simd::Simd;
use image::{ImageFormat, Rgb, RgbImage};
use nalgebra::Point3;
use plume::field::{Aabb, CaveField, Field, PassageSettings, Region, Surface, Texel};
use plume::graph::{Graph, Node, Section, Shape, StationId};
use plume::material::{Clad, DomainWarp, JUMP_M, Look, MATERIALS, Material, OwnMaps, Rock, STEEPEST, Site, Wall};
use plume::noise::Real;
use plume::picture::{Image, Tile};
use proptest::prelude::*;
use serde_json::{Map, Value, json};

fn node(id: u64, position: [f64; 3], width: f64) -> Node {
    Node {
        id,
        parent: None,
        position: Point3::from(position),
        radius: width / f64::from(PassageSettings::default().width_per_radius),
        active: false,
        level: 0,
        section: None,
        name: None,
    }
}

/// A ring with a room, a dead end, a shaft, a narrow passage and a mined drift.
fn graph() -> Graph {
    let mut nodes = vec![
        node(0, [0.0, 0.0, 0.0], 3.0),
        node(1, [8.0, 1.0, -1.0], 2.4),
        node(2, [13.0, 7.0, 0.0], 5.0),
        node(3, [5.0, 9.0, 1.0], 1.4),
        node(4, [-3.0, 6.0, 1.5], 2.0),
        node(5, [13.5, 7.5, -9.0], 2.6),
        node(6, [20.0, 9.0, 0.5], 1.4),
        node(7, [-9.0, 2.0, 0.0], 3.0),
        node(8, [-18.0, 2.0, 0.0], 3.0),
    ];
    for drift in &mut nodes[7..] {
        drift.section = Some(Section { width_m: 3.5, height_m: 3.0, shape: Shape::Drift });
    }
    let edges = [[0, 1], [0, 4], [0, 7], [1, 2], [2, 3], [2, 5], [2, 6], [3, 4], [7, 8]];
    Graph::new(nodes, StationId::pairs(edges))
}

/// A rock that relies on the defaults of its trait, with a wall that jumps by this much at every second metre.
#[derive(Debug)]
struct Plain {
    tear_m: f32,
}

impl Rock for Plain {
    fn domain_warp(&self) -> DomainWarp {
        DomainWarp { length_m: [6.0, 2.4], reach_m: [0.5, 0.2] }
    }

    #[inline(always)]
    fn wall<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Wall<T> {
        let (_, rest) = (site.point.x * 0.5).split();
        let recess = site.source.noise(1, site.point.scaled(0.5)) * 0.25 + rest * self.tear_m;
        let zero = T::zero(site.simd());
        Wall { recess, cavity: recess, state: zero, band: zero }
    }
}

fn cave(rock: Arc<dyn Material>) -> CaveField {
    CaveField::new(&graph(), &PassageSettings::default(), rock, Look::default(), 7)
}

/// A cave in every rock of the table, and in one that relies on the defaults of its trait.
fn caves() -> Vec<CaveField> {
    let rocks = MATERIALS.iter().map(|row| (row.read)(json!({})).expect("an empty object is valid"));
    rocks.chain([Arc::new(Plain { tear_m: 0.0 }) as Arc<dyn Material>]).map(cave).collect()
}

fn texels(field: &CaveField, bounds: Aabb<f32>, points: &[[f32; 3]]) -> Vec<Texel> {
    let mut out = vec![Texel::default(); points.len()];
    let normals = field.normals_at(points);
    field.texels(bounds, 0.007, points, &normals, &mut out);
    out
}

fn around(points: &[[f32; 3]]) -> Aabb<f32> {
    Aabb::from_points(points.iter().copied()).expect("there are points")
}

/// Points scattered over a box.
fn scattered(bounds: Aabb<f32>, count: u32) -> Vec<[f32; 3]> {
    let share = |i: u32, axis: u32| {
        let h = (i * 3 + axis + 1).wrapping_mul(0x9e37_79b1);
        ((h ^ (h >> 15)).wrapping_mul(0x85eb_ca6b) >> 8) as f32 / 16_777_216.0
    };
    let coordinate =
        |i: u32, axis: usize| bounds.min[axis] + share(i, axis as u32) * (bounds.max[axis] - bounds.min[axis]);
    (0..count).map(|i| [coordinate(i, 0), coordinate(i, 1), coordinate(i, 2)]).collect()
}

/// Scattered points within 0.2 m of the wall.
fn near_wall(field: &CaveField, count: u32) -> Vec<[f32; 3]> {
    let points = scattered(field.bounds(), count);
    let values = field.distances_at(&points);
    points.into_iter().zip(values).filter(|(_, v)| v.abs() < 0.2).map(|(p, _)| p).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_region_keeps_its_promise(
        which in any::<proptest::sample::Index>(),
        off in prop::array::uniform3(-1.5_f32..1.5),
        size in prop::array::uniform3(0.02_f32..2.0),
    ) {
        for field in caves() {
            let at = *which.get(&near_wall(&field, 3000));
            let min: [f32; 3] = std::array::from_fn(|i| at[i] + off[i]);
            let bounds = Aabb { min, max: std::array::from_fn(|i| min[i] + size[i]) };
            let region = field.region(bounds);
            let values = field.distances_at(&scattered(bounds, 200));
            match region {
                Region::Air => prop_assert!(values.iter().all(|v| *v < 0.0), "{bounds:?}"),
                Region::Rock => prop_assert!(values.iter().all(|v| *v > 0.0), "{bounds:?}"),
                Region::Mixed => {}
            }
        }
    }

    #[test]
    fn values_do_not_depend_on_the_batch(split in 1_usize..150, margin in 0.0_f32..30.0) {
        for field in caves() {
            let points = near_wall(&field, 3000);
            let tight = around(&points);
            let whole = texels(&field, tight, &points);
            let values = field.distances_at(&points);
            let parts = points.chunks(split).take(4);
            for (part, (whole, values)) in
                parts.zip(whole.chunks(split).zip(values.chunks(split)))
            {
                let bounds = around(part).padded(margin);
                prop_assert_eq!(&texels(&field, bounds, part)[..], whole);
                let mut out = vec![0.0; part.len()];
                field.distances(bounds, part, &mut out);
                prop_assert_eq!(&out[..], values);
            }
        }
    }
}

/// Texels of points near the wall by [`Surface::dense_texels`].
fn dense_texels(field: &CaveField, texel_m: f32, points: &[[f32; 3]], normals: &[[f32; 3]]) -> Vec<Texel> {
    let columns = |rows: &[[f32; 3]]| [0, 1, 2].map(|axis| rows.iter().map(|row| row[axis]).collect::<Vec<f32>>());
    let [points, normals] = [columns(points), columns(normals)];
    let mut out = vec![Texel::default(); points[0].len()];
    let [points, normals] = [&points, &normals].map(|columns| columns.each_ref().map(Vec::as_slice));
    field.dense_texels(texel_m, points, normals, &mut out);
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn dense_texels_do_not_depend_on_the_batch(split in 1_usize..150, texel_m in 0.003_f32..0.06) {
        for field in caves() {
            let points = near_wall(&field, 3000);
            let normals = field.normals_at(&points);
            let whole = dense_texels(&field, texel_m, &points, &normals);
            for start in (0..points.len()).step_by(split).take(4) {
                let part = start..(start + split).min(points.len());
                let texels = dense_texels(&field, texel_m, &points[part.clone()], &normals[part.clone()]);
                prop_assert_eq!(&texels[..], &whole[part]);
            }
        }
    }
}

/// Vectors are as wide as the processor has them, so a point has other company on another machine. In these places what is left out
/// where a whole vector does not need it was once off by rounding.
#[test]
fn a_point_does_not_depend_on_its_company() {
    let of = |name: &str| cave((MATERIALS.find(name).expect("a rock of ours").read)(json!({})).expect("no settings"));
    let (basalt, salt) = (of("basalt"), of("salt"));
    // The share of spalled rock is rounded to 1 here.
    let point = [14.056_15, 5.312_897_7, -4.669_8];
    let elsewhere = basalt.bounds().max;
    assert_eq!(basalt.normals_at(&[point])[0], basalt.normals_at(&[point, elsewhere])[0]);
    // All nodes of the lattice around this one have spalled, and their mean is rounded to more than 1.
    let points = near_wall(&salt, 3000);
    let normals = salt.normals_at(&points);
    let texels = |range: std::ops::Range<usize>| dense_texels(&salt, 0.0175, &points[range.clone()], &normals[range]);
    assert_eq!(texels(25..26)[0], texels(0..points.len())[25]);
}

/// Points moved along the normals of the field until they are on the wall without detail.
fn on_wall(field: &CaveField, mut points: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
    for _ in 0..8 {
        let (values, normals) = (field.distances_at(&points), field.normals_at(&points));
        for ((point, value), normal) in points.iter_mut().zip(values).zip(normals) {
            *point = std::array::from_fn(|axis| point[axis] + 0.6 * value * normal[axis]);
        }
    }
    let values = field.distances_at(&points);
    points.into_iter().zip(values).filter(|(_, value)| value.abs() < 1e-3).map(|(point, _)| point).collect()
}

/// What varies slowly is interpolated in dense texels: that is hard to see.
#[test]
fn dense_texels_are_close_to_the_surface() {
    let share = |mut numbers: Vec<f32>, share: f32| {
        numbers.sort_by(f32::total_cmp);
        numbers[(share * (numbers.len() - 1) as f32) as usize]
    };
    let mut faults = vec![];
    for (number, field) in caves().into_iter().enumerate() {
        let points = on_wall(&field, near_wall(&field, 40_000));
        let normals = field.normals_at(&points);
        let exact = texels(&field, around(&points), &points);
        let dense = dense_texels(&field, 0.007, &points, &normals);
        let pairs = || exact.iter().zip(&dense);
        let cosine = |(a, b): (&Texel, &Texel)| (0..3).map(|i| a.normal[i] * b.normal[i]).sum::<f32>();
        let angles_deg: Vec<f32> = pairs().map(|pair| cosine(pair).clamp(-1.0, 1.0).acos().to_degrees()).collect();
        let colors: Vec<f32> = pairs().map(|(a, b)| (a.color[1] - b.color[1]).abs() / a.color[1].max(0.01)).collect();
        let heights_m: Vec<f32> = pairs().map(|(a, b)| (a.height_m - b.height_m).abs()).collect();
        for (what, numbers, half, most) in [
            ("degrees", angles_deg, 1.5, 7.5),
            ("of a colour", colors, 0.01, 0.06),
            ("metres", heights_m, 0.0005, 0.0015),
        ] {
            let found = [0.5, 0.9].map(|part| share(numbers.clone(), part));
            if found[0] >= half || found[1] >= most {
                faults.push(format!("cave {number}: {found:?} {what} off"));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn regions_are_useful() {
    for field in caves() {
        let bounds = field.bounds();
        let regions: Vec<Region> = scattered(bounds, 20_000)
            .into_iter()
            .map(|min| field.region(Aabb { min, max: min.map(|c| c + 0.2) }))
            .collect();
        let share = |of: Region| regions.iter().filter(|r| **r == of).count() as f64 / regions.len() as f64;
        assert!(share(Region::Rock) > 0.6, "{}", share(Region::Rock));
        assert!(share(Region::Air) > 0.0002, "{}", share(Region::Air));
    }
}

#[test]
fn everything_beyond_the_bounds_is_rock() {
    for field in caves() {
        let bounds = field.bounds();
        let outside = |p: &[f32; 3]| !bounds.contains(*p);
        let points: Vec<_> = scattered(bounds.padded(6.0), 4000).into_iter().filter(outside).collect();
        assert!(field.distances_at(&points).iter().all(|v| *v > 0.0));
    }
}

#[test]
fn normals_point_down_the_field() {
    const STEP: f32 = 0.01;
    for field in caves() {
        let points = near_wall(&field, 20_000);
        let normals = field.normals_at(&points);
        let difference = |at: [f32; 3], axis: usize| {
            let moved = |by: f32| std::array::from_fn(|i| at[i] + if i == axis { by } else { 0.0 });
            let v = field.distances_at(&[moved(STEP), moved(-STEP)]);
            (v[1] - v[0]) / (2.0 * STEP)
        };
        let off = points.iter().zip(&normals).filter(|(at, normal)| {
            let slope: [f32; 3] = std::array::from_fn(|axis| difference(**at, axis));
            let length = slope.iter().map(|c| c * c).sum::<f32>().sqrt();
            let cosine: f32 = slope.iter().zip(*normal).map(|(a, b)| a * b / length).sum();
            cosine < 0.98
        });
        let share = off.count() as f64 / points.len() as f64;
        assert!(points.len() > 100 && share < 0.06, "{share} of {} normals are off", points.len());
    }
}

/// Every setting of a rock at its `bound`, `minimum` or `maximum`.
fn at_bound(schema: &Value, bound: &str) -> Value {
    let properties = schema["properties"].as_object().expect("settings are an object");
    let numbers = properties.iter().filter(|(_, property)| property[bound].is_number());
    Value::Object(numbers.map(|(key, property)| (key.clone(), property[bound].clone())).collect::<Map<_, _>>())
}

#[test]
fn no_wall_is_torn_or_too_steep() {
    for row in MATERIALS.iter() {
        let schema = (row.schema)().to_value();
        for settings in [json!({}), at_bound(&schema, "minimum"), at_bound(&schema, "maximum")] {
            let rock = (row.read)(settings.clone()).expect("bounds are valid");
            let Worst { jump_m, slope, at } = worst(&cave(rock));
            let where_to_look = "see the contract of `Rock`";
            assert!(jump_m < JUMP_M, "{} {settings} jumps by {jump_m} m at {at:?}; {where_to_look}", row.name);
            assert!(slope < STEEPEST, "{} {settings} rises by {slope} m a metre; {where_to_look}", row.name);
        }
    }
}

#[test]
fn a_torn_wall_is_noticed() {
    let whole = worst(&cave(Arc::new(Plain { tear_m: 0.0 })));
    assert!(whole.jump_m < JUMP_M && whole.slope < STEEPEST, "{whole:?}");
    for tear_m in [0.1, 0.3] {
        let torn = worst(&cave(Arc::new(Plain { tear_m })));
        assert!(torn.jump_m > 0.5 * tear_m && torn.jump_m > JUMP_M, "{torn:?}");
    }
}

/// The worst defects of a field near its wall.
#[derive(Debug)]
struct Worst {
    /// Change over a tenth of a millimetre, metres.
    jump_m: f32,
    /// Where that is.
    at: [f32; 3],
    /// Largest change over a centimetre that does not count as a jump, per metre.
    slope: f32,
}

/// Samples the field along many short lines near the wall.
fn worst(field: &CaveField) -> Worst {
    const STEPS: usize = 48;
    const STEP_M: f32 = 0.01;
    /// How far from the wall a field matters, in its own metres.
    const NEAR_M: f32 = 0.25;
    let starts = near_wall(field, 100_000);
    let directions = scattered(Aabb { min: [-1.0; 3], max: [1.0; 3] }, starts.len() as u32);
    let mut worst = Worst { jump_m: 0.0, at: [0.0; 3], slope: 0.0 };
    for (start, direction) in starts.iter().zip(&directions) {
        let length = direction.iter().map(|c| c * c).sum::<f32>().sqrt();
        let point = |n: usize| std::array::from_fn(|axis| start[axis] + direction[axis] / length * STEP_M * n as f32);
        let points: Vec<[f32; 3]> = (0..=STEPS).map(point).collect();
        let values = field.distances_at(&points);
        let rise = |n: &usize| (values[*n + 1] - values[*n]).abs();
        let near = (0..STEPS).filter(|n| values[*n].abs() < NEAR_M && values[n + 1].abs() < NEAR_M);
        let Some(n) = near.max_by(|a, b| rise(a).total_cmp(&rise(b))) else { continue };
        let [a, b] = narrowed(field, [points[n], points[n + 1]], [values[n], values[n + 1]]);
        let jump_m = (b.1 - a.1).abs();
        if jump_m > worst.jump_m {
            worst = Worst { jump_m, at: a.0, ..worst };
        }
        worst.slope = worst.slope.max((rise(&n) - jump_m) / STEP_M);
    }
    worst
}

/// A point and its value.
type Sample = ([f32; 3], f32);

/// The steepest of 128 parts of a step, found by bisection.
fn narrowed(field: &CaveField, points: [[f32; 3]; 2], values: [f32; 2]) -> [Sample; 2] {
    let [mut a, mut b] = [(points[0], values[0]), (points[1], values[1])];
    for _ in 0..7 {
        let middle = std::array::from_fn(|axis| (a.0[axis] + b.0[axis]) / 2.0);
        let middle = (middle, field.distances_at(&[middle])[0]);
        if (middle.1 - a.1).abs() > (b.1 - middle.1).abs() { b = middle } else { a = middle }
    }
    [a, b]
}

#[test]
fn texels_are_in_range() {
    for field in caves() {
        let points = near_wall(&field, 10_000);
        let mesh_normals = field.normals_at(&points);
        let texels = texels(&field, around(&points), &points);
        for (texel, mesh) in texels.iter().zip(mesh_normals) {
            let dot = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f32>();
            assert!((dot(texel.normal, texel.normal) - 1.0).abs() < 1e-4);
            assert!(dot(texel.normal, mesh) > 0.15);
            assert!(texel.color.iter().all(|c| (0.0..=1.0).contains(c)));
            assert!((0.05..=1.0).contains(&texel.roughness));
            assert!((0.0..=1.0).contains(&texel.occlusion));
        }
    }
}

#[test]
fn every_station_is_in_air() {
    for field in caves() {
        let stations: Vec<[f32; 3]> =
            graph().nodes.iter().map(|n| n.position.coords.map(|c| c as f32).into()).collect();
        assert!(field.distances_at(&stations).iter().all(|v| *v < 0.0));
    }
}

/// A robot 0.7 m wide and 0.6 m high gets through the narrowest passage, over stones and swells of 0.18 m.
#[test]
fn a_robot_gets_through() {
    let settings = PassageSettings::default();
    let width = f64::from(settings.width_min_m);
    let nodes = vec![node(0, [0.0; 3], width), node(1, [30.0, 0.0, 0.0], width)];
    let graph = Graph::new(nodes, StationId::pairs([[0, 1]]));
    for row in MATERIALS.iter() {
        for seed in 0..3 {
            let rock = (row.read)(json!({})).expect("an empty object is valid");
            let field = CaveField::new(&graph, &settings, rock, Look::default(), seed);
            let mut lanes: Vec<f32> = (-8..=8).map(|i| i as f32 * 0.05).collect();
            for step in 0..110 {
                let x = 1.0 + step as f32 * 0.25;
                let open = (-8..=8).map(|i| i as f32 * 0.05).filter(|y| fits(&field, x, *y));
                lanes = open.filter(|y| lanes.iter().any(|last| (y - last).abs() < 0.16)).collect();
                assert!(!lanes.is_empty(), "{} seed {seed}: stuck at x = {x} m", row.name);
            }
        }
    }
}

fn fits(field: &CaveField, x: f32, y: f32) -> bool {
    let floor = field.floor_z([x, y, 0.0]);
    let across = [-0.35, -0.2, 0.0, 0.2, 0.35];
    let up = [0.18, 0.3, 0.45, 0.6, 0.75];
    let points: Vec<[f32; 3]> = across.iter().flat_map(|dy| up.iter().map(move |dz| [x, y + dy, floor + dz])).collect();
    field.distances_at(&points).iter().all(|v| *v < 0.0)
}

#[test]
fn seed_changes_the_rock_and_look_does_not() {
    let rock = || (MATERIALS.default_row().read)(json!({})).expect("an empty object is valid");
    let settings = PassageSettings::default();
    let wet = Look { humidity: 1.0, ..Look::default() };
    let one = CaveField::new(&graph(), &settings, rock(), Look::default(), 1);
    let same = CaveField::new(&graph(), &settings, rock(), wet, 1);
    let other = CaveField::new(&graph(), &settings, rock(), Look::default(), 2);
    let points = near_wall(&one, 2000);
    assert_eq!(one.distances_at(&points), same.distances_at(&points));
    assert_ne!(one.distances_at(&points), other.distances_at(&points));
    let bounds = around(&points);
    assert_ne!(texels(&one, bounds, &points), texels(&same, bounds, &points));
}

/// A tint multiplies colours and nothing else, in every rock.
#[test]
fn tints_multiply_colours() {
    let factors = [0.5, 1.0, 1.7];
    for row in MATERIALS.iter() {
        let tinted = |tint| {
            let rock = (row.read)(json!({})).expect("an empty object is valid");
            CaveField::new(&graph(), &PassageSettings::default(), rock, Look { tint, ..Look::default() }, 7)
        };
        let points = near_wall(&tinted([1.0; 3]), 2000);
        let [plain, tinted] = [[1.0; 3], factors].map(|tint| texels(&tinted(tint), around(&points), &points));
        for (mut plain, tinted) in plain.into_iter().zip(tinted) {
            for (value, factor) in plain.color.iter_mut().zip(factors) {
                *value = (*value * factor).clamp(0.0, 1.0);
            }
            assert_eq!(plain, tinted, "{}", row.name);
        }
    }
}

/// Every colour of a rock that is a setting shows somewhere, and changes nothing but colours.
#[test]
fn colors_of_a_rock_change_colours_only() {
    for row in MATERIALS.iter() {
        let schema = (row.schema)().to_value();
        let lithologies = || schema["properties"]["lithology"]["oneOf"].as_array().into_iter().flatten();
        for key in schema["properties"]["colors"]["properties"].as_object().into_iter().flatten().map(|(key, _)| key) {
            let of = |words: &Value| words["const"].as_str().filter(|name| key.starts_with(name)).map(str::to_owned);
            let lithology =
                lithologies().find_map(of).or_else(|| key.starts_with("mudstone").then(|| "coal".to_owned()));
            let mut settings = lithology.map_or(json!({}), |lithology| json!({"lithology": lithology}));
            let painted = |rock: Value| {
                let rock = (row.read)(rock).expect("the settings are valid");
                CaveField::new(&graph(), &PassageSettings::default(), rock, Look::default(), 7)
            };
            let plain = painted(settings.clone());
            settings["colors"] = json!({key: [1.0, 0.0, 1.0]});
            let magenta = painted(settings);
            let points = near_wall(&plain, 6000);
            assert_eq!(plain.distances_at(&points), magenta.distances_at(&points), "{}: {key}", row.name);
            let [before, after] = [plain, magenta].map(|field| texels(&field, around(&points), &points));
            assert_ne!(before, after, "{}: {key}", row.name);
            for (before, mut after) in before.into_iter().zip(after) {
                after.color = before.color;
                assert_eq!(before, after, "{}: {key}", row.name);
            }
        }
    }
}

/// A tile of one value.
fn tile(value: [u8; 3], tile: Tile) -> Image {
    let mut png = Cursor::new(Vec::new());
    RgbImage::from_pixel(4, 4, Rgb(value)).write_to(&mut png, ImageFormat::Png).expect("it is written to memory");
    Image::read_tile(png.get_ref(), tile).expect("it is a tile")
}

/// Maps of the user's own give a rock its colours, tilt its normals as far as a normal map can hold, and leave its shape.
#[test]
fn own_maps_change_looks_and_no_shape() {
    const STEEP: [u8; 3] = [255, 128, 128];
    const FLAT: [u8; 3] = [128, 128, 255];
    for row in MATERIALS.iter() {
        let rock = || (row.read)(json!({})).expect("an empty object is valid");
        let clad = |normal: [u8; 3]| {
            let maps = OwnMaps {
                base_color: tile([255, 0, 0], Tile::Colors),
                normal: Some(tile(normal, Tile::Vectors)),
                roughness: Some(tile([51; 3], Tile::Numbers)),
                tile_m: 2.0,
            };
            cave(Arc::new(Clad { rock: rock(), maps: Arc::new(maps) }))
        };
        let (bare, steep, flat) = (cave(rock()), clad(STEEP), clad(FLAT));
        let points = near_wall(&bare, 2000);
        assert_eq!(bare.distances_at(&points), steep.distances_at(&points));
        let mesh_normals = bare.normals_at(&points);
        let [bare, steep, flat] = [bare, steep, flat].map(|field| texels(&field, around(&points), &points));
        let cosine = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let mut tilted = 0;
        for (n, mesh_normal) in mesh_normals.into_iter().enumerate() {
            for texel in [steep[n], flat[n]] {
                let far = texel.color.iter().zip([1.0, 0.0, 0.0]).any(|(value, wanted)| (value - wanted).abs() > 1e-5);
                assert!(!far && (texel.roughness - 0.2).abs() < 1e-5, "{}: {texel:?}", row.name);
                assert!((cosine(texel.normal, texel.normal) - 1.0).abs() < 1e-4, "{}: {texel:?}", row.name);
                assert!(cosine(texel.normal, mesh_normal) > 0.499, "{}: {texel:?}", row.name);
                assert_eq!((texel.height_m, texel.occlusion), (bare[n].height_m, bare[n].occlusion), "{}", row.name);
            }
            assert!(cosine(flat[n].normal, bare[n].normal) > 0.999, "{}: {:?}", row.name, flat[n]);
            tilted += usize::from(cosine(steep[n].normal, bare[n].normal) < 0.9);
        }
        assert!(4 * tilted > 3 * points.len(), "{}: {tilted} of {} normals", row.name, points.len());
    }
}

/// The share of walls that glisten follows the humidity, in every rock.
#[test]
fn humidity_is_even_in_effect() {
    const ROUGHNESS_OF_WET_ROCK: f32 = 0.35;
    for row in MATERIALS.iter() {
        let mut walls = 0;
        let mut wet = [0; 5];
        for seed in 0..10 {
            let humid = |humidity| {
                let rock = (row.read)(json!({})).expect("an empty object is valid");
                let look = Look { humidity, ..Look::default() };
                // Of the rock alone: heaps change which walls are counted.
                let settings = PassageSettings { collapse: 0.0, ..PassageSettings::default() };
                CaveField::new(&graph(), &settings, rock, look, seed)
            };
            let dry = humid(0.0);
            let points = near_wall(&dry, 30_000);
            let normals = dry.normals_at(&points);
            let steep = points.iter().zip(normals).filter(|(_, normal)| normal[2].abs() < 0.5);
            let points: Vec<[f32; 3]> =
                steep.map(|(point, _)| *point).filter(|point| point[2] - dry.floor_z(*point) > 0.6).collect();
            walls += points.len();
            for (n, wet) in wet.iter_mut().enumerate() {
                let texels = texels(&humid(n as f32 / 4.0), around(&points), &points);
                *wet += texels.iter().filter(|texel| texel.roughness < ROUGHNESS_OF_WET_ROCK).count();
            }
        }
        let shares = wet.map(|wet| 100 * wet / walls);
        for (share, wanted) in shares.into_iter().zip([0, 15, 30, 45, 60]) {
            assert!(share.abs_diff(wanted) <= 5, "{}: {shares:?} % of {walls} places are wet", row.name);
        }
    }
}

#[test]
fn rocks_refuse_unknown_settings() {
    for row in MATERIALS.iter() {
        let fault = (row.read)(json!({ "colour": 3 })).expect_err("not a setting");
        assert!(fault.to_string().contains("colour"), "{}: {fault}", row.name);
    }
}

/// A point displaced by its height is on the wall with all detail, within the accuracy of a first-order step.
#[test]
fn height_maps_lead_to_the_wall() {
    for field in caves() {
        let points = near_wall(&field, 3000);
        let bounds = around(&points).padded(0.5);
        let here = texels(&field, bounds, &points);
        let moved: Vec<[f32; 3]> = points
            .iter()
            .zip(&here)
            .map(|(point, texel)| std::array::from_fn(|axis| point[axis] + texel.height_m * texel.normal[axis]))
            .collect();
        let there = texels(&field, bounds, &moved);
        let median = |texels: &[Texel]| {
            let mut heights: Vec<f32> = texels.iter().map(|texel| texel.height_m.abs()).collect();
            heights.sort_by(f32::total_cmp);
            heights[heights.len() / 2]
        };
        let (before_m, after_m) = (median(&here), median(&there));
        assert!(after_m < 0.25 * before_m, "{after_m} m after a step, {before_m} m before");
    }
}

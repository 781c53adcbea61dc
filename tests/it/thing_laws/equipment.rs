//! The laws of what miners build in, and of objects left for search tasks.

use super::{Cave, assert_have_own_identities, assert_the_corridor_is_free};
use crate::common::distance::corners;
use crate::common::world::small;
use nalgebra::{Point3, Vector3};
use plume::things::{KINDS, Place, Thing};

/// A mine with timbered and bolted drifts.
fn mine(rock: &'static str) -> Cave {
    let row = plume::generators::GENERATORS.find("mine").unwrap();
    Cave::new(format!("mine in {rock}"), small(row, 24, 1), rock, 16.0)
}

#[test]
fn equipment_is_built_into_mines() {
    for rock in ["drilled", "salt"] {
        let cave = mine(rock);
        let things = cave.things();
        let of = |kind: &str| things.iter().filter(|thing| thing.kind == kind).collect::<Vec<_>>();
        for row in KINDS.iter().filter(|row| row.place.is_built() && row.is_in(rock)) {
            assert!(!of(row.name).is_empty(), "{}: no {}", cave.name, row.name);
        }
        assert_the_corridor_is_free(&cave, &things);
        assert_posts_carry_beams(&cave, &of("post"), &of("beam"));
        assert_beams_carry_boards(&cave, &of("beam"), &of("lagging"));
        assert_bolts_are_in_the_roof(&cave, &of("rock_bolt"), &of("roof_mesh"));
        assert_runs_end_in_the_wall(&cave, &of("pipe"), &of("pipe_elbow"));
        assert_runs_end_in_the_wall(&cave, &of("cable"), &of("cable_end"));
        assert_nothing_lies_in_equipment(&cave, &things);
    }
}

/// Bolts touch the roof, or press mesh against it; and all mesh is held.
fn assert_bolts_are_in_the_roof(cave: &Cave, bolts: &[&Thing], meshes: &[&Thing]) {
    let is_held =
        |mesh: &Thing, bolt: &Thing| (bolt.pose.translation.vector - mesh.pose.translation.vector).norm() < 1e-6;
    for bolt in bolts {
        let most_m = if meshes.iter().any(|mesh| is_held(mesh, bolt)) { 0.125 } else { 0.005 };
        let gap_m = roof_m(cave, bolt.pose.translation.vector) - bolt.pose.translation.vector.z;
        assert!(gap_m.abs() < most_m, "{}: {gap_m} m over {bolt:?}", cave.name);
    }
    for mesh in meshes {
        assert!(bolts.iter().any(|bolt| is_held(mesh, bolt)), "{}: nothing holds {mesh:?}", cave.name);
    }
}

/// No piece of a run is alone, and nearly all ends are next to another piece or turn into the rock; some are too far from it.
fn assert_runs_end_in_the_wall(cave: &Cave, pieces: &[&Thing], elbows: &[&Thing]) {
    /// Gap at a bend of the passage, in metres.
    const GAP_M: f64 = 0.8;
    let half_m = |piece: &Thing| 0.5 * cave.prototype(piece).size_m.x * piece.scale;
    let ends = |piece: &Thing| [-1.0, 1.0].map(|way| piece.pose * Point3::new(way * half_m(piece), 0.0, 0.0));
    let goes_on = |n: usize, end: &Point3<f64>| {
        let others = pieces.iter().enumerate().filter(|(other, _)| *other != n);
        others.flat_map(|(_, other)| ends(other)).any(|other| (other - end).norm() < GAP_M)
    };
    let turns =
        |end: &Point3<f64>| elbows.iter().any(|elbow| (elbow.pose.translation.vector - end.coords).norm() < 0.05);
    for (n, piece) in pieces.iter().enumerate() {
        assert!(ends(piece).iter().any(|end| goes_on(n, end)), "{}: {piece:?} is alone", cave.name);
    }
    let all = pieces.iter().enumerate().flat_map(|(n, piece)| ends(piece).map(|end| (n, end)));
    let open = all.filter(|(n, end)| !goes_on(*n, end) && !turns(end)).count();
    assert!(5 * open <= elbows.len(), "{}: {open} open ends, {} elbows", cave.name, elbows.len());
    for elbow in elbows {
        let points: Vec<[f32; 3]> = cave.hull(elbow).into_iter().map(|at| at.map(|c| c as f32).into()).collect();
        let deepest = cave.field.scattered(&points).into_iter().fold(f32::MIN, f32::max);
        assert!(deepest > 0.0, "{}: {elbow:?} ends {deepest} m before the wall", cave.name);
    }
}

/// Height of the lowest roof over a point, or just below it, found by going through every triangle.
fn roof_m(cave: &Cave, at: Vector3<f64>) -> f64 {
    let above = column(cave, at).into_iter().filter(|(z, up)| *up < 0.0 && *z > at.z - 0.1);
    above.map(|(z, _)| z).fold(f64::MAX, f64::min)
}

/// Heights of the triangles over and under a point, and the upward component of their normals.
fn column(cave: &Cave, at: Vector3<f64>) -> Vec<(f64, f64)> {
    let walls = cave.walls.iter().flat_map(|(_, wall)| wall.triangles.iter().map(|triangle| corners(wall, *triangle)));
    let height = |[a, b, c]: [Vector3<f64>; 3]| {
        let side = |p: &Vector3<f64>, q: &Vector3<f64>| (q.x - p.x) * (at.y - p.y) - (q.y - p.y) * (at.x - p.x);
        let (ab, bc, ca) = (side(&a, &b), side(&b, &c), side(&c, &a));
        let is_here = ab * bc > 0.0 && bc * ca > 0.0;
        let up = (b - a).cross(&(c - a)).z;
        is_here.then(|| ((a.z * bc + b.z * ca + c.z * ab) / (ab + bc + ca), up))
    };
    walls.filter_map(height).collect()
}

/// Both ends of each board lie on beams.
fn assert_beams_carry_boards(cave: &Cave, beams: &[&Thing], boards: &[&Thing]) {
    for board in boards {
        let half_m = 0.5 * cave.prototype(board).size_m.x * board.scale;
        for end in [-half_m, half_m] {
            let end = board.pose * Point3::new(end, 0.0, 0.0);
            let over = |beam: &&&Thing| {
                let at = beam.pose.inverse_transform_point(&end);
                let half = cave.prototype(beam).size_m * (0.5 * beam.scale);
                (at.x.abs() < half.x && at.y.abs() < half.y).then_some((at.z - half.z).abs())
            };
            let gap_m = beams.iter().filter_map(|beam| over(&beam)).fold(f64::MAX, f64::min);
            assert!(gap_m < 0.02, "{}: {gap_m} m under an end of {board:?}", cave.name);
        }
    }
}

/// Posts stand on the floor under a beam that touches the roof.
fn assert_posts_carry_beams(cave: &Cave, posts: &[&Thing], beams: &[&Thing]) {
    assert_eq!(posts.len(), 2 * beams.len(), "{}", cave.name);
    let ends = |thing: &Thing| {
        let heights: Vec<f64> = cave.hull(thing).iter().map(|at| at.z).collect();
        [heights.iter().copied().fold(f64::MAX, f64::min), heights.into_iter().fold(f64::MIN, f64::max)]
    };
    for post in posts {
        let at = post.pose.translation.vector;
        let [foot, top] = ends(post);
        let floor = column(cave, Vector3::new(at.x, at.y, 0.5 * (foot + top)));
        let floor = floor.into_iter().filter(|(z, up)| *up > 0.0 && *z < top).map(|(z, _)| z).fold(f64::MIN, f64::max);
        assert!((floor - foot - post.embedding_m).abs() < 0.02, "{}: {floor} m under {post:?}", cave.name);
        let is_over = |beam: &&&Thing| (beam.pose.translation.vector - at).xy().norm() < 3.5;
        let under = beams.iter().filter(is_over).map(|beam| (ends(beam)[0] - top).abs()).fold(f64::MAX, f64::min);
        assert!(under < 0.02, "{}: {under} m over {post:?}", cave.name);
    }
    for beam in beams {
        let [_, top] = ends(beam);
        let half_m = 0.46 * cave.prototype(beam).size_m.y * beam.scale;
        let across = beam.pose.rotation * Vector3::y();
        let place = |n: i32| beam.pose.translation.vector + across * (half_m * f64::from(n) / 20.0);
        let gaps = (-20..=20).map(|n| roof_m(cave, Vector3::new(place(n).x, place(n).y, top)) - top);
        let least = gaps.fold(f64::MAX, f64::min);
        assert!(least < 0.10, "{}: {least} m over {beam:?}", cave.name);
    }
}

/// Stones lie beside what stands on the floor, and posts, drums and sleepers beside each other.
fn assert_nothing_lies_in_equipment(cave: &Cave, things: &[Thing]) {
    let reach_m = |thing: &Thing| cave.prototype(thing).reach_m * thing.scale;
    let stands = |thing: &&Thing| ["post", "drum"].contains(&&*thing.kind);
    for (n, built) in things.iter().enumerate().filter(|(_, thing)| stands(thing)) {
        let others = things
            .iter()
            .enumerate()
            .filter(|(other, thing)| *other != n && (cave.is_loose(thing) || stands(thing) || thing.kind == "sleeper"));
        for (_, other) in others {
            let apart = (other.pose.translation.vector - built.pose.translation.vector).xy().norm();
            let near_m = if cave.is_loose(other) { 0.9 * reach_m(built) } else { reach_m(built) };
            assert!(apart > near_m, "{}: {other:?} is in {built:?}", cave.name);
        }
    }
}

/// Objects for search tasks lie beside the way in every rock, as many as there is room for.
#[test]
fn artefacts_are_spread_along_the_passages() {
    const WANTED: u32 = 9;
    for (generator, rock) in [("gaussian-perlin", "limestone"), ("worms", "basalt"), ("mine", "salt")] {
        let row = plume::generators::GENERATORS.find(generator).unwrap();
        let mut cave = Cave::new(format!("{generator} in {rock}"), small(row, 24, 1), rock, 16.0);
        assert!(!cave.things().iter().any(is_artefact), "{}", cave.name);
        cave.settings.artefacts = WANTED;
        let things = cave.things();
        let artefacts: Vec<Thing> = things.into_iter().filter(is_artefact).collect();
        assert!((7..=WANTED as usize).contains(&artefacts.len()), "{}: {}", cave.name, artefacts.len());
        assert_the_corridor_is_free(&cave, &artefacts);
        assert_have_own_identities(&cave, &artefacts);
        for artefact in &artefacts {
            let at = artefact.pose.translation.vector;
            let floors = column(&cave, at).into_iter().filter(|(_, up)| *up > 0.0).map(|(z, _)| (z - at.z).abs());
            let gap_m = floors.fold(f64::MAX, f64::min);
            assert!(gap_m < 0.06, "{}: {gap_m} m from the floor: {artefact:?}", cave.name);
        }
    }
}

fn is_artefact(thing: &Thing) -> bool {
    matches!(KINDS.find(&thing.kind).unwrap().place, Place::Lost)
}

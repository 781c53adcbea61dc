//! The laws of things, in every rock and in the caves of every generator.

mod dressed;
mod equipment;
mod gravel;
mod models;

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use crate::common::assert_whole;
use crate::common::distance::corners;
use crate::common::world::{kinds, small};
use nalgebra::{Point3, Vector3};
use plume::Recipe;
use plume::field::{CaveField, PassageSettings};
use plume::graph::{Aabb, Graph, Node, StationId};
use plume::material::{Look, MATERIALS};
use plume::mesh::measure::Report;
use plume::mesh::{Grid, MOST_CORNERS, Mesh, MeshSettings, visual_chunk};
use plume::things::{
    Body, Dress, KINDS, Kinds, Library, Place, Prototype, Replica, Setting, Shelf, Thing, ThingSettings, place, strew,
};

/// Stones may be this far above what they rest on, or below, beside the depth to which they were sunk.
const TOUCH_M: f64 = 0.005;

fn shelf(kinds: Kinds, replicas: &[Arc<Replica>]) -> Shelf {
    let plain = Recipe::from_overrides(&[format!("rock.kind={}", kinds.rock)]).unwrap();
    let material = |setting: Option<(&'static str, f64)>| match setting {
        Some((key, value)) => plain.with(&format!("rock.{key}"), value).unwrap().rock().clone(),
        None => plain.rock().clone(),
    };
    Shelf::new(&Dress { kinds, replicas, material: &material, look: &Look::default(), seed: 7 })
}

/// All built-in kinds of this rock.
fn kinds_of(rock: &'static str) -> Kinds<'static> {
    Kinds { rock, has_artefacts: true, files: &[] }
}

/// The prototypes of every rock, made once for all laws.
static LIBRARIES: LazyLock<BTreeMap<&'static str, (Library<'static>, Mesh)>> = LazyLock::new(|| {
    let made = |rock: &'static str| {
        let shelf = shelf(kinds_of(rock), &[]);
        (rock, Library::of_shelf(kinds_of(rock), &shelf))
    };
    MATERIALS.iter().map(|row| made(row.name)).collect()
});

fn library(rock: &str) -> &'static (Library<'static>, Mesh) {
    &LIBRARIES[rock]
}

/// A cave with its walls and its things, chunk by chunk.
struct Cave {
    name: String,
    graph: Graph,
    field: CaveField,
    library: Library<'static>,
    kinds: Kinds<'static>,
    walls: Vec<(Aabb<f64>, Mesh)>,
    settings: ThingSettings,
    seed: u64,
}

impl Cave {
    fn new(name: String, graph: Graph, rock: &'static str, chunk_m: f32) -> Self {
        let material = (MATERIALS.find(rock).unwrap().read)(serde_json::json!({})).unwrap();
        let field = CaveField::new(&graph, &PassageSettings::default(), material, Look::default(), 7);
        let mesh = MeshSettings { chunk_m: [chunk_m; 3], ..MeshSettings::default() };
        let grid = Grid::new(field.bounds(), &mesh).unwrap();
        let bounds = |index| {
            let Aabb { min, max } = grid.chunk_bounds(index);
            Aabb { min: min.map(f64::from), max: max.map(f64::from) }
        };
        let made = grid.indices().filter_map(|index| Some((bounds(index), visual_chunk(&field, &grid, index, &mesh)?)));
        let walls = made.collect();
        let (library, kinds, settings) = (library(rock).0.clone(), kinds_of(rock), ThingSettings::default());
        Self { name, graph, field, library, kinds, walls, settings, seed: 7 }
    }

    fn setting(&self) -> Setting<'_> {
        let Self { graph, field, library, kinds, settings, seed, .. } = self;
        Setting { library, settings, kinds: *kinds, field, graph, seed: *seed }
    }

    fn things(&self) -> Vec<Thing> {
        let all = || self.walls.iter().map(|(_, wall)| wall);
        self.walls.iter().flat_map(|(bounds, _)| place(&self.setting(), *bounds, all())).collect()
    }

    fn prototype(&self, thing: &Thing) -> &Prototype<'static> {
        self.library.named(&thing.prototype).expect(&self.name)
    }

    /// Points on the hull of a thing.
    fn hull(&self, thing: &Thing) -> Vec<Point3<f64>> {
        let hull = &self.prototype(thing).hull;
        let at = |corner: &Point3<f64>| thing.pose * (corner * thing.scale);
        let corners: Vec<Point3<f64>> = hull.corners.iter().map(at).collect();
        let faces = hull.faces.iter().map(|face| face.map(|corner| corners[corner as usize].coords));
        faces.flat_map(|[a, b, c]| [a, b, c, (a + b + c) / 3.0, (a + b) / 2.0]).map(Point3::from).collect()
    }

    fn is_loose(&self, thing: &Thing) -> bool {
        self.prototype(thing).row.place.is_loose()
    }
}

fn hangs(thing: &Thing) -> bool {
    KINDS.find(&thing.kind).is_some_and(|row| matches!(row.place, Place::Ceiling(_)))
}

/// Every generator, and every rock.
fn caves() -> Vec<Cave> {
    let named = kinds().into_iter().zip(1..);
    named
        .map(|((generator, rock), seed)| {
            let name = format!("{} in {}, seed {seed}", generator.name, rock.name);
            Cave::new(name, small(generator, 5, seed), rock.name, 16.0)
        })
        .collect()
}

/// Distance of a point from the plane of what is nearest above or below it and faces upwards, found by going through every
/// triangle.
fn gap(triangles: &[[Vector3<f64>; 3]], at: Point3<f64>, reach_m: f64) -> Option<f64> {
    let gaps = triangles.iter().filter_map(|[a, b, c]| {
        let side = |p: &Vector3<f64>, q: &Vector3<f64>| (q.x - p.x) * (at.y - p.y) - (q.y - p.y) * (at.x - p.x);
        let (ab, bc, ca) = (side(a, b), side(b, c), side(c, a));
        let is_floor = ab > 0.0 && bc > 0.0 && ca > 0.0;
        let up = (b - a).cross(&(c - a)).normalize().z;
        is_floor.then(|| (at.z - (a.z * bc + b.z * ca + c.z * ab) / (ab + bc + ca), up))
    });
    let near = gaps.filter(|(above_m, _)| above_m.abs() < reach_m);
    near.min_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs())).map(|(above_m, up)| above_m * up)
}

/// The triangles of walls near a thing, and those of stones of larger kinds.
fn near(cave: &Cave, things: &[Thing], thing: &Thing, reach_m: f64) -> Vec<[Vector3<f64>; 3]> {
    let at = thing.pose.translation.vector;
    let is_near = |triangle: &[Vector3<f64>; 3]| {
        (0..2).all(|axis| {
            let along = triangle.map(|corner| corner[axis]);
            let (low, high) =
                (along.iter().copied().fold(f64::MAX, f64::min), along.iter().copied().fold(f64::MIN, f64::max));
            low - reach_m < at[axis] && at[axis] < high + reach_m
        })
    };
    let of_walls =
        cave.walls.iter().flat_map(|(_, wall)| wall.triangles.iter().map(|triangle| corners(wall, *triangle)));
    let widest_m = |thing: &Thing| match KINDS.find(&thing.kind).map(|row| row.place) {
        Some(Place::Floor(scatter)) => scatter.width_m[1],
        _ => 0.0,
    };
    let larger = things.iter().filter(|other| widest_m(other) > widest_m(thing));
    let of_stones = larger.flat_map(|stone| {
        let hull = &cave.prototype(stone).hull;
        // Before they were sunk.
        let raised = Vector3::z() * stone.embedding_m;
        let at = |corner: u32| (stone.pose * (hull.corners[corner as usize] * stone.scale)).coords + raised;
        hull.faces.iter().map(move |face| face.map(at)).collect::<Vec<_>>()
    });
    of_walls.chain(of_stones).filter(is_near).collect()
}

#[test]
fn prototypes_are_closed_bodies_of_few_corners() {
    for rock in MATERIALS.iter() {
        let (library, mesh) = library(rock.name);
        assert_whole(mesh);
        let report = Report::of(mesh);
        assert!(report.is_clean() && report.volume_m3 < 0.0, "{}: {report:#?}", rock.name);
        assert!(report.components >= library.prototypes.len(), "{}", rock.name);
        assert_eq!(report.genus, 0, "{}", rock.name);
        for prototype in &library.prototypes {
            let corners = prototype.hull.corners.len();
            assert!((8..=MOST_CORNERS).contains(&corners), "{}: {corners} corners", prototype.name);
            assert!(prototype.volume_m3 > 0.0, "{}", prototype.name);
        }
        let vertices = mesh.positions_m();
        for (prototype, triangles) in library.prototypes.iter().zip(library.cut(&vertices, &mesh.triangles)) {
            let report = Report::of(&Mesh { triangles, ..mesh.clone() });
            assert!(report.is_clean() && report.volume_m3 < 0.0, "{} {}: {report:#?}", rock.name, prototype.name);
            // Dripstone and stones are in one piece.
            assert!(prototype.row.is_solid() || report.components == 1, "{}", prototype.name);
        }
    }
}

#[test]
fn normals_of_solids_point_out_of_them() {
    for rock in MATERIALS.iter() {
        let (library, mesh) = library(rock.name);
        let vertices = mesh.positions_m();
        let cut = library.prototypes.iter().zip(library.cut(&vertices, &mesh.triangles));
        for triangle in cut.filter(|(prototype, _)| prototype.row.is_solid()).flat_map(|(_, triangles)| triangles) {
            let [a, b, c] = corners(mesh, triangle);
            let facing = (b - a).cross(&(c - a)).normalize();
            let normals = triangle.map(|vertex| Vector3::from(mesh.normals[vertex as usize].map(f64::from)));
            let least = normals.iter().map(|normal| normal.dot(&facing)).fold(f64::MAX, f64::min);
            assert!(least > 0.0, "{}: {least} at {a}", rock.name);
        }
    }
}

#[test]
fn hulls_follow_the_stones() {
    /// How far collision geometry may be from floors, as of the convex pieces of the wall.
    const MOST_M: f64 = 0.02;
    for rock in MATERIALS.iter() {
        let (library, mesh) = library(rock.name);
        let vertices = mesh.positions_m();
        let cut = library.cut(&vertices, &mesh.triangles);
        for row in KINDS.iter().filter(|row| row.is_in(rock.name)) {
            let Place::Floor(scatter) = row.place else { continue };
            for prototype in library.of(row) {
                let number = library.prototypes.iter().position(|other| other.name == prototype.name).unwrap();
                let corners = cut[number].iter().flatten().map(|&vertex| vertices[vertex as usize].map(f64::from));
                let outside = |point: [f64; 3]| outside_m(&prototype.hull, Point3::from(point) - prototype.origin);
                let most_m = corners.map(outside).fold(0.0, f64::max) * scatter.width_m[1] / prototype.width_m();
                assert!(most_m < MOST_M, "{} as {}: {most_m} m outside its hull", prototype.name, row.name);
            }
        }
    }
}

/// How far a point is outside of the planes of a convex body, in metres.
fn outside_m(body: &Body, point: Vector3<f64>) -> f64 {
    let planes = body.faces.iter().map(|face| face.map(|corner| body.corners[corner as usize].coords));
    planes.map(|[a, b, c]| (b - a).cross(&(c - a)).normalize().dot(&(point - a))).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn things_keep_the_laws() {
    for cave in caves() {
        let things = cave.things();
        assert!(things.len() > 10, "{}: {} things", cave.name, things.len());
        assert_they_touch(&cave, &things);
        assert_the_corridor_is_free(&cave, &things);
        assert_dripstone_is_attached(&cave, &things);
        assert_have_own_identities(&cave, &things);
        gravel::assert_it_lies(&cave);
    }
}

/// Also if they are in different chunks.
fn assert_have_own_identities(cave: &Cave, things: &[Thing]) {
    let mut ids: Vec<u64> = things.iter().map(|thing| thing.id).collect();
    ids.sort_unstable();
    assert!(ids.windows(2).all(|pair| pair[0] != pair[1]), "{}: two things with one identity", cave.name);
}

/// The lowest gap between a stone and what it lies on, before it is sunk, is nothing.
fn assert_they_touch(cave: &Cave, things: &[Thing]) {
    // Going through every triangle takes long.
    for thing in things.iter().filter(|thing| cave.is_loose(thing)).step_by(7) {
        let reach_m = cave.prototype(thing).size_m.norm() * thing.scale;
        let floor = near(cave, things, thing, reach_m);
        let before = |at: Point3<f64>| at + Vector3::z() * thing.embedding_m;
        let gaps = cave.hull(thing).into_iter().filter_map(|at| gap(&floor, before(at), reach_m));
        let least = gaps.reduce(f64::min).expect("a stone is over a floor");
        assert!(least.abs() < TOUCH_M + 0.02 * reach_m, "{}: {least} m under {thing:?}", cave.name);
    }
}

/// Nothing on the way along the passages is higher than a step.
fn assert_the_corridor_is_free(cave: &Cave, things: &[Thing]) {
    // A tilted stone stands higher than one that lies flat.
    let in_the_way = first_in_the_way(cave, things, 1.6 * cave.settings.step_m);
    assert!(in_the_way.is_none(), "{}: {in_the_way:?} is in the way", cave.name);
}

/// A thing that is this high, or higher, on the way along the passages.
fn first_in_the_way<'a>(cave: &Cave, things: &'a [Thing], least_m: f64) -> Option<&'a Thing> {
    let half_m = cave.settings.corridor_m / 2.0;
    things.iter().filter(|thing| !hangs(thing)).find(|thing| {
        let hull = cave.hull(thing);
        let low = hull.iter().map(|at| at.z).fold(f64::MAX, f64::min);
        let high = hull.iter().map(|at| at.z).fold(f64::MIN, f64::max);
        if high - low < least_m {
            return false;
        }
        let mut ways = cave.graph.edges.iter().map(|edge| edge.map(|station| cave.graph[station].position));
        ways.any(|[a, b]| {
            hull.iter().any(|at| {
                let along = b - a;
                let flat = along.xy().norm_squared().max(1e-9);
                let share = ((at - a).xy().dot(&along.xy()) / flat).clamp(0.0, 1.0);
                let nearest = a + along * share;
                let is_on_the_way = (at - nearest).xy().norm() < 0.9 * half_m && (at.z - nearest.z).abs() < 3.0;
                is_on_the_way && low <= floor_m(cave, nearest) + cave.settings.headroom_m
            })
        })
    })
}

/// Height of the floor of a passage, which undulates around it.
fn floor_m(cave: &Cave, at: Point3<f64>) -> f64 {
    const UNDULATION_M: f64 = 0.2;
    f64::from(cave.field.floor_z(at.coords.map(|c| c as f32).into())) - UNDULATION_M
}

/// Roots are in the rock, and stalagmites stand below stalactites.
fn assert_dripstone_is_attached(cave: &Cave, things: &[Thing]) {
    let hanging: Vec<&Thing> = things.iter().filter(|thing| hangs(thing)).collect();
    let roots: Vec<[f32; 3]> = hanging
        .iter()
        .map(|thing| {
            let top = cave.hull(thing).into_iter().max_by(|a, b| a.z.total_cmp(&b.z)).unwrap();
            let axis = thing.pose.translation.vector;
            [axis.x as f32, axis.y as f32, top.z as f32]
        })
        .collect();
    let in_the_air = cave.field.scattered(&roots).iter().filter(|value| **value < -0.03).count();
    assert!(in_the_air * 50 <= hanging.len(), "{}: {in_the_air} of {} roots are in the air", cave.name, hanging.len());
    for stalagmite in things.iter().filter(|thing| thing.kind == "stalagmite") {
        let foot = stalagmite.pose.translation.vector;
        let is_above = |thing: &&&Thing| {
            let tip = thing.pose.translation.vector;
            (tip - foot).xy().norm() < 1e-9 && tip.z > foot.z
        };
        assert!(hanging.iter().any(|thing| is_above(&thing)), "{}: nothing drips on {stalagmite:?}", cave.name);
    }
}

#[test]
fn things_hardly_depend_on_the_size_of_chunks() {
    let rows = [("gaussian-perlin", "limestone", 8), ("mine", "drilled", 16)];
    for (generator, rock, nodes) in rows {
        let graph = small(plume::generators::GENERATORS.find(generator).unwrap(), nodes, 3);
        let of = |chunk_m: f32| -> BTreeMap<(u64, String), Thing> {
            let cave = Cave::new(format!("chunks of {chunk_m} m"), graph.clone(), rock, chunk_m);
            let things = cave.things();
            assert_have_own_identities(&cave, &things);
            things.into_iter().map(|thing| ((thing.id, thing.kind.clone()), thing)).collect()
        };
        let (one, other) = (of(16.0), of(7.0));
        let same = one.iter().filter(|(id, thing)| {
            let twin = other.get(*id);
            twin.is_some_and(|twin| (twin.pose.translation.vector - thing.pose.translation.vector).norm() < 0.03)
        });
        let share = same.count() as f64 / one.len().max(other.len()) as f64;
        // Triangles differ by millimetres, and of stones that hardly rest some do on one and not on the other.
        assert!(one.len() > 100 && share > 0.8, "{rock}: {share} of {} and {}", one.len(), other.len());
        let built = |all: &BTreeMap<(u64, String), Thing>| -> Vec<(u64, String)> {
            let is_built = |kind: &str| KINDS.find(kind).unwrap().place.is_built();
            all.keys().filter(|(_, kind)| is_built(kind)).cloned().collect()
        };
        let (these, those) = (built(&one), built(&other));
        let lost = these.iter().filter(|key| !other.contains_key(*key)).count();
        assert!(lost * 20 <= these.len(), "{rock}: {lost} of {} are gone, of {}", these.len(), those.len());
    }
}

/// Two large rooms side by side.
fn hall() -> Graph {
    let node = |id: u64, x: f64, z: f64| Node {
        id,
        parent: None,
        position: Point3::new(x, 0.0, z),
        radius: 16.0,
        active: false,
        level: 0,
        section: None,
        name: None,
    };
    Graph::new(vec![node(0, 0.0, 0.0), node(1, 20.0, 6.0)], StationId::pairs([[0, 1]]))
}

/// Chunks know the walls a few metres beyond their borders, which is less than the height of a hall.
#[test]
fn chunks_agree_on_the_things_of_a_hall() {
    let cave = Cave::new("hall".to_owned(), hall(), "basalt", 16.0);
    let in_box = |bounds: Aabb<f64>| {
        let walls = || cave.walls.iter().map(|(_, wall)| wall);
        [place(&cave.setting(), bounds, walls()), strew(&cave.setting(), bounds, walls())].concat()
    };
    let keys = |things: Vec<Thing>| -> BTreeMap<u64, String> {
        things.into_iter().map(|thing| (thing.id, format!("{} {:.3}", thing.kind, thing.pose.translation))).collect()
    };
    let [min, max] = [[-6.0, -14.0, -14.0], [26.0, 14.0, 20.0]];
    let whole = keys(in_box(Aabb { min, max }));
    let slices = (0..17).map(|n| [min[2] + 2.0 * f64::from(n), min[2] + 2.0 * f64::from(n + 1)]);
    let sliced =
        slices.flat_map(|[low, high]| in_box(Aabb { min: [min[0], min[1], low], max: [max[0], max[1], high] }));
    let sliced: Vec<Thing> = sliced.collect();
    assert_have_own_identities(&cave, &sliced);
    let sliced = keys(sliced);
    let differ: Vec<&u64> = whole.keys().chain(sliced.keys()).filter(|id| whole.get(id) != sliced.get(id)).collect();
    assert!(whole.len() > 100 && differ.is_empty(), "{} of {} differ", differ.len(), whole.len());
}

#[test]
fn no_cover_is_no_things() {
    let mut cave =
        Cave::new("bare".to_owned(), small(plume::generators::GENERATORS.default_row(), 4, 3), "limestone", 16.0);
    assert!(!cave.things().is_empty());
    cave.settings.cover = 0.0;
    assert!(cave.things().is_empty());
}

#[test]
fn difficulty_brings_more_and_larger_stones_and_closes_the_way() {
    let mut cave =
        Cave::new("harder".to_owned(), small(plume::generators::GENERATORS.default_row(), 6, 3), "limestone", 16.0);
    let mut before = [0.0; 3];
    for difficulty in [0.0, 0.5, 1.0] {
        cave.settings.difficulty = difficulty;
        let things = cave.things();
        let stones: Vec<&Thing> = things.iter().filter(|thing| cave.is_loose(thing)).collect();
        let width_m = |thing: &Thing| cave.prototype(thing).width_m() * thing.scale;
        let area_m2: f64 = stones.iter().map(|stone| width_m(stone) * width_m(stone)).sum();
        let large = || stones.iter().filter(|stone| stone.kind != "pebble");
        let mean_m = large().map(|stone| width_m(stone)).sum::<f64>() / large().count() as f64;
        let in_the_way = stones.iter().filter(|stone| width_m(stone) > 0.1 && is_on_the_axis(&cave, stone)).count();
        let now = [area_m2, mean_m, in_the_way as f64];
        assert!(now.iter().zip(before).all(|(now, before)| *now >= before), "{difficulty}: {now:?} after {before:?}");
        before = now;
    }
    assert!(before[2] > 5.0, "only {} stones in the way", before[2]);
}

#[test]
fn steps_are_allowed_on_the_way() {
    let mut cave =
        Cave::new("steps".to_owned(), small(plume::generators::GENERATORS.default_row(), 6, 3), "limestone", 16.0);
    cave.settings.cover = 0.2;
    for step_m in [0.025, 0.1] {
        cave.settings.step_m = step_m;
        let things = cave.things();
        assert_the_corridor_is_free(&cave, &things);
        assert_eq!(first_in_the_way(&cave, &things, 0.06).is_some(), step_m > 0.06, "{step_m}");
    }
}

/// Whether a thing is within half a metre of the middle of a passage.
fn is_on_the_axis(cave: &Cave, thing: &Thing) -> bool {
    let at = thing.pose.translation.vector.xy();
    cave.graph.edges.iter().any(|edge| {
        let [a, b] = edge.map(|station| cave.graph[station].position.coords.xy());
        let along = b - a;
        let share = ((at - a).dot(&along) / along.norm_squared().max(1e-9)).clamp(0.0, 1.0);
        (at - a - along * share).norm() < 0.5
    })
}

//! ufbx finds every thing of an FBX file at its place, with a mesh that it shares.

use std::collections::BTreeSet;

use crate::sample::Chamber;
use crate::strewn::Strewn;
use nalgebra::Point3;
use plume_exporters::Target;
use plume_exporters::frame::Up;
use plume_exporters::package::Memory;
use plume_exporters::scene::{Chunks, Instance, Mesh};
use plume_exporters::targets::fbx::{Fbx, FbxCollision, FbxSettings};
use ufbx::{CoordinateAxes, LoadOpts, Vec3};

/// The file with the things.
fn export(settings: FbxSettings) -> (ufbx::SceneRoot, Strewn, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let strewn = Strewn::new(folder.path(), false).unwrap();
    let mut memory = Memory::default();
    let file = if settings.per_chunk { "chunks/things_0_0_0.fbx" } else { "chamber.fbx" };
    Fbx(settings).export(&strewn.scene(), &mut memory).unwrap();
    let target_axes = CoordinateAxes::right_handed_z_up();
    let options = LoadOpts { strict: true, target_axes, target_unit_meters: 1.0, ..LoadOpts::default() };
    let scene = ufbx::load_memory(&memory.bytes[file], options).unwrap();
    assert!(scene.metadata.warnings.is_empty());
    (scene, strewn, folder)
}

fn name(thing: &Instance) -> String {
    format!("{}_{:016x}", thing.class, thing.id)
}

fn node<'a>(scene: &'a ufbx::Scene, name: &str) -> &'a ufbx::Node {
    let found = scene.nodes.iter().find(|node| &*node.element.name == name);
    found.unwrap_or_else(|| panic!("there is no {name}"))
}

/// Whether a node shows a mesh of the prototype at the place of a thing.
fn is_at(node: &ufbx::Node, expected: &Mesh, thing: &Instance) -> bool {
    let mesh = node.mesh.as_ref().unwrap();
    let world = mesh.vertices.iter().map(|vertex| ufbx::transform_position(&node.geometry_to_world, *vertex));
    let placed = expected.positions.iter().map(|at| thing.pose * (Point3::from(at.map(f64::from)) * thing.scale));
    let near = |(Vec3 { x, y, z }, placed): (Vec3, Point3<f64>)| (Point3::new(x, y, z) - placed).norm() < 1e-6;
    mesh.vertex_indices.iter().eq(&expected.indices) && world.zip(placed).all(near)
}

/// The ids of the meshes that these nodes show.
fn meshes(scene: &ufbx::Scene, names: impl Iterator<Item = String>) -> BTreeSet<u32> {
    names.map(|name| node(scene, &name).mesh.as_ref().unwrap().element.element_id).collect()
}

#[test]
fn things_share_a_mesh_per_level_at_their_places() {
    for (up, per_chunk) in [(Up::Z, false), (Up::Y, false), (Up::Z, true), (Up::Y, true)] {
        let (scene, strewn, _folder) = export(FbxSettings { up, per_chunk, ..FbxSettings::default() });
        let prototype = &strewn.prototypes().unwrap()[0];
        let of_walls = if per_chunk { 0 } else { 2 * strewn.chamber.len() };
        assert_eq!(scene.meshes.len(), of_walls + prototype.levels.len());
        for (number, level) in prototype.levels.iter().enumerate() {
            let names = || strewn.things().into_iter().map(move |thing| format!("{}_LOD{number}", name(&thing)));
            assert_eq!(meshes(&scene, names()).len(), 1);
            for (thing, shown) in strewn.things().iter().zip(names()) {
                let node = node(&scene, &shown);
                assert!(is_at(node, &level.mesh, thing), "{shown}");
                assert_eq!(&*node.materials[0].element.name, "prototypes");
                assert_eq!(&*node.parent.as_ref().unwrap().element.name, name(thing));
            }
        }
        assert_eq!(node(&scene, "things_0_0_0").children.len(), strewn.things().len());
    }
}

#[test]
fn larger_copies_show_finer_levels_from_further_away() {
    let (scene, strewn, _folder) = export(FbxSettings::default());
    let error_m = f64::from(strewn.prototypes().unwrap()[0].levels[1].error_m);
    for thing in strewn.things() {
        let group = ufbx::as_lod_group(node(&scene, &name(&thing)).attrib.as_ref().unwrap()).unwrap();
        let distances: Vec<f64> = group.lod_levels.iter().map(|level| level.distance).collect();
        assert_eq!(distances.len(), 2);
        assert!((distances[1] - 1000.0 * error_m * thing.scale).abs() < 1e-6, "{distances:?}");
    }
}

#[test]
fn without_coarser_levels_a_thing_is_one_node() {
    let (scene, strewn, _folder) = export(FbxSettings { lods: false, ..FbxSettings::default() });
    let full = &strewn.prototypes().unwrap()[0].levels[0].mesh;
    assert!(strewn.things().iter().all(|thing| is_at(node(&scene, &name(thing)), full, thing)));
    assert_eq!(scene.meshes.len(), strewn.chamber.len() + 1);
}

#[test]
fn hulls_are_shared_and_named_after_the_mesh_they_belong_to() {
    for (lods, full) in [(true, "_LOD0"), (false, "")] {
        let (scene, strewn, _folder) =
            export(FbxSettings { lods, collision: FbxCollision::Pieces, ..FbxSettings::default() });
        let hull = &strewn.prototypes().unwrap()[0].hull;
        let hull_of = |thing: &Instance| format!("UCX_{}{full}_00", name(thing));
        for thing in strewn.things() {
            let node = node(&scene, &hull_of(&thing));
            assert!(is_at(node, hull, &thing) && node.materials.is_empty());
        }
        assert_eq!(meshes(&scene, strewn.things().iter().map(hull_of)).len(), 1);
    }
}

#[test]
fn triangles_of_all_hulls_are_one_collision_mesh() {
    let (scene, strewn, _folder) = export(FbxSettings { collision: FbxCollision::Triangles, ..FbxSettings::default() });
    let expected = strewn.load(Chamber::len(&strewn.chamber)).unwrap().collision;
    let mesh = node(&scene, "things_0_0_0_collision").mesh.as_ref().unwrap();
    assert_eq!(mesh.num_triangles as u64, expected.triangles());
}

#[test]
fn triangles_are_counted_as_they_are_seen() {
    for (collision, hulls) in
        [(FbxCollision::None, false), (FbxCollision::Triangles, true), (FbxCollision::Pieces, true)]
    {
        let folder = tempfile::tempdir().unwrap();
        let strewn = Strewn::new(folder.path(), false).unwrap();
        let told =
            |scene| Fbx(FbxSettings { collision, ..FbxSettings::default() }).export(scene, &mut Memory::default());
        let (with, without) = (told(&strewn.scene()).unwrap(), told(&strewn.chamber.scene()).unwrap());
        let count = strewn.things().len() as u64;
        assert_eq!(with.visual_triangles - without.visual_triangles, 12 * count);
        assert_eq!(with.collision_triangles - without.collision_triangles, if hulls { 12 * count } else { 0 });
    }
}

//! ufbx reads the meshes of an Unreal package like Unreal's importer, and finds the scene in Unreal's frame.

use std::collections::BTreeSet;
use std::path::Path;

use crate::sample;
use plume_exporters::Target;
use plume_exporters::collision::Collision;
use plume_exporters::frame::unreal_from_scene;
use plume_exporters::package::Memory;
use plume_exporters::scene::{Chunk, Chunks, Mesh};
use plume_exporters::targets::unreal::{Unreal, UnrealSettings};
use serde_json::Value;

const PIECES: UnrealSettings = UnrealSettings { collision: Collision::Pieces, nanite: true, lods: true, lights: true };

struct Exported {
    memory: Memory,
    chunks: Vec<Chunk>,
    /// Keeps the images of the chunks.
    _folder: tempfile::TempDir,
}

impl Exported {
    fn new(settings: UnrealSettings) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let chamber = sample::Chamber::new(folder.path()).unwrap();
        let mut memory = Memory::default();
        Unreal(settings).export(&chamber.scene(), &mut memory).unwrap();
        let chunks = (0..chamber.len()).map(|index| chamber.load(index).unwrap()).collect();
        Self { memory, chunks, _folder: folder }
    }

    fn index(&self) -> Value {
        serde_json::from_slice(&self.memory.bytes["scene.json"]).unwrap()
    }

    /// A file in centimetres with the axes that Unreal's importer requests from the FBX SDK: still right-handed.
    fn read(&self, path: &str) -> ufbx::SceneRoot {
        let options = ufbx::LoadOpts {
            target_axes: ufbx::CoordinateAxes::right_handed_z_up(),
            target_unit_meters: 0.01,
            ..ufbx::LoadOpts::default()
        };
        let scene = ufbx::load_memory(&self.memory.bytes[path], options).unwrap();
        assert_eq!(scene.metadata.warnings.len(), 0, "{path}");
        scene
    }
}

fn name(node: &ufbx::Node) -> &str {
    &node.element.name
}

fn node<'a>(scene: &'a ufbx::Scene, wanted: &str) -> &'a ufbx::Node {
    scene.nodes.iter().find(|node| name(node) == wanted).unwrap()
}

/// The vertices of a node in Unreal: its importer transforms them to world space and negates y.
fn imported(node: &ufbx::Node) -> Vec<[f64; 3]> {
    let vertices = node.mesh.as_ref().unwrap().vertices.iter();
    let moved = vertices.map(|&vertex| ufbx::transform_position(&node.geometry_to_world, vertex));
    moved.map(|point| [point.x, -point.y, point.z]).collect()
}

fn assert_same(found: &[[f64; 3]], mesh: &Mesh) {
    assert_eq!(found.len(), mesh.positions.len());
    for (found, &position) in found.iter().zip(&mesh.positions) {
        let expected = unreal_from_scene(position.map(f64::from));
        assert!((0..3).all(|axis| (found[axis] - expected[axis]).abs() < 1e-3), "{found:?} is not {expected:?}");
    }
}

#[test]
fn vertices_are_in_place_in_centimetres() {
    let exported = Exported::new(UnrealSettings::default());
    for chunk in &exported.chunks {
        let scene = exported.read(&format!("meshes/{}.fbx", chunk.name));
        assert_same(&imported(node(&scene, &format!("{}_LOD0", chunk.name))), &chunk.visual);
        assert_same(&imported(node(&scene, &format!("{}_LOD1", chunk.name))), &chunk.lods[0].mesh);
        let path = format!("meshes/{}_collision.fbx", chunk.name);
        assert_same(&imported(node(&exported.read(&path), &format!("{}_collision", chunk.name))), &chunk.collision);
    }
}

#[test]
fn the_bounds_of_the_index_match_the_meshes() {
    let exported = Exported::new(UnrealSettings::default());
    for entry in exported.index()["chunks"].as_array().unwrap() {
        let scene = exported.read(entry["mesh"].as_str().unwrap());
        let points = imported(node(&scene, &format!("{}_LOD0", entry["name"].as_str().unwrap())));
        for axis in 0..3 {
            let coordinates = points.iter().map(|point| point[axis]);
            let least = coordinates.clone().fold(f64::INFINITY, f64::min);
            let greatest = coordinates.fold(f64::NEG_INFINITY, f64::max);
            assert!((entry["min_cm"][axis].as_f64().unwrap() - least).abs() < 1e-3);
            assert!((entry["max_cm"][axis].as_f64().unwrap() - greatest).abs() < 1e-3);
        }
    }
}

#[test]
fn levels_of_detail_are_in_a_group_in_order() {
    let exported = Exported::new(UnrealSettings::default());
    for entry in exported.index()["chunks"].as_array().unwrap() {
        let scene = exported.read(entry["mesh"].as_str().unwrap());
        let group = node(&scene, entry["name"].as_str().unwrap());
        assert_eq!(group.attrib_type, ufbx::ElementType::LodGroup);
        let levels = entry["lods"].as_array().unwrap();
        assert_eq!(group.children.len(), levels.len());
        for (child, level) in group.children.iter().zip(levels) {
            assert_eq!(child.mesh.as_ref().unwrap().num_triangles as u64, level["triangles"].as_u64().unwrap());
        }
        let sizes: Vec<f64> = levels.iter().map(|level| level["screen_size"].as_f64().unwrap()).collect();
        assert!(sizes.is_sorted_by(|a, b| a > b), "{sizes:?}");
    }
}

#[test]
fn levels_of_detail_can_be_omitted() {
    let exported = Exported::new(UnrealSettings { lods: false, ..PIECES });
    let scene = exported.read("meshes/chunk_0_0_0.fbx");
    let meshes: Vec<&str> = scene.nodes.iter().filter(|node| node.mesh.is_some()).map(|node| name(node)).collect();
    assert_eq!(meshes.iter().filter(|name| !name.starts_with("UCX_")).collect::<Vec<_>>(), [&"chunk_0_0_0_LOD0"]);
    assert_eq!(exported.index()["chunks"][0]["lods"].as_array().unwrap().len(), 1);
}

/// Unreal takes the text between the first and the last underscore for the name of the mesh, or all after the first.
#[test]
fn unreal_finds_the_mesh_of_each_piece() {
    let exported = Exported::new(PIECES);
    for entry in exported.index()["chunks"].as_array().unwrap() {
        let scene = exported.read(entry["mesh"].as_str().unwrap());
        let names: Vec<&str> = scene.nodes.iter().map(|node| name(node)).collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
        let pieces: Vec<&str> = names.iter().filter_map(|name| name.strip_prefix("UCX_")).collect();
        assert_eq!(pieces.len() as u64, entry["convex_pieces"].as_u64().unwrap());
        let full = format!("{}_LOD0", entry["name"].as_str().unwrap());
        for piece in pieces {
            assert_eq!(piece.rsplit_once('_').unwrap().0, full);
            assert!(!names.contains(&piece));
        }
    }
}

#[test]
fn only_the_green_channel_of_normals_is_inverted() {
    let exported = Exported::new(UnrealSettings::default());
    for chunk in &exported.chunks {
        let written = |role: &str| &exported.memory.bytes[&format!("textures/{}_{role}.png", chunk.name)];
        assert!(written("base_color") == &std::fs::read(&chunk.material.base_color.path).unwrap());
        assert!(written("orm") == &std::fs::read(&chunk.material.orm.path).unwrap());
        let (found, given) = (pixels(written("normal")), pixels(&std::fs::read(&chunk.material.normal.path).unwrap()));
        let turned: Vec<u8> = given.chunks(3).flat_map(|pixel| [pixel[0], 255 - pixel[1], pixel[2]]).collect();
        assert!(found != given && found == turned);
    }
}

fn pixels(bytes: &[u8]) -> Vec<u8> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    pixels
}

#[test]
fn every_reference_resolves_and_every_file_is_referenced() {
    for settings in [UnrealSettings::default(), PIECES] {
        let exported = Exported::new(settings);
        let mut named = BTreeSet::from(["README.md", "import_cave.py", "scene.json"].map(str::to_owned));
        for entry in exported.index()["chunks"].as_array().unwrap() {
            let textures = entry["textures"].as_object().unwrap().values();
            let paths = textures.chain([&entry["mesh"], &entry["collision_mesh"]]);
            named.extend(paths.filter_map(|path| path.as_str().map(str::to_owned)));
            for texture in &exported.read(entry["mesh"].as_str().unwrap()).textures {
                let path = texture.relative_filename.strip_prefix("../").unwrap();
                assert!(exported.memory.bytes.contains_key(path), "{path}");
            }
        }
        assert_eq!(exported.memory.bytes.keys().cloned().collect::<BTreeSet<_>>(), named);
    }
}

#[test]
fn lights_and_nanite_can_be_omitted() {
    for on in [true, false] {
        let index = Exported::new(UnrealSettings { lights: on, nanite: on, ..UnrealSettings::default() }).index();
        assert_eq!(index["lights"].as_array().unwrap().len(), if on { 2 } else { 0 });
        assert_eq!(index["nanite"], on);
    }
}

#[test]
fn the_script_is_the_tested_one() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../templates/unreal/import_cave.py");
    let exported = Exported::new(UnrealSettings::default());
    assert!(exported.memory.bytes["import_cave.py"] == std::fs::read(script).unwrap());
}

/// The full text, so that changes show up in review.
#[test]
fn texts_are_golden() {
    let exported = Exported::new(UnrealSettings::default());
    let text = |path: &str| String::from_utf8(exported.memory.bytes[path].clone()).unwrap();
    insta::assert_snapshot!("README.md", text("README.md"));
    insta::assert_snapshot!("scene.json", text("scene.json"));
    let pieces = Exported::new(PIECES);
    insta::assert_snapshot!("README_pieces.md", String::from_utf8(pieces.memory.bytes["README.md"].clone()).unwrap());
}

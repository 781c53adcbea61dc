//! ufbx reads the FBX files back and finds the scene in them.

use std::collections::BTreeMap;

use crate::sample;
use nalgebra::{Point3, Vector3};
use plume_exporters::Target;
use plume_exporters::format::fbx::{self, Collider, Head, Level, Maps, Part};
use plume_exporters::frame::Up;
use plume_exporters::frame::gltf_from_scene;
use plume_exporters::package::Memory;
use plume_exporters::place::{Existing, Folder};
use plume_exporters::scene::{Chunks, Mesh};
use plume_exporters::targets::fbx::{Fbx, FbxCollision, FbxSettings};
use ufbx::{CoordinateAxes, CoordinateAxis, LoadOpts, Vec3};

fn export(settings: FbxSettings) -> (Memory, sample::Chamber, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    Fbx(settings).export(&chamber.scene(), &mut memory).unwrap();
    (memory, chamber, folder)
}

/// A file as loaded, without warnings.
fn read(bytes: &[u8]) -> ufbx::SceneRoot {
    let scene = ufbx::load_memory(bytes, LoadOpts { retain_dom: true, strict: true, ..LoadOpts::default() }).unwrap();
    let warnings: Vec<&str> = scene.metadata.warnings.iter().map(|warning| &*warning.description).collect();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.metadata.version, scene.metadata.ascii), (7400, false));
    scene
}

fn node<'a>(scene: &'a ufbx::Scene, name: &str) -> &'a ufbx::Node {
    let found = scene.nodes.iter().find(|node| &*node.element.name == name);
    found.unwrap_or_else(|| panic!("there is no {name}"))
}

/// Every level of every chunk, and the names of the nodes that they should have.
fn levels(chamber: &sample::Chamber) -> Vec<(String, String, Mesh)> {
    let chunks = (0..chamber.len()).map(|index| chamber.load(index).unwrap());
    chunks
        .flat_map(|chunk| {
            let meshes = std::iter::once(chunk.visual).chain(chunk.lods.into_iter().map(|lod| lod.mesh));
            let name = chunk.name;
            meshes.enumerate().map(move |(n, mesh)| (name.clone(), format!("{name}_LOD{n}"), mesh)).collect::<Vec<_>>()
        })
        .collect()
}

fn vector([x, y, z]: [f32; 3]) -> [f64; 3] {
    [x, y, z].map(f64::from)
}

fn parts(vector: &Vec3) -> [f64; 3] {
    [vector.x, vector.y, vector.z]
}

/// The values at the corners of all triangles.
fn at_corners(attribute: &ufbx::VertexVec3) -> Vec<[f64; 3]> {
    attribute.indices.iter().map(|&index| parts(&attribute.values[index as usize])).collect()
}

#[test]
fn every_level_of_every_chunk_reads_back_bit_for_bit() {
    for (up, turn) in [(Up::Z, (|v| v) as fn([f64; 3]) -> [f64; 3]), (Up::Y, gltf_from_scene)] {
        let (memory, chamber, _folder) = export(FbxSettings { up, ..FbxSettings::default() });
        let scene = read(&memory.bytes["chamber.fbx"]);
        assert_eq!(scene.meshes.len(), 4);
        for (chunk, name, expected) in levels(&chamber) {
            let node = node(&scene, &name);
            let mesh = node.mesh.as_ref().unwrap();
            let of_corners = |vectors: &[[f32; 3]]| -> Vec<[f64; 3]> {
                expected.indices.iter().map(|&corner| turn(vector(vectors[corner as usize]))).collect()
            };
            assert!(mesh.vertices.iter().map(parts).eq(expected.positions.iter().map(|&p| turn(vector(p)))));
            assert!(mesh.vertex_indices.iter().eq(&expected.indices));
            assert_eq!(mesh.num_triangles, expected.indices.len() / 3);
            assert!(at_corners(&mesh.vertex_normal) == of_corners(&expected.normals));
            let tangents: Vec<_> = expected.tangents.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
            assert!(at_corners(&mesh.vertex_tangent) == of_corners(&tangents));
            let uvs = expected.indices.iter().map(|&corner| expected.uvs[corner as usize].map(f64::from));
            let found = &mesh.vertex_uv;
            let read = found.indices.iter().map(|&index| &found.values[index as usize]);
            assert!(read.map(|uv| [uv.x, uv.y]).eq(uvs));
            assert_eq!(node.materials.iter().map(|material| &*material.element.name).collect::<Vec<_>>(), [chunk]);
        }
    }
}

/// The axes and units in the file convert both kinds into the frame of the scene.
#[test]
fn axes_and_units_convert_back_to_the_scene() {
    for (up, named) in [(Up::Z, CoordinateAxis::PositiveZ), (Up::Y, CoordinateAxis::PositiveY)] {
        let (memory, chamber, _folder) = export(FbxSettings { up, ..FbxSettings::default() });
        let bytes = &memory.bytes["chamber.fbx"];
        let settings = &read(bytes).settings;
        assert!(settings.axes.up == named && settings.axes.right == CoordinateAxis::PositiveX);
        assert_eq!((settings.unit_meters, settings.original_unit_meters), (1.0, 1.0));
        let target = CoordinateAxes::right_handed_z_up();
        let options = LoadOpts { target_axes: target, target_unit_meters: 1.0, ..LoadOpts::default() };
        let scene = ufbx::load_memory(bytes, options).unwrap();
        for (_, name, expected) in levels(&chamber) {
            let node = node(&scene, &name);
            for (vertex, position) in node.mesh.as_ref().unwrap().vertices.iter().zip(&expected.positions) {
                let world = Point3::from(parts(&ufbx::transform_position(&node.geometry_to_world, *vertex)));
                assert!((world - Point3::from(vector(*position))).norm() < 1e-9);
            }
        }
        let pose = chamber.scene().spawns[0];
        let spawn = node(&scene, "spawn_0");
        for body in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            let [x, y, z] = body;
            let world = parts(&ufbx::transform_position(&spawn.node_to_world, Vec3 { x, y, z }));
            assert!((Point3::from(world) - pose * Point3::from(body)).norm() < 1e-9);
        }
    }
}

/// The binormal must run up the image, along the v of FBX.
#[test]
fn the_binormal_runs_up_the_image() {
    for up in [Up::Z, Up::Y] {
        let (memory, ..) = export(FbxSettings { up, ..FbxSettings::default() });
        let scene = read(&memory.bytes["chamber.fbx"]);
        let mesh = node(&scene, "chunk_0_0_0_LOD0").mesh.as_ref().unwrap();
        let points = at_corners(&mesh.vertex_position);
        let binormals = at_corners(&mesh.vertex_bitangent);
        let uvs: Vec<_> = mesh.vertex_uv.indices.iter().map(|&i| mesh.vertex_uv.values[i as usize]).collect();
        for corner in (0..points.len()).step_by(3) {
            let [a, b, c] = [0, 1, 2].map(|i| Vector3::from(points[corner + i]));
            let [u1, u2] = [1, 2].map(|i| uvs[corner + i].x - uvs[corner].x);
            let [v1, v2] = [1, 2].map(|i| uvs[corner + i].y - uvs[corner].y);
            let along_v = ((c - a) * u1 - (b - a) * u2) / (u1 * v2 - u2 * v1);
            let binormal = Vector3::from(binormals[corner]);
            assert!(binormal.dot(&along_v) > 0.0 && (binormal.norm() - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn textures_are_found() {
    for per_chunk in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let chamber = sample::Chamber::new(folder.path()).unwrap();
        let out = folder.path().join("package");
        let mut package = Folder::create(&out, Existing::Keep).unwrap();
        let settings = FbxSettings { per_chunk, ..FbxSettings::default() };
        Fbx(settings).export(&chamber.scene(), &mut package).unwrap();
        package.finish().unwrap();
        for index in 0..chamber.len() {
            let chunk = chamber.load(index).unwrap();
            let file = if per_chunk { format!("chunks/{}.fbx", chunk.name) } else { "chamber.fbx".to_owned() };
            let scene = ufbx::load_file(out.join(file).to_str().unwrap(), LoadOpts::default()).unwrap();
            let found = scene.materials.iter().find(|found| *found.element.name == chunk.name).unwrap();
            let occlusion = found.textures.iter().find(|used| &*used.material_prop == "Maya|TEX_ao_map").unwrap();
            for (texture, image) in [
                (found.fbx.diffuse_color.texture.as_ref().unwrap(), &chunk.material.base_color),
                (found.fbx.normal_map.texture.as_ref().unwrap(), &chunk.material.normal),
                (found.pbr.roughness.texture.as_ref().unwrap(), &chunk.material.roughness),
                (&occlusion.texture, &chunk.material.orm),
            ] {
                assert!(std::fs::read(&*texture.filename).unwrap() == std::fs::read(&image.path).unwrap());
                assert_eq!(&*texture.uv_set, &*scene.meshes[0].uv_sets[0].name);
            }
            assert_eq!((found.pbr.metalness.value_vec4.x, found.fbx.diffuse_color.value_vec4.x), (0.0, 1.0));
        }
    }
}

#[test]
fn coarser_levels_are_shown_from_where_their_error_is_invisible() {
    let (memory, chamber, _folder) = export(FbxSettings::default());
    let scene = read(&memory.bytes["chamber.fbx"]);
    for index in 0..chamber.len() {
        let chunk = chamber.load(index).unwrap();
        let group = node(&scene, &chunk.name);
        let lods = ufbx::as_lod_group(group.attrib.as_ref().unwrap()).unwrap();
        let expected = [0.0, f64::from(chunk.lods[0].error_m) * 1000.0];
        assert_eq!(lods.lod_levels.len(), 2);
        assert!(lods.lod_levels.iter().zip(expected).all(|(level, from)| (level.distance - from).abs() < 1e-9));
        let children: Vec<_> = group.children.iter().map(|child| child.element.name.to_string()).collect();
        assert_eq!(children, [0, 1].map(|level| format!("{}_LOD{level}", chunk.name)));
    }
    let (memory, chamber, _folder) = export(FbxSettings { lods: false, ..FbxSettings::default() });
    let scene = read(&memory.bytes["chamber.fbx"]);
    assert_eq!((scene.lod_groups.len(), scene.meshes.len()), (0, chamber.len()));
    assert!(node(&scene, "chunk_1_0_0").mesh.is_some());
}

#[test]
fn collision_shapes_read_back_bit_for_bit() {
    for per_chunk in [false, true] {
        let settings = |collision| FbxSettings { per_chunk, collision, ..FbxSettings::default() };
        let (memory, chamber, _folder) = export(settings(FbxCollision::Triangles));
        let chunks = (0..chamber.len()).map(|index| chamber.load(index).unwrap());
        let expected = chunks.map(|chunk| (format!("{}_collision", chunk.name), solid(&chunk.collision))).collect();
        assert!(colliders(&memory) == expected);

        let (memory, ..) = export(settings(FbxCollision::Pieces));
        let mut expected = BTreeMap::new();
        for index in 0..chamber.len() {
            for (number, piece) in chamber.pieces(index).unwrap().iter().enumerate() {
                expected.insert(format!("UCX_chunk_{index}_0_0_LOD0_{number:02}"), solid(&piece.mesh));
            }
        }
        assert!(colliders(&memory) == expected);
    }
}

/// A part need not have a visual mesh, and a material need not have every map.
#[test]
fn missing_data_is_omitted() {
    let folder = tempfile::tempdir().unwrap();
    let chunk = sample::Chamber::new(folder.path()).unwrap().load(0).unwrap();
    let mut memory = Memory::default();
    let head = Head { generator: "plume test", up: Up::Z };
    let maps = Maps { base_color: "a.png".to_owned(), normal: "b.png".to_owned(), ..Maps::default() };
    let level = Level { name: "seen".to_owned(), mesh: &chunk.visual, error_m: 0.0 };
    let collider = Collider { name: "touched".to_owned(), mesh: &chunk.collision };
    fbx::write(&mut memory, "parts.fbx", &head, |document, _| {
        let part = Part { name: "part", levels: vec![level], colliders: Vec::new(), material: "rock", maps: &maps };
        document.add(&part)?;
        document.add(&Part { name: "ghost", levels: Vec::new(), colliders: vec![collider], ..part })
    })
    .unwrap();
    let scene = read(&memory.bytes["parts.fbx"]);
    assert_eq!((scene.nodes.len(), scene.materials.len(), scene.textures.len()), (3, 1, 2));
    assert!(node(&scene, "touched").materials.is_empty());
}

type Solid = (Vec<[f64; 3]>, Vec<u32>);

fn solid(mesh: &Mesh) -> Solid {
    (mesh.positions.iter().copied().map(vector).collect(), mesh.indices.clone())
}

/// Meshes without a material.
fn colliders(memory: &Memory) -> BTreeMap<String, Solid> {
    let files = memory.bytes.iter().filter(|(path, _)| path.ends_with(".fbx"));
    let mut found = BTreeMap::new();
    for scene in files.map(|(_, bytes)| read(bytes)) {
        for node in scene.nodes.iter().filter(|node| node.materials.is_empty()) {
            let Some(mesh) = &node.mesh else { continue };
            let solid = (mesh.vertices.iter().map(parts).collect(), mesh.vertex_indices.to_vec());
            assert!(found.insert(node.element.name.to_string(), solid).is_none());
        }
    }
    found
}

#[test]
fn lights_shine_where_they_hang() {
    let (memory, chamber, _folder) = export(FbxSettings::default());
    let scene = read(&memory.bytes["chamber.fbx"]);
    assert_eq!(scene.lights.len(), 2);
    for expected in chamber.scene().lights {
        let node = node(&scene, &expected.name);
        let light = node.light.as_ref().unwrap();
        assert_eq!(parts(&node.local_transform.translation), <[f64; 3]>::from(expected.position));
        assert_eq!(parts(&light.color), expected.color);
        // ufbx also uses 100 for 1.
        assert_eq!(light.intensity, expected.intensity_cd);
        assert!(light.type_ == ufbx::LightType::Point && light.decay == ufbx::LightDecay::Quadratic);
    }
    let (memory, ..) = export(FbxSettings { lights: false, ..FbxSettings::default() });
    assert!(read(&memory.bytes["chamber.fbx"]).lights.is_empty());
}

#[test]
fn one_file_per_chunk_holds_the_same() {
    let (single, ..) = export(FbxSettings::default());
    let (memory, chamber, _folder) = export(FbxSettings { per_chunk: true, ..FbxSettings::default() });
    let whole = read(&single.bytes["chamber.fbx"]);
    for (chunk, name, _) in levels(&chamber) {
        let alone = read(&memory.bytes[&format!("chunks/{chunk}.fbx")]);
        assert_eq!((alone.meshes.len(), alone.materials.len()), (2, 1));
        let points = |scene: &ufbx::Scene| -> Vec<[f64; 3]> {
            node(scene, &name).mesh.as_ref().unwrap().vertices.iter().map(parts).collect()
        };
        assert!(points(&alone) == points(&whole));
    }
    let places = read(&memory.bytes["chamber.fbx"]);
    assert_eq!((places.meshes.len(), places.lights.len(), places.empties.len()), (0, 2, 1));
}

/// The header has the number of objects of each kind, although it precedes them.
#[test]
fn the_numbers_of_objects_match_the_header() {
    let (memory, ..) = export(FbxSettings { collision: FbxCollision::Triangles, ..FbxSettings::default() });
    let scene = read(&memory.bytes["chamber.fbx"]);
    let root = scene.dom_root.as_ref().unwrap();
    let mut objects: BTreeMap<String, i64> = BTreeMap::from([("GlobalSettings".to_owned(), 1)]);
    for object in &ufbx::dom_find(root, "Objects").unwrap().children {
        *objects.entry(object.name.to_string()).or_default() += 1;
    }
    let definitions = ufbx::dom_find(root, "Definitions").unwrap();
    let count = |node: &ufbx::DomNode| ufbx::dom_find(node, "Count").unwrap().values[0].value_int;
    let types = definitions.children.iter().filter(|node| &*node.name == "ObjectType");
    let announced: BTreeMap<String, i64> =
        types.map(|node| (node.values[0].value_str.to_string(), count(node))).collect();
    assert_eq!(announced, objects);
    assert_eq!(count(definitions), objects.values().sum::<i64>());
    assert_eq!((objects["Geometry"], objects["NodeAttribute"]), (6, 5));
}

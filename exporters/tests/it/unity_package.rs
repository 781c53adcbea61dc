//! A package for Unity is consistent, and its meshes are where the prefab says.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::changed;
use crate::sample;
use image::RgbImage;
use nalgebra::Vector3;
use plume_exporters::ImageFormat;
use plume_exporters::Target;
use plume_exporters::bundle::Bundle;
use plume_exporters::collision::Collision;
use plume_exporters::frame::unity_from_scene;
use plume_exporters::package::Memory;
use plume_exporters::place::Existing;
use plume_exporters::place::Place;
use plume_exporters::scene::{Chunk, Chunks, Image, Mesh, Scene};
use plume_exporters::targets::unity::material::Pipeline;
use plume_exporters::targets::unity::{Unity, UnitySettings, identity};

use changed::Changed;

fn export(settings: UnitySettings, scene: &Scene) -> Memory {
    let mut memory = Memory::default();
    Unity(settings).export(scene, &mut memory).unwrap();
    memory
}

fn sample_package(settings: UnitySettings) -> Memory {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    export(settings, &chamber.scene())
}

fn text<'a>(package: &'a Memory, path: &str) -> &'a str {
    std::str::from_utf8(&package.bytes[path]).unwrap()
}

/// The values between `key` and the next comma, brace or end of line, for all occurrences of `key`.
fn values<'a>(text: &'a str, key: &str) -> Vec<&'a str> {
    let parts = text.split(key).skip(1);
    parts.map(|rest| rest.split([',', '}', '\n']).next().unwrap()).collect()
}

/// The GUID of each asset, by path.
fn guids(package: &Memory) -> BTreeMap<String, String> {
    let metas = package.bytes.keys().filter_map(|path| path.strip_suffix(".meta"));
    metas
        .map(|path| (path.to_owned(), values(text(package, &format!("{path}.meta")), "\nguid: ")[0].to_owned()))
        .collect()
}

#[test]
fn a_folder_and_a_tarball_have_their_own_instructions() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let how = |bundle: Option<Bundle>| {
        let path = folder.path().join(bundle.map_or("folder", Bundle::name));
        let place = Place { path, bundle, existing: Existing::Keep };
        place.write("unity", &Unity(UnitySettings::default()), &chamber.scene()).unwrap().0.open.text().to_owned()
    };
    let drag = "; then drag Runtime/chamber.prefab into a scene";
    assert_eq!(how(None), format!("copy the folder to Packages/com.plume.chamber of a Unity project{drag}"));
    assert_eq!(how(Some(Bundle::Tgz)), format!("in Unity: Package Manager, +, Add package from tarball{drag}"));
}

#[test]
fn every_asset_and_folder_has_a_unique_guid() {
    let package = sample_package(UnitySettings::default());
    let guids = guids(&package);
    let mut assets: BTreeSet<String> = ["LICENSE.md", "manifest.json"].map(str::to_owned).into();
    for path in package.bytes.keys().filter(|path| !path.ends_with(".meta")) {
        assets.extend(path.match_indices('/').map(|(end, _)| path[..end].to_owned()));
        assets.insert(path.clone());
    }
    assert_eq!(guids.keys().cloned().collect::<BTreeSet<_>>(), assets);
    let different: BTreeSet<&String> = guids.values().collect();
    assert_eq!(different.len(), guids.len());
}

#[test]
fn guids_are_reproducible_and_differ_between_caves() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let of = |scene: &Scene| guids(&export(UnitySettings::default(), scene));
    let first = of(&chamber.scene());
    assert_eq!(first, of(&chamber.scene()));
    let moved = |_, mut chunk: Chunk| {
        chunk.collision.positions[0][0] += 1.0;
        Ok(chunk)
    };
    let changed = Changed { inner: &chamber, change: moved };
    let others = [Scene { name: "hall".to_owned(), ..chamber.scene() }, Scene { chunks: &changed, ..chamber.scene() }];
    for other in &others {
        let other = of(other);
        for path in ["Runtime", "Runtime/Meshes/chunk_0_0_0.fbx", "manifest.json"] {
            assert_ne!(first[path], other[path]);
        }
    }
}

const ALL: [(Pipeline, Collision); 3] = [
    (Pipeline::BuiltIn, Collision::Triangles),
    (Pipeline::Urp, Collision::Pieces),
    (Pipeline::Hdrp, Collision::Triangles),
];

#[test]
fn every_reference_resolves() {
    for (pipeline, collision) in ALL {
        let package = sample_package(UnitySettings { pipeline, collision, ..UnitySettings::default() });
        let known: BTreeSet<String> = guids(&package).into_values().collect();
        let shaders = [
            "0000000000000000f000000000000000",
            "933532a4fcc9baf4fa0491de14d08ed7",
            "6e4ae4064600d784cac1e41a9e6f2e59",
        ];
        for path in package.bytes.keys().filter(|path| path.ends_with(".mat") || path.ends_with(".prefab")) {
            for guid in values(text(&package, path), "guid: ") {
                assert!(known.contains(guid) || shaders.contains(&guid), "{path}: {guid}");
            }
        }
        check_objects(text(&package, "Runtime/chamber.prefab"));
    }
}

/// The ids of the objects of a prefab are unique, and every referenced id exists.
fn check_objects(prefab: &str) {
    let objects: Vec<&str> =
        prefab.lines().filter_map(|line| Some(line.strip_prefix("--- !u!")?.split_once('&')?.1)).collect();
    let different: BTreeSet<&str> = objects.iter().copied().collect();
    assert_eq!(different.len(), objects.len());
    for line in prefab.lines().filter(|line| !line.contains("guid: ")) {
        for number in values(line, "{fileID: ") {
            assert!(number == "0" || different.contains(number), "{line}");
        }
    }
}

fn read(bytes: &[u8]) -> ufbx::SceneRoot {
    ufbx::load_memory(bytes, ufbx::LoadOpts::default()).unwrap()
}

#[test]
fn the_prefab_refers_to_meshes_by_the_ids_that_unity_assigns() {
    for (pipeline, collision) in ALL {
        let package = sample_package(UnitySettings { pipeline, collision, ..UnitySettings::default() });
        let guids = guids(&package);
        let mut expected = BTreeSet::new();
        for (path, bytes) in package.bytes.iter().filter(|(path, _)| path.ends_with(".fbx")) {
            for mesh in &read(bytes).meshes {
                let [name, node] = [&*mesh.element.name, &*mesh.element.instances[0].element.name];
                assert_eq!(name, node);
                expected.insert(format!("{}, guid: {}", identity::mesh(name), guids[path]));
            }
        }
        let prefab = text(&package, "Runtime/chamber.prefab");
        let named = prefab.split("m_Mesh: {fileID: ").skip(1);
        let named: BTreeSet<String> = named.map(|rest| rest.split_once(", type: 3").unwrap().0.to_owned()).collect();
        assert_eq!(named, expected);
    }
}

/// The result of Unity's importer for a Y-up FBX: x negated, and the winding reversed.
fn imported(mesh: &ufbx::Mesh) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mirror = |point: &ufbx::Vec3| [-point.x, point.y, point.z].map(|part| part as f32);
    let corners: Vec<u32> = mesh.vertex_indices.iter().copied().collect();
    (mesh.vertices.iter().map(mirror).collect(), corners.chunks(3).map(|face| [face[0], face[2], face[1]]).collect())
}

#[test]
fn imported_meshes_match_the_scene_and_face_the_air() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let package = export(UnitySettings::default(), &chamber.scene());
    for index in 0..chamber.len() {
        let chunk = chamber.load(index).unwrap();
        let scene = read(&package.bytes[&format!("Runtime/Meshes/{}.fbx", chunk.name)]);
        assert!(scene.metadata.warnings.is_empty());
        assert!((scene.settings.unit_meters - 1.0).abs() < 1e-12);
        assert_eq!(scene.settings.axes.up, ufbx::CoordinateAxis::PositiveY);
        for (suffix, mesh) in [("LOD0", &chunk.visual), ("LOD1", &chunk.lods[0].mesh), ("collision", &chunk.collision)]
        {
            let node = scene.find_node(&format!("{}_{suffix}", chunk.name)).unwrap();
            check_import(&imported(node.mesh.as_ref().unwrap()), mesh);
        }
    }
}

fn check_import((positions, faces): &(Vec<[f32; 3]>, Vec<[u32; 3]>), mesh: &Mesh) {
    assert_eq!(*positions, mesh.positions.iter().copied().map(unity_from_scene).collect::<Vec<_>>());
    assert_eq!(faces.len() as u64, mesh.triangles());
    // In a left-handed frame the cross product points to where the winding is clockwise, which is the front in Unity.
    let mut facing = 0;
    for face in faces {
        let [a, b, c] = face.map(|corner| Vector3::from(positions[corner as usize]));
        let front = (b - a).cross(&(c - a));
        let middle = (a + b + c) / 3.0;
        // The chamber surrounds the x axis: the air is towards it.
        facing += usize::from(front.dot(&Vector3::new(0.0, -middle.y, -middle.z)) > 0.0);
    }
    assert!(facing * 100 > faces.len() * 95, "{facing} of {}", faces.len());
}

#[test]
fn the_mask_is_metalness_occlusion_unused_and_smoothness() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let package = export(UnitySettings::default(), &chamber.scene());
    let orm = image::open(folder.path().join("1_orm.png")).unwrap().into_rgb8();
    check_mask(&package, "chunk_1_0_0", &orm);
}

#[test]
fn images_may_be_jpeg() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    for role in ["base_color", "normal", "orm"] {
        for chunk in 0..chamber.len() {
            let png = folder.path().join(format!("{chunk}_{role}.png"));
            image::open(&png).unwrap().save(png.with_extension("jpg")).unwrap();
        }
    }
    let as_jpeg = |_, mut chunk: Chunk| {
        let material = &mut chunk.material;
        for image in [&mut material.base_color, &mut material.normal, &mut material.orm] {
            *image = Image { path: image.path.with_extension("jpg"), format: ImageFormat::Jpeg };
        }
        Ok(chunk)
    };
    let jpeg = Changed { inner: &chamber, change: as_jpeg };
    let package = export(UnitySettings::default(), &Scene { chunks: &jpeg, ..chamber.scene() });
    let orm = image::open(folder.path().join("0_orm.jpg")).unwrap().into_rgb8();
    check_mask(&package, "chunk_0_0_0", &orm);
    assert!(package.bytes.contains_key("Runtime/Textures/chunk_0_0_0_normal.jpg.meta"));
}

fn check_mask(package: &Memory, chunk: &str, orm: &RgbImage) {
    let mask =
        image::load_from_memory(&package.bytes[&format!("Runtime/Textures/{chunk}_mask.png")]).unwrap().into_rgba8();
    assert_eq!(mask.dimensions(), orm.dimensions());
    for (mask, orm) in mask.pixels().zip(orm.pixels()) {
        assert_eq!(mask.0, [orm.0[2], orm.0[0], 0, 255 - orm.0[1]]);
    }
}

#[test]
fn images_are_imported_as_the_right_kind() {
    let package = sample_package(UnitySettings::default());
    for (role, srgb, kind) in [("base_color", "1", "0"), ("normal", "0", "1"), ("mask", "0", "0")] {
        let meta = text(&package, &format!("Runtime/Textures/chunk_0_0_0_{role}.png.meta"));
        assert_eq!([values(meta, "sRGBTexture: "), values(meta, "textureType: ")], [[srgb], [kind]]);
        assert_eq!(values(meta, "maxTextureSize: "), ["64"; 2]);
        // The images of the chamber repeat.
        assert_eq!(values(meta, "wrapU: "), ["0"]);
    }
}

#[test]
fn an_invalid_image_is_reported_with_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    std::fs::write(folder.path().join("0_orm.png"), "no image").unwrap();
    let error = Unity(UnitySettings::default()).export(&chamber.scene(), &mut Memory::default()).unwrap_err();
    let told = error.to_string();
    let file = Path::new(told.split(": ").next().unwrap()).file_name().unwrap().to_owned();
    assert!(file == "0_orm.png" && !error.is_usage(), "{told}");
}

#[test]
fn levels_switch_where_their_error_is_a_line_of_the_image() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let package = export(UnitySettings::default(), &chamber.scene());
    let prefab = text(&package, "Runtime/chamber.prefab");
    let chunk = chamber.load(0).unwrap();
    let [low, high] = chunk.visual.bounds().map(|corner| Vector3::from(corner).cast::<f64>());
    let half_view = libm::tan(30_f64.to_radians());
    let heights: Vec<f64> = values(prefab, "screenRelativeHeight: ").iter().map(|text| text.parse().unwrap()).collect();
    assert_eq!(heights.len(), 2 * chamber.len());
    assert!(heights[1] == 0.0 && heights[3] == 0.0);
    let from_the_middle = (high - low).max() / (2.0 * heights[0] * half_view);
    let from_the_nearest = from_the_middle - (high - low).norm() / 2.0;
    let lines = f64::from(chunk.lods[0].error_m) / (2.0 * from_the_nearest * half_view) * 1080.0;
    assert!((lines - 1.0).abs() < 1e-3, "{lines}");
}

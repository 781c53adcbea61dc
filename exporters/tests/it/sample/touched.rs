//! Collision shapes of a package, found by third-party readers.

use std::collections::HashMap;

use plume_exporters::package::Memory;
use roxmltree::{Document, Node};

use crate::mjcf;

/// The number of vertices of every collision shape.
pub fn touched(package: &Memory) -> Vec<usize> {
    let shapes = |(path, bytes): (&String, &Vec<u8>)| match path.rsplit('.').next() {
        Some("sdf") => objects_of_collisions(package, bytes, "models/"),
        Some("urdf") => objects_of_collisions(package, bytes, ""),
        Some("xml") if path.ends_with("_world.xml") => collision_meshes(&mjcf::whole(package, path)),
        Some("obj") if path.ends_with("_collision.obj") && !path.contains('/') => objects(bytes),
        Some("fbx") if path.starts_with("Runtime/") => bare_meshes(bytes),
        Some("fbx") => unreal_nodes(bytes),
        Some("glb") => unreal_meshes(&gltf::Gltf::from_slice(bytes).unwrap(), package),
        Some("gltf") if !path.ends_with("_lods.gltf") => {
            unreal_meshes(&gltf::Gltf::from_slice(bytes).unwrap(), package)
        }
        Some("usdc" | "usdz") => colliders(bytes),
        _ => Vec::new(),
    };
    package.bytes.iter().flat_map(shapes).collect()
}

/// The objects of the OBJ files of collision elements of SDF or URDF; models are below `folder`.
fn objects_of_collisions(package: &Memory, bytes: &[u8], folder: &str) -> Vec<usize> {
    let document = Document::parse(std::str::from_utf8(bytes).unwrap()).unwrap();
    let collisions = document.descendants().filter(|node| node.has_tag_name("collision"));
    let uri = |node: Node<'_, '_>| node.attribute("filename").or(node.text()).map(str::to_owned);
    let is_uri = |node: &Node| node.has_tag_name("uri") || node.has_attribute("filename");
    let uris = collisions.map(|node| node.descendants().find(is_uri).and_then(uri).unwrap());
    uris.flat_map(|uri| {
        let path = format!("{folder}{}", uri.split("://").last().unwrap());
        objects(&package.bytes[&path])
    })
    .collect()
}

/// The objects of an OBJ file.
fn objects(mut bytes: &[u8]) -> Vec<usize> {
    let options = tobj::LoadOptions::default();
    let read = tobj::load_obj_buf(&mut bytes, &options, |_| Ok((Vec::new(), HashMap::new())));
    read.unwrap().0.into_iter().map(|object| object.mesh.positions.len() / 3).collect()
}

/// The meshes of collision geoms of MJCF.
fn collision_meshes(world: &str) -> Vec<usize> {
    let document = Document::parse(world).unwrap();
    let meshes: HashMap<&str, usize> = document
        .descendants()
        .filter(|node| node.has_tag_name("mesh"))
        .filter_map(|mesh| Some((mesh.attribute("name")?, mesh.attribute("vertex")?.split_whitespace().count() / 3)))
        .collect();
    let geoms = document.descendants().filter(|node| node.has_tag_name("geom"));
    geoms.filter_map(|geom| meshes.get(geom.attribute("mesh")?).copied()).collect()
}

/// The meshes that Unreal uses as collision of the mesh of the parent node.
fn unreal_meshes(document: &gltf::Gltf, package: &Memory) -> Vec<usize> {
    let buffer = |buffer: gltf::Buffer| match buffer.source() {
        gltf::buffer::Source::Bin => document.blob.as_deref(),
        gltf::buffer::Source::Uri(uri) => package.bytes.get(uri).map(Vec::as_slice),
    };
    let mut found = Vec::new();
    for node in document.nodes() {
        for (number, child) in node.children().enumerate() {
            let name = format!("UCX_{}_{number:02}", node.mesh().unwrap().name().unwrap());
            let mesh = child.mesh().unwrap();
            assert_eq!([child.name(), mesh.name()], [Some(&*name); 2]);
            let primitive = mesh.primitives().next().unwrap();
            found.push(primitive.reader(buffer).read_positions().unwrap().len());
        }
    }
    found
}

/// The nodes that Unreal uses as collision of the mesh that they are named after.
fn unreal_nodes(bytes: &[u8]) -> Vec<usize> {
    let scene = ufbx::load_memory(bytes, ufbx::LoadOpts::default()).unwrap();
    let seen: Vec<String> = meshes(&scene).map(|(name, _)| name).filter(|name| !name.starts_with("UCX_")).collect();
    let mut numbers: HashMap<String, usize> = HashMap::new();
    let mut found = Vec::new();
    for (name, vertices) in meshes(&scene) {
        let Some((mesh, number)) = name.strip_prefix("UCX_").and_then(|rest| rest.rsplit_once('_')) else { continue };
        assert!(seen.iter().any(|name| name == mesh), "{name}");
        let expected = numbers.entry(mesh.to_owned()).or_default();
        assert_eq!(number, format!("{expected:02}"));
        *expected += 1;
        found.push(vertices);
    }
    found
}

/// Nodes with meshes: their names and numbers of vertices.
fn meshes(scene: &ufbx::Scene) -> impl Iterator<Item = (String, usize)> {
    scene.nodes.iter().filter_map(|node| Some((node.element.name.to_string(), node.mesh.as_ref()?.num_vertices)))
}

/// The colliders recorded by the fake USD library.
fn colliders(bytes: &[u8]) -> Vec<usize> {
    let text = String::from_utf8_lossy(bytes);
    let sizes = text.lines().filter_map(|line| line.strip_prefix("Collision")?.split_once(".points "));
    sizes.map(|(_, size)| size.parse().unwrap()).collect()
}

/// The meshes of an FBX without a material, which are collision meshes.
fn bare_meshes(bytes: &[u8]) -> Vec<usize> {
    let scene = ufbx::load_memory(bytes, ufbx::LoadOpts::default()).unwrap();
    let bare = scene.meshes.iter().filter(|mesh| mesh.materials.is_empty());
    bare.map(|mesh| mesh.num_vertices).collect()
}

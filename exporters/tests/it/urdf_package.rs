//! All references of a URDF package, as read by urdf-rs, resolve.

use std::collections::BTreeSet;

use crate::sample;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use plume_exporters::collision::Collision;
use plume_exporters::package::Memory;
use plume_exporters::scene::Chunks;
use plume_exporters::targets::urdf::{Urdf, UrdfSettings};
use plume_exporters::{Summary, Target};
use roxmltree::Document;
use urdf_rs::{Geometry, JointType, Robot};

fn export(collision: Collision) -> (Memory, Summary) {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    let summary = Urdf(UrdfSettings { collision }).export(&chamber.scene(), &mut memory).unwrap();
    (memory, summary)
}

fn text<'a>(package: &'a Memory, path: &str) -> &'a str {
    std::str::from_utf8(&package.bytes[path]).unwrap()
}

fn robot(package: &Memory) -> Robot {
    urdf_rs::read_from_string(text(package, "chamber/urdf/chamber.urdf")).unwrap()
}

/// The file of a geometry in the package.
fn mesh_path(geometry: &Geometry) -> String {
    let Geometry::Mesh { filename, scale: None } = geometry else { panic!("{geometry:?} is no plain mesh") };
    filename.strip_prefix("package://").unwrap().to_owned()
}

#[test]
fn every_reference_resolves_and_every_file_is_referenced() {
    for collision in [Collision::Triangles, Collision::Pieces] {
        let package = export(collision).0;
        let rock = &robot(&package).links[0];
        let visuals = rock.visual.iter().map(|visual| mesh_path(&visual.geometry));
        let named: BTreeSet<String> =
            visuals.chain(rock.collision.iter().map(|collision| mesh_path(&collision.geometry))).collect();
        let meshes = package.bytes.keys().filter(|path| path.ends_with(".obj"));
        assert_eq!(named, meshes.cloned().collect());
    }
}

#[test]
fn material_libraries_lead_to_textures() {
    let package = export(Collision::Triangles).0;
    let mut named = BTreeSet::new();
    for library in package.bytes.keys().filter(|path| path.ends_with(".mtl")) {
        let maps = text(&package, library).lines().filter_map(|line| line.split_once(" textures/"));
        named.extend(maps.map(|(_, image)| format!("chamber/meshes/textures/{image}")));
    }
    let images = package.bytes.keys().filter(|path| path.ends_with(".png"));
    assert_eq!(named, images.cloned().collect());
    assert_eq!(named.len(), 6);
}

#[test]
fn one_massless_link_has_all_chunks() {
    let robot = robot(&export(Collision::Triangles).0);
    let rock = &robot.links[0];
    assert_eq!((robot.name.as_str(), rock.name.as_str()), ("chamber", "chamber"));
    assert_eq!((rock.visual.len(), rock.collision.len(), rock.inertial.mass.value), (2, 2, 0.0));
}

#[test]
fn start_poses_are_fixed_frames_without_geometry() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let robot = robot(&export(Collision::Triangles).0);
    let spawns = chamber.scene().spawns;
    assert_eq!((robot.links.len(), robot.joints.len()), (1 + spawns.len(), spawns.len()));
    for (number, (spawn, joint)) in spawns.iter().zip(&robot.joints).enumerate() {
        let frame = &robot.links[1 + number];
        assert_eq!(frame.name, format!("chamber_spawn_{number}"));
        assert!(frame.visual.is_empty() && frame.collision.is_empty());
        assert_eq!((&joint.parent.link, &joint.child.link), (&robot.links[0].name, &frame.name));
        assert_eq!(joint.joint_type, JointType::Fixed);
        let [x, y, z] = *joint.origin.xyz;
        let [roll, pitch, yaw] = *joint.origin.rpy;
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let written = Isometry3::from_parts(Translation3::new(x, y, z), rotation);
        assert!((written.translation.vector - spawn.translation.vector).norm() < 1e-5);
        assert!(written.rotation.angle_to(&spawn.rotation) < 1e-5);
    }
}

/// Bullet only checks whether the attribute exists.
#[test]
fn triangles_are_marked_as_concave_and_pieces_are_not() {
    for (collision, count) in [(Collision::Triangles, 2), (Collision::Pieces, 0)] {
        let package = export(collision).0;
        let document = Document::parse(text(&package, "chamber/urdf/chamber.urdf")).unwrap();
        let marked = document.descendants().filter(|node| node.attribute("concave").is_some());
        assert_eq!(marked.filter(|node| node.has_tag_name("collision")).count(), count);
        let link = document.descendants().find(|node| node.has_tag_name("contact")).unwrap().parent().unwrap();
        assert_eq!(link.attribute("name"), Some("chamber"));
    }
}

#[test]
fn each_piece_is_an_object_with_its_own_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let pieces = sample::Chamber::new(folder.path()).unwrap().pieces(1).unwrap();
    let (package, summary) = export(Collision::Pieces);
    let text = text(&package, "chamber/meshes/chunk_1_0_0_collision.obj");
    let objects: Vec<&str> = text.split("o chunk_1_0_0_").skip(1).collect();
    assert_eq!(objects.len(), pieces.len());
    let mut before = 0;
    for (object, piece) in objects.iter().zip(&pieces) {
        let rows = |key| object.lines().filter_map(move |line| line.strip_prefix(key));
        let positions: Vec<f32> = rows("v ").flat_map(numbers).collect();
        assert_eq!(positions, piece.mesh.positions.concat());
        let corners: Vec<u32> = rows("f ").flat_map(numbers).map(|corner: u32| corner - 1 - before).collect();
        assert_eq!(corners, piece.mesh.indices);
        before += piece.mesh.positions.len() as u32;
    }
    let written: usize =
        package.bytes.iter().map(|(path, bytes)| if path.contains("_collision") { faces(bytes) } else { 0 }).sum();
    assert_eq!(summary.collision_triangles, written as u64);
}

/// The first number of each corner, or the parts of a vertex.
fn numbers<T: std::str::FromStr<Err: std::fmt::Debug>>(line: &str) -> impl Iterator<Item = T> {
    line.split(' ').map(|number| number.split('/').next().unwrap().parse().unwrap())
}

fn faces(obj: &[u8]) -> usize {
    std::str::from_utf8(obj).unwrap().lines().filter(|line| line.starts_with("f ")).count()
}

#[test]
fn only_convex_collisions_use_pieces() {
    for (collision, wants) in [(Collision::Triangles, false), (Collision::Pieces, true)] {
        assert_eq!(Urdf(UrdfSettings { collision }).wants_pieces(), wants);
    }
}

#[test]
fn texts_are_escaped() {
    let package = export(Collision::Triangles).0;
    let document = Document::parse(text(&package, "chamber/package.xml")).unwrap();
    let description = document.descendants().find(|node| node.has_tag_name("description")).unwrap();
    assert_eq!(description.text(), Some("A bumpy chamber for tests & <examples>. Made by plume test."));
}

/// The full text, so that changes show up in review.
#[test]
fn texts_are_golden() {
    let package = export(Collision::Triangles).0;
    for path in ["chamber/package.xml", "chamber/CMakeLists.txt", "chamber/urdf/chamber.urdf", "README.md"] {
        insta::assert_snapshot!(path.replace('/', "_"), text(&package, path));
    }
}

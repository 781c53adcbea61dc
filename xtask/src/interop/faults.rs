//! Faults injected into intact packages: which check must notice each, and with which message.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::Reader;
use super::queue::Check;
use crate::tools::Result;

/// One check per fault of the table that any of these readers must notice.
pub(super) fn checks(readers: &[&'static Reader], scene: &Path) -> Vec<Check> {
    let reader_of = |fault: &Fault| readers.iter().find(|reader| reader.name == fault.reader).copied();
    let known = FAULTS.iter().enumerate().filter_map(|(number, fault)| Some((number, fault, reader_of(fault)?)));
    let check = |(number, fault, reader): (usize, &'static Fault, &'static Reader)| {
        let scene = scene.to_owned();
        Check::new(reader.name, move || fault.must_be_noticed(reader, &scene, number))
    };
    known.map(check).collect()
}

/// An injected fault, the check that must notice it, and a part of its message.
struct Fault {
    name: &'static str,
    reader: &'static str,
    message: &'static str,
    /// File of the synthetic scene to rewrite.
    file: &'static str,
    rewrite: fn(Vec<u8>) -> Option<Vec<u8>>,
}

impl Fault {
    fn must_be_noticed(&self, reader: &Reader, scene: &Path, number: usize) -> Result<String> {
        let folder = scene.with_file_name("faults").join(number.to_string());
        let package = self.copy(scene, &folder).map_err(|error| format!("{}: {error}", self.name))?;
        match reader.open(&package) {
            Err(said) if said.contains(self.message) => {}
            Err(said) => return Err(format!("on {}: {said}", self.name)),
            Ok(summary) => return Err(format!("did not notice {}: {summary}", self.name)),
        }
        fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        Ok(format!("noticed {}", self.name))
    }

    /// Copies the package with one file rewritten, or removed if the rewrite leaves it empty.
    fn copy(&self, scene: &Path, folder: &Path) -> io::Result<PathBuf> {
        let (target, file) = self.file.split_once('/').expect("it starts with the target");
        let package = folder.join(target);
        if package.exists() {
            fs::remove_dir_all(&package)?;
        }
        copy_folder(&scene.join(target), &package)?;
        match (self.rewrite)(fs::read(package.join(file))?) {
            Some(bytes) => fs::write(package.join(file), bytes)?,
            None => fs::remove_file(package.join(file))?,
        }
        Ok(package)
    }
}

static FAULTS: [Fault; 32] = [
    Fault {
        name: "a hole in the collision mesh",
        reader: "pybullet",
        message: "rays from spawn_0 leave the cave",
        file: "gazebo/models/chamber/meshes/chunk_1_0_0_collision.obj",
        rewrite: |bytes| Some(keep_triangles(&bytes, |number| !number.is_multiple_of(20))),
    },
    Fault {
        name: "convex pieces that are one object",
        reader: "pybullet",
        message: "rays from spawn_0 leave the cave",
        file: "gazebo_pieces/models/chamber/meshes/chunk_1_0_0_wall.obj",
        rewrite: |bytes| Some(without_objects(&bytes)),
    },
    Fault {
        name: "a spawn pose in the air",
        reader: "pybullet",
        message: "spawn_0 is 0.50 m above the floor",
        file: "gazebo/models/chamber/model.sdf",
        rewrite: |bytes| replace(&bytes, "<pose>0 0 -1.84 ", "<pose>0 0 -1.34 "),
    },
    Fault {
        name: "a missing texture",
        reader: "gazebo",
        message: "cannot load image",
        file: "gazebo/models/chamber/materials/textures/chunk_0_0_0_normal.png",
        rewrite: |_| None,
    },
    Fault {
        name: "an unknown SDF element",
        reader: "gazebo",
        message: "roughnes_map",
        file: "gazebo/models/chamber/model.sdf",
        rewrite: |bytes| replace(&bytes, "roughness_map", "roughnes_map"),
    },
    Fault {
        name: "a collision mesh without triangles",
        reader: "gazebo",
        message: "cannot load mesh",
        file: "gazebo/models/chamber/meshes/chunk_0_0_0_collision.obj",
        rewrite: |bytes| Some(keep_triangles(&bytes, |_| false)),
    },
    Fault {
        name: "a collision mesh without normals",
        reader: "gazebo",
        message: "has no normals",
        file: "gazebo/models/chamber/meshes/chunk_0_0_0_collision.obj",
        rewrite: |bytes| Some(without_normals(&bytes)),
    },
    Fault {
        name: "an unknown element of the rover",
        reader: "gazebo",
        message: "wheel_radios",
        file: "gazebo_ros2/models/chamber_rover/model.sdf",
        rewrite: |bytes| replace(&bytes, "<mass>40</mass>", "<mass>40</mass><wheel_radios>1</wheel_radios>"),
    },
    Fault {
        name: "a wheel that turns the other way",
        reader: "gazebo",
        message: "the rover drove",
        file: "gazebo_ros2/models/chamber_rover/model.sdf",
        rewrite: |bytes| replace(&bytes, "<xyz>0 1 0</xyz>", "<xyz>0 -1 0</xyz>"),
    },
    Fault {
        name: "wheels further apart than they are",
        reader: "gazebo",
        message: "the rover turned",
        file: "gazebo_ros2/models/chamber_rover/model.sdf",
        rewrite: |bytes| replace(&bytes, "<wheel_separation>0.56<", "<wheel_separation>1.12<"),
    },
    Fault {
        name: "wrong bounds of an accessor",
        reader: "validator",
        message: "ACCESSOR_MAX_MISMATCH",
        file: "glb/chamber.glb",
        rewrite: |bytes| replace(&bytes, "\"max\":[", "\"max\":[9"),
    },
    Fault {
        name: "a missing buffer",
        reader: "validator",
        message: "IO_ERROR",
        file: "gltf/buffers/chunk_1_0_0.bin",
        rewrite: |_| None,
    },
    Fault {
        name: "an index that is wrong about the triangles",
        reader: "three",
        message: "has 6048 triangles",
        file: "glb_meshopt/scene.json",
        rewrite: |bytes| replace(&bytes, "\"triangles\": 6048", "\"triangles\": 6049"),
    },
    Fault {
        name: "instances that no node has",
        reader: "three",
        message: "things_0_0_0 has 12 triangles, and scene.json says 36",
        file: "glb_instancing/chamber.glb",
        rewrite: |bytes| replace(&bytes, "{\"EXT_mesh_gpu_instancing\":{", "{\"EXT_mesh_gpu_instancin_\":{"),
    },
    Fault {
        name: "tangents under another name",
        reader: "three",
        message: "has no tangents",
        file: "glb/chamber.glb",
        rewrite: |bytes| replace(&bytes, "\"TANGENT\"", "\"_TANGEN\""),
    },
    Fault {
        name: "a chunk that is not in the scene",
        reader: "three",
        message: "of the view is not rock",
        file: "glb/chamber.glb",
        rewrite: |bytes| replace(&bytes, "\"nodes\":[0,1", "\"nodes\":[0,0"),
    },
    Fault {
        name: "a missing texture",
        reader: "three-fbx",
        message: "cannot load",
        file: "fbx/textures/chunk_0_0_0_normal.png",
        rewrite: |_| None,
    },
    Fault {
        name: "a texture of another role",
        reader: "three-fbx",
        message: "has no normalMap",
        file: "fbx/chamber.fbx",
        rewrite: |bytes| replace(&bytes, "NormalMap", "NormalMop"),
    },
    Fault {
        name: "full detail under the name of a coarser level",
        reader: "three-fbx",
        message: "of the view is not rock",
        file: "fbx/chamber.fbx",
        rewrite: |bytes| replace(&bytes, "chunk_1_0_0_LOD0\0\x01Model", "chunk_1_0_0_LOD1\0\x01Model"),
    },
    Fault {
        name: "a joint to a link that is not there",
        reader: "check_urdf",
        message: "chamber_spawn_9",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, "child link=\"chamber_spawn_0", "child link=\"chamber_spawn_9"),
    },
    Fault {
        name: "a missing mesh",
        reader: "pinocchio",
        message: "chunk_1_0_0_collision.obj",
        file: "urdf/chamber/meshes/chunk_1_0_0_collision.obj",
        rewrite: |_| None,
    },
    Fault {
        name: "a path into another package",
        reader: "pinocchio",
        message: "package://cavern/",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, "package://chamber/", "package://cavern/"),
    },
    Fault {
        name: "a chunk that is not touched",
        reader: "pinocchio",
        message: "nothing names",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, "chunk_1_0_0_collision.obj", "chunk_0_0_0_collision.obj"),
    },
    Fault {
        name: "a mesh in millimetres",
        reader: "pinocchio",
        message: "its bounds are",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, ".obj\"", ".obj\" scale=\"1000 1000 1000\""),
    },
    Fault {
        name: "a missing texture",
        reader: "yourdfpy",
        message: "no image is on",
        file: "urdf/chamber/meshes/textures/chunk_0_0_0_base_color.png",
        rewrite: |_| None,
    },
    Fault {
        name: "a ROS package without a licence",
        reader: "yourdfpy",
        message: "refuse package.xml",
        file: "urdf/chamber/package.xml",
        rewrite: |bytes| replace(&bytes, "<license>not stated</license>", ""),
    },
    Fault {
        name: "triangles that one format lacks",
        reader: "trimesh",
        message: "triangles instead of",
        file: "formats/obj/chamber.obj",
        rewrite: |bytes| Some(keep_triangles(&bytes, |number| !number.is_multiple_of(20))),
    },
    Fault {
        name: "a label without its name",
        reader: "trimesh",
        message: "names no label for ['ceiling']",
        file: "formats/ply/chamber.ply",
        rewrite: |bytes| replace(&bytes, "label 3 ceiling", "label 3 sealing"),
    },
    Fault {
        name: "a corner that one format has elsewhere",
        reader: "trimesh",
        message: "trimesh on stl: its bounds are",
        file: "formats/stl/chamber.stl",
        rewrite: |bytes| Some([&bytes[..96], &99.0_f32.to_le_bytes(), &bytes[100..]].concat()),
    },
    Fault {
        name: "a missing image",
        reader: "trimesh",
        message: "has no image",
        file: "formats/obj/textures/chunk_1_0_0_base_color.png",
        rewrite: |_| None,
    },
    Fault {
        name: "a material without roughness",
        reader: "blender",
        message: "chunk_0_0_0 has images for ['Base Color'] only",
        file: "formats/obj/chamber.mtl",
        rewrite: |bytes| replace(&bytes, "map_Pr", "map_Px"),
    },
    Fault {
        name: "a missing image",
        reader: "libassimp",
        message: "textures/chunk_1_0_0_base_color.png is not there",
        file: "formats/fbx/textures/chunk_1_0_0_base_color.png",
        rewrite: |_| None,
    },
];

/// Copies a folder with all that is in it.
pub(super) fn copy_folder(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let copy = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &copy)?;
        } else {
            fs::copy(entry.path(), copy)?;
        }
    }
    Ok(())
}

/// The OBJ with only the triangles selected by `keep`, by line number.
fn keep_triangles(bytes: &[u8], keep: impl Fn(usize) -> bool) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    let lines = text.lines().enumerate();
    let kept = lines.filter(|(number, line)| !line.starts_with("f ") || keep(*number));
    kept.map(|(_, line)| format!("{line}\n")).collect::<String>().into_bytes()
}

fn without_objects(bytes: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    let kept = text.lines().filter(|line| !line.starts_with("o "));
    kept.map(|line| format!("{line}\n")).collect::<String>().into_bytes()
}

fn without_normals(bytes: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    let mut kept = String::new();
    for line in text.lines().filter(|line| !line.starts_with("vn")) {
        for word in line.split(' ') {
            kept.push_str(word.split('/').next().unwrap_or_default());
            kept.push(' ');
        }
        kept.push('\n');
    }
    kept.into_bytes()
}

/// Replaces the first `old`; in a GLB, whose length must stay, over as many bytes as `new` has.
fn replace(bytes: &[u8], old: &str, new: &str) -> Option<Vec<u8>> {
    let at = bytes.windows(old.len()).position(|window| window == old.as_bytes())?;
    let rest = if bytes.starts_with(b"glTF") { at + new.len() } else { at + old.len() };
    Some([&bytes[..at], new.as_bytes(), &bytes[rest..]].concat())
}

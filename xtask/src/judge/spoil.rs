//! Good packages, spoiled: what each judge must complain about, and in which words.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::{Judge, Tally, verdict};
use crate::tools::Result;

/// Spoils a copy of the sample in each way of the table and asks the judge.
pub fn run(judges: &[&'static Judge], sample: &Path, tally: &mut Tally) -> Result<()> {
    for spoil in &SPOILS {
        let Some(judge) = judges.iter().find(|judge| judge.name == spoil.judge) else {
            continue;
        };
        let package = copy(sample, spoil).map_err(|error| format!("{}: {error}", spoil.fault))?;
        match verdict(judge, &package) {
            Err(complaint) if complaint.contains(spoil.complaint) => {
                tally.praise(judge.name, &format!("noticed {}", spoil.fault));
            }
            Err(complaint) => {
                tally.complain(judge.name, &format!("on {}: {complaint}", spoil.fault));
            }
            Ok(praise) => {
                tally.complain(judge.name, &format!("did not notice {}: {praise}", spoil.fault));
            }
        }
    }
    Ok(())
}

/// A fault, who must notice it and a part of what is said about it.
struct Spoil {
    fault: &'static str,
    judge: &'static str,
    complaint: &'static str,
    /// File of the sample that is rewritten.
    file: &'static str,
    rewrite: fn(Vec<u8>) -> Option<Vec<u8>>,
}

const SPOILS: [Spoil; 27] = [
    Spoil {
        fault: "a hole in the collision mesh",
        judge: "pybullet",
        complaint: "rays from spawn_0 leave the cave",
        file: "gazebo/models/chamber/meshes/chunk_1_0_0_collision.obj",
        rewrite: |bytes| Some(keep_triangles(&bytes, |number| !number.is_multiple_of(20))),
    },
    Spoil {
        fault: "convex pieces that are one object",
        judge: "pybullet",
        complaint: "rays from spawn_0 leave the cave",
        file: "gazebo_pieces/models/chamber/meshes/chunk_1_0_0_wall.obj",
        rewrite: |bytes| Some(without_objects(&bytes)),
    },
    Spoil {
        fault: "a spawn pose in the air",
        judge: "pybullet",
        complaint: "spawn_0 is 0.50 m above the floor",
        file: "gazebo/worlds/chamber.sdf",
        rewrite: |bytes| replace(&bytes, "<pose>0 0 -1.84 ", "<pose>0 0 -1.34 "),
    },
    Spoil {
        fault: "a missing texture",
        judge: "gazebo",
        complaint: "cannot load image",
        file: "gazebo/models/chamber/materials/textures/chunk_0_0_0_normal.png",
        rewrite: |_| None,
    },
    Spoil {
        fault: "an unknown SDF element",
        judge: "gazebo",
        complaint: "roughnes_map",
        file: "gazebo/models/chamber/model.sdf",
        rewrite: |bytes| replace(&bytes, "roughness_map", "roughnes_map"),
    },
    Spoil {
        fault: "a collision mesh without triangles",
        judge: "gazebo",
        complaint: "cannot load mesh",
        file: "gazebo/models/chamber/meshes/chunk_0_0_0_collision.obj",
        rewrite: |bytes| Some(keep_triangles(&bytes, |_| false)),
    },
    Spoil {
        fault: "a collision mesh without normals",
        judge: "gazebo",
        complaint: "has no normals",
        file: "gazebo/models/chamber/meshes/chunk_0_0_0_collision.obj",
        rewrite: |bytes| Some(without_normals(&bytes)),
    },
    Spoil {
        fault: "wrong bounds of an accessor",
        judge: "validator",
        complaint: "ACCESSOR_MAX_MISMATCH",
        file: "glb/chamber.glb",
        rewrite: |bytes| replace(&bytes, "\"max\":[", "\"max\":[9"),
    },
    Spoil {
        fault: "a missing buffer",
        judge: "validator",
        complaint: "IO_ERROR",
        file: "gltf/buffers/chunk_1_0_0.bin",
        rewrite: |_| None,
    },
    Spoil {
        fault: "an index that is wrong about the triangles",
        judge: "three",
        complaint: "has 6048 triangles",
        file: "glb_meshopt/scene.json",
        rewrite: |bytes| replace(&bytes, "\"triangles\": 6048", "\"triangles\": 6049"),
    },
    Spoil {
        fault: "tangents under another name",
        judge: "three",
        complaint: "has no tangents",
        file: "glb/chamber.glb",
        rewrite: |bytes| replace(&bytes, "\"TANGENT\"", "\"_TANGEN\""),
    },
    Spoil {
        fault: "a chunk that is not in the scene",
        judge: "three",
        complaint: "of the view is not rock",
        file: "glb/chamber.glb",
        rewrite: |bytes| replace(&bytes, "\"nodes\":[0,1", "\"nodes\":[0,0"),
    },
    Spoil {
        fault: "a missing texture",
        judge: "three-fbx",
        complaint: "cannot load",
        file: "fbx/textures/chunk_0_0_0_normal.png",
        rewrite: |_| None,
    },
    Spoil {
        fault: "a texture of another role",
        judge: "three-fbx",
        complaint: "has no normalMap",
        file: "fbx/chamber.fbx",
        rewrite: |bytes| replace(&bytes, "NormalMap", "NormalMop"),
    },
    Spoil {
        fault: "full detail under the name of a coarser level",
        judge: "three-fbx",
        complaint: "of the view is not rock",
        file: "fbx/chamber.fbx",
        rewrite: |bytes| replace(&bytes, "chunk_1_0_0_LOD0\0\x01Model", "chunk_1_0_0_LOD1\0\x01Model"),
    },
    Spoil {
        fault: "a joint to a link that is not there",
        judge: "check_urdf",
        complaint: "chamber_spawn_9",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, "child link=\"chamber_spawn_0", "child link=\"chamber_spawn_9"),
    },
    Spoil {
        fault: "a missing mesh",
        judge: "pinocchio",
        complaint: "chunk_1_0_0_collision.obj",
        file: "urdf/chamber/meshes/chunk_1_0_0_collision.obj",
        rewrite: |_| None,
    },
    Spoil {
        fault: "a path into another package",
        judge: "pinocchio",
        complaint: "package://cavern/",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, "package://chamber/", "package://cavern/"),
    },
    Spoil {
        fault: "a chunk that is not touched",
        judge: "pinocchio",
        complaint: "nothing names",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, "chunk_1_0_0_collision.obj", "chunk_0_0_0_collision.obj"),
    },
    Spoil {
        fault: "a mesh in millimetres",
        judge: "pinocchio",
        complaint: "its bounds are",
        file: "urdf/chamber/urdf/chamber.urdf",
        rewrite: |bytes| replace(&bytes, ".obj\"", ".obj\" scale=\"1000 1000 1000\""),
    },
    Spoil {
        fault: "a missing texture",
        judge: "yourdfpy",
        complaint: "no image is on",
        file: "urdf/chamber/meshes/textures/chunk_0_0_0_base_color.png",
        rewrite: |_| None,
    },
    Spoil {
        fault: "a ROS package without a licence",
        judge: "yourdfpy",
        complaint: "refuse package.xml",
        file: "urdf/chamber/package.xml",
        rewrite: |bytes| replace(&bytes, "<license>not stated</license>", ""),
    },
    Spoil {
        fault: "triangles that one format lacks",
        judge: "trimesh",
        complaint: "triangles instead of",
        file: "formats/obj/chamber.obj",
        rewrite: |bytes| Some(keep_triangles(&bytes, |number| !number.is_multiple_of(20))),
    },
    Spoil {
        fault: "a corner that one format has elsewhere",
        judge: "trimesh",
        complaint: "trimesh on stl: its bounds are",
        file: "formats/stl/chamber.stl",
        rewrite: |bytes| Some([&bytes[..96], &99.0_f32.to_le_bytes(), &bytes[100..]].concat()),
    },
    Spoil {
        fault: "a missing image",
        judge: "trimesh",
        complaint: "has no image",
        file: "formats/obj/textures/chunk_1_0_0_base_color.png",
        rewrite: |_| None,
    },
    Spoil {
        fault: "a material without roughness",
        judge: "blender",
        complaint: "chunk_0_0_0 has images for ['Base Color'] only",
        file: "formats/obj/chamber.mtl",
        rewrite: |bytes| replace(&bytes, "map_Pr", "map_Px"),
    },
    Spoil {
        fault: "a missing image",
        judge: "libassimp",
        complaint: "textures/chunk_1_0_0_base_color.png is not there",
        file: "formats/fbx/textures/chunk_1_0_0_base_color.png",
        rewrite: |_| None,
    },
];

/// A copy of the package with one file rewritten, or removed if nothing is left of it.
fn copy(sample: &Path, spoil: &Spoil) -> io::Result<PathBuf> {
    let (kind, file) = spoil.file.split_once('/').expect("it starts with the target");
    let package = sample.with_file_name("spoiled").join(kind);
    if package.exists() {
        fs::remove_dir_all(&package)?;
    }
    copy_folder(&sample.join(kind), &package)?;
    match (spoil.rewrite)(fs::read(package.join(file))?) {
        Some(bytes) => fs::write(package.join(file), bytes)?,
        None => fs::remove_file(package.join(file))?,
    }
    Ok(package)
}

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

/// The OBJ with only those triangles that `keep` wants, by line number.
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

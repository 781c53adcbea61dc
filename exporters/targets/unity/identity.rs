//! Identifiers of assets and objects in Unity.

use std::fmt;

use serde::{Serialize, Serializer};
use sha2::{Digest, Sha256};
use twox_hash::XxHash64;

/// GUID of an asset, 128 bits stored in its `.meta`.
///
/// The first 128 bits of a SHA-256 over the name of the package, the path of the asset and the SHA-256 of its content. Hence
/// the same cave has the same GUIDs wherever it is exported, and two caves in one project have none in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guid([u8; 16]);

impl Guid {
    /// The GUID of the asset at `path` of `package`; `content` is the SHA-256 of its content.
    pub fn new(package: &str, path: &str, content: &str) -> Self {
        let mut hash = Sha256::new();
        for part in ["plume unity", package, path, content] {
            hash.update(part.as_bytes());
            hash.update([0]);
        }
        Self(std::array::from_fn({
            let digest = hash.finalize();
            move |index| digest[index]
        }))
    }
}

impl fmt::Display for Guid {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(formatter, "{byte:02x}"))
    }
}

impl Serialize for Guid {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The id by which other files refer to a mesh of a model, for importers with `fileIdsGeneration: 2` (Unity 2019.3 and
/// later). Unity derives it from the class and the name of the mesh. The last digit counts meshes of the same name, of
/// which there are none here.
pub fn mesh(name: &str) -> i64 {
    XxHash64::oneshot(0, format!("Type:Mesh->{name}0").as_bytes()).cast_signed()
}

/// An id for the object `path` of a prefab; `class` distinguishes its components. Any positive number will do.
pub fn object(path: &str, class: u32) -> i64 {
    (XxHash64::oneshot(u64::from(class), path.as_bytes()) >> 1).cast_signed()
}

/// The id, in a prefab, of the object `source` of a prefab of which it has the instance `instance`.
pub fn nested(instance: i64, source: i64) -> i64 {
    instance ^ source
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ids that Unity itself has written into many public projects: the mesh `default` is that of an OBJ, `Cube` that of
    /// Blender's default scene.
    #[test]
    fn meshes_have_the_ids_that_unity_assigns() {
        assert_eq!(mesh("default"), -2_432_090_755_550_338_912);
        assert_eq!(mesh("Cube"), -5_495_902_117_074_765_545);
    }

    /// The ids of an instance, an object of its prefab, and what stands for it: from a prefab that Unity has written.
    #[test]
    fn objects_of_nested_prefabs_have_the_ids_that_unity_assigns() {
        assert_eq!(nested(7_876_467_245_726_119_373, 7_291_146_517_268_352_539), 603_920_067_861_314_518);
    }

    #[test]
    fn guids_depend_on_package_path_and_content() {
        let guid = |package, path, content| Guid::new(package, path, content).to_string();
        let first = guid("com.plume.a", "Runtime/a.mat", "00");
        assert!(first.len() == 32 && first.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f')));
        assert_eq!(first, guid("com.plume.a", "Runtime/a.mat", "00"));
        for other in [
            ("com.plume.b", "Runtime/a.mat", "00"),
            ("com.plume.a", "Runtime/b.mat", "00"),
            ("com.plume.a", "Runtime/a.mat", "01"),
        ] {
            assert_ne!(first, guid(other.0, other.1, other.2));
        }
    }
}

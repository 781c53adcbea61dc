//! The scene: everything an exporter needs, resolved; metres, kilograms, seconds, radians; right-handed, Z up.
//!
//! Chunks are loaded one at a time, so memory does not grow with their number.

use std::path::PathBuf;

use nalgebra::{Isometry3, Point3};

/// A static world in chunks.
pub struct Scene<'a> {
    /// Safe name: `[a-z][a-z0-9_]*` (see `names`).
    pub name: String,
    /// One sentence for a human.
    pub description: String,
    /// What made it, e.g. `plume 0.1.0`.
    pub generator: String,
    /// The text that alone makes this scene again, if there is one.
    pub recipe: String,
    /// The chunks, in a fixed order.
    pub chunks: &'a dyn Chunks,
    /// Where a robot may start; never empty. +X looks along the passage, +Z is up, the origin is on the ground.
    pub spawns: Vec<Isometry3<f64>>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Coulomb friction of the ground.
    pub friction: f64,
    /// Downward acceleration in m/s².
    pub gravity: f64,
    /// How far the collision mesh lies from the visual mesh at most, in metres.
    pub collision_error_m: f64,
}

/// Loads chunks one at a time.
pub trait Chunks: Sync {
    /// Number of chunks.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Loads a chunk.
    ///
    /// # Errors
    /// When it cannot be read.
    fn load(&self, index: usize) -> Result<Chunk, std::io::Error>;
}

/// A piece of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    /// Safe name, unique in the scene, e.g. `chunk_0_2_1`.
    pub name: String,
    /// What cameras see.
    pub visual: Mesh,
    /// What wheels touch: fewer triangles, positions and triangles only.
    pub collision: Mesh,
    /// Material of the visual mesh.
    pub material: Material,
}

/// Triangles; counter-clockwise from outside the solid. Attribute arrays are empty or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in metres, scene frame.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, origin at the lower left of the image.
    pub uvs: Vec<[f32; 2]>,
    /// Tangents (MikkTSpace): unit x, y, z along +u, and the handedness w = ±1 of the bitangent (+v).
    pub tangents: Vec<[f32; 4]>,
    /// Vertex indices, three a triangle.
    pub indices: Vec<u32>,
}

/// Metallic-roughness material. Images are files already encoded.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Base colour, sRGB.
    pub base_color: Image,
    /// Tangent-space normals, +Y up (OpenGL), linear.
    pub normal: Image,
    /// Occlusion in red, roughness in green, metalness (0) in blue; linear.
    pub orm: Image,
    /// Roughness alone, grey, linear.
    pub roughness: Image,
}

/// An encoded image on disk.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// File to copy.
    pub path: PathBuf,
    /// Its encoding.
    pub format: ImageFormat,
}

/// Encoding of an [`Image`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// PNG, 8 bits a channel.
    Png,
    /// JPEG.
    Jpeg,
}

/// A point light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Safe name, unique in the scene.
    pub name: String,
    /// Where.
    pub position: Point3<f64>,
    /// Linear RGB, 0–1.
    pub color: [f64; 3],
    /// Luminous intensity in candela.
    pub intensity_cd: f64,
    /// Distance beyond which it can be left out, metres.
    pub range_m: f64,
}

//! Model files of the user, GLB and OBJ, as triangles with their colours.
//!
//! Promised: metres with z up, and for every file a model or an error that says what is wrong, within memory that is bounded by
//! [`MOST_TRIANGLES`], [`MOST_TEXTURES`] and the size of the file. Not read: skins, morph targets, animations, normal maps,
//! metalness, transparency and light.

mod glb;
mod obj;

use std::path::Path;
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use crate::picture::{Image, Wrap};

/// Most triangles of a model. Tuned: the charts of one leave room for those of all other things in their images.
pub const MOST_TRIANGLES: usize = 10_000;
/// Most textures of a model: each takes up to 70 MB of memory.
pub const MOST_TEXTURES: usize = 8;

/// A model in its own frame, z up.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Its surface.
    pub triangles: Vec<Triangle>,
    /// What it is made of.
    pub materials: Vec<Material>,
}

/// A triangle, counter-clockwise from outside.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Its corners.
    pub corners: [Corner; 3],
    /// Index of its material.
    pub material: usize,
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Where it is, in metres.
    pub at: Point3<f64>,
    /// Unit normal; `None` for that of the triangle.
    pub normal: Option<Vector3<f64>>,
    /// Texture coordinates, v downwards.
    pub uv: [f32; 2],
    /// Colour by which that of the material is multiplied, linear RGB.
    pub color: [f32; 3],
}

/// What a surface is made of.
#[derive(Clone, Debug)]
pub struct Material {
    /// Albedo by which that of the texture is multiplied, linear RGB.
    pub color: [f32; 3],
    /// Perceptual roughness.
    pub roughness: f32,
    /// Albedo over the surface.
    pub texture: Option<Texture>,
}

/// An image on a surface, and how it continues beyond its sides.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The image.
    pub image: Arc<Image>,
    /// Beyond its sides along u and v.
    pub wrap: [Wrap; 2],
}

/// Why a file gives no model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ModelError {
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub hint: &'static str,
}

impl ModelError {
    /// An error with a hint.
    pub fn new(message: impl Into<String>, hint: &'static str) -> Self {
        Self { message: message.into(), hint }
    }
}

/// Gives the content of a file that a model names, relative to its own folder.
pub type Beside<'a> = dyn FnMut(&str) -> Result<Vec<u8>, ModelError> + 'a;

/// A format of models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary glTF 2.0 (ISO/IEC 12113:2022).
    Glb,
    /// Wavefront OBJ with its MTL files.
    Obj,
}

impl Format {
    /// The format of a file, by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "glb" => Some(Self::Glb),
            "obj" => Some(Self::Obj),
            _ => None,
        }
    }

    /// Reads a model.
    ///
    /// # Errors
    /// If it is none, is too large, or names files that `beside` does not give.
    pub fn read(self, bytes: &[u8], beside: &mut Beside) -> Result<Model, ModelError> {
        let model = match self {
            Self::Glb => glb::read(bytes),
            Self::Obj => obj::read(bytes, beside),
        }?;
        if model.triangles.is_empty() {
            return Err(ModelError::new("has no triangles", "a model is a closed surface of triangles"));
        }
        Ok(model)
    }
}

impl Model {
    /// Adds a triangle, if it is not one too many.
    fn push(&mut self, triangle: Triangle) -> Result<(), ModelError> {
        if self.triangles.len() == MOST_TRIANGLES {
            let message = format!("has more than {MOST_TRIANGLES} triangles");
            return Err(ModelError::new(message, "simplify it, for example with Blender's Decimate modifier"));
        }
        self.triangles.push(triangle);
        Ok(())
    }
}

/// Reads a texture.
fn texture(bytes: &[u8]) -> Result<Image, ModelError> {
    Image::read(bytes).map_err(|problem| {
        let message = format!("has a texture that {problem}");
        ModelError::new(message, "use PNG, JPEG or WebP of at most 8192 pixels a side")
    })
}

/// A vector of a file whose y axis is up, with z up.
fn z_up([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -z, y]
}

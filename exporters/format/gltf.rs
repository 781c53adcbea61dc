//! glTF 2.0 as JSON and bytes: Y up, metres.
//!
//! Follows the Khronos specification 2.0 (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>) and passes its
//! validator. [`Layout`] builds the JSON chunk by chunk and returns the bytes of each, so a writer holds one chunk.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;

mod copies;
mod document;
mod geometry;
pub mod glb;
pub mod index;
mod instancing;
mod landmarks;
mod layout;
mod lights;
mod material;
mod meshopt;
mod payload;
mod readme;
mod spool;

pub use copies::Copies;
pub use document::Document;
pub use geometry::buffer_file;
pub use layout::{Layout, level_buffer};
pub use material::{image_files, images};
pub use payload::Payload;
pub use readme::Readme;

/// How a document stores its data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Where vertices and triangles are.
    pub buffers: Place,
    /// Where images are.
    pub images: Place,
    /// Compression of vertices and triangles.
    pub compression: Compression,
}

/// Where a part of a document is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the payload of the GLB.
    Embedded,
    /// In separate files: `buffers/<chunk>.bin`, `textures/<chunk>_<role>.<extension>`.
    Beside,
}

/// Compression of vertices and triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Compression {
    /// Uncompressed: supported by any viewer.
    #[default]
    None,
    /// With EXT_meshopt_compression, for viewers that support it, among them three.js and Babylon.js. Lossless, except that
    /// the corners of a triangle may be rotated.
    Meshopt,
}

impl Compression {
    /// Whether this program supports the compression.
    ///
    /// # Errors
    /// [`ExportError::MissingPart`] if it was built without meshoptimizer.
    pub fn check(self) -> Result<(), ExportError> {
        match self {
            Self::None => Ok(()),
            Self::Meshopt => meshopt::check(),
        }
    }
}

//! glTF 2.0 as JSON and bytes: Y up, metres.
//!
//! Written after the Khronos specification 2.0 (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>) and clean
//! under its validator. [`Layout`] grows the JSON by chunks and hands out the bytes of each, so a writer holds one chunk.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;

mod geometry;
pub mod glb;
pub mod index;
mod layout;
mod lights;
mod material;
mod meshopt;
mod payload;
mod readme;

pub use geometry::buffer_file;
pub use layout::{Layout, level_buffer};
pub use material::image_files;
pub use payload::Payload;
pub use readme::Readme;

/// How a document keeps what it is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Where vertices and triangles are.
    pub buffers: Place,
    /// Where images are.
    pub images: Place,
    /// How vertices and triangles are packed.
    pub compression: Compression,
}

/// Where a part of a document is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the payload of the GLB.
    Embedded,
    /// In files of its own beside the JSON: `buffers/<chunk>.bin`, `textures/<chunk>_<role>.<extension>`.
    Beside,
}

/// How vertices and triangles are packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Compression {
    /// As they are: any viewer reads them.
    #[default]
    None,
    /// By EXT_meshopt_compression, for viewers that know it, among them three.js and Babylon.js. Every number stays as
    /// it is; a triangle may begin at another of its corners.
    Meshopt,
}

impl Compression {
    /// Whether this program can pack so.
    ///
    /// # Errors
    /// [`ExportError::MissingPart`] when it was built without meshoptimizer.
    pub fn check(self) -> Result<(), ExportError> {
        match self {
            Self::None => Ok(()),
            Self::Meshopt => meshopt::check(),
        }
    }
}

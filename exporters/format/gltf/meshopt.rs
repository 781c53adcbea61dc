//! EXT_meshopt_compression: vertices and triangles compressed by meshoptimizer, in the only bitstream version of the
//! extension (<https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_meshopt_compression>).
//!
//! Without filters and quantisation: the compression is lossless, so that chunks still share their borders, and
//! KHR_mesh_quantization is not needed.

use gltf_json::buffer::View;
use gltf_json::{Buffer, Index};
use serde_json::json;

use crate::error::ExportError;
use crate::scene::Mesh;

pub(super) const EXTENSION: &str = "EXT_meshopt_compression";

/// What a reader must know to unpack a view.
pub(super) struct Packing {
    mode: &'static str,
    stride: usize,
}

impl Packing {
    pub(super) fn vertices(stride: usize) -> Self {
        Self { mode: "ATTRIBUTES", stride }
    }

    pub(super) fn triangles(stride: usize) -> Self {
        Self { mode: "TRIANGLES", stride }
    }

    /// Adds to the `view` of the unpacked data the `range` of the compressed data in its buffer.
    pub(super) fn tell(&self, view: &mut View, buffer: Index<Buffer>, range: &View) {
        let packed = json!({
            "buffer": buffer,
            "byteOffset": range.byte_offset,
            "byteLength": range.byte_length,
            "byteStride": self.stride,
            "count": view.byte_length.0 / self.stride as u64,
            "mode": self.mode,
        });
        view.extensions.get_or_insert_default().others.insert(EXTENSION.to_owned(), packed);
    }
}

/// Marks a buffer without a file as the fallback that readers unpack into.
pub(super) fn mark_fallback(buffer: &mut Buffer) {
    let others = &mut buffer.extensions.get_or_insert_default().others;
    others.insert(EXTENSION.to_owned(), json!({ "fallback": true }));
}

#[cfg(feature = "meshopt")]
mod codec {
    use super::{ExportError, Mesh};

    /// The newer bitstream of meshoptimizer is smaller, but not part of the extension.
    const BITSTREAM: i32 = 0;
    /// The bitstream has no levels; any number will do.
    const LEVEL: i32 = 0;

    pub fn check() -> Result<(), ExportError> {
        Ok(())
    }

    pub fn vertices(bytes: &[u8], stride: usize) -> Vec<u8> {
        match stride {
            4 => packed::<4>(bytes),
            8 => packed::<8>(bytes),
            12 => packed::<12>(bytes),
            _ => packed::<16>(bytes),
        }
    }

    fn packed<const STRIDE: usize>(bytes: &[u8]) -> Vec<u8> {
        let (vertices, _) = bytes.as_chunks::<STRIDE>();
        meshopt::encode_vertex_buffer_level(vertices, LEVEL, Some(BITSTREAM))
            .expect("the buffer has the requested size")
    }

    pub fn triangles(mesh: &Mesh) -> Vec<u8> {
        meshopt::encode_index_buffer(&mesh.indices, mesh.positions.len()).expect("the buffer has the requested size")
    }
}

#[cfg(not(feature = "meshopt"))]
mod codec {
    use super::{ExportError, Mesh};

    pub fn check() -> Result<(), ExportError> {
        Err(ExportError::MissingPart {
            message: "this program was built without meshoptimizer".to_owned(),
            hint: "leave `compression` at `none`, or build with the feature `meshopt` and a C++ compiler".to_owned(),
        })
    }

    pub fn vertices(_: &[u8], _: usize) -> Vec<u8> {
        unreachable!("`check` has refused")
    }

    pub fn triangles(_: &Mesh) -> Vec<u8> {
        unreachable!("`check` has refused")
    }
}

pub(super) use codec::{check, triangles, vertices};

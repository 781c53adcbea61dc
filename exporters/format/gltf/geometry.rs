//! Vertices and triangles: accessors, buffer views and buffers.

use std::collections::BTreeMap;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Buffer, Index};
use serde_json::json;

use super::layout::Layout;
use super::payload::{Payload, padding};
use super::{Compression, Place, meshopt};
use crate::frame;
use crate::scene::{self, Mesh};

/// The vertex attributes of a visual mesh in the order of the payload; a convex piece has only the first.
pub(super) const VERTEX: [Semantic; 4] =
    [Semantic::Positions, Semantic::Normals, Semantic::Tangents, Semantic::TexCoords(0)];

impl Layout {
    /// Starts the buffer `name`, if there are several.
    pub(super) fn open_buffer(&mut self, name: &str) {
        if self.style.buffers == Place::Embedded && !self.document.root.buffers.is_empty() {
            return;
        }
        let uri = match self.style.buffers {
            Place::Embedded => None,
            Place::Beside => Some(buffer_file(name)),
        };
        self.open = self.document.root.push(empty_buffer(uri));
        if self.style.compression == Compression::Meshopt {
            self.require_extension(meshopt::EXTENSION);
            let mut unpacked = empty_buffer(None);
            meshopt::mark_fallback(&mut unpacked);
            self.document.root.buffers.push(unpacked);
        }
    }

    /// Accessors of the requested attributes, in that order.
    pub(super) fn primitive(&mut self, mesh: &Mesh, wanted: &[Semantic], payload: &mut Payload) -> Primitive {
        let mut attributes = BTreeMap::new();
        for semantic in wanted {
            attributes.insert(Valid(semantic.clone()), self.attribute(mesh, semantic, payload));
        }
        Primitive {
            attributes,
            extensions: None,
            extras: None,
            indices: Some(self.indices(mesh, payload)),
            material: None,
            mode: Valid(Mode::Triangles),
            targets: None,
        }
    }

    fn attribute(&mut self, mesh: &Mesh, semantic: &Semantic, payload: &mut Payload) -> Index<Accessor> {
        let (shape, bytes) = match semantic {
            Semantic::Positions => (Type::Vec3, floats(&mesh.positions, frame::gltf_from_scene)),
            Semantic::Normals => (Type::Vec3, floats(&mesh.normals, frame::gltf_from_scene)),
            Semantic::Tangents => (Type::Vec4, floats(&mesh.tangents, frame::gltf_tangent_from_scene)),
            _ => (Type::Vec2, floats(&mesh.uvs, frame::upper_left_uv)),
        };
        let index = self.rows(bytes, shape, payload);
        let accessor = self.document.accessors.recent(index);
        if *semantic == Semantic::Positions {
            [accessor.min, accessor.max] = bounds(&mesh.positions).map(|corner| Some(json!(corner)));
        }
        if let Some(view) = accessor.buffer_view {
            self.document.buffer_views.recent(view).target = Some(Valid(Target::ArrayBuffer));
        }
        index
    }

    /// An accessor of rows of this shape, given the bytes of their single-precision numbers.
    pub(super) fn rows(&mut self, bytes: Vec<u8>, shape: Type, payload: &mut Payload) -> Index<Accessor> {
        let stride = 4 * shape.multiplicity();
        let count = bytes.len() / stride;
        let view = match self.style.compression {
            Compression::None => self.plain(bytes, payload),
            Compression::Meshopt => {
                let plain = bytes.len() as u64;
                self.packed(meshopt::vertices(&bytes, stride), plain, &meshopt::Packing::vertices(stride), payload)
            }
        };
        self.document.accessors.push(accessor(view, count, ComponentType::F32, shape))
    }

    fn indices(&mut self, mesh: &Mesh, payload: &mut Payload) -> Index<Accessor> {
        let (component, stride) = index_type(mesh);
        let view = match self.style.compression {
            Compression::None => {
                let bytes = mesh.indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(stride));
                self.plain(bytes.collect(), payload)
            }
            Compression::Meshopt => {
                let plain = (mesh.indices.len() * stride) as u64;
                self.packed(meshopt::triangles(mesh), plain, &meshopt::Packing::triangles(stride), payload)
            }
        };
        self.document.buffer_views.recent(view).target = Some(Valid(Target::ElementArrayBuffer));
        self.document.accessors.push(accessor(view, mesh.indices.len(), component, Type::Scalar))
    }

    fn plain(&mut self, bytes: Vec<u8>, payload: &mut Payload) -> Index<View> {
        let view = self.view(bytes.len() as u64);
        payload.push_bytes(bytes);
        view
    }

    /// A view of `plain` bytes, which the reader unpacks into the fallback buffer after the open one.
    fn packed(&mut self, bytes: Vec<u8>, plain: u64, packing: &meshopt::Packing, payload: &mut Payload) -> Index<View> {
        let unpacked = Index::new(self.open.value() as u32 + 1);
        let range = append(&mut self.document.root.buffers[self.open.value()], bytes.len() as u64);
        let mut view = append(&mut self.document.root.buffers[unpacked.value()], plain);
        view.buffer = unpacked;
        packing.tell(&mut view, self.open, &range);
        payload.push_bytes(bytes);
        self.document.buffer_views.push(view)
    }

    /// The next `bytes` of the open buffer.
    pub(super) fn view(&mut self, bytes: u64) -> Index<View> {
        let mut view = append(&mut self.document.root.buffers[self.open.value()], bytes);
        view.buffer = self.open;
        self.document.buffer_views.push(view)
    }
}

/// The next `bytes` of a buffer, without the buffer index; padded to a multiple of four.
fn append(buffer: &mut Buffer, bytes: u64) -> View {
    let byte_offset = buffer.byte_length.0;
    buffer.byte_length.0 += bytes + padding(bytes);
    View {
        buffer: Index::new(0),
        byte_length: bytes.into(),
        byte_offset: Some(byte_offset.into()),
        byte_stride: None,
        name: None,
        target: None,
        extensions: None,
        extras: None,
    }
}

fn empty_buffer(uri: Option<String>) -> Buffer {
    Buffer { byte_length: 0_u64.into(), extensions: None, extras: None, name: None, uri }
}

/// The file of a separate buffer.
pub fn buffer_file(name: &str) -> String {
    format!("buffers/{name}.bin")
}

/// Lowest and highest corner of scene points, in the frame of glTF.
pub(super) fn bounds(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    scene::bounds(points.iter().copied().map(frame::gltf_from_scene))
}

fn floats<const N: usize>(vectors: &[[f32; N]], change: fn([f32; N]) -> [f32; N]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(4 * N * vectors.len());
    vectors.iter().flat_map(|&vector| change(vector)).for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

/// The type of a vertex index and its bytes. The largest value of a type is reserved for primitive restart.
fn index_type(mesh: &Mesh) -> (ComponentType, usize) {
    match mesh.positions.len() <= usize::from(u16::MAX) {
        true => (ComponentType::U16, 2),
        false => (ComponentType::U32, 4),
    }
}

fn accessor(view: Index<View>, count: usize, component: ComponentType, shape: Type) -> Accessor {
    Accessor {
        buffer_view: Some(view),
        byte_offset: None,
        count: count.into(),
        component_type: Valid(GenericComponentType(component)),
        extensions: None,
        extras: None,
        type_: Valid(shape),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

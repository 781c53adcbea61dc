//! Models in binary glTF 2.0 (ISO/IEC 12113:2022), with all that they need in the one file.
//!
//! The crate `gltf` checks the document and that indices lead somewhere; lengths and types are checked here, before anything is
//! read by them.

use std::sync::Arc;

use gltf::accessor::DataType;
use gltf::mesh::{Mode, Primitive};
use gltf::texture::WrappingMode;
use gltf::{Accessor, Document, Gltf, Node, Semantic, buffer, json};
use nalgebra::{Matrix3, Matrix4, Point3, Vector3};
use plume_graph::echo::{sentence, shown};

use super::{Corner, MOST_TEXTURES, Material, Model, ModelError, Texture, Triangle, texture, z_up};
use crate::picture::{Image, Wrap};

/// Most nodes of a scene: those of a circle would never end.
const MOST_NODES: usize = 10_000;
/// Length of the header and of that of the first chunk, in bytes.
const HEADERS: usize = 20;
const PLAIN: &str = "export it again as a single plain .glb file, without compression and with its textures embedded";

/// Reads the default scene of a file.
pub fn read(bytes: &[u8]) -> Result<Model, ModelError> {
    let Gltf { document, blob } = checked(bytes)?;
    let bin = blob.unwrap_or_default();
    let mut model = Model { triangles: Vec::new(), materials: materials(&document, &bin)? };
    for (node, pose) in nodes(&document)? {
        for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
            add(&mut model, &primitive, &pose, &bin)?;
        }
    }
    Ok(model)
}

/// The document of a file, found valid.
fn checked(bytes: &[u8]) -> Result<Gltf, ModelError> {
    let length = bytes.get(8..12).and_then(|length| Some(u32::from_le_bytes(length.try_into().ok()?) as usize));
    if !bytes.starts_with(b"glTF") || !length.is_some_and(|length| (HEADERS..=bytes.len()).contains(&length)) {
        return Err(ModelError::new("is not a GLB file, or not all of one", PLAIN));
    }
    let invalid = |error: gltf::Error| ModelError::new(format!("is invalid: {}", sentence(&error.to_string())), PLAIN);
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(invalid)?;
    if let Some(extension) = document.extensions_required().next() {
        return Err(ModelError::new(format!("needs the extension {}", shown(extension)), PLAIN));
    }
    // The crate looks up the places of vertices before it checks that there are any.
    let json::Root { meshes, accessors, .. } = document.as_json();
    let mut attributes =
        meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|primitive| primitive.attributes.values());
    if attributes.any(|index| index.value() >= accessors.len()) {
        return Err(unread());
    }
    Ok(Gltf { document: Document::from_json(document.into_json()).map_err(invalid)?, blob })
}

/// The nodes of the default scene, with their poses, z up.
fn nodes(document: &Document) -> Result<Vec<(Node<'_>, Matrix4<f64>)>, ModelError> {
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| Vector3::from(z_up(axis)));
    let root = Matrix3::from_columns(&columns).to_homogeneous();
    let mut waiting: Vec<(Node, Matrix4<f64>)> =
        scene.iter().flat_map(|scene| scene.nodes()).map(|node| (node, root)).collect();
    let mut found = Vec::new();
    while let Some((node, above)) = waiting.pop() {
        if found.len() == MOST_NODES {
            return Err(ModelError::new(format!("has more than {MOST_NODES} nodes, or a circle of nodes"), PLAIN));
        }
        let pose = above * Matrix4::from(node.transform().matrix()).map(f64::from);
        waiting.extend(node.children().map(|child| (child, pose)));
        found.push((node, pose));
    }
    Ok(found)
}

fn add(model: &mut Model, primitive: &Primitive, pose: &Matrix4<f64>, bin: &[u8]) -> Result<(), ModelError> {
    if primitive.mode() != Mode::Triangles {
        return Err(ModelError::new("has points, lines, strips or fans", "convert them to triangles"));
    }
    let last = model.materials.len() - 1;
    let material = primitive.material().index().unwrap_or(last);
    let uv_set = primitive.material().pbr_metallic_roughness().base_color_texture().map_or(0, |info| info.tex_coord());
    let at = vectors::<3>(primitive, &Semantic::Positions, bin)?.unwrap_or_default();
    let normals = vectors::<3>(primitive, &Semantic::Normals, bin)?;
    let uvs = vectors::<2>(primitive, &Semantic::TexCoords(uv_set), bin)?;
    let colors = vectors::<3>(primitive, &Semantic::Colors(0), bin)?;
    let turned = pose.fixed_view::<3, 3>(0, 0).into_owned();
    let turned_normals = turned.try_inverse().map(|inverse| inverse.transpose());
    let corner = |vertex: u32| {
        let vertex = vertex as usize;
        let normal = || {
            let own = Vector3::from(*normals.as_ref()?.get(vertex)?).map(f64::from);
            (turned_normals? * own).try_normalize(0.0)
        };
        Some(Corner {
            at: pose.transform_point(&Point3::from(*at.get(vertex)?).map(f64::from)),
            normal: normal(),
            uv: uvs.as_ref().and_then(|uvs| uvs.get(vertex)).copied().unwrap_or_default(),
            color: colors.as_ref().and_then(|colors| colors.get(vertex)).copied().unwrap_or([1.0; 3]),
        })
    };
    let indices = match primitive.indices() {
        Some(accessor) => indices(&accessor, bin).ok_or_else(unread)?,
        None => (0..at.len() as u32).collect(),
    };
    let is_mirrored = turned.determinant() < 0.0;
    for &[a, b, c] in indices.as_chunks::<3>().0 {
        let order = if is_mirrored { [a, c, b] } else { [a, b, c] };
        let [Some(a), Some(b), Some(c)] = order.map(corner) else { return Err(unread()) };
        model.push(Triangle { corners: [a, b, c], material })?;
    }
    Ok(())
}

fn unread() -> ModelError {
    ModelError::new(
        "has vertices that cannot be read: they are sparse, of another type, or lie outside of the file",
        PLAIN,
    )
}

/// The vectors of a primitive that mean this, if it has any.
fn vectors<const N: usize>(
    primitive: &Primitive,
    semantic: &Semantic,
    bin: &[u8],
) -> Result<Option<Vec<[f32; N]>>, ModelError> {
    let Some(accessor) = primitive.get(semantic) else { return Ok(None) };
    let read = || -> Option<Vec<[f32; N]>> {
        let size = accessor.data_type().size();
        let items = items(&accessor, bin).filter(|_| accessor.dimensions().multiplicity() >= N)?;
        let number = |item: &[u8], n: usize| number(accessor.data_type(), &item[n * size..(n + 1) * size]);
        let vector = |item: &[u8]| {
            let mut vector = [0.0; N];
            for (n, out) in vector.iter_mut().enumerate() {
                *out = number(item, n)?;
            }
            Some(vector)
        };
        items.map(vector).collect()
    };
    read().map(Some).ok_or_else(unread)
}

fn indices(accessor: &Accessor, bin: &[u8]) -> Option<Vec<u32>> {
    let index = |item: &[u8]| match *item {
        [a] => Some(u32::from(a)),
        [a, b] => Some(u32::from(u16::from_le_bytes([a, b]))),
        [a, b, c, d] => Some(u32::from_le_bytes([a, b, c, d])),
        _ => None,
    };
    items(accessor, bin)?.map(index).collect()
}

/// The bytes of each item of an accessor; `None` if they are not all in the file.
fn items<'a>(accessor: &Accessor, bin: &'a [u8]) -> Option<impl Iterator<Item = &'a [u8]> + use<'a>> {
    let view = accessor.view().filter(|_| accessor.sparse().is_none())?;
    let (size, count) = (accessor.size(), accessor.count());
    let stride = view.stride().unwrap_or(size);
    let bytes = bytes_of(&view, bin)?.get(accessor.offset()..)?;
    let length = count.checked_sub(1)?.checked_mul(stride)?.checked_add(size)?;
    (stride >= size && length <= bytes.len()).then(|| (0..count).map(move |n| &bytes[n * stride..][..size]))
}

fn bytes_of<'a>(view: &buffer::View, bin: &'a [u8]) -> Option<&'a [u8]> {
    let is_within = matches!(view.buffer().source(), buffer::Source::Bin);
    bin.get(view.offset()..view.offset().checked_add(view.length())?).filter(|_| is_within)
}

/// A component of a vector; whole numbers are shares of their largest.
fn number(kind: DataType, bytes: &[u8]) -> Option<f32> {
    match (kind, bytes) {
        (DataType::U8, &[a]) => Some(f32::from(a) / 255.0),
        (DataType::U16, &[a, b]) => Some(f32::from(u16::from_le_bytes([a, b])) / 65_535.0),
        (DataType::F32, &[a, b, c, d]) => Some(f32::from_le_bytes([a, b, c, d])).filter(|number| number.is_finite()),
        _ => None,
    }
}

/// The materials of a document in their order, and the default one.
fn materials(document: &Document, bin: &[u8]) -> Result<Vec<Material>, ModelError> {
    let mut images: Vec<Option<Arc<Image>>> = vec![None; document.images().len()];
    let mut materials = Vec::new();
    for material in document.materials() {
        let pbr = material.pbr_metallic_roughness();
        let texture = pbr.base_color_texture().map(|info| info.texture());
        let image = texture.as_ref().and_then(|texture| texture.source());
        if let Some(image) = &image
            && images[image.index()].is_none()
        {
            images[image.index()] = Some(Arc::new(decoded(document, image.index(), bin)?));
            if images.iter().flatten().count() > MOST_TEXTURES {
                let message = format!("has more than {MOST_TEXTURES} textures");
                return Err(ModelError::new(message, "bake them into one"));
            }
        }
        let texture = texture.zip(image).and_then(|(texture, image)| {
            let (image, sampler) = (images[image.index()].clone()?, texture.sampler());
            Some(Texture { image, wrap: [sampler.wrap_s(), sampler.wrap_t()].map(wrap) })
        });
        let [r, g, b, _] = pbr.base_color_factor();
        materials.push(Material { color: [r, g, b], roughness: pbr.roughness_factor(), texture });
    }
    materials.push(Material { color: [1.0; 3], roughness: 1.0, texture: None });
    Ok(materials)
}

/// An image of a document. It is looked up in its JSON, since the crate panics on one without a type or without a source.
fn decoded(document: &Document, image: usize, bin: &[u8]) -> Result<Image, ModelError> {
    let view = document.as_json().images[image].buffer_view.and_then(|view| document.views().nth(view.value()));
    let bytes = view.and_then(|view| bytes_of(&view, bin));
    texture(bytes.ok_or_else(|| ModelError::new("has a texture that is not in the file", PLAIN))?)
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::ClampToEdge => Wrap::Clamp,
    }
}

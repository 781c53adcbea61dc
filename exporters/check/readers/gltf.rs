//! glTF 2.0, as text and as binary (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>).

use gltf_json::validation::{Error, Validate};
use gltf_json::{Path, Root};

use super::{Content, Found, Unfit, json};

const MAGIC: [u8; 4] = *b"glTF";
const CHUNK_JSON: u32 = 0x4e4f_534a;
const CHUNK_BIN: u32 = 0x004e_4942;

/// Reads `.gltf`.
pub fn read_text(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let text = content.rest()?;
    read_root(&text, None, content, found)
}

/// Reads `.glb`.
pub fn read_binary(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    if content.array()? != MAGIC || content.u32()? != 2 {
        return Err("is not a binary glTF 2.0".into());
    }
    if u64::from(content.u32()?) != content.size() {
        return Err("has a wrong length in its header".into());
    }
    let length = content.u32()?;
    if content.u32()? != CHUNK_JSON {
        return Err("does not begin with a JSON chunk".into());
    }
    let text = content.block(length.into())?;
    let head_bytes = 12 + 8 + u64::from(length);
    if content.size() == head_bytes {
        return read_root(&text, Some(0), content, found);
    }
    let length = content.u32()?;
    if content.u32()? != CHUNK_BIN {
        return Err("has a second chunk that is not binary".into());
    }
    read_root(&text, Some(length.into()), content, found)?;
    content.skip(length.into())
}

/// Reads a document; `binary` is the length of the chunk that follows it in a `.glb`.
fn read_root(text: &[u8], binary: Option<u64>, content: &Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let value = json::parse(text)?;
    let root = Root::deserialize_checked(&value)?;
    let buffers = root.buffers.iter().enumerate();
    for (number, buffer) in buffers {
        let bytes = buffer.byte_length.0;
        match (&buffer.uri, binary) {
            (Some(uri), _) if uri.starts_with("data:") => {}
            (Some(uri), _) => found.buffer(content.path(), uri, bytes),
            (None, Some(length)) if number == 0 && bytes > length => {
                return Err(Unfit(format!("has {length} binary bytes where its JSON needs {bytes}")));
            }
            (None, _) => {}
        }
    }
    for uri in root.images.iter().filter_map(|image| image.uri.as_ref()).filter(|uri| !uri.starts_with("data:")) {
        found.reference(content.path(), uri);
    }
    check_views(&root)
}

/// Fails unless buffer views are inside their buffers, and accessors inside their views.
fn check_views(root: &Root) -> Result<(), Unfit> {
    for (number, view) in root.buffer_views.iter().enumerate() {
        let end = view.byte_offset.map_or(0, |offset| offset.0).checked_add(view.byte_length.0);
        let buffer = root.get(view.buffer).map_or(0, |buffer| buffer.byte_length.0);
        if end.is_none_or(|end| end > buffer) {
            return Err(Unfit(format!("has buffer view {number}, which extends beyond its buffer")));
        }
    }
    for (number, accessor) in root.accessors.iter().enumerate() {
        let Some(view) = accessor.buffer_view.and_then(|view| root.get(view)) else { continue };
        let (Ok(kind), Ok(component)) = (checked(&accessor.type_), checked(&accessor.component_type)) else { continue };
        let item = (kind.multiplicity() * component.0.size()) as u64;
        let stride = view.byte_stride.map_or(item, |stride| stride.0 as u64);
        let before = accessor.count.0.saturating_sub(1).saturating_mul(stride);
        let end = accessor.byte_offset.map_or(0, |offset| offset.0).saturating_add(before).saturating_add(item);
        if accessor.count.0 > 0 && end > view.byte_length.0 {
            return Err(Unfit(format!("has accessor {number}, which extends beyond its buffer view")));
        }
    }
    Ok(())
}

fn checked<T: Copy>(value: &gltf_json::validation::Checked<T>) -> Result<T, Error> {
    match value {
        gltf_json::validation::Checked::Valid(value) => Ok(*value),
        gltf_json::validation::Checked::Invalid => Err(Error::Invalid),
    }
}

trait Checked: Sized {
    fn deserialize_checked(value: &serde_json::Value) -> Result<Self, Unfit>;
}

impl Checked for Root {
    /// The document, if everything required is there and every index is valid. Unknown extensions are not faults.
    fn deserialize_checked(value: &serde_json::Value) -> Result<Self, Unfit> {
        let root: Self =
            serde::Deserialize::deserialize(value).map_err(|error| Unfit(format!("is not valid glTF: {error}")))?;
        let mut fault = None;
        root.validate(&root, Path::new, &mut |path, error| {
            if error != Error::Unsupported {
                fault.get_or_insert_with(|| Unfit(format!("is not valid glTF: {} is {error}", path())));
            }
        });
        fault.map_or(Ok(root), Err)
    }
}

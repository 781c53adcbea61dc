//! TIFF, little-endian: the directory of one image, and that the values and strips it refers to are in the file.

use super::{Content, Found, Unfit};

const STRIP_OFFSETS: u16 = 273;
const STRIP_BYTE_COUNTS: u16 = 279;

/// Reads `.tif`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let bytes = content.rest()?;
    if !bytes.starts_with(b"II*\0") {
        return Err("is not a little-endian TIFF".into());
    }
    let short = |at: usize| Some(u16::from_le_bytes(bytes.get(at..)?.first_chunk().copied()?));
    let long = |at: usize| Some(u32::from_le_bytes(bytes.get(at..)?.first_chunk().copied()?) as usize);
    let outside = || Unfit::from("refers to something beyond its end");
    let directory = long(4).ok_or_else(outside)?;
    let mut strips = [Vec::new(), Vec::new()];
    for entry in 0..usize::from(short(directory).ok_or_else(outside)?) {
        let at = directory + 2 + 12 * entry;
        let (Some(tag), Some(kind), Some(count)) = (short(at), short(at + 2), long(at + 4)) else {
            return Err(outside());
        };
        let size = bytes_of(kind).ok_or("has a value of an unknown type")?.saturating_mul(count);
        let place = if size > 4 { long(at + 8).ok_or_else(outside)? } else { at + 8 };
        let value = bytes.get(place..place.saturating_add(size)).ok_or_else(outside)?;
        if let Some(n) = [STRIP_OFFSETS, STRIP_BYTE_COUNTS].iter().position(|known| *known == tag) {
            strips[n] = value.as_chunks::<4>().0.iter().map(|number| u32::from_le_bytes(*number) as usize).collect();
        }
    }
    let [offsets, counts] = strips;
    if offsets.is_empty() || offsets.len() != counts.len() {
        return Err("has no strips, or only part of what tells where they are".into());
    }
    let is_inside = |(offset, count): (&usize, &usize)| offset.saturating_add(*count) <= bytes.len();
    if offsets.iter().zip(&counts).all(is_inside) { Ok(()) } else { Err(outside()) }
}

/// Bytes of a value of this type.
fn bytes_of(kind: u16) -> Option<usize> {
    match kind {
        1 | 2 | 6 | 7 => Some(1),
        3 | 8 => Some(2),
        4 | 9 | 11 => Some(4),
        5 | 10 | 12 => Some(8),
        _ => None,
    }
}

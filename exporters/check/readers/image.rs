//! Images. PNGs are decoded row by row, which verifies their checksums; of the others only the headers are read.

use std::io::Cursor;

use png::{Decoder, Limits};

use super::{Content, Found, Unfit};

/// The most memory that a PNG may take, for rows and tables.
const MOST_BYTES: usize = 1 << 26;

/// Reads `.png`.
pub fn read_png(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let unfit = |error: png::DecodingError| Unfit(format!("is not an intact PNG: {error}"));
    let decoder = Decoder::new_with_limits(Cursor::new(content.rest()?), Limits { bytes: MOST_BYTES });
    let mut reader = decoder.read_info().map_err(unfit)?;
    while reader.next_row().map_err(unfit)?.is_some() {}
    reader.finish().map_err(unfit)?;
    Ok(())
}

/// Reads `.jpg`: segments up to the first scan, and the marker at the end.
pub fn read_jpeg(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    if content.array()? != [0xff, 0xd8] {
        return Err("is not a JPEG".into());
    }
    let mut has_frame = false;
    loop {
        let [mark, kind] = content.array()?;
        if mark != 0xff {
            return Err("has an invalid JPEG segment".into());
        }
        let length = u64::from(u16::from_be_bytes(content.array()?));
        content.skip(length.checked_sub(2).ok_or("has an invalid JPEG segment")?)?;
        has_frame |= matches!(kind, 0xc0..=0xc3);
        if kind == 0xda {
            break;
        }
    }
    let scan = content.rest()?;
    if has_frame && scan.ends_with(&[0xff, 0xd9]) { Ok(()) } else { Err("is not an intact JPEG".into()) }
}

/// Reads `.webp`.
pub fn read_webp(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let (riff, bytes) = (content.array()?, u64::from(content.u32()?));
    let (webp, kind): ([u8; 4], [u8; 4]) = (content.array()?, content.array()?);
    let is_webp = riff == *b"RIFF" && webp == *b"WEBP" && kind.starts_with(b"VP8");
    if is_webp && bytes + 8 == content.size() { Ok(()) } else { Err("is not an intact WebP".into()) }
}

/// Reads `.ktx2`.
pub fn read_ktx2(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    if content.array()? != *b"\xabKTX 20\xbb\r\n\x1a\n" {
        return Err("is not a KTX 2".into());
    }
    content.skip(28)?;
    let levels = u64::from(content.u32()?).clamp(1, 32);
    content.skip(36)?;
    for _ in 0..levels {
        let [start, bytes, _] = [content.array()?, content.array()?, content.array()?].map(u64::from_le_bytes);
        if start.saturating_add(bytes) > content.size() {
            return Err("is not an intact KTX 2".into());
        }
    }
    Ok(())
}

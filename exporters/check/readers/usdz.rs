//! USDZ: a zip of uncompressed files aligned to 64 bytes (<https://openusd.org/release/spec_usdz.html>). Read as a stream,
//! so that no file is held in memory.

use super::{Content, Found, Unfit};

const FILE: [u8; 4] = *b"PK\x03\x04";
const DIRECTORY: [u8; 4] = *b"PK\x01\x02";
const HEAD_BYTES: u64 = 30;
const ALIGNMENT: u64 = 64;

/// Reads `.usdz` and every file in it.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let (mut at, mut files) = (0, 0);
    loop {
        let magic: [u8; 4] = content.array()?;
        if magic == DIRECTORY && files > 0 {
            return Ok(());
        }
        if magic != FILE {
            return Err("is not a USDZ".into());
        }
        at = read_file(at, content, found)?;
        files += 1;
    }
}

/// Reads the file whose header begins `at`, its magic being read already; returns where it ends.
fn read_file(at: u64, content: &mut Content<'_>, found: &mut Found) -> Result<u64, Unfit> {
    let head: [u8; 26] = content.array()?;
    let short = |at: usize| u64::from(u16::from_le_bytes([head[at], head[at + 1]]));
    let size = u64::from(u32::from_le_bytes([head[14], head[15], head[16], head[17]]));
    let (flags, method, name, extra) = (short(2), short(4), short(22), short(24));
    let name = String::from_utf8(content.block(name)?).map_err(|_| Unfit::from("has a name that is not UTF-8"))?;
    if method != 0 || flags & 0b1001 != 0 {
        return Err(Unfit(format!("contains `{name}` compressed, encrypted or without a size")));
    }
    if let Some(fault) = crate::package::path_fault(&name) {
        return Err(Unfit(format!("contains `{name}`, which {fault}")));
    }
    content.skip(extra)?;
    let start = at + HEAD_BYTES + name.len() as u64 + extra;
    if !start.is_multiple_of(ALIGNMENT) {
        return Err(Unfit(format!("contains `{name}` at an offset that is not a multiple of {ALIGNMENT}")));
    }
    let path = format!("{}/{name}", content.path());
    if name.ends_with(".usdz") {
        return Err(Unfit(format!("contains another archive: `{name}`")));
    }
    let mut inner = Content::part(&path, size, content);
    super::read(&mut inner, found).map_err(|unfit| Unfit(format!("contains `{name}`, which {}", unfit.0)))?;
    let (bytes, _) = inner.finish()?;
    if bytes < size {
        return Err("ends early".into());
    }
    found.inside(path);
    Ok(start + size)
}

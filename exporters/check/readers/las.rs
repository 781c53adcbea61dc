//! LAS 1.4: the header, and that the points end where the file does.

use super::{Content, Found, Unfit};

/// Bytes of the header.
const HEADER: usize = 375;

/// Reads `.las`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let header: [u8; HEADER] = content.array()?;
    if !header.starts_with(b"LASF") || header[24..26] != [1, 4] {
        return Err("is not a LAS 1.4".into());
    }
    let number = |at: usize, bytes: usize| {
        let mut eight = [0; 8];
        eight[..bytes].copy_from_slice(&header[at..at + bytes]);
        u64::from_le_bytes(eight)
    };
    let [first, record, points] = [number(96, 4), number(105, 2), number(247, 8)];
    if first < HEADER as u64 || first.saturating_add(record.saturating_mul(points)) != content.size() {
        return Err(Unfit(format!("states {points} points, which does not match its size")));
    }
    Ok(())
}

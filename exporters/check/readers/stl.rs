//! STL, binary or as text.

use super::{Content, Found, Unfit};

const HEAD_BYTES: u64 = 84;
const TRIANGLE_BYTES: u64 = 50;

/// Reads `.stl`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let head: [u8; 80] = content.array()?;
    let triangles = u64::from(content.u32()?);
    if content.size() == HEAD_BYTES + TRIANGLE_BYTES * triangles {
        return if triangles > 0 { Ok(()) } else { Err("has no triangle".into()) };
    }
    if !head.starts_with(b"solid") {
        return Err(Unfit(format!("states {triangles} triangles, which does not match its size")));
    }
    let mut last = String::new();
    while let Some(line) = content.line()? {
        if !line.trim().is_empty() {
            last = line;
        }
    }
    if last.trim_start().starts_with("endsolid") { Ok(()) } else { Err("ends early".into()) }
}

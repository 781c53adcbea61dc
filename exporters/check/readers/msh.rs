//! MuJoCo meshes: four counts, then vertices, normals, texture coordinates and faces.

use super::{Content, Found, Unfit};

/// Reads `.msh`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let mut numbers = 4;
    for per_item in [3, 3, 2, 3] {
        numbers += per_item * u64::from(content.u32()?);
    }
    if content.size() == 4 * numbers { Ok(()) } else { Err("has counts that do not match its size".into()) }
}

//! What the map server of ROS needs to know about an image: flat YAML, a key and a value a line.

use super::{Content, Found, Unfit};

/// Reads `.yaml`.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let text = content.text()?;
    let value = |key: &str| text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(": "));
    for key in ["resolution", "origin", "occupied_thresh", "free_thresh"] {
        value(key).ok_or_else(|| Unfit(format!("has no `{key}`")))?;
    }
    found.reference(content.path(), value("image").ok_or("names no image")?);
    Ok(())
}

//! YAML: what the map server of ROS needs to know about an image, a key and a value a line, or parameters of its nodes.

use super::{Content, Found, Unfit};

/// Reads `.yaml`.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let text = content.text()?;
    let value = |key: &str| text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(": "));
    const KEYS: [&str; 4] = ["resolution", "origin", "occupied_thresh", "free_thresh"];
    if ["image"].iter().chain(&KEYS).all(|key| value(key).is_none()) {
        return Ok(());
    }
    for key in KEYS {
        value(key).ok_or_else(|| Unfit(format!("has no `{key}`")))?;
    }
    found.reference(content.path(), value("image").ok_or("names no image")?);
    Ok(())
}

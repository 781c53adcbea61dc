//! Unity files: YAML that refers to other files by GUID. A light scan; whether Unity accepts the YAML is tested elsewhere.

use super::{Content, Found, Unfit};

/// GUIDs of what Unity and its render pipelines include: built-in resources, and the Lit shaders of URP and HDRP.
const ELSEWHERE: [&str; 4] = [
    "0000000000000000e000000000000000",
    "0000000000000000f000000000000000",
    "933532a4fcc9baf4fa0491de14d08ed7",
    "6e4ae4064600d784cac1e41a9e6f2e59",
];

/// Reads `.meta`, which holds the GUID of the file next to it, and assets, which refer to GUIDs.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let text = content.text()?;
    let path = content.path();
    if text.contains('\t') || !text.contains(':') {
        return Err("is not Unity YAML".into());
    }
    if let Some(described) = path.strip_suffix(".meta") {
        let own = text.lines().find_map(|line| line.strip_prefix("guid: ")).ok_or("has no GUID")?;
        if !is_guid(own.trim()) {
            return Err("has an invalid GUID".into());
        }
        found.own_guid(path, own.trim());
        found.reference(path, described.rsplit('/').next().unwrap_or(described));
    } else if !text.starts_with("%YAML 1.1") {
        return Err("is not Unity YAML".into());
    }
    let named = text.split("guid: ").skip(1).filter_map(|rest| rest.get(..32)).filter(|guid| is_guid(guid));
    named.filter(|guid| !ELSEWHERE.contains(guid)).for_each(|guid| found.named_guid(path, guid));
    Ok(())
}

fn is_guid(text: &str) -> bool {
    text.len() == 32 && text.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte))
}

//! Names that are safe everywhere: SDF and URDF elements, USD prims, glTF nodes and file names on every system; and those by
//! which importers recognise the purpose of a mesh.

use crate::scene::Instance;

/// Whether `name` is `[a-z][a-z0-9_]*`, and not a device name of Windows.
pub fn is_safe(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.chars().all(is_safe_char)
        && !plume_disk::is_device_name(name)
}

/// A safe name derived from `text`: lower case, runs of other characters become one underscore.
pub fn safe(text: &str) -> String {
    let mut name = String::with_capacity(text.len());
    for letter in text.chars().map(|letter| letter.to_ascii_lowercase()) {
        if is_safe_char(letter) && letter != '_' {
            name.push(letter);
        } else if !name.ends_with('_') && !name.is_empty() {
            name.push('_');
        }
    }
    let name = name.trim_end_matches('_');
    match is_safe(name) {
        true => name.to_owned(),
        false => format!("scene_{name}").trim_end_matches('_').to_owned(),
    }
}

/// Name of a level of detail, 0 being the full one, by which engines recognise levels.
pub fn level(chunk: &str, number: usize) -> String {
    format!("{chunk}_LOD{number}")
}

/// Name of a convex piece of the mesh called `mesh`, by which Unreal recognises collision.
pub fn convex_piece(mesh: &str, number: usize) -> String {
    format!("UCX_{mesh}_{number:02}")
}

/// Name of a thing.
pub fn thing(thing: &Instance) -> String {
    format!("{}_{:016x}", thing.class, thing.id)
}

fn is_safe_char(letter: char) -> bool {
    letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_becomes_a_safe_name() {
        for (text, name) in [
            ("My Cave (2)", "my_cave_2"),
            ("lava-tube", "lava_tube"),
            ("7 sisters", "scene_7_sisters"),
            ("Höhle", "h_hle"),
            ("../../etc", "etc"),
            ("", "scene"),
            ("__", "scene"),
            ("CON", "scene_con"),
            ("lpt1.", "scene_lpt1"),
        ] {
            assert_eq!(safe(text), name);
            assert!(is_safe(&safe(text)), "{text}");
        }
    }

    #[test]
    fn a_safe_name_stays() {
        assert_eq!(safe("chunk_0_2_1"), "chunk_0_2_1");
        assert!(!is_safe("Cave") && !is_safe("2cave") && !is_safe("") && !is_safe("a/b") && !is_safe("nul"));
    }
}

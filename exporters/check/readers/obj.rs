//! Wavefront OBJ and its materials.

use super::{Content, Found, Unfit};

/// Material keys that name an image: the last word is the file.
const IMAGE_KEYS: [&str; 5] = ["bump", "disp", "norm", "decal", "refl"];

/// Reads `.obj`: numbers are finite, faces refer to existing vertices.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let mut counts = [0; 3];
    let mut number = 0;
    while let Some(line) = content.line()? {
        number += 1;
        let (key, rest) = split(&line);
        let sound = match key {
            "v" => is_vector(rest, 3, &mut counts[0]),
            "vt" => is_vector(rest, 2, &mut counts[1]),
            "vn" => is_vector(rest, 3, &mut counts[2]),
            "f" => is_face(rest, counts),
            "mtllib" => {
                found.reference(content.path(), rest);
                true
            }
            _ => true,
        };
        if !sound {
            return Err(Unfit(format!("has an invalid OBJ line {number}: `{}`", shortened(&line))));
        }
    }
    if counts[0] == 0 { Err("has no vertex".into()) } else { Ok(()) }
}

/// Reads `.mtl`.
pub fn read_materials(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let mut materials = 0;
    while let Some(line) = content.line()? {
        let (key, rest) = split(&line);
        let key = key.to_ascii_lowercase();
        if key == "newmtl" {
            materials += 1;
        } else if key.starts_with("map_") || IMAGE_KEYS.contains(&&*key) {
            found.reference(content.path(), rest.split_whitespace().last().unwrap_or_default());
        }
    }
    if materials == 0 { Err("has no material".into()) } else { Ok(()) }
}

fn split(line: &str) -> (&str, &str) {
    let line = line.trim();
    line.split_once(char::is_whitespace).map_or((line, ""), |(key, rest)| (key, rest.trim()))
}

fn is_vector(text: &str, least: usize, count: &mut u64) -> bool {
    *count += 1;
    let mut numbers = text.split_whitespace().map(|word| word.parse::<f64>().is_ok_and(f64::is_finite));
    numbers.by_ref().take(least).filter(|&is_number| is_number).count() == least && numbers.all(|is_number| is_number)
}

fn is_face(text: &str, counts: [u64; 3]) -> bool {
    let is_corner = |corner: &str| {
        let mut parts = corner.split('/').zip(counts);
        corner.split('/').count() <= 3 && parts.all(|(part, count)| part.is_empty() || is_index(part, count))
    };
    text.split_whitespace().count() >= 3 && text.split_whitespace().all(is_corner)
}

/// Counted from 1, or backwards from the last.
fn is_index(text: &str, count: u64) -> bool {
    text.parse::<i64>().is_ok_and(|index| index != 0 && index.unsigned_abs() <= count)
}

fn shortened(line: &str) -> String {
    line.chars().take(40).collect()
}

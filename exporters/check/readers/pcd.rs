//! Binary PCD: the header, and that the body has the length it states.

use super::{Content, Found, Unfit};

/// Most lines of a header.
const MOST_LINES: usize = 64;

/// Reads `.pcd`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let (mut sizes, mut counts, mut points) = (None, None, None);
    for _ in 0..MOST_LINES {
        let line = content.line()?.ok_or("has no end of its header")?;
        let (key, values) = line.split_once(' ').unwrap_or((&line, ""));
        match key {
            "SIZE" => sizes = numbers(values),
            "COUNT" => counts = numbers(values),
            "POINTS" => points = numbers(values).filter(|points| points.len() == 1).map(|points| points[0]),
            "DATA" if values != "binary" => return Err("is not a binary PCD".into()),
            "DATA" => break,
            _ => {}
        }
    }
    let (Some(sizes), Some(counts), Some(points)) = (sizes, counts, points) else {
        return Err("has an invalid PCD header".into());
    };
    let row =
        sizes.iter().zip(&counts).fold(0, |sum: u64, (size, count)| sum.saturating_add(size.saturating_mul(*count)));
    if sizes.len() != counts.len() || row == 0 {
        return Err("has an invalid PCD header".into());
    }
    content.skip(row.saturating_mul(points))?;
    content.end()
}

fn numbers(text: &str) -> Option<Vec<u64>> {
    text.split_whitespace().map(|word| word.parse().ok()).collect()
}

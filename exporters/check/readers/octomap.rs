//! OctoMap binary trees: some lines, then a tree with as many nodes as they state.

use super::{Content, Found, Unfit};

/// Levels of a tree below its root.
const LEVELS: u32 = 16;
/// Most lines before the tree.
const MOST_LINES: usize = 64;

/// Reads `.bt`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    if content.line()?.as_deref() != Some("# Octomap OcTree binary file") {
        return Err("is not a binary OctoMap".into());
    }
    let (mut size, mut has_resolution) = (None, false);
    for _ in 0..MOST_LINES {
        let line = content.line()?.ok_or("has no tree")?;
        match line.split_once(' ') {
            Some(("size", count)) => size = count.parse::<u64>().ok(),
            Some(("res", side)) => has_resolution = side.parse().is_ok_and(|side: f64| side > 0.0),
            _ if line == "data" => break,
            _ => {}
        }
    }
    let (Some(size), true) = (size, has_resolution) else {
        return Err("does not state its size and resolution".into());
    };
    let nodes = if size == 0 { 0 } else { 1 + below(content, LEVELS)? };
    if nodes != size {
        return Err(Unfit(format!("states {size} nodes and has {nodes}")));
    }
    content.end()
}

/// Number of nodes below one that has so many levels below it.
fn below(content: &mut Content<'_>, levels: u32) -> Result<u64, Unfit> {
    if levels == 0 {
        return Err("has a tree that is too deep".into());
    }
    let kinds = u16::from_le_bytes(content.array()?);
    let kinds = (0..8).map(|child| kinds >> (2 * child) & 0b11);
    let mut nodes = kinds.clone().filter(|kind| *kind != 0).count() as u64;
    for _ in kinds.filter(|kind| *kind == 0b11) {
        nodes += below(content, levels - 1)?;
    }
    Ok(nodes)
}

//! MJCF with what it includes.

use plume_exporters::package::Memory;

/// A model of a package with the elements of each file that it includes in its place, as MuJoCo reads it.
pub fn whole(package: &Memory, path: &str) -> String {
    let text = std::str::from_utf8(&package.bytes[path]).unwrap();
    text.lines().map(|line| included(package, line).unwrap_or_else(|| format!("{line}\n"))).collect()
}

/// What a line includes, without the root element.
fn included(package: &Memory, line: &str) -> Option<String> {
    let (path, _) = line.split_once("<include file=\"")?.1.split_once('"')?;
    let text = whole(package, path);
    let (_, rest) = text.trim_end().split_once('\n').unwrap();
    let (elements, _) = rest.rsplit_once('\n').unwrap();
    Some(format!("{elements}\n"))
}

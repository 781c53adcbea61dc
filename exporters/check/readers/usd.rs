//! USD layers, as text and as binary ("crate").
//!
//! A crate keeps its strings, including file names, in one table of tokens (`pxr/usd/sdf/crateFile.h` of OpenUSD). Those
//! with a known extension are taken for file names.

use super::{Content, Found, Unfit, is_file_name};

/// The section of a crate that holds file names.
const TOKENS: &[u8] = b"TOKENS\0";
/// The largest table of tokens. Geometry is not in it.
const MOST_TOKEN_BYTES: usize = 1 << 26;

/// Reads `.usda`: asset paths are enclosed in `@`.
pub fn read_text(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let text = content.text()?;
    if !text.starts_with("#usda 1.0") {
        return Err("is not a USD text file".into());
    }
    let mut rest = text.as_str();
    while let Some(start) = rest.find(['"', '\'', '#', '@']) {
        rest = &rest[start..];
        let closing = closing_mark(rest);
        let inner = &rest[closing.len().min(rest.len())..];
        let inner = if closing == "\n" { &rest[1..] } else { inner };
        let Some(end) = end_of(inner, closing) else {
            return if closing == "\n" { Ok(()) } else { Err("has an unterminated string".into()) };
        };
        if closing.starts_with('@') && end > 0 {
            found.reference(content.path(), &inner[..end]);
        }
        rest = &inner[end + closing.len()..];
    }
    Ok(())
}

/// What ends the string, comment or asset path that begins here.
fn closing_mark(text: &str) -> &'static str {
    let marks = ["\"\"\"", "'''", "@@@", "\"", "'", "@"];
    marks.into_iter().find(|mark| text.starts_with(mark)).unwrap_or("\n")
}

/// Where it ends; a backslash escapes what follows.
fn end_of(text: &str, mark: &str) -> Option<usize> {
    let mut from = 0;
    loop {
        let end = from + text[from..].find(mark)?;
        let slashes = text[..end].bytes().rev().take_while(|&byte| byte == b'\\').count();
        if slashes % 2 == 0 || mark.starts_with(['\n', '@']) {
            return Some(end);
        }
        from = end + 1;
    }
}

/// Reads `.usdc`.
pub fn read_crate(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let bytes = content.rest()?;
    if !bytes.starts_with(b"PXR-USDC") {
        return Err("is not a binary USD file".into());
    }
    let tokens = tokens(&bytes).ok_or("is a binary USD file with broken tables")?;
    let texts = tokens.split(|&byte| byte == 0).filter_map(|text| std::str::from_utf8(text).ok());
    let is_path = |text: &&str| is_file_name(text) && !text.contains([' ', '\n']);
    texts.filter(is_path).for_each(|text| found.reference(content.path(), text));
    Ok(())
}

/// The tokens of a crate, each with a terminating zero.
fn tokens(bytes: &[u8]) -> Option<Vec<u8>> {
    let contents = usize::try_from(number(bytes, 16)?).ok()?;
    let count = usize::try_from(number(bytes, contents)?).ok()?;
    let sections = bytes.get(contents.checked_add(8)?..)?.chunks_exact(32).take(count);
    let sections: Vec<&[u8]> = sections.collect();
    let is_inside = |section: &&[u8]| span(section).is_some_and(|(start, end)| bytes.get(start..end).is_some());
    if sections.len() != count || !sections.iter().all(is_inside) {
        return None;
    }
    let section = sections.into_iter().find(|section| section.starts_with(TOKENS))?;
    let (start, end) = span(section)?;
    unpacked(&bytes[start..end])
}

/// Start and end of a section.
fn span(section: &[u8]) -> Option<(usize, usize)> {
    let start = usize::try_from(number(section, 16)?).ok()?;
    let size = usize::try_from(number(section, 24)?).ok()?;
    Some((start, start.checked_add(size)?))
}

/// The tokens of a section: count, size, packed size, and a single LZ4 block, marked as such by a leading zero.
fn unpacked(section: &[u8]) -> Option<Vec<u8>> {
    let size = usize::try_from(number(section, 8)?).ok().filter(|&size| size <= MOST_TOKEN_BYTES)?;
    let packed = usize::try_from(number(section, 16)?).ok()?;
    let block = section.get(24..24_usize.checked_add(packed)?)?.strip_prefix(&[0])?;
    lz4_flex::block::decompress(block, size).ok().filter(|tokens| tokens.len() == size)
}

fn number(bytes: &[u8], at: usize) -> Option<u64> {
    let eight = bytes.get(at..at.checked_add(8)?)?;
    Some(u64::from_le_bytes(eight.try_into().ok()?))
}

//! Binary FBX: the tree of nodes, and the files that textures refer to. Written here because `fbxcel` panics on some broken
//! files.

use std::io::Read;

use super::{Content, Found, Unfit};

const MAGIC: [u8; 23] = *b"Kaydara FBX Binary  \0\x1a\0";
/// From this version on offsets have eight bytes.
const WIDE: u32 = 7500;
/// Nodes within nodes.
const MOST_DEPTH: usize = 64;
/// Nodes whose text is a file.
const FILES: [&[u8]; 3] = [b"RelativeFilename", b"FileName", b"Filename"];
/// The longest name of a file.
const MOST_NAME_BYTES: u32 = 4096;

/// Reads `.fbx`.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    if content.array()? != MAGIC {
        return Err("is not a binary FBX".into());
    }
    let version = content.u32()?;
    let mut tree = Tree { is_wide: version >= WIDE, at: 27, ends: Vec::new() };
    while tree.read_node(content, found)? {}
    Ok(())
}

/// The reader's position in the tree.
struct Tree {
    is_wide: bool,
    at: u64,
    /// Ends of the enclosing nodes.
    ends: Vec<u64>,
}

impl Tree {
    /// Reads the head and the properties of a node; false at the end of the tree.
    fn read_node(&mut self, content: &mut Content<'_>, found: &mut Found) -> Result<bool, Unfit> {
        self.ends.retain(|&end| end != self.at);
        let (end, count, bytes) = (self.number(content)?, self.number(content)?, self.number(content)?);
        let [length] = content.array()?;
        self.at += 1;
        if end == 0 {
            return self.close();
        }
        let name = content.block(length.into())?;
        self.at += u64::from(length);
        let room = self.ends.last().copied().unwrap_or(content.size());
        if self.at.checked_add(bytes).is_none_or(|after| after > end) || end > room || self.ends.len() >= MOST_DEPTH {
            return Err("has a node that extends beyond its parent".into());
        }
        if count > 0 && FILES.contains(&&*name) {
            read_file_name(bytes, content, found)?;
        } else {
            content.skip(bytes)?;
        }
        self.at += bytes;
        self.ends.push(end);
        Ok(true)
    }

    /// The null record that ends a list of nodes.
    fn close(&mut self) -> Result<bool, Unfit> {
        match self.ends.pop() {
            None => Ok(false),
            Some(end) if end == self.at => Ok(true),
            Some(_) => Err("has a node with a wrong end offset".into()),
        }
    }

    fn number(&mut self, content: &mut Content<'_>) -> Result<u64, Unfit> {
        self.at += if self.is_wide { 8 } else { 4 };
        Ok(if self.is_wide { u64::from_le_bytes(content.array()?) } else { content.u32()?.into() })
    }
}

/// Reads the properties of a node, the first of which is a string: `S`, length, bytes.
fn read_file_name(bytes: u64, content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let [kind] = content.array()?;
    let length = content.u32()?;
    let rest = bytes.checked_sub(5 + u64::from(length));
    let (b'S', Some(rest), 0..=MOST_NAME_BYTES) = (kind, rest, length) else {
        return Err("has a file name that is not a string".into());
    };
    let mut name = vec![0; length as usize];
    content.read_exact(&mut name)?;
    let name = String::from_utf8(name).map_err(|_| Unfit::from("has a file name that is not UTF-8"))?;
    if !name.is_empty() {
        found.reference(content.path(), name);
    }
    content.skip(rest)
}

//! NumPy archives: zips of arrays.

use std::io::{self, Cursor, Read};

use zip::ZipArchive;

use super::{Content, Found, Unfit};

/// Most bytes of all arrays together.
const MOST_BYTES: u64 = 1 << 32;

/// Reads `.npz` with all its arrays.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let mut archive = ZipArchive::new(Cursor::new(content.rest()?)).map_err(|_| "is not a zip")?;
    let mut left = MOST_BYTES;
    for number in 0..archive.len() {
        let mut array = archive.by_index(number).map_err(|_| "has an entry that cannot be read")?;
        let magic = "has an entry that is not an array";
        let mut head = [0; 8];
        array.read_exact(&mut head).map_err(|_| magic)?;
        if head != *b"\x93NUMPY\x01\x00" {
            return Err(magic.into());
        }
        // The end of each entry has its checksum.
        let bytes = io::copy(&mut array.take(left), &mut io::sink()).map_err(|_| "has a damaged array")?;
        left -= bytes;
        if left == 0 {
            return Err("unpacks to more than is looked at".into());
        }
    }
    Ok(())
}

//! Files packed by gzip: that they unpack, and to what their checksums say.

use std::io::{self, Read};

use flate2::read::GzDecoder;

use super::{Content, Found, Unfit};

/// Most bytes that are unpacked.
const MOST_BYTES: u64 = 1 << 32;

/// Reads `.gz`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let packed = content.rest()?;
    let mut unpacked = GzDecoder::new(&packed[..]).take(MOST_BYTES);
    match io::copy(&mut unpacked, &mut io::sink()) {
        Ok(MOST_BYTES) => Err("unpacks to more than is looked at".into()),
        Ok(_) => Ok(()),
        Err(_) => Err("does not unpack".into()),
    }
}

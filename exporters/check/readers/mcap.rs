//! MCAP: that it is a chain of records from one magic to another.

use super::{Content, Found, Unfit};

const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
/// The kind of the last record.
const FOOTER: u8 = 2;

/// Reads `.mcap`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    if content.array()? != MAGIC {
        return Err("is not an MCAP".into());
    }
    loop {
        let [kind] = content.array()?;
        let length = u64::from_le_bytes(content.array()?);
        content.skip(length)?;
        if kind == FOOTER {
            break;
        }
    }
    if content.array()? != MAGIC {
        return Err("does not end as an MCAP".into());
    }
    content.end()
}

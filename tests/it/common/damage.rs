//! Files that are damaged a little.

/// Every way to cut a file off, and to change one byte: into each of these, by its lowest or its highest bit, and to zero.
pub fn damaged(bytes: &[u8], others: &[u8]) -> impl Iterator<Item = (String, Vec<u8>)> {
    let cut = (0..bytes.len()).map(|length| (format!("cut off at {length}"), bytes[..length].to_vec()));
    let changed = (0..bytes.len()).flat_map(move |place| {
        let flipped = [bytes[place] ^ 1, bytes[place] ^ 0x80, 0];
        others.iter().copied().chain(flipped).map(move |byte| {
            let mut bytes = bytes.to_vec();
            bytes[place] = byte;
            (format!("byte {place} is {byte}"), bytes)
        })
    });
    cut.chain(changed)
}

//! Texts that reveal whether they were changed since they were written.
//!
//! A seal is not a signature: it detects accidents, not forgery.
//!
//! ```
//! use plume_disk::sealed::{seal, unseal};
//!
//! let text = seal("{\n  \"chunks\": 3\n}");
//! assert!(unseal(text.as_bytes()).is_some());
//! assert!(unseal(text.replace('3', "4").as_bytes()).is_none());
//! ```

use sha2::{Digest, Sha256};

/// The text before the seal, and after it.
const SEAL: &str = "  \"seal\": \"";
const SEAL_END: &str = "\"\n}\n";
const HEX_DIGITS: usize = 64;

/// A pretty-printed JSON object with one more key at its end: the SHA-256 of everything before the digits.
pub fn seal(json: &str) -> String {
    let before = format!("{},\n{SEAL}", json.trim_end_matches("\n}"));
    let digits = sha256(before.as_bytes());
    before + &digits + SEAL_END
}

/// The JSON object without its seal; `None` if the seal is missing or wrong.
pub fn unseal(text: &[u8]) -> Option<Vec<u8>> {
    let before = text.strip_suffix(SEAL_END.as_bytes())?;
    let (before, digits) = before.split_at_checked(before.len().checked_sub(HEX_DIGITS)?)?;
    if sha256(before).as_bytes() != digits {
        return None;
    }
    let bare = before.strip_suffix(format!(",\n{SEAL}").as_bytes())?;
    Some([bare, b"\n}"].concat())
}

/// Whether a text has a seal, valid or not.
pub fn looks_sealed(text: &[u8]) -> bool {
    text.windows(SEAL.len()).any(|window| window == SEAL.as_bytes())
}

/// SHA-256 in lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes in lower-case hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_changed_byte_breaks_the_seal() {
        let sealed = seal("{\n  \"a\": 1\n}");
        assert_eq!(unseal(sealed.as_bytes()).unwrap(), b"{\n  \"a\": 1\n}");
        for place in 0..sealed.len() {
            let mut changed = sealed.clone().into_bytes();
            changed[place] ^= 1;
            assert_eq!(unseal(&changed), None, "byte {place}");
        }
        for end in 0..sealed.len() {
            assert_eq!(unseal(&sealed.as_bytes()[..end]), None, "cut at {end}");
        }
    }
}

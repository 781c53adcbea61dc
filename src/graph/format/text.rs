//! What all formats that are text have in common.

use super::{ReadError, Source};

/// The text of a file, without the byte order mark.
pub(super) fn utf8<'a>(source: &Source<'a>) -> Result<&'a str, ReadError> {
    let text = str::from_utf8(source.bytes);
    let text = text.map_err(|error| {
        ReadError::byte(source.path, error.valid_up_to(), "is not UTF-8 text", "save the file as UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

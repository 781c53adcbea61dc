//! Shared by all text formats.

use std::path::Path;

use super::ReadError;
use super::limits::{MAX_COORDINATE_M, MAX_LENGTH_M};
use plume_graph::echo::shown;

/// Hint for an invalid length.
pub(super) const LENGTH_HINT: &str = "lengths are decimal numbers in metres, coordinates at most 100,000 km";

/// The text of a file, without the byte order mark.
pub(super) fn utf8<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, ReadError> {
    let text = str::from_utf8(bytes);
    let text = text
        .map_err(|error| ReadError::byte(path, error.valid_up_to(), "is not UTF-8 text", "save the file as UTF-8"))?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// The line of a byte, counted from 1; at the end of a line, that of the next character.
pub(super) fn line_of(text: &str, byte: usize) -> usize {
    let (before, after) = text.as_bytes().split_at(byte.min(text.len()));
    let blank = after.iter().take_while(|byte| matches!(byte, b'\r' | b'\n'));
    1 + before.iter().chain(blank).filter(|&&byte| byte == b'\n').count()
}

/// A coordinate in metres in its grid, or what is wrong with it.
pub(super) fn coordinate(text: &str) -> Result<f64, String> {
    match number(text)? {
        far if far.abs() > MAX_COORDINATE_M => Err(format!("{} is too far away", shown(text))),
        near => Ok(near),
    }
}

/// A radius, width or height in metres, or what is wrong with it; less than half a millimetre counts as unknown, 0.
pub(super) fn length(text: &str) -> Result<f64, String> {
    match number(text)? {
        below if below < 0.0 => Err(format!("{} is negative", shown(text))),
        above if above > MAX_LENGTH_M => Err(format!("{} is too large", shown(text))),
        small if small < 0.0005 => Ok(0.0),
        length => Ok(length),
    }
}

/// A non-negative whole number, also if written as a decimal, or what is wrong with it.
pub(super) fn whole(text: &str) -> Result<u32, String> {
    let number = number(text)?;
    let is_whole = number >= 0.0 && number <= f64::from(u32::MAX) && number.fract() == 0.0;
    if is_whole { Ok(number as u32) } else { Err(format!("{} is not a non-negative whole number", shown(text))) }
}

/// A finite number.
fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("{} is not a number", shown(text)))
}

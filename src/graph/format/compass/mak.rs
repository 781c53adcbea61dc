//! Projects: which books belong together, which stations they share, and where some of them are.
//!
//! ```text
//! #DEEP1.DAT,A1[F,10.1,20.2,30.3];    / a book, with a station at known coordinates in feet
//! #DEEP2.DAT,A7,A9;                   / a book that shares two stations with those before it
//! ```
//! Folders, datums, zones and settings are passed over.

use std::path::{Path, PathBuf};

use nalgebra::Point3;

use super::super::ReadError;
use super::super::limits::MAX_FILES;
use super::METRES_PER_FOOT;

const HINT: &str = "a book is #FILE.DAT,STATION,STATION[M,east,north,up]; with a semicolon at its end";

/// One of the books of a project.
pub(super) struct Book {
    pub(super) path: PathBuf,
    /// Where the project names it.
    pub(super) line: usize,
    /// Stations that it shares with the books before it, if only some.
    pub(super) links: Vec<Vec<u8>>,
    /// Stations whose coordinates are known, in metres.
    pub(super) fixes: Vec<(Vec<u8>, Point3<f64>)>,
}

/// The books of a project in their order.
pub(super) fn books(path: &Path, bytes: &[u8]) -> Result<Vec<Book>, ReadError> {
    let mut books = Vec::new();
    for (line, entry) in entries(bytes) {
        let fault = |message: String| ReadError::line(path, line, message, HINT);
        if books.len() >= MAX_FILES {
            return Err(fault(format!("names more than {MAX_FILES} books")));
        }
        let entry = entry.ok_or_else(|| fault("names a book that does not end".to_owned()))?;
        books.push(book(path, line, &entry).map_err(fault)?);
    }
    if books.is_empty() {
        return Err(ReadError::whole(path, "names no book", HINT));
    }
    Ok(books)
}

/// What stands between each `#` and its semicolon, without blanks and comments, and the line where it starts; `None`
/// where the semicolon is missing. Comments reach from a slash to the next or to the end of the line.
fn entries(bytes: &[u8]) -> Vec<(usize, Option<Vec<u8>>)> {
    let mut entries = Vec::new();
    let (mut line, mut in_comment) = (1, false);
    let mut entry: Option<(usize, Vec<u8>)> = None;
    for &byte in bytes {
        line += usize::from(byte == b'\n');
        in_comment = match byte {
            b'\n' => false,
            b'/' => !in_comment,
            _ => in_comment,
        };
        if in_comment || byte == b'/' || byte.is_ascii_whitespace() {
            continue;
        }
        match (byte, entry.as_mut()) {
            (b'#', None) => entry = Some((line, Vec::new())),
            (b';', Some(_)) => entries.extend(entry.take().map(|(line, text)| (line, Some(text)))),
            (_, Some((_, text))) => text.push(byte),
            _ => {}
        }
    }
    entries.extend(entry.map(|(line, _)| (line, None)));
    entries
}

fn book(project: &Path, line: usize, entry: &[u8]) -> Result<Book, String> {
    let text = String::from_utf8_lossy(entry);
    let (file, mut rest) = text.split_once(',').unwrap_or((&text, ""));
    if file.is_empty() {
        return Err("names a book without a name".to_owned());
    }
    let path = project.parent().unwrap_or(Path::new("")).join(file.replace('\\', "/"));
    let mut book = Book { path, line, links: Vec::new(), fixes: Vec::new() };
    while !rest.is_empty() {
        let end = rest.find([',', '[']).unwrap_or(rest.len());
        let (name, after) = rest.split_at(end);
        rest = after.strip_prefix(',').unwrap_or(after);
        if let Some(fix) = after.strip_prefix('[') {
            let (place, after) = fix.split_once(']').ok_or_else(|| format!("fixes {name:?} without an end"))?;
            book.fixes.push((name.into(), position(place).ok_or_else(|| format!("fixes {name:?} at {place:?}"))?));
            rest = after.strip_prefix(',').unwrap_or(after);
        } else if !name.is_empty() {
            book.links.push(name.into());
        }
    }
    Ok(book)
}

/// A unit and three numbers.
fn position(text: &str) -> Option<Point3<f64>> {
    let mut parts = text.split(',');
    let metres = match parts.next()? {
        "F" | "f" => METRES_PER_FOOT,
        "M" | "m" => 1.0,
        _ => return None,
    };
    let mut number = || parts.next()?.parse().ok().filter(|number: &f64| number.abs() < 1e9);
    Some(Point3::new(number()?, number()?, number()?) * metres)
}

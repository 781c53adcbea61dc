//! Survey books of Compass (Fish: fountainware.com/compass): `.dat`, and the projects `.mak` that put several together.
//!
//! Shots are measured and loops closed as those of other surveys ([`measure`](super::measure),
//! [`centreline`](super::centreline)). Left, right, up and down come along. Shots flagged `X` do not exist, `S` are splays,
//! `L` (not counted in the length) are duplicates, `P` (not plotted) are taken to lead over the ground, `C` (not adjusted)
//! hardly give way when loops close. Calibrations, declinations and redundant backsights are applied; the convergence
//! of a grid and the project's own settings are not: coordinates are taken as they stand. As by Survex, shots between the same
//! stations one after the other count as their mean, and a shot without length says that two stations are one.
//!
//! The crate `compass_data` 0.0.7 reads these files too, but panics at a date that does not exist, which books with
//! unknown dates have, drops flags and backsights, and takes the first line that it cannot read for the end.

mod dat;
mod mak;

use super::centreline::{Centreline, Name, Names};
use super::files::Files;
use super::{Import, Parts, ReadError, Source};

/// Reads a file as a row of [`FORMATS`](super::FORMATS) does.
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let mut reader = Reader { files: Files::new(source), centreline: Centreline::default(), book: Names::ROOT };
    if source.path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mak")) {
        reader.read_project(source.bytes)?;
    } else {
        reader.read_book(source.bytes)?;
    }
    reader.centreline.into_import(source, parts, &reader.files)
}

/// Books while they are read.
struct Reader<'a> {
    files: Files<'a>,
    centreline: Centreline,
    /// What the names are below that the book knows.
    book: Name,
}

impl Reader<'_> {
    fn station(&mut self, name: &str) -> Result<Name, String> {
        self.centreline.names.below(self.book, name)
    }
}

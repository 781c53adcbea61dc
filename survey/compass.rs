//! Compass survey data (Fish: fountainware.com/compass): `.dat` files, and `.mak` projects that combine several.
//!
//! Shots are computed and loops closed as in other surveys ([`measure`](super::measure),
//! [`centreline`](super::centreline)). Left, right, up and down are used. Shots flagged `X` are ignored, `S` are splays,
//! `L` (not counted in the length) are duplicates, `P` (not plotted) are taken for surface legs, `C` (not adjusted) are
//! hardly adjusted when loops are closed. Calibrations, declinations and redundant backsights are applied; grid convergence
//! and the project's own settings are not: coordinates are taken as they are. As in Survex, consecutive shots between the
//! same stations count as their mean, and a zero-length shot equates two stations.
//!
//! The crate `compass_data` 0.0.7 reads these files too, but panics on invalid dates, which files with unknown dates have,
//! drops flags and backsights, and takes the first line that it cannot read for the end.

mod dat;
mod mak;

use super::centreline::{Centreline, Name, Names};
use super::files::Files;
use super::{Import, Parts, ReadError, Source};

/// Reader of a row of [`FORMATS`](super::FORMATS).
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let mut reader = Reader { files: Files::new(source), centreline: Centreline::default(), book: Names::ROOT };
    if source.path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mak")) {
        reader.read_project(source.bytes)?;
    } else {
        reader.read_book(source.bytes)?;
    }
    reader.centreline.into_import(source, parts, &reader.files)
}

/// A project while it is read.
struct Reader<'a> {
    files: Files<'a>,
    centreline: Centreline,
    /// The scope of the names in the current file.
    book: Name,
}

impl Reader<'_> {
    fn station(&mut self, name: &str) -> Result<Name, String> {
        self.centreline.names.below(self.book, name)
    }
}

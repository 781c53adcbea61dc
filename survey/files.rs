//! Text files that include others, read within limits.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::limits::{MAX_BYTES, MAX_DEPTH, MAX_FILES, MAX_LINE};
use super::{
    OUTSIDE_FILE, OUTSIDE_HINT, OUTSIDE_LINE, OUTSIDE_LINE_HINT, OUTSIDE_READING, Place, ReadError, Source, Warning,
};
use plume_graph::echo::shown;

/// A line of a file that was read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FilePosition {
    file: usize,
    /// From 1.
    pub(super) line: usize,
}

/// The files of one survey.
pub(super) struct Files<'a> {
    source: &'a Source<'a>,
    /// All files read, in order.
    paths: Vec<PathBuf>,
    /// Whether each file is outside the folder of the first.
    is_outside: Vec<bool>,
    /// The files that are being read, the innermost last.
    open: Vec<usize>,
    bytes: usize,
}

impl<'a> Files<'a> {
    /// Starts with the file that includes all others.
    pub(super) fn new(source: &'a Source<'a>) -> Self {
        let paths = vec![source.path.to_path_buf()];
        Self { source, paths, is_outside: vec![false], open: vec![0], bytes: source.bytes.len() }
    }

    /// A line of the file that is being read.
    pub(super) fn file_position(&self, line: usize) -> FilePosition {
        FilePosition { file: self.open.last().copied().unwrap_or_default(), line }
    }

    /// An error in a line.
    pub(super) fn fault(
        &self,
        file_position: FilePosition,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> ReadError {
        match self.is_outside[file_position.file] {
            true => {
                ReadError::line(&self.paths[file_position.file], file_position.line, OUTSIDE_LINE, OUTSIDE_LINE_HINT)
            }
            false => ReadError::line(&self.paths[file_position.file], file_position.line, message, hint),
        }
    }

    /// A doubt about readings in a line.
    pub(super) fn warning(&self, file_position: FilePosition, message: String) -> Warning {
        let FilePosition { file, line } = file_position;
        let message = if self.is_outside[file] { OUTSIDE_READING.to_owned() } else { message };
        Warning { place: Place::Line(self.paths[file].clone(), line), message }
    }

    /// An error of the whole file that is being read.
    pub(super) fn fault_of_file(&self, message: impl Into<String>, hint: impl Into<String>) -> ReadError {
        let file = self.file_position(0).file;
        match self.is_outside[file] {
            true => ReadError::whole(&self.paths[file], OUTSIDE_LINE, OUTSIDE_LINE_HINT),
            false => ReadError::whole(&self.paths[file], message, hint),
        }
    }

    /// Whether names may come from files of which nothing may be shown.
    pub(super) fn has_outside_files(&self) -> bool {
        self.is_outside.contains(&true)
    }

    /// Opens the file that a line includes, relative to the including file: as named or with an extension, in the given or
    /// in lower case. Must be closed again. A file outside the folder of the first file is refused, unless allowed.
    pub(super) fn open(&mut self, file_position: FilePosition, name: &str, ending: &str) -> Result<Vec<u8>, ReadError> {
        let refused = |message: String, hint: &str| Err(self.fault(file_position, message, hint));
        if self.open.len() >= MAX_DEPTH {
            return refused(format!("includes are nested more than {MAX_DEPTH} deep"), "");
        }
        if self.paths.len() >= MAX_FILES {
            return refused(format!("the survey includes more than {MAX_FILES} files"), "");
        }
        let folder = self.paths[file_position.file].parent().unwrap_or(Path::new(""));
        let name = name.replace('\\', "/");
        let small = name.to_ascii_lowercase();
        let names = [name.clone(), format!("{name}{ending}"), small.clone(), format!("{small}{ending}")];
        let (mut first, mut is_refused) = (None, false);
        for path in names.iter().map(|name| folder.join(name)) {
            if self.open.iter().any(|&open| self.paths[open] == path) {
                return refused(format!("{} includes itself", shown(&name)), "remove the circular include");
            }
            let is_outside_file = self.source.is_outside_file(&path);
            if self.source.refuses(is_outside_file) {
                is_refused = true;
                continue;
            }
            match self.source.outside.read(&path) {
                Ok(bytes) if self.bytes + bytes.len() > MAX_BYTES => {
                    let message = format!("the files are larger than {} MiB in total", MAX_BYTES >> 20);
                    return refused(message, "");
                }
                Ok(bytes) => {
                    self.bytes += bytes.len();
                    self.open.push(self.paths.len());
                    self.paths.push(path);
                    self.is_outside.push(is_outside_file);
                    return Ok(bytes);
                }
                Err(error) => first = first.or(Some(error)),
            }
        }
        if is_refused {
            return refused(format!("{} {OUTSIDE_FILE}", shown(&name)), OUTSIDE_HINT);
        }
        let why = first.map(|error| error.to_string()).unwrap_or_default();
        refused(format!("{} cannot be read: {why}", shown(&name)), "paths are relative to the file that includes them")
    }

    /// Closes the innermost file.
    pub(super) fn close(&mut self) {
        self.open.pop();
    }

    /// The lines of a text with their numbers.
    ///
    /// # Errors
    /// For a line that is too long.
    pub(super) fn line<'t>(&self, number: usize, line: &'t str) -> Result<&'t str, ReadError> {
        if line.len() > MAX_LINE {
            let message = format!("the line is longer than {} KiB", MAX_LINE >> 10);
            return Err(self.fault(self.file_position(number), message, "is this a text file?"));
        }
        Ok(line.strip_suffix('\r').unwrap_or(line))
    }
}

/// The text of a file: UTF-8, otherwise Latin-1, as in old surveys.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()),
    }
}

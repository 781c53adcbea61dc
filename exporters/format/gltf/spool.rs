//! Lists of a document that may be longer than memory: what is settled waits in a file, as the text that it will be.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use gltf_json::Index;
use serde::ser::{Error, SerializeSeq};
use serde::{Serialize, Serializer};
use serde_json::value::RawValue;

/// Text that is kept in memory before it goes to the file; short documents need no file.
const KEPT_BYTES: usize = 1 << 16;

/// A list to which elements are added, and of which those since it was last [settled](Self::settle) may still change.
pub struct Spool<T> {
    /// Elements that are settled, a line of JSON each: those in the file, then those in the text.
    settled: usize,
    file: Option<File>,
    text: Vec<u8>,
    recent: Vec<T>,
}

impl<T> Default for Spool<T> {
    fn default() -> Self {
        Self { settled: 0, file: None, text: Vec::new(), recent: Vec::new() }
    }
}

impl<T: Serialize> Spool<T> {
    pub(super) fn is_empty(&self) -> bool {
        self.settled + self.recent.len() == 0
    }

    pub(super) fn push(&mut self, element: T) -> Index<T> {
        let index = Index::new((self.settled + self.recent.len()) as u32);
        self.recent.push(element);
        index
    }

    /// An element added since the list was settled.
    ///
    /// # Panics
    /// If it was added before.
    pub(super) fn recent(&mut self, index: Index<T>) -> &mut T {
        &mut self.recent[index.value() - self.settled]
    }

    /// Makes all elements what they will be. Their text goes to a file in the folder `scratch` when there is enough of it.
    ///
    /// # Errors
    /// Those of the file.
    pub(super) fn settle(&mut self, scratch: &Path) -> io::Result<()> {
        self.settled += self.recent.len();
        for element in self.recent.drain(..) {
            serde_json::to_writer(&mut self.text, &element)?;
            self.text.push(b'\n');
        }
        if self.text.len() < KEPT_BYTES {
            return Ok(());
        }
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(tempfile::tempfile_in(scratch)?),
        };
        file.write_all(&self.text)?;
        self.text.clear();
        Ok(())
    }

    /// The settled text from its beginning.
    fn read(&self) -> io::Result<impl BufRead> {
        let mut file = self.file.as_ref();
        if let Some(file) = &mut file {
            file.seek(SeekFrom::Start(0))?;
        }
        let file: Box<dyn Read> = file.map_or(Box::new(io::empty()), |file| Box::new(file));
        Ok(BufReader::new(file.chain(&*self.text)))
    }
}

/// A JSON array of what is settled.
impl<T: Serialize> Serialize for Spool<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut array = serializer.serialize_seq(Some(self.settled))?;
        for line in self.read().map_err(S::Error::custom)?.lines() {
            let element = RawValue::from_string(line.map_err(S::Error::custom)?).map_err(S::Error::custom)?;
            array.serialize_element(&element)?;
        }
        array.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_those_that_were_pushed() {
        let scratch = tempfile::tempdir().unwrap();
        let (mut spool, mut list) = (Spool::default(), Vec::new());
        assert!(spool.is_empty());
        for number in 0..40_000_u32 {
            let index = spool.push(vec![number]);
            assert_eq!(index.value(), list.len());
            if number % 7 == 0 {
                spool.recent(index).push(1);
            }
            list.push(if number % 7 == 0 { vec![number, 1] } else { vec![number] });
            if number % 1000 == 0 {
                spool.settle(scratch.path()).unwrap();
            }
        }
        spool.settle(scratch.path()).unwrap();
        assert!(spool.file.is_some() && !spool.text.is_empty());
        // A length is counted before the text is written.
        for _ in 0..2 {
            assert_eq!(serde_json::to_string(&spool).unwrap(), serde_json::to_string(&list).unwrap());
        }
    }

    #[test]
    fn a_file_that_cannot_be_made_is_told() {
        let mut spool = Spool::default();
        spool.push("x".repeat(KEPT_BYTES));
        assert!(spool.settle(Path::new("no/such/folder")).is_err());
    }
}

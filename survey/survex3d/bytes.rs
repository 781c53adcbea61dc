//! Reads a file byte by byte; reading past the end is an error with its position.

use std::path::Path;

use super::super::ReadError;

/// The rest of a file.
pub(super) struct Bytes<'a> {
    path: &'a Path,
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(path: &'a Path, all: &'a [u8]) -> Self {
        Self { path, all, at: 0 }
    }

    /// Bytes read so far.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// The next `count` bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], ReadError> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.all.len());
        let end = end.ok_or_else(|| self.cut_short())?;
        let taken = &self.all[self.at..end];
        self.at = end;
        Ok(taken)
    }

    pub(super) fn skip(&mut self, count: usize) -> Result<(), ReadError> {
        self.take(count).map(|_| ())
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        Ok(self.take(N)?.try_into().expect("N bytes were taken"))
    }

    pub(super) fn u8(&mut self) -> Result<u8, ReadError> {
        Ok(self.array::<1>()?[0])
    }

    pub(super) fn u32(&mut self) -> Result<u32, ReadError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub(super) fn i16(&mut self) -> Result<i16, ReadError> {
        Ok(i16::from_le_bytes(self.array()?))
    }

    pub(super) fn i32(&mut self) -> Result<i32, ReadError> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    /// The bytes up to the next line feed, without it.
    pub(super) fn line(&mut self) -> Result<&'a [u8], ReadError> {
        let length = self.all[self.at..].iter().position(|&byte| byte == b'\n').ok_or_else(|| self.cut_short())?;
        let line = self.take(length)?;
        self.skip(1)?;
        Ok(line)
    }

    /// An error at a byte.
    pub(super) fn fault_at(&self, at: usize, message: impl Into<String>, hint: &str) -> ReadError {
        ReadError::byte(self.path, at, message, hint)
    }

    fn cut_short(&self) -> ReadError {
        self.fault_at(
            self.all.len(),
            "ends too early",
            "copy the file again, or process the survey again with `cavern`",
        )
    }
}

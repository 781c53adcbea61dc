//! A file of a package as its reader sees it: a stream that is counted and hashed while it is read.

use std::io::{self, BufRead, BufReader, Read, Take};

use sha2::{Digest, Sha256};

use plume_disk::sealed::hex;

/// The largest part of a file that is held in memory.
const MOST_BYTES: u64 = 1 << 28;

/// Why a file is not what its extension says, as the predicate of a sentence about it.
#[derive(Debug)]
pub struct Unfit(pub String);

impl From<io::Error> for Unfit {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self("ends early".to_owned()),
            _ => Self(format!("cannot be read: {error}")),
        }
    }
}

impl From<&str> for Unfit {
    fn from(what: &str) -> Self {
        Self(what.to_owned())
    }
}

/// A file of a package.
pub struct Content<'a> {
    path: &'a str,
    size: u64,
    bytes: BufReader<Tally<'a>>,
}

struct Tally<'a> {
    inner: Take<&'a mut dyn Read>,
    count: u64,
    hash: Sha256,
}

impl<'a> Content<'a> {
    /// The file `path`, which should have `size` bytes; at most one byte more is read.
    pub fn new(path: &'a str, size: u64, bytes: &'a mut dyn Read) -> Self {
        let tally = Tally { inner: bytes.take(size.saturating_add(1)), count: 0, hash: Sha256::new() };
        Self { path, size, bytes: BufReader::with_capacity(1 << 16, tally) }
    }

    /// The file of exactly `size` bytes at the current position of a longer stream.
    pub fn part(path: &'a str, size: u64, bytes: &'a mut dyn Read) -> Self {
        let mut part = Self::new(path, size, bytes);
        part.bytes.get_mut().inner.set_limit(size);
        part
    }

    /// Path in the package.
    pub fn path(&self) -> &'a str {
        self.path
    }

    /// The size that it should have.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// Reads the rest, and returns the total number of bytes and their SHA-256.
    ///
    /// # Errors
    /// Those of the stream.
    pub fn finish(&mut self) -> io::Result<(u64, String)> {
        io::copy(&mut self.bytes, &mut io::sink())?;
        let tally = self.bytes.get_ref();
        Ok((tally.count, hex(&tally.hash.clone().finalize())))
    }

    /// The next bytes.
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], Unfit> {
        let mut array = [0; N];
        self.bytes.read_exact(&mut array)?;
        Ok(array)
    }

    /// The next four bytes as a little-endian number.
    pub fn u32(&mut self) -> Result<u32, Unfit> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    /// Skips bytes.
    pub fn skip(&mut self, count: u64) -> Result<(), Unfit> {
        let skipped = io::copy(&mut (&mut self.bytes).take(count), &mut io::sink())?;
        if skipped == count { Ok(()) } else { Err("ends early".into()) }
    }

    /// The next `count` bytes in memory.
    pub fn block(&mut self, count: u64) -> Result<Vec<u8>, Unfit> {
        if count > MOST_BYTES {
            return Err("is too large to be read into memory".into());
        }
        let mut block = Vec::new();
        (&mut self.bytes).take(count).read_to_end(&mut block)?;
        if block.len() as u64 == count { Ok(block) } else { Err("ends early".into()) }
    }

    /// The rest, in memory.
    pub fn rest(&mut self) -> Result<Vec<u8>, Unfit> {
        self.rest_up_to(MOST_BYTES)
    }

    /// The rest, in memory, if it has at most this many bytes.
    pub fn rest_up_to(&mut self, most: u64) -> Result<Vec<u8>, Unfit> {
        let mut rest = Vec::new();
        (&mut self.bytes).take(most + 1).read_to_end(&mut rest)?;
        if rest.len() as u64 > most { Err("is too large to be read into memory".into()) } else { Ok(rest) }
    }

    /// The rest, as text.
    pub fn text(&mut self) -> Result<String, Unfit> {
        String::from_utf8(self.rest()?).map_err(|_| "is not UTF-8".into())
    }

    /// The next line without its line ending, or `None` after the last.
    pub fn line(&mut self) -> Result<Option<String>, Unfit> {
        let mut line = Vec::new();
        if (&mut self.bytes).take(MOST_BYTES).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let text = String::from_utf8(line).map_err(|_| Unfit::from("is not UTF-8"))?;
        Ok(Some(text.trim_end_matches(['\n', '\r']).to_owned()))
    }

    /// Fails unless everything was read.
    pub fn end(&mut self) -> Result<(), Unfit> {
        if self.bytes.fill_buf()?.is_empty() { Ok(()) } else { Err("has trailing data".into()) }
    }
}

impl Read for Content<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.bytes.read(buffer)
    }
}

impl BufRead for Content<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.bytes.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.bytes.consume(count);
    }
}

impl Read for Tally<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.hash.update(&buffer[..count]);
        self.count += count as u64;
        Ok(count)
    }
}

//! Reads the files of a folder or an archive one by one, without writing anything to the disk.
//!
//! Nothing is trusted: names that lead outside, links, devices, duplicates and archives that unpack to far more than their
//! size are reported, not followed. Memory: the list of names, one file as a stream, and the window of the compression.

use std::collections::BTreeSet;
use std::io::{self, Read};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use plume_disk::regular;

use crate::package::path_fault;

mod folder;
mod tar;
mod zip;

/// The top-level folder of a `tgz`.
pub const TGZ_ROOT: &str = "package/";

/// The path of the folder or archive itself, in faults.
pub const WHOLE: &str = ".";

/// Most files of a package.
const MOST_FILES: usize = 200_000;
/// An archive may unpack to this many times its size. Meshes as text compress to a tenth, seldom to a fiftieth.
const MOST_TIMES: u64 = 200;
/// Additional allowance, because small archives are mostly headers.
const MOST_BYTES_MORE: u64 = 1 << 24;
/// The longest text that is read into memory.
const MOST_TEXT_BYTES: u64 = 1 << 26;

/// A folder or an archive.
pub struct Contents {
    path: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Folder,
    Zip,
    Tar(tar::Compression),
}

/// Receives the content of a folder or an archive.
pub trait Visitor {
    /// A file. Its path is valid in a package, and unique; its bytes need not be read to the end.
    fn file(&mut self, path: &str, bytes: &mut dyn Read) -> ControlFlow<()>;

    /// Something that is not allowed in a package: its path, and what is wrong.
    fn fault(&mut self, path: &str, what: &str);
}

impl Contents {
    /// Opens what is at `path`: a folder or, recognised by its first bytes, a zip, `tar.zst` or `tgz`.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] for any other file; I/O errors.
    pub fn open(path: &Path) -> io::Result<Self> {
        let kind = if path.is_dir() { Kind::Folder } else { kind(&head(path)?)? };
        Ok(Self { path: path.to_owned(), kind })
    }

    /// Passes everything to `visitor`, in stored order, until it breaks.
    ///
    /// # Errors
    /// If an archive is damaged, truncated, or unpacks to an implausible size; I/O errors.
    pub fn read(&self, visitor: &mut dyn Visitor) -> io::Result<()> {
        let gate = Gate { visitor, names: BTreeSet::new() };
        match self.kind {
            Kind::Folder => folder::read(&self.path, gate),
            Kind::Zip => zip::read(regular::open(&self.path)?, self.most_bytes()?, gate),
            Kind::Tar(compression) => tar::read(regular::open(&self.path)?, compression, self.most_bytes()?, gate),
        }
    }

    /// The bytes of one file, if it exists.
    ///
    /// # Errors
    /// As [`Contents::read`]; if the file has more than 64 MiB.
    pub fn text_of(&self, path: &str) -> io::Result<Option<Vec<u8>>> {
        let mut wanted = Wanted { path, found: None };
        self.read(&mut wanted)?;
        wanted.found.transpose()
    }

    fn most_bytes(&self) -> io::Result<u64> {
        Ok(regular::open(&self.path)?.metadata()?.len().saturating_mul(MOST_TIMES).saturating_add(MOST_BYTES_MORE))
    }
}

/// The first bytes of a file, which determine its format.
fn head(path: &Path) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    regular::open(path)?.take(4).read_to_end(&mut head)?;
    Ok(head)
}

fn kind(head: &[u8]) -> io::Result<Kind> {
    match head {
        [b'P', b'K', ..] => Ok(Kind::Zip),
        [0x28, 0xb5, 0x2f, 0xfd] => Ok(Kind::Tar(tar::Compression::Zstd)),
        [0x1f, 0x8b, ..] => Ok(Kind::Tar(tar::Compression::Gzip)),
        _ => Err(io::Error::new(io::ErrorKind::InvalidInput, "is not a folder, zip, tar.zst or tgz")),
    }
}

/// Finds one file.
struct Wanted<'a> {
    path: &'a str,
    found: Option<io::Result<Vec<u8>>>,
}

impl Visitor for Wanted<'_> {
    fn file(&mut self, path: &str, bytes: &mut dyn Read) -> ControlFlow<()> {
        if path != self.path {
            return ControlFlow::Continue(());
        }
        let mut text = Vec::new();
        let read = bytes.take(MOST_TEXT_BYTES + 1).read_to_end(&mut text);
        self.found = Some(match read {
            Ok(count) if count as u64 > MOST_TEXT_BYTES => Err(too_much()),
            read => read.map(|_| text),
        });
        ControlFlow::Break(())
    }

    fn fault(&mut self, _: &str, _: &str) {}
}

/// Passes on what is allowed in a package.
struct Gate<'a> {
    visitor: &'a mut dyn Visitor,
    names: BTreeSet<String>,
}

impl Gate<'_> {
    /// The path of a file or folder, if it is valid; otherwise reports it.
    fn path(&mut self, raw: &[u8]) -> Option<String> {
        let Ok(path) = std::str::from_utf8(raw) else {
            self.fault(&String::from_utf8_lossy(raw), "has a name that is not UTF-8");
            return None;
        };
        let bare = path.strip_suffix('/').unwrap_or(path);
        if let Some(fault) = path_fault(bare) {
            self.fault(path, fault);
            return None;
        }
        Some(bare.to_owned())
    }

    fn file(&mut self, path: String, bytes: &mut dyn Read) -> io::Result<ControlFlow<()>> {
        if self.names.len() >= MOST_FILES {
            return Err(invalid(format!("contains more than {MOST_FILES} files")));
        }
        if self.names.contains(&path) {
            self.fault(&path, "appears twice");
            return Ok(ControlFlow::Continue(()));
        }
        let flow = self.visitor.file(&path, bytes);
        self.names.insert(path);
        Ok(flow)
    }

    fn fault(&mut self, path: &str, what: &str) {
        self.visitor.fault(path, what);
    }
}

/// Fails if there are more bytes than allowed.
struct Limited<R> {
    inner: R,
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(too_much)?;
        Ok(count)
    }
}

fn too_much() -> io::Error {
    invalid("unpacks to an implausible size".to_owned())
}

fn invalid(what: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

//! The formats of archives.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use flate2::write::GzEncoder;
use tar::{Builder, EntryType, Header};
use tempfile::SpooledTempFile;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::Bundle;

/// The file that an archive grows in.
///
/// After its first error it takes whatever comes and fails at the end: a zip that is given up writes its directory all the same, and
/// would print that it cannot.
pub struct Sink {
    file: BufWriter<File>,
    has_failed: bool,
}

impl Sink {
    /// An empty file.
    pub fn new(file: File) -> Self {
        Self { file: BufWriter::new(file), has_failed: false }
    }

    /// Writes what is left.
    pub fn finish(mut self) -> io::Result<()> {
        match self.has_failed {
            true => Err(io::Error::other("an earlier part could not be written")),
            false => self.file.flush(),
        }
    }

    fn note<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        self.has_failed |= result.is_err();
        result
    }
}

impl Write for Sink {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        if self.has_failed {
            return Ok(buffer.len());
        }
        let written = self.file.write(buffer);
        self.note(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.has_failed {
            return Ok(());
        }
        let flushed = self.file.flush();
        self.note(flushed)
    }
}

impl Seek for Sink {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        if self.has_failed {
            return Ok(0);
        }
        let place = self.file.seek(to);
        self.note(place)
    }
}

/// 1980-01-01, the first time that a zip can say, in seconds since 1970: the time of no file.
const TIME_S: u64 = 315_532_800;
/// Beyond level 6 files hardly get smaller: of the meshes of a small cave it leaves 25 % at 30 MB/s, level 9 24 % at 20 MB/s,
/// level 3 28 % at 90 MB/s.
const ZSTD_LEVEL: i32 = 6;
/// A file of a tar up to this size is gathered in memory, a larger one on the disk.
const SPOOL_BYTES: usize = 1 << 22;

/// Puts files into an archive, one after the other.
pub enum Packer {
    /// A zip, which learns the size of a file when it ends.
    Zip(Box<ZipWriter<Sink>>, SimpleFileOptions),
    /// A tar, which must know it before.
    Tar(TarPacker),
}

impl Packer {
    /// Starts an archive.
    pub fn new(kind: Bundle, file: Sink) -> io::Result<Self> {
        Ok(match kind {
            // A zip must know at the start of a file whether it may pass 4 GiB.
            Bundle::Zip => Self::Zip(Box::new(ZipWriter::new(file)), zip_options().large_file(true)),
            Bundle::Mjz => Self::Zip(Box::new(ZipWriter::new(file)), zip_options()),
            Bundle::TarZst => Self::Tar(TarPacker::new(Box::new(zstd::Encoder::new(file, ZSTD_LEVEL)?), "")),
            Bundle::Tgz => Self::Tar(TarPacker::new(
                Box::new(GzEncoder::new(file, flate2::Compression::default())),
                crate::contents::TGZ_ROOT,
            )),
        })
    }

    /// Starts a file; what must be gathered on the disk first is gathered in `folder`.
    pub fn open(&mut self, path: &str, folder: &Path) -> io::Result<Box<dyn Write + '_>> {
        match self {
            Self::Zip(zip, options) => {
                zip.start_file(path, options.compression_method(zip_method(path)))?;
                Ok(Box::new(zip))
            }
            Self::Tar(tar) => Ok(Box::new(tar.open(path, folder))),
        }
    }

    /// Ends the file.
    pub fn close(&mut self) -> io::Result<()> {
        match self {
            Self::Zip(..) => Ok(()),
            Self::Tar(tar) => tar.close(),
        }
    }

    /// Ends the archive.
    pub fn finish(self) -> io::Result<Sink> {
        match self {
            Self::Zip(zip, _) => Ok(zip.finish()?),
            Self::Tar(tar) => tar.builder.into_inner()?.finish(),
        }
    }
}

/// A tar that is being compressed.
pub struct TarPacker {
    builder: Builder<Box<dyn Squeeze>>,
    root: &'static str,
    open: Option<(String, SpooledTempFile)>,
}

impl TarPacker {
    /// Every path is put below `root`.
    fn new(squeeze: Box<dyn Squeeze>, root: &'static str) -> Self {
        Self { builder: Builder::new(squeeze), root, open: None }
    }

    fn open(&mut self, path: &str, folder: &Path) -> &mut SpooledTempFile {
        let file = tempfile::spooled_tempfile_in(SPOOL_BYTES, folder);
        &mut self.open.insert((format!("{}{path}", self.root), file)).1
    }

    fn close(&mut self) -> io::Result<()> {
        let Some((path, mut file)) = self.open.take() else { return Ok(()) };
        let size = file.stream_position()?;
        file.rewind()?;
        let mut header = Header::new_ustar();
        header.set_path(path)?;
        header.set_entry_type(EntryType::Regular);
        header.set_size(size);
        header.set_mode(0o644);
        header.set_mtime(TIME_S);
        header.set_uid(0);
        header.set_gid(0);
        header.set_cksum();
        self.builder.append(&header, file.take(size))
    }
}

/// A compression.
pub trait Squeeze: Write + Send {
    /// Writes what is left.
    fn finish(self: Box<Self>) -> io::Result<Sink>;
}

impl Squeeze for zstd::Encoder<'static, Sink> {
    fn finish(self: Box<Self>) -> io::Result<Sink> {
        (*self).finish()
    }
}

impl Squeeze for GzEncoder<Sink> {
    fn finish(self: Box<Self>) -> io::Result<Sink> {
        (*self).finish()
    }
}

fn zip_options() -> SimpleFileOptions {
    SimpleFileOptions::default().last_modified_time(zip::DateTime::default()).unix_permissions(0o644)
}

/// Images are compressed already.
fn zip_method(path: &str) -> CompressionMethod {
    let is_packed = [".png", ".jpg", ".webp", ".usdz"].iter().any(|extension| path.ends_with(extension));
    if is_packed { CompressionMethod::Stored } else { CompressionMethod::Deflated }
}

//! The formats of archives.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use flate2::write::GzEncoder;
use tar::{Builder, EntryType, Header};
use tempfile::SpooledTempFile;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::Bundle;
use crate::zip_entry;

/// The file that an archive is written to.
///
/// After its first error it silently accepts everything and fails when it is finished: an abandoned zip writer still writes
/// its directory, prints errors of its own, and panics if the position is before what it has written.
pub struct Sink<F = BufWriter<File>> {
    file: F,
    at: u64,
    /// The largest position so far.
    end: u64,
    has_failed: bool,
}

impl Sink {
    /// An empty file.
    pub fn new(file: File) -> Self {
        Self { file: BufWriter::new(file), at: 0, end: 0, has_failed: false }
    }

    /// Writes what is left.
    pub fn finish(mut self) -> io::Result<()> {
        match self.has_failed {
            true => Err(io::Error::other("an earlier part could not be written")),
            false => self.file.flush(),
        }
    }
}

impl<F> Sink<F> {
    fn note<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        self.has_failed |= result.is_err();
        result
    }
}

impl<F: Write> Write for Sink<F> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let written = if self.has_failed { Ok(buffer.len()) } else { self.file.write(buffer) };
        let count = self.note(written)?;
        self.at += count as u64;
        self.end = self.end.max(self.at);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = if self.has_failed { Ok(()) } else { self.file.flush() };
        self.note(flushed)
    }
}

impl<F: Seek> Seek for Sink<F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let sought = match to {
            to if !self.has_failed => self.file.seek(to),
            _ => Ok(self.end),
        };
        self.at = self.note(sought)?;
        Ok(self.at)
    }
}

/// 1980-01-01, the earliest time that a zip can store, in seconds since 1970: the time of all files.
const TIME_S: u64 = 315_532_800;
/// Beyond level 6 files hardly get smaller: the meshes of a small cave are reduced to 25 % at 30 MB/s, by level 9 to 24 % at
/// 20 MB/s, by level 3 to 28 % at 90 MB/s.
const ZSTD_LEVEL: i32 = 6;
/// A file of a tar up to this size is buffered in memory, a larger one on the disk.
const SPOOL_BYTES: usize = 1 << 22;

/// Adds files to an archive, one after the other.
pub enum Packer {
    /// A zip, which needs the size of a file only at its end.
    Zip(Box<ZipWriter<Sink>>, SimpleFileOptions),
    /// A tar, which needs it at the start.
    Tar(TarPacker),
}

impl Packer {
    /// Starts an archive.
    pub fn new(kind: Bundle, file: Sink) -> io::Result<Self> {
        Ok(match kind {
            // A zip must know at the start of a file whether it may exceed 4 GiB.
            Bundle::Zip => Self::Zip(Box::new(ZipWriter::new(file)), zip_entry::options().large_file(true)),
            Bundle::Mjz => Self::Zip(Box::new(ZipWriter::new(file)), zip_entry::options()),
            Bundle::TarZst => Self::Tar(TarPacker::new(Box::new(zstd_encoder(file)?), "")),
            Bundle::Tgz => Self::Tar(TarPacker::new(
                Box::new(GzEncoder::new(file, flate2::Compression::default())),
                crate::contents::TGZ_ROOT,
            )),
        })
    }

    /// Starts a file; a buffer on the disk, if needed, is in `folder`.
    pub fn open(&mut self, path: &str, folder: &Path) -> io::Result<Box<dyn Write + '_>> {
        match self {
            Self::Zip(zip, options) => {
                zip.start_file(path, options.compression_method(zip_method(path))).map_err(plain)?;
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
            Self::Zip(zip, _) => zip.finish().map_err(plain),
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
    /// Prefix of every path.
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

/// The checksum also covers what the manifest does not: headers, and gaps between files.
fn zstd_encoder(file: Sink) -> io::Result<zstd::Encoder<'static, Sink>> {
    let mut encoder = zstd::Encoder::new(file, ZSTD_LEVEL)?;
    encoder.include_checksum(true)?;
    Ok(encoder)
}

/// Images are compressed already.
fn zip_method(path: &str) -> CompressionMethod {
    let is_packed = [".png", ".jpg", ".webp", ".usdz"].iter().any(|extension| path.ends_with(extension));
    if is_packed { CompressionMethod::Stored } else { CompressionMethod::Deflated }
}

/// The error of the system, without wrappers.
fn plain(error: ZipError) -> io::Error {
    match error {
        ZipError::Io(error) => error,
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    /// A disk that is full after some bytes.
    struct Full(Cursor<Vec<u8>>, usize);

    impl Write for Full {
        fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
            if self.0.get_ref().len() + buffer.len() > self.1 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.0.write(buffer)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Full {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }

    #[test]
    fn a_zip_is_abandoned_cleanly_wherever_the_disk_is_full() {
        for room in 0..600 {
            let file = Full(Cursor::new(Vec::new()), room);
            let mut zip = ZipWriter::new(Sink { file, at: 0, end: 0, has_failed: false });
            let written = ["a.png", "b.png", "c.png"].into_iter().try_for_each(|path| {
                zip.start_file(path, zip_entry::options().compression_method(zip_method(path))).map_err(plain)?;
                zip.write_all(&[7; 100])
            });
            let finished = written.and_then(|()| zip.finish().map_err(plain).map(drop));
            let kind = finished.map_err(|error| error.kind());
            assert!(matches!(kind, Ok(()) | Err(io::ErrorKind::StorageFull)), "{room}: {kind:?}");
        }
    }
}

//! Files of a compressed tar.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};

use flate2::bufread::GzDecoder;
use tar::{Archive, EntryType};

use super::{Gate, Limited, TGZ_ROOT, WHOLE};

/// The largest window that Zstandard may ask for: 32 MiB, four times what level 19 uses.
const WINDOW_LOG: u32 = 25;

/// How a tar is compressed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Compression {
    Zstd,
    Gzip,
}

/// Passes on the files. Headers that change the name or size of the next entry are reported instead of read, like links.
pub fn read(file: File, compression: Compression, most_bytes: u64, mut gate: Gate<'_>) -> io::Result<()> {
    let mut archive = Archive::new(Limited { inner: Unpacker::new(file, compression)?, left: most_bytes });
    for entry in archive.entries()?.raw(true) {
        let mut entry = entry?;
        let Some(path) = gate.path(&entry.path_bytes()) else { continue };
        match entry.header().entry_type() {
            EntryType::Directory => {}
            EntryType::Regular => {
                let Some(path) = below_root(&path, compression) else {
                    gate.fault(&path, "is not below `package/`");
                    continue;
                };
                if gate.file(path, &mut entry)?.is_break() {
                    return Ok(());
                }
            }
            EntryType::Symlink | EntryType::Link => gate.fault(&path, "is a link"),
            other => gate.fault(&path, &format!("is not a file or folder but has the tar type {other:?}")),
        }
    }
    let mut rest = archive.into_inner();
    if !is_blank(&mut rest)? || !rest.inner.has_ended()? {
        gate.fault(WHOLE, "has trailing data");
    }
    Ok(())
}

/// Unpacks one frame of Zstandard, or one member of gzip.
enum Unpacker {
    Zstd(zstd::Decoder<'static, BufReader<File>>),
    Gzip(Box<GzDecoder<BufReader<File>>>),
}

impl Unpacker {
    fn new(file: File, compression: Compression) -> io::Result<Self> {
        let file = BufReader::new(file);
        Ok(match compression {
            Compression::Gzip => Self::Gzip(Box::new(GzDecoder::new(file))),
            Compression::Zstd => {
                let mut decoder = zstd::Decoder::with_buffer(file)?.single_frame();
                decoder.window_log_max(WINDOW_LOG)?;
                Self::Zstd(decoder)
            }
        })
    }

    /// Whether the file ends where the unpacked data does.
    fn has_ended(self) -> io::Result<bool> {
        let mut file = match self {
            Self::Zstd(decoder) => decoder.finish(),
            Self::Gzip(decoder) => decoder.into_inner(),
        };
        Ok(file.fill_buf()?.is_empty())
    }
}

impl Read for Unpacker {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Zstd(decoder) => decoder.read(buffer),
            Self::Gzip(decoder) => decoder.read(buffer),
        }
    }
}

fn below_root(path: &str, compression: Compression) -> Option<String> {
    match compression {
        Compression::Zstd => Some(path.to_owned()),
        Compression::Gzip => path.strip_prefix(TGZ_ROOT).map(str::to_owned),
    }
}

/// Whether only zeros are left.
fn is_blank(mut rest: impl Read) -> io::Result<bool> {
    let mut buffer = [0; 1 << 14];
    loop {
        match rest.read(&mut buffer)? {
            0 => return Ok(true),
            count if buffer[..count].iter().any(|&byte| byte != 0) => return Ok(false),
            _ => {}
        }
    }
}

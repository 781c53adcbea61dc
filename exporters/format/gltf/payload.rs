//! The binary data that the JSON refers to, each part padded to four bytes.

use std::fs::File;
use std::io::{self, Read, Write};

use crate::error::{ExportError, at};
use crate::scene::Image;

/// Bytes of a buffer in the order in which they are written.
#[derive(Default)]
pub struct Payload<'a> {
    blocks: Vec<Block<'a>>,
}

enum Block<'a> {
    Bytes(Vec<u8>),
    Image { image: &'a Image, bytes: u64 },
}

impl<'a> Payload<'a> {
    pub(super) fn push_bytes(&mut self, bytes: Vec<u8>) {
        self.blocks.push(Block::Bytes(bytes));
    }

    /// An image of this many bytes.
    pub(super) fn push_image(&mut self, image: &'a Image, bytes: u64) {
        self.blocks.push(Block::Image { image, bytes });
    }

    /// Whether there is nothing to write.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Writes all of it.
    ///
    /// # Errors
    /// Those of `file`, and if an image cannot be read or has changed since planning.
    pub fn write(&self, file: &mut dyn Write) -> Result<(), ExportError> {
        for block in &self.blocks {
            let written = match block {
                Block::Bytes(bytes) => {
                    file.write_all(bytes)?;
                    bytes.len() as u64
                }
                Block::Image { image, bytes } => {
                    write_image(file, image, *bytes)?;
                    *bytes
                }
            };
            file.write_all(&[0; 3][..padding(written) as usize])?;
        }
        Ok(())
    }
}

fn write_image(file: &mut dyn Write, image: &Image, planned: u64) -> Result<(), ExportError> {
    let named = |error| at(image.path.display(), &error);
    let source = File::open(&image.path).map_err(named)?;
    let copied = io::copy(&mut source.take(planned), file)?;
    if copied != planned {
        return Err(named(io::ErrorKind::UnexpectedEof.into()).into());
    }
    Ok(())
}

/// Bytes from `bytes` to the next multiple of four.
pub(super) fn padding(bytes: u64) -> u64 {
    bytes.next_multiple_of(4) - bytes
}

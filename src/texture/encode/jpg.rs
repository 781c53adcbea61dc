//! Writes a JPG row by row.
//!
//! `jpeg-encoder` asks for rows instead of taking them, so it runs on a thread of its own and waits for them there.

use std::cell::RefCell;
use std::io::{self, ErrorKind};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};

use jpeg_encoder::{Encoder, EncodingError, ImageBuffer, JpegColorType, SamplingFactor, rgb_to_ycbcr};

use super::{Channels, Spill};

/// Colours differ by less than what can be seen side by side; see docs/decisions/0036-image-formats.md.
const QUALITY: u8 = 95;
/// Rows that may wait for the encoder.
const ROWS_WAITING: usize = 64;

/// A JPG being encoded.
pub struct JpgStream {
    rows: SyncSender<Vec<u8>>,
    encoder: JoinHandle<Result<(), EncodingError>>,
    /// The beginning of the next row.
    row: Vec<u8>,
    row_bytes: usize,
    missing_rows: u32,
}

impl JpgStream {
    /// Starts an image of `size_px` pixels a side, 8 bits a channel.
    ///
    /// # Errors
    /// If the system starts no thread.
    pub fn new(spill: Spill, channels: Channels, size_px: u32) -> io::Result<Self> {
        let (rows, waiting) = sync_channel(ROWS_WAITING);
        let source = Rows { waiting, channels, size_px: size_px as u16, last: RefCell::default() };
        let encode = move || {
            let mut encoder = Encoder::new(spill, QUALITY);
            encoder.set_sampling_factor(SamplingFactor::F_1_1);
            encoder.encode_image(source)
        };
        let encoder = Builder::new().name("jpg".to_owned()).spawn(encode)?;
        let row_bytes = size_px as usize * channels.bytes();
        Ok(Self { rows, encoder, row: Vec::new(), row_bytes, missing_rows: size_px })
    }

    /// Adds pixels.
    ///
    /// # Errors
    /// If the encoder has failed, or has all pixels already.
    pub fn write(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            let (begin, rest) = bytes.split_at(bytes.len().min(self.row_bytes - self.row.len()));
            self.row.extend_from_slice(begin);
            bytes = rest;
            if self.row.len() == self.row_bytes {
                self.rows.send(std::mem::take(&mut self.row)).map_err(io::Error::other)?;
                self.missing_rows = self.missing_rows.saturating_sub(1);
            }
        }
        Ok(())
    }

    /// Waits for the end of the image.
    ///
    /// # Errors
    /// If the encoder has failed, or pixels are missing.
    pub fn finish(self) -> io::Result<()> {
        drop(self.rows);
        let encoded = self.encoder.join().map_err(|_| io::Error::other("the JPEG encoder panicked"))?;
        encoded.map_err(io::Error::other)?;
        if self.missing_rows > 0 { Err(ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
    }
}

/// The rows of an image in the order in which they arrive.
struct Rows {
    waiting: Receiver<Vec<u8>>,
    channels: Channels,
    size_px: u16,
    /// The number of rows so far, and the last of them, of which the encoder asks again to fill its last blocks.
    last: RefCell<(u16, Vec<u8>)>,
}

impl ImageBuffer for Rows {
    fn get_jpeg_color_type(&self) -> JpegColorType {
        if self.channels == Channels::Grey { JpegColorType::Luma } else { JpegColorType::Ycbcr }
    }

    fn width(&self) -> u16 {
        self.size_px
    }

    fn height(&self) -> u16 {
        self.size_px
    }

    /// Rows that never arrive are black; their writer knows.
    fn fill_buffers(&self, y: u16, buffers: &mut [Vec<u8>; 4]) {
        let mut last = self.last.borrow_mut();
        if y == last.0 {
            let black = || vec![0; usize::from(self.size_px) * self.channels.bytes()];
            *last = (y + 1, self.waiting.recv().unwrap_or_else(|_| black()));
        }
        if self.channels == Channels::Grey {
            buffers[0].extend_from_slice(&last.1);
            return;
        }
        for &[red, green, blue] in last.1.as_chunks::<3>().0 {
            let (luma, blueness, redness) = rgb_to_ycbcr(red, green, blue);
            buffers[0].push(luma);
            buffers[1].push(blueness);
            buffers[2].push(redness);
        }
    }
}

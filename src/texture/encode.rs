//! Writes a map row by row.

use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use image_webp::{ColorType as WebpColor, WebPEncoder};
use png::{BitDepth, Compression, Encoder as PngEncoder, Filter, SrgbRenderingIntent, StreamWriter};

use plume_exporters::ImageFormat;

use self::jpg::JpgStream;

mod jpg;

/// Bytes of compressed data per PNG chunk.
const PNG_CHUNK: usize = 1 << 16;

/// The meaning of the channels of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Colour, already in sRGB.
    Srgb,
    /// Three linear quantities.
    LinearRgb,
    /// One linear quantity.
    Grey,
    /// One linear quantity of 16 bits, big-endian. Only PNG supports it.
    Grey16,
}

impl Channels {
    /// Bytes per pixel.
    pub fn bytes(self) -> usize {
        match self {
            Self::Srgb | Self::LinearRgb => 3,
            Self::Grey => 1,
            Self::Grey16 => 2,
        }
    }
}

/// A square map being written, top row first. The bytes depend only on the pixels, not on how they are passed.
///
/// PNG and JPG stream; WebP keeps the pixels until [`MapWriter::finish`].
pub struct MapWriter<W: Write>(Inner<W>);

enum Inner<W: Write> {
    Png { sink: W, stream: Box<StreamWriter<'static, Spill>>, spill: Spill },
    Jpg { sink: W, stream: JpgStream, spill: Spill },
    WebP { sink: W, picture: Picture },
}

impl<W: Write> MapWriter<W> {
    /// Starts a map of `size_px` (at most [`super::settings::MAX_SIZE_PX`]) pixels a side.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn new(sink: W, channels: Channels, size_px: u32, format: ImageFormat) -> io::Result<Self> {
        let inner = match format {
            ImageFormat::Png => {
                let spill = Spill::default();
                let stream = Box::new(png_stream(spill.clone(), channels, size_px)?);
                Inner::Png { sink, stream, spill }
            }
            ImageFormat::Jpeg => {
                let spill = Spill::default();
                Inner::Jpg { sink, stream: JpgStream::new(spill.clone(), channels, size_px)?, spill }
            }
            ImageFormat::WebP => Inner::WebP { sink, picture: Picture::new(channels, size_px) },
        };
        Ok(Self(inner))
    }

    /// Adds pixels.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match &mut self.0 {
            Inner::Png { sink, stream, spill } => {
                stream.write_all(bytes)?;
                spill.pour(sink)
            }
            Inner::Jpg { sink, stream, spill } => {
                stream.write(bytes)?;
                spill.pour(sink)
            }
            Inner::WebP { picture, .. } => {
                picture.pixels.extend_from_slice(bytes);
                Ok(())
            }
        }
    }

    /// Finishes the map; all pixels must have been written.
    ///
    /// # Errors
    /// If the sink fails or pixels are missing.
    pub fn finish(self) -> io::Result<()> {
        match self.0 {
            Inner::Png { mut sink, stream, spill } => {
                stream.finish()?;
                spill.pour(&mut sink)
            }
            Inner::Jpg { mut sink, stream, spill } => {
                stream.finish()?;
                spill.pour(&mut sink)
            }
            Inner::WebP { sink, picture } => encode_webp(sink, picture),
        }
    }
}

/// The pixels of a map of 8 bits a channel.
struct Picture {
    pixels: Vec<u8>,
    channels: Channels,
    size_px: u32,
}

impl Picture {
    fn new(channels: Channels, size_px: u32) -> Self {
        let pixels = Vec::with_capacity(size_px as usize * size_px as usize * channels.bytes());
        Self { pixels, channels, size_px }
    }
}

fn encode_webp<W: Write>(sink: W, Picture { pixels, channels, size_px }: Picture) -> io::Result<()> {
    if pixels.len() != size_px as usize * size_px as usize * channels.bytes() {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    let color = if channels == Channels::Grey { WebpColor::L8 } else { WebpColor::Rgb8 };
    WebPEncoder::new(sink).encode(&pixels, size_px, size_px, color).map_err(io::Error::other)
}

/// A buffer of compressed bytes for a sink: the stream of `png` and the thread of a JPG require a `'static` writer.
#[derive(Clone, Default)]
struct Spill(Arc<Mutex<Vec<u8>>>);

impl Spill {
    fn pour(&self, sink: &mut impl Write) -> io::Result<()> {
        let mut bytes = self.0.lock().expect("no writer panics while it holds the bytes");
        sink.write_all(&bytes)?;
        bytes.clear();
        Ok(())
    }
}

impl Write for Spill {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("no writer panics while it holds the bytes").extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn png_stream(spill: Spill, channels: Channels, size_px: u32) -> io::Result<StreamWriter<'static, Spill>> {
    let mut encoder = PngEncoder::new(spill, size_px, size_px);
    let (color, depth) = match channels {
        Channels::Srgb | Channels::LinearRgb => (png::ColorType::Rgb, BitDepth::Eight),
        Channels::Grey => (png::ColorType::Grayscale, BitDepth::Eight),
        Channels::Grey16 => (png::ColorType::Grayscale, BitDepth::Sixteen),
    };
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Paeth);
    if channels == Channels::Srgb {
        // Some readers (MuJoCo) take the colour space from here.
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    Ok(encoder.write_header()?.into_stream_writer_with_size(PNG_CHUNK)?)
}

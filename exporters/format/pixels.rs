//! Rearranges the channels of images, or makes them smaller, and writes them as PNG; samples colours of images.
//!
//! Compressed fast and with one filter, as the images of a scene are. Memory: one image. The pixels of a JPEG are the same on
//! every machine, although its decoder (`zune-jpeg`) has one routine for AVX2, one for NEON and one for the rest: all
//! calculate with the same integers, and images of a scene have no subsampled colours, which would have to be interpolated.

use std::fs::File;
use std::io::{self, BufReader, Write};

use image::{ImageError, ImageReader, RgbImage, imageops};
use png::{BitDepth, ColorType, Compression, Encoder, Filter};

use crate::error::{ExportError, at};
use crate::scene::Image;

/// Bytes of compressed data per PNG chunk.
const PNG_CHUNK: usize = 1 << 16;

/// Writes `image` as an 8-bit PNG, applying `map` to the red, green and blue of each pixel: `N` is 1 for grey, 3 for RGB, 4
/// for RGBA. Grey images have three equal channels.
///
/// # Errors
/// If the image cannot be read, with its path, and those of `out`.
pub fn remap<const N: usize>(
    image: &Image,
    out: &mut dyn Write,
    map: impl Fn([u8; 3]) -> [u8; N],
) -> Result<(), ExportError> {
    encode(&read(image)?, out, map)
}

fn encode<const N: usize>(
    pixels: &RgbImage,
    out: &mut dyn Write,
    map: impl Fn([u8; 3]) -> [u8; N],
) -> Result<(), ExportError> {
    let color = const {
        match N {
            1 => ColorType::Grayscale,
            3 => ColorType::Rgb,
            4 => ColorType::Rgba,
            _ => panic!("a PNG has 1, 3 or 4 channels here"),
        }
    };
    let mut encoder = Encoder::new(out, pixels.width(), pixels.height());
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Paeth);
    let mut writer = encoder.write_header().map_err(io::Error::from)?;
    let mut stream = writer.stream_writer_with_size(PNG_CHUNK).map_err(io::Error::from)?;
    for row in pixels.rows() {
        let row: Vec<u8> = row.flat_map(|pixel| map(pixel.0)).collect();
        stream.write_all(&row)?;
    }
    stream.finish().map_err(io::Error::from)?;
    Ok(writer.finish().map_err(io::Error::from)?)
}

/// An image that is made smaller step by step.
pub struct Pyramid(RgbImage);

impl Pyramid {
    /// Reads the image.
    ///
    /// # Errors
    /// If it cannot be read, with its path.
    pub fn open(image: &Image) -> Result<Self, ExportError> {
        read(image).map(Self)
    }

    /// Half its width and height, rounded down, each pixel the mean of those that it covers.
    pub fn halve(&mut self) {
        let [width, height] = [self.0.width(), self.0.height()].map(|side| (side / 2).max(1));
        self.0 = imageops::thumbnail(&self.0, width, height);
    }

    /// Writes it as an 8-bit PNG.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        encode(&self.0, out, |pixel| pixel)
    }
}

/// Colours of an image at texture coordinates, with bilinear filtering.
pub struct Sampler(RgbImage);

impl Sampler {
    /// Reads the image.
    ///
    /// # Errors
    /// If it cannot be read, with its path.
    pub fn open(image: &Image) -> Result<Self, ExportError> {
        read(image).map(Self)
    }

    /// The bilinear mean of the four nearest pixels at `uv` from the lower left; the image repeats.
    pub fn at(&self, [u, v]: [f32; 2]) -> [u8; 3] {
        let (x, y) = (Between::new(u, self.0.width()), Between::new(1.0 - v, self.0.height()));
        let mut sum = [0.0; 3];
        for ((column, row), share) in
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| ((x.pixels[i], y.pixels[j]), x.shares[i] * y.shares[j]))
        {
            let pixel = self.0.get_pixel(column, row).0;
            sum = [0, 1, 2].map(|channel| sum[channel] + share * f32::from(pixel[channel]));
        }
        sum.map(|channel| (channel + 0.5) as u8)
    }
}

/// A position between the centres of two neighbouring pixels of a row or a column.
struct Between {
    pixels: [u32; 2],
    shares: [f32; 2],
}

impl Between {
    fn new(coordinate: f32, size: u32) -> Self {
        let place = (coordinate - coordinate.floor()) * size as f32 - 0.5;
        let first = place.floor();
        let pixels = [0, 1].map(|step| (first as i32 + step).rem_euclid(size as i32) as u32);
        Self { pixels, shares: [1.0 - (place - first), place - first] }
    }
}

/// Width and height in pixels.
///
/// # Errors
/// When the image cannot be read, with its path.
pub fn size(image: &Image) -> Result<[u32; 2], ExportError> {
    with(image, |reader| reader.into_dimensions()).map(<[u32; 2]>::from)
}

fn read(image: &Image) -> Result<RgbImage, ExportError> {
    with(image, |reader| Ok(reader.decode()?.into_rgb8()))
}

/// Images of a scene may exceed the default limits of the decoder.
fn with<T>(
    image: &Image,
    read: impl FnOnce(ImageReader<BufReader<File>>) -> Result<T, ImageError>,
) -> Result<T, ExportError> {
    let open = || {
        let mut reader = ImageReader::open(&image.path)?.with_guessed_format()?;
        reader.no_limits();
        read(reader).map_err(plain)
    };
    Ok(open().map_err(|error| at(image.path.display(), &error))?)
}

/// The underlying I/O error, if there is one.
fn plain(error: ImageError) -> io::Error {
    match error {
        ImageError::IoError(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidData, other),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use image::DynamicImage;

    use super::*;
    use crate::image_format::ImageFormat;
    use plume_disk::sealed::hex;
    use sha2::{Digest, Sha256};

    /// 3 × 2 pixels, no two channels alike.
    fn sample() -> RgbImage {
        RgbImage::from_fn(3, 2, |x, y| image::Rgb([x as u8 * 50, y as u8 * 90 + 7, 255 - x as u8]))
    }

    fn on_disk(folder: &Path, image: DynamicImage, format: ImageFormat) -> Image {
        let path = folder.join(format!("image.{}", format.extension()));
        image.save(&path).unwrap();
        Image { path, format }
    }

    fn remapped<const N: usize>(image: &Image, map: impl Fn([u8; 3]) -> [u8; N]) -> DynamicImage {
        let mut bytes = Vec::new();
        remap(image, &mut bytes, map).unwrap();
        assert_eq!(image::guess_format(&bytes).unwrap(), image::ImageFormat::Png);
        image::load_from_memory(&bytes).unwrap()
    }

    #[test]
    fn every_pixel_is_mapped() {
        let folder = tempfile::tempdir().unwrap();
        let image = on_disk(folder.path(), sample().into(), ImageFormat::Png);
        let rgb = remapped(&image, |[r, g, b]| [b, 255 - g, r]);
        let rgba = remapped(&image, |[r, g, b]| [r, g, b, r ^ g]);
        let grey = remapped(&image, |[_, g, _]| [g]);
        for (x, y, &image::Rgb([r, g, b])) in sample().enumerate_pixels() {
            assert_eq!(rgb.as_rgb8().unwrap().get_pixel(x, y).0, [b, 255 - g, r]);
            assert_eq!(rgba.as_rgba8().unwrap().get_pixel(x, y).0, [r, g, b, r ^ g]);
            assert_eq!(grey.as_luma8().unwrap().get_pixel(x, y).0, [g]);
        }
    }

    #[test]
    fn grey_and_jpeg_images_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let grey = DynamicImage::from(sample()).into_luma8();
        let image = on_disk(folder.path(), grey.clone().into(), ImageFormat::Png);
        for (x, y, pixel) in remapped(&image, |pixel| pixel).to_rgb8().enumerate_pixels() {
            assert_eq!(pixel.0, [grey.get_pixel(x, y).0[0]; 3]);
        }
        let image = on_disk(folder.path(), RgbImage::from_pixel(8, 8, image::Rgb([200; 3])).into(), ImageFormat::Jpeg);
        let inverted = remapped(&image, |pixel| pixel.map(|channel| 255 - channel)).to_rgb8();
        assert!(inverted.pixels().flat_map(|pixel| pixel.0).all(|channel| channel.abs_diff(55) <= 1));
    }

    /// The hash is that of the scalar routines, so a machine whose decoder rounds differently fails here.
    #[test]
    fn pixels_of_a_jpeg_are_the_same_on_every_machine() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/data/rock.jpg");
        let pixels = read(&Image { path, format: ImageFormat::Jpeg }).unwrap();
        assert_eq!(pixels.dimensions(), (100, 100));
        assert_eq!(
            hex(&Sha256::digest(pixels.as_raw())),
            "f877d92eee12623c37eb789f3e92f266dc891160d54702a75470b29c29c5ed74"
        );
    }

    #[test]
    fn colours_blend_between_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let sampler = Sampler::open(&on_disk(folder.path(), sample().into(), ImageFormat::Png)).unwrap();
        for (x, y, pixel) in sample().enumerate_pixels() {
            let middle = [(x as f32 + 0.5) / 3.0, 1.0 - (y as f32 + 0.5) / 2.0];
            assert_eq!(sampler.at(middle), pixel.0);
            assert_eq!(sampler.at([middle[0] + 2.0, middle[1] - 1.0]), pixel.0);
        }
        assert_eq!(sampler.at([1.0 / 3.0, 0.75]), [25, 7, 255], "half-way from the first to the second");
        assert_eq!(sampler.at([0.0, 0.25]), [50, 97, 254], "half-way from the last back to the first");
    }

    #[test]
    fn a_halved_image_has_the_means_of_its_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let mut pyramid = Pyramid::open(&on_disk(folder.path(), sample().into(), ImageFormat::Png)).unwrap();
        pyramid.halve();
        let mut bytes = Vec::new();
        pyramid.write(&mut bytes).unwrap();
        let half = image::load_from_memory(&bytes).unwrap().into_rgb8();
        assert_eq!(half.dimensions(), (1, 1));
        let mean = |channel: fn(u32, u32) -> u32| {
            (0..2).flat_map(|y| (0..3).map(move |x| channel(x, y))).sum::<u32>().div_ceil(6) as u8
        };
        assert_eq!(half.get_pixel(0, 0).0, [mean(|x, _| x * 50), mean(|_, y| y * 90 + 7), mean(|x, _| 255 - x)]);
        pyramid.halve();
        assert_eq!(pyramid.0.dimensions(), (1, 1), "no image has no pixels");
    }

    #[test]
    fn a_broken_image_is_reported_with_its_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rock.png");
        std::fs::write(&path, "no image").unwrap();
        let error = remap(&Image { path, format: ImageFormat::Png }, &mut Vec::new(), |pixel| pixel).unwrap_err();
        assert!(error.to_string().contains("rock.png"), "{error}");
    }
}

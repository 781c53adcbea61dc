//! Images of the user, on models or on rock: read, made smaller, and filtered as wide as they are looked at.
//!
//! Not promised: the same bytes on another processor for JPEG, whose decoder may round otherwise there.

use std::io::Cursor;

use image::{ColorType, DynamicImage, ImageError, ImageFormat, ImageReader, Limits, guess_format};
use plume_graph::echo::sentence;

use crate::srgb::linear;

/// Longest side of an image that is read, in pixels.
const MOST_PX: u32 = 8192;
/// Longest side that is kept, in pixels. Tuned: things have fewer texels along their whole length, and so have the tiles of rock.
const KEPT_PX: usize = 2048;

/// An image in linear numbers, at every level down to one pixel.
#[derive(Debug)]
pub struct Image {
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    size: [usize; 2],
    pixels: Vec<[f32; 3]>,
}

/// How an image continues beyond a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// It repeats.
    Repeat,
    /// Every other time mirrored.
    Mirror,
    /// By its outermost pixels.
    Clamp,
}

/// What a tile shows, and how its file has to hold it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tile {
    /// Colours in sRGB.
    Colors,
    /// Vectors, a component in each colour.
    Vectors,
    /// Numbers, as greys or in the red of colours.
    Numbers,
}

impl Image {
    /// Reads a PNG, JPEG or WebP file of colours.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        Ok(Self::of(decoded(bytes)?, srgb))
    }

    /// Reads a square PNG file that is to be repeated.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read_tile(bytes: &[u8], tile: Tile) -> Result<Self, String> {
        if guess_format(bytes).ok() != Some(ImageFormat::Png) {
            return Err("is not a PNG file".to_owned());
        }
        let image = decoded(bytes)?;
        let [width, height] = [image.width(), image.height()];
        if width != height {
            return Err(format!("is not square, but {width} x {height} pixels"));
        }
        match (image.color(), tile) {
            (ColorType::Rgb8 | ColorType::Rgb16, _) | (ColorType::L8 | ColorType::L16, Tile::Numbers) => {}
            (ColorType::L8 | ColorType::L16, _) => return Err("is grey instead of RGB".to_owned()),
            _ => return Err("has transparency".to_owned()),
        }
        Ok(Self::of(image, if tile == Tile::Colors { srgb } else { share }))
    }

    /// An image whose codes mean what `value` says.
    fn of(image: DynamicImage, value: fn(u8) -> f32) -> Self {
        let size = [image.width(), image.height()].map(|side| side as usize);
        Self::of_codes(size, image.into_rgb8().as_raw(), value)
    }

    fn of_codes(size: [usize; 2], codes: &[u8], value: fn(u8) -> f32) -> Self {
        let table: Vec<f32> = (0..=u8::MAX).map(value).collect();
        let (pixels, _) = codes.as_chunks::<3>();
        let pixels = pixels.iter().map(|codes| codes.map(|code| table[usize::from(code)])).collect();
        let mut level = Level { size, pixels };
        while level.size.iter().any(|side| *side > KEPT_PX) {
            level = level.halved();
        }
        let mut levels = vec![level];
        while let Some(last) = levels.last().filter(|last| last.size != [1, 1]) {
            levels.push(last.halved());
        }
        Self { levels }
    }

    /// The mean around texture coordinates, v downwards; `width` is that of the area which is looked at, in texture coordinates.
    pub fn color(&self, uv: [f32; 2], wrap: [Wrap; 2], width: f32) -> [f32; 3] {
        let across = width * self.levels[0].size[0].max(self.levels[0].size[1]) as f32;
        let coarser = libm::log2f(across.max(1.0)).round() as usize;
        self.levels[coarser.min(self.levels.len() - 1)].color(uv, wrap)
    }
}

/// The pixels of a file, in bounded memory.
fn decoded(bytes: &[u8]) -> Result<DynamicImage, String> {
    let unread = |error: String| format!("cannot be read: {}", sentence(&error));
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| unread(error.to_string()))?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MOST_PX), Some(MOST_PX));
    reader.limits(limits);
    let image = reader.decode().map_err(|error| match error {
        ImageError::Limits(_) => format!("is too large: more than {MOST_PX} pixels a side"),
        other => unread(other.to_string()),
    })?;
    if image.width() == 0 || image.height() == 0 { Err(unread("it is empty".to_owned())) } else { Ok(image) }
}

/// The linear light of an sRGB code.
fn srgb(code: u8) -> f32 {
    linear(f64::from(code) / 255.0) as f32
}

/// A code as a share of the largest.
fn share(code: u8) -> f32 {
    f32::from(code) / 255.0
}

impl Level {
    /// Half as large: means of up to four pixels.
    fn halved(&self) -> Self {
        let size = self.size.map(|side| side.div_ceil(2));
        let pixel = |n: usize| {
            let [x, y] = [n % size[0], n / size[0]].map(|c| 2 * c);
            let four = [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(|at| self.at(at));
            [0, 1, 2].map(|channel| four.iter().map(|color| color[channel]).sum::<f32>() / 4.0)
        };
        Self { size, pixels: (0..size[0] * size[1]).map(pixel).collect() }
    }

    /// The pixel at a place, or the nearest.
    fn at(&self, [x, y]: [usize; 2]) -> [f32; 3] {
        self.pixels[y.min(self.size[1] - 1) * self.size[0] + x.min(self.size[0] - 1)]
    }

    /// Bilinear.
    fn color(&self, uv: [f32; 2], wrap: [Wrap; 2]) -> [f32; 3] {
        let along = |axis: usize| {
            let at = f64::from(uv[axis]) * self.size[axis] as f64 - 0.5;
            let first = at.floor();
            let place = |at: f64| wrap[axis].place(at, self.size[axis]);
            ([place(first), place(first + 1.0)], (at - first) as f32)
        };
        let ([left, right], x) = along(0);
        let ([top, bottom], y) = along(1);
        let corners = [[left, top], [right, top], [left, bottom], [right, bottom]].map(|at| self.at(at));
        [0, 1, 2].map(|channel| {
            let [a, b, c, d] = corners.map(|color| color[channel]);
            let (above, below) = (a + (b - a) * x, c + (d - c) * x);
            above + (below - above) * y
        })
    }
}

impl Wrap {
    /// The pixel of a row of so many at a whole number, which may be beyond its ends.
    fn place(self, at: f64, pixels: usize) -> usize {
        let count = pixels as f64;
        let place = match self {
            Self::Repeat => at.rem_euclid(count),
            Self::Mirror => {
                let twice = at.rem_euclid(2.0 * count);
                if twice < count { twice } else { 2.0 * count - 1.0 - twice }
            }
            Self::Clamp => at.clamp(0.0, count - 1.0),
        };
        place as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_continue_beyond_their_sides() {
        let places = |wrap: Wrap| [-3.0, -1.0, 0.0, 2.0, 3.0, 4.0].map(|at| wrap.place(at, 3));
        assert_eq!(places(Wrap::Repeat), [0, 2, 0, 2, 0, 1]);
        assert_eq!(places(Wrap::Mirror), [2, 0, 0, 2, 2, 1]);
        assert_eq!(places(Wrap::Clamp), [0, 0, 0, 2, 2, 2]);
    }

    #[test]
    fn wide_looks_see_means() {
        let image = Image::of_codes([2, 2], &[[255; 3], [0; 3], [0; 3], [255; 3]].concat(), srgb);
        assert_eq!(image.color([0.25, 0.25], [Wrap::Clamp; 2], 0.0), [1.0; 3]);
        assert_eq!(image.color([0.25, 0.25], [Wrap::Clamp; 2], 1.0), [0.5; 3]);
    }

    /// A PNG file of one value.
    fn png(size: [u32; 2], color: ColorType) -> Vec<u8> {
        let bytes = vec![128; (size[0] * size[1]) as usize * usize::from(color.bytes_per_pixel())];
        let mut file = Cursor::new(Vec::new());
        image::write_buffer_with_format(&mut file, &bytes, size[0], size[1], color, ImageFormat::Png).unwrap();
        file.into_inner()
    }

    #[test]
    fn tiles_hold_what_they_show() {
        let seen = |tile: Tile, color: ColorType| {
            Image::read_tile(&png([2, 2], color), tile).map(|image| image.color([0.3; 2], [Wrap::Repeat; 2], 0.1)[0])
        };
        assert_eq!(seen(Tile::Colors, ColorType::Rgb8), Ok(srgb(128)));
        assert_eq!(seen(Tile::Vectors, ColorType::Rgb16), Ok(128.0 / 255.0));
        assert_eq!(seen(Tile::Numbers, ColorType::L8), Ok(128.0 / 255.0));
        assert_eq!(seen(Tile::Colors, ColorType::L8), Err("is grey instead of RGB".to_owned()));
        assert_eq!(seen(Tile::Numbers, ColorType::Rgba8), Err("has transparency".to_owned()));
        let fault = |bytes: &[u8]| Image::read_tile(bytes, Tile::Colors).unwrap_err();
        assert_eq!(fault(&png([4, 2], ColorType::Rgb8)), "is not square, but 4 x 2 pixels");
        assert_eq!(fault(b"a text"), "is not a PNG file");
        assert_eq!(fault(&png([8193, 1], ColorType::L8)), "is too large: more than 8192 pixels a side");
        let whole = png([64, 64], ColorType::Rgb8);
        assert!(fault(&whole[..whole.len() / 2]).starts_with("cannot be read: "));
    }
}

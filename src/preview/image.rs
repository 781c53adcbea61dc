//! Images and their encoding.

use std::io;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use super::Size;

/// An image of 8-bit sRGB, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Its size.
    pub size: Size,
    /// Three bytes per pixel.
    pub rgb: Vec<u8>,
}

impl Image {
    /// Rasterises an SVG of ours.
    pub fn of_svg(svg: &str, size: Size) -> Self {
        let tree = Tree::from_str(svg, &Options::default()).expect("the drawing is an SVG");
        let mut pixels = Pixmap::new(size.width, size.height).expect("a size is never zero");
        resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
        let rgb = pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
        Self { size, rgb }
    }

    /// As PNG.
    pub fn png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes).expect("memory takes all");
        bytes
    }

    fn write_png(&self, bytes: &mut Vec<u8>) -> Result<(), png::EncodingError> {
        let mut writer = encoder(bytes, self.size).write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()
    }
}

/// An encoder of sRGB.
pub fn encoder<W: io::Write>(to: W, size: Size) -> png::Encoder<'static, W> {
    let mut encoder = png::Encoder::new(to, size.width, size.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder
}

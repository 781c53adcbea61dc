//! What a camera records for every pixel, and its PNG.

use std::io;

use nalgebra::Isometry3;
use png::{BitDepth, ColorType, Compression, Encoder};

use crate::rig::Output;

/// What a camera records at a moment.
pub struct Frame {
    /// Number of the camera.
    pub camera: usize,
    /// Number of the frame.
    pub number: u64,
    /// When.
    pub time_ns: i64,
    /// From its optical frame to the scene.
    pub scene_from_optical: Isometry3<f64>,
    /// What it records.
    pub pictures: Vec<Picture>,
}

/// An output for every pixel.
pub struct Picture {
    /// What it is.
    pub output: Output,
    /// Width and height.
    pub size: [u32; 2],
    /// Rows from above.
    pub pixels: Pixels,
}

/// Values of pixels.
pub enum Pixels {
    /// sRGB.
    Color(Vec<[u8; 3]>),
    /// Metres; 0 where nothing is.
    Metres(Vec<f32>),
    /// Unit vectors in the optical frame; zero where nothing is.
    Normals(Vec<[f32; 3]>),
    /// Labels.
    Labels(Vec<u8>),
    /// Numbers of things.
    Things(Vec<u16>),
    /// Pixels to the right and down.
    Flow(Vec<Option<[f32; 2]>>),
}

impl Output {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Image => "image",
            Self::Depth => "depth",
            Self::ExactDepth => "exact_depth",
            Self::Normal => "normal",
            Self::Label => "label",
            Self::Instance => "instance",
            Self::Flow => "flow",
        }
    }
}

impl Picture {
    /// As a PNG: colours, labels with 8 bits, others with 16. Depth is in units of `1 / units_per_m`, and 0 where it has none or more
    /// than fit. Normals are `32767.5 · (n + 1)`. Flow is as in KITTI's: red and green are `32768 + 64 · pixels`, blue is 1 where
    /// there is one.
    ///
    /// # Errors
    /// Not in memory.
    pub fn png(&self, units_per_m: f32) -> io::Result<Vec<u8>> {
        let deep = |values: &mut dyn Iterator<Item = u16>| values.flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
        let (color, depth, bytes) = match &self.pixels {
            Pixels::Color(pixels) => (ColorType::Rgb, BitDepth::Eight, pixels.as_flattened().to_vec()),
            Pixels::Labels(pixels) => (ColorType::Grayscale, BitDepth::Eight, pixels.clone()),
            Pixels::Things(pixels) => (ColorType::Grayscale, BitDepth::Sixteen, deep(&mut pixels.iter().copied())),
            Pixels::Metres(pixels) => {
                let units = |metres: &f32| within(metres * units_per_m).unwrap_or(0);
                (ColorType::Grayscale, BitDepth::Sixteen, deep(&mut pixels.iter().map(units)))
            }
            Pixels::Normals(pixels) => {
                let part = |part: &f32| within((part + 1.0) * 32767.5).unwrap_or(0);
                (ColorType::Rgb, BitDepth::Sixteen, deep(&mut pixels.as_flattened().iter().map(part)))
            }
            Pixels::Flow(pixels) => (ColorType::Rgb, BitDepth::Sixteen, deep(&mut pixels.iter().flat_map(flow))),
        };
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, self.size[0], self.size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.set_compression(Compression::Fast);
        let mut writer = encoder.write_header().map_err(io::Error::from)?;
        writer.write_image_data(&bytes).map_err(io::Error::from)?;
        writer.finish().map_err(io::Error::from)?;
        Ok(file)
    }
}

/// The nearest whole number, if 16 bits hold it.
fn within(value: f32) -> Option<u16> {
    let rounded = value.round();
    (0.0..=f32::from(u16::MAX)).contains(&rounded).then_some(rounded as u16)
}

fn flow(moved: &Option<[f32; 2]>) -> [u16; 3] {
    let told =
        moved.and_then(|[right, down]| Some([within(32768.0 + 64.0 * right)?, within(32768.0 + 64.0 * down)?, 1]));
    told.unwrap_or_default()
}

//! Samples the surface once per texel and writes the maps.
//!
//! The atlas is baked in strips of rows, several in parallel, which are passed to the encoders before the next ones begin:
//! memory is bounded by the width of the atlas, not its area.

use std::io::{self, Write};

use rayon::prelude::*;

use super::encode::{Channels, MapWriter};
use super::owners::{NONE, Strips};
use super::patch::{Frame, Patch};
use super::srgb::SrgbTable;
use super::{HEIGHT_AMPLITUDE_M, Maps, Textured};
use crate::field::{Aabb, Surface, Texel};
use plume_exporters::ImageFormat;

/// Size of the squares of texels that are sampled together, so that nearby passages are searched once; also the rows of a
/// strip. Tuned.
const TILE_PX: u32 = 32;
/// Strips in flight. A constant, so that memory does not depend on the machine.
const STRIPS_AT_ONCE: u32 = 16;

/// Bakes `surface` onto `textured` and writes the maps to `sinks`.
///
/// Texels within two texels of a chart extend its rim along the plane of the nearest triangle; the others repeat the nearest
/// texel of their row, so that no mip level mixes in a background.
///
/// # Errors
/// If a sink fails.
pub fn bake<W: Write + Send>(
    textured: &Textured,
    surface: &dyn Surface,
    format: ImageFormat,
    sinks: Maps<W>,
) -> io::Result<()> {
    let strips = Strips::new(textured, TILE_PX);
    let wants_height = sinks.height.is_some();
    let baker = Baker { textured, surface, strips: &strips, srgb: SrgbTable::new(), wants_height };
    let mut writers = Writers::new(sinks, textured.size_px, format)?;
    let top_down: Vec<u32> = (0..strips.count()).rev().collect();
    for batch in top_down.chunks(STRIPS_AT_ONCE as usize) {
        let baked: Vec<Maps<Vec<u8>>> = batch.par_iter().map(|&strip| baker.strip(strip)).collect();
        writers.write(&baked)?;
    }
    writers.finish()
}

struct Baker<'a> {
    textured: &'a Textured,
    surface: &'a dyn Surface,
    strips: &'a Strips,
    srgb: SrgbTable,
    wants_height: bool,
}

impl Baker<'_> {
    /// The pixels of a strip, top row first.
    fn strip(&self, strip: u32) -> Maps<Vec<u8>> {
        let rows = self.strips.rows(strip, self.textured.size_px);
        let owners = self.strips.owners(self.textured, strip);
        let width = self.textured.size_px as usize;
        let mut pixels = Pixels::new(width, rows.len());
        let mut batch = Batch::default();
        for left in (0..width).step_by(TILE_PX as usize) {
            let columns = left..(left + TILE_PX as usize).min(width);
            let mut tile = vec![];
            for row in 0..rows.len() {
                tile.extend(columns.clone().filter_map(|x| {
                    let owner = owners[row * width + x];
                    (owner != NONE).then_some(TexelSample { owner, x: x as u32, row: row as u32 })
                }));
            }
            // Charts that meet in a tile may be far apart in the cave.
            tile.sort_by_key(|sample| self.textured.charts[sample.owner as usize]);
            for samples in tile.chunk_by(|a, b| self.chart(a) == self.chart(b)) {
                batch.look(self, samples, rows.start);
                batch.paint(self, samples, &mut pixels);
            }
        }
        pixels.fill_background(&owners);
        pixels.into_maps(self.wants_height)
    }

    fn chart(&self, sample: &TexelSample) -> u32 {
        self.textured.charts[sample.owner as usize]
    }
}

/// A texel to sample: `row` counts from the bottom of its strip.
#[derive(Clone, Copy)]
struct TexelSample {
    owner: u32,
    x: u32,
    row: u32,
}

/// Texels of one chart in one tile.
#[derive(Default)]
struct Batch {
    frames: Vec<Frame>,
    points: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    offsets_m: Vec<f32>,
    texels: Vec<Texel>,
}

impl Batch {
    fn look(&mut self, baker: &Baker, samples: &[TexelSample], first_row: i32) {
        self.frames.clear();
        for run in samples.chunk_by(|a, b| a.owner == b.owner) {
            let patch = Patch::new(baker.textured, run[0].owner);
            let frame = |sample: &TexelSample| patch.frame(sample.x as i32, first_row + sample.row as i32);
            self.frames.extend(run.iter().map(frame));
        }
        self.points.clear();
        self.points.extend(self.frames.iter().map(|frame| frame.position));
        self.normals.clear();
        self.normals.extend(self.frames.iter().map(Frame::unit_normal));
        self.project(baker.surface);
        self.texels.clear();
        self.texels.resize(samples.len(), Texel::default());
        let texel_m = 1.0 / baker.textured.texels_per_m;
        let bounds = Aabb::from_points(self.points.iter().copied()).expect("a batch has texels");
        baker.surface.texels(bounds, texel_m, &self.points, &self.normals, &mut self.texels);
    }

    /// Moves the points from the mesh to the wall.
    fn project(&mut self, surface: &dyn Surface) {
        self.offsets_m.clear();
        self.offsets_m.resize(self.points.len(), 0.0);
        let bounds = Aabb::from_points(self.points.iter().copied()).expect("a batch has texels");
        surface.offsets(bounds, &self.points, &self.normals, &mut self.offsets_m);
        for ((point, normal), offset_m) in self.points.iter_mut().zip(&self.normals).zip(&self.offsets_m) {
            *point = std::array::from_fn(|axis| point[axis] + normal[axis] * offset_m);
        }
    }

    fn paint(&self, baker: &Baker, samples: &[TexelSample], pixels: &mut Pixels) {
        let texels = self.texels.iter().zip(&self.offsets_m);
        for ((sample, frame), (texel, offset_m)) in samples.iter().zip(&self.frames).zip(texels) {
            let roughness = byte(texel.roughness);
            let height_m = texel.height_m + offset_m;
            pixels.set(
                sample,
                Pixel {
                    color: texel.color.map(|c| baker.srgb.encode(c)),
                    normal: frame.tangent_normal(texel.normal).map(|c| byte(0.5 * c + 0.5)),
                    orm: [byte(texel.occlusion), roughness, 0],
                    height: word(0.5 * (height_m / HEIGHT_AMPLITUDE_M).clamp(-1.0, 1.0) + 0.5),
                },
            );
        }
    }
}

/// 0–1 to 0–255, rounded.
fn byte(value: f32) -> u8 {
    (value * 255.0 + 0.5) as u8
}

/// 0–1 to 0–65535, rounded.
fn word(value: f32) -> u16 {
    (value * 65_535.0 + 0.5) as u16
}

#[derive(Clone, Copy)]
struct Pixel {
    color: [u8; 3],
    normal: [u8; 3],
    orm: [u8; 3],
    height: u16,
}

/// The colour of rows without charts.
const BLANK: Pixel = Pixel { color: [128; 3], normal: [128, 128, 255], orm: [255, 255, 0], height: 1 << 15 };

/// A strip of pixels, lowest row first.
struct Pixels {
    width: usize,
    pixels: Vec<Pixel>,
}

impl Pixels {
    fn new(width: usize, rows: usize) -> Self {
        Self { width, pixels: vec![BLANK; width * rows] }
    }

    fn set(&mut self, sample: &TexelSample, pixel: Pixel) {
        self.pixels[sample.row as usize * self.width + sample.x as usize] = pixel;
    }

    /// Fills every free texel with the nearest pixel of its row.
    fn fill_background(&mut self, owners: &[u32]) {
        let rows = self.pixels.chunks_mut(self.width).zip(owners.chunks(self.width));
        for (row, owners) in rows {
            let mut left = None;
            for (x, _) in owners.iter().enumerate().filter(|&(_, &owner)| owner != NONE) {
                fill_gap(row, left, Some(x));
                left = Some(x);
            }
            fill_gap(row, left, None);
        }
    }

    fn into_maps(self, wants_height: bool) -> Maps<Vec<u8>> {
        Maps {
            base_color: self.channels(|pixel| pixel.color),
            normal: self.channels(|pixel| pixel.normal),
            orm: self.channels(|pixel| pixel.orm),
            roughness: self.channels(|pixel| [pixel.orm[1]]),
            height: wants_height.then(|| self.channels(|pixel| pixel.height.to_be_bytes())),
        }
    }

    /// One map, top row first.
    fn channels<const N: usize>(&self, of: impl Fn(&Pixel) -> [u8; N]) -> Vec<u8> {
        let mut bytes = vec![0; self.pixels.len() * N];
        let rows = self.pixels.chunks(self.width).rev();
        for (row, out) in rows.zip(bytes.chunks_mut(self.width * N)) {
            for (pixel, out) in row.iter().zip(out.chunks_exact_mut(N)) {
                out.copy_from_slice(&of(pixel));
            }
        }
        bytes
    }
}

/// Fills the pixels between two columns that have one, or between one and the border.
fn fill_gap(row: &mut [Pixel], left: Option<usize>, right: Option<usize>) {
    let (start, end) = (left.map_or(0, |x| x + 1), right.unwrap_or(row.len()));
    let middle = match (left, right) {
        (None, _) => start,
        (_, None) => end,
        _ => start + (end - start).div_ceil(2),
    };
    if let Some(pixel) = left.map(|x| row[x]) {
        row[start..middle].fill(pixel);
    }
    if let Some(pixel) = right.map(|x| row[x]) {
        row[middle..end].fill(pixel);
    }
}

/// The encoders.
struct Writers<W: Write>(Maps<MapWriter<W>>);

impl<W: Write + Send> Writers<W> {
    fn new(sinks: Maps<W>, size_px: u32, format: ImageFormat) -> io::Result<Self> {
        let start = |sink, channels| MapWriter::new(sink, channels, size_px, format);
        let start_height = |sink| MapWriter::new(sink, Channels::Grey16, size_px, ImageFormat::Png);
        Ok(Self(Maps {
            base_color: start(sinks.base_color, Channels::Srgb)?,
            normal: start(sinks.normal, Channels::LinearRgb)?,
            orm: start(sinks.orm, Channels::LinearRgb)?,
            roughness: start(sinks.roughness, Channels::Grey)?,
            height: sinks.height.map(start_height).transpose()?,
        }))
    }

    /// Appends strips, each map on a separate thread.
    fn write(&mut self, strips: &[Maps<Vec<u8>>]) -> io::Result<()> {
        let pixels: Vec<Vec<&Vec<u8>>> = strips.iter().map(|strip| strip.as_ref().into_iter().collect()).collect();
        let writers: Vec<&mut MapWriter<W>> = self.0.as_mut().into_iter().collect();
        let write =
            |(map, writer): (usize, &mut MapWriter<W>)| pixels.iter().try_for_each(|strip| writer.write(strip[map]));
        writers.into_par_iter().enumerate().try_for_each(write)
    }

    fn finish(self) -> io::Result<()> {
        let writers: Vec<MapWriter<W>> = self.0.into_iter().collect();
        writers.into_par_iter().try_for_each(MapWriter::finish)
    }
}

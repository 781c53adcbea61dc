//! Samples the surface once per texel and writes the maps.
//!
//! The atlas is baked in strips of rows, several in parallel, which are passed to the encoders before the next ones begin:
//! memory is bounded by the width of the atlas, not its area.

use std::io::{self, Write};
use std::ops::Range;

use rayon::prelude::*;

use super::encode::{Channels, MapWriter};
use super::frames::Frames;
use super::owners::{NONE, Shown, Strips};
use super::patch::Patch;
use super::settings::MapFormats;
use super::{HEIGHT_AMPLITUDE_M, Maps, Textured};
use crate::field::{Columns, Surface, Texel};
use crate::srgb::SrgbTable;

/// Width and height of the tiles of texels that are sampled together, so that they share what varies slowly; a strip is as
/// high as a tile, without the texels beyond it that it repeats. Tuned.
const TILE_PX: [u32; 2] = [256, 64];
/// Strips in flight. A constant, so that memory does not depend on the machine.
const STRIPS_AT_ONCE: u32 = 8;

/// Bakes `surface` onto `textured` and writes the maps to `sinks`.
///
/// Texels within two texels of a chart extend its rim along the plane of the nearest triangle; those within eight repeat the
/// nearest texel of that rim, so that the first four mip levels mix hardly any of another chart; the others repeat the nearest
/// texel of their row, so that no level mixes in a background.
///
/// # Errors
/// If a sink fails.
pub fn bake<W: Write + Send>(
    textured: &Textured,
    surface: &dyn Surface,
    formats: MapFormats,
    sinks: Maps<W>,
) -> io::Result<()> {
    let strips = Strips::new(textured, TILE_PX[1]);
    let wants_height = sinks.height.is_some();
    let baker = Baker { textured, surface, strips: &strips, srgb: SrgbTable::default(), wants_height };
    let mut writers = Writers::new(sinks, textured.size_px, formats)?;
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
        let shown = self.strips.shown(self.textured, strip);
        let width = self.textured.size_px as usize;
        let mut pixels = Pixels::new(width, shown.rows.len(), self.wants_height);
        let mut tile = Tile::default();
        for left in (0..width).step_by(TILE_PX[0] as usize) {
            let columns = left..(left + TILE_PX[0] as usize).min(width);
            tile.place(self.textured, &shown, columns);
            tile.sample(self);
            tile.paint(&self.srgb, &mut pixels);
        }
        pixels.repeat_rims(&shown.sources);
        pixels.fill_background(&shown.sources);
        let rows = self.strips.rows(strip, self.textured.size_px);
        pixels.of_rows((shown.rows.end - rows.end) as usize, rows.len())
    }
}

/// Consecutive texels of a row that show one triangle.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// Column of the first.
    x: u32,
    /// Row, from the lowest of [`Shown`].
    row: u32,
    /// Number of texels.
    len: u32,
}

/// The texels of a tile.
#[derive(Default)]
struct Tile {
    spans: Vec<Span>,
    frames: Frames,
    texels: Vec<Texel>,
}

impl Tile {
    /// The texels in some columns of a strip.
    fn place(&mut self, textured: &Textured, Shown { rows, triangles, .. }: &Shown, columns: Range<usize>) {
        self.spans.clear();
        self.frames.clear();
        let width = textured.size_px as usize;
        for row in 0..rows.len() {
            let triangles = &triangles[row * width..][columns.clone()];
            let mut x = columns.start as u32;
            for run in triangles.chunk_by(|a, b| a == b) {
                let (triangle, len) = (run[0], run.len() as u32);
                if triangle != NONE {
                    self.spans.push(Span { x, row: row as u32, len });
                    let patch = Patch::new(textured, triangle);
                    self.frames.extend(&patch, x as i32, rows.start + row as i32, len);
                }
                x += len;
            }
        }
    }

    fn sample(&mut self, baker: &Baker) {
        self.texels.clear();
        self.texels.resize(self.frames.signs.len(), Texel::default());
        let texel_m = 1.0 / baker.textured.texels_per_m;
        let normals = self.frames.unit_normals();
        let [positions, normals] =
            [&self.frames.positions, &normals].map(|columns| columns.each_ref().map(Vec::as_slice));
        baker.surface.dense_texels(texel_m, positions, normals, &mut self.texels);
    }

    fn paint(&self, srgb: &SrgbTable, pixels: &mut Pixels) {
        let normals = [0, 1, 2].map(|axis| self.texels.iter().map(|texel| texel.normal[axis]).collect());
        let normals = self.frames.tangent_normals(&normals);
        let mut start = 0;
        for span in &self.spans {
            let range = start..start + span.len as usize;
            start = range.end;
            pixels.set(
                span,
                srgb,
                &self.texels[range.clone()],
                normals.each_ref().map(|column| &column[range.clone()]),
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

/// The pixels of a strip, top row first.
struct Pixels {
    width: usize,
    rows: usize,
    maps: Maps<Vec<u8>>,
}

impl Pixels {
    /// Pixels in the colour of rows without charts.
    fn new(width: usize, rows: usize, wants_height: bool) -> Self {
        let blank = |pixel: &[u8]| pixel.repeat(width * rows);
        let maps = Maps {
            base_color: blank(&[128; 3]),
            normal: blank(&[128, 128, 255]),
            orm: blank(&[255, 255, 0]),
            roughness: blank(&[255]),
            height: wants_height.then(|| blank(&[128, 0])),
        };
        Self { width, rows, maps }
    }

    fn set(&mut self, span: &Span, srgb: &SrgbTable, texels: &[Texel], normals: Columns) {
        let start = (self.rows - 1 - span.row as usize) * self.width + span.x as usize;
        let range = start..start + texels.len();
        let [x, y, z] = normals;
        let Maps { base_color, normal, orm, roughness, height } = &mut self.maps;
        for (to, texel) in base_color.as_chunks_mut().0[range.clone()].iter_mut().zip(texels) {
            *to = texel.color.map(|c| srgb.encode(c));
        }
        for (i, to) in normal.as_chunks_mut().0[range.clone()].iter_mut().enumerate() {
            *to = [x[i], y[i], z[i]].map(|c| byte(0.5 * c + 0.5));
        }
        for (to, texel) in orm.as_chunks_mut().0[range.clone()].iter_mut().zip(texels) {
            *to = [byte(texel.occlusion), byte(texel.roughness), 0];
        }
        for (to, texel) in roughness[range.clone()].iter_mut().zip(texels) {
            *to = byte(texel.roughness);
        }
        if let Some(height) = height {
            for (to, texel) in height.as_chunks_mut().0[range].iter_mut().zip(texels) {
                let share = 0.5 * (texel.height_m / HEIGHT_AMPLITUDE_M).clamp(-1.0, 1.0) + 0.5;
                *to = word(share).to_be_bytes();
            }
        }
    }

    /// Copies the pixels that others repeat. Rows of `sources` are from the bottom, like those that they tell.
    fn repeat_rims(&mut self, sources: &[u32]) {
        let width = self.width;
        let pixel = |texel: usize| (self.rows - 1 - texel / width) * width + texel % width;
        let repeated =
            sources.iter().enumerate().filter(|(texel, source)| **source != NONE && **source as usize != *texel);
        let pairs: Vec<[usize; 2]> = repeated.map(|(texel, source)| [pixel(*source as usize), pixel(texel)]).collect();
        pairs.into_iter().for_each(|[from, to]| self.repeat(from, to..to + 1));
    }

    /// Fills every free texel with the nearest pixel of its row. Rows of `sources` are from the bottom.
    fn fill_background(&mut self, sources: &[u32]) {
        for (row, sources) in sources.chunks(self.width).rev().enumerate() {
            let taken = (0..).zip(sources).filter(|(_, source)| **source != NONE).map(|(x, _): (usize, _)| x);
            let mut start = 0;
            let mut left = None;
            for x in taken {
                if x > start {
                    self.fill_gap(row, start..x, left, Some(x));
                }
                (start, left) = (x + 1, Some(x));
            }
            self.fill_gap(row, start..self.width, left, None);
        }
    }

    /// Fills the pixels of a gap from those beside it.
    fn fill_gap(&mut self, row: usize, gap: Range<usize>, left: Option<usize>, right: Option<usize>) {
        let middle = match (left, right) {
            (None, _) => gap.start,
            (_, None) => gap.end,
            _ => gap.start + gap.len().div_ceil(2),
        };
        let first = row * self.width;
        for (pixel, gap) in [(left, gap.start..middle), (right, middle..gap.end)] {
            let Some(pixel) = pixel else { continue };
            self.repeat(first + pixel, first + gap.start..first + gap.end);
        }
    }

    /// Copies a pixel to others.
    fn repeat(&mut self, pixel: usize, to: Range<usize>) {
        let Maps { base_color, normal, orm, roughness, height } = &mut self.maps;
        repeat::<3>(base_color, pixel, to.clone());
        repeat::<3>(normal, pixel, to.clone());
        repeat::<3>(orm, pixel, to.clone());
        repeat::<1>(roughness, pixel, to.clone());
        if let Some(height) = height {
            repeat::<2>(height, pixel, to);
        }
    }

    /// The maps of some rows, from `first` on.
    fn of_rows(self, first: usize, rows: usize) -> Maps<Vec<u8>> {
        let texels = first * self.width..(first + rows) * self.width;
        let bytes = CHANNELS.map(Channels::bytes);
        self.maps.zip(bytes).map(|(map, bytes)| map[texels.start * bytes..texels.end * bytes].to_vec())
    }
}

/// Copies a pixel of `N` bytes to others.
fn repeat<const N: usize>(map: &mut [u8], pixel: usize, to: Range<usize>) {
    let (pixels, _) = map.as_chunks_mut::<N>();
    let value = pixels[pixel];
    pixels[to].fill(value);
}

/// The channels of each map.
const CHANNELS: Maps<Channels> = Maps {
    base_color: Channels::Srgb,
    normal: Channels::LinearRgb,
    orm: Channels::LinearRgb,
    roughness: Channels::Grey,
    height: Some(Channels::Grey16),
};

/// The encoders.
struct Writers<W: Write>(Maps<MapWriter<W>>);

impl<W: Write + Send> Writers<W> {
    fn new(sinks: Maps<W>, size_px: u32, formats: MapFormats) -> io::Result<Self> {
        let start = |((sink, channels), format)| MapWriter::new(sink, channels, size_px, format);
        Ok(Self(sinks.zip(CHANNELS).zip(formats.each()).try_map(start)?))
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

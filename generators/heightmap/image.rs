//! Height maps from files: greyscale PNG (W3C PNG specification, third edition) and the ESRI ASCII grid.

use std::fmt::Display;
use std::io::Cursor;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

use super::{Heightmap, Heights};
use crate::GenerateError;
use plume_graph::Outside;

/// Largest number of cells of a height map.
const MOST_CELLS: usize = 1 << 25;
/// Memory limit of the decoder in bytes, if the rows of the picture are not larger.
const MOST_BYTES: usize = 1 << 26;
/// The signature of PNG.
const SIGNATURE: &[u8] = b"\x89PNG";

/// Reads the height map at `path`; the content determines the format.
pub(super) fn read(path: &Path, settings: &Heightmap, outside: &dyn Outside) -> Result<Heights, GenerateError> {
    let bytes = outside.read(path).map_err(|error| fault(path, error, "`path` is relative to the recipe"))?;
    let read = if bytes.starts_with(SIGNATURE) { read_png(&bytes, settings) } else { read_grid(&bytes, settings) };
    read.map_err(|Bad { message, hint }| fault(path, message, hint))
}

fn fault(path: &Path, message: impl Display, hint: &str) -> GenerateError {
    GenerateError::new(format!("{}: {message}", path.display()), hint)
}

/// What is wrong with a file.
#[derive(Debug)]
struct Bad {
    message: String,
    hint: &'static str,
}

fn bad(message: impl Into<String>, hint: &'static str) -> Bad {
    Bad { message: message.into(), hint }
}

fn check_size(columns: usize, rows: usize) -> Result<(), Bad> {
    if columns < 1 || rows < 1 || columns.checked_mul(rows).is_none_or(|cells| cells > MOST_CELLS) {
        let message = format!("has {columns} by {rows} cells");
        return Err(bad(message, "1 to 33554432 cells are supported; scale it down"));
    }
    Ok(())
}

fn read_png(bytes: &[u8], settings: &Heightmap) -> Result<Heights, Bad> {
    let broken =
        |error: png::DecodingError| bad(format!("is not an intact PNG: {error}"), "save it again as a greyscale PNG");
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST_BYTES });
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(broken)?;
    let (columns, rows) = (reader.info().width as usize, reader.info().height as usize);
    check_size(columns, rows)?;
    let step = match reader.output_color_type() {
        (ColorType::Grayscale, BitDepth::Eight) => 1,
        (ColorType::Grayscale | ColorType::GrayscaleAlpha, BitDepth::Sixteen) | (ColorType::GrayscaleAlpha, _) => 2,
        _ => return Err(bad("is a colour picture", "save it as a greyscale PNG of 8 or 16 bits")),
    };
    let (color, depth) = reader.output_color_type();
    let sample = if depth == BitDepth::Sixteen { 2 } else { 1 };
    let step = if color == ColorType::GrayscaleAlpha { 2 * sample } else { step };
    let mut values = Vec::with_capacity(columns * rows);
    while let Some(row) = reader.next_row().map_err(broken)? {
        values.extend(row.data().chunks_exact(step).map(|pixel| match sample {
            2 => f32::from(u16::from_be_bytes([pixel[0], pixel[1]])) / f32::from(u16::MAX),
            _ => f32::from(pixel[0]) / f32::from(u8::MAX),
        }));
    }
    if values.len() != columns * rows {
        return Err(bad("is interlaced", "save it without interlacing"));
    }
    Ok(Heights { columns, values, cell_m: settings.metres_per_pixel, range_m: settings.height_range_m })
}

/// Reads an ESRI ASCII grid: lines of names and values, then heights row by row from the north.
fn read_grid(bytes: &[u8], settings: &Heightmap) -> Result<Heights, Bad> {
    const KNOWN: &str = "greyscale PNG and ESRI ASCII grids are supported";
    let text = std::str::from_utf8(bytes).map_err(|_| bad("is not a height map", KNOWN))?;
    let mut words = text.split_ascii_whitespace().peekable();
    let (mut columns, mut rows, mut cell_m, mut void) = (0, 0, settings.metres_per_pixel, None);
    while let Some(name) = words.next_if(|word| word.starts_with(|c: char| c.is_ascii_alphabetic())) {
        let value = words.next().and_then(|word| word.parse::<f64>().ok()).filter(|value| value.is_finite());
        let value = value.ok_or_else(|| bad(format!("has no number after {name:.40}"), KNOWN))?;
        match name.to_ascii_lowercase().as_str() {
            "ncols" => columns = value as usize,
            "nrows" => rows = value as usize,
            "cellsize" => cell_m = value,
            "nodata_value" => void = Some(value),
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" => {}
            _ => return Err(bad(format!("has an unknown key {name:.40}"), KNOWN)),
        }
    }
    check_size(columns, rows)?;
    if !(0.01..=1000.0).contains(&cell_m) {
        return Err(bad(format!("has a cellsize of {cell_m}"), "cells from 0.01 to 1000 m are supported"));
    }
    let mut heights = Vec::new();
    for word in words {
        let height = word.parse::<f64>().ok().filter(|height| height.abs() < 1e7);
        heights.push(height.ok_or_else(|| bad(format!("has the height {word:.40}"), "heights are numbers in metres"))?);
        if heights.len() > columns * rows {
            break;
        }
    }
    if heights.len() != columns * rows {
        return Err(bad(format!("does not have the {} heights that it announces", columns * rows), "save it again"));
    }
    Ok(scaled(columns, &heights, void, cell_m))
}

/// Heights in metres scaled to 0 to 1; missing ones become the lowest.
fn scaled(columns: usize, heights: &[f64], void: Option<f64>, cell_m: f64) -> Heights {
    let known = || heights.iter().copied().filter(|&height| Some(height) != void);
    let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
    let range_m = (high - low).max(0.001);
    let value = |&height: &f64| if Some(height) == void { 0.0 } else { ((height - low) / range_m) as f32 };
    Heights { columns, values: heights.iter().map(value).collect(), cell_m, range_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    fn heights(bytes: &[u8]) -> Result<Heights, Bad> {
        let settings = Heightmap::default();
        if bytes.starts_with(SIGNATURE) { read_png(bytes, &settings) } else { read_grid(bytes, &settings) }
    }

    #[test]
    fn grey_pictures_of_either_depth_are_read() {
        let eight = heights(&png(ColorType::Grayscale, BitDepth::Eight, &[0, 255, 51, 0])).unwrap();
        assert_eq!(eight.values, [0.0, 1.0, 0.2, 0.0]);
        let sixteen = png(ColorType::GrayscaleAlpha, BitDepth::Sixteen, &[255; 16]);
        assert_eq!(heights(&sixteen).unwrap().values, [1.0; 4]);
    }

    #[test]
    fn grids_have_their_own_scale() {
        let grid = b"ncols 2\nnrows 2\nxllcorner 5\nyllcorner 6\ncellsize 2.5\nNODATA_value -9\n10 14\n-9 12\n";
        let grid = heights(grid).unwrap();
        assert_eq!((grid.values.as_slice(), grid.cell_m, grid.range_m), ([0.0, 1.0, 0.0, 0.5].as_slice(), 2.5, 4.0));
    }

    #[test]
    fn invalid_height_maps_are_refused_with_a_hint() {
        let whole = png(ColorType::Grayscale, BitDepth::Eight, &[0; 4]);
        let mut vast = Vec::new();
        let mut writer = png::Encoder::new(&mut vast, 1 << 20, 1 << 20).write_header().unwrap();
        writer.write_chunk(png::chunk::IDAT, &[0]).unwrap();
        drop(writer);
        let files: [&[u8]; 8] = [
            &png(ColorType::Rgb, BitDepth::Eight, &[0; 12]),
            &whole[..whole.len() - 30],
            &vast,
            b"\xff\xfe",
            b"ncols 2 nrows 2 1 2 3",
            b"ncols 1e9 nrows 1e9 1",
            b"ncols 2 nrows 1 nan 1",
            b"",
        ];
        let told: Vec<String> = files.iter().map(|file| heights(file).unwrap_err().message).collect();
        insta::assert_snapshot!(told.join("\n"), @r"
        is a colour picture
        is not an intact PNG: unexpected end of file
        has 1048576 by 1048576 cells
        is not a height map
        does not have the 4 heights that it announces
        has 1000000000 by 1000000000 cells
        has an unknown key nan
        has 0 by 0 cells
        ");
    }
}

//! GeoTIFF rasters of single-precision numbers, with several bands.
//!
//! Follows TIFF 6.0, GeoTIFF 1.1 (OGC 19-008) and what GDAL adds for names and units of bands and for cells without a value
//! (<https://gdal.org/en/stable/drivers/raster/gtiff.html>). Coordinates are local: there is no reference system. Bands are one after
//! the other, compressed by rows; only some rows are in memory at a time.

use std::io::{Seek, Write};
use std::ops::Range;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use tiff::TiffResult;
use tiff::encoder::{DirectoryEncoder, TiffEncoder, TiffKind};
use tiff::tags::Tag;

/// The shape of a raster.
pub struct Raster<'a> {
    /// Number of cells along x and y.
    pub size: [u32; 2],
    /// Outer corner of the first cell, which has the lowest x and the highest y, in metres.
    pub corner_m: [f64; 2],
    /// Side of a cell in metres.
    pub cell_m: f64,
    /// Name and unit of each band.
    pub bands: &'a [(&'a str, &'a str)],
}

/// Rows that are compressed together.
const ROWS: u32 = 64;

/// Names and units of bands, in XML.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// Writes a raster, given the numbers of some rows, counted from the highest y: those of each band row by row, NaN where there is
/// none.
///
/// # Errors
/// Those of `file`.
pub fn write<W: Write + Seek>(
    file: W,
    raster: &Raster,
    mut numbers_of: impl FnMut(Range<u32>) -> Vec<Vec<f32>>,
) -> TiffResult<()> {
    let mut encoder = TiffEncoder::new(file)?;
    let mut directory = encoder.image_directory()?;
    let strips = raster.size[1].div_ceil(ROWS);
    let mut places = vec![Vec::new(); raster.bands.len()];
    for strip in 0..strips {
        let rows = strip * ROWS..(ROWS * (strip + 1)).min(raster.size[1]);
        for (band, numbers) in numbers_of(rows).into_iter().enumerate() {
            let bytes = compressed(&numbers)?;
            places[band].push((directory.write_data(&bytes[..])? as u32, bytes.len() as u32));
        }
    }
    describe(&mut directory, raster)?;
    let (offsets, counts): (Vec<u32>, Vec<u32>) = places.into_iter().flatten().unzip();
    directory.write_tag(Tag::StripOffsets, &offsets[..])?;
    directory.write_tag(Tag::StripByteCounts, &counts[..])?;
    directory.finish()
}

fn compressed(numbers: &[f32]) -> std::io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_ne_bytes()).collect();
    encoder.write_all(&bytes)?;
    encoder.finish()
}

fn describe<W: Write + Seek, K: TiffKind>(directory: &mut DirectoryEncoder<W, K>, raster: &Raster) -> TiffResult<()> {
    const DEFLATE: u16 = 8;
    const BLACK_IS_ZERO: u16 = 1;
    const BANDS_APART: u16 = 2;
    const FLOAT: u16 = 3;
    /// Three keys: coordinates are of no known system, what is told of a cell holds for its area, and lengths are in metres.
    const KEYS: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 32767, 1025, 0, 1, 1, 3076, 0, 1, 9001];
    let [width, height] = raster.size;
    let [x, y] = raster.corner_m;
    let bands = raster.bands.len();
    directory.write_tag(Tag::ImageWidth, width)?;
    directory.write_tag(Tag::ImageLength, height)?;
    directory.write_tag(Tag::BitsPerSample, &vec![32_u16; bands][..])?;
    directory.write_tag(Tag::Compression, DEFLATE)?;
    directory.write_tag(Tag::PhotometricInterpretation, BLACK_IS_ZERO)?;
    directory.write_tag(Tag::SamplesPerPixel, bands as u16)?;
    directory.write_tag(Tag::RowsPerStrip, ROWS)?;
    directory.write_tag(Tag::PlanarConfiguration, BANDS_APART)?;
    directory.write_tag(Tag::ExtraSamples, &vec![0_u16; bands - 1][..])?;
    directory.write_tag(Tag::SampleFormat, &vec![FLOAT; bands][..])?;
    directory.write_tag(Tag::ModelPixelScaleTag, &[raster.cell_m, raster.cell_m, 0.0][..])?;
    directory.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, x, y, 0.0][..])?;
    directory.write_tag(Tag::GeoKeyDirectoryTag, &KEYS[..])?;
    directory.write_tag(GDAL_METADATA, &*metadata(raster.bands))?;
    directory.write_tag(Tag::GdalNodata, "nan")
}

fn metadata(bands: &[(&str, &str)]) -> String {
    let item = |(number, (name, unit)): (usize, &(&str, &str))| {
        format!(
            "<Item name=\"DESCRIPTION\" sample=\"{number}\" role=\"description\">{name}</Item>\
             <Item name=\"UNITTYPE\" sample=\"{number}\" role=\"unittype\">{unit}</Item>"
        )
    };
    let items: String = bands.iter().enumerate().map(item).collect();
    format!("<GDALMetadata>{items}</GDALMetadata>")
}

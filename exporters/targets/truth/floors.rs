//! The files of the floor: arrays, and for each storey a map and a raster.

use std::fs::File;
use std::io::{self, BufWriter};
use std::ops::Range;
use std::path::Path;

use plume_truth::{Floor, Gap, OccupancyMap, Relief, State, Storeys};
use png::{BitDepth, ColorType, Encoder};
use serde::Serialize;

use super::table::{Entry, Table};
use super::{Part, TruthSettings};
use crate::error::ExportError;
use crate::format::geotiff::{self, Raster};
use crate::format::npy::Archive;
use crate::format::ros2::{Bag, GridMap, Message};
use crate::package::Package;

/// Most cells along either axis in a message, so that none is larger than 6 MB.
const TILE: usize = 512;

/// What is known about a storey.
#[derive(Serialize)]
pub struct Storey {
    /// Its number in `floor.npz`.
    storey: u16,
    area_m2: f64,
    /// Lowest and highest floor.
    floor_m: [f32; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    map: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    elevation: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    grid_map: Option<String>,
}

/// The floor, and what a robot reaches of it.
pub struct Floors<'a> {
    /// All of it.
    pub floor: &'a Floor,
    /// Its storeys.
    pub storeys: &'a Storeys,
    /// Those of the target.
    pub settings: &'a TruthSettings,
}

impl Floors<'_> {
    /// Writes the files that are wanted; returns the storeys that are not too small.
    pub fn write(&self, scratch: &Path, table: &mut Table, out: &mut dyn Package) -> Result<Vec<Storey>, ExportError> {
        let cell_m = self.settings.cell_m;
        if self.settings.files.contains(&Part::Floor) {
            out.write_by(scratch, "floor.npz", |file| Ok(self.write_arrays(file)?))?;
            table.add(Entry::of_cells("floor.npz", "cells of the floor, also those over each other", "m, rad", cell_m));
        }
        let mut listed = Vec::new();
        for (storey, cells) in (0..).zip(&self.storeys.sizes) {
            let area_m2 = *cells as f64 * cell_m * cell_m;
            if area_m2 >= self.settings.least_area_m2 {
                listed.push(self.write_storey(storey, area_m2, listed.len(), scratch, table, out)?);
            }
        }
        Ok(listed)
    }

    /// Writes the files of a storey, of which the names have this number.
    fn write_storey(
        &self,
        storey: u16,
        area_m2: f64,
        number: usize,
        scratch: &Path,
        table: &mut Table,
        out: &mut dyn Package,
    ) -> Result<Storey, ExportError> {
        let map = OccupancyMap::of(self.floor, self.storeys, storey);
        let mut listed = Storey { storey, area_m2, floor_m: map.floor_m, map: None, elevation: None, grid_map: None };
        if self.settings.files.contains(&Part::Maps) {
            let name = format!("map_{number}");
            out.write(&format!("{name}.png"), |file| write_image(file, &map))?;
            out.text(&format!("{name}.yaml"), &yaml(&name, &map))?;
            table.add(Entry::of_cells(format!("{name}.png"), "occupancy map of a storey", "1", map.cell_m));
            listed.map = Some(format!("{name}.yaml"));
        }
        if self.settings.files.contains(&Part::Elevation) {
            let path = format!("elevation_{number}.tif");
            self.write_raster(&path, storey, &map, scratch, out)?;
            let content = "raster of a storey: floor, ceiling, headroom, slope, step, roughness";
            table.add(Entry::of_cells(path.clone(), content, "m, rad", map.cell_m));
            listed.elevation = Some(path);
        }
        if self.settings.files.contains(&Part::GridMap) {
            let path = format!("elevation_{number}.mcap");
            self.write_grid_map(&path, storey, &map, scratch, out)?;
            let content = "the same as messages of grid_map";
            table.add(Entry::of_cells(path.clone(), content, "m, rad", map.cell_m));
            listed.grid_map = Some(path);
        }
        Ok(listed)
    }

    /// Writes the arrays of `floor.npz`.
    fn write_arrays(&self, file: &mut BufWriter<&File>) -> io::Result<()> {
        let (cells, reliefs) = (self.floor.cells(), self.floor.reliefs());
        let count = [cells.len()];
        let storey = |storey: &Option<u16>| storey.map_or(-1, |storey| storey as i16);
        let mut archive = Archive::new(file);
        archive.add("cell_m", &[], [self.floor.cell_m()])?;
        archive.add("cell", &[cells.len(), 2], cells.iter().flat_map(|gap| gap.cell))?;
        archive.add("z", &count, cells.iter().map(|gap| gap.floor_m))?;
        archive.add("headroom", &count, cells.iter().map(Gap::height_m))?;
        archive.add("slope", &count, reliefs.iter().map(|relief| relief.slope_rad))?;
        archive.add("step", &count, reliefs.iter().map(|relief| relief.step_m))?;
        archive.add("roughness", &count, reliefs.iter().map(|relief| relief.roughness_m))?;
        archive.add("storey", &count, self.storeys.of.iter().map(storey))?;
        archive.finish()
    }

    /// Writes the numbers of a storey on the cells of its map.
    fn write_raster(
        &self,
        path: &str,
        storey: u16,
        map: &OccupancyMap,
        scratch: &Path,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let OccupancyMap { cell_m, origin_m: [x, y], size: [width, height], .. } = *map;
        let corner_m = [x, y + height as f64 * cell_m];
        let raster = Raster {
            size: [width as u32, height as u32],
            corner_m,
            cell_m,
            bands: &BANDS.map(|band| (band.name, band.unit)),
        };
        out.write_by(scratch, path, |file| {
            geotiff::write(file, &raster, |rows| self.bands(storey, map, rows)).map_err(|error| named(path, error))
        })
    }

    /// The numbers of some rows of a storey, from the highest y, for each of [`BANDS`].
    fn bands(&self, storey: u16, map: &OccupancyMap, rows: Range<u32>) -> Vec<Vec<f32>> {
        let [width, height] = map.size;
        let cells = rows.flat_map(|row| (0..width).map(move |column| [column, height - 1 - row as usize]));
        let numbers: Vec<Option<usize>> = cells.map(|cell| self.at(storey, map, cell)).collect();
        let of = |band: &Band| numbers.iter().map(|number| self.value(band, *number)).collect();
        BANDS.iter().map(of).collect()
    }

    /// Writes the numbers of a storey as messages, each of a part of its map.
    fn write_grid_map(
        &self,
        path: &str,
        storey: u16,
        map: &OccupancyMap,
        scratch: &Path,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let firsts = |axis: usize| (0..map.size[axis]).step_by(TILE);
        out.write_by(scratch, path, |file| {
            let mut bag = Bag::create(file)?;
            for first in firsts(0).flat_map(|x| firsts(1).map(move |y| [x, y])) {
                if let Some(data) = self.tile(storey, map, first) {
                    let topic = "/elevation".to_owned();
                    bag.write(Message { topic, kind: &GridMap::KIND, time_ns: 0, data, is_latched: true })?;
                }
            }
            Ok(bag.finish()?)
        })
    }

    /// The message of a part of a map that begins at a cell; `None` if the storey is not there.
    fn tile(&self, storey: u16, map: &OccupancyMap, first: [usize; 2]) -> Option<Vec<u8>> {
        let [width, height] = [0, 1].map(|axis| TILE.min(map.size[axis] - first[axis]));
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| [first[0] + x, first[1] + y]));
        let numbers: Vec<Option<usize>> = cells.map(|cell| self.at(storey, map, cell)).collect();
        numbers.iter().find_map(|number| *number)?;
        let middle =
            |axis: usize, count: usize| map.origin_m[axis] + (first[axis] as f64 + count as f64 / 2.0) * map.cell_m;
        let grid = GridMap {
            frame: "map",
            cell_m: map.cell_m,
            middle_m: [middle(0, width), middle(1, height)],
            size: [width, height],
            layers: &BANDS.map(|band| band.layer),
        };
        Some(grid.encode(|layer, [x, y]| self.value(&BANDS[layer], numbers[y * width + x])))
    }

    /// The number of the floor of a storey at a cell of its map.
    fn at(&self, storey: u16, map: &OccupancyMap, cell: [usize; 2]) -> Option<usize> {
        let first = |axis: usize| (map.origin_m[axis] / map.cell_m).round() as i32;
        let cell = [0, 1].map(|axis| first(axis) + cell[axis] as i32);
        self.floor.over(cell).find(|number| self.storeys.of[*number] == Some(storey))
    }

    /// What a band says of a cell; NaN where there is no floor.
    fn value(&self, band: &Band, number: Option<usize>) -> f32 {
        number.map_or(f32::NAN, |number| (band.value)(&self.floor.cells()[number], &self.floor.reliefs()[number]))
    }
}

/// What rasters and messages say of a cell.
#[derive(Clone, Copy)]
struct Band {
    name: &'static str,
    /// Its name in messages, where the floor is called as programs for grid_map do.
    layer: &'static str,
    unit: &'static str,
    value: fn(&Gap, &Relief) -> f32,
}

impl Band {
    const fn new(name: &'static str, unit: &'static str, value: fn(&Gap, &Relief) -> f32) -> Self {
        Self { name, layer: name, unit, value }
    }
}

static BANDS: [Band; 6] = [
    Band { layer: "elevation", ..Band::new("floor", "m", |gap, _| gap.floor_m) },
    Band::new("ceiling", "m", |gap, _| gap.ceiling_m),
    Band::new("headroom", "m", |gap, _| gap.height_m()),
    Band::new("slope", "rad", |_, relief| relief.slope_rad),
    Band::new("step", "m", |_, relief| relief.step_m),
    Band::new("roughness", "m", |_, relief| relief.roughness_m),
];

/// The error of the system, or that of the format, with the file.
fn named(path: &str, error: tiff::TiffError) -> ExportError {
    let error = match error {
        tiff::TiffError::IoError(error) => error,
        other => std::io::Error::other(other),
    };
    crate::error::at(path, &error).into()
}

/// A map in the greys that the map server of ROS writes and reads, its first row at the top.
fn write_image(file: &mut dyn std::io::Write, map: &OccupancyMap) -> Result<(), ExportError> {
    let [width, height] = map.size;
    let grey = |state: &State| match state {
        State::Free => 254,
        State::Occupied => 0,
        State::Unknown => 205,
    };
    let pixels: Vec<u8> = map.cells.chunks_exact(width).rev().flatten().map(grey).collect();
    let mut encoder = Encoder::new(file, width as u32, height as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(std::io::Error::from)?;
    writer.write_image_data(&pixels).map_err(std::io::Error::from)?;
    Ok(writer.finish().map_err(std::io::Error::from)?)
}

/// What the map server needs to know about an image. With its default threshold for free cells, the grey of unknown ones would
/// be free.
fn yaml(name: &str, map: &OccupancyMap) -> String {
    let OccupancyMap { cell_m, origin_m: [x, y], .. } = map;
    format!(
        "image: {name}.png\nmode: trinary\nresolution: {cell_m}\norigin: [{x}, {y}, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
}

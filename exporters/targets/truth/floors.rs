//! The files of the floor: arrays, and for each storey a map, a raster and messages.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use plume_truth::{Floor, Gap, OccupancyMap, State, Storeys};
use png::{BitDepth, ColorType, Encoder};
use serde::Serialize;

use super::sheet::Sheet;
use super::table::{Entry, Table};
use super::{Part, TruthSettings};
use crate::error::ExportError;
use crate::format::npy::Archive;
use crate::package::Package;

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
        let sheet = Sheet { floor: self.floor, storeys: self.storeys, storey, map: &map };
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
            sheet.write_raster(&path, scratch, out)?;
            let content = "raster of a storey: floor, ceiling, headroom, slope, step, roughness";
            table.add(Entry::of_cells(path.clone(), content, "m, rad", map.cell_m));
            listed.elevation = Some(path);
        }
        if self.settings.files.contains(&Part::GridMap) {
            let path = format!("elevation_{number}.mcap");
            sheet.write_grid_map(&path, scratch, out)?;
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

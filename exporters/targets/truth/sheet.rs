//! What is known about a storey, on the cells of its map: as a raster and as messages of grid_map.

use std::ops::Range;
use std::path::Path;

use plume_truth::{Floor, Gap, OccupancyMap, Relief, Storeys};

use crate::error::ExportError;
use crate::format::geotiff::{self, Raster};
use crate::format::ros2::{Bag, GridMap, Message};
use crate::package::Package;

/// Most cells along either axis in a message, so that none is larger than 6 MB.
const TILE: usize = 512;

/// A storey and its map.
pub struct Sheet<'a> {
    /// The floor of all storeys.
    pub floor: &'a Floor,
    /// Which of them each cell of the floor belongs to.
    pub storeys: &'a Storeys,
    /// This one.
    pub storey: u16,
    /// Its map.
    pub map: &'a OccupancyMap,
}

impl Sheet<'_> {
    /// Writes the raster.
    pub fn write_raster(&self, path: &str, scratch: &Path, out: &mut dyn Package) -> Result<(), ExportError> {
        let OccupancyMap { cell_m, origin_m: [x, y], size: [width, height], .. } = *self.map;
        let corner_m = [x, y + height as f64 * cell_m];
        let raster = Raster {
            size: [width as u32, height as u32],
            corner_m,
            cell_m,
            bands: &BANDS.map(|band| (band.name, band.unit)),
        };
        out.write_by(scratch, path, |file| {
            geotiff::write(file, &raster, |rows| self.bands(rows)).map_err(|error| named(path, error))
        })
    }

    /// The numbers of some rows, from the highest y, for each of [`BANDS`].
    fn bands(&self, rows: Range<u32>) -> Vec<Vec<f32>> {
        let [width, height] = self.map.size;
        let cells = rows.flat_map(|row| (0..width).map(move |column| [column, height - 1 - row as usize]));
        let numbers: Vec<Option<usize>> = cells.map(|cell| self.at(cell)).collect();
        let of = |band: &Band| numbers.iter().map(|number| self.value(band, *number)).collect();
        BANDS.iter().map(of).collect()
    }

    /// Writes the messages, each of a part of the map.
    pub fn write_grid_map(&self, path: &str, scratch: &Path, out: &mut dyn Package) -> Result<(), ExportError> {
        let firsts = |axis: usize| (0..self.map.size[axis]).step_by(TILE);
        out.write_by(scratch, path, |file| {
            let mut bag = Bag::create(file)?;
            for first in firsts(0).flat_map(|x| firsts(1).map(move |y| [x, y])) {
                if let Some(data) = self.tile(first) {
                    let topic = "/elevation".to_owned();
                    bag.write(Message { topic, kind: &GridMap::KIND, time_ns: 0, data, is_latched: true })?;
                }
            }
            Ok(bag.finish()?)
        })
    }

    /// The message of the part of the map that begins at a cell; `None` if the storey is not there.
    fn tile(&self, first: [usize; 2]) -> Option<Vec<u8>> {
        let [width, height] = [0, 1].map(|axis| TILE.min(self.map.size[axis] - first[axis]));
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| [first[0] + x, first[1] + y]));
        let numbers: Vec<Option<usize>> = cells.map(|cell| self.at(cell)).collect();
        numbers.iter().find_map(|number| *number)?;
        let middle = |axis: usize, count: usize| {
            self.map.origin_m[axis] + (first[axis] as f64 + count as f64 / 2.0) * self.map.cell_m
        };
        let grid = GridMap {
            frame: "map",
            cell_m: self.map.cell_m,
            middle_m: [middle(0, width), middle(1, height)],
            size: [width, height],
            layers: &BANDS.map(|band| band.layer),
        };
        Some(grid.encode(|layer, [x, y]| self.value(&BANDS[layer], numbers[y * width + x])))
    }

    /// The number of the floor of a storey at a cell of its map.
    fn at(&self, cell: [usize; 2]) -> Option<usize> {
        let first = |axis: usize| (self.map.origin_m[axis] / self.map.cell_m).round() as i32;
        let cell = [0, 1].map(|axis| first(axis) + cell[axis] as i32);
        self.floor.over(cell).find(|number| self.storeys.of[*number] == Some(self.storey))
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

//! The files of the grid of voxels.

use std::path::Path;

use super::layer::Layer;
use super::table::{Entry, Table};
use super::{Part, TruthSettings};
use crate::error::ExportError;
use crate::format::octomap;
use crate::package::Package;

/// Writes `occupancy.bt` and `voxels.npz`, whichever are wanted.
pub fn write_states(
    mut states: Layer<u8>,
    settings: &TruthSettings,
    scratch: &Path,
    table: &mut Table,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let voxel_m = settings.voxel_m;
    if settings.files.contains(&Part::Occupancy) {
        let path = "occupancy.bt";
        if !octomap::holds(states.places()) {
            return Err(ExportError::TooFar {
                path: path.to_owned(),
                format: "OctoMap",
                reach_m: octomap::reach_m(voxel_m),
            });
        }
        let cells = states.cells()?;
        out.write(path, |file| Ok(octomap::write(file, voxel_m, states.places(), cells)?))?;
        table.add(Entry::of_cells(path, "OctoMap: occupied where a surface passes, free in the air", "1", voxel_m));
    }
    if settings.files.contains(&Part::Voxels) {
        let path = "voxels.npz";
        states.write(scratch, path, voxel_m, "label", out)?;
        table.add(Entry::of_cells(path, "labels of cells: see labels.json", "1", voxel_m));
    }
    Ok(())
}

/// Writes `distance.npz`.
pub fn write_distances(
    mut distances: Layer<f32>,
    settings: &TruthSettings,
    scratch: &Path,
    table: &mut Table,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let path = "distance.npz";
    distances.write(scratch, path, settings.voxel_m, "distance", out)?;
    let content = "distance from the centre of a cell to the surface, negative in the air, infinite beyond the reach";
    table.add(Entry::of_cells(path, content, "m", settings.voxel_m));
    Ok(())
}

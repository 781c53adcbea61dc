//! The files of the grid of voxels.

use plume_truth::{Block, Distances, SIDE, Voxels};

use super::table::{Entry, Table};
use super::{Part, TruthSettings};
use crate::error::ExportError;
use crate::format::npy::{Archive, Number};
use crate::format::octomap;
use crate::package::Package;

/// Writes `occupancy.bt` and `voxels.npz`, whichever are wanted.
pub fn write_voxels(
    voxels: Voxels,
    settings: &TruthSettings,
    table: &mut Table,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let (blocks, voxel_m) = (voxels.into_blocks(), settings.voxel_m);
    if settings.files.contains(&Part::Occupancy) {
        let path = "occupancy.bt";
        if !octomap::holds(&blocks) {
            return Err(ExportError::TooFar {
                path: path.to_owned(),
                format: "OctoMap",
                reach_m: octomap::reach_m(voxel_m),
            });
        }
        out.write(path, |file| Ok(octomap::write(file, voxel_m, &blocks)?))?;
        table.add(Entry::of_cells(path, "OctoMap: occupied where a surface passes, free in the air", "1", voxel_m));
    }
    if settings.files.contains(&Part::Voxels) {
        let path = "voxels.npz";
        write_blocks(path, voxel_m, "label", &blocks, out)?;
        table.add(Entry::of_cells(path, "labels of cells: see labels.json", "1", voxel_m));
    }
    Ok(())
}

/// Writes `distance.npz`.
pub fn write_distances(
    distances: Distances,
    settings: &TruthSettings,
    table: &mut Table,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let path = "distance.npz";
    write_blocks(path, settings.voxel_m, "distance", &distances.into_blocks(), out)?;
    let content = "distance from the centre of a cell to the surface, negative in the air, infinite beyond the reach";
    table.add(Entry::of_cells(path, content, "m", settings.voxel_m));
    Ok(())
}

/// Writes the arrays of a sparse grid.
fn write_blocks<N: Number>(
    path: &str,
    cell_m: f64,
    name: &str,
    blocks: &[Block<N>],
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let mut archive = Archive::default();
    let places: Vec<i32> = blocks.iter().flat_map(|block| block.place).collect();
    archive.add("cell_m", &[], &[cell_m])?;
    archive.add("block", &[blocks.len(), 3], &places)?;
    let cells = blocks.iter().map(|block| &block.cells[..]);
    archive.add_parts(name, &[blocks.len(), SIDE, SIDE, SIDE], cells)?;
    let bytes = archive.finish()?;
    out.write(path, |file| Ok(file.write_all(&bytes)?))
}

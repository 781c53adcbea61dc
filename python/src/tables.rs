//! The available choices, as in `plume list`.

use plume::generators::GENERATORS;
use plume::material::MATERIALS;
use plume::preset::PRESETS;
use plume_exporters::TARGETS;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Targets for `Cave.export` by name, with what each writes.
///
/// >>> " ".join(sorted(plume.targets()))
/// 'assimp:<id> fbx gazebo glb gltf isaac mujoco obj ply stl tiles truth unity unreal urdf usd usdz'
#[pyfunction]
pub fn targets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    table(py, TARGETS.iter().map(|row| (row.usage(), row.summary)))
}

/// Values of `graph.generator`, with how each lays out the passages.
#[pyfunction]
pub fn generators(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    table(py, GENERATORS.iter().map(|row| (row.name, row.summary)))
}

/// Values of `rock.kind`, with a description of each rock.
#[pyfunction]
pub fn materials(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    table(py, MATERIALS.iter().map(|row| (row.name, row.summary)))
}

/// Names for `Recipe.preset`, with a description of each.
#[pyfunction]
pub fn presets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    table(py, PRESETS.iter().map(|row| (row.name, row.summary)))
}

fn table<'py>(
    py: Python<'py>,
    rows: impl Iterator<Item = (impl AsRef<str>, &'static str)>,
) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    rows.into_iter().try_for_each(|(name, summary)| table.set_item(name.as_ref(), summary))?;
    Ok(table)
}

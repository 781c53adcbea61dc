//! Ray as the engine of datasets: `plume.ray` runs the tasks, and what they make is put into place here.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use plume::cave::CaveError;
use plume::store::StoreError;
use plume_cli::RayTasks;
use plume_dataset::{Engine, Plan, Reply, item};
use plume_disk::Staging;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::from_python;

/// Tasks of a Ray cluster.
pub struct Ray(pub RayTasks);

/// What a task made: number, CPU seconds, why it could not be made, its folder.
type Made = (usize, f64, Option<String>, Option<PathBuf>);

impl Engine for Ray {
    fn make(
        &self,
        plan: &Plan,
        numbers: &[usize],
        root: &Path,
        stop: &AtomicBool,
        on_reply: &(dyn Fn(Reply) + Sync),
    ) -> Result<(), CaveError> {
        let staging = Staging::new(&item::work_folder(root)).map_err(|error| StoreError::io(root, error))?;
        Python::attach(|py| {
            let raised = |error: PyErr| from_python(py, &error);
            let tasks = self.start(py, plan, numbers, staging.path()).map_err(raised)?;
            for made in tasks.try_iter().map_err(raised)? {
                if stop.load(Ordering::Relaxed) {
                    // Cancels what is being made.
                    tasks.call_method0("close").map_err(raised)?;
                    return Err(CaveError::Interrupted);
                }
                // Nothing comes every now and then, so that work can be stopped.
                let Some((number, cpu_s, fault, folder)) =
                    made.and_then(|made| made.extract::<Option<Made>>()).map_err(raised)?
                else {
                    continue;
                };
                if let Some(folder) = folder {
                    py.detach(|| item::adopt(root, number, &folder))?;
                }
                on_reply(Reply { item: number, cpu_s, fault, is_final: false });
            }
            Ok(())
        })
    }
}

impl Ray {
    /// The generator of what tasks make.
    fn start<'py>(
        &self,
        py: Python<'py>,
        plan: &Plan,
        numbers: &[usize],
        scratch: &Path,
    ) -> PyResult<Bound<'py, PyAny>> {
        let RayTasks { spec, address, allows_programs, allows_outside_files } = &self.0;
        let keywords = PyDict::new(py);
        keywords.set_item("fingerprint", plan.fingerprint())?;
        keywords.set_item("allow_run", allows_programs)?;
        keywords.set_item("allow_outside", allows_outside_files)?;
        let items = py.import("plume.ray")?.getattr("_items")?;
        items.call((spec, numbers, scratch, address.as_deref()), Some(&keywords))
    }
}

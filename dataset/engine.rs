//! Where the caves of a dataset are made.

use std::io::ErrorKind;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use plume::cave::CaveError;
use plume::pipeline::PipelineError;
use plume::store::StoreError;
use plume_exporters::ExportError;
use serde::{Deserialize, Serialize};

use crate::plan::Plan;

/// Makes caves of a dataset: in processes of this machine, or on a cluster.
pub trait Engine: Sync {
    /// Makes the caves with these numbers in the folder `root`, in any order, and calls `on_reply` once for each.
    ///
    /// # Errors
    /// What would keep all other caves from being made too; [`CaveError::Interrupted`] once `stop` is set.
    fn make(
        &self,
        plan: &Plan,
        numbers: &[usize],
        root: &Path,
        stop: &AtomicBool,
        on_reply: &(dyn Fn(Reply) + Sync),
    ) -> Result<(), CaveError>;
}

/// What came of a cave.
#[derive(Debug, Serialize, Deserialize)]
pub struct Reply {
    /// Its number.
    pub item: usize,
    /// CPU seconds that it took.
    pub cpu_s: f64,
    /// Why it could not be made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// Whether no other can be made either, as the disk is full.
    #[serde(default)]
    pub is_final: bool,
}

impl Reply {
    /// From the CPU seconds that a cave took, or why it could not be made.
    pub fn of(item: usize, result: Result<f64, CaveError>) -> Self {
        match result {
            Ok(cpu_s) => Self { item, cpu_s, fault: None, is_final: false },
            Err(error) => Self { item, cpu_s: 0.0, fault: Some(error.to_string()), is_final: is_final(&error) },
        }
    }
}

/// Whether an error is not that of a cave, so that all others would meet it too.
pub fn is_final(error: &CaveError) -> bool {
    let source = match error {
        CaveError::Interrupted | CaveError::Pipeline(PipelineError::Interrupted) => return true,
        CaveError::Export(ExportError::MissingPart { .. }) => return true,
        CaveError::Pipeline(PipelineError::Store(StoreError::Io { source, .. })) => source,
        CaveError::Export(ExportError::Io(source) | ExportError::Load { source, .. }) => source,
        _ => return false,
    };
    let of_the_disk = [
        ErrorKind::StorageFull,
        ErrorKind::QuotaExceeded,
        ErrorKind::FileTooLarge,
        ErrorKind::ReadOnlyFilesystem,
        ErrorKind::PermissionDenied,
    ];
    of_the_disk.contains(&source.kind())
}

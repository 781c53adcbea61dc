//! From the errors of Plume to the exceptions of `plume.errors`, with the same text and the hint in the words of Python, and back.

use std::io::{self, ErrorKind};
use std::path::Path;

use plume::cave::CaveError;
use plume::pipeline::PipelineError;
use plume::recipe::{Fault, Faults, Origin};
use plume::store::StoreError;
use plume_exporters::ExportError;
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;

use crate::words::in_python;

/// The exception for an error.
pub fn raised(py: Python<'_>, error: &CaveError) -> PyErr {
    match error {
        CaveError::Recipe(faults) => recipe_error(py, faults),
        CaveError::Input { path, source }
        | CaveError::Pipeline(PipelineError::Store(StoreError::Io { path, source })) => {
            file_error(py, error, path, source)
        }
        other => exception(py, class(other), (other.to_string(), in_python(&other.hint()))),
    }
}

/// An exception about an impossible request.
pub fn refused(py: Python<'_>, message: &str, hint: &str) -> PyErr {
    exception(py, "InputError", (message, hint))
}

/// An exception about a bug in Plume.
pub fn internal(py: Python<'_>, message: &str) -> PyErr {
    let hint = "this is a bug in plume: please report it with the recipe";
    exception(py, "PlumeError", (format!("internal error: {message}"), hint))
}

/// The error for an exception that Python code of Plume raised on behalf of the command line.
pub fn from_python(py: Python<'_>, error: &PyErr) -> CaveError {
    let value = error.value(py);
    let is_a = |class: &str| errors(py).and_then(|errors| value.is_instance(&errors.getattr(class)?)).unwrap_or(false);
    let hint = value.getattr("hint").and_then(|hint| hint.extract::<String>()).unwrap_or_default();
    let text = value.to_string();
    let message = text.strip_suffix(&format!("\n hint: {hint}")).unwrap_or(&text).to_owned();
    if is_a("MissingPartError") {
        return ExportError::MissingPart { message, hint }.into();
    }
    match is_a("InputError") {
        true => CaveError::Usage { message, hint },
        false => CaveError::Failed(text),
    }
}

fn class(error: &CaveError) -> &'static str {
    match error {
        CaveError::Export(ExportError::MissingPart { .. }) => "MissingPartError",
        CaveError::Input { .. }
        | CaveError::Pipeline(
            PipelineError::Store(_)
            | PipelineError::OtherCave { .. }
            | PipelineError::OtherPart { .. }
            | PipelineError::EditedGraph { .. }
            | PipelineError::ChangedFiles { .. },
        )
        | CaveError::Export(
            ExportError::NotEmpty { .. }
            | ExportError::NotOurs { .. }
            | ExportError::InTheWay { .. }
            | ExportError::NotAFolder { .. }
            | ExportError::NotAFile { .. }
            | ExportError::FileExists { .. }
            | ExportError::Load { .. }
            | ExportError::Io(_),
        ) => "StorageError",
        CaveError::Usage { .. }
        | CaveError::Pipeline(
            PipelineError::Generate(_)
            | PipelineError::GraphFile(_)
            | PipelineError::Grid(_)
            | PipelineError::Map { .. }
            | PipelineError::Model { .. }
            | PipelineError::TooLarge { .. }
            | PipelineError::Empty,
        )
        | CaveError::Export(
            ExportError::UnknownTarget { .. } | ExportError::Settings { .. } | ExportError::TooLarge { .. },
        ) => "InputError",
        _ => "PlumeError",
    }
}

/// An exception about a file that the system refuses.
fn file_error(py: Python<'_>, error: &CaveError, path: &Path, source: &io::Error) -> PyErr {
    let class = match source.kind() {
        ErrorKind::NotFound => "MissingFileError",
        _ => "StorageError",
    };
    exception(py, class, (error.to_string(), in_python(&error.hint()), errno(py, source.kind()), path))
}

/// The number that Python has for this kind of error. That of the system is another on Windows.
fn errno(py: Python<'_>, kind: ErrorKind) -> Option<i32> {
    let name = match kind {
        ErrorKind::NotFound => "ENOENT",
        ErrorKind::PermissionDenied => "EACCES",
        ErrorKind::StorageFull => "ENOSPC",
        ErrorKind::NotADirectory => "ENOTDIR",
        ErrorKind::IsADirectory => "EISDIR",
        _ => return None,
    };
    py.import("errno").and_then(|errno| errno.getattr(name)?.extract()).ok()
}

fn recipe_error(py: Python<'_>, faults: &Faults) -> PyErr {
    let faults = &Faults { told: faults.told.iter().map(with_hint_in_python).collect(), more: faults.more };
    let told = faults.told.iter().map(|fault| told(py, fault)).collect::<PyResult<Vec<_>>>();
    match told {
        Ok(told) => exception(py, "RecipeError", (faults.to_string(), told)),
        Err(error) => error,
    }
}

fn with_hint_in_python(fault: &Fault) -> Fault {
    Fault { hint: in_python(&fault.hint), ..fault.clone() }
}

fn told<'py>(py: Python<'py>, fault: &Fault) -> PyResult<Bound<'py, PyAny>> {
    let line = match &fault.origin {
        Origin::Line(_, line) => Some(*line),
        _ => None,
    };
    let origin = match &fault.origin {
        Origin::Line(file, _) | Origin::File(file) => file.display().to_string(),
        Origin::Override(pair) => pair.clone(),
    };
    errors(py)?.getattr("Fault")?.call1((origin, line, &fault.message, &fault.hint))
}

fn exception<'py>(py: Python<'py>, class: &str, arguments: impl PyCallArgs<'py>) -> PyErr {
    let made = errors(py).and_then(|errors| errors.getattr(class)?.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

fn errors(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("plume.errors")
}

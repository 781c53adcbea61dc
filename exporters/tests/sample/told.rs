//! What a user is told.

use plume_exporters::ExportError;

/// The error and its hint, and whether the user or the machine is to mend it.
pub fn told(error: &ExportError) -> String {
    let kind = if error.is_usage() { "usage" } else { "system" };
    let hint = error.hint().map(|hint| format!(" (hint: {hint})")).unwrap_or_default();
    format!("{kind}: {error}{hint}")
}

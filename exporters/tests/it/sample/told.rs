//! Error messages as users see them.

use plume_exporters::ExportError;

/// The error with its hint, and whether it is a usage or a system error.
pub fn told(error: &ExportError) -> String {
    let kind = if error.is_usage() { "usage" } else { "system" };
    let hint = error.hint().map(|hint| format!(" (hint: {hint})")).unwrap_or_default();
    format!("{kind}: {error}{hint}")
}

//! Files in zips.

use zip::write::SimpleFileOptions;

/// What every file of a zip has: no time, so that the same content gives the same bytes, and the rights of any other file.
pub(crate) fn options() -> SimpleFileOptions {
    SimpleFileOptions::default().last_modified_time(zip::DateTime::default()).unix_permissions(0o644)
}

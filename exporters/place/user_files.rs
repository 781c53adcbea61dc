//! Files that users put into the folder of a package.

use std::fs::{self, FileType};
use std::io::{self, ErrorKind};
use std::path::Path;

use crate::error::{ExportError, at};
use crate::package::{Files, MANIFEST};

/// Hard-links everything in the package folder `old` that is not its `own` into `new`, so that it survives whichever of the
/// two is removed.
///
/// # Errors
/// [`ExportError::InTheWay`] if `new` has that name already; if the disk fails.
pub fn carry_over(old: &Path, own: &Files, new: &Path) -> Result<(), ExportError> {
    carry_over_below(old, Some(""), own, new)
}

/// `above` is the path of `old` in the package, empty or with a trailing slash; `None` if it is not UTF-8 and so cannot be
/// in a manifest.
fn carry_over_below(old: &Path, above: Option<&str>, own: &Files, new: &Path) -> Result<(), ExportError> {
    let named = |error: io::Error| at(old.display(), &error);
    for entry in fs::read_dir(old).map_err(named)? {
        let entry = entry.map_err(named)?;
        let kind = entry.file_type().map_err(named)?;
        let (from, to, name) = (entry.path(), new.join(entry.file_name()), entry.file_name());
        let path = above.zip(name.to_str()).map(|(above, name)| format!("{above}{name}"));
        if kind.is_dir() {
            let below = path.map(|path| path + "/");
            if !below.as_ref().is_some_and(|below| own.0.keys().any(|file| file.starts_with(below))) {
                fs::create_dir_all(&to).map_err(|error| in_the_way(&from, &error))?;
            }
            carry_over_below(&from, below.as_deref(), own, &to)?;
        } else if !path.is_some_and(|path| path == MANIFEST || own.0.contains_key(&path)) {
            fs::create_dir_all(new).map_err(|error| in_the_way(&from, &error))?;
            name_again(&from, &to, kind).map_err(|error| in_the_way(&from, &error))?;
        }
    }
    Ok(())
}

fn name_again(from: &Path, to: &Path, kind: FileType) -> io::Result<()> {
    if to.symlink_metadata().is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    match fs::hard_link(from, to) {
        Err(_) if kind.is_file() => fs::copy(from, to).map(drop),
        linked => linked,
    }
}

fn in_the_way(path: &Path, error: &io::Error) -> ExportError {
    match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => ExportError::InTheWay { path: path.to_owned() },
        _ => at(path.display(), error).into(),
    }
}

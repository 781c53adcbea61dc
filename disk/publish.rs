//! Renames finished files and folders into place.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Renames a finished file or folder into place, unless something else is there by now; a folder may replace an empty one.
/// The content is synced before the name.
///
/// # Errors
/// [`ErrorKind::AlreadyExists`] or [`ErrorKind::DirectoryNotEmpty`] if the name is taken; I/O errors.
pub fn publish(from: &Path, to: &Path) -> io::Result<()> {
    sync_tree(from)?;
    if from.is_dir() {
        // Fails for anything but an empty folder, so it checks and renames in one step.
        publish_folder(from, to)?;
    } else {
        publish_file(from, to)?;
    }
    sync_parent(to)
}

/// Renames a finished file into place; replaces a file or link of that name.
///
/// # Errors
/// I/O errors.
pub fn replace_file(from: &Path, to: &Path) -> io::Result<()> {
    File::open(from)?.sync_all()?;
    fs::rename(from, to)?;
    sync_parent(to)
}

#[cfg(unix)]
fn publish_folder(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)
}

/// On other systems no folder replaces another.
#[cfg(not(unix))]
fn publish_folder(from: &Path, to: &Path) -> io::Result<()> {
    match fs::remove_dir(to) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => fs::rename(from, to),
    }
}

/// A hard link never replaces anything, and works on every system that has them. Where a file system has none, an empty
/// file claims the name first.
fn publish_file(from: &Path, to: &Path) -> io::Result<()> {
    match fs::hard_link(from, to) {
        Ok(()) => fs::remove_file(from),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => Err(error),
        Err(_) => {
            File::create_new(to)?;
            fs::rename(from, to)
        }
    }
}

/// Swaps two names atomically, where the system and the file system can.
///
/// # Errors
/// [`ErrorKind::Unsupported`] where they cannot; I/O errors.
#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
pub(crate) fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    use rustix::io::Errno;
    match renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE) {
        Err(Errno::INVAL | Errno::NOSYS | Errno::NOTSUP) => Err(ErrorKind::Unsupported.into()),
        result => Ok(result?),
    }
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
pub(crate) fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}

/// Syncs everything below `path` to the disk.
pub(crate) fn sync_tree(path: &Path) -> io::Result<()> {
    let kind = path.symlink_metadata()?.file_type();
    if kind.is_file() {
        return File::open(path)?.sync_all();
    }
    if kind.is_dir() {
        for entry in fs::read_dir(path)? {
            sync_tree(&entry?.path())?;
        }
        return sync_folder(path);
    }
    Ok(())
}

/// Syncs the names in the parent folder, where the system supports it.
///
/// # Errors
/// I/O errors.
pub fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(path)?.sync_all() } else { Ok(()) }
}

pub(crate) fn sync_parent(path: &Path) -> io::Result<()> {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => sync_folder(parent),
        _ => sync_folder(Path::new(".")),
    }
}

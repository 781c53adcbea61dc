//! Giving finished files and folders their names.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Gives a finished file or folder its name, unless something has that name by now; an empty folder gives way to a folder.
/// The content is on the disk before the name is.
///
/// # Errors
/// [`ErrorKind::AlreadyExists`] or [`ErrorKind::DirectoryNotEmpty`] when the name is taken; those of the system.
pub fn publish(from: &Path, to: &Path) -> io::Result<()> {
    sync_tree(from)?;
    if from.is_dir() {
        // Fails for anything but an empty folder, and so asks and renames in one step.
        publish_folder(from, to)?;
    } else {
        publish_file(from, to)?;
    }
    sync_parent(to)
}

/// Gives a finished file its name; a file or link that has it goes.
///
/// # Errors
/// Those of the system.
pub fn replace_file(from: &Path, to: &Path) -> io::Result<()> {
    File::open(from)?.sync_all()?;
    fs::rename(from, to)?;
    sync_parent(to)
}

#[cfg(unix)]
fn publish_folder(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)
}

/// Elsewhere no folder gives way to another.
#[cfg(not(unix))]
fn publish_folder(from: &Path, to: &Path) -> io::Result<()> {
    match fs::remove_dir(to) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => fs::rename(from, to),
    }
}

/// A second name refuses to take the place of anything, and works on every system that has such names. Where a file system
/// has none, the name is claimed by an empty file first.
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

/// Swaps two names in one step, where the system and the file system can.
///
/// # Errors
/// [`ErrorKind::Unsupported`] where they cannot; those of the system.
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

/// Waits until everything below `path` is on the disk.
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

/// Waits until the names in a folder are on the disk, where the system can tell.
///
/// # Errors
/// Those of the system.
pub fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(path)?.sync_all() } else { Ok(()) }
}

pub(crate) fn sync_parent(path: &Path) -> io::Result<()> {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => sync_folder(parent),
        _ => sync_folder(Path::new(".")),
    }
}

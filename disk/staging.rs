//! Hidden folders in which output is written until it is complete.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::publish;

/// Prefix of the names of staging folders; random letters follow.
const PREFIX: &str = ".plume-";
const RANDOM_LETTERS: usize = 8;
/// The file that marks a staging folder. It is locked while the folder is in use.
const MARKER: &str = "plume-staging";
const MARKER_TEXT: &[u8] = b"Plume is writing a file or folder next to this one, or was until it was killed.\n\
    The next run removes this folder; you may remove it yourself when Plume is not running.\n";
/// Where a folder that is being replaced is kept, under its own name, on systems that cannot swap two names.
const REPLACED: &str = "replaced";
/// How many times another run may sweep a folder away while it is being marked.
const ATTEMPTS: usize = 16;

/// A hidden folder of this process next to the path that is written to. Removed with its contents when dropped.
#[derive(Debug)]
pub struct Staging {
    path: PathBuf,
    marker: Option<File>,
}

impl Staging {
    /// Makes a staging folder in `parent`, creating parent folders, and [sweeps](sweep) there.
    ///
    /// # Errors
    /// I/O errors.
    pub fn new(parent: &Path) -> io::Result<Self> {
        fs::create_dir_all(parent)?;
        sweep(parent);
        for _ in 0..ATTEMPTS {
            let folder = tempfile::Builder::new().prefix(PREFIX).rand_bytes(RANDOM_LETTERS).tempdir_in(parent)?;
            if let Some(marker) = mark(folder.path())? {
                return Ok(Self { path: folder.keep(), marker: Some(marker) });
            }
        }
        Err(io::Error::other("other runs keep removing the staging folder"))
    }

    /// Makes a staging folder next to `place`.
    ///
    /// # Errors
    /// I/O errors.
    pub fn beside(place: &Path) -> io::Result<Self> {
        Self::new(folder_of(place))
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Waits for other runs that hold this lock of the folder in which this one is, and keeps them from having it until the
    /// result is dropped: for work that depends on what is next to this folder. Nothing where folders cannot be locked.
    pub fn lock_parent(&self) -> Option<File> {
        let parent = File::open(folder_of(&self.path)).ok()?;
        parent.lock().is_ok().then_some(parent)
    }

    /// Replaces the folder `to` with the folder `name` from here. Returns the path at which the old folder, if there was
    /// one, is kept until this staging folder is removed. A kill leaves the old or the new one in place, or, where the
    /// system cannot swap, the old one here until the next run puts it back.
    ///
    /// # Errors
    /// I/O errors; the old folder is then in its place.
    pub fn swap(&self, name: &str, to: &Path) -> io::Result<Option<PathBuf>> {
        let from = self.path.join(name);
        if to.symlink_metadata().is_err() {
            publish::publish(&from, to)?;
            return Ok(None);
        }
        publish::sync_tree(&from)?;
        let old = match publish::exchange(&from, to) {
            Ok(()) => from,
            Err(error) if error.kind() == ErrorKind::Unsupported => self.swap_in_two_steps(&from, to)?,
            Err(error) => return Err(error),
        };
        publish::sync_parent(to)?;
        Ok(Some(old))
    }

    fn swap_in_two_steps(&self, from: &Path, to: &Path) -> io::Result<PathBuf> {
        let waiting = self.path.join(REPLACED);
        fs::create_dir_all(&waiting)?;
        let old = waiting.join(to.file_name().ok_or(ErrorKind::InvalidInput)?);
        fs::rename(to, &old)?;
        fs::rename(from, to).inspect_err(|_| {
            // The first error is the one to report; what cannot be put back now is put back by the next run.
            let _ = fs::rename(&old, to);
        })?;
        Ok(old)
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        put_back(&self.path);
        // Some systems cannot remove open files. If another run sweeps now, that does no harm.
        self.marker = None;
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Removes the staging folders in `parent` left by killed processes, and nothing else: a folder must have the name and the
/// marker of one, and no process may hold its lock. What cannot be removed stays.
pub fn sweep(parent: &Path) {
    let Ok(entries) = fs::read_dir(parent) else { return };
    for entry in entries.flatten() {
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_folder && entry.file_name().to_str().is_some_and(is_name) {
            remove_if_abandoned(&entry.path());
        }
    }
}

/// [Sweeps](sweep) the folder that contains `place`.
pub fn sweep_beside(place: &Path) {
    sweep(folder_of(place));
}

fn is_name(name: &str) -> bool {
    name.strip_prefix(PREFIX).is_some_and(|letters| {
        letters.len() == RANDOM_LETTERS && letters.bytes().all(|letter| letter.is_ascii_alphanumeric())
    })
}

fn remove_if_abandoned(folder: &Path) {
    match crate::regular::open_no_follow(&folder.join(MARKER)) {
        Ok(marker) => {
            // Without the lock the folder cannot be known to be abandoned, so it stays.
            if marker.try_lock().is_ok() {
                put_back(folder);
                // Still locked: a run that is marking this folder now must not take it for its own.
                let _ = fs::remove_dir_all(folder);
            }
        }
        // Its process was killed before marking it; this removes empty folders only.
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let _ = fs::remove_dir(folder);
        }
        Err(_) => {}
    }
}

/// Restores a folder if a kill came before its replacement was in place.
fn put_back(staging: &Path) {
    let Some(parent) = staging.parent() else { return };
    for entry in fs::read_dir(staging.join(REPLACED)).into_iter().flatten().flatten() {
        let place = parent.join(entry.file_name());
        if place.symlink_metadata().is_err() {
            let _ = fs::rename(entry.path(), place);
        }
    }
}

/// Marks a staging folder and locks the marker; `None` if another run has swept it away in the meantime.
fn mark(folder: &Path) -> io::Result<Option<File>> {
    let path = folder.join(MARKER);
    let mut marker = match File::create_new(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        made => made?,
    };
    // Where locks are not supported, no run sweeps.
    if let Err(TryLockError::WouldBlock) = marker.try_lock() {
        return Ok(None);
    }
    if path.symlink_metadata().is_err() {
        return Ok(None);
    }
    marker.write_all(MARKER_TEXT)?;
    Ok(Some(marker))
}

fn folder_of(place: &Path) -> &Path {
    match place.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = entries.collect();
        names.sort();
        names
    }

    /// A staging folder whose owner was killed.
    fn abandoned(parent: &Path) -> PathBuf {
        let staging = Staging::new(parent).unwrap();
        let path = parent.join(".plume-00000000");
        fs::rename(staging.path(), &path).unwrap();
        path
    }

    #[test]
    fn a_staging_folder_is_removed_with_its_owner() {
        let parent = tempfile::tempdir().unwrap();
        let staging = Staging::new(parent.path()).unwrap();
        fs::write(staging.path().join("half"), "h").unwrap();
        assert_eq!(names(parent.path()).len(), 1);
        drop(staging);
        assert!(names(parent.path()).is_empty());
    }

    #[test]
    fn only_marked_and_abandoned_folders_are_swept() {
        let parent = tempfile::tempdir().unwrap();
        let staging = Staging::new(parent.path()).unwrap();
        let own = staging.path().file_name().unwrap().to_str().unwrap().to_owned();
        abandoned(parent.path());
        for name in [".plume-notes", ".plume-AbCdEfGh", ".plume-AbCdEfGh2", "plume-AbCdEfGh"] {
            fs::create_dir(parent.path().join(name)).unwrap();
            fs::write(parent.path().join(name).join("thesis.txt"), "x").unwrap();
        }
        fs::create_dir(parent.path().join(".plume-unmarked")).unwrap();
        sweep(parent.path());
        let mut kept = [own.as_str(), ".plume-AbCdEfGh", ".plume-AbCdEfGh2", ".plume-notes", "plume-AbCdEfGh"];
        kept.sort_unstable();
        assert_eq!(names(parent.path()), kept);
    }

    #[cfg(unix)]
    #[test]
    fn a_linked_folder_is_not_swept() {
        let [parent, home] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        fs::write(home.path().join(MARKER), "planted").unwrap();
        std::os::unix::fs::symlink(home.path(), parent.path().join(".plume-AbCdEfGh")).unwrap();
        sweep(parent.path());
        assert_eq!(names(home.path()), [MARKER]);
    }

    #[test]
    fn folders_swap_names() {
        let parent = tempfile::tempdir().unwrap();
        let place = parent.path().join("cave");
        for text in ["old", "new"] {
            let staging = Staging::beside(&place).unwrap();
            fs::create_dir(staging.path().join("package")).unwrap();
            fs::write(staging.path().join("package/text"), text).unwrap();
            let old = staging.swap("package", &place).unwrap();
            assert_eq!(old.is_some(), text == "new");
        }
        assert_eq!(fs::read_to_string(place.join("text")).unwrap(), "new");
        assert_eq!(names(parent.path()), ["cave"]);
    }

    #[test]
    fn a_swap_in_two_steps_has_the_same_result() {
        let parent = tempfile::tempdir().unwrap();
        let place = parent.path().join("cave");
        fs::create_dir(&place).unwrap();
        let staging = Staging::beside(&place).unwrap();
        let package = staging.path().join("package");
        assert!(staging.swap_in_two_steps(&package, &place).is_err() && place.is_dir());
        fs::create_dir(&package).unwrap();
        fs::write(package.join("text"), "new").unwrap();
        let old = staging.swap_in_two_steps(&package, &place).unwrap();
        assert!(old.is_dir() && place.join("text").is_file());
    }

    #[test]
    fn the_next_run_recovers_from_a_kill_between_the_two_steps() {
        let parent = tempfile::tempdir().unwrap();
        let staging = abandoned(parent.path());
        fs::create_dir_all(staging.join(REPLACED).join("cave")).unwrap();
        fs::write(staging.join(REPLACED).join("cave/text"), "old").unwrap();
        sweep(parent.path());
        assert_eq!(names(parent.path()), ["cave"]);
        assert_eq!(fs::read_to_string(parent.path().join("cave/text")).unwrap(), "old");
    }

    #[test]
    fn concurrent_runs_do_not_sweep_each_other() {
        let parent = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let staging = Staging::new(parent.path()).unwrap();
                        fs::write(staging.path().join("half"), "h").unwrap();
                        assert!(staging.path().join("half").exists());
                    }
                });
            }
        });
        assert!(names(parent.path()).is_empty());
    }
}

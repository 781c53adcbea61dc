//! Reads regular files and nothing else.
//!
//! A pipe without a writer blocks whoever opens it, and a device such as `/dev/zero` never ends. Neither is what a user
//! means by a recipe, a survey or a package.
//!
//! ```
//! use plume_disk::regular;
//!
//! let folder = tempfile::tempdir()?;
//! assert!(regular::open(folder.path()).is_err(), "a folder is not a regular file");
//! assert!(regular::read("/dev/zero".as_ref(), 1 << 20).is_err());
//! # Ok::<(), std::io::Error>(())
//! ```

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Opens a regular file for reading, without blocking.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] for a pipe, a socket or a device, [`ErrorKind::IsADirectory`] for a folder; I/O errors.
pub fn open(path: &Path) -> io::Result<File> {
    only_regular(options(Links::Follow).open(path)?)
}

/// Opens a regular file for reading, unless its name is a symbolic link.
///
/// # Errors
/// As [`open`]; [`ErrorKind::InvalidInput`] for a link.
pub fn open_no_follow(path: &Path) -> io::Result<File> {
    if path.symlink_metadata()?.is_symlink() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "is a symbolic link"));
    }
    only_regular(options(Links::Refuse).open(path)?)
}

/// Opens a regular file for appending and creates it if it is missing; never through a symbolic link.
///
/// # Errors
/// As [`open_no_follow`].
pub fn append_no_follow(path: &Path) -> io::Result<File> {
    if path.symlink_metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return Err(io::Error::new(ErrorKind::InvalidInput, "is not a regular file"));
    }
    only_regular(options(Links::Refuse).read(false).append(true).create(true).open(path)?)
}

/// The content of a regular file of at most `most_bytes`.
///
/// # Errors
/// As [`open`]; [`ErrorKind::FileTooLarge`].
pub fn read(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    read_at_most(open(path)?, most_bytes)
}

/// The content of an open file of at most `most_bytes`.
///
/// # Errors
/// [`ErrorKind::FileTooLarge`]; I/O errors.
pub fn read_at_most(file: File, most_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(most_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        return Err(io::Error::new(ErrorKind::FileTooLarge, format!("is larger than {}", in_words(most_bytes))));
    }
    Ok(bytes)
}

fn in_words(bytes: u64) -> String {
    match bytes {
        bytes if bytes >> 30 << 30 == bytes && bytes > 0 => format!("{} GiB", bytes >> 30),
        bytes if bytes >> 20 << 20 == bytes && bytes > 0 => format!("{} MiB", bytes >> 20),
        bytes => format!("{bytes} bytes"),
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Links {
    Follow,
    Refuse,
}

/// The flag matters for pipes only: opening one would wait for a writer.
fn options(links: Links) -> OpenOptions {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;

        use rustix::fs::OFlags;
        let no_follow = if links == Links::Refuse { OFlags::NOFOLLOW } else { OFlags::empty() };
        options.custom_flags((OFlags::NONBLOCK | no_follow).bits() as i32);
    }
    #[cfg(not(unix))]
    let _ = links;
    options
}

fn only_regular(file: File) -> io::Result<File> {
    let kind = file.metadata()?.file_type();
    if kind.is_file() {
        return Ok(file);
    }
    if kind.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    Err(io::Error::new(ErrorKind::InvalidInput, "is a pipe, a socket or a device, not a regular file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, [7; 10]).unwrap();
        assert_eq!(read(&path, 10).unwrap(), [7; 10]);
        let error = read(&path, 9).unwrap_err();
        assert_eq!((error.kind(), error.to_string().as_str()), (ErrorKind::FileTooLarge, "is larger than 9 bytes"));
        assert_eq!(read(folder.path(), 9).unwrap_err().kind(), ErrorKind::IsADirectory);
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_and_a_device_are_refused_without_blocking() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        assert_eq!(open(&pipe).unwrap_err().kind(), ErrorKind::InvalidInput);
        assert_eq!(read(Path::new("/dev/zero"), 9).unwrap_err().kind(), ErrorKind::InvalidInput);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_only_where_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.path().join(name));
        std::fs::write(&file, "text").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert_eq!(read(&link, 9).unwrap(), b"text");
        assert_eq!(open_no_follow(&link).unwrap_err().to_string(), "is a symbolic link");
        assert!(open_no_follow(&file).is_ok());
    }
}

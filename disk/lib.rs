//! Files and folders that appear whole or not at all.
//!
//! Everything that Plume writes to a path chosen by the user goes through a [`Staging`] folder next to that path and is
//! renamed once it is complete and synced. [`regular`] opens files named by the user for reading.
//!
//! Promised: a process that is killed at any moment, or a machine that loses power, leaves the old content, the new
//! content or nothing at the path, and at most a marked hidden folder next to it, which the next run removes. Nothing
//! unmarked is removed, except empty folders with such a name. A link planted under the name of a temporary file is never
//! followed, because those names are random and created exclusively.
//!
//! Not promised: anything against a malicious program that changes the same folders at the same time.
//!
//! ```
//! use plume_disk::{Existing, write_file};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("plans/cave.txt");
//! write_file(&path, Existing::Keep, b"first")?;
//! assert!(write_file(&path, Existing::Keep, b"second").is_err());
//! assert_eq!(std::fs::read(&path)?, b"first");
//! # Ok::<(), std::io::Error>(())
//! ```

mod device;
mod file;
mod publish;
pub mod regular;
pub mod sealed;
mod staging;

pub use self::device::is_device_name;
pub use self::file::{Existing, write_file};
pub use self::publish::{publish, replace_file, sync_folder};
pub use self::staging::{Staging, sweep, sweep_beside};

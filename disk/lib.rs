//! Files and folders that appear whole or not at all.
//!
//! Everything that Plume writes where a user has named a place goes through a [`Staging`] folder beside that place and is
//! renamed once it is complete and on the disk. [`regular`] opens what a user has named for reading.
//!
//! Promised: a process that is killed at any moment, or a machine that loses power, leaves the old content, the new
//! content or nothing at the place, and at most a marked hidden folder beside it, which the next run removes. Nothing
//! that is not marked is removed, but for empty folders of just such a name. A link planted under the name of a temporary file is never followed, because those names
//! are random and created exclusively.
//!
//! Not promised: anything against a program that changes the same folders at the same time and means harm.

mod file;
mod publish;
pub mod regular;
pub mod sealed;
mod staging;

pub use self::file::{Existing, write_file};
pub use self::publish::{publish, replace_file, sync_folder};
pub use self::staging::{Staging, sweep, sweep_beside};

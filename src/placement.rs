//! Start poses and lamps.
//!
//! Everything here uses the field, not the mesh, so it holds for every level of detail within its error.

mod column;
mod lamps;
mod spawn;

pub use self::lamps::{Lamp, lamps};
pub use self::spawn::{Spawn, spawns};

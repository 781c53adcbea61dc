//! What a robot should find: places to start, and light to see by.
//!
//! Everything here asks the field, not the mesh, so it holds for every level of detail to within the error that level
//! states.

mod column;
mod lamps;
mod spawn;

pub use self::lamps::{Lamp, lamps};
pub use self::spawn::{Spawn, spawns};

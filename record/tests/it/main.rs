//! The laws of recordings, in a room whose measures are known.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod cameras;
mod images;
mod lidars;
mod room;
mod runs;

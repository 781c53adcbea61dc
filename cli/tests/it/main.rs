//! The integration tests of the command line.
//!
//! One program, because every further one would be linked and would wait for its slowest test alone.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod cave_folder;
mod certify;
mod chunk;
mod cli;
mod command;
mod dataset;
mod external;
mod graphs;
mod handover;
mod measure;
mod models;
mod new;
mod nothing_lost;
mod options;
mod own_maps;
mod record;

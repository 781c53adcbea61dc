//! The attacks.

mod damage;
mod datasets;
mod failing_disk;
mod fuzz;
mod hostile_folder;
mod kept_folders;
mod kills;
mod machine;
mod memory;
mod neighbours;
mod races;
mod recipes;
mod signals;
mod stops;
mod streams;
mod supply;

use crate::attack::Attack;

/// Every attack.
pub const ATTACKS: &[Attack] = &[
    hostile_folder::ATTACK,
    neighbours::ATTACK,
    races::ATTACK,
    stops::ATTACK,
    kills::ATTACK,
    datasets::ATTACK,
    failing_disk::ATTACK,
    damage::ATTACK,
    kept_folders::ATTACK,
    streams::ATTACK,
    signals::ATTACK,
    recipes::ATTACK,
    machine::ATTACK,
    memory::ATTACK,
    fuzz::ATTACK,
    supply::ATTACK,
];

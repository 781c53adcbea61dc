//! Things that lie, stand and hang in a cave: stones, dripstone, the equipment of mines, and models of the user.
//!
//! A [`KindRow`] says what a thing looks like, how large it is and where it occurs. Its shapes are meshed once, all together
//! on one [`Shelf`], into a [`Library`] of prototypes that share a set of images. [`place()`] then finds the things of a
//! chunk: each is a prototype, a size and a pose. [`strew()`] finds its gravel, which is only drawn.
//!
//! Promised: a chunk's things follow from the walls of the chunk and its neighbours, the field and the graph, in any order
//! and on any number of threads. Stones rest on the triangles of the wall, or on larger stones, with their centre of mass
//! between three supports. Stalagmites stand exactly below their stalactites. Nothing higher than [`ThingSettings::step_m`] stands in the
//! corridor. Not promised: the same things for other sizes of chunks, whose triangles differ by millimetres.

mod along;
mod around;
mod artefact;
mod catalogue;
mod corridor;
mod dressed;
mod drip;
mod dripstone;
mod equipment;
mod facets;
mod gravel;
mod halls;
mod kind;
mod library;
mod lost;
mod lots;
mod place;
mod plane;
mod replica;
mod rest;
mod roof;
mod run;
mod scatter;
mod settings;
mod shelf;
mod solid;
mod stone;
mod substance;

pub use around::place_in;
pub use catalogue::KINDS;
pub use dressed::Dressed;
pub use gravel::strew;
pub use kind::{Along, Fit, Hang, Heading, KindRow, Kinds, Place, Scatter, Shape, Shapes};
pub use library::{Body, Library, Prototype};
pub use place::{Setting, place};
pub use replica::Replica;
pub use settings::{FileSettings, KEPT, ThingSettings};
pub use solid::Solid;
pub use substance::Substance;

pub use shelf::{Dress, Shelf};

use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};

/// A thing in a cave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thing {
    /// Its identity, which does not depend on the other things.
    pub id: u64,
    /// Its [`KindRow::name`].
    pub kind: String,
    /// The [name](Prototype::name) of its prototype.
    pub prototype: String,
    /// Its size relative to the prototype.
    pub scale: f64,
    /// From the frame of the prototype to that of the cave.
    pub pose: Isometry3<f64>,
    /// How deep it was sunk into what it rests on, in metres.
    pub embedding_m: f64,
}

//! Datasets: many caves from one specification.
//!
//! A [`Spec`] says which keys of a recipe vary, how, and over which seeds. From a [`Plan`] follows each
//! cave by its number. [`item::make`] makes a cave in a folder of its own, wherever and whenever. [`run`] has an [`Engine`] make
//! all of them, such as [processes of this machine](local), and writes index, data card, contact sheet and sums. [`check`] compares
//! a dataset with them.
//!
//! Promised: the same specification and version give the same bytes, for any number of workers, in any order, after any kills; all caves
//! of a seed are in one part, and no two parts have a cave of the same layout. Not promised: that every cave can be made. Those that
//! cannot are left out and listed.

mod card;
mod check;
mod curve;
mod draw;
mod engine;
mod finish;
mod folder;
mod index;
pub mod item;
pub mod local;
mod measures;
mod plan;
mod run;
mod sheet;
mod spec;

pub use self::check::{Report, check, is_dataset};
pub use self::curve::{Knob, Law, Task};
pub use self::draw::{Draw, Vary};
pub use self::engine::{Engine, Reply, is_final};
pub use self::finish::Outcome;
pub use self::index::Failure;
pub use self::measures::Measures;
pub use self::plan::{Item, Plan};
pub use self::run::{Watch, run};
pub use self::spec::{Part, Shares, Spec};

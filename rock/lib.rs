//! The walls of underground worlds as fields: how far is rock, and what does it look like?
//!
//! A [`CaveField`](field::CaveField) takes the passages of a graph and roughens them by a [`Material`](material::Material), whose
//! formulas are written in vectorised [`noise`]. All of it is compiled for several widths of vectors, and inlined into a few large
//! functions, which is why it is a crate of its own: what is above it can be compiled without compiling this again.

pub mod field;
pub mod material;
pub mod noise;

#[doc(hidden)]
pub mod picture;
#[doc(hidden)]
pub mod srgb;

#[doc(hidden)]
pub use fearless_simd;

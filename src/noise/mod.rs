//! Noise over space, in lanes.
//!
//! Every primitive is written once over [`Real`] and used twice: with [`Value`] it gives the value alone, with [`Jet`]
//! the value and its exact gradient (forward-mode dual numbers). Lanes are as wide as the machine's own vectors, chosen
//! at run time by `fearless_simd`; since only `+ - * / sqrt floor` and integers are used and nothing is contracted, the
//! bits are the same on every width.
//!
//! Promised: values are functions of the point and the salt alone. Not promised: precision beyond about 10 km from the
//! origin, where `f32` no longer resolves the finest grain.

mod cellular;
mod gradient;
mod lane;

pub use cellular::{Cell2, Cell3, cells_2d, cells_3d, facets};
pub use gradient::Source;
pub use lane::{Ints, Jet, Lanes, Mask, Real, Value, Vec3, mix, soft_max, soft_min, vec3};

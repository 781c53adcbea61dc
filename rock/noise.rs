//! Noise in space, in vector lanes.
//!
//! Every primitive is written once over [`Real`] and used twice: with [`Value`] it gives the value alone, with [`Jet`] the
//! value and its exact gradient (forward-mode dual numbers). The vector width is chosen at run time by `fearless_simd`;
//! since only `+ - * / sqrt floor` and integers are used, without contraction, the bits are the same for every width.
//!
//! Promised: values are functions of the point and the salt alone. Not promised: precision beyond about 10 km from the
//! origin, where `f32` no longer resolves the finest grain.
//!
//! ```
//! use plume_rock::noise::{Real, Simd, Source, Vec3};
//!
//! /// Hills of 2 m with a wavelength of 10 m: as values, or as values with gradients.
//! fn hills<S: Simd, T: Real<S>>(source: Source, at: Vec3<T>) -> T {
//!     source.noise(0, at.scaled(0.1)) * 2.0
//! }
//! ```

/// A closure that is inlined into its caller: otherwise it would be compiled without the caller's vector instructions.
macro_rules! inlined {
    ($($closure:tt)*) => {
        std::convert::identity(#[inline(always)] $($closure)*)
    };
}
pub(crate) use inlined;

/// Evaluates an expression with the vectors of [`level`]. Only widths worth their compile time are instantiated.
#[doc(hidden)]
#[macro_export]
macro_rules! dispatched {
    ($simd:ident => $expression:expr) => {{
        let level = $crate::noise::level();
        #[cfg(target_arch = "x86_64")]
        if let Some($simd) = level.as_avx512() {
            $crate::fearless_simd::Simd::vectorize($simd, #[inline(always)] || $expression)
        } else if let Some($simd) = level.as_avx2() {
            $crate::fearless_simd::Simd::vectorize($simd, #[inline(always)] || $expression)
        } else {
            let $simd = level.as_sse2().expect("part of every x86-64");
            $crate::fearless_simd::Simd::vectorize($simd, #[inline(always)] || $expression)
        }
        #[cfg(not(target_arch = "x86_64"))]
        $crate::fearless_simd::dispatch!(level, $simd => $expression)
    }};
}
pub use dispatched;

mod cellular;
mod gradient;
mod lane;
mod vector;

use std::cell::Cell;

use fearless_simd::Level;
pub use fearless_simd::Simd;

pub use cellular::{Cell2, Cell3, cells_2d, cells_3d, facets, hollows};
pub use gradient::{LACUNARITY, Source};
#[doc(hidden)]
pub use lane::smooth_step;
pub use lane::{Ints, Jet, Lanes, Mask, Real, Value};
pub use vector::{Vec3, mix, soft_max, soft_min, vec3};

thread_local! {
    static CHOSEN_LEVEL: Cell<Option<Level>> = const { Cell::new(None) };
}

/// The widest vectors of this machine, or those that [`with_level`] has chosen.
#[doc(hidden)]
pub fn level() -> Level {
    CHOSEN_LEVEL.get().unwrap_or_else(Level::new)
}

/// Runs something on this thread with the vectors of another machine.
#[doc(hidden)]
pub fn with_level<T>(level: Level, run: impl FnOnce() -> T) -> T {
    let before = CHOSEN_LEVEL.replace(Some(level));
    let result = run();
    CHOSEN_LEVEL.set(before);
    result
}

#[cfg(test)]
mod laws;

//! Numbers in vector lanes: plain values, and values with their gradient.

use super::vector::Vec3;
use fearless_simd::prelude::*;
use fearless_simd::{Select, Simd};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The machine's own vector of `f32`.
pub type Lanes<S> = <S as Simd>::f32s;
/// The machine's own vector of `i32`.
pub type Ints<S> = <S as Simd>::i32s;
/// A placement value per lane.
pub type Mask<S> = <S as Simd>::mask32s;

/// The number type of formulas: [`Value`] or [`Jet`].
pub trait Real<S: Simd>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
{
    /// A number that is constant in space.
    fn constant(value: Lanes<S>) -> Self;
    /// The value without its gradient.
    fn value(self) -> Lanes<S>;
    /// `value` = g(self), where `slope` = g'(self).
    fn chain(self, value: Lanes<S>, slope: Lanes<S>) -> Self;
    /// `value` = g(at), where `slope` is the gradient of g there.
    fn chain_3(value: Lanes<S>, slope: [Lanes<S>; 3], at: Vec3<Self>) -> Self;
    /// `yes` where the mask holds, `no` elsewhere.
    fn pick(mask: Mask<S>, yes: Self, no: Self) -> Self;

    /// The same constant in all lanes.
    #[inline(always)]
    fn splat(simd: S, value: f32) -> Self {
        Self::constant(Lanes::<S>::splat(simd, value))
    }

    /// Zero in all lanes.
    #[inline(always)]
    fn zero(simd: S) -> Self {
        Self::splat(simd, 0.0)
    }

    /// The square.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }

    /// Square root, of at least 1e-12.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value().max(1e-12).sqrt();
        self.chain(root, Lanes::<S>::splat(root.token(), 0.5) / root)
    }

    /// |x| rounded over a width of `softness`.
    #[inline(always)]
    fn soft_abs(self, softness: f32) -> Self {
        let x = self.value();
        let root = (x * x + softness * softness).sqrt();
        self.chain(root, x / root)
    }

    /// The larger.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::pick(self.value().simd_gt(other.value()), self, other)
    }

    /// The smaller.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::pick(self.value().simd_lt(other.value()), self, other)
    }

    /// At least `low`.
    #[inline(always)]
    fn at_least(self, low: f32) -> Self {
        let low = Self::constant(Lanes::<S>::splat(self.value().token(), low));
        self.max(low)
    }

    /// At most `high`.
    #[inline(always)]
    fn at_most(self, high: f32) -> Self {
        let high = Self::constant(Lanes::<S>::splat(self.value().token(), high));
        self.min(high)
    }

    /// Between `low` and `high`.
    #[inline(always)]
    fn within(self, low: f32, high: f32) -> Self {
        self.at_least(low).at_most(high)
    }

    /// Hermite step from 0 at `from` to 1 at `to`; exactly 0 and 1 outside. `from` may be the larger. Where it is 1, its gradient is 0,
    /// also where it is rounded to 1: so what is weighted by the rest adds nothing and may be left out.
    #[inline(always)]
    fn step(self, from: f32, to: f32) -> Self {
        let t = ((self - from) * (1.0 / (to - from))).within(0.0, 1.0);
        (t * t * (t * -2.0 + 3.0)).at_most(1.0)
    }

    /// A bump of half-width 1 around 0: (1 − x²)³, exactly 0 outside.
    #[inline(always)]
    fn bump(self) -> Self {
        let t = (-self.squared() + 1.0).at_least(0.0);
        t * t * t
    }

    /// Integer part and fraction in 0..1; the integer part has no gradient.
    #[inline(always)]
    fn split(self) -> (Ints<S>, Self) {
        let whole = self.value().floor();
        (whole.to_int(), self - Self::constant(whole))
    }
}

/// [`Real::step`] of a number by itself.
pub fn smooth_step([from, to]: [f64; 2], x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A plain value.
#[derive(Clone, Copy, Debug)]
pub struct Value<S: Simd>(pub Lanes<S>);

/// A value and its gradient over space.
#[derive(Clone, Copy, Debug)]
pub struct Jet<S: Simd> {
    /// The value.
    pub value: Lanes<S>,
    /// Its derivatives along x, y and z.
    pub gradient: [Lanes<S>; 3],
}

impl<S: Simd> Real<S> for Value<S> {
    #[inline(always)]
    fn constant(value: Lanes<S>) -> Self {
        Self(value)
    }

    #[inline(always)]
    fn value(self) -> Lanes<S> {
        self.0
    }

    #[inline(always)]
    fn chain(self, value: Lanes<S>, _slope: Lanes<S>) -> Self {
        Self(value)
    }

    #[inline(always)]
    fn chain_3(value: Lanes<S>, _slope: [Lanes<S>; 3], _at: Vec3<Self>) -> Self {
        Self(value)
    }

    #[inline(always)]
    fn pick(mask: Mask<S>, yes: Self, no: Self) -> Self {
        Self(mask.select(yes.0, no.0))
    }
}

impl<S: Simd> Real<S> for Jet<S> {
    #[inline(always)]
    fn constant(value: Lanes<S>) -> Self {
        Self { value, gradient: [Lanes::<S>::splat(value.token(), 0.0); 3] }
    }

    #[inline(always)]
    fn value(self) -> Lanes<S> {
        self.value
    }

    #[inline(always)]
    fn chain(self, value: Lanes<S>, slope: Lanes<S>) -> Self {
        let [x, y, z] = self.gradient;
        Self { value, gradient: [x * slope, y * slope, z * slope] }
    }

    #[inline(always)]
    fn chain_3(value: Lanes<S>, slope: [Lanes<S>; 3], at: Vec3<Self>) -> Self {
        let along = inlined!(|i: usize| {
            at.x.gradient[i] * slope[0] + at.y.gradient[i] * slope[1] + at.z.gradient[i] * slope[2]
        });
        Self { value, gradient: [along(0), along(1), along(2)] }
    }

    #[inline(always)]
    fn pick(mask: Mask<S>, yes: Self, no: Self) -> Self {
        let along = inlined!(|i: usize| mask.select(yes.gradient[i], no.gradient[i]));
        let value = mask.select(yes.value, no.value);
        Self { value, gradient: [along(0), along(1), along(2)] }
    }
}

/// Value operators; the gradient-less case.
macro_rules! value_operator {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl<S: Simd> $trait for Value<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
    };
    ($trait:ident, $method:ident, $operator:tt, f32) => {
        impl<S: Simd> $trait<f32> for Value<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                Self(self.0 $operator other)
            }
        }
    };
}
value_operator!(Add, add, +);
value_operator!(Sub, sub, -);
value_operator!(Mul, mul, *);
value_operator!(Div, div, /);
value_operator!(Add, add, +, f32);
value_operator!(Sub, sub, -, f32);
value_operator!(Mul, mul, *, f32);

impl<S: Simd> Neg for Value<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Simd> Jet<S> {
    /// Joins two gradients component by component.
    #[inline(always)]
    fn join(self, other: Self, value: Lanes<S>, slope: impl Fn(Lanes<S>, Lanes<S>) -> Lanes<S>) -> Self {
        let along = inlined!(|i: usize| slope(self.gradient[i], other.gradient[i]));
        Self { value, gradient: [along(0), along(1), along(2)] }
    }

    #[inline(always)]
    fn product(self, other: Self) -> Self {
        let (u, v) = (self.value, other.value);
        self.join(
            other,
            u * v,
            #[inline(always)]
            |a, b| a * v + b * u,
        )
    }

    #[inline(always)]
    fn quotient(self, other: Self) -> Self {
        let (quotient, v) = (self.value / other.value, other.value);
        self.join(
            other,
            quotient,
            #[inline(always)]
            |a, b| (a - b * quotient) / v,
        )
    }
}

impl<S: Simd> Add for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.join(
            other,
            self.value + other.value,
            #[inline(always)]
            |a, b| a + b,
        )
    }
}

impl<S: Simd> Sub for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.join(
            other,
            self.value - other.value,
            #[inline(always)]
            |a, b| a - b,
        )
    }
}

impl<S: Simd> Mul for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.product(other)
    }
}

impl<S: Simd> Div for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.quotient(other)
    }
}

impl<S: Simd> Neg for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [x, y, z] = self.gradient;
        Self { value: -self.value, gradient: [-x, -y, -z] }
    }
}

impl<S: Simd> Add<f32> for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f32) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl<S: Simd> Sub<f32> for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f32) -> Self {
        Self { value: self.value - other, ..self }
    }
}

/// By a number that is constant in space.
impl<S: Simd> Mul<Value<S>> for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Value<S>) -> Self {
        let [x, y, z] = self.gradient;
        Self { value: self.value * other.0, gradient: [x * other.0, y * other.0, z * other.0] }
    }
}

impl<S: Simd> Mul<f32> for Jet<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f32) -> Self {
        let [x, y, z] = self.gradient;
        Self { value: self.value * other, gradient: [x * other, y * other, z * other] }
    }
}

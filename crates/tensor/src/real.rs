//! The arithmetic that every number type of the kernels offers.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A real number of a kernel: a value, a register of values, or either with derivatives.
///
/// Constants are plain `f64` on the right-hand side (`x * 2.0`). [`Real::constant`] makes a number with a given value from
/// an existing number. There is no `From<f64>`, because a SIMD register cannot be made without its token.
///
/// Comparisons act on values, lane by lane; derivatives follow the chosen branch.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// The constant `c` (all derivatives zero), in the kind of `self`.
    fn constant(self, c: f64) -> Self;
    /// 1 / `self`.
    fn recip(self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The absolute value; at zero it has the derivative of the positive branch.
    fn abs(self) -> Self;
    /// The larger of two numbers; `self` if they are equal.
    fn max(self, other: Self) -> Self;
    /// The smaller of two numbers; `self` if they are equal.
    fn min(self, other: Self) -> Self;
    /// `a` where `self >= threshold`, otherwise `b`.
    fn select_ge(self, threshold: Self, a: Self, b: Self) -> Self;
    /// `self` to a constant real power; `self` must be positive.
    fn powf(self, exponent: f64) -> Self;
    /// The natural logarithm; `self` must be positive.
    fn ln(self) -> Self;
    /// `self * factor + term`, fused where the hardware fuses.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Zero, in the kind of `self`.
    #[inline(always)]
    fn zero(self) -> Self {
        self.constant(0.0)
    }
}

/// A number that can be combined with numbers of a simpler kind `G`, at the cost of the simpler kind.
///
/// `G` is the number type of the geometry, `Self` that of the state: `f64` over `f64`, lanes over lanes, a dual over its
/// own values (the mesh is not differentiated) or over itself (it is).
pub trait Over<G>: Real {
    /// `g`, with zero for derivatives that `G` does not carry.
    fn lift(g: G) -> Self;
    /// `self * g`.
    fn scale(self, g: G) -> Self;
    /// `self * g + term`.
    fn scale_add(self, g: G, term: Self) -> Self;
    /// `self - g`.
    fn minus(self, g: G) -> Self;
    /// `self + g`.
    fn plus(self, g: G) -> Self;
}

impl<T: Real> Over<T> for T {
    #[inline(always)]
    fn lift(g: T) -> Self {
        g
    }
    #[inline(always)]
    fn scale(self, g: T) -> Self {
        self * g
    }
    #[inline(always)]
    fn scale_add(self, g: T, term: T) -> Self {
        self.mul_add(g, term)
    }
    #[inline(always)]
    fn minus(self, g: T) -> Self {
        self - g
    }
    #[inline(always)]
    fn plus(self, g: T) -> Self {
        self + g
    }
}

/// Functions beyond arithmetic. They serve exact states, motions and case-file expressions, which are evaluated point by
/// point; SIMD lanes do not offer them.
pub trait Transcendental: Real + From<f64> {
    /// The plain value, derivatives dropped.
    fn value(self) -> f64;
    /// The exponential.
    fn exp(self) -> Self;
    /// The sine.
    fn sin(self) -> Self;
    /// The cosine.
    fn cos(self) -> Self;
    /// The inverse tangent.
    fn atan(self) -> Self;
    /// The hyperbolic tangent.
    fn tanh(self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn constant(self, c: f64) -> f64 {
        c
    }
    #[inline(always)]
    fn recip(self) -> f64 {
        1.0 / self
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        if self >= other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: f64) -> f64 {
        if self <= other { self } else { other }
    }
    #[inline(always)]
    fn select_ge(self, threshold: f64, a: f64, b: f64) -> f64 {
        if self >= threshold { a } else { b }
    }
    #[inline(always)]
    fn powf(self, exponent: f64) -> f64 {
        f64::powf(self, exponent)
    }
    #[inline(always)]
    fn ln(self) -> f64 {
        f64::ln(self)
    }
    /// Not `f64::mul_add`: without a compile-time target feature it calls the C library, which is a hundred times slower.
    #[inline(always)]
    fn mul_add(self, factor: f64, term: f64) -> f64 {
        self * factor + term
    }
}

impl Transcendental for f64 {
    fn value(self) -> f64 {
        self
    }
    fn exp(self) -> f64 {
        f64::exp(self)
    }
    fn sin(self) -> f64 {
        f64::sin(self)
    }
    fn cos(self) -> f64 {
        f64::cos(self)
    }
    fn atan(self) -> f64 {
        f64::atan(self)
    }
    fn tanh(self) -> f64 {
        f64::tanh(self)
    }
}

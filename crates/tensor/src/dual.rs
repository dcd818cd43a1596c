//! First derivatives by forward differentiation.

use crate::real::{Over, Real, Transcendental};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A value and its derivative in one direction. Duals nest: the derivative of a derivative is a `Dual<Dual<T>>`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T> {
    /// The value.
    pub value: T,
    /// The derivative of the value along the chosen direction.
    pub derivative: T,
}

impl<T> Dual<T> {
    /// A value with its derivative.
    #[inline(always)]
    pub fn new(value: T, derivative: T) -> Self {
        Dual { value, derivative }
    }
}

impl<T: Real> Dual<T> {
    /// Chain rule: a function with value `f` and slope `slope` at `self.value`.
    #[inline(always)]
    fn chain(self, f: T, slope: T) -> Self {
        Dual::new(f, slope * self.derivative)
    }
}

impl<T: Real> Add for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Dual::new(self.value + o.value, self.derivative + o.derivative)
    }
}
impl<T: Real> Sub for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Dual::new(self.value - o.value, self.derivative - o.derivative)
    }
}
impl<T: Real> Mul for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Dual::new(self.value * o.value, self.value.mul_add(o.derivative, self.derivative * o.value))
    }
}
impl<T: Real> Div for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let inverse = o.value.recip();
        let quotient = self.value * inverse;
        Dual::new(quotient, (self.derivative - quotient * o.derivative) * inverse)
    }
}
impl<T: Real> Neg for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual::new(-self.value, -self.derivative)
    }
}
impl<T: Real> Add<f64> for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, c: f64) -> Self {
        Dual::new(self.value + c, self.derivative)
    }
}
impl<T: Real> Sub<f64> for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, c: f64) -> Self {
        Dual::new(self.value - c, self.derivative)
    }
}
impl<T: Real> Mul<f64> for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, c: f64) -> Self {
        Dual::new(self.value * c, self.derivative * c)
    }
}
impl<T: Real> AddAssign for Dual<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<T: Real> SubAssign for Dual<T> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl<T: Real> Real for Dual<T> {
    #[inline(always)]
    fn constant(self, c: f64) -> Self {
        Dual::new(self.value.constant(c), self.value.constant(0.0))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let inverse = self.value.recip();
        self.chain(inverse, -(inverse * inverse))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, (root + root).recip())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.select_ge(self.zero(), self, -self)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.select_ge(other, self, other)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        other.select_ge(self, self, other)
    }
    #[inline(always)]
    fn select_ge(self, threshold: Self, a: Self, b: Self) -> Self {
        let value = self.value.select_ge(threshold.value, a.value, b.value);
        let derivative = self.value.select_ge(threshold.value, a.derivative, b.derivative);
        Dual::new(value, derivative)
    }
    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        let power = self.value.powf(exponent);
        self.chain(power, power / self.value * exponent)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let derivative = self.value.mul_add(factor.derivative, self.derivative.mul_add(factor.value, term.derivative));
        Dual::new(self.value.mul_add(factor.value, term.value), derivative)
    }
}

/// A differentiated state over a geometry that is not differentiated.
impl<T: Real> Over<T> for Dual<T> {
    #[inline(always)]
    fn lift(g: T) -> Self {
        Dual::new(g, g.constant(0.0))
    }
    #[inline(always)]
    fn scale(self, g: T) -> Self {
        Dual::new(self.value * g, self.derivative * g)
    }
    #[inline(always)]
    fn scale_add(self, g: T, term: Self) -> Self {
        Dual::new(self.value.mul_add(g, term.value), self.derivative.mul_add(g, term.derivative))
    }
    #[inline(always)]
    fn minus(self, g: T) -> Self {
        Dual::new(self.value - g, self.derivative)
    }
    #[inline(always)]
    fn plus(self, g: T) -> Self {
        Dual::new(self.value + g, self.derivative)
    }
}

impl<T: Transcendental> From<f64> for Dual<T> {
    fn from(c: f64) -> Self {
        Dual::new(T::from(c), T::from(0.0))
    }
}

impl<T: Transcendental> Transcendental for Dual<T> {
    fn value(self) -> f64 {
        self.value.value()
    }
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }
    fn atan(self) -> Self {
        self.chain(self.value.atan(), (self.value * self.value + 1.0).recip())
    }
    fn tanh(self) -> Self {
        let t = self.value.tanh();
        self.chain(t, -(t * t) + 1.0)
    }
}

//! A number type that counts its floating-point operations.

use crate::{Dual, LaneNumber, Lanes, Over, Pack, Real};
use pulp::Simd;
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The floating-point operations that `work` does in [`Counted`] numbers on this thread. A sum, difference, product, quotient,
/// root, power or logarithm counts as one, a fused multiply-add as two; signs and comparisons are not counted.
pub fn count_operations(work: impl FnOnce()) -> u64 {
    let before = OPERATIONS.get();
    work();
    OPERATIONS.get() - before
}

/// A number of type `T` whose operations are counted.
#[derive(Clone, Copy, Debug)]
pub struct Counted<T>(T);

impl<T> Counted<T> {
    /// The result of `operations` operations.
    #[inline(always)]
    fn after(operations: u64, result: T) -> Self {
        OPERATIONS.set(OPERATIONS.get() + operations);
        Counted(result)
    }
}

macro_rules! counted_operator {
    ($operator:ident, $method:ident) => {
        impl<T: Real> $operator for Counted<T> {
            type Output = Self;
            fn $method(self, o: Self) -> Self {
                Counted::after(1, $operator::$method(self.0, o.0))
            }
        }
    };
    ($operator:ident, $method:ident, f64) => {
        impl<T: Real> $operator<f64> for Counted<T> {
            type Output = Self;
            fn $method(self, c: f64) -> Self {
                Counted::after(1, $operator::$method(self.0, c))
            }
        }
    };
}
counted_operator!(Add, add);
counted_operator!(Sub, sub);
counted_operator!(Mul, mul);
counted_operator!(Div, div);
counted_operator!(Add, add, f64);
counted_operator!(Sub, sub, f64);
counted_operator!(Mul, mul, f64);

impl<T: Real> Neg for Counted<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Counted(-self.0)
    }
}
impl<T: Real> AddAssign for Counted<T> {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<T: Real> SubAssign for Counted<T> {
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl<T: Real> Real for Counted<T> {
    fn constant(self, c: f64) -> Self {
        Counted(self.0.constant(c))
    }
    fn recip(self) -> Self {
        Counted::after(1, self.0.recip())
    }
    fn sqrt(self) -> Self {
        Counted::after(1, self.0.sqrt())
    }
    fn abs(self) -> Self {
        Counted(self.0.abs())
    }
    fn max(self, other: Self) -> Self {
        Counted(self.0.max(other.0))
    }
    fn min(self, other: Self) -> Self {
        Counted(self.0.min(other.0))
    }
    fn select_ge(self, threshold: Self, a: Self, b: Self) -> Self {
        Counted(self.0.select_ge(threshold.0, a.0, b.0))
    }
    fn powf(self, exponent: f64) -> Self {
        Counted::after(1, self.0.powf(exponent))
    }
    fn ln(self) -> Self {
        Counted::after(1, self.0.ln())
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Counted::after(2, self.0.mul_add(factor.0, term.0))
    }
}

impl<S: Simd> LaneNumber<S> for Counted<Lanes<S>> {
    const BLOCKS: usize = 1;
    fn load(simd: S, array: &[Pack], _block: usize, i: usize, part: usize) -> Self {
        Counted(Lanes::read(simd, &array[i], part))
    }
    fn store(self, array: &mut [Pack], _block: usize, i: usize, part: usize) {
        self.0.write(&mut array[i], part);
    }
    fn times(self, factor: Lanes<S>) -> Self {
        self * Counted(factor)
    }
    fn primal(self) -> Lanes<S> {
        self.0
    }
    fn result(self) -> Lanes<S> {
        self.0
    }
}

impl<S: Simd> LaneNumber<S> for Dual<Counted<Lanes<S>>> {
    const BLOCKS: usize = 2;
    fn load(simd: S, array: &[Pack], block: usize, i: usize, part: usize) -> Self {
        let at = |i: usize| Counted(Lanes::read(simd, &array[i], part));
        Dual::new(at(i), at(block + i))
    }
    fn store(self, array: &mut [Pack], block: usize, i: usize, part: usize) {
        self.value.0.write(&mut array[i], part);
        self.derivative.0.write(&mut array[block + i], part);
    }
    fn times(self, factor: Lanes<S>) -> Self {
        self.scale(Counted(factor))
    }
    fn primal(self) -> Lanes<S> {
        self.value.0
    }
    fn result(self) -> Lanes<S> {
        self.derivative.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_is_counted_and_leaves_the_value_alone() {
        let (a, b) = (Counted(3.0), Counted(2.0));
        let mut x = a;
        let operations = count_operations(|| {
            x = (a + b) * (a - b) / a; // 4
            x += b.mul_add(a, -b); // 3
            x = (x * 2.0 + 1.0 - 0.5).sqrt().recip().max(a).abs(); // 5
        });
        assert_eq!(operations, 12);
        let plain: f64 = (3.0 + 2.0) * (3.0 - 2.0) / 3.0 + (2.0 * 3.0 - 2.0);
        assert_eq!(x.0, (plain * 2.0 + 1.0 - 0.5).sqrt().recip().max(3.0));
    }

    /// (uv)' = u v' + u' v: two fused operations less one addition, beside the product itself.
    #[test]
    fn a_product_of_duals_is_four_operations() {
        let (u, v) = (Dual::new(Counted(3.0), Counted(1.0)), Dual::new(Counted(2.0), Counted(5.0)));
        assert_eq!(count_operations(|| assert_eq!((u * v).derivative.0, 17.0)), 4);
    }
}

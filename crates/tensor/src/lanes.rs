//! SIMD lanes: one cell (or facet) per lane.

use crate::{Dual, Real};
use pulp::Simd;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Cells per pack: one AVX-512 register or two AVX2 registers. It is fixed, so that data have the same layout on every
/// machine.
pub const WIDTH: usize = 8;

/// One number in each of [`WIDTH`] cells: the unit of storage of every batched array.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pack(pub [f64; WIDTH]);

impl Pack {
    /// A pack of zeros.
    pub const ZERO: Pack = Pack([0.0; WIDTH]);
}

/// `n` packs of zeros.
pub fn zeroed(n: usize) -> Vec<Pack> {
    vec![Pack::ZERO; n]
}

/// One SIMD register. On machines with short registers a [`Pack`] consists of several, addressed by `part`.
///
/// It carries the token `S`, the proof that the instructions exist here. So operators can be plain `+` and `*`.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    register: S::f64s,
    simd: S,
}

impl<S: Simd> Lanes<S> {
    /// Registers per [`Pack`].
    pub const PARTS: usize = WIDTH / S::F64_LANES;

    /// The same value in every lane.
    #[inline(always)]
    pub fn splat(simd: S, c: f64) -> Self {
        Lanes { register: simd.splat_f64s(c), simd }
    }
    /// Register `part` of `pack`.
    #[inline(always)]
    pub fn read(simd: S, pack: &Pack, part: usize) -> Self {
        Lanes { register: S::as_simd_f64s(&pack.0).0[part], simd }
    }
    /// Writes to register `part` of `pack`.
    #[inline(always)]
    pub fn write(self, pack: &mut Pack, part: usize) {
        S::as_mut_simd_f64s(&mut pack.0).0[part] = self.register;
    }
    #[inline(always)]
    fn with(self, register: S::f64s) -> Self {
        Lanes { register, simd: self.simd }
    }
}

macro_rules! register_operation {
    ($operator:ident, $method:ident, $instruction:ident) => {
        impl<S: Simd> $operator for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                self.with(self.simd.$instruction(self.register, o.register))
            }
        }
    };
}
register_operation!(Add, add, add_f64s);
register_operation!(Sub, sub, sub_f64s);
register_operation!(Mul, mul, mul_f64s);
register_operation!(Div, div, div_f64s);

macro_rules! constant_operation {
    ($operator:ident, $method:ident) => {
        impl<S: Simd> $operator<f64> for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, c: f64) -> Self {
                $operator::$method(self, self.constant(c))
            }
        }
    };
}
constant_operation!(Add, add);
constant_operation!(Sub, sub);
constant_operation!(Mul, mul);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    /// -0 - x: exact, and inlined, whereas the negation of `pulp` is a function call.
    #[inline(always)]
    fn neg(self) -> Self {
        self.constant(-0.0) - self
    }
}
impl<S: Simd> AddAssign for Lanes<S> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<S: Simd> SubAssign for Lanes<S> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn constant(self, c: f64) -> Self {
        self.with(self.simd.splat_f64s(c))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        self.constant(1.0) / self
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.register))
    }
    /// All bits but the sign, inlined for the same reason as [`Neg`].
    #[inline(always)]
    fn abs(self) -> Self {
        let magnitude = self.simd.splat_f64s(f64::from_bits(u64::MAX >> 1));
        self.with(self.simd.and_f64s(self.register, magnitude))
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
        let mask = self.simd.greater_than_or_equal_f64s(self.register, threshold.register);
        self.with(self.simd.select_f64s(mask, a.register, b.register))
    }
    /// Lane by lane, since powers occur on boundaries only.
    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        let mut pack = Pack::ZERO;
        self.write(&mut pack, 0);
        for lane in 0..S::F64_LANES {
            pack.0[lane] = pack.0[lane].powf(exponent);
        }
        Lanes::read(self.simd, &pack, 0)
    }
    /// Lane by lane: one logarithm per point costs little beside the rest of a law.
    #[inline(always)]
    fn ln(self) -> Self {
        let mut pack = Pack::ZERO;
        self.write(&mut pack, 0);
        for lane in 0..S::F64_LANES {
            pack.0[lane] = pack.0[lane].ln();
        }
        Lanes::read(self.simd, &pack, 0)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.with(self.simd.mul_add_f64s(self.register, factor.register, term.register))
    }
}

/// A number that kernels read from and write to batched arrays.
///
/// An array holds a block of packs for the values and, for duals, a second block of the same length for the derivatives.
/// Linear steps (interpolation, differentiation, integration) treat both alike; only point functions use duals.
pub trait LaneNumber<S: Simd>: Real {
    /// Blocks per array: 1 for values, 2 for values with derivatives.
    const BLOCKS: usize;
    /// Reads entry `i` of the blocks of length `block`, register `part`.
    fn load(simd: S, array: &[Pack], block: usize, i: usize, part: usize) -> Self;
    /// Writes entry `i` of the blocks of length `block`, register `part`.
    fn store(self, array: &mut [Pack], block: usize, i: usize, part: usize);
    /// `self` times a register without derivatives.
    fn times(self, factor: Lanes<S>) -> Self;
    /// The value, derivatives dropped.
    fn primal(self) -> Lanes<S>;
    /// The result of a kernel: the value, or the derivative of a dual. Results have one block.
    fn result(self) -> Lanes<S>;
}

impl<S: Simd> LaneNumber<S> for Lanes<S> {
    const BLOCKS: usize = 1;
    #[inline(always)]
    fn load(simd: S, array: &[Pack], _block: usize, i: usize, part: usize) -> Self {
        Lanes::read(simd, &array[i], part)
    }
    #[inline(always)]
    fn store(self, array: &mut [Pack], _block: usize, i: usize, part: usize) {
        self.write(&mut array[i], part);
    }
    #[inline(always)]
    fn times(self, factor: Lanes<S>) -> Self {
        self * factor
    }
    #[inline(always)]
    fn primal(self) -> Lanes<S> {
        self
    }
    #[inline(always)]
    fn result(self) -> Lanes<S> {
        self
    }
}

impl<S: Simd> LaneNumber<S> for Dual<Lanes<S>> {
    const BLOCKS: usize = 2;
    #[inline(always)]
    fn load(simd: S, array: &[Pack], block: usize, i: usize, part: usize) -> Self {
        Dual::new(Lanes::read(simd, &array[i], part), Lanes::read(simd, &array[block + i], part))
    }
    #[inline(always)]
    fn store(self, array: &mut [Pack], block: usize, i: usize, part: usize) {
        self.value.write(&mut array[i], part);
        self.derivative.write(&mut array[block + i], part);
    }
    #[inline(always)]
    fn times(self, factor: Lanes<S>) -> Self {
        Dual::new(self.value * factor, self.derivative * factor)
    }
    #[inline(always)]
    fn primal(self) -> Lanes<S> {
        self.value
    }
    #[inline(always)]
    fn result(self) -> Lanes<S> {
        self.derivative
    }
}

//! The times of a slab at which kernels evaluate.

use basis::{Matrix, RadauTime};
use tensor::Pack;

/// The times at which a slab evaluates time-dependent data: boundary states, sources.
///
/// ```text
/// t(s) = start + rate s,   s in [0, 1],   rate = dt in a march, 0 in a steady flow                                     (clock)
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    start: f64,
    rate: f64,
}

impl Clock {
    /// The clock of a slab of length `dt`.
    pub fn running(start: f64, dt: f64) -> Self {
        Clock { start, rate: dt }
    }

    /// Always the same time.
    pub fn stopped(time: f64) -> Self {
        Clock { start: time, rate: 0.0 }
    }

    /// The clock of a slab of length `dt`, which stands still if all data are those of the time `held`.
    pub fn of_slab(start: f64, dt: f64, held: Option<f64>) -> Self {
        held.map_or(Clock::running(start, dt), Clock::stopped)
    }

    /// Whether time passes.
    pub fn runs(&self) -> bool {
        self.rate != 0.0
    }

    /// t(s)
    pub fn time(&self, s: f64) -> f64 {
        self.start + self.rate * s
    }
}

/// The time basis at one time of the slab.
pub struct TimePoint {
    /// Position in the slab, in [0, 1].
    pub s: f64,
    /// Quadrature weight on the unit slab.
    pub weight: f64,
    /// phi_a(s), one row.
    pub values: Matrix,
    /// Position on the slab, one row over (bottom position, velocities): 1, dt Phi_1(s), ..., dt Phi_{N_t}(s), for dt = 1.
    pub positions: Vec<f64>,
    /// Velocity, one row over (bottom position, velocities): 0, phi_1(s), ..., phi_{N_t}(s).
    pub velocities: Matrix,
}

impl TimePoint {
    /// The basis at `s`.
    pub fn new(time: &RadauTime, s: f64, weight: f64) -> Self {
        let (phi, integrals) = (time.values(s), time.integrals(s));
        let n = phi.len();
        TimePoint {
            s,
            weight,
            values: Matrix::from_fn(1, n, |_, a| phi[a]),
            positions: std::iter::once(1.0).chain(integrals).collect(),
            velocities: Matrix::from_fn(1, n + 1, |_, b| if b == 0 { 0.0 } else { phi[b - 1] }),
        }
    }

    /// The basis at `s` for the operator of space: positions and velocities of the slab, but a state at this time only.
    pub fn of_space(time: &RadauTime, s: f64) -> Self {
        TimePoint { values: Matrix::identity(1), ..TimePoint::new(time, s, 1.0) }
    }

    /// The row that gives the position at this time in a slab of length `dt`.
    pub fn position_row(&self, dt: f64) -> Matrix {
        Matrix::from_fn(1, self.positions.len(), |_, b| if b == 0 { 1.0 } else { dt * self.positions[b] })
    }
}

/// Time `number` of `count`.
#[derive(Clone, Copy)]
pub(crate) struct TimePointIndex {
    pub(crate) number: usize,
    pub(crate) count: usize,
}

impl TimePointIndex {
    /// The only time.
    pub(crate) const ALONE: TimePointIndex = TimePointIndex { number: 0, count: 1 };

    /// The part of `array[b][time][..]` for this time in block `b`, `len` packs.
    #[inline(always)]
    pub(crate) fn block<'a>(&self, array: &'a [Pack], b: usize, len: usize) -> &'a [Pack] {
        &array[(b * self.count + self.number) * len..][..len]
    }
}

/// The map from time nodes and slots of a slab to traces at some times: `[time][node]`, `[time][slot]`.
#[derive(Clone, Copy)]
pub struct InTime<'a> {
    /// States.
    pub values: &'a Matrix,
    /// Velocities of the mesh.
    pub velocities: &'a Matrix,
    /// Positions of the mesh.
    pub positions: &'a Matrix,
}

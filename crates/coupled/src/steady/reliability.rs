//! Whether a converged steady flow is physical, or a solution of the discrete equations alone.
//!
//! ```text
//! r = |f_N+1(u)| / |(df_N+1/dm) m|             the residual at the next higher order, relative to the inertial terms        (next order)
//! |du/dt| while u is marched in time           grows if the steady flow is unstable                                      (stability)
//! ```
//!
//! Coarse meshes have spurious steady solutions: Newton's method finds them, but a flow in time leaves them. They are not resolved, so r is
//! large. A march is expensive: it is made if r is large, or if the case asks for it.

use super::residual_norms;
use super::search::{Discretisation, Search};
use super::settling::{PER_TIME_UNIT, duration, mean, rates_of_change};
use crate::slab_error::SlabError;
use fem::Layout;
use navier_stokes::Conserved;
use newton_krylov::inner_product::smallest;
use newton_krylov::problem::NonlinearProblem;

/// r above which a march in time tests the flow.
const UNRESOLVED: f64 = 0.1;

/// r above which forces may change with the order: a NACA 4415 at Re = 5,000 has 0.04 to 0.07 where its lift changes by a factor of 2.7.
const DOUBTFUL: f64 = 0.02;

/// Time units of a march that the case does not ask for.
const TIME_UNITS: f64 = 8.0;

/// The flow is unstable if its rate of change grows by this factor.
const UNSTABLE: f64 = 10.0;

/// Where the rate of change grows by this factor, a longer march must tell whether the flow is unstable.
const GROWING: f64 = 2.0;

/// Before the march, the deviation from the mean of each cell changes by at most this part, to break symmetries.
const DISTURBANCE: f64 = 1e-5;

/// Highest order of a flow in space.
const HIGHEST_ORDER: usize = 16;

/// The tests of a steady flow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reliability {
    /// (next order); None where that residual cannot be evaluated.
    pub next_order_residual: Option<f64>,
    /// The result of a march in time, if there was one.
    pub stability: Option<Stability>,
}

impl Reliability {
    /// r, if it is so large that forces may change with the order.
    pub fn doubtful_residual(&self) -> Option<f64> {
        self.next_order_residual.filter(|residual| *residual > DOUBTFUL)
    }

    /// Whether the mesh and the order resolve the flow.
    pub fn is_resolved(&self) -> bool {
        self.next_order_residual.is_some_and(|residual| residual <= UNRESOLVED)
    }
}

/// A march in time from a steady flow that was disturbed slightly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stability {
    /// |du/dt| in the last eighth of the march, relative to the least mean of all eighths: 1 if it decays to the end.
    pub growth: f64,
    /// The time marched.
    pub duration: f64,
    /// Whether every slab could be solved.
    pub completed: bool,
}

impl Stability {
    fn new(rates: &[f64], slabs: usize, duration: f64) -> Self {
        let eighth = |k: usize| rates.get(k * slabs / 8..rates.len().min((k + 1) * slabs / 8));
        let eighths: Vec<f64> = (0..8).filter_map(eighth).filter(|part| !part.is_empty()).map(mean).collect();
        let (late, least) = (eighths.last(), smallest(eighths.iter().copied()));
        Stability { growth: late.map_or(1.0, |late| late / least), duration, completed: rates.len() == slabs }
    }

    /// Whether the steady flow is unstable.
    pub fn is_unstable(&self) -> bool {
        !self.completed || self.growth > UNSTABLE
    }

    /// Whether the march was too short to tell.
    pub fn is_undecided(&self) -> bool {
        !self.is_unstable() && self.growth > GROWING
    }
}

impl<const D: usize, const M: usize> Search<'_, D, M> {
    /// Tests the steady flow `u`.
    ///
    /// # Errors
    /// [`SlabError::Stopped`]
    pub(super) fn reliability(&self, u: &[f64]) -> Result<Reliability, SlabError> {
        let next_order_residual = if self.order < HIGHEST_ORDER { self.next_order_residual(u) } else { None };
        let reliability = Reliability { next_order_residual, stability: None };
        let needed = if reliability.is_resolved() || self.order >= HIGHEST_ORDER { 0.0 } else { TIME_UNITS };
        let units = self.stability_time.unwrap_or(needed);
        let stability = if units > 0.0 { Some(self.stability(u, units)?) } else { None };
        Ok(Reliability { stability, ..reliability })
    }

    fn next_order_residual(&self, u: &[f64]) -> Option<f64> {
        let next = Discretisation { order: self.order + 1, ..self.own() };
        let u = self.transferred(u, self.order, next.order);
        let (mut problem, _) = (self.discretise)(next);
        problem.at_rest(self.times(), &u, self.displacement).ok()?;
        let residual = residual_norms(&mut problem, &u).ok()?[0];
        if problem.round_off(&u).is_some_and(|rounding| residual <= rounding[0]) {
            // A uniform flow, for instance, has no terms to compare with.
            return Some(0.0);
        }
        let (momentum, mut terms) = (momentum::<D, M>(problem.flow.operator.layout, &u), vec![0.0; u.len()]);
        // At the point where rounding was estimated.
        problem.jacobian_product(&momentum, &mut terms);
        let size = problem.field_norms(&terms)[0];
        (size > 0.0).then_some(residual / size)
    }

    /// Marches the disturbed flow in time.
    fn stability(&self, u: &[f64], units: f64) -> Result<Stability, SlabError> {
        let mut disturbed = u.to_vec();
        let (own, nodes) = (&self.share.own, self.order.pow(D as u32));
        disturb(own, Layout { cells: own.len(), time_order: 1, components: M, nodes }, &mut disturbed);
        let slabs = (units * PER_TIME_UNIT).ceil().max(8.0) as usize;
        let rates = rates_of_change(self, &mut disturbed, slabs);
        match (self.is_stopped)() {
            true => Err(SlabError::Stopped),
            false => Ok(Stability::new(&rates, slabs, duration(self, rates.len()))),
        }
    }
}

/// The flow `u` with zeros for density and energy.
fn momentum<const D: usize, const M: usize>(layout: Layout, u: &[f64]) -> Vec<f64> {
    let kept: [f64; M] = Conserved { density: 0.0, momentum: [1.0; D], energy: 0.0 }.pack();
    let is_kept = |i: usize| kept[layout.component_of(i)] != 0.0;
    u.iter().enumerate().map(|(i, u)| if is_kept(i) { *u } else { 0.0 }).collect()
}

/// Scales the deviation from the mean of every component in every cell of `own`, by a factor that alternates without a pattern.
fn disturb(own: &[usize], layout: Layout, u: &mut [f64]) {
    for (cell, a) in layout.cells_and_times() {
        for m in 0..layout.components {
            let values = &mut u[layout.component_at(cell, a, m)];
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            // The golden ratio spreads its multiples evenly.
            let multiple = (own[cell] * layout.components + m) as f64 * 0.618_033_988_749_894_9;
            let factor = DISTURBANCE * (2.0 * multiple.fract() - 1.0);
            values.iter_mut().for_each(|value| *value += factor * (*value - mean));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Layout, Stability, momentum};

    #[test]
    fn momentum_is_what_is_neither_density_nor_energy() {
        let layout = Layout { cells: 2, time_order: 1, components: 4, nodes: 1 };
        let u = [1.0, 2.0, 3.0, 4.0, -5.0, -6.0, -7.0, -8.0];
        assert_eq!(momentum::<2, 4>(layout, &u), [0.0, 2.0, 3.0, 0.0, 0.0, -6.0, -7.0, 0.0]);
    }

    fn stability(rates: impl Iterator<Item = f64>) -> Stability {
        let rates: Vec<f64> = rates.collect();
        Stability::new(&rates, 48, 8.0)
    }

    fn unstable(rates: impl Iterator<Item = f64>) -> bool {
        stability(rates).is_unstable()
    }

    /// Of nine slabs the last one alone was compared with means of two.
    #[test]
    fn eighths_are_equal_up_to_a_slab() {
        let rates = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 8.0];
        // The geometric mean of the last two.
        assert!((Stability::new(&rates, 9, 1.5).growth - 8.0_f64.sqrt()).abs() < 1e-14);
        assert_eq!(Stability::new(&rates[..3], 9, 1.5).growth, 1.0);
    }

    /// A flow whose rate of change had grown by a factor of 9.4 counted as stable.
    #[test]
    fn slow_growth_leaves_the_stability_open() {
        let grown = |rate: f64| stability((0..48).map(|k| (rate * f64::from(k) / 6.0).exp()));
        assert!(grown(0.3).is_undecided() && !grown(0.3).is_unstable());
        assert!(!grown(0.02).is_undecided() && !grown(-1.0).is_undecided() && !grown(1.0).is_undecided());
    }

    #[test]
    fn a_flow_is_unstable_where_its_rate_of_change_grows() {
        let times = || (0..48).map(|k| f64::from(k) / 6.0);
        assert!(!unstable(times().map(|_| 1e-10)));
        assert!(!unstable(times().map(|t| (-t).exp())));
        assert!(!unstable(times().map(|t| 1e-9 * (0.1 * t).exp())));
        // The disturbance decays first, then the unstable mode rises.
        assert!(unstable(times().map(|t| (-3.0 * t).exp() + 1e-4 * t.exp())));
        // A limit cycle has been reached.
        assert!(unstable(times().map(|t| (1e-6 * (4.0 * t).exp()).min(1.0))));
        // Not all slabs could be solved.
        assert!(unstable(times().take(10).map(|_| 1e-10)));
        assert!(unstable(std::iter::empty()));
    }
}

//! The kernels of a conservation law behind one object.
//!
//! The kernels are large, and there is one of each for every number type and instruction set. Behind [`Kernels`] they are
//! compiled once, in the crate that knows the law. Code that works with slabs knows only dimension and components.

use crate::boundary::{FacetFlux, FluxTime};
use crate::cell::{CellCoefficients, CellContext, CellMassProduct, SlabCells, SpaceCells};
use crate::conservation_law::ConservationLaw;
#[cfg(feature = "operation-counts")]
use crate::counted_mode::{CountedAlongState, CountedValues};
use crate::facet::{Across, FacetContext, FacetTerms};
use crate::mode::{AlongState, AlongStateAndMesh, Values};
use crate::scratch::{CellScratch, FacetScratch};
use crate::tables::Tables;
use crate::time_points::{InTime, TimePoint};
use crate::two_point::{FacePairs, TwoPointFluxes};
use basis::Matrix;
use std::marker::PhantomData;
use tensor::Arch;
#[cfg(feature = "operation-counts")]
use tensor::{count_operations, pulp::Scalar, pulp::WithSimd};

/// The quantity that a run of the kernels differentiates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Differentiate {
    /// Nothing: the residual itself.
    Nothing,
    /// A direction of the state.
    State,
    /// A direction of the state and of the mesh.
    StateAndMesh,
}

impl Differentiate {
    /// Blocks of geometry arrays, see `Mode::GEOMETRY_BLOCKS`.
    pub fn geometry_blocks(self) -> usize {
        if self == Differentiate::StateAndMesh { 2 } else { 1 }
    }
    /// Blocks of state arrays.
    pub fn state_blocks(self) -> usize {
        if self == Differentiate::Nothing { 1 } else { 2 }
    }

    /// The same where a direction of the mesh, and one of the state, may be zero; `None` if the derivative is zero. Many motions of a mesh
    /// leave a part of it alone.
    pub(crate) fn restricted(
        self,
        mesh_changes: impl FnOnce() -> bool,
        state_changes: impl FnOnce() -> bool,
    ) -> Option<Self> {
        if self != Differentiate::StateAndMesh || mesh_changes() {
            Some(self)
        } else {
            state_changes().then_some(Differentiate::State)
        }
    }
}

/// The times of a run of the facet kernel.
pub struct Times<'a> {
    /// The times.
    pub time_points: &'a [TimePoint],
    /// The map from time nodes and slots to these times.
    pub in_time: InTime<'a>,
    /// phi_a at these times, `[a][time]`.
    pub test: &'a Matrix,
    /// Weight of the terms at all of them: dt in a slab, 1 for the operator of space.
    pub weight: f64,
}

/// A conservation law with the conditions on the boundaries of a mesh, as the slab operator uses it.
pub trait Kernels<const D: usize, const M: usize>: Send + Sync {
    /// See [`ConservationLaw::is_viscous`].
    fn is_viscous(&self) -> bool;
    /// See [`ConservationLaw::scales`].
    fn scales(&self) -> [f64; M];
    /// See [`ConservationLaw::inadmissible`].
    fn inadmissible(&self, u: &[f64; M]) -> Option<(&'static str, f64)>;
    /// The number of boundaries with a condition.
    fn boundaries(&self) -> usize;
    /// Whether the condition on boundary number `boundary` takes data.
    fn takes_data(&self, boundary: usize) -> bool;
    /// The volume terms of a slab.
    fn slab_cells(
        &self,
        along: Differentiate,
        context: &CellContext<D>,
        coefficients: CellCoefficients,
        scratch: &mut CellScratch,
    );
    /// The terms of the operator of space, differentiated along a direction of the state.
    fn space_cells(&self, context: &CellContext<D>, time_point: &TimePoint, scratch: &mut CellScratch);
    /// Mass product of a state at one time.
    fn mass_product(&self, tables: &Tables<D>, scratch: &mut CellScratch);
    /// The facet terms.
    fn facets(
        &self,
        along: Differentiate,
        context: &FacetContext<D>,
        times: &Times,
        across: &Across,
        scratch: &mut FacetScratch,
    );
    /// Derivatives of the fluxes of (low order): between cells, or on `boundary`. `dissipation` is theta.
    fn two_point_fluxes(&self, boundary: Option<usize>, dissipation: f64, pairs: &mut FacePairs);
    /// Operations at points of one run of [`Self::slab_cells`], in all lanes, counted by a run in scalars. None without the feature
    /// `operation-counts`: kernels that count are a third of all their code.
    fn count_cells(
        &self,
        _along: Differentiate,
        _context: &CellContext<D>,
        _coefficients: CellCoefficients,
        _scratch: &mut CellScratch,
    ) -> Option<u64> {
        None
    }
    /// The same for [`Self::facets`] between cells. The mesh is not differentiated in either.
    fn count_facets(
        &self,
        _along: Differentiate,
        _context: &FacetContext<D>,
        _times: &Times,
        _scratch: &mut FacetScratch,
    ) -> Option<u64> {
        None
    }
    /// The flux out of the domain through the facets of a batch on a boundary, at one time: overwrites `through` of the scratch. Forces do
    /// work at the velocity of the mesh, or at `boundary_velocity` of the scratch where `time` says so.
    fn boundary_flux(&self, context: &FacetContext<D>, time: FluxTime, across: &Across, scratch: &mut FacetScratch);
}

/// The kernels of the law `L`.
pub struct LawKernels<const D: usize, const M: usize, L: ConservationLaw<D, M>> {
    law: L,
    conditions: Vec<L::Boundary>,
    arch: Arch,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>> LawKernels<D, M, L> {
    /// The kernels of `law` with a condition for every boundary of the mesh, in the order of its names.
    pub fn new(law: L, conditions: Vec<L::Boundary>) -> Self {
        LawKernels { law, conditions, arch: Arch::new() }
    }
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>> Kernels<D, M> for LawKernels<D, M, L> {
    fn is_viscous(&self) -> bool {
        self.law.is_viscous()
    }
    fn scales(&self) -> [f64; M] {
        self.law.scales()
    }
    fn inadmissible(&self, u: &[f64; M]) -> Option<(&'static str, f64)> {
        self.law.inadmissible(u)
    }
    fn boundaries(&self) -> usize {
        self.conditions.len()
    }
    fn takes_data(&self, boundary: usize) -> bool {
        self.law.takes_data(self.conditions[boundary])
    }

    fn slab_cells(
        &self,
        along: Differentiate,
        context: &CellContext<D>,
        coefficients: CellCoefficients,
        scratch: &mut CellScratch,
    ) {
        let law = &self.law;
        match along {
            Differentiate::Nothing => {
                self.arch.dispatch(SlabCells { law, context, coefficients, scratch, mode: PhantomData::<Values> })
            }
            Differentiate::State => {
                self.arch.dispatch(SlabCells { law, context, coefficients, scratch, mode: PhantomData::<AlongState> })
            }
            Differentiate::StateAndMesh => self.arch.dispatch(SlabCells {
                law,
                context,
                coefficients,
                scratch,
                mode: PhantomData::<AlongStateAndMesh>,
            }),
        }
    }

    fn space_cells(&self, context: &CellContext<D>, time_point: &TimePoint, scratch: &mut CellScratch) {
        self.arch.dispatch(SpaceCells {
            law: &self.law,
            context,
            time_point,
            scratch,
            mode: PhantomData::<AlongState>,
        });
    }

    fn mass_product(&self, tables: &Tables<D>, scratch: &mut CellScratch) {
        self.arch.dispatch(CellMassProduct { law: &self.law, tables, scratch });
    }

    fn facets(
        &self,
        along: Differentiate,
        context: &FacetContext<D>,
        times: &Times,
        across: &Across,
        scratch: &mut FacetScratch,
    ) {
        let (law, conditions) = (&self.law, &self.conditions[..]);
        match along {
            Differentiate::Nothing => {
                self.arch.dispatch(FacetTerms {
                    law,
                    conditions,
                    context,
                    times,
                    across,
                    scratch,
                    mode: PhantomData::<Values>,
                });
            }
            Differentiate::State => {
                self.arch.dispatch(FacetTerms {
                    law,
                    conditions,
                    context,
                    times,
                    across,
                    scratch,
                    mode: PhantomData::<AlongState>,
                });
            }
            Differentiate::StateAndMesh => {
                let mode = PhantomData::<AlongStateAndMesh>;
                self.arch.dispatch(FacetTerms { law, conditions, context, times, across, scratch, mode });
            }
        }
    }

    fn two_point_fluxes(&self, boundary: Option<usize>, dissipation: f64, pairs: &mut FacePairs) {
        let condition = boundary.map(|number| self.conditions[number]);
        self.arch.dispatch(TwoPointFluxes { law: &self.law, condition, dissipation, pairs });
    }

    #[cfg(feature = "operation-counts")]
    fn count_cells(
        &self,
        along: Differentiate,
        context: &CellContext<D>,
        coefficients: CellCoefficients,
        scratch: &mut CellScratch,
    ) -> Option<u64> {
        let law = &self.law;
        Some(count_operations(|| match along {
            Differentiate::Nothing => {
                SlabCells { law, context, coefficients, scratch, mode: PhantomData::<CountedValues> }.with_simd(Scalar)
            }
            _ => SlabCells { law, context, coefficients, scratch, mode: PhantomData::<CountedAlongState> }
                .with_simd(Scalar),
        }))
    }

    #[cfg(feature = "operation-counts")]
    fn count_facets(
        &self,
        along: Differentiate,
        context: &FacetContext<D>,
        times: &Times,
        scratch: &mut FacetScratch,
    ) -> Option<u64> {
        let (law, conditions, across) = (&self.law, &self.conditions[..], &Across::Cells);
        Some(count_operations(|| match along {
            Differentiate::Nothing => {
                let mode = PhantomData::<CountedValues>;
                FacetTerms { law, conditions, context, times, across, scratch, mode }.with_simd(Scalar);
            }
            _ => {
                let mode = PhantomData::<CountedAlongState>;
                FacetTerms { law, conditions, context, times, across, scratch, mode }.with_simd(Scalar);
            }
        }))
    }

    fn boundary_flux(&self, context: &FacetContext<D>, time: FluxTime, across: &Across, scratch: &mut FacetScratch) {
        let Across::Boundary(number, data) = across else { return };
        let (law, condition, data) = (&self.law, self.conditions[*number], *data);
        self.arch.dispatch(FacetFlux { law, condition, context, time, data, scratch });
    }
}

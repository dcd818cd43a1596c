//! Verification, regression, command-line and restart tests of stsolve: shared helpers.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

pub mod manufactured_interface;
pub mod orders;
pub mod rotating_box;
pub mod strip;
pub mod viscous;
pub mod vortex;

use fem::{Orders, PointFamily, Problem, Quadrature, SlabOperator, StateField};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use navier_stokes::exact::FreeStream;
use navier_stokes::{
    Boundary, Compiled, Exact, Gas, NavierStokes, PrescribedState, Primitive, Reference, Riemann, Source, Viscosity,
    VolumeFlux, WallFlux,
};
use std::sync::Arc;

/// Pseudo-random numbers in [-1, 1] that are the same on every machine.
pub struct Noise(u64);

impl Noise {
    /// The sequence for `seed`.
    pub fn new(seed: u64) -> Self {
        Noise(seed)
    }
    /// The next number (splitmix64).
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    /// `n` numbers times `amplitude`.
    pub fn vector(&mut self, n: usize, amplitude: f64) -> Vec<f64> {
        (0..n).map(|_| amplitude * self.number()).collect()
    }
}

/// Air with the given viscosity.
pub fn gas(viscosity: Viscosity) -> Gas {
    Gas::new(1.4, 1.0, 0.72, viscosity).unwrap()
}

/// A uniform state at about Mach 0.4.
pub fn uniform<const D: usize>() -> Primitive<f64, D> {
    Primitive { density: 1.1, velocity: std::array::from_fn(|d| 0.5 - 0.3 * d as f64), pressure: 1.7 }
}

/// The law with the scales of [`uniform`].
pub fn law<const D: usize>(viscosity: Viscosity, riemann: Riemann) -> NavierStokes<D> {
    let gas = gas(viscosity);
    plain_law(gas, riemann, Reference::new(&gas, 1.0, 0.5, 1.7).unwrap())
}

/// The law without a source of its own, split forms, shock capturing or mirrored walls.
pub fn plain_law<const D: usize>(gas: Gas, riemann: Riemann, reference: Reference) -> NavierStokes<D> {
    NavierStokes {
        gas,
        riemann,
        reference,
        source: Source::Given,
        volume_flux: VolumeFlux::Central,
        shock_capturing: None,
        wall_flux: WallFlux::Inside,
    }
}

/// A unit box of `cells` per axis, randomly curved, cells turned at random.
pub fn curved_box<const D: usize>(cells: usize, order: usize) -> Mesh<D> {
    curved_box_at(0.0, cells, order)
}

/// The same with its lowest corner at `lower` on every axis.
pub fn curved_box_at<const D: usize>(lower: f64, cells: usize, order: usize) -> Mesh<D> {
    let curving = Curving::Random { amplitude: 0.03, seed: 7 };
    let cells = [cells; D];
    BoxMesh { lower: [lower; D], upper: [lower + 1.0; D], cells, order, curving, periodic: [false; D] }
        .build()
        .unwrap()
        .scrambled(3)
}

/// An operator whose boundaries all have `condition`, with `data` if the condition takes any.
pub fn operator<const D: usize, const M: usize>(
    mesh: &Mesh<D>,
    law: NavierStokes<D>,
    orders: Orders,
    condition: Boundary<D>,
    data: Arc<dyn StateField<D, M>>,
) -> SlabOperator<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    operator_by(Quadrature::Conserving, mesh, law, orders, condition, data)
}

/// The same with any quadrature.
pub fn operator_by<const D: usize, const M: usize>(
    quadrature: Quadrature,
    mesh: &Mesh<D>,
    law: NavierStokes<D>,
    orders: Orders,
    condition: Boundary<D>,
    data: Arc<dyn StateField<D, M>>,
) -> SlabOperator<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let names = mesh.boundary_names();
    let data = names.iter().map(|_| condition.takes_data().then(|| data.clone())).collect();
    let problem = Problem { kernels: law.kernels(vec![condition; names.len()]), data, source: None };
    SlabOperator::new(problem, mesh, NodeNumbering::new(mesh, orders.mesh), orders, quadrature)
}

/// A quadrature and the flux inside of cells.
pub type Rule = (Quadrature, VolumeFlux);

/// The rules that conserve on moving meshes.
pub const RULES: [Rule; 6] = [
    (Quadrature::Conserving, VolumeFlux::Central),
    (Quadrature::Collocated(PointFamily::Gauss), VolumeFlux::Central),
    (Quadrature::Collocated(PointFamily::Lobatto), VolumeFlux::Central),
    (Quadrature::Collocated(PointFamily::Lobatto), VolumeFlux::KineticEnergy),
    (Quadrature::Collocated(PointFamily::Lobatto), VolumeFlux::Entropy),
    (Quadrature::Collocated(PointFamily::Lobatto), VolumeFlux::EntropyViscosity),
];

/// The free stream as a field.
pub fn free_stream<const D: usize, const M: usize>(law: &NavierStokes<D>) -> Arc<dyn StateField<D, M>>
where
    Exact<FreeStream<D>>: StateField<D, M>,
{
    Arc::new(Exact(FreeStream::new(law.gas, uniform()).unwrap()))
}

/// The condition that imposes the prescribed state.
pub fn prescribed<const D: usize>() -> Boundary<D> {
    Boundary::PrescribedState(PrescribedState)
}

/// max |a - b| / max |b|
pub fn relative_difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = |v: &mut dyn Iterator<Item = f64>| v.fold(0.0, |m: f64, x| m.max(x.abs()));
    largest(&mut a.iter().zip(b).map(|(a, b)| a - b)) / largest(&mut b.iter().copied())
}

/// The numbers of the own cells among those of the `whole` mesh, as many in every cell.
pub fn own_part(share: &fem::Share, whole: &[f64]) -> Vec<f64> {
    let len = whole.len() / share.whole_cells();
    share.own.iter().flat_map(|&cell| &whole[cell * len..(cell + 1) * len]).copied().collect()
}

//! The motion and the equilibrium of a structure whose law is not linear, or whose loads follow it, by Newton's method.
//!
//! Products are exact. They are preconditioned by the systems of K at one displacement: that at the bottom of a slab, or that of the
//! Newton step where there is no inertia.

use crate::modal::ModalSolver;
use crate::shifted::Shifted;
use crate::structure_slab::StructureSlab;
use crate::{ElasticityError, Structure};
use newton_krylov::inner_product::{Euclidean, InnerProduct};
use newton_krylov::newton::{self, Workspace};
use newton_krylov::problem::{Field, Inadmissible, NonlinearProblem};
use newton_krylov::{forcing, pseudo_time};

/// Relative tolerance of a preconditioner that is a solve.
const PRECONDITIONER_TOLERANCE: f64 = 1e-2;

/// The residual is this small against the forces in it, or rounding.
const TOLERANCE: f64 = 1e-12;

/// Rounding of a force is about this part of stiffness times displacement.
const ROUNDING: f64 = 10.0 * f64::EPSILON;

/// What Newton's method has cost.
pub(crate) struct Work {
    pub(crate) steps: usize,
    pub(crate) iterations: usize,
}

/// Finds `z` with a residual that is small against `forces`, the size of the forces in it, in the slab from `time`.
pub(crate) fn solve(
    problem: &mut dyn NonlinearProblem,
    forces: f64,
    time: f64,
    z: &mut [f64],
) -> Result<Work, ElasticityError> {
    let settings = newton::Settings {
        relative_tolerance: TOLERANCE,
        round_off: TOLERANCE,
        max_steps: 100,
        forcing: forcing::Settings { minimum: 1e-4, ..Default::default() },
        pseudo_time: pseudo_time::Settings { restart_inverse: 0.0, max_rejections: 0, ..Default::default() },
        ..Default::default()
    };
    match newton::solve(problem, z, Some(&[forces]), &settings, &mut Workspace::default()) {
        Ok(report) => Ok(Work { steps: report.steps.len(), iterations: report.krylov_iterations }),
        Err(error) => Err(ElasticityError::LargeDisplacement { time, source: Box::new(error) }),
    }
}

/// (dynamics) as R(V) = 0; fixed entries stay as they are.
pub(crate) struct Motion<'a, const D: usize> {
    slab: StructureSlab<'a, D>,
    forces: &'a [f64],
    modal: &'a ModalSolver<D>,
    fields: [Field; 1],
    /// V where R is differentiated.
    point: Vec<f64>,
}

impl<'a, const D: usize> Motion<'a, D> {
    /// The slab with the loads `forces` at rest, preconditioned by `modal`.
    pub(crate) fn new(slab: StructureSlab<'a, D>, forces: &'a [f64], modal: &'a ModalSolver<D>) -> Self {
        let fields = [Field { name: "structure", range: 0..forces.len() }];
        Motion { slab, forces, modal, fields, point: vec![0.0; forces.len()] }
    }

    fn at_fixed(&self, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        let length = self.slab.structure.length();
        for (a, vector) in vector.chunks_exact_mut(length).enumerate() {
            self.slab.structure.at_fixed(vector, |i| value(a * length + i));
        }
    }
}

impl<const D: usize> NonlinearProblem for Motion<'_, D> {
    fn len(&self) -> usize {
        self.forces.len()
    }
    fn fields(&self) -> &[Field] {
        &self.fields
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }
    fn residual(&mut self, v: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        self.slab.residual(self.forces, v, r)?;
        self.at_fixed(r, |_| 0.0);
        Ok(())
    }
    fn linearise(&mut self, v: &[f64], _inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        self.point.copy_from_slice(v);
        Ok(())
    }
    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.slab.product(&self.point, direction, out);
        self.at_fixed(out, |i| direction[i]);
    }
    fn add_pseudo_time(&mut self, _direction: &[f64], _out: &mut [f64]) {}
    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        out.copy_from_slice(r);
        // An unconverged increment still is a good direction.
        let _ = self.modal.solve(self.slab.structure, self.slab.dt, PRECONDITIONER_TOLERANCE, out);
    }
    /// Slender bodies are stiff along their axis and soft across it.
    fn merit(&mut self, r: &[f64]) -> f64 {
        let mut increment = vec![0.0; r.len()];
        self.precondition(r, &mut increment);
        Euclidean.norm(&increment)
    }
    fn largest_step(&mut self, _v: &[f64], _increment: &[f64]) -> f64 {
        1.0
    }
    fn round_off(&mut self, v: &[f64]) -> Option<Vec<f64>> {
        let StructureSlab { structure, motion, bottom, dt, .. } = &self.slab;
        let mut d = vec![0.0; structure.length()];
        let of_node = |a: usize| {
            motion.displacement_at_node(*dt, bottom.displacement, v, a, &mut d);
            (dt * motion.time().weights()[a] * rounding(structure, &d)).powi(2)
        };
        Some(vec![(0..motion.time().order()).map(of_node).sum::<f64>().sqrt()])
    }
}

/// The rounding of R(d).
fn rounding<const D: usize>(structure: &Structure<D>, d: &[f64]) -> f64 {
    let forces: Vec<f64> = structure.force_scales(0.0).into_iter().zip(d).map(|(k, d)| k * d).collect();
    ROUNDING * Euclidean.norm(&forces)
}

/// R(d) - f = 0 at free entries; fixed ones stay as they are.
pub(crate) struct Equilibrium<'a, const D: usize> {
    structure: &'a Structure<D>,
    /// r := R(d) - f at `d`, on all entries.
    imbalance: Imbalance<'a>,
    /// out := the derivative of that at the first, along the second argument.
    stiffness: Product<'a>,
    fields: [Field; 1],
    /// d where R is differentiated, and K there.
    point: Vec<f64>,
    shifted: Option<Shifted<D>>,
}

type Imbalance<'a> = &'a dyn Fn(&[f64], &mut [f64]) -> Result<(), crate::Inversion>;
type Product<'a> = &'a dyn Fn(&[f64], &[f64], &mut [f64]);

impl<'a, const D: usize> Equilibrium<'a, D> {
    /// The equilibrium of `structure` where `imbalance`, with the derivative `stiffness`, vanishes.
    pub(crate) fn new(structure: &'a Structure<D>, imbalance: Imbalance<'a>, stiffness: Product<'a>) -> Self {
        let length = structure.length();
        let fields = [Field { name: "structure", range: 0..length }];
        Equilibrium { structure, imbalance, stiffness, fields, point: vec![0.0; length], shifted: None }
    }
}

impl<const D: usize> NonlinearProblem for Equilibrium<'_, D> {
    fn len(&self) -> usize {
        self.point.len()
    }
    fn fields(&self) -> &[Field] {
        &self.fields
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }
    fn residual(&mut self, d: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        (self.imbalance)(d, r)?;
        self.structure.at_fixed(r, |_| 0.0);
        Ok(())
    }
    fn linearise(&mut self, d: &[f64], _inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        self.point.copy_from_slice(d);
        self.shifted = self.structure.shifted(0.0, Vec::new(), d).ok();
        Ok(())
    }
    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        (self.stiffness)(&self.point, direction, out);
        self.structure.at_fixed(out, |i| direction[i]);
    }
    fn add_pseudo_time(&mut self, _direction: &[f64], _out: &mut [f64]) {}
    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        out.copy_from_slice(r);
        if let Some(shifted) = &self.shifted {
            shifted.low_order.apply(r, out);
        }
    }
    /// Slender bodies are stiff along their axis and soft across it.
    fn merit(&mut self, r: &[f64]) -> f64 {
        let mut increment = vec![0.0; r.len()];
        self.precondition(r, &mut increment);
        Euclidean.norm(&increment)
    }
    fn largest_step(&mut self, _d: &[f64], _increment: &[f64]) -> f64 {
        1.0
    }
    fn round_off(&mut self, d: &[f64]) -> Option<Vec<f64>> {
        Some(vec![rounding(self.structure, d)])
    }
}

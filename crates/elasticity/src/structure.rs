//! An elastic body with mass.

mod damping;
mod systems;

pub use damping::Damping;

use crate::geometry::{StiffnessSampler, nodal_coordinates};
use crate::loads::{Loads, Surface};
use crate::mass::Mass;
use crate::operator::Operator;
use crate::{ElasticityError, FluidLayer, Inversion, Lame, Law, Solid};
use fem::NodalBatches;
use mesh::{Mesh, NodeNumbering};
use newton_krylov::inner_product::{Euclidean, InnerProduct};
use tensor::Dual;

/// The equations of motion of an elastic body in the coordinates of its mesh, where it is at rest (total Lagrangian),
///
/// ```text
/// rho d_tt - div P(grad d) = b,    P n = q on loaded boundaries,    d = g on supports                          (elastodynamics)
/// M d_tt + C d_t + R(d) = f(t)     at free entries                                                             (motion of nodes)
/// ```
///
/// rho is the density at rest, C a [`Damping`], and R the forces of a [`Law`]; for the linear one R(d) = K d. K(d) is the derivative of R,
/// and K its value at rest.
///
/// An entry is one component of one C0 node; vectors have the layout `[C0 node][component]`. An entry is either free or fixed; the
/// motion of a fixed entry is prescribed. All methods take `&self`.
pub struct Structure<const D: usize> {
    operator: Operator<D>,
    /// The contribution of lambda to R beyond `operator`, if Poisson's ratio varies: see `solid`.
    excess: Option<Operator<D>>,
    mass: Mass<D>,
    surface: Surface<D>,
    fixed: Vec<[bool; D]>,
    coordinates: Vec<[f64; D]>,
    mesh: Mesh<D>,
    numbering: NodeNumbering,
    solid: Solid<D>,
    damping: Damping,
    /// A shear modulus of the body.
    shear_modulus: f64,
}

impl<const D: usize> Structure<D> {
    /// A body of `solid` (or a constant `Material`) and `density` that fills `mesh`, with displacements of the order of
    /// `numbering`. `fixed[node][component]` tells whether the motion is prescribed; it may be prescribed nowhere.
    ///
    /// # Errors
    /// A material out of range, [`ElasticityError::PlaneStress`], a density that is not positive, or a `fixed` of the wrong length.
    pub fn new(
        mesh: Mesh<D>,
        numbering: NodeNumbering,
        solid: impl Into<Solid<D>>,
        density: f64,
        fixed: Vec<[bool; D]>,
    ) -> Result<Self, ElasticityError> {
        if fixed.len() != numbering.count {
            let (found, expected) = (fixed.len(), numbering.count);
            return Err(ElasticityError::Length { array: "the list of fixed nodes", found, expected });
        }
        if !(density > 0.0 && density.is_finite()) {
            let (constant, accepted) = ("the density", "a positive number");
            return Err(ElasticityError::Material { constant, value: density, accepted });
        }
        let (order, batches) = (numbering.order(), NodalBatches::new(&numbering));
        let mass = Mass::new(&mesh, &batches, order, density);
        let solid = solid.into();
        let (law, base) = (solid.law()?, solid.base()?);
        let at_points = StiffnessSampler::of_solid(&mesh, &solid, base, law.rule(D, order));
        let excess = if solid.ratio_varies() {
            let (unit, batches) = (Lame { mu: 0.0, lambda: 1.0 }, NodalBatches::new(&numbering));
            Some(Operator::weighted(law, unit, order, batches, &at_points, |sample| sample.excess)?)
        } else {
            None
        };
        let operator = Operator::new(law, base, order, batches, &at_points)?;
        let shear_modulus = solid.lame(&mesh.position(0, &[0.0; D]))?.mu;
        let surface = Surface::new(&mesh, &numbering);
        let coordinates = nodal_coordinates(&mesh, &numbering);
        Ok(Structure {
            operator,
            excess,
            mass,
            surface,
            fixed,
            coordinates,
            mesh,
            numbering,
            solid,
            damping: Damping::default(),
            shear_modulus,
        })
    }

    /// The length of a vector: D times the number of C0 nodes.
    pub fn length(&self) -> usize {
        self.fixed.len() * D
    }
    /// The position at rest of every C0 node.
    pub fn coordinates(&self) -> &[[f64; D]] {
        &self.coordinates
    }
    /// For every entry of a vector, whether its motion is prescribed.
    pub fn fixed(&self) -> &[bool] {
        self.fixed.as_flattened()
    }
    /// The mesh at rest.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.mesh
    }
    /// Its C0 nodes.
    pub fn numbering(&self) -> &NodeNumbering {
        &self.numbering
    }

    /// The law.
    pub fn law(&self) -> Law {
        self.solid.law
    }

    /// out = R(d) on all entries, fixed or not.
    ///
    /// # Errors
    /// [`Inversion`] where the law has no stress; `out` then has no meaning.
    pub fn internal_forces(&self, d: &[f64], out: &mut [f64]) -> Result<(), Inversion> {
        self.operator.forces(d, out)?;
        self.add_excess(out, |excess, out| excess.forces(d, out))
    }

    /// out = K(d) w on all entries, fixed or not, for a `d` where R is defined. A linear law does not look at `d`.
    pub fn apply_stiffness_at(&self, d: &[f64], w: &[f64], out: &mut [f64]) {
        self.operator.product(d, w, out);
        // A product has no error.
        let _ = self.add_excess(out, |excess, out| {
            excess.product(d, w, out);
            Ok(())
        });
    }

    /// out = K(d) w without the part proportional to the stress, on all entries: int F C : sym(F^T grad w) : grad phi. It is positive
    /// semi-definite for any `d`. C is the tensor of elasticity at zero strain; for the law of St. Venant and Kirchhoff C is constant.
    pub(crate) fn apply_material_stiffness_at(&self, d: &[f64], w: &[f64], out: &mut [f64]) {
        if self.law().is_linear() {
            return self.apply_stiffness_at(d, w, out);
        }
        self.operator.viscous_forces(d, w, out);
        // These forces have no error.
        let _ = self.add_excess(out, |excess, out| {
            excess.viscous_forces(d, w, out);
            Ok(())
        });
    }

    /// out = K w on all entries, fixed or not.
    pub fn apply_stiffness(&self, w: &[f64], out: &mut [f64]) {
        if self.law().is_linear() {
            return self.apply_stiffness_at(w, w, out);
        }
        self.apply_stiffness_at(&vec![0.0; w.len()], w, out);
    }

    /// Adds to `out` the part of the forces that `excess` holds.
    fn add_excess(
        &self,
        out: &mut [f64],
        apply: impl FnOnce(&Operator<D>, &mut [f64]) -> Result<(), Inversion>,
    ) -> Result<(), Inversion> {
        let Some(excess) = &self.excess else { return Ok(()) };
        let mut forces = vec![0.0; out.len()];
        apply(excess, &mut forces)?;
        out.iter_mut().zip(&forces).for_each(|(out, force)| *out += force);
        Ok(())
    }

    /// out = M v on all entries, fixed or not.
    pub fn apply_mass(&self, v: &[f64], out: &mut [f64]) {
        self.mass.apply(self.operator.batches(), v, out);
    }

    /// out = (M + `layer`) v. The layer is a mass of every node; empty means none.
    pub(crate) fn apply_mass_with(&self, layer: &[[[f64; D]; D]], v: &[f64], out: &mut [f64]) {
        self.apply_mass(v, out);
        for ((mass, v), out) in layer.iter().zip(v.chunks_exact(D)).zip(out.chunks_exact_mut(D)) {
            (0..D).for_each(|i| out[i] += (0..D).map(|j| mass[i][j] * v[j]).sum::<f64>());
        }
    }

    /// out = (M + added mass) v, where `fluid` moves along at the rate |lambda| / dt.
    pub fn apply_mass_beside(&self, fluid: &FluidLayer<D>, rate: f64, v: &[f64], out: &mut [f64]) {
        self.apply_mass_with(&fluid.masses(rate), v, out);
    }

    /// out = f(t), on all entries.
    ///
    /// # Errors
    /// [`ElasticityError::Load`] if a load, or a follower pressure on the body at rest, is not a finite number.
    pub fn load(&self, loads: &Loads<D>, t: f64, out: &mut [f64]) -> Result<(), ElasticityError> {
        loads.assemble(&self.mass, self.operator.batches(), &self.surface, t, out);
        self.check_load(t, out)?;
        if loads.pressures.is_empty() {
            return Ok(());
        }
        let (rest, mut followers) = (vec![0.0; out.len()], vec![0.0; out.len()]);
        self.add_pressures(loads, t, &rest, &mut followers);
        self.check_load(t, &followers)
    }

    fn check_load(&self, time: f64, load: &[f64]) -> Result<(), ElasticityError> {
        let Some(entry) = load.iter().position(|f| !f.is_finite()) else { return Ok(()) };
        Err(ElasticityError::Load { time, position: self.coordinates[entry / D].to_vec(), value: load[entry] })
    }

    /// out += the follower pressures of `loads` on the body displaced by `d`.
    pub fn add_pressures(&self, loads: &Loads<D>, t: f64, d: &[f64], out: &mut [f64]) {
        loads.add_pressures(&self.surface, t, d, out);
    }

    /// out += `factor` times the derivative of these forces along w. The pair holds d and w.
    pub fn add_pressure_stiffness(
        &self,
        loads: &Loads<D>,
        t: f64,
        (d, w): (&[f64], &[f64]),
        factor: f64,
        out: &mut [f64],
    ) {
        if loads.pressures.is_empty() {
            return;
        }
        let d: Vec<Dual<f64>> = d.iter().zip(w).map(|(d, w)| Dual::new(*d, *w)).collect();
        let mut forces = vec![Dual::new(0.0, 0.0); out.len()];
        loads.add_pressures(&self.surface, t, &d, &mut forces);
        out.iter_mut().zip(&forces).for_each(|(out, force)| *out += factor * force.derivative);
    }

    /// v . M v / 2
    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        let mut momentum = vec![0.0; v.len()];
        self.apply_mass(v, &mut momentum);
        0.5 * Euclidean.dot(v, &momentum)
    }

    /// The strain energy of the displacement `d`: d . K d / 2 for the linear law.
    pub fn strain_energy(&self, d: &[f64]) -> f64 {
        if !self.law().is_linear() {
            return self.operator.energy(d) + self.excess.as_ref().map_or(0.0, |excess| excess.energy(d));
        }
        let mut forces = vec![0.0; d.len()];
        self.apply_stiffness(d, &mut forces);
        0.5 * Euclidean.dot(d, &forces)
    }

    /// Sets the fixed entries of a vector, or of several one after the other.
    pub(crate) fn at_fixed(&self, vectors: &mut [f64], value: impl Fn(usize) -> f64) {
        let length = self.length();
        for (k, vector) in vectors.chunks_exact_mut(length).enumerate() {
            for (i, _) in self.fixed().iter().enumerate().filter(|(_, fixed)| **fixed) {
                vector[i] = value(k * length + i);
            }
        }
    }
}

//! An elastic body with mass.

use crate::batches::Batches;
use crate::geometry::{Sampler, nodal_coordinates};
use crate::loads::{Loads, Surface};
use crate::low_order::LowOrder;
use crate::mass::Mass;
use crate::operator::Operator;
use crate::shifted::Shifted;
use crate::{ElasticityError, Lame, Law, Solid};
use basis::gauss_lobatto;
use mesh::{Mesh, NodeNumbering};
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// The equations of motion of a linear elastic body at rest in the position of its mesh,
///
/// ```text
/// rho d_tt - div sigma(d) = b,    sigma n = q on loaded boundaries,    d = g on supports                       (elastodynamics)
/// M d_tt + K d = f(t)             at free entries                                                              (motion of nodes)
/// ```
///
/// An entry is one component of one C0 node; vectors have the layout `[C0 node][component]`, and an entry is either free or fixed: its
/// motion then is prescribed. All methods take `&self`.
pub struct Structure<const D: usize> {
    operator: Operator<D>,
    /// What lambda adds to K beyond `operator`, where Poisson's ratio varies: see `solid`.
    excess: Option<Operator<D>>,
    mass: Mass<D>,
    surface: Surface<D>,
    fixed: Vec<[bool; D]>,
    coordinates: Vec<[f64; D]>,
    mesh: Mesh<D>,
    numbering: NodeNumbering,
    solid: Solid<D>,
    /// A shear modulus of the body.
    shear_modulus: f64,
}

impl<const D: usize> Structure<D> {
    /// A body of `solid` (or a `Material`, the same everywhere) and `density` that fills `mesh`, with displacements of the
    /// order of `numbering`. `fixed[node][component]` says where the motion is prescribed; it may be so nowhere.
    ///
    /// # Errors
    /// A material that is not possible, a density that is not positive, or a `fixed` of the wrong length.
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
        let (order, batches) = (numbering.order(), Batches::new(&mesh, &numbering));
        let mass = Mass::new(&mesh, &batches, order, density);
        let (solid, rule) = (solid.into(), Law::Linear.rule(D, order));
        let base = solid.base()?;
        let at_points = Sampler::of_solid(&mesh, &solid, base, &rule.points);
        let excess = if solid.ratio_varies() {
            let (unit, batches) = (Lame { mu: 0.0, lambda: 1.0 }, Batches::new(&mesh, &numbering));
            Some(Operator::weighted(Law::Linear, unit, order, batches, &rule, &at_points, |sample| sample.excess)?)
        } else {
            None
        };
        let operator = Operator::new(Law::Linear, base, order, batches, &rule, &at_points)?;
        let shear_modulus = solid.lame(&mesh.position(0, &[0.0; D]))?.mu;
        let surface = Surface::new(&mesh, &numbering);
        let coordinates = nodal_coordinates(&mesh, &numbering);
        Ok(Structure { operator, excess, mass, surface, fixed, coordinates, mesh, numbering, solid, shear_modulus })
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

    /// out = K d on all entries, fixed or not.
    pub fn apply_stiffness(&self, d: &[f64], out: &mut [f64]) {
        // A linear K is the same everywhere.
        self.operator.product(d, d, out);
        if let Some(excess) = &self.excess {
            let mut forces = vec![0.0; out.len()];
            excess.product(d, d, &mut forces);
            out.iter_mut().zip(&forces).for_each(|(out, force)| *out += force);
        }
    }

    /// out = M v on all entries, fixed or not.
    pub fn apply_mass(&self, v: &[f64], out: &mut [f64]) {
        self.mass.apply(self.operator.batches(), v, out);
    }

    /// out = f(t), on all entries.
    ///
    /// # Errors
    /// [`ElasticityError::Load`] if a load is not a finite number.
    pub fn load(&self, loads: &Loads<D>, t: f64, out: &mut [f64]) -> Result<(), ElasticityError> {
        loads.assemble(&self.mass, self.operator.batches(), &self.surface, t, out);
        match out.iter().position(|f| !f.is_finite()) {
            Some(entry) => {
                let position = self.coordinates[entry / D].to_vec();
                Err(ElasticityError::Load { time: t, position, value: out[entry] })
            }
            None => Ok(()),
        }
    }

    /// v . M v / 2
    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        let mut momentum = vec![0.0; v.len()];
        self.apply_mass(v, &mut momentum);
        0.5 * Euclidean.dot(v, &momentum)
    }

    /// d . K d / 2
    pub fn strain_energy(&self, d: &[f64]) -> f64 {
        let mut forces = vec![0.0; d.len()];
        self.apply_stiffness(d, &mut forces);
        0.5 * Euclidean.dot(d, &forces)
    }

    /// The preconditioner of K + m M at free entries.
    pub(crate) fn shifted(&self, m: f64) -> Result<Shifted<D>, ElasticityError> {
        let (base, cells) = (self.solid.base()?, self.mesh.n_cells());
        let nodes = gauss_lobatto(self.numbering.order()).points;
        let at_nodes = Sampler::of_solid(&self.mesh, &self.solid, base, &nodes);
        let mass = m * self.mass.density();
        let samples = |cell| at_nodes.cell(cell);
        let low_order = LowOrder::new(base, mass, cells, &self.numbering, samples, &self.fixed, None)?;
        Ok(Shifted { m, low_order })
    }

    /// m of the size of the lowest squared frequency of a compact body: (mu / rho) / (diameter)^2.
    pub(crate) fn typical_shift(&self) -> f64 {
        self.shear_modulus / self.mass.density() / self.mesh.diameter().powi(2)
    }

    /// Sets the fixed entries.
    pub(crate) fn at_fixed(&self, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        for (i, _) in self.fixed().iter().enumerate().filter(|(_, fixed)| **fixed) {
            vector[i] = value(i);
        }
    }
}

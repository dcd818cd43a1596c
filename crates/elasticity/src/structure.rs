//! An elastic body with mass.

use crate::geometry::{StiffnessSampler, nodal_coordinates, node_spacing};
use crate::loads::{Loads, Surface};
use crate::low_order::{Inertia, LowOrder};
use crate::mass::Mass;
use crate::operator::Operator;
use crate::shifted::Shifted;
use crate::{ElasticityError, FluidLayer, Inversion, Lame, Law, Solid};
use basis::gauss_lobatto;
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
/// rho is the density at rest, C a [`Damping`], and R the forces of a [`Law`]; for the linear one R(d) = K d. K(d) is their derivative, and
/// K that at rest.
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

/// The damping C = alpha M + beta K of Rayleigh; where the law is not linear K is that of (viscous) of `law`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// alpha
    pub mass: f64,
    /// beta
    pub stiffness: f64,
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
        let (order, batches) = (numbering.order(), NodalBatches::new(&mesh, &numbering));
        let mass = Mass::new(&mesh, &batches, order, density);
        let solid = solid.into();
        let (law, base) = (solid.law()?, solid.base()?);
        let at_points = StiffnessSampler::of_solid(&mesh, &solid, base, law.rule(D, order));
        let excess = if solid.ratio_varies() {
            let (unit, batches) = (Lame { mu: 0.0, lambda: 1.0 }, NodalBatches::new(&mesh, &numbering));
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

    /// The same body with `damping`.
    pub fn with_damping(self, damping: Damping) -> Self {
        Structure { damping, ..self }
    }

    /// The damping.
    pub fn damping(&self) -> Damping {
        self.damping
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

    /// out = K w on all entries, fixed or not.
    pub fn apply_stiffness(&self, w: &[f64], out: &mut [f64]) {
        if self.law().is_linear() {
            return self.apply_stiffness_at(w, w, out);
        }
        self.apply_stiffness_at(&vec![0.0; w.len()], w, out);
    }

    /// Adds to `out` what lambda does beyond `operator`.
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

    /// out = (M + `layer`) v, where the layer is a mass of every node, none if that is empty.
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

    /// out += C v at the displacement `d`.
    pub(crate) fn add_damping(&self, d: &[f64], v: &[f64], out: &mut [f64]) {
        self.add_damping_by(v, out, |operator, out| operator.viscous_forces(d, v, out));
    }

    /// out += the derivative of C v at the displacement and velocity `at` along the displacement and velocity `along`.
    pub(crate) fn add_damping_product(&self, at: (&[f64], &[f64]), along: (&[f64], &[f64]), out: &mut [f64]) {
        self.add_damping_by(along.1, out, |operator, out| operator.viscous_product(at, along, out));
    }

    /// out += alpha M v + beta K v, where of a law that is not linear K v is what `viscous` says.
    fn add_damping_by(&self, v: &[f64], out: &mut [f64], viscous: impl Fn(&Operator<D>, &mut [f64])) {
        let Damping { mass, stiffness } = self.damping;
        let mut force = vec![0.0; out.len()];
        let mut add = |factor: f64, apply: &dyn Fn(&mut [f64])| {
            if factor != 0.0 {
                apply(&mut force);
                out.iter_mut().zip(&force).for_each(|(out, force)| *out += factor * force);
            }
        };
        add(mass, &|force| self.apply_mass(v, force));
        if self.law().is_linear() {
            return add(stiffness, &|force| self.apply_stiffness(v, force));
        }
        for operator in [&self.operator].into_iter().chain(&self.excess) {
            add(stiffness, &|force| viscous(operator, force));
        }
    }

    /// out += the follower pressures of `loads` on the body displaced by `d`.
    pub fn add_pressures(&self, loads: &Loads<D>, t: f64, d: &[f64], out: &mut [f64]) {
        loads.add_pressures(&self.surface, t, d, out);
    }

    /// out += `factor` times the derivative of that along `w`, where d and w are given as a pair.
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

    /// The low-order matrix of K(d) + m M at free entries and what else describes it, for the `position` d, at rest if that is empty. M has
    /// the additional mass `layer` of every node, none if that is empty.
    ///
    /// K(d) is taken for linear elasticity on the mesh that d has moved. A curved cell may be valid where a sub-cell between its nodes is
    /// inverted: then it is that of the mesh at rest, which costs iterations, but no accuracy.
    pub(crate) fn shifted(
        &self,
        m: f64,
        layer: Vec<[[f64; D]; D]>,
        position: &[f64],
    ) -> Result<Shifted<D>, ElasticityError> {
        let rest = vec![0.0; if self.law().is_linear() { 0 } else { self.length() }];
        let moved = !rest.is_empty() && position.iter().any(|d| *d != 0.0);
        let low_order = match self.low_order(m, &layer, if moved { position } else { &[] }) {
            Err(ElasticityError::SubCell { .. }) if moved => self.low_order(m, &layer, &[])?,
            built => built?,
        };
        Ok(Shifted { m, low_order, layer, position: if moved { position.to_vec() } else { rest } })
    }

    fn low_order(&self, m: f64, layer: &[[[f64; D]; D]], d: &[f64]) -> Result<LowOrder<D>, ElasticityError> {
        let base = self.solid.base()?;
        let nodes = gauss_lobatto(self.numbering.order());
        let at_nodes = StiffnessSampler::of_solid(&self.mesh, &self.solid, base, nodes);
        let inertia = Inertia { m, density: self.mass.density(), layer };
        let samples = |cell: usize| {
            let mut samples = at_nodes.cell(cell)?;
            for (sample, node) in samples.iter_mut().zip(self.numbering.cell(cell)).filter(|_| !d.is_empty()) {
                (0..D).for_each(|i| sample.position[i] += d[node * D + i]);
            }
            Ok(samples)
        };
        LowOrder::new(base, inertia, &self.numbering, samples, &self.fixed, None)
    }

    /// The lumped integral of n n^T over those boundary facets whose nodes all are `wet`, by C0 node.
    pub fn wet_areas(&self, wet: &[bool]) -> Vec<[[f64; D]; D]> {
        self.surface.areas(wet)
    }

    /// The diagonal of K + m M with lumped masses: the scale of the forces at every entry.
    pub fn force_scales(&self, m: f64) -> Vec<f64> {
        let (mut scales, mut excess, mut masses) =
            (vec![0.0; self.length()], vec![0.0; self.length()], vec![0.0; self.length()]);
        self.operator.diagonal(&mut scales);
        if let Some(operator) = &self.excess {
            operator.diagonal(&mut excess);
        }
        self.apply_mass(&vec![1.0; self.length()], &mut masses);
        scales.iter_mut().zip(excess.iter().zip(&masses)).for_each(|(k, (excess, mass))| *k += excess + m * mass);
        scales
    }

    /// The distance of every C0 node to the nearest neighbour on its lines.
    pub fn node_spacing(&self) -> Vec<f64> {
        node_spacing(&self.mesh, &self.numbering)
    }

    /// An m of the size of the lowest squared frequency of a compact body: (mu / rho) / (diameter)^2.
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

//! The coarse level of steady flows: what ILU(0) takes many sweeps to carry across the mesh, a direct solver carries at once.
//!
//! ```text
//! x_1 = P (P^T B P)^{-1} P^T r,     z = x_1 + S^{-1} (r - B x_1),     B = lambda M + dt A                              (two-level)
//! ```
//!
//! with the polynomials of degree 1 in every cell as coarse space, P their values at the nodes, and the sweeps S of the factored mode.
//! B P is kept, so that a product with B costs no more than the few columns of P. On the airfoil of the heaving cases the last four steps,
//! which pseudo-time does not damp, then take 29 iterations instead of 117.

use super::blocks::{Link, coupling_block, diagonal_block};
use super::ilu::BlockIlu;
use basis::{Lagrange, Matrix};
use faer::{Mat, MatRef};
use fem::{Layout, TraceSpace};
use newton_krylov::operator::Preconditioner;
use rayon::prelude::*;
use sparse::{BlockMatrix, EliminationTree, Factorisation, Kind};
use std::sync::Arc;

/// Coarse unknowns of a three-dimensional mesh for which a direct solver of degree 1 pays: its work grows with their square, and
/// with 27,000 it takes as long as a hundred iterations.
const AFFORDABLE: usize = 12_000;

/// Coarse functions of one component per direction, on a mesh of so many cells with a flow of this `order`. There are 2 of degree 1, or
/// one constant if the order has no more or linear functions cost too much.
pub fn functions_per_direction(cells: usize, components: usize, dimension: u32, order: usize) -> usize {
    let linear = cells * components * 2_usize.pow(dimension);
    if order > 2 && (dimension < 3 || linear <= AFFORDABLE) { 2 } else { 1 }
}

/// P of one component of a cell, `[node][coarse function]`: products of (1 - x) / 2 and (1 + x) / 2 at `order` nodes per direction.
fn prolongation(dimension: u32, order: usize, per_direction: usize) -> Matrix {
    let nodes = Lagrange::gauss_lobatto(order).nodes().to_vec();
    let value = |node: usize, function: usize| match per_direction {
        1 => 1.0,
        _ if function == 0 => 0.5 * (1.0 - nodes[node]),
        _ => 0.5 * (1.0 + nodes[node]),
    };
    Matrix::from_fn(order.pow(dimension), per_direction.pow(dimension), |i, a| {
        (0..dimension).map(|d| value(i / order.pow(d) % order, a / per_direction.pow(d) % per_direction)).product()
    })
}

/// The part of B P that a link brings to its cell: rows traces of the cell, columns coarse functions of the neighbour.
struct CoupledImage {
    link: Link,
    image: Mat<f64>,
}

/// The coarse level of a mode with a real eigenvalue.
pub struct CoarseLevel {
    layout: Layout,
    prolongation: Matrix,
    /// P of a cell, all components.
    p: Mat<f64>,
    /// T_f P.
    traces: Vec<Mat<f64>>,
    /// B_ii P of every cell.
    images: Vec<Mat<f64>>,
    /// B_ik P of every cell.
    coupled: Vec<Vec<CoupledImage>>,
    tree: Arc<EliminationTree>,
    /// Of P^T B P, once it is assembled.
    factors: Option<Factorisation<f64>>,
    coefficients: Vec<f64>,
    solve: Vec<f64>,
    rest: Vec<f64>,
}

impl CoarseLevel {
    /// The coarse level of lambda M + dt A, with dt and the one mode of `sweeps`, undamped; `order` nodes per direction.
    ///
    /// # Errors
    /// If memory runs out.
    pub fn new(sweeps: &BlockIlu<f64>, order: usize) -> Result<Option<Self>, sparse::Error> {
        let (layout, links, jacobian) = (sweeps.layout, sweeps.links(), &sweeps.jacobian);
        let (components, dimension) = (jacobian.block / jacobian.traces.nodes, layout.nodes.ilog(order));
        let functions = functions_per_direction(layout.cells, components, dimension, order);
        let prolongation = prolongation(dimension, order, functions);
        let p = over_components(&prolongation, components);
        let faces = links.iter().flatten().map(|link| link.face + 1).max().unwrap_or(0);
        let traces = (0..faces).map(|face| traces_of(&jacobian.traces, face, &p)).collect();
        let coarse = CoarseLevel {
            layout,
            prolongation,
            traces,
            images: Vec::new(),
            coupled: Vec::new(),
            tree: Arc::new(zero_matrix(links, p.ncols()).elimination_tree()?),
            factors: None,
            coefficients: vec![0.0; layout.cells * p.ncols()],
            solve: Vec::new(),
            rest: vec![0.0; layout.len()],
            p,
        };
        Ok(coarse.updated(sweeps))
    }

    /// The same with the dt and the A that `sweeps` have now; None if the coarse matrix is singular.
    pub fn updated(mut self, sweeps: &BlockIlu<f64>) -> Option<Self> {
        let (dt, lambda) = (sweeps.dt, sweeps.modes.eigenvalues[0].re);
        let (jacobian, t, traces) = (&sweeps.jacobian, sweeps.jacobian.traces.len(), &self.traces);
        let image = |cell: usize| diagonal_block(jacobian, cell, dt, lambda) * &self.p;
        self.images = (0..self.layout.cells).into_par_iter().map(image).collect();
        let coupled_image = |link: &Link| {
            let block = MatRef::from_column_major_slice(coupling_block(jacobian, *link), t, t);
            CoupledImage { link: *link, image: faer::Scale(dt) * (block * &traces[link.other_face]) }
        };
        self.coupled = sweeps.links().par_iter().map(|links| links.iter().map(coupled_image).collect()).collect();
        // The memory of old factors is free before new ones are made.
        self.factors = None;
        self.factors = Some(self.assemble(sweeps.links()).factor(self.tree.clone()).ok()?);
        Some(self)
    }

    /// P^T B P.
    fn assemble(&self, links: &[Vec<Link>]) -> BlockMatrix<f64> {
        let mut matrix = zero_matrix(links, self.p.ncols());
        for (cell, (image, coupled)) in self.images.iter().zip(&self.coupled).enumerate() {
            let own = self.p.transpose() * image;
            matrix.add(cell, cell, |i, j| own[(i, j)]);
            for CoupledImage { link, image } in coupled {
                let block = self.traces[link.face].transpose() * image;
                matrix.add(cell, link.cell, |i, j| block[(i, j)]);
            }
        }
        matrix
    }

    /// Bytes of B P and of the factors.
    pub fn bytes(&self) -> usize {
        let images = self.images.iter().chain(self.coupled.iter().flatten().map(|coupled| &coupled.image));
        let factors = self.factors.as_ref().map_or(0, Factorisation::bytes);
        images.map(|image| image.nrows() * image.ncols() * size_of::<f64>()).sum::<usize>() + factors
    }

    /// z by (two-level).
    pub fn apply(&mut self, sweeps: &mut BlockIlu<f64>, r: &[f64], z: &mut [f64]) {
        self.restrict(r);
        if let Some(factors) = &self.factors {
            factors.solve(&mut self.coefficients, 1, &mut self.solve);
        }
        let mut rest = std::mem::take(&mut self.rest);
        rest.copy_from_slice(r);
        self.subtract_images(&sweeps.jacobian.traces, &mut rest);
        sweeps.apply(&rest, z);
        self.rest = rest;
        self.add_prolonged(z);
    }

    /// Coarse functions of a cell.
    fn columns(&self) -> usize {
        self.coefficients.len() / self.layout.cells
    }

    /// P^T r.
    fn restrict(&mut self, r: &[f64]) {
        let (nodes, functions) = (self.prolongation.rows(), self.prolongation.cols());
        let components = self.coefficients.par_chunks_exact_mut(functions).zip(r.par_chunks_exact(nodes));
        components.with_min_len(64).for_each(|(coarse, r)| {
            coarse.fill(0.0);
            for (i, r) in r.iter().enumerate() {
                coarse.iter_mut().zip(self.prolongation.row(i)).for_each(|(c, p)| *c += p * r);
            }
        });
    }

    /// z += P x for the coefficients x.
    fn add_prolonged(&self, z: &mut [f64]) {
        let (nodes, functions) = (self.prolongation.rows(), self.prolongation.cols());
        let components = z.par_chunks_exact_mut(nodes).zip(self.coefficients.par_chunks_exact(functions));
        components.with_min_len(64).for_each(|(z, coarse)| {
            for (i, z) in z.iter_mut().enumerate() {
                *z += self.prolongation.row(i).iter().zip(coarse).map(|(p, c)| p * c).sum::<f64>();
            }
        });
    }

    /// rest -= B P x.
    fn subtract_images(&self, traces: &TraceSpace, rest: &mut [f64]) {
        let columns = self.columns();
        let x = |cell: usize| &self.coefficients[cell * columns..(cell + 1) * columns];
        let cells = rest.par_chunks_exact_mut(self.layout.cell_len()).enumerate().with_min_len(16);
        cells.for_each_init(
            || vec![0.0; traces.len()],
            |sent, (cell, rest)| {
                subtract_product(&self.images[cell], x(cell), rest);
                for CoupledImage { link, image } in &self.coupled[cell] {
                    sent.fill(0.0);
                    subtract_product(image, x(link.cell), sent);
                    for (trace, sent) in sent.iter().enumerate() {
                        let (offset, functional) = traces.functional(link.face, trace);
                        functional.iter().for_each(|&(node, weight)| rest[offset + node] += weight * sent);
                    }
                }
            },
        );
    }
}

/// The matrix without entries of the coarse unknowns of cells, `block` in each.
fn zero_matrix(links: &[Vec<Link>], block: usize) -> BlockMatrix<f64> {
    let neighbours = links.iter().map(|links| links.iter().map(|link| link.cell).collect()).collect();
    BlockMatrix::new(Kind::Lu, block, neighbours)
}

/// y -= A x, column by column.
fn subtract_product(matrix: &Mat<f64>, x: &[f64], y: &mut [f64]) {
    for (j, x) in x.iter().enumerate() {
        let column = matrix.col_as_slice(j);
        y.iter_mut().zip(column).for_each(|(y, a)| *y -= a * x);
    }
}

/// P of all components of a cell: one block for each.
fn over_components(p: &Matrix, components: usize) -> Mat<f64> {
    let (nodes, functions) = (p.rows(), p.cols());
    Mat::from_fn(components * nodes, components * functions, |i, j| {
        if i / nodes == j / functions { p.row(i % nodes)[j % functions] } else { 0.0 }
    })
}

/// T_f P: the traces of the coarse functions on `face`.
fn traces_of(traces: &TraceSpace, face: usize, p: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(traces.len(), p.ncols(), |trace, column| {
        let (offset, functional) = traces.functional(face, trace);
        functional.iter().map(|&(node, weight)| weight * p[(offset + node, column)]).sum()
    })
}

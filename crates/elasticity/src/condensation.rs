//! A direct solver: static condensation to the skeleton of the mesh, and sparse Cholesky there.
//!
//! A node inside a cell is coupled with the nodes of that cell alone. With the nodes of a cell split into inner ones (i) and those of
//! the skeleton (s),
//!
//! ```text
//! S = sum over cells of  K_ss - K_si K_ii^{-1} K_is                                                            (condensation)
//! S d_s = f_s - sum over cells of  K_si K_ii^{-1} f_i
//! d_i = K_ii^{-1} f_i - (K_ii^{-1} K_is) d_s
//! ```
//!
//! Exact, without iterations; where it fits (in 2-D, and in 3-D for small meshes of low order) cheaper than the low-order factor. A cell
//! of order N stores dense matrices of D (N - 2)^D rows.

use crate::cholesky::{BlockMatrix, Cholesky, DenseCholesky, add_product};
use crate::{ElasticMesh, ElasticityError};
use faer::Mat;
use rayon::prelude::*;
use tensor::{Pack, WIDTH};

/// The condensed and factored K_ff of an [`ElasticMesh`].
pub struct Condensation<const D: usize> {
    cells: Vec<Cell>,
    /// The free C0 nodes that lie in several cells.
    skeleton: Vec<usize>,
    factor: Cholesky,
}

/// The free nodes of one cell and their matrices, with rows `[node][component]`.
struct Cell {
    /// The C0 nodes that lie in this cell only.
    inner: Vec<usize>,
    /// The positions of the other ones in the list of skeleton nodes.
    skeleton: Vec<usize>,
    /// K_ii = L L^T.
    factor: DenseCholesky,
    /// K_ii^{-1} K_is.
    extension: Mat<f64>,
}

impl<const D: usize> Condensation<D> {
    /// Condenses every cell, and factors S.
    ///
    /// # Errors
    /// [`ElasticityError::NotDefinite`] if too few nodes are constrained.
    pub fn new(mesh: &ElasticMesh<D>) -> Result<Self, ElasticityError> {
        let batches = mesh.operator().batches();
        let is_skeleton = |&node: &usize| !mesh.constrained()[node] && batches.multiplicity(node) > 1;
        let skeleton: Vec<usize> = (0..mesh.constrained().len()).filter(is_skeleton).collect();
        let mut unknowns = vec![None; mesh.constrained().len()];
        skeleton.iter().enumerate().for_each(|(unknown, &node)| unknowns[node] = Some(unknown));
        let condense = |batch| -> Vec<Result<(Cell, Mat<f64>), ElasticityError>> {
            let matrices = mesh.cell_matrices(batch);
            let cells = (batch * WIDTH..batches.cells()).take(WIDTH);
            cells.map(|cell| Cell::condense(mesh, cell, &unknowns, &matrices)).collect()
        };
        let condensed: Vec<_> = (0..batches.count()).into_par_iter().map(condense).collect();
        let (cells, schur) = condensed.into_iter().flatten().collect::<Result<(Vec<_>, Vec<_>), _>>()?;
        let factor = assemble::<D>(&cells, &schur, skeleton.len()).factor()?;
        Ok(Condensation { cells, skeleton, factor })
    }

    /// Solves K_ff d_f = f_f - K_fc d_c with the K of `mesh` that was condensed; `d` holds the prescribed displacement at constrained nodes, `f` the forces.
    pub fn solve(&self, mesh: &ElasticMesh<D>, f: &[f64], d: &mut [f64]) {
        let (mut boundary, mut b) = (vec![0.0; d.len()], vec![0.0; d.len()]);
        mesh.right_hand_side(Some(f), d, &mut boundary, &mut b);
        let mut s = entries::<D>(&b, &self.skeleton);
        for cell in &self.cells {
            // K_si K_ii^{-1} is the transpose of the extension.
            let mut reaction = Mat::zeros(cell.skeleton.len() * D, 1);
            add_product(&mut reaction, -1.0, cell.extension.transpose(), entries::<D>(&b, &cell.inner).as_ref());
            add_entries::<D>(&reaction, &cell.skeleton, &mut s);
        }
        self.factor.solve(s.col_as_slice_mut(0));
        for cell in &self.cells {
            let mut inner = entries::<D>(&b, &cell.inner);
            cell.factor.solve(inner.as_mut());
            let outer = entries::<D>(s.col_as_slice(0), &cell.skeleton);
            add_product(&mut inner, -1.0, cell.extension.as_ref(), outer.as_ref());
            set_entries::<D>(&inner, &cell.inner, d);
        }
        set_entries::<D>(&s, &self.skeleton, d);
    }
}

impl Cell {
    /// The cell and K_ss - K_si K_ii^{-1} K_is, for the skeleton numbers `unknowns[C0 node]` and the `matrices` of the cell's batch.
    fn condense<const D: usize>(
        mesh: &ElasticMesh<D>,
        cell: usize,
        unknowns: &[Option<usize>],
        matrices: &[Pack],
    ) -> Result<(Self, Mat<f64>), ElasticityError> {
        let nodes: Vec<usize> = mesh.operator().batches().cell_nodes(cell).collect();
        let on_skeleton = |&k: &usize| unknowns[nodes[k]].is_some();
        let is_inner = |&k: &usize| unknowns[nodes[k]].is_none() && !mesh.constrained()[nodes[k]];
        let s: Vec<usize> = (0..nodes.len()).filter(on_skeleton).collect();
        let i: Vec<usize> = (0..nodes.len()).filter(is_inner).collect();
        // Row and column numbers of `matrices` are [component][node].
        let number = |list: &[usize], row: usize| row % D * nodes.len() + list[row / D];
        let entry = |row: usize, column: usize| matrices[column * nodes.len() * D + row].0[cell % WIDTH];
        let part = |rows: &[usize], columns: &[usize]| {
            Mat::from_fn(rows.len() * D, columns.len() * D, |a, b| entry(number(rows, a), number(columns, b)))
        };
        let factor = DenseCholesky::new(part(&i, &i))?;
        let coupling = part(&i, &s);
        let mut extension = coupling.clone();
        factor.solve(extension.as_mut());
        let mut schur = part(&s, &s);
        add_product(&mut schur, -1.0, coupling.transpose(), extension.as_ref());
        let skeleton = s.iter().filter_map(|&k| unknowns[nodes[k]]).collect();
        let inner = i.iter().map(|&k| nodes[k]).collect();
        Ok((Cell { inner, skeleton, factor, extension }, schur))
    }
}

/// S of the skeleton with `count` nodes: the sum of the cells' parts `schur`.
fn assemble<const D: usize>(cells: &[Cell], schur: &[Mat<f64>], count: usize) -> BlockMatrix<D> {
    let mut neighbours = vec![Vec::new(); count];
    for cell in cells {
        cell.skeleton.iter().for_each(|&node| neighbours[node].extend(&cell.skeleton));
    }
    let mut matrix = BlockMatrix::new(neighbours);
    for (cell, schur) in cells.iter().zip(schur) {
        for (k, &row) in cell.skeleton.iter().enumerate() {
            for (l, &column) in cell.skeleton.iter().enumerate() {
                let entry = |i: usize, j: usize| schur[(k * D + i, l * D + j)];
                matrix.add(row, column, &std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))));
            }
        }
    }
    matrix
}

/// The entries of `vector` at `nodes`, as a column.
fn entries<const D: usize>(vector: &[f64], nodes: &[usize]) -> Mat<f64> {
    Mat::from_fn(nodes.len() * D, 1, |row, _| vector[nodes[row / D] * D + row % D])
}

/// Sets the entries of `vector` at `nodes`.
fn set_entries<const D: usize>(column: &Mat<f64>, nodes: &[usize], vector: &mut [f64]) {
    (0..column.nrows()).for_each(|row| vector[nodes[row / D] * D + row % D] = column[(row, 0)]);
}

/// Adds to the entries of the column `sum` at `nodes`.
fn add_entries<const D: usize>(column: &Mat<f64>, nodes: &[usize], sum: &mut Mat<f64>) {
    (0..column.nrows()).for_each(|row| sum[(nodes[row / D] * D + row % D, 0)] += column[(row, 0)]);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Stiffness;
    use crate::testing::{clamped, distance, largest, noise, unit_box};
    use mesh::{BoxMesh, Curving, Mesh};

    fn agrees_with_iterations<const D: usize>(mesh: &Mesh<D>, order: usize) {
        let elastic = clamped(mesh, order, Stiffness::InverseJacobian { power: 1.0 });
        let random = noise(2 * elastic.length());
        let (forces, given) = random.split_at(elastic.length());
        let (mut direct, mut iterative) = (given.to_vec(), given.to_vec());
        Condensation::new(&elastic).unwrap().solve(&elastic, forces, &mut direct);
        elastic.solve(forces, &mut iterative, 1e-13).unwrap();
        assert!(distance(&direct, &iterative) < 1e-9 * largest(&direct), "D = {D}, N = {order}");
    }

    #[test]
    fn direct_and_iterative_agree() {
        for order in [2, 3, 6, 10] {
            agrees_with_iterations(&unit_box([4, 3], order, 0.03), order);
        }
        for order in [2, 3, 5] {
            agrees_with_iterations(&unit_box([3, 2, 2], order, 0.03), order);
        }
    }

    /// Nodes of one cell on both sides of a periodic boundary are one node.
    #[test]
    fn direct_and_iterative_agree_on_a_periodic_strip_one_cell_long() {
        let periodic = [true, false];
        let strip =
            BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [1, 3], order: 4, curving: Curving::None, periodic };
        agrees_with_iterations(&strip.build().unwrap(), 4);
    }
}

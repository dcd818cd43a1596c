//! K + m M on the sub-cells: its pattern and its entries.

use super::sub_cells::{Corner, SubCells};
use crate::ElasticityError;
use crate::geometry::Sample;
use crate::material::Lame;
use crate::multigrid::Couplings;
use mesh::NodeNumbering;

/// The mass in K + m M.
#[derive(Clone, Copy)]
pub(crate) struct Inertia<'a, const D: usize> {
    /// m
    pub(crate) m: f64,
    /// rho
    pub(crate) density: f64,
    /// The additional mass of every C0 node; may be empty.
    pub(crate) layer: &'a [[[f64; D]; D]],
}

impl<const D: usize> Inertia<'_, D> {
    pub(crate) fn none() -> Self {
        Inertia { m: 0.0, density: 0.0, layer: &[] }
    }
}

/// The unknown of every C0 node, by its place in `free`.
pub(super) fn unknowns_of(free: &[usize], count: usize) -> Vec<Option<usize>> {
    let mut unknowns = vec![None; count];
    free.iter().enumerate().for_each(|(unknown, &node)| unknowns[node] = Some(unknown));
    unknowns
}

/// For every unknown, the unknowns of larger number that share a sub-cell with it.
pub(super) fn later_neighbours<const D: usize>(
    numbering: &NodeNumbering,
    unknowns: &[Option<usize>],
) -> Vec<Vec<usize>> {
    let sub_cells = SubCells::<D>::new(numbering.order());
    let mut neighbours = vec![Vec::new(); unknowns.iter().flatten().count()];
    for cell in 0..numbering.n_cells() {
        sub_cells.couple(&of_cell(numbering, cell, unknowns), &mut neighbours);
    }
    neighbours
}

/// The unknowns at the nodes of a cell.
fn of_cell(numbering: &NodeNumbering, cell: usize, unknowns: &[Option<usize>]) -> Vec<Option<usize>> {
    numbering.cell(cell).iter().map(|&node| unknowns[node]).collect()
}

/// The unknowns that share a sub-cell, in flat lists: many small ones would leave holes in the memory.
pub(super) fn couplings<const D: usize>(numbering: &NodeNumbering, unknowns: &[Option<usize>]) -> Couplings {
    let sub_cells = SubCells::<D>::new(numbering.order());
    let (starts, places) = places_of_unknowns(numbering, unknowns);
    let (mut couplings, mut coupled) = (Couplings::new(), Vec::new());
    for unknown in starts.windows(2) {
        coupled.clear();
        for &[cell, node] in &places[unknown[0]..unknown[1]] {
            let nodes = numbering.cell(cell as usize);
            let near = sub_cells.around(node as usize).filter_map(|other| unknowns[nodes[other]]);
            coupled.extend(near.map(|other| other as u32));
        }
        coupled.sort_unstable();
        coupled.dedup();
        couplings.push(&coupled);
    }
    couplings
}

/// The cells of every unknown and its nodes in them, one unknown after the other, and the first of each.
fn places_of_unknowns(numbering: &NodeNumbering, unknowns: &[Option<usize>]) -> (Vec<usize>, Vec<[u32; 2]>) {
    let mut starts = vec![0; unknowns.iter().flatten().count() + 1];
    let visit = |see: &mut dyn FnMut(usize, [u32; 2])| {
        for cell in 0..numbering.n_cells() {
            for (node, number) in numbering.cell(cell).iter().enumerate() {
                unknowns[*number].into_iter().for_each(|unknown| see(unknown, [cell as u32, node as u32]));
            }
        }
    };
    visit(&mut |unknown, _| starts[unknown + 1] += 1);
    (1..starts.len()).for_each(|unknown| starts[unknown] += starts[unknown - 1]);
    let (mut next, mut places) = (starts.clone(), vec![[0; 2]; starts[starts.len() - 1]]);
    visit(&mut |unknown, place| {
        places[next[unknown]] = place;
        next[unknown] += 1;
    });
    (starts, places)
}

/// K + m M on the sub-cells of a mesh.
pub(crate) struct LowOrderTerms<'a, const D: usize> {
    pub(crate) lame: Lame,
    pub(crate) inertia: Inertia<'a, D>,
    pub(crate) numbering: &'a NodeNumbering,
    /// The samples of a cell at the Gauss-Lobatto nodes of the numbering's order.
    pub(crate) samples: &'a dyn Fn(usize) -> Result<Vec<Sample<D>>, ElasticityError>,
    /// The components that are held, by C0 node. Of their rows and columns only the diagonal is kept.
    pub(crate) fixed: &'a [[bool; D]],
}

impl<const D: usize> LowOrderTerms<'_, D> {
    /// The C0 nodes with a free component.
    pub(super) fn free(&self) -> Vec<usize> {
        (0..self.numbering.count).filter(|&node| self.fixed[node] != [true; D]).collect()
    }

    /// Adds K + m M of all cells, block by block. Rows and columns are unknowns, that is, places in `free`.
    pub(super) fn assemble(
        &self,
        free: &[usize],
        mut add: impl FnMut(usize, usize, &[[f64; D]; D]),
    ) -> Result<(), ElasticityError> {
        let mut add = |row: usize, column: usize, mut block: [[f64; D]; D]| {
            self.decouple([free[row], free[column]], &mut block);
            add(row, column, &block);
        };
        let (sub_cells, unknowns) = (SubCells::new(self.numbering.order()), unknowns_of(free, self.numbering.count));
        for cell in 0..self.numbering.n_cells() {
            let (unknowns, samples) = (of_cell(self.numbering, cell, &unknowns), (self.samples)(cell)?);
            sub_cells.visit_corners(cell, &samples, |corner| self.add_corner(corner, &unknowns, &mut add))?;
        }
        let Inertia { m, layer, .. } = self.inertia;
        let of_layer = free.iter().filter_map(|&node| layer.get(node)).enumerate();
        of_layer.for_each(|(unknown, layer)| add(unknown, unknown, layer.map(|row| row.map(|mass| m * mass))));
        Ok(())
    }

    /// Adds W block(grad phi_row, grad phi_column) for all pairs of functions, and the mass of the corner.
    fn add_corner(
        &self,
        corner: &Corner<D>,
        unknowns: &[Option<usize>],
        add: &mut impl FnMut(usize, usize, [[f64; D]; D]),
    ) {
        let own = corner.gradients.len() - 1;
        let mass = self.inertia.m * self.inertia.density * corner.volume;
        let lame = Lame { lambda: self.lame.lambda + corner.excess / corner.stiffness, ..self.lame };
        for (k, (row, grad_row)) in corner.gradients.iter().enumerate() {
            for (l, (column, grad_column)) in corner.gradients.iter().enumerate() {
                if let (Some(row), Some(column)) = (unknowns[*row], unknowns[*column]) {
                    let weighted = grad_column.map(|g| g * corner.volume * corner.stiffness);
                    let mut block = lame.block(grad_row, &weighted);
                    if (k, l) == (own, own) {
                        (0..D).for_each(|i| block[i][i] += mass);
                    }
                    add(row, column, block);
                }
            }
        }
    }

    /// Sets the rows and columns of fixed components to zero, except the diagonal, in the block of two nodes.
    fn decouple(&self, [row, column]: [usize; 2], block: &mut [[f64; D]; D]) {
        let (fixed_rows, fixed_columns) = (self.fixed[row], self.fixed[column]);
        for i in 0..D {
            for j in 0..D {
                let diagonal = row == column && i == j;
                if !diagonal && (fixed_rows[i] || fixed_columns[j]) {
                    block[i][j] = 0.0;
                }
            }
        }
    }
}

//! The graph of cells and the blocks on it, as the factorisation sees them.

use faer::Mat;
use fem::{SpaceJacobian, Stored};

/// How a cell couples to a neighbour: A_ik = T_f^T B T_g, i this cell, k the neighbour.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// The neighbour k.
    pub cell: usize,
    /// The number of the coupling.
    pub coupling: usize,
    /// 0 if this cell is on the minus side, 1 on the plus side.
    pub side: usize,
    /// The face f of this cell.
    pub face: usize,
    /// The face g of the neighbour.
    pub other_face: usize,
}

/// For every cell its links, in the order of couplings; none for ghosts, which come after the `own` cells.
pub fn links<T: Stored>(jacobian: &SpaceJacobian<T>, own: usize, ghosts: usize) -> Vec<Vec<Link>> {
    let mut links = vec![Vec::new(); own + ghosts];
    for (number, coupling) in jacobian.couplings.iter().enumerate() {
        for side in 0..2 {
            let (face, other_face) = (coupling.faces[side], coupling.faces[1 - side]);
            let cell = coupling.cells[1 - side];
            if coupling.cells[side] < own {
                links[coupling.cells[side]].push(Link { cell, coupling: number, side, face, other_face });
            }
        }
    }
    links
}

/// The block B of `link`: rows traces of this cell, columns traces of the neighbour, by columns.
pub fn coupling_block<T: Stored>(jacobian: &SpaceJacobian<T>, link: Link) -> &[T] {
    let coupling = &jacobian.couplings[link.coupling];
    if link.side == 0 { &coupling.minus_plus } else { &coupling.plus_minus }
}

/// lambda M + dt A_ii of `cell` for a real lambda.
pub fn diagonal_block<T: Stored>(jacobian: &SpaceJacobian<T>, cell: usize, dt: f64, lambda: f64) -> Mat<f64> {
    let (n, nodes) = (jacobian.block, jacobian.traces.nodes);
    let (a, mass) = (jacobian.block_of(cell), jacobian.mass_of(cell));
    Mat::from_fn(n, n, |i, j| {
        let m = if i / nodes == j / nodes { mass[j % nodes * nodes + i % nodes].into() } else { 0.0 };
        lambda * m + dt * a[j * n + i].into()
    })
}

//! The preconditioner by directions: every cell alone, one axis after the other.
//!
//! With the cell's operators along its lines (lines), of D axes, and the mean J of det J in the reference cell [-1, 1]^D,
//!
//! ```text
//! lambda M + dt A_cell  ~  (lambda J)^(1-D) 2^(D - D^2) F_D .. F_1,    F_k = lambda m_k + dt L_k                       (directions)
//! ```
//!
//! which is exact up to products of two and more L_k where coefficients are constant (alternating directions; Peaceman & Rachford
//! 1955). A block has as many rows as a line has unknowns, not as a cell has. At any order, set-up and application cost little beside residuals,
//! and the memory is small. It serves where slabs are short: where sound crosses no more than about the distance of two nodes, h / (N - 1), in each.
//! At order 8 iterations grow from 45 to 188 and 470 as it crosses 0.7, 1.7 and 3.3 times that distance, with blocks from 12 to 20.

use super::inverse::{Shape, as_real, invert};
use super::modal::{Split, join, largest};
use super::ordering::Ordering;
use super::panel::{Multiply, padded};
use super::{FactoredModes, FlowPreconditioner, TimeScales};
use basis::TemporalModes;
use faer::c64;
use fem::parallel::{self, Grain};
use fem::{Layout, LineJacobian, PerThread, Share, SlabOperator};
use newton_krylov::operator::Preconditioner;
use std::sync::Arc;
use tensor::Arch;

/// The inverses of (directions) for all temporal modes, in single precision.
pub struct LinePreconditioner {
    layout: Layout,
    share: Arc<Share>,
    modes: TemporalModes,
    jacobian: LineJacobian,
    /// F_k^{-1} with their scales as real matrices in panels, `[cell][mode][axis]`.
    inverses: Vec<f32>,
    arch: Arch,
    scratch: PerThread<Scratch>,
}

/// What is kept of one mode of a cell.
struct Scratch {
    /// Unknowns, `[part][component][node]`.
    cell: Vec<f32>,
    /// The same by lines along an axis, `[line][part][component][place]`.
    lines: Vec<f32>,
    /// Their images, `[line][part][padded row]`.
    images: Vec<f32>,
}

impl LinePreconditioner {
    /// Factors the modes of the Jacobian of `operator` in the middle of its slab.
    pub fn new<const D: usize, const M: usize>(operator: &SlabOperator<D, M>, scales: TimeScales) -> Self {
        let (layout, share, modes) =
            (operator.layout, operator.share.clone(), TemporalModes::new(&operator.tables.time));
        let jacobian = operator.line_jacobian(0.5);
        let (cell, block) = (2 * layout.time_len(), jacobian.block);
        let images = 2 * padded(block) * layout.nodes / jacobian.nodes;
        let room = || Scratch { cell: vec![0.0; cell], lines: vec![0.0; cell], images: vec![0.0; images] };
        let (arch, scratch) = (Arch::new(), PerThread::new(room));
        let mut preconditioner =
            LinePreconditioner { layout, share, modes, jacobian, inverses: Vec::new(), arch, scratch };
        preconditioner.factor(scales);
        preconditioner
    }

    /// Takes the Jacobian that `operator` has now.
    pub fn update<const D: usize, const M: usize>(&mut self, operator: &SlabOperator<D, M>, scales: TimeScales) {
        self.jacobian = operator.line_jacobian(0.5);
        self.factor(scales);
    }

    /// The blocks of the modes along one axis.
    fn shapes(&self) -> impl Iterator<Item = Shape> {
        let n = self.jacobian.block;
        self.modes.eigenvalues.iter().map(move |lambda| Shape::shifted(n, *lambda))
    }

    /// 2^(D-1) F_k^{-1}, along all axes but the first times lambda J: the product of all is the inverse of (directions).
    fn inverse(&self, cell: usize, axis: usize, shape: Shape, lambda: c64, dt: f64) -> Vec<f32> {
        let LineJacobian { dimension, nodes, block, .. } = self.jacobian;
        let (operator, mass) = (self.jacobian.operator(cell, axis), self.jacobian.mass(cell, axis));
        let (rows, across) = (padded(block), (1 << (dimension - 1)) as f64);
        let mean = mass.iter().map(|&m| f64::from(m)).sum::<f64>() / (1 << dimension) as f64;
        let scale = if axis == 0 { c64::new(across, 0.0) } else { lambda * (across * mean) };
        let mut f = vec![0.0; shape.len()];
        for (j, (f, l)) in f.chunks_exact_mut(shape.stride()).zip(operator.chunks_exact(block)).enumerate() {
            let (component, m) = (j / nodes * nodes, &mass[j % nodes * nodes..][..nodes]);
            for i in 0..block {
                let m = if i / nodes * nodes == component { f64::from(m[i % nodes]) } else { 0.0 };
                // F / scale, so that its inverse has the scale.
                let entry = (lambda * m + dt * f64::from(l[i])) / scale;
                f[i] = entry.re as f32;
                if shape.parts == 2 {
                    f[rows + i] = entry.im as f32;
                }
            }
        }
        invert(self.arch, shape, &mut f);
        as_real(shape, &f)
    }

    /// Mode by mode, axis by axis.
    fn apply_to_cell(
        &self,
        cell: usize,
        mut inverses: &[f32],
        right_side: &Split,
        z: &mut [f64],
        scratch: &mut Scratch,
    ) {
        let (block, mut first) = (self.layout.time_len(), 0);
        for shape in self.shapes() {
            for (part, c) in scratch.cell.chunks_exact_mut(block).take(shape.parts).enumerate() {
                right_side.take(cell, first + part, c);
            }
            for axis in 0..self.jacobian.dimension {
                let (matrix, rest) = inverses.split_at(matrix_len(shape));
                self.along(axis, shape, matrix, scratch);
                inverses = rest;
            }
            for (part, c) in scratch.cell.chunks_exact(block).take(shape.parts).enumerate() {
                join(&self.modes, first + part, right_side.scale, c, z);
            }
            first += shape.parts;
        }
    }

    /// Multiplies the unknowns on every line along `axis` with `matrix`.
    fn along(&self, axis: usize, shape: Shape, matrix: &[f32], scratch: &mut Scratch) {
        let Scratch { cell, lines, images } = scratch;
        let (n, nodes, parts) = (self.jacobian.nodes, self.layout.nodes, shape.parts);
        let (count, stride) = (nodes / n, n.pow(axis as u32));
        let line_len = parts * shape.n;
        // The node with which a line begins; parts and components of a line lie one after the other.
        let start = |line: usize| line / stride * stride * n + line % stride;
        let tensors = line_len / n;
        for line in 0..count {
            for tensor in 0..tensors {
                let from = tensor * nodes + start(line);
                let to = &mut lines[line * line_len + tensor * n..][..n];
                to.iter_mut().enumerate().for_each(|(i, to)| *to = cell[from + i * stride]);
            }
        }
        let images = &mut images[..count * shape.stride()];
        images.fill(0.0);
        let x = &lines[..count * line_len];
        self.arch.dispatch(Multiply { matrix, rows: shape.stride(), columns: count, x, y: images });
        let padding = padded(shape.n) - shape.n;
        for line in 0..count {
            for tensor in 0..tensors {
                let to = tensor * nodes + start(line);
                let part = tensor * n / shape.n;
                let from = &images[line * shape.stride() + tensor * n + part * padding..][..n];
                from.iter().enumerate().for_each(|(i, from)| cell[to + i * stride] = *from);
            }
        }
    }

    /// Floating-point operations of the products with blocks in an application.
    pub fn operations(&self) -> usize {
        let lines = self.layout.nodes / self.jacobian.nodes;
        2 * self.inverses.len() * lines
    }
}

impl Preconditioner for LinePreconditioner {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let scale = match largest(&self.share, r) {
            0.0 => 1.0,
            largest => largest,
        };
        let right_side = Split { modes: &self.modes, layout: self.layout, r, scale };
        let len = self.inverses.len() / self.layout.cells;
        parallel::for_each_chunk(z, self.layout.cell_len(), Grain::AtLeast(4), &|cell, z| {
            z.fill(0.0);
            let inverses = &self.inverses[cell * len..(cell + 1) * len];
            self.scratch.with(|scratch| self.apply_to_cell(cell, inverses, &right_side, z, scratch));
        });
    }
}

impl FactoredModes for LinePreconditioner {
    fn factor(&mut self, TimeScales { dt, damping }: TimeScales) {
        let len: usize = self.shapes().map(|shape| self.jacobian.dimension * matrix_len(shape)).sum();
        let mut inverses = std::mem::take(&mut self.inverses);
        inverses.resize(len * self.layout.cells, 0.0);
        parallel::for_each_chunk(&mut inverses, len, Grain::Any, &|cell, mut stored| {
            for (shape, lambda) in self.shapes().zip(&self.modes.eigenvalues) {
                for axis in 0..self.jacobian.dimension {
                    let (now, rest) = std::mem::take(&mut stored).split_at_mut(matrix_len(shape));
                    now.copy_from_slice(&self.inverse(cell, axis, shape, lambda + damping, dt));
                    stored = rest;
                }
            }
        });
        self.inverses = inverses;
    }

    fn ordering(&self) -> Ordering {
        Ordering::none()
    }

    fn bytes(&self) -> usize {
        let LineJacobian { operators, masses, .. } = &self.jacobian;
        size_of_val(&self.inverses[..]) + size_of_val(&operators[..]) + size_of_val(&masses[..])
    }
}

impl<const D: usize, const M: usize> FlowPreconditioner<D, M> for LinePreconditioner {
    fn updated(
        mut self: Box<Self>,
        flow: &SlabOperator<D, M>,
        scales: TimeScales,
    ) -> Box<dyn FlowPreconditioner<D, M>> {
        self.update(flow, scales);
        self
    }
}

/// Numbers of a block as a real matrix.
fn matrix_len(shape: Shape) -> usize {
    shape.parts * shape.len()
}

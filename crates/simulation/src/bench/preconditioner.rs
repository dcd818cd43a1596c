//! Set-up and application of the preconditioners of the flow.

use super::flow::{DT, Flow, PLANE_NODES, SPACE_NODES};
use super::subject::{Build, Size, Subject, Work, bytes};
use coupled::preconditioner::{BlockIlu, FactoredModes, LinePreconditioner, TimeScales};
use navier_stokes::{Boundary, Compiled, NavierStokes};
use newton_krylov::operator::Preconditioner;

/// The largest memory of the blocks of A in bytes; the factors take about half as much again.
const MOST_BYTES: f64 = 3e8;

/// The largest block: its factorisation takes seconds.
const LARGEST_BLOCK: usize = 1100;

/// An operator with its preconditioner.
pub struct Preconditioned<const D: usize, const M: usize> {
    flow: Flow<D, M>,
    preconditioner: BlockIlu<f32>,
    out: Vec<f64>,
}

/// Those of the slabs of the flow.
const SCALES: TimeScales = TimeScales { dt: DT, damping: 0.0 };

impl<const D: usize, const M: usize> Build for Preconditioned<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    fn build(size: Size) -> anyhow::Result<Option<Self>> {
        let block = M * size.order.pow(D as u32);
        let fits = |cells: &usize| bytes(cells.pow(D as u32) * block * block) <= MOST_BYTES;
        let wanted = size.even_cells(96, 12);
        let Some(cells) = (2..=wanted).rev().find(fits).filter(|_| block <= LARGEST_BLOCK) else { return Ok(None) };
        let flow = Flow::<D, M>::on(cells, size)?;
        let (preconditioner, out) = (BlockIlu::new(&flow.operator, SCALES, None), vec![0.0; flow.state.len()]);
        Ok(Some(Preconditioned { flow, preconditioner, out }))
    }
}

impl<const D: usize, const M: usize> Subject for Preconditioned<D, M> {
    fn work(&self) -> Vec<Work> {
        let state = self.flow.state.len();
        let unknowns = state as f64;
        let (read, operations) = (self.preconditioner.swept_bytes() as f64, self.preconditioner.operations() as f64);
        vec![
            Work { kernel: "preconditioner set-up", unknowns, flops: None, bytes: self.preconditioner.bytes() as f64 },
            Work { kernel: "preconditioner", unknowns, flops: Some(operations), bytes: bytes(2 * state) + read },
        ]
    }

    fn run(&mut self, number: usize) {
        match number {
            // As in a run: with the order of elimination and the memory of the first set-up.
            0 => self.preconditioner.update(&self.flow.operator, SCALES),
            _ => self.preconditioner.apply(&self.flow.state, &mut self.out),
        }
    }
}

/// An operator with its preconditioner by directions.
pub struct ByLines<const D: usize, const M: usize> {
    flow: Flow<D, M>,
    lines: LinePreconditioner,
    out: Vec<f64>,
}

impl<const D: usize, const M: usize> Build for ByLines<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    fn build(size: Size) -> anyhow::Result<Option<Self>> {
        let flow = Flow::<D, M>::on(size.even_cells(PLANE_NODES, SPACE_NODES), size)?;
        let lines = LinePreconditioner::new(&flow.operator, SCALES);
        Ok(Some(ByLines { out: vec![0.0; flow.state.len()], lines, flow }))
    }
}

impl<const D: usize, const M: usize> Subject for ByLines<D, M> {
    fn work(&self) -> Vec<Work> {
        let state = self.flow.state.len();
        let (unknowns, held) = (state as f64, self.lines.bytes() as f64);
        vec![
            Work { kernel: "lines set-up", unknowns, flops: None, bytes: held },
            Work {
                kernel: "lines",
                unknowns,
                flops: Some(self.lines.operations() as f64),
                bytes: bytes(2 * state) + held,
            },
        ]
    }

    fn run(&mut self, number: usize) {
        match number {
            0 => self.lines.update(&self.flow.operator, SCALES),
            _ => self.lines.apply(&self.flow.state, &mut self.out),
        }
    }
}

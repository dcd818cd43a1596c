//! The averages along axes of space, as a table and, in a plane, for a viewer.
//!
//! ```text
//! <q> = int int q dt dl / int int dt dl,    l along the axes at rest                                        (average along)
//! ```
//!
//! Fluctuations are those about this mean, so products are averaged along the axes before the covariances are made.

use super::fields::{drawn, spec};
use super::sums::OfCell;
use super::{AverageSums, Moments};
use case::Averages;
use fem::Sampler;
use mesh::{CrossSection, LineNode, Mesh, Stack, clusters};
use output::{FileLayout, Grid, OutputError, Step, ViewerFile, write_atomically};
use std::fmt::Write;
use std::path::Path;
use tensor::AXES;

/// Names of the files.
pub(super) const TABLE: &str = "averages_along.csv";
pub(super) const VIEWER_FILE: &str = "averages_along.vtkhdf";

/// The averages along axes at the end of a run.
pub struct AlongFiles<'a> {
    moments: Moments,
    /// By cell.
    sums: Vec<OfCell<'a>>,
    section: CrossSection,
    /// Nodes per cell of the mesh.
    nodes: usize,
}

impl<'a> AlongFiles<'a> {
    /// Those that the case has `wanted`, from the `sums` of a flow with `order` nodes per direction on `mesh`. `None` if it wants none, or
    /// if no slab has been averaged.
    pub fn new<const D: usize>(wanted: &Averages, sums: &'a AverageSums, mesh: &Mesh<D>, order: usize) -> Option<Self> {
        if wanted.along.is_empty() || sums.is_empty() {
            return None;
        }
        let (moments, nodes) = (Moments::new::<D>(&wanted.fields).along(&wanted.along), order.pow(D as u32));
        let section = mesh.cross_section(order, &wanted.along)?;
        let sums = (0..mesh.n_cells()).map(|cell| sums.sums_of_cell(&moments, cell, nodes, None)).collect();
        Some(AlongFiles { moments, sums, section, nodes })
    }

    /// Writes the files into `directory`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), OutputError> {
        write_atomically(&directory.join(TABLE), self.table().as_bytes())?;
        match self.section.remaining.len() {
            2 => self.write_viewer_file(&directory.join(VIEWER_FILE)),
            _ => Ok(()),
        }
    }

    /// The averages on a line, `[component]` of one after the other.
    fn on_line(&self, line: &[LineNode]) -> Vec<f64> {
        let count = self.moments.quantities.len();
        let offsets = |node: &LineNode| self.column(self.sums[node.cell].offsets, count, node.node);
        let others = offsets(&line[0]);
        let (mut means, mut whole) = (vec![0.0; self.moments.len()], 0.0);
        for node in line {
            let of_cell = &self.sums[node.cell];
            let mut here = self.column(&of_cell.sums, self.moments.len(), node.node);
            here.iter_mut().for_each(|sum| *sum /= of_cell.duration);
            let here = self.moments.about(&others, &offsets(node), &here);
            means.iter_mut().zip(here).for_each(|(mean, here)| *mean += node.weight * here);
            whole += node.weight;
        }
        let averages = &self.moments.averages;
        averages.iter().flat_map(|average| self.moments.average(average, whole, &others, &means)).collect()
    }

    /// The mean of the averages on `lines` at the same place, weighted by their lengths. Jumps between cells are no fluctuations.
    fn where_lines_meet(&self, lines: &[&[LineNode]]) -> Vec<f64> {
        let length = |line: &[LineNode]| line.iter().map(|node| node.weight).sum::<f64>();
        let whole: f64 = lines.iter().map(|line| length(line)).sum();
        let mut mean = vec![0.0; self.on_line(lines[0]).len()];
        for line in lines {
            let part = length(line) / whole;
            mean.iter_mut().zip(self.on_line(line)).for_each(|(mean, here)| *mean += part * here);
        }
        mean
    }

    /// The first `count` numbers of `node` in `values`, `[number][node]`.
    fn column(&self, values: &[f64], count: usize, node: usize) -> Vec<f64> {
        values.iter().skip(node).step_by(self.nodes).take(count).copied().collect()
    }

    /// A row for each point. Where cells meet, the mean of their values.
    fn table(&self) -> String {
        let names = self.moments.averages.iter().flat_map(|average| match average.components() {
            1 => vec![average.name.clone()],
            count => AXES[..count].iter().map(|axis| format!("{}_{axis}", average.name)).collect(),
        });
        let axes = self.section.remaining.iter().map(|&axis| AXES[axis].to_owned());
        let mut text = axes.chain(names).collect::<Vec<_>>().join(",") + "\n";
        let stacks = &self.section.stacks;
        let all: Vec<(&[f64], &[LineNode])> = stacks
            .iter()
            .flat_map(|stack| stack.points.iter().map(Vec::as_slice).zip(stack.lines.iter().map(Vec::as_slice)))
            .collect();
        let points: Vec<&[f64]> = all.iter().map(|(point, _)| *point).collect();
        for group in clusters(&points, self.section.tolerance) {
            let lines: Vec<&[LineNode]> = group.iter().map(|&number| all[number].1).collect();
            let numbers = [points[group[0]], &self.where_lines_meet(&lines)].concat();
            // Writing to a string cannot fail.
            let _ =
                writeln!(text, "{}", numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(","));
        }
        text
    }

    /// Every stack is a cell of the file.
    fn write_viewer_file(&self, path: &Path) -> Result<(), OutputError> {
        let (order, stacks) = (self.section.order, &self.section.stacks);
        let sampler = Sampler::<2>::new(order, order, &basis::equidistant_points(order));
        let coefficients: Vec<Vec<f64>> = stacks.iter().map(|stack| self.on_stack(stack)).collect();
        let (mut first, mut arrays) = (0, Vec::new());
        for average in &self.moments.averages {
            let length = average.components() * order * order;
            let of_all: Vec<f64> = coefficients.iter().flat_map(|cell| &cell[first..first + length]).copied().collect();
            arrays.push(drawn::<2>(average, &of_all, order * order, &sampler));
            first += length;
        }
        let fields = self.moments.averages.iter().map(spec).collect();
        let grid = Grid { dimension: 2, points_per_direction: order, cells: stacks.len() };
        let file = ViewerFile::create(path, FileLayout { grid, fields, exact: Vec::new() })?;
        let points: Vec<f64> = stacks.iter().flat_map(|stack| self.positions(stack, &sampler)).collect();
        let names = self.moments.averages.iter().map(|average| &average.name[..]);
        let fields: Vec<(&str, &[f64])> = names.zip(arrays.iter().map(Vec::as_slice)).collect();
        file.append(&Step { time: 0.0, points: &points, fields: &fields, exact: &[] })?;
        file.publish()
    }

    /// The averages at the nodes of a stack, `[average][component][node]`.
    fn on_stack(&self, stack: &Stack) -> Vec<f64> {
        let nodes: Vec<Vec<f64>> = stack.lines.iter().map(|line| self.on_line(line)).collect();
        let components = nodes[0].len();
        (0..components).flat_map(|component| nodes.iter().map(move |node| node[component])).collect()
    }

    /// The positions of the points of a stack, `[point][3]`.
    fn positions(&self, stack: &Stack, sampler: &Sampler<2>) -> Vec<f64> {
        let nodal: Vec<f64> = (0..2).flat_map(|i| stack.points.iter().map(move |point| point[i])).collect();
        let (x, n, remaining) = (sampler.positions(&nodal), sampler.points(), &self.section.remaining);
        let place = |axis: usize| remaining.iter().position(|&other| other == axis);
        (0..3 * n).map(|i| place(i % 3).map_or(0.0, |component| x[component * n + i / 3])).collect()
    }
}

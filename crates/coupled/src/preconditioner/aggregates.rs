//! Aggregates of cells: the supports of the functions of [`super::coarse::CoarseLevel`].
//!
//! Rounds of pairing join strongly coupled neighbours: across thin cells first. An aggregate has coordinates that continue the reference
//! coordinates of one of its cells from neighbour to neighbour, so that coarse functions follow curved and thin cells. Aggregates lie within
//! blocks of the mesh, so that they do not depend on the number of ranks.

use super::blocks::Link;
use super::ilu::BlockIlu;
use basis::{Lagrange, Matrix};
use faer::Mat;
use fem::{Coupling, Share, SlabOperator, Stored};
use mesh::{corner_node, face_nodes};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Coarse functions of one component in one direction: 2 of degree 1, or one constant if cells have no more.
pub fn functions_per_direction(order: usize) -> usize {
    if order > 2 { 2 } else { 1 }
}

/// A point in the coordinates of an aggregate; two of them in the plane.
type Point = [f64; 3];

/// The cells of a mesh, and how they meet.
pub struct Neighbourhood<'a> {
    /// 2 or 3.
    dimension: usize,
    /// Nodes per direction of the lattices.
    order: usize,
    share: &'a Share,
    /// The neighbours of every own cell.
    links: &'a [Vec<Link>],
    /// For every coupling the node in the lattice of the face on the plus side, for every node on the minus side.
    lattices: Vec<Vec<usize>>,
    /// For every coupling how strong it is: an inverse time, times a volume.
    strengths: Vec<f64>,
    /// The volumes of the cells.
    volumes: Vec<f64>,
}

/// The aggregates. Their numbers are those in the whole mesh: block by block.
pub struct Aggregates {
    /// The aggregate of every own cell and ghost.
    pub of_cell: Vec<usize>,
    /// The number of aggregates of every rank.
    pub of_ranks: Vec<usize>,
    /// The cells of every own aggregate.
    cells: Vec<Vec<usize>>,
    /// The first own aggregate.
    first: usize,
    /// The corners of every own cell and ghost, in the coordinates of its aggregate: a box from -1 to 1.
    corners: Vec<Vec<Point>>,
}

impl<'a> Neighbourhood<'a> {
    /// That of the cells of `operator`, which `sweeps` precondition.
    pub fn new<T: Stored, const D: usize, const M: usize>(
        operator: &SlabOperator<D, M>,
        sweeps: &'a BlockIlu<T>,
    ) -> Self {
        let jacobian = &sweeps.jacobian;
        let size = |block: &[T]| block.iter().map(|&a| a.into() * a.into()).sum::<f64>();
        let strength = |coupling: &Coupling<T>| (size(&coupling.minus_plus) + size(&coupling.plus_minus)).sqrt();
        let volume = |cell| jacobian.mass_of(cell).iter().map(|&m| m.into()).sum();
        Neighbourhood {
            dimension: D,
            order: operator.tables.orders.flow,
            share: &sweeps.share,
            links: sweeps.links(),
            lattices: operator.lattices_of_couplings(),
            strengths: jacobian.couplings.iter().map(strength).collect(),
            volumes: (0..sweeps.layout.cells).map(volume).collect(),
        }
    }

    /// Aggregates, at most as many as `most` if pairing gets there. Each block has as many of them as cells. A collective call.
    pub fn aggregates(&self, most: usize) -> Aggregates {
        let (mut of_cell, mut cells) = (Vec::new(), Vec::new());
        for ends in self.share.ends.windows(2) {
            let (block, first) = (ends[0]..ends[1], cells.len());
            let (groups, count) = self.groups(&block, (most * block.len() / self.share.whole_cells()).max(1));
            cells.resize(first + count, Vec::new());
            of_cell.extend(groups.into_iter().map(|group| first + group));
            block.for_each(|cell| cells[of_cell[cell]].push(cell));
        }
        let corners = self.corners(&of_cell, &cells);
        let of_ranks = self.share.sums.communicator().all_gather(&[cells.len() as f64]);
        let of_ranks: Vec<usize> = of_ranks.iter().flatten().map(|&count| count as usize).collect();
        let first = of_ranks[..self.share.sums.communicator().rank()].iter().sum();
        of_cell.iter_mut().for_each(|aggregate| *aggregate += first);
        let mut aggregates = Aggregates { of_cell, of_ranks, cells, first, corners };
        aggregates.meet_ghosts(self.share, 1 << self.dimension);
        aggregates
    }

    /// The group of every cell of a `block`, and the number of groups: pairs of cells, pairs of these, until there are at most `most`.
    fn groups(&self, block: &Range<usize>, most: usize) -> (Vec<usize>, usize) {
        let mut of_cell: Vec<usize> = (0..block.len()).collect();
        let mut count = of_cell.len();
        while count > most {
            let pairs = self.pairs(block, &of_cell, count);
            let mut numbers = vec![usize::MAX; count];
            let mut new = 0;
            for group in 0..count {
                if numbers[group] == usize::MAX {
                    numbers[group] = new;
                    if let Some(other) = pairs[group] {
                        numbers[other] = new;
                    }
                    new += 1;
                }
            }
            if new == count {
                break;
            }
            of_cell.iter_mut().for_each(|group| *group = numbers[*group]);
            count = new;
        }
        (of_cell, count)
    }

    /// For every group of a `block` the one that it is paired with: the strongest couplings, per volume, are taken first.
    fn pairs(&self, block: &Range<usize>, of_cell: &[usize], count: usize) -> Vec<Option<usize>> {
        let mut volumes = vec![0.0; count];
        of_cell.iter().zip(&self.volumes[block.clone()]).for_each(|(&group, volume)| volumes[group] += volume);
        let mut strengths = BTreeMap::new();
        for (&a, links) in of_cell.iter().zip(&self.links[block.clone()]) {
            for link in links.iter().filter(|link| block.contains(&link.cell)) {
                let b = of_cell[link.cell - block.start];
                if a < b {
                    *strengths.entry((a, b)).or_insert(0.0) += self.strengths[link.coupling];
                }
            }
        }
        let per_volume =
            |((a, b), strength): ((usize, usize), f64)| (strength / (volumes[a] * volumes[b]).sqrt(), a, b);
        let mut edges: Vec<(f64, usize, usize)> = strengths.into_iter().map(per_volume).collect();
        edges.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut pairs = vec![None; count];
        for (_, a, b) in edges {
            if pairs[a].is_none() && pairs[b].is_none() {
                (pairs[a], pairs[b]) = (Some(b), Some(a));
            }
        }
        pairs
    }

    /// The corners of own cells in the coordinates of their aggregates.
    fn corners(&self, of_cell: &[usize], aggregates: &[Vec<usize>]) -> Vec<Vec<Point>> {
        let mut corners = vec![Vec::new(); of_cell.len()];
        for cells in aggregates {
            corners[cells[0]] = (0..1 << self.dimension).map(reference_corner).collect();
            let mut reached = vec![cells[0]];
            let mut next = 0;
            while next < reached.len() {
                let cell = reached[next];
                next += 1;
                for link in &self.links[cell] {
                    if of_cell.get(link.cell) == Some(&of_cell[cell]) && corners[link.cell].is_empty() {
                        corners[link.cell] = self.continued(&corners[cell], link);
                        reached.push(link.cell);
                    }
                }
            }
            scale_to_box(cells, &mut corners);
        }
        corners
    }

    /// The corners of the neighbour behind `link`, in the coordinates in which those of the cell are `corners`.
    fn continued(&self, corners: &[Point], link: &Link) -> Vec<Point> {
        let (dimension, n) = (self.dimension, self.order);
        let [nodes, other_nodes] = [link.face, link.other_face].map(|face| face_nodes(dimension, n, face));
        let corner_of = |node: usize| (0..1 << dimension).find(|&k| corner_node(dimension, n, k) == node);
        let lattice = &self.lattices[link.coupling];
        let mut continued = vec![[0.0; 3]; corners.len()];
        for (minus, &plus) in lattice.iter().enumerate() {
            let (here, there) = if link.side == 0 { (minus, plus) } else { (plus, minus) };
            let (Some(k), Some(l)) = (corner_of(nodes[here]), corner_of(other_nodes[there])) else { continue };
            let (shared, behind) = (corners[k], corners[k ^ 1 << (link.face / 2)]);
            continued[l] = shared;
            continued[l ^ 1 << (link.other_face / 2)] = std::array::from_fn(|i| 2.0 * shared[i] - behind[i]);
        }
        continued
    }
}

impl Aggregates {
    /// Learns of the aggregates of ghosts, whose cells have so many `corners`. A collective call.
    fn meet_ghosts(&mut self, share: &Share, corners: usize) {
        let numbers = |(&aggregate, corners): (&usize, &Vec<Point>)| -> Vec<f64> {
            std::iter::once(aggregate as f64).chain(corners.iter().flatten().copied()).collect()
        };
        let own: Vec<f64> = self.of_cell.iter().zip(&self.corners).flat_map(numbers).collect();
        let (len, mut all) = (1 + 3 * corners, Vec::new());
        share.with_ghosts(&own, len, &mut all);
        for ghost in all[own.len()..].chunks_exact(len) {
            self.of_cell.push(ghost[0] as usize);
            self.corners.push(ghost[1..].chunks_exact(3).map(|point| [point[0], point[1], point[2]]).collect());
        }
    }

    /// The number of all aggregates.
    pub fn count(&self) -> usize {
        self.of_ranks.iter().sum()
    }

    /// The own aggregates.
    pub fn own(&self) -> Range<usize> {
        self.first..self.first + self.cells.len()
    }

    /// The cells of an own aggregate; none of others.
    pub fn own_cells(&self, aggregate: usize) -> &[usize] {
        aggregate.checked_sub(self.first).and_then(|number| self.cells.get(number)).map_or(&[], Vec::as_slice)
    }

    /// Every aggregate with those beside it, in increasing order. A collective call.
    pub fn neighbourhoods(&self, links: &[Vec<Link>], share: &Share) -> Vec<Vec<usize>> {
        let around = |aggregate: usize| {
            let beside = self.own_cells(aggregate).iter().flat_map(|&cell| &links[cell]);
            let all: BTreeSet<usize> = beside.map(|link| self.of_cell[link.cell]).chain([aggregate]).collect();
            std::iter::once(all.len()).chain(all).map(|number| number as f64).collect::<Vec<f64>>()
        };
        let own: Vec<f64> = self.own().flat_map(around).collect();
        let all = share.sums.communicator().all_gather(&own).concat();
        let (mut rest, mut neighbourhoods) = (&all[..], Vec::with_capacity(self.count()));
        while let [count, others @ ..] = rest {
            let (beside, others) = others.split_at(*count as usize);
            neighbourhoods.push(beside.iter().map(|&aggregate| aggregate as usize).collect());
            rest = others;
        }
        neighbourhoods
    }

    /// The values of the functions of the aggregate of `cell` at its nodes, `[node][function]`: products of (1 - X) / 2 and (1 + X) / 2 in
    /// the coordinates X of the aggregate, or 1.
    pub fn prolongation(&self, cell: usize, order: usize, dimension: usize, per_direction: usize) -> Mat<f64> {
        let nodes = Lagrange::gauss_lobatto(order).nodes().to_vec();
        let corners = &self.corners[cell];
        let shape = |x: f64, side: usize| 0.5 * if side == 0 { 1.0 - x } else { 1.0 + x };
        let at = |node: usize| -> Point {
            let xi: Vec<f64> = (0..dimension).map(|d| nodes[node / order.pow(d as u32) % order]).collect();
            let weight = |k: usize| (0..dimension).map(|d| shape(xi[d], k >> d & 1)).product::<f64>();
            std::array::from_fn(|i| corners.iter().enumerate().map(|(k, corner)| weight(k) * corner[i]).sum())
        };
        let values = Matrix::from_fn(order.pow(dimension as u32), 3, |node, i| at(node)[i]);
        Mat::from_fn(values.rows(), per_direction.pow(dimension as u32), |node, function| {
            let factor = |d: usize| shape(values.row(node)[d], function >> d & 1);
            if per_direction == 1 { 1.0 } else { (0..dimension).map(factor).product() }
        })
    }
}

/// Corner `k` of a reference cell.
fn reference_corner(k: usize) -> Point {
    std::array::from_fn(|i| if k >> i & 1 == 1 { 1.0 } else { -1.0 })
}

/// Scales the corners of `cells` so that they fill a box from -1 to 1.
fn scale_to_box(cells: &[usize], corners: &mut [Vec<Point>]) {
    for i in 0..3 {
        let all = || cells.iter().flat_map(|&cell| corners[cell].iter().map(move |corner| corner[i]));
        let low = all().min_by(f64::total_cmp).unwrap_or_default();
        let high = all().max_by(f64::total_cmp).unwrap_or_default();
        let scale = |x: f64| if high > low { (2.0 * x - low - high) / (high - low) } else { 0.0 };
        cells.iter().for_each(|&cell| corners[cell].iter_mut().for_each(|corner| corner[i] = scale(corner[i])));
    }
}

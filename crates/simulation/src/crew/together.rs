//! Files that all ranks write together. No rank receives all numbers of cells: each receives a range of the cells, and writes it.

use super::orders::{Order, Orders};
use super::parts::{OfCells, Own};
use super::{Crew, agree};
use crate::averages::AverageSums;
use crate::error::Failure;
use output::{FileLayout, OutputError, SharedFile, SolverState};
use ranks::{Communicator, FileSharing};
use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Deals numbers of cells: every rank has a range of cells, and receives the numbers there. A collective call.
type Deal<'a, T> = Box<dyn Fn(&[Range<usize>]) -> T + 'a>;

/// The ranks of a run that write files together.
pub struct Together<'a> {
    communicator: &'a dyn Communicator,
    sharing: FileSharing,
    /// On rank 0.
    orders: Option<&'a Orders>,
    /// The arrays of a checkpoint that they write.
    pub arrays: Vec<LongArray<'a>>,
    deal_step: Deal<'a, CellsOfStep>,
}

/// An array of a checkpoint with numbers of cells.
pub struct LongArray<'a> {
    /// Its name.
    pub name: &'static str,
    /// Numbers of a cell.
    pub len: usize,
    deal: Deal<'a, Vec<f64>>,
}

/// The numbers of a step in some cells.
pub struct CellsOfStep {
    /// The flow of the slab, `[cell][time node][component][node]`.
    pub flow: Vec<f64>,
    /// The averages.
    pub averages: AverageSums,
}

impl Crew {
    /// All ranks, if they write files together.
    pub fn together<'a, const D: usize, const M: usize>(&'a self, own: Own<'a, D, M>) -> Option<Together<'a>> {
        Together::new(own, &**self.orders.communicator(), Some(&self.orders))
    }
}

impl<'a> Together<'a> {
    /// All ranks, from what this one has; with `orders` on rank 0. `None` if rank 0 alone writes files.
    pub(super) fn new<const D: usize, const M: usize>(
        own: Own<'a, D, M>,
        communicator: &'a dyn Communicator,
        orders: Option<&'a Orders>,
    ) -> Option<Self> {
        let sharing = communicator.file_sharing().filter(|_| communicator.size() > 1)?;
        let share = &own.march.solver.system.flow.operator.share;
        let deal = move |of: OfCells, ranges: &[Range<usize>]| share.deal(of.own(own), ranges);
        let deal_step = move |ranges: &[Range<usize>]| {
            let numbers = |of| Cow::Owned(deal(of, ranges));
            CellsOfStep { flow: own.flow_of_slab(numbers).into_owned(), averages: own.averages_in(numbers) }
        };
        let array = |(of, name): (OfCells, &'static str)| LongArray {
            name,
            len: of.own(own).len() / share.own.len(),
            deal: Box::new(move |ranges: &[Range<usize>]| deal(of, ranges)),
        };
        let arrays = own.long_arrays().map(array).collect();
        Some(Together { communicator, sharing, orders, arrays, deal_step: Box::new(deal_step) })
    }

    /// How many ranks there are.
    pub fn size(&self) -> usize {
        self.communicator.size()
    }

    /// The numbers of an array in the range of this rank, which `write` receives, round by round. A collective call.
    ///
    /// # Errors
    /// The first one of `write`.
    pub fn deal(
        &self,
        array: &LongArray,
        rounds: impl Iterator<Item = Vec<Range<usize>>>,
        write: impl FnMut(Range<usize>, Vec<f64>) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        self.each(rounds, &array.deal, write)
    }

    /// The same for the numbers of a step.
    ///
    /// # Errors
    /// The first one of `write`.
    pub fn deal_step(
        &self,
        rounds: impl Iterator<Item = Vec<Range<usize>>>,
        write: impl FnMut(Range<usize>, CellsOfStep) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        self.each(rounds, &self.deal_step, write)
    }

    /// Passes what is dealt in each round to `write`. After an error this rank goes on to deal: the others wait for its numbers.
    fn each<T>(
        &self,
        rounds: impl Iterator<Item = Vec<Range<usize>>>,
        deal: impl Fn(&[Range<usize>]) -> T,
        mut write: impl FnMut(Range<usize>, T) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        let mut written = Ok(());
        for ranges in rounds {
            let (own, numbers) = (ranges[self.communicator.rank()].clone(), deal(&ranges));
            if !own.is_empty() && written.is_ok() {
                written = write(own, numbers);
            }
        }
        written
    }

    /// Has all ranks open the file at `path`, `write` to it and close it. Rank 0 gives the others the `order`. A collective call.
    ///
    /// # Errors
    /// That of any rank.
    pub fn write(
        &self,
        order: Order,
        path: &Path,
        layout: FileLayout,
        write: impl FnOnce(&SharedFile) -> Result<(), OutputError>,
    ) -> Result<(), Failure> {
        self.orders.iter().for_each(|orders| orders.give(order, Some(&request(path))));
        let opened = SharedFile::open(path, layout, self.sharing).map_err(Failure::from);
        let file = agree(self.communicator, opened)?;
        let written = write(&file);
        let closed = file.close();
        agree(self.communicator, written.and(closed).map_err(Failure::from))
    }
}

/// The name of the text with the path of a file.
const PATH: &str = "path";

/// What goes with the order to write the file at `path`.
fn request(path: &Path) -> SolverState {
    let mut request = SolverState::default();
    request.texts.insert(PATH.to_owned(), path.to_string_lossy().into_owned());
    request
}

/// The path in a [`request`].
pub(super) fn path_of(request: &SolverState) -> PathBuf {
    request.texts.get(PATH).map(PathBuf::from).unwrap_or_default()
}

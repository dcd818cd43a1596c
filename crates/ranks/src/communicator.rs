//! How ranks talk to each other.

use std::sync::Arc;

/// How several ranks write one file together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileSharing {
    /// As threads of one process.
    Threads,
    /// As processes, through MPI.
    Mpi,
}

/// A group of ranks that solve one case together. Every call is collective: all ranks make the same calls in the same order.
///
/// A call ends when this rank has received its data. A failure of the network or of another rank ends the process, or panics; it is not an
/// error value.
pub trait Communicator: Send + Sync {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// How many ranks there are.
    fn size(&self) -> usize;

    /// Sends `sends` = (rank, numbers) and fills `receives` = (rank, buffer of the expected length). At most one message per pair of
    /// ranks and direction. A rank may send to itself.
    fn exchange(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])]) {
        self.exchange_while(sends, receives, &mut || ());
    }

    /// [`Self::exchange`] that does `work` while messages are on their way. The work needs nothing that is received, and makes no calls of
    /// its own.
    fn exchange_while(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])], work: &mut dyn FnMut());

    /// The parts of all ranks, in the order of ranks; lengths may differ.
    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>>;

    /// The parts of all ranks one after the other, where every rank knows the `lengths` of all parts: one message less than
    /// [`Self::all_gather`].
    fn all_gather_known(&self, part: &[f64], lengths: &[usize]) -> Vec<f64>;

    /// The bytes of rank 0, on all ranks.
    fn broadcast(&self, bytes: &mut Vec<u8>);

    /// Ends all ranks at once: after a panic or an error that the others cannot know of.
    fn abort(&self, code: i32) -> !;

    /// How the ranks write one file together; `None` if only rank 0 writes. The same on all ranks.
    fn file_sharing(&self) -> Option<FileSharing> {
        None
    }
}

impl<C: Communicator + ?Sized> Communicator for Arc<C> {
    fn rank(&self) -> usize {
        (**self).rank()
    }

    fn size(&self) -> usize {
        (**self).size()
    }

    fn exchange_while(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])], work: &mut dyn FnMut()) {
        (**self).exchange_while(sends, receives, work);
    }

    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>> {
        (**self).all_gather(part)
    }

    fn all_gather_known(&self, part: &[f64], lengths: &[usize]) -> Vec<f64> {
        (**self).all_gather_known(part, lengths)
    }

    fn broadcast(&self, bytes: &mut Vec<u8>) {
        (**self).broadcast(bytes);
    }

    fn abort(&self, code: i32) -> ! {
        (**self).abort(code)
    }

    fn file_sharing(&self) -> Option<FileSharing> {
        (**self).file_sharing()
    }
}

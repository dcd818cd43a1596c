//! How ranks talk to each other.

use std::sync::Arc;

/// A group of ranks that solve one case together. Every call is collective: all ranks make the same calls in the same order.
///
/// A call ends when this rank has what it needs. A failure of the network or of another rank ends the process, or panics; it is not an
/// error value.
pub trait Communicator: Send + Sync {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// How many ranks there are.
    fn size(&self) -> usize;

    /// Sends `sends` = (rank, numbers) and fills `receives` = (rank, buffer of the expected length). At most one message per pair of
    /// ranks and direction. A rank may send to itself.
    fn exchange(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])]);

    /// The parts of all ranks, in the order of ranks; lengths may differ.
    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>>;

    /// The bytes of rank 0, on all ranks.
    fn broadcast(&self, bytes: &mut Vec<u8>);

    /// Ends all ranks at once: after a panic or an error that the others cannot know of.
    fn abort(&self, code: i32) -> !;
}

impl<C: Communicator + ?Sized> Communicator for Arc<C> {
    fn rank(&self) -> usize {
        (**self).rank()
    }

    fn size(&self) -> usize {
        (**self).size()
    }

    fn exchange(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])]) {
        (**self).exchange(sends, receives);
    }

    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>> {
        (**self).all_gather(part)
    }

    fn broadcast(&self, bytes: &mut Vec<u8>) {
        (**self).broadcast(bytes);
    }

    fn abort(&self, code: i32) -> ! {
        (**self).abort(code)
    }
}

//! Ranks that are processes, by MPI.

use crate::Error;
use mpi::Threading;
use mpi::collective::CommunicatorCollectives;
use mpi::datatype::PartitionMut;
use mpi::environment::Universe;
use mpi::request::{Request, Scope, scope};
use mpi::topology::{Communicator as _, SimpleCommunicator};
use mpi::traits::{Destination, Equivalence, Root, Source};
use ranks::{Communicator, FileSharing};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The largest number of bytes in one call of MPI, which counts in 32 bits.
const CHUNK: usize = 1 << 30;

/// How long a rank looks for an order without a break, as others follow at once in most slabs; and each break after that.
const AWAKE: Duration = Duration::from_millis(2);
const ASLEEP: Duration = Duration::from_micros(200);

/// The code with which all ranks end when one of them panics: that of any Rust program that panics.
const PANIC: i32 = 101;

/// One of the processes that a launcher of MPI has started.
///
/// When it is dropped, MPI ends in this process. When it is dropped by a panic, all ranks end: the others may wait for this one. No call
/// waits for a rank that returns early without a panic, so that each rank has to make the same calls until its end.
pub struct Mpi {
    universe: Universe,
}

impl Mpi {
    /// Starts MPI in this process.
    ///
    /// # Errors
    ///
    /// If it was started before, or allows calls from the main thread only.
    pub fn start() -> Result<Self, Error> {
        let (universe, threading) = mpi::initialize_with_threading(Threading::Multiple).ok_or(Error::StartedBefore)?;
        // All ranks make their calls one after the other.
        if threading < Threading::Serialized { Err(Error::MainThreadOnly) } else { Ok(Self { universe }) }
    }

    fn world(&self) -> SimpleCommunicator {
        self.universe.world()
    }
}

impl Drop for Mpi {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.abort(PANIC)
        }
    }
}

/// The communicator of all ranks, as libraries in C take it. MPI has been started.
#[cfg(feature = "parallel-hdf5")]
pub fn handle_of_world() -> mpi::ffi::MPI_Comm {
    use mpi::raw::AsRaw;
    SimpleCommunicator::world().as_raw()
}

/// A number of entries, as MPI counts.
fn count(entries: usize) -> i32 {
    entries.try_into().expect("more than 2^31 numbers in one message")
}

/// Waits for a message without occupying a processor for long.
fn wait_asleep<'a, D: ?Sized, S: Scope<'a>>(mut request: Request<'a, D, S>) {
    let begun = Instant::now();
    while let Err(waiting) = request.test() {
        request = waiting;
        if begun.elapsed() > AWAKE {
            sleep(ASLEEP);
        }
    }
}

impl Communicator for Mpi {
    fn rank(&self) -> usize {
        self.world().rank() as usize
    }

    fn size(&self) -> usize {
        self.world().size() as usize
    }

    fn exchange_while(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])], work: &mut dyn FnMut()) {
        let world = self.world();
        let expected: Vec<_> = receives.iter().map(|(_, buffer)| count(buffer.len())).collect();
        let process = |rank: usize| world.process_at_rank(count(rank));
        let arrived: Vec<_> = scope(|scope| {
            let receiving =
                receives.iter_mut().map(|(from, buffer)| process(*from).immediate_receive_into(scope, &mut **buffer));
            let receiving: Vec<_> = receiving.collect();
            let sending: Vec<_> =
                sends.iter().map(|(to, numbers)| process(*to).immediate_send(scope, *numbers)).collect();
            work();
            let arrived =
                receiving.into_iter().map(|request| request.wait().count(f64::equivalent_datatype())).collect();
            sending.into_iter().for_each(|request| request.wait_without_status());
            arrived
        });
        assert_eq!(arrived, expected, "the lengths of the messages that have arrived");
    }

    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>> {
        let world = self.world();
        let mut counts = vec![0; self.size()];
        world.all_gather_into(&count(part.len()), &mut counts[..]);
        let lengths: Vec<usize> = counts.iter().map(|count| *count as usize).collect();
        let all = self.all_gather_known(part, &lengths);
        let mut rest = &all[..];
        let next = |length: &usize| rest.split_off(..*length).map_or(Vec::new(), <[f64]>::to_vec);
        lengths.iter().map(next).collect()
    }

    fn all_gather_known(&self, part: &[f64], lengths: &[usize]) -> Vec<f64> {
        assert_eq!(lengths[self.rank()], part.len(), "the length of the part of this rank");
        let mut total = 0;
        let start = |length: &usize| {
            total += length;
            count(total - length)
        };
        let starts: Vec<_> = lengths.iter().map(start).collect();
        let counts: Vec<_> = lengths.iter().copied().map(count).collect();
        let mut all = vec![0.0; total];
        if total > 0 {
            let mut parts = PartitionMut::new(&mut all[..], &counts[..], &starts[..]);
            self.world().all_gather_varcount_into(part, &mut parts);
        }
        all
    }

    fn broadcast(&self, bytes: &mut Vec<u8>) {
        let world = self.world();
        let root = world.process_at_rank(0);
        let mut length = bytes.len() as u64;
        // Rank 0 may compute for minutes before: the others leave their processors to it.
        scope(|scope| wait_asleep(root.immediate_broadcast_into(scope, &mut length)));
        bytes.resize(length as usize, 0);
        bytes.chunks_mut(CHUNK).for_each(|chunk| root.broadcast_into(chunk));
    }

    fn abort(&self, code: i32) -> ! {
        self.world().abort(code)
    }

    fn file_sharing(&self) -> Option<FileSharing> {
        cfg!(feature = "parallel-hdf5").then_some(FileSharing::Mpi)
    }
}

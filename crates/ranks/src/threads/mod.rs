//! Ranks that are threads of one process.

mod post_office;
#[cfg(test)]
mod tests;

use crate::{Communicator, FileSharing};
use post_office::{Message, PostOffice};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::thread::{Builder, scope};

/// Bytes of the stack of a rank: those of a main thread.
const STACK: usize = 8 << 20;

/// One of several ranks that are threads of one process. They serve tests: all that ranks do runs without MPI.
///
/// The ranks share the pool of rayon. A rank must not call the communicator from a thread of that pool.
pub struct Threads {
    rank: usize,
    sharing: Option<FileSharing>,
    post_office: Arc<PostOffice>,
}

impl Threads {
    /// Runs `work` on `size` ranks and returns their results in the order of ranks.
    ///
    /// # Panics
    ///
    /// When a rank panics, the other ranks panic in their next call that needs an answer, and this function goes on with the first panic.
    /// Ranks that wait for each other and for nothing else panic, too.
    pub fn run<T: Send>(size: usize, work: impl Fn(Arc<dyn Communicator>) -> T + Sync) -> Vec<T> {
        Self::run_with(None, size, work)
    }

    /// [`Self::run`], with files that are written as `sharing` tells.
    ///
    /// # Panics
    ///
    /// As [`Self::run`].
    pub fn run_with<T: Send>(
        sharing: Option<FileSharing>,
        size: usize,
        work: impl Fn(Arc<dyn Communicator>) -> T + Sync,
    ) -> Vec<T> {
        let post_office = Arc::new(PostOffice::new(size));
        let outcomes: Vec<_> = scope(|scope| {
            let start = |rank| {
                let (threads, work) = (Threads { rank, sharing, post_office: Arc::clone(&post_office) }, &work);
                let thread = Builder::new().name(format!("rank {rank}")).stack_size(STACK);
                thread.spawn_scoped(scope, move || threads.work(work)).expect("the system starts no more threads")
            };
            let threads: Vec<_> = (0..size).map(start).collect();
            threads.into_iter().map(|thread| thread.join().and_then(|outcome| outcome)).collect()
        });
        results(outcomes, post_office.first_failure())
    }

    /// The work of this rank. The others learn how it ended.
    fn work<T>(self, work: impl Fn(Arc<dyn Communicator>) -> T) -> Result<T, Box<dyn Any + Send>> {
        let (rank, post_office) = (self.rank, Arc::clone(&self.post_office));
        let outcome = catch_unwind(AssertUnwindSafe(|| work(Arc::new(self))));
        post_office.leave(rank, outcome.is_err());
        outcome
    }
}

/// The results of all ranks, or the panic of the rank `failed`.
fn results<T>(outcomes: Vec<Result<T, Box<dyn Any + Send>>>, failed: Option<usize>) -> Vec<T> {
    let mut results = Vec::new();
    for (rank, outcome) in outcomes.into_iter().enumerate() {
        match outcome {
            Ok(result) => results.push(result),
            Err(panic) if failed.is_none_or(|failed| failed == rank) => resume_unwind(panic),
            Err(_) => {}
        }
    }
    results
}

impl Communicator for Threads {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.post_office.size()
    }

    fn exchange_while(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])], work: &mut dyn FnMut()) {
        for (to, numbers) in sends {
            self.post_office.send(self.rank, *to, Message::Exchange(numbers.to_vec()));
        }
        work();
        for (from, buffer) in receives {
            match self.post_office.receive(*from, self.rank) {
                Message::Exchange(numbers) => buffer.copy_from_slice(&numbers),
                other => self.confused("exchange", *from, &other),
            }
        }
    }

    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>> {
        (0..self.size()).for_each(|to| self.post_office.send(self.rank, to, Message::Gather(part.to_vec())));
        let receive = |from| match self.post_office.receive(from, self.rank) {
            Message::Gather(part) => part,
            other => self.confused("all_gather", from, &other),
        };
        (0..self.size()).map(receive).collect()
    }

    fn all_gather_known(&self, part: &[f64], lengths: &[usize]) -> Vec<f64> {
        let parts = self.all_gather(part);
        assert!(parts.iter().map(Vec::len).eq(lengths.iter().copied()), "the lengths of the parts of all ranks");
        parts.concat()
    }

    fn broadcast(&self, bytes: &mut Vec<u8>) {
        if self.rank == 0 {
            return (1..self.size()).for_each(|to| self.post_office.send(0, to, Message::Broadcast(bytes.clone())));
        }
        *bytes = match self.post_office.receive(0, self.rank) {
            Message::Broadcast(bytes) => bytes,
            other => self.confused("broadcast", 0, &other),
        }
    }

    fn abort(&self, code: i32) -> ! {
        panic!("rank {} ends all ranks with code {code}", self.rank)
    }

    fn file_sharing(&self) -> Option<FileSharing> {
        self.sharing
    }
}

impl Threads {
    /// Two ranks do not make the same calls.
    fn confused(&self, call: &str, from: usize, message: &Message) -> ! {
        panic!("rank {} calls {call}, but rank {from} has sent a message of {}", self.rank, message.call())
    }
}

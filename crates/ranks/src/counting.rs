//! A communicator that counts what it sends.

use crate::{Communicator, FileSharing};
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts of the messages of a rank. Tests measure communication by them, because counts do not depend on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Calls of `exchange` and `exchange_while`.
    pub exchanges: u64,
    /// Messages of these to other ranks.
    pub messages: u64,
    /// Calls of `all_gather`, `all_gather_known` and `broadcast`.
    pub collectives: u64,
    /// Bytes that this rank gave away: messages to other ranks, its parts of `all_gather`, the bytes of rank 0 in `broadcast`. Each counts
    /// once, however many ranks receive it.
    pub bytes: u64,
}

/// Wraps a communicator and counts its calls, messages and bytes.
#[derive(Debug, Default)]
pub struct Counting<C> {
    communicator: C,
    exchanges: AtomicU64,
    messages: AtomicU64,
    collectives: AtomicU64,
    bytes: AtomicU64,
}

impl<C: Communicator> Counting<C> {
    /// Counts from zero.
    pub fn new(communicator: C) -> Self {
        let zero = || AtomicU64::new(0);
        Self { communicator, exchanges: zero(), messages: zero(), collectives: zero(), bytes: zero() }
    }

    /// The counts since the start or the last `reset`.
    pub fn traffic(&self) -> Traffic {
        self.read(|counter| counter.load(Ordering::Relaxed))
    }

    /// Sets the counts to zero, and returns those until now.
    pub fn reset(&self) -> Traffic {
        self.read(|counter| counter.swap(0, Ordering::Relaxed))
    }

    fn read(&self, read: impl Fn(&AtomicU64) -> u64) -> Traffic {
        Traffic {
            exchanges: read(&self.exchanges),
            messages: read(&self.messages),
            collectives: read(&self.collectives),
            bytes: read(&self.bytes),
        }
    }
}

fn add(counter: &AtomicU64, number: usize) {
    counter.fetch_add(number as u64, Ordering::Relaxed);
}

impl<C: Communicator> Communicator for Counting<C> {
    fn rank(&self) -> usize {
        self.communicator.rank()
    }

    fn size(&self) -> usize {
        self.communicator.size()
    }

    fn exchange_while(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])], work: &mut dyn FnMut()) {
        add(&self.exchanges, 1);
        for (_, numbers) in sends.iter().filter(|(to, _)| *to != self.rank()) {
            add(&self.messages, 1);
            add(&self.bytes, size_of_val(*numbers));
        }
        self.communicator.exchange_while(sends, receives, work);
    }

    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>> {
        add(&self.collectives, 1);
        add(&self.bytes, size_of_val(part));
        self.communicator.all_gather(part)
    }

    fn all_gather_known(&self, part: &[f64], lengths: &[usize]) -> Vec<f64> {
        add(&self.collectives, 1);
        add(&self.bytes, size_of_val(part));
        self.communicator.all_gather_known(part, lengths)
    }

    fn broadcast(&self, bytes: &mut Vec<u8>) {
        add(&self.collectives, 1);
        add(&self.bytes, if self.rank() == 0 { bytes.len() } else { 0 });
        self.communicator.broadcast(bytes);
    }

    fn abort(&self, code: i32) -> ! {
        self.communicator.abort(code)
    }

    fn file_sharing(&self) -> Option<FileSharing> {
        self.communicator.file_sharing()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sums, Threads};
    use std::sync::Arc;

    #[test]
    fn messages_and_bytes_are_counted() {
        let traffic = Threads::run(3, |ranks| {
            let ranks = Counting::new(ranks);
            let (next, before) = ((ranks.rank() + 1) % 3, (ranks.rank() + 2) % 3);
            let (mut from_before, mut from_itself) = ([0.0; 2], [0.0]);
            for _ in 0..5 {
                let receives = &mut [(before, &mut from_before[..]), (ranks.rank(), &mut from_itself[..])];
                ranks.exchange(&[(next, &[1.0, 2.0]), (ranks.rank(), &[3.0])], receives);
            }
            ranks.all_gather(&vec![0.0; ranks.rank()]);
            ranks.all_gather_known(&vec![0.0; ranks.rank()], &[0, 1, 2]);
            ranks.broadcast(&mut b"hello".to_vec());
            // Five messages of two numbers, two parts of as many numbers as the rank says, and five bytes of rank 0.
            let bytes = 80 + [5, 16, 32][ranks.rank()];
            assert_eq!(ranks.reset(), Traffic { exchanges: 5, messages: 5, collectives: 3, bytes });
            ranks.traffic()
        });
        assert_eq!(traffic, [Traffic::default(); 3]);
    }

    /// The traffic of one total of two numbers over eight blocks.
    fn of_total(size: usize) -> Vec<Traffic> {
        Threads::run(size, |ranks| {
            let counting = Arc::new(Counting::new(ranks));
            let sums = Sums::new(counting.clone(), 8);
            sums.total(&vec![1.0; 2 * sums.own().len()], 2);
            counting.traffic()
        })
    }

    #[test]
    fn a_sum_is_one_call_of_few_numbers() {
        assert_eq!(of_total(1), [Traffic::default()]);
        // One node of the tree for each rank.
        for size in [2, 4, 8] {
            assert_eq!(of_total(size), vec![Traffic { collectives: 1, bytes: 16, ..Traffic::default() }; size]);
        }
        // Blocks 0..2 and 5..8: one and two nodes; 2..5: two nodes.
        let bytes: Vec<_> = of_total(3).iter().map(|traffic| traffic.bytes).collect();
        assert_eq!(bytes, [16, 32, 32]);
    }
}

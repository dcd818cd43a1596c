//! Parallel work on items that depend on each other. Every thread takes the next item in order and waits for the items that it
//! needs.
//!
//! The items that a thread waits for are already taken, and the first unfinished item waits for nothing. So there is no deadlock for any
//! number of threads. A barrier after each level of the graph would cost more than the work on short items.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A thread checks a flag this many times before it yields its core.
const SPINS: usize = 1000;

/// Does `work(k)` for all k in 0..`count`, each after the items `needs(k)`, which are smaller than k. At most `width` threads take
/// part.
///
/// `work` must not run parallel loops. While a thread waits in such a loop it may begin another item. That item may need the one that the
/// thread has not finished.
pub fn dependency_schedule<N: IntoIterator<Item = usize>>(
    count: usize,
    width: usize,
    needs: impl Fn(usize) -> N + Sync,
    work: impl Fn(usize) + Sync,
) {
    schedule(count, width, &|k, wait| needs(k).into_iter().for_each(wait), &work);
}

/// Passes the items that an item needs to a function that waits for each.
type WaitForNeeds<'a> = dyn Fn(usize, &mut dyn FnMut(usize)) + Sync + 'a;

/// [`dependency_schedule`], compiled once for all callers.
fn schedule(count: usize, width: usize, wait_for_needs: &WaitForNeeds, work: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    let flags: Vec<AtomicBool> = (0..count).map(|_| AtomicBool::new(false)).collect();
    let take_part = || {
        let numbers = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        for k in numbers.take_while(|k| *k < count) {
            let _done = Done(&flags[k]);
            wait_for_needs(k, &mut |other| wait_for(&flags[other]));
            work(k);
        }
    };
    let threads = rayon::current_num_threads().min(width);
    if threads < 2 {
        return take_part();
    }
    rayon::scope(|scope| {
        (1..threads).for_each(|_| scope.spawn(|_| take_part()));
        take_part();
    });
}

/// Sets the flag of an item at the end of its work, even if the work panics, so that no thread waits for ever.
struct Done<'a>(&'a AtomicBool);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

fn wait_for(flag: &AtomicBool) {
    let mut spins = 0;
    while !flag.load(Ordering::Acquire) {
        spins += 1;
        if spins % SPINS == 0 { std::thread::yield_now() } else { std::hint::spin_loop() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// Every number needs some smaller ones.
    fn needs(k: usize) -> impl Iterator<Item = usize> {
        [1, 3, 7].into_iter().filter_map(move |back| k.checked_sub(back))
    }

    #[test]
    fn all_is_done_once_and_after_what_it_needs() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let log = Mutex::new(Vec::new());
            pool.install(|| dependency_schedule(200, 4, needs, |k| log.lock().expect("no work panics").push(k)));
            let log = log.into_inner().expect("no work panics");
            let place = |k: usize| log.iter().position(|&other| other == k).expect("all are done");
            assert_eq!(log.len(), 200);
            assert!((0..200).all(|k| needs(k).all(|before| place(before) < place(k))), "{threads} threads");
        }
    }

    /// Two schedules in one pool: a thread that waits in one may be needed by the other.
    #[test]
    fn several_share_a_pool() {
        let sum = AtomicUsize::new(0);
        let one = || dependency_schedule(500, 4, needs, |k| _ = sum.fetch_add(k, Ordering::Relaxed));
        rayon::join(|| rayon::join(one, one), || rayon::join(one, one));
        assert_eq!(sum.into_inner(), 4 * 499 * 500 / 2);
    }

    #[test]
    fn work_that_panics_does_not_make_others_wait() {
        let broken = || dependency_schedule(50, 4, needs, |k| assert!(k != 20, "broken"));
        assert!(std::panic::catch_unwind(broken).is_err());
    }
}

//! The shortest time of many short bursts, because other programs may use the machine from time to time.

use rayon::ThreadPool;
use std::time::Instant;

/// The seconds of one call.
fn time(mut call: impl FnMut()) -> f64 {
    let start = Instant::now();
    call();
    start.elapsed().as_secs_f64()
}

/// The seconds of a burst, after which the next kernel follows.
const BURST: f64 = 0.02;

/// The shortest time of a call in a burst; its first calls refill the caches after other kernels.
fn best_of_burst(mut call: impl FnMut()) -> f64 {
    let (start, mut best) = (Instant::now(), f64::INFINITY);
    loop {
        best = best.min(time(&mut call));
        if start.elapsed().as_secs_f64() >= BURST {
            return best;
        }
    }
}

/// The shortest time of `call` in at least `seconds`, and at least three calls after a first one.
pub(super) fn best(seconds: f64, mut call: impl FnMut()) -> f64 {
    call();
    let (start, mut best) = (Instant::now(), f64::INFINITY);
    for calls in 0.. {
        if calls >= 3 && start.elapsed().as_secs_f64() >= seconds {
            break;
        }
        best = best.min(time(&mut call));
    }
    best
}

/// The shortest time of each of `count` kinds of work in each pool, burst by burst in rounds, until `seconds` per kind and pool are over.
pub(super) fn in_turns(
    pools: &[ThreadPool; 2],
    seconds: f64,
    count: usize,
    mut run: impl FnMut(usize, usize) + Send,
) -> Vec<[f64; 2]> {
    let mut best = vec![[f64::INFINITY; 2]; count];
    let (start, budget) = (Instant::now(), 2.0 * seconds * count as f64);
    for round in 0.. {
        if round >= 2 && start.elapsed().as_secs_f64() >= budget {
            break;
        }
        for (number, best) in best.iter_mut().enumerate() {
            for (pool, best) in best.iter_mut().enumerate() {
                let elapsed = pools[pool].install(|| best_of_burst(|| run(pool, number)));
                // The first round warms up.
                *best = if round == 0 { f64::INFINITY } else { best.min(elapsed) };
            }
        }
    }
    best
}

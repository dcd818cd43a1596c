//! Checks the communicator of MPI: `cargo build --release -p message_passing --features mpi --example check`, then
//!
//!     mpirun -n 4 target/release/examples/check [abort | panic]
//!
//! With `abort` or `panic`, rank 1 ends all others that wait for it, with the code 7 or 101.
#![allow(clippy::print_stdout)]

use message_passing::{Error, world};
use ranks::{Communicator, Counting, Sums, agree};
use std::sync::Arc;

fn main() -> Result<(), Error> {
    let ranks = Arc::new(Counting::new(world()?));
    match std::env::args().nth(1).as_deref() {
        Some("abort") if ranks.rank() == 1 => ranks.abort(7),
        Some("panic") if ranks.rank() == 1 => panic!("rank 1 panics"),
        Some(_) => drop(ranks.all_gather(&[])),
        None => check_all(&ranks),
    }
    Ok(())
}

fn check_all(ranks: &Arc<Counting<Arc<dyn Communicator>>>) {
    ring(&**ranks);
    all_to_all(&**ranks);
    gather(&**ranks);
    broadcast(&**ranks);
    errors(&**ranks);
    sums(ranks.clone());
    ranks.all_gather(&[]);
    if ranks.rank() == 0 {
        println!("{} ranks: all checks passed; {:?}", ranks.size(), ranks.traffic());
    }
}

/// Messages to the next rank, short and too long for a buffer of MPI.
fn ring(ranks: &dyn Communicator) {
    let (rank, size) = (ranks.rank(), ranks.size());
    let (next, before) = ((rank + 1) % size, (rank + size - 1) % size);
    for length in [0, 1, 1000, 1 << 20] {
        let mut heard = vec![f64::NAN; length];
        let mut worked = false;
        let send = vec![rank as f64; length];
        ranks.exchange_while(&[(next, &send)], &mut [(before, &mut heard)], &mut || worked = true);
        assert!(worked);
        assert_eq!(heard, vec![before as f64; length]);
    }
}

/// Messages between all pairs of ranks, also from a rank to itself, of different lengths.
fn all_to_all(ranks: &dyn Communicator) {
    let letter = |from: usize, to: usize| vec![(10 * from + to) as f64; 1 + (3 * from + to) % 4];
    let letters: Vec<_> = (0..ranks.size()).map(|to| letter(ranks.rank(), to)).collect();
    let sends: Vec<_> = letters.iter().map(Vec::as_slice).enumerate().collect();
    let expected: Vec<_> = (0..ranks.size()).map(|from| letter(from, ranks.rank())).collect();
    let mut heard: Vec<_> = expected.iter().map(|letter| vec![f64::NAN; letter.len()]).collect();
    let mut receives: Vec<_> = heard.iter_mut().map(Vec::as_mut_slice).enumerate().rev().collect();
    ranks.exchange(&sends, &mut receives);
    assert_eq!(heard, expected);
}

fn gather(ranks: &dyn Communicator) {
    let part = |rank: usize| vec![rank as f64; rank % 3];
    assert_eq!(ranks.all_gather(&part(ranks.rank())), (0..ranks.size()).map(part).collect::<Vec<_>>());
    assert_eq!(ranks.all_gather(&[]), vec![vec![]; ranks.size()]);
    let lengths: Vec<usize> = (0..ranks.size()).map(|rank| rank % 3).collect();
    let all: Vec<f64> = (0..ranks.size()).flat_map(part).collect();
    assert_eq!(ranks.all_gather_known(&part(ranks.rank()), &lengths), all);
}

fn broadcast(ranks: &dyn Communicator) {
    for length in [0, 5, 1 << 20] {
        let mut bytes = vec![if ranks.rank() == 0 { 7 } else { 8 }; if ranks.rank() == 0 { length } else { 3 }];
        ranks.broadcast(&mut bytes);
        assert_eq!(bytes, vec![7; length]);
    }
}

/// All ranks have the error of each rank in turn.
fn errors(ranks: &dyn Communicator) {
    let encode = |error: &String| error.clone().into_bytes();
    let decode = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    for bad in 0..ranks.size() {
        let own = if ranks.rank() == bad { Err(format!("error of rank {bad}")) } else { Ok(()) };
        assert_eq!(agree(ranks, own, encode, decode), Err(format!("error of rank {bad}")));
    }
    assert_eq!(agree(ranks, Ok(ranks.rank()), encode, decode), Ok(ranks.rank()));
}

/// The same bits as on one rank.
fn sums(ranks: Arc<dyn Communicator>) {
    let part = |block: usize| [1.0 / (1 + block) as f64, (block as f64).exp(), [1e16, -1.1, 0.3][block % 3]];
    for blocks in [ranks.size(), 16 * ranks.size() + 5] {
        let sums = Sums::new(ranks.clone(), blocks);
        let own: Vec<f64> = sums.own().flat_map(part).collect();
        let all: Vec<f64> = (0..blocks).flat_map(part).collect();
        let alone = Sums::new(Arc::new(ranks::Alone), blocks).total(&all, 3);
        assert_eq!(bits(&sums.total(&own, 3)), bits(&alone));
        assert_eq!(sums.largest(sums.own().end as f64), blocks as f64);
        assert!(sums.largest(if ranks.rank() == 0 { f64::NAN } else { 1.0 }).is_nan());
    }
}

fn bits(sums: &[f64]) -> Vec<u64> {
    sums.iter().map(|sum| sum.to_bits()).collect()
}

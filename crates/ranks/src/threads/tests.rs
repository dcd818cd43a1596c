use super::*;
use std::time::{Duration, Instant};

const SIZES: [usize; 5] = [1, 2, 3, 5, 8];

/// The message of the rank `from` to the rank `to`: its length depends on both.
fn letter(from: usize, to: usize) -> Vec<f64> {
    (0..1 + (3 * from + to) % 4).map(|k| (100 * from + 10 * to + k) as f64).collect()
}

#[test]
fn neighbours_in_a_ring_exchange_messages() {
    for size in SIZES {
        let heard = Threads::run(size, |ranks| {
            let (rank, mut sum) = (ranks.rank(), 0.0);
            for round in 0..50 {
                let mut number = [f64::NAN];
                let (right, left) = ((rank + 1) % size, (rank + size - 1) % size);
                ranks.exchange(&[(right, &[(rank * round) as f64])], &mut [(left, &mut number)]);
                sum += number[0];
            }
            sum
        });
        let expected: Vec<_> = (0..size).map(|rank| ((rank + size - 1) % size * 1225) as f64).collect();
        assert_eq!(heard, expected);
    }
}

#[test]
fn all_ranks_exchange_messages_with_all() {
    for size in SIZES {
        Threads::run(size, |ranks| {
            let rank = ranks.rank();
            let letters: Vec<_> = (0..size).map(|to| letter(rank, to)).collect();
            let sends: Vec<_> = letters.iter().enumerate().map(|(to, letter)| (to, letter.as_slice())).collect();
            let mut heard: Vec<_> = (0..size).map(|from| vec![0.0; letter(from, rank).len()]).collect();
            let mut receives: Vec<_> = heard.iter_mut().map(|buffer| buffer.as_mut_slice()).enumerate().collect();
            // The order of the list does not matter.
            receives.reverse();
            ranks.exchange(&sends, &mut receives);
            assert_eq!(heard, (0..size).map(|from| letter(from, rank)).collect::<Vec<_>>());
        });
    }
}

#[test]
fn parts_of_any_length_are_gathered_in_the_order_of_ranks() {
    for size in SIZES {
        let part = |rank: usize| vec![rank as f64; rank % 3];
        let gathered = Threads::run(size, |ranks| ranks.all_gather(&part(ranks.rank())));
        let expected: Vec<_> = (0..size).map(part).collect();
        assert!(gathered.iter().all(|parts| *parts == expected));
        let lengths: Vec<usize> = expected.iter().map(Vec::len).collect();
        let known = Threads::run(size, |ranks| ranks.all_gather_known(&part(ranks.rank()), &lengths));
        assert!(known.iter().all(|parts| *parts == expected.concat()));
    }
}

#[test]
fn a_rank_works_while_messages_are_on_their_way() {
    let order = Threads::run(2, |ranks| {
        let (other, mut number, mut worked) = (1 - ranks.rank(), [f64::NAN], 0);
        ranks.exchange_while(&[(other, &[ranks.rank() as f64])], &mut [(other, &mut number)], &mut || worked += 1);
        (number[0], worked)
    });
    assert_eq!(order, [(1.0, 1), (0.0, 1)]);
}

#[test]
fn parts_of_other_lengths_than_those_known_are_refused() {
    let message = panic_of(2, |ranks| drop(ranks.all_gather_known(&[1.0], &[1, 2])));
    assert!(message.contains("the lengths of the parts of all ranks"), "{message}");
}

#[test]
fn all_ranks_have_the_bytes_of_rank_0() {
    for size in SIZES {
        let heard = Threads::run(size, |ranks| {
            let mut bytes = format!("from rank {}", ranks.rank()).into_bytes();
            ranks.broadcast(&mut bytes);
            bytes
        });
        assert!(heard.iter().all(|bytes| bytes == b"from rank 0"));
    }
}

/// The message of the panic with which `work` on `size` ranks ends, within a second.
fn panic_of(size: usize, work: impl Fn(&dyn Communicator) + Sync) -> String {
    let start = Instant::now();
    let panic = catch_unwind(AssertUnwindSafe(|| Threads::run(size, |ranks| work(&*ranks)))).expect_err("no panic");
    assert!(start.elapsed() < Duration::from_secs(1));
    let message = panic.downcast_ref::<String>().cloned();
    message.or_else(|| panic.downcast_ref::<&str>().map(|text| text.to_string())).expect("a panic has a message")
}

#[test]
fn a_panic_of_one_rank_ends_all() {
    for size in SIZES {
        for bad in 0..size {
            let message = panic_of(size, |ranks| {
                assert!(ranks.rank() != bad, "rank {bad} is bad");
                ranks.all_gather(&[]);
                ranks.broadcast(&mut Vec::new());
            });
            assert_eq!(message, format!("rank {bad} is bad"));
        }
    }
}

#[test]
fn an_abort_of_one_rank_ends_all() {
    let message = panic_of(3, |ranks| {
        if ranks.rank() == 1 {
            ranks.abort(7)
        }
        ranks.all_gather(&[]);
    });
    assert_eq!(message, "rank 1 ends all ranks with code 7");
}

#[test]
fn ranks_that_make_different_calls_panic() {
    let returns = panic_of(2, |ranks| {
        if ranks.rank() == 0 {
            ranks.all_gather(&[]);
        }
    });
    assert_eq!(returns, "rank 0 waits in vain for rank 1: rank 1 has ended its work");
    let waits = panic_of(3, |ranks| {
        let other = (ranks.rank() + 1) % 3;
        ranks.exchange(&[], &mut [(other, &mut [0.0])]);
    });
    assert!(waits.ends_with("all ranks wait for each other"), "{waits}");
    let confused = panic_of(2, |ranks| match ranks.rank() {
        0 => ranks.broadcast(&mut Vec::new()),
        _ => drop(ranks.all_gather(&[])),
    });
    assert_eq!(confused, "rank 1 calls all_gather, but rank 0 has sent a message of broadcast");
}

//! What ranks agree on: a failure of one of them, and the mesh that each has solved for.

use crate::Failure;
use ranks::Communicator;
use std::iter::once;

/// The same on all ranks: `result`, or the failure of the lowest rank that has one. That of another rank than the first one says so. A
/// collective call.
///
/// # Errors
/// The failure.
pub fn agree<T>(communicator: &dyn Communicator, result: Result<T, Failure>) -> Result<T, Failure> {
    let rank = communicator.rank();
    ranks::agree(communicator, result, |failure| encode(failure, rank), decode)
}

/// The kind of a failure and the messages of its causes, with a zero before each.
fn encode(failure: &Failure, rank: usize) -> Vec<u8> {
    let (kind, error) = match failure {
        Failure::BadInput(error) => (0, Some(error)),
        Failure::Solve(error) => (1, Some(error)),
        Failure::Stopped => (2, None),
    };
    let messages = error.into_iter().flat_map(|error| error.chain().map(ToString::to_string));
    let place = (rank > 0 && error.is_some()).then(|| format!("process {rank}"));
    once(kind).chain(place.into_iter().chain(messages).flat_map(|text| once(0).chain(text.into_bytes()))).collect()
}

/// The failure behind [`encode`].
fn decode(bytes: &[u8]) -> Failure {
    let messages = bytes.get(1..).unwrap_or_default().split(|byte| *byte == 0).skip(1);
    let texts: Vec<String> = messages.map(|part| String::from_utf8_lossy(part).into_owned()).collect();
    let mut parts = texts.into_iter().rev();
    let last = parts.next().unwrap_or_default();
    let error = parts.fold(anyhow::anyhow!(last), anyhow::Error::context);
    match bytes.first() {
        Some(2) => Failure::Stopped,
        Some(1) => Failure::Solve(error),
        _ => Failure::BadInput(error),
    }
}

/// A number that differs if a bit of the numbers differs: FNV-1a.
pub fn digest(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let add = |hash: u64, number: f64| {
        number
            .to_bits()
            .to_le_bytes()
            .iter()
            .fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
    };
    numbers.into_iter().fold(0xcbf2_9ce4_8422_2325, add)
}

/// The first rank whose `digest` is not that of rank 0. A collective call.
pub fn first_other(communicator: &dyn Communicator, digest: u64) -> Option<usize> {
    let halves = [(digest >> 32) as f64, f64::from(digest as u32)];
    let all = communicator.all_gather_known(&halves, &vec![2; communicator.size()]);
    let (all, _) = all.as_chunks::<2>();
    all.iter().position(|other| *other != all[0])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use anyhow::{Context, anyhow};
    use ranks::Threads;

    fn failure() -> Failure {
        Failure::Solve(anyhow!("no space left").context("cannot write").context("the slab is lost"))
    }

    fn words(failure: &Failure) -> Vec<String> {
        match failure {
            Failure::BadInput(error) | Failure::Solve(error) => error.chain().map(ToString::to_string).collect(),
            Failure::Stopped => Vec::new(),
        }
    }

    #[test]
    fn a_failure_of_one_rank_is_that_of_all() {
        for bad in 0..3 {
            let outcomes = Threads::run(3, |ranks| {
                let own = if ranks.rank() == bad { Err(failure()) } else { Ok(ranks.rank()) };
                agree(&*ranks, own)
            });
            for outcome in outcomes {
                let failure = outcome.unwrap_err();
                assert!(matches!(failure, Failure::Solve(_)));
                let place = (bad > 0).then(|| format!("process {bad}"));
                let causes = ["the slab is lost", "cannot write", "no space left"].map(String::from);
                assert_eq!(words(&failure), place.into_iter().chain(causes).collect::<Vec<_>>());
            }
        }
        let outcomes = Threads::run(2, |ranks| agree(&*ranks, Ok(ranks.rank())));
        assert_eq!(outcomes.into_iter().map(Result::unwrap).collect::<Vec<_>>(), [0, 1]);
    }

    #[test]
    fn a_failure_without_words_keeps_its_kind() {
        let outcomes = Threads::run(2, |ranks| agree::<()>(&*ranks, Err(Failure::Stopped)));
        assert!(outcomes.iter().all(|outcome| matches!(outcome, Err(Failure::Stopped))));
        let bad = Err::<(), _>(anyhow!("b")).context("a");
        assert_eq!(words(&decode(&encode(&Failure::BadInput(bad.unwrap_err()), 0))), ["a", "b"]);
    }

    #[test]
    fn one_bit_of_one_rank_is_found() {
        let numbers = [0.1_f64, -0.0, 3.0];
        let other = |bad: Option<usize>| {
            Threads::run(4, |ranks| {
                let mut own = numbers;
                if bad == Some(ranks.rank()) {
                    own[0] = own[0].next_up();
                }
                first_other(&*ranks, digest(own))
            })
        };
        assert_eq!(other(None), [None; 4]);
        assert_eq!(other(Some(2)), [Some(2); 4]);
        // All differ from the first.
        assert_eq!(other(Some(0)), [Some(1); 4]);
        assert_ne!(digest([0.0]), digest([-0.0]));
        assert_ne!(digest([1.0, 2.0]), digest([2.0, 1.0]));
    }
}

//! Agreement of all ranks on an error.

use crate::Communicator;

/// Agreement: the same result on all ranks. It is the error of the lowest rank with an error, otherwise Ok.
///
/// Every step that may fail on one rank alone ends in it, before the next collective call. With one rank the result is returned as it is.
/// With more, all ranks return what `decode` makes of the bytes of the error, also the rank whose error it is.
pub fn agree<T, E>(
    communicator: &dyn Communicator,
    result: Result<T, E>,
    encode: impl Fn(&E) -> Vec<u8>,
    decode: impl Fn(&[u8]) -> E,
) -> Result<T, E> {
    if communicator.size() == 1 {
        return result;
    }
    let own = result.as_ref().err().map(encode);
    match first_error(communicator, own) {
        Some(bytes) => Err(decode(&bytes)),
        None => result,
    }
}

/// The bytes of the lowest rank that has any.
fn first_error(communicator: &dyn Communicator, own: Option<Vec<u8>>) -> Option<Vec<u8>> {
    // A mark before the bytes tells an error without bytes from success.
    let part: Vec<f64> =
        own.iter().flat_map(|bytes| std::iter::once(&1).chain(bytes)).map(|byte| f64::from(*byte)).collect();
    let parts = communicator.all_gather(&part);
    let first = parts.iter().find(|part| !part.is_empty())?;
    Some(first[1..].iter().map(|number| *number as u8).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Alone, Threads};

    fn agree_on(ranks: &dyn Communicator, result: Result<usize, String>) -> Result<usize, String> {
        let decode = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        agree(ranks, result, |error| error.clone().into_bytes(), decode)
    }

    /// The result on which the ranks agree if each rank of `bad` has an error.
    fn outcomes(size: usize, bad: &[usize]) -> Vec<Result<usize, String>> {
        Threads::run(size, |ranks| {
            let rank = ranks.rank();
            agree_on(&*ranks, if bad.contains(&rank) { Err(format!("error of rank {rank}: \u{e9}")) } else { Ok(rank) })
        })
    }

    #[test]
    fn an_error_of_one_rank_is_an_error_of_all() {
        for size in [1, 2, 3, 5, 8] {
            for bad in 0..size {
                assert_eq!(outcomes(size, &[bad]), vec![Err(format!("error of rank {bad}: \u{e9}")); size]);
            }
            assert_eq!(outcomes(size, &[]), (0..size).map(Ok).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_error_of_the_lowest_rank_wins() {
        assert_eq!(outcomes(5, &[3, 1, 4]), vec![Err("error of rank 1: \u{e9}".to_string()); 5]);
    }

    #[test]
    fn an_error_may_have_no_bytes() {
        let outcomes =
            Threads::run(2, |ranks| agree_on(&*ranks, if ranks.rank() == 1 { Err(String::new()) } else { Ok(0) }));
        assert_eq!(outcomes, [Err(String::new()), Err(String::new())]);
    }

    #[test]
    fn a_rank_alone_keeps_its_error() {
        let result: Result<(), String> = agree(&Alone, Err("own".into()), |_| unreachable!(), |_| unreachable!());
        assert_eq!(result, Err("own".to_string()));
    }
}

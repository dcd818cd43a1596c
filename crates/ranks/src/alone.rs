//! One rank, without others.

use crate::Communicator;

/// The only rank. Nothing is sent; a message to itself is a copy.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Communicator for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn exchange_while(&self, sends: &[(usize, &[f64])], receives: &mut [(usize, &mut [f64])], work: &mut dyn FnMut()) {
        assert_eq!(sends.len(), receives.len(), "a rank alone receives what it sends");
        for ((to, numbers), (from, buffer)) in sends.iter().zip(receives) {
            assert!(*to == 0 && *from == 0, "there is only rank 0");
            buffer.copy_from_slice(numbers);
        }
        work();
    }

    fn all_gather(&self, part: &[f64]) -> Vec<Vec<f64>> {
        vec![part.to_vec()]
    }

    fn all_gather_known(&self, part: &[f64], lengths: &[usize]) -> Vec<f64> {
        assert_eq!(lengths, [part.len()], "the length of the only part");
        part.to_vec()
    }

    fn broadcast(&self, _bytes: &mut Vec<u8>) {}

    fn abort(&self, code: i32) -> ! {
        std::process::exit(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rank_alone_hears_itself() {
        let mut heard = [0.0; 2];
        Alone.exchange(&[(0, &[1.0, 2.0])], &mut [(0, &mut heard)]);
        assert_eq!(heard, [1.0, 2.0]);
        Alone.exchange(&[], &mut []);
        assert_eq!(Alone.all_gather(&[3.0]), [[3.0]]);
        assert_eq!(Alone.all_gather_known(&[3.0, 4.0], &[2]), [3.0, 4.0]);
        let mut worked = false;
        Alone.exchange_while(&[], &mut [], &mut || worked = true);
        assert!(worked);
        let mut bytes = b"kept".to_vec();
        Alone.broadcast(&mut bytes);
        assert_eq!((bytes.as_slice(), Alone.rank(), Alone.size()), (&b"kept"[..], 0, 1));
    }
}

//! Numbers in single precision in messages, which consist of numbers in double precision: two in one, bit by bit.

/// So many numbers in double precision hold `len` in single precision.
pub fn packed(len: usize) -> usize {
    len.div_ceil(2)
}

/// Appends `numbers` to `message`.
pub fn pack(numbers: &[f32], message: &mut Vec<f64>) {
    let (pairs, last) = numbers.as_chunks::<2>();
    let join = |low: f32, high: f32| f64::from_bits(u64::from(low.to_bits()) | u64::from(high.to_bits()) << 32);
    message.extend(pairs.iter().map(|&[low, high]| join(low, high)));
    message.extend(last.iter().map(|&low| join(low, 0.0)));
}

/// The numbers behind [`pack`].
pub fn unpack(message: &[f64], numbers: &mut [f32]) {
    for (pair, packed) in numbers.chunks_mut(2).zip(message) {
        let bits = packed.to_bits();
        let halves = [bits as u32, (bits >> 32) as u32].map(f32::from_bits);
        pair.copy_from_slice(&halves[..pair.len()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_bits() {
        for numbers in [&[1.5, -0.0, f32::NAN, f32::MIN_POSITIVE, -f32::INFINITY][..], &[0.1, 0.2], &[]] {
            let (mut message, mut back) = (vec![7.0], vec![9.0; numbers.len()]);
            pack(numbers, &mut message);
            assert_eq!(message.len(), 1 + packed(numbers.len()));
            unpack(&message[1..], &mut back);
            let bits = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&back), bits(numbers));
        }
    }
}

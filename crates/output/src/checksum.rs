//! A checksum that is the same on every machine and for every version of the program.

use std::fmt;

/// FNV-1a over 64-bit words: x <- (x xor word) * prime (Fowler, Noll and Vo, 1991).
///
/// Each step is a bijection of x, so a single damaged word always changes the result. The checksum detects incomplete
/// files and distinguishes cases; it does not resist forgery.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Checksum(u64);

const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

impl Default for Checksum {
    fn default() -> Self {
        Self(OFFSET)
    }
}

impl Checksum {
    /// The checksum with one more word.
    #[must_use]
    pub fn word(self, word: u64) -> Self {
        Self((self.0 ^ word).wrapping_mul(PRIME))
    }

    /// The checksum with a text: its length, then its bytes, so that consecutive texts stay distinct.
    #[must_use]
    pub fn text(self, text: &str) -> Self {
        text.bytes().fold(self.word(text.len() as u64), |sum, byte| sum.word(u64::from(byte)))
    }

    /// The checksum with numbers: their count, then their bits.
    #[must_use]
    pub fn numbers(self, numbers: &[f64]) -> Self {
        numbers.iter().fold(self.word(numbers.len() as u64), |sum, number| sum.word(number.to_bits()))
    }

    /// The value.
    pub fn value(self) -> u64 {
        self.0
    }
}

impl fmt::Display for Checksum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reference_value_of_fnv_1a() {
        // FNV-1a of the single byte "a" as published with the algorithm.
        assert_eq!(Checksum::default().word(u64::from(b'a')).value(), 0xaf63_dc4c_8601_ec8c);
    }

    #[test]
    fn every_single_bit_counts() {
        let numbers = [1.0, -0.0, f64::MIN_POSITIVE];
        let sum = Checksum::default().numbers(&numbers);
        for index in 0..numbers.len() {
            for bit in 0..64 {
                let mut damaged = numbers;
                damaged[index] = f64::from_bits(numbers[index].to_bits() ^ (1 << bit));
                assert_ne!(Checksum::default().numbers(&damaged), sum, "number {index}, bit {bit}");
            }
        }
    }

    #[test]
    fn texts_do_not_run_together() {
        assert_ne!(Checksum::default().text("ab").text("c"), Checksum::default().text("a").text("bc"));
    }
}

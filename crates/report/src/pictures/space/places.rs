//! Points that are the same up to round-off.

use std::collections::HashMap;

/// Points closer than this fraction of the length of the domain are the same.
const SAME: f64 = 1e-8;

/// The place of a point, in units of the smallest distance.
pub type Place = [i64; 3];

/// The places in a domain.
#[derive(Clone, Copy)]
pub struct Places {
    unit: f64,
}

impl Places {
    /// The places in a domain of this length.
    pub fn new(length: f64) -> Self {
        Places { unit: SAME * length }
    }

    /// The place of a point.
    pub fn of(self, point: &[f64; 3]) -> Place {
        point.map(|x| (x / self.unit).round() as i64)
    }

    /// The sums of numbers at points, by place, added in their order.
    pub fn sums<'p, const N: usize>(
        self,
        numbers: impl Iterator<Item = (&'p [f64; 3], [f64; N])>,
    ) -> HashMap<Place, [f64; N]> {
        let mut sums = HashMap::new();
        for (point, numbers) in numbers {
            let sum = sums.entry(self.of(point)).or_insert([0.0; N]);
            sum.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_with_other_last_digits_are_one() {
        let places = Places::new(10.0);
        let points = [[0.3, 1.0, 2.0], [0.1 + 0.2, 1.0, 2.0], [0.3001, 1.0, 2.0]];
        let sums = places.sums(points.iter().map(|point| (point, [1.0])));
        assert_eq!((sums.len(), sums[&places.of(&points[0])]), (2, [2.0]));
    }
}

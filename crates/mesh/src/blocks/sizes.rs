//! The sizes that blocks may have.

/// The largest deviation of the size of a block from the mean, relative to the mean. One cell is always allowed.
const SLACK: f64 = 0.03;

/// The smallest and the largest size of a block, in cells.
pub(super) struct Limits {
    smallest: usize,
    largest: usize,
}

/// The sizes that the first side of a bisection may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Range {
    pub(super) low: i64,
    pub(super) high: i64,
}

impl Limits {
    /// For `count` blocks of a mesh of `cells` cells; there are at least `count` cells.
    pub(super) fn new(cells: usize, count: usize) -> Self {
        let mean = cells as f64 / count as f64;
        let slack = (SLACK * mean).max(1.0);
        Limits { smallest: ((mean - slack).ceil() as usize).max(1), largest: (mean + slack).floor() as usize }
    }

    /// The sizes of the first side of a cut through `cells` cells, which are to become `counts` blocks on its two sides.
    /// Later cuts of a side share the rest of its tolerance.
    pub(super) fn first_side(&self, cells: usize, counts: [usize; 2]) -> Range {
        let low = (counts[0] * self.smallest).max(cells.saturating_sub(counts[1] * self.largest));
        let high = (counts[0] * self.largest).min(cells - counts[1] * self.smallest);
        let (total, levels) = (counts[0] + counts[1], counts[1].ilog2() as usize + 1);
        let exact = (cells * counts[0]) as f64 / total as f64;
        let towards = |bound: usize| exact + (bound as f64 - exact) / levels as f64;
        let (floor, ceil) = (exact.floor() as i64, exact.ceil() as i64);
        let range =
            Range { low: (towards(low).ceil() as i64).min(floor), high: (towards(high).floor() as i64).max(ceil) };
        Range { low: range.low.max(low as i64), high: range.high.min(high as i64) }
    }
}

impl Range {
    /// By how many cells a first side of this size violates the range.
    pub(super) fn violation(&self, size: i64) -> i64 {
        (self.low - size).max(size - self.high).max(0)
    }
    /// The range, widened for a graph whose vertices stand for up to `largest` cells each: it cannot meet the range exactly.
    pub(super) fn widened(&self, largest: i64) -> Range {
        let extra = (largest - 1).max(0) / 2;
        Range { low: self.low - extra, high: self.high + extra }
    }
    /// The middle of the range.
    pub(super) fn middle(&self) -> i64 {
        (self.low + self.high) / 2
    }
}

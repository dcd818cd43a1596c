//! When a checkpoint is due.

use std::time::{Duration, Instant};

/// Slabs between checkpoints, at least, where the case gives no number.
const FEWEST_SLABS: usize = 10;

/// The run goes on for this multiple of the duration of a checkpoint before the next one. A checkpoint copies the whole file: at a fixed number of
/// slabs all copies together would grow with the square of the run.
const PAUSE: u32 = 20;

/// The slabs and the time since the last checkpoint. No result depends on it: a run that goes back to a checkpoint writes one for that.
#[derive(Debug)]
pub(super) struct CheckpointSchedule {
    /// The slabs between checkpoints, if the case gives them.
    every: Option<usize>,
    slabs: usize,
    /// The end and the duration of the last checkpoint.
    last: Option<(Instant, Duration)>,
}

impl CheckpointSchedule {
    /// The schedule of a run that begins; `every` is the number of slabs in its case.
    pub fn new(every: Option<usize>) -> Self {
        CheckpointSchedule { every, slabs: 0, last: None }
    }

    /// Counts a slab that ends `now`; returns whether a checkpoint is due.
    pub fn count(&mut self, now: Instant) -> bool {
        self.slabs += 1;
        match self.every {
            Some(every) => self.slabs >= every,
            None => self.slabs >= FEWEST_SLABS && self.has_paused(now),
        }
    }

    /// Whether the last checkpoint was long ago, compared with its duration.
    fn has_paused(&self, now: Instant) -> bool {
        self.last.is_none_or(|(end, duration)| now.saturating_duration_since(end) >= PAUSE * duration)
    }

    /// A checkpoint was written between these times.
    pub fn written(&mut self, begin: Instant, end: Instant) {
        self.slabs = 0;
        self.last = Some((end, end.saturating_duration_since(begin)));
    }

    /// The run has gone back to its last checkpoint.
    pub fn go_back(&mut self) {
        self.slabs = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of the first slab with a checkpoint after one that took a second; a slab takes this time.
    fn slabs_until_due(every: Option<usize>, slab: Duration) -> Option<usize> {
        let begin = Instant::now();
        let mut schedule = CheckpointSchedule::new(every);
        schedule.written(begin, begin + Duration::from_secs(1));
        (1..1000).find(|number| schedule.count(begin + Duration::from_secs(1) + slab * *number as u32))
    }

    /// Checkpoints every ten slabs were four fifths of the time of a long run with a small mesh.
    #[test]
    fn checkpoints_are_spaced_by_their_own_duration() {
        assert_eq!(slabs_until_due(None, Duration::from_millis(100)), Some(200));
        assert_eq!(slabs_until_due(None, Duration::from_secs(60)), Some(FEWEST_SLABS), "long slabs");
    }

    #[test]
    fn a_given_number_of_slabs_is_kept_exactly() {
        assert_eq!(slabs_until_due(Some(3), Duration::from_millis(1)), Some(3));
        assert_eq!(slabs_until_due(Some(300), Duration::from_secs(60)), Some(300));
    }

    #[test]
    fn the_first_checkpoint_needs_slabs_only() {
        let mut schedule = CheckpointSchedule::new(None);
        let now = Instant::now();
        assert_eq!((1..100).find(|_| schedule.count(now)), Some(FEWEST_SLABS));
        schedule.go_back();
        assert!(!schedule.count(now));
    }
}

//! How many pictures fit into the page.

use super::cuts::Cut;
use super::{Encoded, Frame};

/// The largest size of all pictures in the page, in bytes.
const MOST_BYTES: usize = 9_000_000;

/// The largest size of the cuts among them.
const MOST_BYTES_OF_CUTS: usize = 3_000_000;

/// `most` of `count` things at equal distances, the first and the last among them.
pub fn chosen(count: usize, most: usize) -> Vec<usize> {
    let shown = count.min(most);
    (0..shown).map(|i| if shown > 1 { i * (count - 1) / (shown - 1) } else { 0 }).collect()
}

/// As many of the cuts and frames, each at equal distances, as fit into the page.
pub fn fitting(frames: Vec<Frame>, cuts: Vec<Cut>) -> (Vec<Frame>, Vec<Cut>) {
    let bytes = |cut: &Cut| cut.views.iter().map(Encoded::bytes).sum::<usize>();
    let room = MOST_BYTES_OF_CUTS.checked_div(cuts.len()).unwrap_or(0);
    let cuts: Vec<Cut> = cuts.into_iter().map(|cut| with_fewer_positions(cut, room)).collect();
    let room = MOST_BYTES - cuts.iter().map(bytes).sum::<usize>().min(MOST_BYTES);
    let of_frame = |frame: &Frame| frame.views.iter().map(Encoded::bytes).sum::<usize>();
    (thinned(frames, of_frame, room), cuts)
}

/// A cut with as many of its positions as have room.
fn with_fewer_positions(cut: Cut, room: usize) -> Cut {
    let both = cut.positions.into_iter().zip(cut.views).collect();
    let (positions, views) = thinned(both, |(_, view)| view.bytes(), room).into_iter().unzip();
    Cut { window: cut.window, positions, views }
}

/// As many of `all`, at equal distances, as have room, but at least the first and the last.
fn thinned<T>(all: Vec<T>, bytes: impl Fn(&T) -> usize, room: usize) -> Vec<T> {
    let size: usize = all.iter().map(bytes).sum();
    let most = (all.len() * room).checked_div(size).unwrap_or(usize::MAX).max(2);
    let kept = chosen(all.len(), most);
    all.into_iter().enumerate().filter(|(i, _)| kept.binary_search(i).is_ok()).map(|(_, one)| one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::bounds::Extent;
    use super::super::window::Window;
    use super::*;

    #[test]
    fn the_first_and_the_last_step_are_shown() {
        assert_eq!(chosen(1, 40), [0]);
        assert_eq!(chosen(3, 40), [0, 1, 2]);
        assert_eq!(chosen(5, 3), [0, 2, 4]);
        let many = chosen(1001, 40);
        assert_eq!((many.len(), many[0], many[39]), (40, 0, 1000));
        assert!(many.is_sorted_by(|a, b| a < b));
    }

    /// Pictures of this size.
    fn view(bytes: usize) -> Encoded {
        Encoded { pictures: vec![], mesh: "x".repeat(bytes), outline: String::new(), shift: [0.0; 2] }
    }

    fn frames(count: usize) -> Vec<Frame> {
        (0..count).map(|step| Frame { step, time: step as f64, views: vec![view(2_000_000)] }).collect()
    }

    #[test]
    fn too_many_pictures_are_thinned_out() {
        let steps = |count: usize| fitting(frames(count), vec![]).0.iter().map(|f| f.step).collect::<Vec<_>>();
        assert_eq!(steps(4), [0, 1, 2, 3]);
        assert_eq!(steps(7), [0, 2, 4, 6]);
        assert_eq!(steps(100), [0, 33, 66, 99]);
    }

    #[test]
    fn cuts_leave_room_for_the_times() {
        let cut = |bytes: usize| {
            let window = Window::new("", Extent { lower: [0.0; 2], upper: [1.0; 2] }, 9.0);
            Cut { window, positions: (0..7).map(f64::from).collect(), views: (0..7).map(|_| view(bytes)).collect() }
        };
        let (times, cuts) = fitting(frames(10), [100_000; 3].map(cut).into());
        assert_eq!(cuts.iter().map(|cut| cut.views.len()).collect::<Vec<_>>(), [7, 7, 7]);
        assert_eq!(times.len(), 3, "6.9 MB are left");
        let (_, cuts) = fitting(frames(1), [200_000; 3].map(cut).into());
        assert_eq!(cuts[1].positions, [0.0, 1.0, 3.0, 4.0, 6.0]);
        assert!(cuts.iter().all(|cut| cut.views.len() == 5));
    }
}

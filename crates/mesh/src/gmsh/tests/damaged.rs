//! Damaged files give an error or, if the damage does not matter, a mesh; never a panic, never much memory.

use super::drawing::{all_shapes, square};
use super::{Encoding, SQUARE_2, SQUARE_4, two_cells};
use crate::random::SplitMix64;
use crate::{Mesh, Simplices};

fn samples() -> Vec<Vec<u8>> {
    let mut files = vec![SQUARE_2.as_bytes().to_vec(), SQUARE_4.as_bytes().to_vec()];
    for encoding in Encoding::ALL {
        files.extend([two_cells().version2(encoding), two_cells().version4(encoding)]);
    }
    files
}

#[test]
fn files_cut_anywhere_are_refused() {
    for file in samples() {
        // Without the last line break the file is still complete.
        for length in 0..file.len() - 1 {
            assert!(Mesh::<2>::from_gmsh(&file[..length], &[]).is_err(), "{length} of {}", file.len());
        }
    }
}

#[test]
fn flipped_bytes_never_panic() {
    let mut random = SplitMix64::new(20);
    let (mut refused, mut tried) = (0, 0);
    for file in samples() {
        for _ in 0..1500 {
            let mut damaged = file.clone();
            for _ in 0..=random.below(3) {
                let place = random.below(file.len());
                damaged[place] = random.below(256) as u8;
            }
            let flat = Mesh::<2>::from_gmsh(&damaged, &[]);
            let space = Mesh::<3>::from_gmsh(&damaged, &[]);
            assert!(space.is_err());
            refused += usize::from(flat.is_err());
            tried += 1;
        }
    }
    assert!(refused > tried / 2 && refused < tried, "{refused} of {tried} refused");
}

#[test]
fn damaged_simplices_never_panic() {
    let plane = square(2, |i, _| i == 0).file(2, |x| x);
    let mut random = SplitMix64::new(21);
    let (mut refused, mut tried) = (0, 0);
    for encoding in Encoding::ALL {
        for file in [plane.version2(encoding), plane.version4(encoding), all_shapes().file(1, |x| x).version2(encoding)]
        {
            for _ in 0..1500 {
                let mut damaged = file.clone();
                for _ in 0..=random.below(3) {
                    let place = random.below(file.len());
                    damaged[place] = random.below(256) as u8;
                }
                let pair = [("left".to_owned(), "right".to_owned())];
                let plane = Mesh::<2>::from_gmsh_with(&damaged, &pair[random.below(2)..], Simplices::Split);
                let space = Mesh::<3>::from_gmsh_with(&damaged, &[], Simplices::Split);
                refused += usize::from(plane.is_err() && space.is_err());
                tried += 1;
            }
        }
    }
    assert!(refused > tried / 4 && refused < tried, "{refused} of {tried} refused");
}

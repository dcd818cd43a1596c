//! The reader of Gmsh files.
#![no_main]

#[path = "../src/gmsh.rs"]
mod gmsh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    gmsh::read(bytes);
});

//! The reader of case files.
#![no_main]

#[path = "../src/case.rs"]
mod case;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    case::read(bytes);
});

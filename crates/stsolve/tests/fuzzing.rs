//! Random bytes for all readers: a result or an error, never a crash or a hang.
//!
//! The readers are those of the fuzz targets in `fuzz/`. The inputs are damaged seeds, the same ones each time. For
//! more: `STSOLVE_FUZZ_INPUTS=1000000 cargo test --release -p stsolve --test fuzzing`; with coverage: `scripts/fuzz`.

#![allow(clippy::unwrap_used)]

#[path = "../../../fuzz/src/case.rs"]
mod case;
#[path = "../../../fuzz/src/checkpoint.rs"]
mod checkpoint;
mod common;
#[path = "../../../fuzz/src/gmsh.rs"]
mod gmsh;
#[path = "common/random.rs"]
mod random;

use random::Random;
use std::ops::Range;
use std::path::Path;

/// Cases whose meshes are built quickly.
const CASES: [&str; 6] = ["channel_roughness", "couette", "free_stream", "free_stream_3d", "manufactured", "vortex"];

/// The files of a folder of the repository, by name.
fn seeds(folder: &str) -> Vec<Vec<u8>> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    let mut paths: Vec<_> = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().filter(|path| path.is_file()).map(|path| std::fs::read(path).unwrap()).collect()
}

/// A random piece of `bytes`, mostly a short one.
fn piece(bytes: &[u8], random: &mut Random) -> Range<usize> {
    let longest = 1 << random.below(7);
    let (start, length) = (random.below(bytes.len() + 1), random.below(longest));
    start..(start + length).min(bytes.len())
}

/// One of the seeds with a few pieces lost, doubled, taken from another seed, or overwritten.
fn damaged(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = random.choose(seeds).unwrap();
    for _ in 0..=random.below(3) {
        let (Range { start, end }, other) = (piece(&bytes, random), random.below(seeds.len()));
        let tokens: [&[u8]; 8] =
            [b"-1", b"0", b"1e999", b"18446744073709551615", b"nan", b"\"", b"[[", b"\xff\xff\xff\x7f"];
        let new = match random.below(6) {
            0 => Vec::new(),
            1 => bytes[start..end].repeat(2),
            2 => seeds[other][piece(&seeds[other], random)].to_vec(),
            3 => random.choose(&tokens).unwrap().to_vec(),
            4 => (start..end).map(|_| random.bits() as u8).collect(),
            _ => bytes[start..end].iter().map(|byte| byte ^ (1 << random.below(8))).collect(),
        };
        bytes.splice(start..end, new);
    }
    bytes
}

/// Reads damaged seeds, `inputs` of them or as many as the environment says. The seeds themselves must be readable. Some
/// damaged ones must be readable too, or the damage is too severe to reach far into the reader.
#[allow(clippy::print_stdout)]
fn fuzz(name: &str, seeds: &[Vec<u8>], inputs: usize, read: fn(&[u8]) -> bool) -> usize {
    let inputs = std::env::var("STSOLVE_FUZZ_INPUTS").map_or(inputs, |number| number.parse().unwrap());
    assert!(seeds.iter().all(|seed| read(seed)), "{name}: a seed is refused");
    let mut random = Random(6);
    let input = |_| Some(damaged(seeds, &mut random)).filter(|input| !seeds.contains(input));
    let readable = (0..inputs).filter_map(input).filter(|input| read(input)).count();
    println!("{name}: {inputs} inputs, {readable} readable");
    readable
}

#[test]
fn any_bytes_as_a_case() {
    let seeds = CASES.map(|name| std::fs::read(common::shipped(&format!("{name}.toml"))).unwrap());
    assert!(fuzz("cases", &seeds, 500, case::read) > 50);
}

#[test]
fn any_bytes_as_a_gmsh_file() {
    assert!(fuzz("Gmsh files", &seeds("fuzz/seeds/gmsh"), 5000, gmsh::read) > 50);
}

#[test]
fn any_bytes_as_a_result_file() {
    let directory = tempfile::TempDir::new().unwrap();
    let set = ["mesh.order=2", "mesh.generate.box.cells=[1,1]", "flow.order=2", "time.end=0.2", "output.fields=[]"];
    common::finished(directory.path(), "vortex", &set);
    let seed = std::fs::read(directory.path().join("vortex/result.vtkhdf")).unwrap();
    assert_eq!(fuzz("result files", &[seed], 500, checkpoint::read), 0, "damage that the checksum does not show");
}

//! A small run whose numbers are all different, and a comparison of every bit of a result file.

#![allow(clippy::unwrap_used, dead_code)]

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use output::{
    ArraySpec, FieldSpec, FileLayout, Grid, Metadata, OutputError, RestMesh, ResultFile, RunDirectory, SharedFile,
    SolverState, Step,
};
use ranks::{Communicator, FileSharing, Threads};

pub const CASE: &str = "0123456789abcdef";

pub fn layout() -> FileLayout {
    FileLayout {
        grid: Grid { dimension: 2, points_per_direction: 3, cells: 40 },
        fields: vec![FieldSpec::vector("velocity"), FieldSpec::scalar("density")],
        exact: vec![ArraySpec::new("flow", &[("cell", 40), ("time node", 2), ("component", 4), ("space node", 9)])],
    }
}

pub fn metadata() -> Metadata {
    Metadata {
        creator: "stsolve test".to_owned(),
        case_name: "box".to_owned(),
        case_text: "title = \"größer\"\n".to_owned(),
        case_fingerprint: CASE.to_owned(),
        mesh_id: "fedcba9876543210".to_owned(),
        space_nodes: vec![-1.0, 0.0, 1.0],
        time_nodes: vec![1.0 / 3.0, 1.0],
        mesh: RestMesh {
            position: vec![0.0, 0.5, -1e-300],
            boundary_names: vec!["wall".to_owned(), "sortie d'été".to_owned()],
            boundary_facets: vec![[0, 1, 0], [39, 2, 1]],
        },
    }
}

/// Pseudo-random bits (SplitMix64), so that they cannot be guessed or compressed; NaN and infinity occur.
pub fn noise(seed: u64, count: usize) -> Vec<f64> {
    let mix = |i: u64| {
        let mut z = (seed << 32 | i).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from_bits(z ^ (z >> 31))
    };
    (0..count as u64).map(mix).collect()
}

/// The state after a slab.
pub fn state(slab: u64) -> SolverState {
    SolverState {
        arrays: BTreeMap::from([
            ("flow".to_owned(), noise(1000 + slab, 700).into()),
            ("history".to_owned(), noise(2000, 3 * slab as usize).into()),
            ("special".to_owned(), vec![-0.0, f64::NAN, f64::NEG_INFINITY, 5e-324, 0.1 + 0.2].into()),
        ]),
        integers: BTreeMap::from([("slab".to_owned(), slab as i64), ("lowest".to_owned(), i64::MIN)]),
        texts: BTreeMap::from([("note".to_owned(), "Δt halved".to_owned()), ("empty".to_owned(), String::new())]),
    }
}

pub fn append(result: &mut ResultFile, slab: u64) {
    write_cells(slab, &(0..layout().grid.cells), |step| result.append(step)).unwrap();
}

/// Points, density, velocity and flow of the step of [`append`].
fn arrays(slab: u64) -> [Vec<f64>; 4] {
    let (points, of_flow) = (layout().grid.points(), layout().exact[0].len());
    let seeds = [(slab, 3 * points), (slab + 100, points), (slab + 200, 3 * points), (slab + 300, of_flow)];
    seeds.map(|(seed, count)| noise(seed, count))
}

/// Passes some `cells` of the step of [`append`] to `write`.
fn write_cells(
    slab: u64,
    cells: &Range<usize>,
    write: impl FnOnce(&Step) -> Result<(), OutputError>,
) -> Result<(), OutputError> {
    let arrays = arrays(slab);
    let [x, density, velocity, flow] = arrays.each_ref().map(|values| {
        let len = values.len() / layout().grid.cells;
        &values[cells.start * len..cells.end * len]
    });
    let fields: [(&str, &[f64]); 2] = [("density", density), ("velocity", velocity)];
    write(&Step { time: slab as f64, points: x, fields: &fields, exact: &[("flow", flow)] })
}

/// The step of [`append`], in parts of these cells.
pub fn append_in_parts(result: &mut ResultFile, slab: u64, parts: &[Range<usize>]) -> Result<(), OutputError> {
    let mut step = result.append_in_parts(slab as f64)?;
    parts.iter().try_for_each(|cells| write_cells(slab, cells, |part| step.add(part)))?;
    step.finish()
}

/// The step of [`append`], in parts of these cells, each by a rank of its own.
pub fn append_together(result: &mut ResultFile, slab: u64, parts: &[Range<usize>]) -> Result<(), OutputError> {
    let write = |path: &Path| {
        together(path, parts.len(), |rank, file| {
            write_cells(slab, &parts[rank], |part| file.write_cells(parts[rank].start, part))
        })
    };
    result.append_in_parts(slab as f64)?.share(layout().grid.cells, write)?.finish()
}

/// Has each of so many ranks write to a file.
pub fn together(
    path: &Path,
    ranks: usize,
    write: impl Fn(usize, &SharedFile) -> Result<(), OutputError> + Sync,
) -> Result<(), OutputError> {
    let of_rank = |communicator: Arc<dyn Communicator>| {
        let file = SharedFile::open(path, layout(), FileSharing::Threads)?;
        // All have opened it.
        communicator.all_gather(&[]);
        write(communicator.rank(), &file).and(file.close())
    };
    Threads::run(ranks, of_rank).into_iter().collect()
}

/// Runs slabs `from`..`to` with a checkpoint after every `interval` slabs, resuming if `from` is not 0.
pub fn run(path: &Path, from: u64, to: u64, interval: u64) {
    let directory = RunDirectory::open(path).unwrap();
    let mut result = if from == 0 {
        ResultFile::create(&directory, layout(), &metadata()).unwrap()
    } else {
        let (result, found) = ResultFile::resume(&directory, &metadata(), &[], |_, _| Ok(())).unwrap();
        assert_eq!(found.state.integers["slab"], from as i64);
        result
    };
    for slab in from + 1..=to {
        append(&mut result, slab);
        if slab % interval == 0 {
            result.checkpoint(&state(slab)).unwrap();
        }
    }
}

/// Seals a file as FORMAT.md describes it: name, length, and FNV-1a over words of 8 bytes, lowest byte first.
pub fn seal(path: &Path) {
    let mut bytes = std::fs::read(path).unwrap();
    let length = bytes.len() as u64;
    bytes.resize(bytes.len().div_ceil(8) * 8, 0);
    let words = bytes.chunks_exact(8).map(|word| u64::from_le_bytes(word.try_into().unwrap()));
    let sum = words.fold(0xcbf2_9ce4_8422_2325, |sum: u64, word| (sum ^ word).wrapping_mul(0x0000_0100_0000_01b3));
    bytes.truncate(length as usize);
    bytes.extend(b"stsolve\n".iter().copied().chain(length.to_le_bytes()).chain(sum.to_le_bytes()));
    std::fs::write(path, bytes).unwrap();
}

/// Every array in a file, with its shape and bits, and every integer attribute.
pub fn contents(path: &Path) -> BTreeMap<String, (Vec<usize>, Vec<u64>)> {
    let file = hdf5::File::open(path).unwrap();
    let mut found = BTreeMap::new();
    collect(&file, &mut found);
    found
}

fn collect(group: &hdf5::Group, found: &mut BTreeMap<String, (Vec<usize>, Vec<u64>)>) {
    for name in group.attr_names().unwrap() {
        if let Ok(value) = group.attr(&name).unwrap().read_raw::<i64>() {
            let bits = value.into_iter().map(|value| value as u64).collect();
            found.insert(format!("{}@{name}", group.name()), (vec![], bits));
        }
    }
    for dataset in group.datasets().unwrap() {
        let values: Vec<f64> = dataset.read_raw().unwrap();
        found.insert(dataset.name(), (dataset.shape(), values.into_iter().map(f64::to_bits).collect()));
    }
    group.groups().unwrap().iter().for_each(|child| collect(child, found));
}

//! A run on several ranks has the bits of a run on one. Ranks are threads of one process here.

#![allow(clippy::unwrap_used)]

mod common;
mod several_ranks;

use case::AnyCase;
use common::{assert_same_bits, number, shipped, summary};
use ranks::{FileSharing, Threads};
use several_ranks::{assert_same_bits_on, attempt, attempt_each, attempt_with, changes, run};
use simulation::{Destination, Existing, Failure};
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

/// A run of a shipped case has the same bits on 1, 2, 3 and 4 ranks of one and two threads. Returns the runs: the directory `1` is that on
/// one rank.
fn assert_ranks_leave_no_trace(case: &str, set: &[&str]) -> TempDir {
    assert_same_bits_on(&[(1, 2), (2, 1), (3, 2), (4, 1)], case, set)
}

const VORTEX: [&str; 4] =
    ["mesh.generate.box.cells=[6,6]", "time.step=0.2", "time.end=1", "parallel={blocks=4,stages=1}"];

#[test]
fn a_moving_vortex_has_the_same_bits_on_any_number_of_ranks() {
    let runs = assert_ranks_leave_no_trace("vortex", &VORTEX);
    let blocks = summary(&runs.path().join("4_1"));
    let mass = number(&blocks, "conservation.mass_error");
    assert!(mass < 1e-13, "{mass:.1e}");
    // One block is another way to the same solution.
    let (one, directory) = (changes(&VORTEX[..3]), runs.path().join("one_block"));
    run(1, 1, "vortex", &one, &directory, Existing::Keep);
    let error = |summary: &serde_json::Value| number(summary, "error.density_l2");
    let (four, one) = (error(&blocks), error(&summary(&directory)));
    assert!((four / one - 1.0).abs() < 1e-3, "{four} {one}");
}

/// Two runs have left the same checkpoint, history and arrays of the result.
fn assert_same_result(one: &Path, other: &Path, what: &str) {
    assert_same_bits(one, other, what);
    let (one, other) = (arrays(one), arrays(other));
    assert!(one.len() > 20 && one.keys().eq(other.keys()), "{what}: {:?}, {:?}", one.keys(), other.keys());
    one.iter().for_each(|(name, values)| assert!(*values == other[name], "{what}: `{name}` differs"));
}

/// Every array of the result in a directory: its shape, and its bits as real numbers.
fn arrays(directory: &Path) -> BTreeMap<String, (Vec<usize>, Vec<u64>)> {
    fn collect(group: &hdf5::Group, found: &mut BTreeMap<String, (Vec<usize>, Vec<u64>)>) {
        for dataset in group.datasets().unwrap() {
            let values: Result<Vec<f64>, _> = dataset.read_raw();
            let bits = values.map_or_else(|_| Vec::new(), |values| values.into_iter().map(f64::to_bits).collect());
            found.insert(dataset.name(), (dataset.shape(), bits));
        }
        group.groups().unwrap().iter().for_each(|child| collect(child, found));
    }
    let mut found = BTreeMap::new();
    collect(&hdf5::File::open(directory.join(output::RESULT_FILE)).unwrap(), &mut found);
    found
}

/// A result that all ranks write together has the bits of that of one rank: fields, averages, a structure beside the flow, a steady start, states. So it
/// has after it was resumed on other ranks, with and without files of all ranks.
#[test]
fn ranks_that_write_together_leave_the_same_files() {
    let averages = ["output.averages.from=0.02", "output.checkpoint_every=1", "output.every=1"];
    let foil = [&["flow.order=3", "time.end=0.2", "parallel.blocks=5"], &averages[..]].concat();
    let flap = [&["mesh.order=3", "flow.order=3", "time.end=0.08", "parallel.blocks=5"], &averages[..]].concat();
    let wing = ["mesh.generate.ellipsoid.cells=[4,2,4,4]", "flow.order=2", "time.end=0.2", "parallel.blocks=5"];
    let cases = [
        ("naca0012_heave", &foil[..], "time.end=0.1"),
        ("perpendicular_flap", &flap, "time.end=0.04"),
        ("flapping_wing_3d", &wing, "time.end=0.1"),
    ];
    for (case, set, half) in cases {
        let (directory, set) = (TempDir::new().unwrap(), changes(set));
        let at = |name: &str| directory.path().join(name);
        run(1, 1, case, &set, &at("alone"), Existing::Keep);
        let together = |ranks, changes: &[String], existing| {
            attempt_with(Some(FileSharing::Threads), (ranks, 1), case, changes, (&at("together"), existing)).unwrap();
        };
        let half = [&set[..], &changes(&[half])].concat();
        together(3, &half, Existing::Keep);
        together(2, &set, Existing::Resume);
        assert_same_result(&at("alone"), &at("together"), &format!("{case}: written together"));
        run(2, 1, case, &half, &at("by_turns"), Existing::Keep);
        let by_turns = (at("by_turns"), Existing::Resume);
        attempt_with(Some(FileSharing::Threads), (5, 1), case, &set, (&by_turns.0, by_turns.1)).unwrap();
        assert_same_result(&at("alone"), &at("by_turns"), &format!("{case}: written by turns"));
    }
}

/// Eight ranks, each with a block of some cells, most of them at cuts; stages from the fewest to the exact order of elimination.
#[test]
fn any_number_of_stages_has_the_same_bits_on_up_to_eight_ranks() {
    let iterations = ["1", "3", "\"exact\""].map(|stages| {
        let stages = format!("parallel.stages={stages}");
        let set = [&VORTEX[..3], &["parallel.blocks=8", &stages]].concat();
        let runs = assert_same_bits_on(&[(3, 2), (8, 1)], "vortex", &set);
        number(&summary(&runs.path().join("8_1")), "krylov.total")
    });
    let directory = TempDir::new().unwrap();
    let one_block = directory.path().join("run");
    run(1, 1, "vortex", &changes(&VORTEX[..3]), &one_block, Existing::Keep);
    let one = number(&summary(&one_block), "krylov.total");
    // The exact order has the iterations of one block, up to round-off; the fewest stages need more.
    assert!(iterations[0] >= iterations[2] && (iterations[2] / one - 1.0).abs() < 0.02, "{iterations:?} {one}");
}

#[test]
fn a_wing_a_blade_and_a_flap_have_the_same_bits_on_any_number_of_ranks() {
    // BDDC solves the mesh of the wing.
    let bddc = "motion.elasticity.solver=bddc";
    let wing = ["mesh.generate.ellipsoid.cells=[4,2,4,4]", "flow.order=2", "time.end=0.1", "parallel.blocks=8", bddc];
    let blade = ["mesh.order=3", "flow.order=3", "time.end=0.1", "parallel.blocks=8"];
    let flap = ["mesh.order=3", "flow.order=3", "time.end=0.04", "parallel.blocks=8"];
    assert_same_bits_on(&[(3, 2), (8, 1)], "flapping_wing_3d", &wing);
    assert_same_bits_on(&[(3, 2), (8, 1)], "turbine_blade", &blade);
    assert_same_bits_on(&[(8, 1)], "perpendicular_flap", &flap);
}

#[test]
fn other_preconditioners_have_the_same_bits_on_any_number_of_ranks() {
    for preconditioner in ["lines", "low_order"] {
        let preconditioner = format!("solver.preconditioner={preconditioner}");
        assert_ranks_leave_no_trace("vortex", &[&VORTEX[..], &[&preconditioner]].concat());
    }
}

#[test]
fn collocated_rules_have_the_same_bits_on_any_number_of_ranks() {
    assert_ranks_leave_no_trace("vortex", &[&VORTEX[..], &["flow.quadrature=collocated"]].concat());
}

#[test]
fn a_flow_in_space_has_the_same_bits_on_any_number_of_ranks() {
    let runs = assert_ranks_leave_no_trace("free_stream_3d", &["parallel.blocks=5", "time.slabs=3"]);
    let error = number(&summary(&runs.path().join("3_2")), "conservation.free_stream_error");
    assert!(error < 1e-12, "{error:.1e}");
}

/// A steady start, walls with forces, and a mesh that elasticity moves.
#[test]
fn an_airfoil_has_the_same_bits_on_any_number_of_ranks() {
    assert_ranks_leave_no_trace("naca0012_heave", &["flow.order=3", "time.end=0.2", "parallel.blocks=4"]);
}

/// Ranks search a steady flow together: through lower orders, and with the march that tests it.
#[test]
fn a_steady_search_has_the_same_bits_on_any_number_of_ranks() {
    let cylinder = [
        "mesh.order=3",
        "flow.order=3",
        "mesh.generate.annulus.cells=[12,8]",
        "time={order=1,end=0,step=1}",
        "parallel.blocks=4",
    ];
    let steady = "solver.steady={first_step=1e4,stability_time=1}";
    let runs = assert_same_bits_on(&[(2, 1), (4, 1)], "cylinder_steady", &[&cylinder[..], &[steady]].concat());
    let steady = &summary(&runs.path().join("4_1"))["steady"];
    assert!(steady.get("stability").is_some(), "{steady}");
}

/// Ranks let a flag go from the steady flow together.
#[test]
fn an_equilibrium_has_the_same_bits_on_any_number_of_ranks() {
    let coarse =
        ["mesh.order=3", "flow.order=3", "mesh.generate.channel_flag.flag_cell=0.04", "solver.steady.tolerance=1e-5"];
    assert_same_bits_on(&[(2, 1), (3, 1)], "turek_hron_fsi1", &[&coarse[..], &["parallel.blocks=4"]].concat());
}

/// The mesh by BDDC in the plane, with a law that is factored anew in every slab.
#[test]
fn a_mesh_that_ranks_share_has_the_same_bits_on_any_number_of_them() {
    let bddc = "motion.elasticity.solver=bddc";
    let updated = "motion.elasticity.reference=updated";
    let plane = ["flow.order=3", "time.end=0.2", "parallel.blocks=4", bddc, updated];
    let runs = assert_same_bits_on(&[(3, 2), (4, 1)], "naca0012_heave", &plane);
    assert!(number(&summary(&runs.path().join("1")), "krylov.elasticity_total") > 0.0);
}

#[test]
fn bodies_and_structures_have_the_same_bits_on_any_number_of_ranks() {
    assert_ranks_leave_no_trace("piston_free", &["time.slabs=10", "flow.order=4", "parallel.blocks=4"]);
    let coarse = ["time.slabs=10", "flow.order=4", "mesh.order=4", "parallel.blocks=4"];
    let runs = assert_ranks_leave_no_trace("elastic_piston", &coarse);
    let energy = number(&summary(&runs.path().join("4_1")), "conservation.coupled_energy_error");
    assert!(energy < 1e-11, "{energy:.1e}");
}

#[test]
fn a_run_resumes_on_another_number_of_ranks_with_the_same_bits() {
    let directory = TempDir::new().unwrap();
    let at = |name: &str| directory.path().join(name);
    // So few iterations per linear solve that the preconditioner is rebuilt on the way.
    let until = |end: &str| changes(&[&VORTEX[..2], &["parallel.blocks=4", "constants.stretch=0.8", end]].concat());
    run(2, 1, "vortex", &until("time.end=2"), &at("through"), Existing::Keep);
    run(4, 1, "vortex", &until("time.end=1.2"), &at("interrupted"), Existing::Keep);
    for (ranks, end) in [(1, "time.end=1.6"), (3, "time.end=2")] {
        run(ranks, 1, "vortex", &until(end), &at("interrupted"), Existing::Resume);
    }
    assert_same_bits(&at("through"), &at("interrupted"), "resumed on 1 and on 3 ranks");
}

/// A state in the same orders goes from the file to the ranks in parts, with its averages; another one is made on rank 0.
#[test]
fn a_run_that_starts_from_another_one_has_the_same_bits_on_any_number_of_ranks() {
    let directory = TempDir::new().unwrap();
    let averages = ["parallel.blocks=4", "output.averages={from=0.2}"];
    let earlier = [&VORTEX[..2], &averages, &["time.end=0.6"]].concat();
    run(2, 1, "vortex", &changes(&earlier), &directory.path().join("earlier"), Existing::Keep);
    let from = format!("restart.from={:?}", directory.path().join("earlier"));
    // In other orders the averages begin anew.
    for (orders, averaged) in [("flow.order=4", 1.0), ("flow.order=3", 0.6)] {
        let later = [&VORTEX[..2], &averages, &["time.end=1.2", &from, orders]].concat();
        let runs = assert_ranks_leave_no_trace("vortex", &later);
        let (_, state) = output::read_checkpoint(&runs.path().join("4_1/result.vtkhdf")).unwrap();
        let duration = state.arrays["statistics.averages.durations"][0];
        assert!((duration - averaged).abs() < 1e-12, "{orders}: {duration}");
    }
}

/// All ranks give the initial state the same layer at the wall, see `starts.rs`.
#[test]
fn a_start_that_is_made_easier_has_the_same_bits_on_any_number_of_ranks() {
    let sudden = [
        "mesh.generate.annulus={ inner_radius = 0.5, outer_radius = 50, first_cell = 0.02, cells = [12, 8] }",
        "mesh.order=4",
        "flow.order=4",
        "flow.gas={ gamma = 1.4, prandtl = 0.72, mach = 0.4, viscosity = { constant = 1e-5 } }",
        "flow.reference={ density = 1, speed = 1, pressure = 4.464285714285714 }",
        "flow.initial={ uniform = { velocity = [1, 0], mach = 0.4 } }",
        "flow.boundary.far={ far_field = { velocity = [1, 0], mach = 0.4 } }",
        "time.step=0.05",
        "time.end=0.1",
        "parallel.blocks=4",
    ];
    let runs = assert_ranks_leave_no_trace("cylinder_street", &sudden);
    let summary = summary(&runs.path().join("4_1"));
    assert!(number(&summary, "start_layer") > 0.0 && number(&summary, "conservation.mass_error") < 1e-12, "{summary}");
}

/// A slab that cannot be solved ends the run on all ranks, with the message of a run on one rank.
#[test]
fn a_failure_ends_all_ranks_with_the_same_message() {
    let directory = TempDir::new().unwrap();
    let set = changes(&[&VORTEX[..], &["solver.newton_steps=1", "solver.slab_halvings=1"]].concat());
    let message = |ranks: usize| {
        let directory = directory.path().join(ranks.to_string());
        match attempt((ranks, 1), "vortex", &set, (&directory, Existing::Keep)) {
            Err(Failure::Solve(error)) => {
                format!("{:?}", error.chain().skip(1).map(ToString::to_string).collect::<Vec<_>>())
            }
            other => panic!("{other:?}"),
        }
    };
    let one = message(1);
    assert!(one.contains("Newton"), "{one}");
    assert_eq!(message(3), one);
    assert_same_bits(&directory.path().join("1"), &directory.path().join("3"), "the last good state");
}

/// The others do not wait for a rank whose case has an error.
#[test]
fn a_case_that_one_rank_cannot_read_is_an_error_of_all() {
    for bad in 0..3 {
        let messages = Threads::run(3, |communicator| {
            let set = changes(if communicator.rank() == bad { &["flow.order=none"] } else { &[] });
            let read = AnyCase::read(Path::new(&shipped("vortex.toml")), &set).map_err(Failure::from);
            match simulation::agree(&*communicator, read) {
                Err(Failure::BadInput(error)) => error.chain().map(ToString::to_string).collect::<Vec<_>>().join(": "),
                _ => panic!("rank {} has a case", communicator.rank()),
            }
        });
        assert!(messages.iter().all(|message| *message == messages[0]), "{messages:?}");
        assert!(messages[0].contains("flow.order"), "{messages:?}");
        assert_eq!(messages[0].contains(&format!("process {bad}")), bad > 0, "{messages:?}");
    }
}

#[test]
fn more_ranks_than_blocks_are_refused() {
    let directory = TempDir::new().unwrap();
    let (set, run) = (changes(&["parallel.blocks=2"]), directory.path().join("run"));
    let error = match attempt((3, 1), "vortex", &set, (&run, Existing::Keep)) {
        Err(Failure::BadInput(error)) => error.to_string(),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        error,
        "3 processes for 2 blocks: each process needs a block; `parallel.blocks` = 3 or more, or fewer processes"
    );
}

/// The result file is copied to a device that is always full. All ranks end with one message, and the file before is whole.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_all_ranks_with_the_same_message_and_the_last_good_state() {
    let (directory, half) = (TempDir::new().unwrap(), [&VORTEX[..], &["time.end=0.4"]].concat());
    let message = |sharing: Option<FileSharing>, ranks: usize| {
        let run_directory = directory.path().join(ranks.to_string());
        run(ranks, 1, "vortex", &changes(&half), &run_directory, Existing::Keep);
        let (result, working) = (run_directory.join("result.vtkhdf"), run_directory.join("result.vtkhdf.partial"));
        let before = std::fs::read(&result).unwrap();
        std::os::unix::fs::symlink("/dev/full", &working).unwrap();
        let resumed = (&*run_directory, Existing::Resume);
        let failed = attempt_with(sharing, (ranks, 1), "vortex", &changes(&VORTEX), resumed);
        let Err(Failure::BadInput(error) | Failure::Solve(error)) = failed else { panic!("{failed:?}") };
        assert_eq!(std::fs::read(&result).unwrap(), before, "{ranks} ranks");
        let words: Vec<String> = error.chain().map(ToString::to_string).collect();
        words.join(": ").replace(&*run_directory.to_string_lossy(), "RUN")
    };
    let one = message(None, 1);
    assert!(one.contains("No space left on device") && one.contains("--resume"), "{one}");
    assert_eq!([message(None, 3), message(Some(FileSharing::Threads), 2)], [&*one, &*one]);
    run(2, 1, "vortex", &changes(&VORTEX), &directory.path().join("3"), Existing::Resume);
    run(1, 1, "vortex", &changes(&VORTEX), &directory.path().join("whole"), Existing::Keep);
    assert_same_bits(&directory.path().join("whole"), &directory.path().join("3"), "resumed after a full disk");
}

/// All ranks receive the number of a control before each slab.
#[test]
fn a_control_has_the_same_bits_on_any_number_of_ranks() {
    let controlled = [
        "flow.source={acceleration=[\"force\",0]}",
        "controls.force={measure=\"momentum_x\",rate=\"1e-4*measured\"}",
        "output.integrals=[\"momentum_x\"]",
    ];
    assert_ranks_leave_no_trace("vortex", &[&VORTEX[..], &controlled].concat());
}

/// Thin viscous cells, periodic along their short axis, need blocks in two terms. All ranks decide alike, and all see that of the worst cell.
#[test]
fn thin_cells_have_the_same_bits_on_any_number_of_ranks() {
    let thin = [
        "mesh.generate.box={lower=[0,0],upper=[0.01,1],cells=[1,6],periodic=[\"x\"]}",
        "motion.displacement=[\"0\",\"0.02*sin(pi*y)*sin(2*pi*t)\"]",
        "flow.gas.viscosity={constant=0.05}",
        "time={order=2,end=0.1,slabs=2}",
        "parallel.blocks=4",
    ];
    let runs = assert_same_bits_on(&[(2, 1), (3, 2)], "couette", &thin);
    let iterations = number(&summary(&runs.path().join("1")), "krylov.total");
    assert!(iterations < 200.0, "{iterations} iterations: one term would take thousands");
}

/// Ranks whose files or arguments differ solved different equations, and the run ended as if nothing were wrong.
#[test]
fn ranks_with_different_cases_are_refused() {
    let directory = TempDir::new().unwrap();
    for other in ["flow.gas.gamma=1.3", "output.every=7", "time.step=0.1", "mesh.generate.box.cells=[4,9]"] {
        let of_rank = |rank: usize| {
            let set: Vec<&str> = VORTEX.into_iter().chain((rank == 2).then_some(other)).collect();
            changes(&set)
        };
        let run = directory.path().join("run");
        let failure = attempt_each(None, (3, 1), "vortex", &of_rank, (&run, Existing::Keep)).unwrap_err();
        let Failure::BadInput(error) = failure else { panic!("{other}: {failure:?}") };
        assert!(format!("{error:#}").contains("process 2 has another case than process 0"), "{error:#}");
    }
}

/// A rank whose case has no flow waited for ever for what the others did.
#[test]
fn a_rank_without_a_flow_is_refused() {
    let directory = TempDir::new().unwrap();
    let results = Threads::run_with(None, 2, |communicator| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        pool.install(|| {
            let file = if communicator.rank() == 0 { "vortex.toml" } else { "cantilever.toml" };
            let set = if communicator.rank() == 0 { changes(&VORTEX) } else { Vec::new() };
            let case = AnyCase::read(Path::new(&shipped(file)), &set).unwrap();
            if communicator.rank() > 0 {
                simulation::serve(&case, &communicator);
                return Ok(());
            }
            let destination = Destination { directory: directory.path().join("run"), existing: Existing::Keep };
            simulation::run_on(communicator, &case, &destination, &()).map(drop)
        })
    });
    let failure = results.into_iter().next().unwrap().unwrap_err();
    let Failure::BadInput(error) = failure else { panic!("{failure:?}") };
    assert!(format!("{error:#}").contains("process 1 has another case than process 0"), "{error:#}");
}

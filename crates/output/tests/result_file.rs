//! Files return their contents bit by bit; a resumed run writes the same file; damaged files are refused.

#![allow(clippy::unwrap_used)]

mod common;

use std::fs;
use std::path::Path;

use common::{
    CASE, append, append_in_parts, append_together, contents, layout, metadata, noise, run, seal, state, together,
};
use output::{
    ArrayInParts, ArraySpec, EarlierRun, FieldSpec, FileLayout, Kept, Metadata, OutputError, Parts, RESULT_FILE,
    ResultFile, ResultReader, RunDirectory, SolverState, Step, inspect, read_checkpoint,
};

/// NaN is not equal to itself: compare the bits.
fn bits(state: &SolverState) -> Vec<Vec<u64>> {
    state.arrays.values().map(|values| values.iter().map(|value| value.to_bits()).collect()).collect()
}

#[test]
fn the_state_and_the_metadata_come_back_bit_by_bit() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 3, 3);
    let (found_metadata, found) = read_checkpoint(&directory.path().join(RESULT_FILE)).unwrap();
    let expected = state(3);
    assert_eq!(found_metadata, metadata());
    assert_eq!(bits(&found), bits(&expected));
    assert_eq!((found.integers, found.texts), (expected.integers, expected.texts));
}

#[test]
fn coefficients_points_and_fields_come_back_bit_by_bit() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 3, 3);
    let found = contents(&directory.path().join(RESULT_FILE));
    let as_bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    let expected: Vec<f64> = (1..=3).flat_map(|slab| noise(slab + 300, 40 * 2 * 4 * 9)).collect();
    assert_eq!(found["/stsolve/exact/flow"], (vec![3, 40, 2, 4, 9], as_bits(expected)));

    // VTK's order of the nine nodes: corners, edges, centre.
    let lexicographic = [0, 2, 8, 6, 1, 5, 7, 3, 4];
    let density = noise(2 + 100, 360);
    let second: Vec<f64> = (0..360).map(|i| density[i / 9 * 9 + lexicographic[i % 9]]).collect();
    assert_eq!(found["/VTKHDF/PointData/density"].1[360..720], as_bits(second));
}

#[test]
fn a_reader_finds_each_step_while_the_run_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 3, 3);
    assert!(!RunDirectory::is_held(directory.path()));
    let held = RunDirectory::open(directory.path()).unwrap();
    assert!(RunDirectory::is_held(directory.path()));
    let (mut result, _) = ResultFile::resume(&held, &metadata(), &[], |_, _| Ok(())).unwrap();
    let reader = ResultReader::open(&directory.path().join(RESULT_FILE)).unwrap();
    append(&mut result, 4);
    result.checkpoint(&state(4)).unwrap();
    assert_eq!((reader.times.as_slice(), &reader.layout.grid), (&[1.0, 2.0, 3.0][..], &layout().grid));
    let as_bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    for step in 0..3 {
        let expected = noise(step + 301, 40 * 2 * 4 * 9);
        assert_eq!(as_bits(reader.exact("flow", step as usize).unwrap().unwrap()), as_bits(expected));
    }
    assert!(reader.exact("position", 0).unwrap().is_none());
    assert!(matches!(reader.exact("flow", 3), Err(OutputError::Damaged { .. })));
    drop((result, held));
    assert!(!RunDirectory::is_held(directory.path()));
}

/// A run that went on after its end kept what it had written there.
#[test]
fn a_former_end_leaves_no_trace() {
    let at = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let array = ArraySpec::new("surface", &[("facet", 3)]);
    let write = |path: &Path, slabs: &[u64], former_end: bool| {
        let directory = RunDirectory::open(path).unwrap();
        let mut result = match former_end {
            true => ResultFile::resume(&directory, &metadata(), &[], |_, _| Ok(())).unwrap().0,
            false => ResultFile::create(&directory, layout(), &metadata()).unwrap(),
        };
        if former_end {
            result.drop_former_end(2.0, Kept { step: true, series: true }).unwrap();
            result.drop_former_end(7.0, Kept { step: false, series: false }).unwrap();
            result.drop_former_end(2.0, Kept { step: false, series: false }).unwrap();
            // The only step that is left is the start.
            assert_eq!(result.step_times().unwrap(), [1.0]);
            result.drop_former_end(1.0, Kept { step: false, series: true }).unwrap();
        }
        for slab in slabs {
            append(&mut result, *slab);
            result.append_to_series(&array, *slab as f64, &[*slab as f64; 3]).unwrap();
        }
        result.checkpoint(&state(9)).unwrap();
    };
    write(at[0].path(), &[1, 3, 4], false);
    write(at[1].path(), &[1, 2], false);
    write(at[1].path(), &[3, 4], true);
    let [one, other] = at.each_ref().map(|directory| contents(&directory.path().join(RESULT_FILE)));
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
    one.iter().for_each(|(name, values)| assert!(values == &other[name], "{name}"));
}

#[test]
fn resuming_writes_the_same_file_as_running_through() {
    let (through, resumed) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run(through.path(), 0, 6, 6);
    run(resumed.path(), 0, 2, 1);
    // Slab 3 is computed but not published: it must leave no trace.
    run(resumed.path(), 2, 3, 2);
    run(resumed.path(), 2, 4, 2);
    run(resumed.path(), 4, 6, 2);
    let (through, resumed) = (contents(&through.path().join(RESULT_FILE)), contents(&resumed.path().join(RESULT_FILE)));
    assert!(through.len() > 20, "the comparison must see the whole file: {:?}", through.keys());
    assert_eq!(through, resumed);
}

/// A step and a state in parts, as a run on several ranks writes them, make the file that whole ones make.
#[test]
fn parts_make_the_same_file() {
    let (whole, in_parts) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run(whole.path(), 0, 3, 1);
    let directory = RunDirectory::open(in_parts.path()).unwrap();
    let mut result = ResultFile::create(&directory, layout(), &metadata()).unwrap();
    for slab in 1..=3 {
        append_in_parts(&mut result, slab, &[0..1, 1..17, 17..40]).unwrap();
        let mut state = state(slab);
        let flow = state.arrays.remove("flow").unwrap();
        let parts = flow.chunks(99).map(<[f64]>::to_vec);
        let long = ArrayInParts { name: "flow".to_owned(), len: flow.len(), parts: Parts::InOrder(Box::new(parts)) };
        result.checkpoint_with(&state, vec![long]).unwrap();
    }
    assert_eq!(contents(&whole.path().join(RESULT_FILE)), contents(&in_parts.path().join(RESULT_FILE)));
}

/// A step and a state that several ranks write together make the file that one writes, also after a resume.
#[test]
fn ranks_that_write_together_make_the_same_file() {
    let (whole, shared) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run(whole.path(), 0, 3, 1);
    let directory = RunDirectory::open(shared.path()).unwrap();
    let mut result = ResultFile::create(&directory, layout(), &metadata()).unwrap();
    for slab in 1..=3 {
        if slab == 3 {
            drop(result);
            result = ResultFile::resume(&directory, &metadata(), &[], |_, _| Ok(())).unwrap().0;
        }
        assert!(result.can_be_shared().unwrap());
        append_together(&mut result, slab, &[17..40, 0..1, 1..17]).unwrap();
        let mut state = state(slab);
        let flow = state.arrays.remove("flow").unwrap();
        let long = ArrayInParts { name: "flow".to_owned(), len: flow.len(), parts: Parts::OfAllRanks };
        let write = |path: &Path| {
            together(path, 2, |rank, file| {
                let (before, after) = flow.split_at(99);
                file.write_state("flow", 99 * rank, [before, after][rank])
            })
        };
        result.checkpoint_together(&state, vec![long], write).unwrap();
    }
    assert_eq!(contents(&whole.path().join(RESULT_FILE)), contents(&shared.path().join(RESULT_FILE)));
}

/// Nothing is published after a rank could not write.
#[test]
fn a_step_that_a_rank_could_not_write_is_no_step() {
    let directory = tempfile::tempdir().unwrap();
    let locked = RunDirectory::open(directory.path()).unwrap();
    let mut result = ResultFile::create(&locked, layout(), &metadata()).unwrap();
    let refuse = |path: &Path| {
        together(path, 2, |rank, file| if rank == 0 { Ok(()) } else { file.write_state("no such array", 0, &[1.0]) })
    };
    let step = result.append_in_parts(1.0).unwrap();
    assert!(matches!(step.share(40, refuse), Err(OutputError::Hdf5 { .. })));
    assert!(result.checkpoint(&state(1)).is_err());
    assert!(!directory.path().join(RESULT_FILE).exists());
}

/// Nothing is published after a step that lacks a part.
#[test]
fn a_step_without_its_last_part_is_no_step() {
    let directory = tempfile::tempdir().unwrap();
    let locked = RunDirectory::open(directory.path()).unwrap();
    let mut result = ResultFile::create(&locked, layout(), &metadata()).unwrap();
    let error = append_in_parts(&mut result, 1, &[0..1, 1..17]).unwrap_err();
    assert!(matches!(error, OutputError::Length { found: 459, expected: 1080, .. }), "{error}");
    assert!(result.checkpoint(&state(1)).is_err());
    assert!(!directory.path().join(RESULT_FILE).exists());
}

#[test]
fn checkpoints_use_the_space_of_the_old_state_again() {
    let directory = tempfile::tempdir().unwrap();
    let locked = RunDirectory::open(directory.path()).unwrap();
    let mut result = ResultFile::create(&locked, layout(), &metadata()).unwrap();
    let mut large = state(1);
    large.arrays.insert("large".to_owned(), noise(7, 1 << 16).into());
    let mut size_after = |count| {
        (0..count).for_each(|_| result.checkpoint(&large).unwrap());
        fs::metadata(directory.path().join(RESULT_FILE)).unwrap().len()
    };
    let first = size_after(1);
    let twentieth = size_after(19);
    assert!(twentieth < first + first / 4, "{first} bytes grew to {twentieth}");
}

/// A history of 4,000 slabs made a file of 109 MB: every checkpoint wrote it behind the old one.
#[test]
fn a_history_that_grows_uses_the_space_of_the_old_one_again() {
    let directory = tempfile::tempdir().unwrap();
    let locked = RunDirectory::open(directory.path()).unwrap();
    let mut result = ResultFile::create(&locked, layout(), &metadata()).unwrap();
    let mut growing = state(1);
    let mut size_after = |rows: usize| {
        growing.arrays.insert("history".to_owned(), noise(9, 20 * rows).into());
        growing.integers.insert("slab".to_owned(), rows as i64);
        result.checkpoint(&growing).unwrap();
        assert_eq!(bits(&output::read_checkpoint(result.path()).unwrap().1), bits(&growing));
        fs::metadata(result.path()).unwrap().len()
    };
    let first = size_after(1);
    let last = (1..=300).map(|checkpoint| size_after(10 * checkpoint)).last().unwrap();
    let history = 8 * 20 * 3000;
    assert!(last < first + history + history / 4, "{history} bytes of history make {first} bytes to {last}");
}

#[test]
fn a_step_that_does_not_fit_is_refused_before_anything_is_written() {
    let directory = tempfile::tempdir().unwrap();
    let locked = RunDirectory::open(directory.path()).unwrap();
    let mut result = ResultFile::create(&locked, layout(), &metadata()).unwrap();
    let points = vec![0.0; 3 * 360];
    let short = Step { time: 0.0, points: &points[1..], fields: &[], exact: &[] };
    assert!(matches!(result.append(&short), Err(OutputError::Length { expected: 1080, found: 1079, .. })));
    let without_fields = Step { time: 0.0, points: &points, fields: &[], exact: &[] };
    assert!(matches!(result.append(&without_fields), Err(OutputError::Absent { name }) if name == "velocity"));
    append(&mut result, 1);
    result.checkpoint(&state(1)).unwrap();
    assert_eq!(inspect(result.path()).unwrap().times, [1.0]);
}

#[test]
fn after_a_failed_write_nothing_more_is_published() {
    let directory = tempfile::tempdir().unwrap();
    let locked = RunDirectory::open(directory.path()).unwrap();
    let mut result = ResultFile::create(&locked, layout(), &metadata()).unwrap();
    result.checkpoint(&state(0)).unwrap();
    let hidden = directory.path().join("hidden");
    fs::rename(result.path(), &hidden).unwrap();
    assert!(matches!(result.checkpoint(&state(1)), Err(OutputError::File { .. })));
    fs::rename(&hidden, result.path()).unwrap();
    assert!(matches!(result.checkpoint(&state(1)), Err(OutputError::Hdf5 { .. })));
    assert_eq!(read_checkpoint(result.path()).unwrap().1.integers["slab"], 0);
}

#[test]
fn inspect_tells_what_the_file_holds() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 4, 2);
    let info = inspect(&directory.path().join(RESULT_FILE)).unwrap();
    assert_eq!(info.times, [1.0, 2.0, 3.0, 4.0]);
    assert_eq!((info.layout.grid, &info.layout.exact), (layout().grid, &layout().exact));
    assert_eq!((info.space_nodes, info.time_nodes, info.case_name.as_str()), (3, 2, "box"));
    assert!(info.checkpoint.arrays.contains(&("flow".to_owned(), 700)));
    assert!(info.checkpoint.integers.contains(&("slab".to_owned(), 4)));
}

#[test]
fn nothing_to_resume_from_another_case_and_another_format_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    let resume = |case: &str| {
        let accept = |found: &Metadata, _: &SolverState| match found.case_fingerprint == case {
            true => Ok(()),
            false => Err(format!("{} is not {case}", found.case_fingerprint)),
        };
        ResultFile::resume(&RunDirectory::open(directory.path()).unwrap(), &metadata(), &[], accept).map(drop)
    };
    assert!(matches!(resume(CASE), Err(OutputError::NoCheckpoint { .. })));
    run(directory.path(), 0, 1, 1);
    assert!(resume(CASE).is_ok());
    let error = resume("another").unwrap_err();
    assert!(
        matches!(&error, OutputError::OtherCase { difference, .. } if *difference == format!("{CASE} is not another"))
    );

    let file = hdf5::File::open_rw(directory.path().join(RESULT_FILE)).unwrap();
    file.group("stsolve").unwrap().attr("format_version").unwrap().write_scalar(&99_i64).unwrap();
    file.close().unwrap();
    assert!(matches!(resume(CASE), Err(OutputError::NotSealed { .. })), "a changed file has lost its seal");
    seal(&directory.path().join(RESULT_FILE));
    assert!(matches!(resume(CASE), Err(OutputError::Version { found: 99, .. })));
}

#[test]
fn a_resumed_run_leaves_its_own_case() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 1, 1);
    let held = RunDirectory::open(directory.path()).unwrap();
    let now = Metadata { case_text: "end = 2".into(), case_fingerprint: "1".into(), ..metadata() };
    let (mut result, _) = ResultFile::resume(&held, &now, &[], |_, _| Ok(())).unwrap();
    append(&mut result, 2);
    result.checkpoint(&state(2)).unwrap();
    assert_eq!(read_checkpoint(result.path()).unwrap().0, now);
}

/// A reader does not speak of resuming.
#[test]
fn a_missing_result_is_no_missing_checkpoint() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(RESULT_FILE);
    for error in [ResultReader::open(&path).unwrap_err(), read_checkpoint(&path).unwrap_err()] {
        assert!(matches!(error, OutputError::NoResult { .. }), "{error:?}");
        let message = error.to_string();
        assert!(message.contains(RESULT_FILE) && !message.contains("resum"), "{message}");
    }
}

/// A run that was killed has no summary; its result tells what it was.
#[test]
fn a_killed_run_of_the_mesh_alone_is_recognised() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 1, 1);
    assert!(!EarlierRun::find(directory.path()).unwrap().is_mesh_alone);
    for (field, is_mesh_alone) in [("jacobian", true), ("von_mises", false)] {
        let held = RunDirectory::open(directory.path()).unwrap();
        let layout = FileLayout { fields: vec![FieldSpec::scalar(field)], exact: Vec::new(), ..layout() };
        ResultFile::create(&held, layout, &metadata()).unwrap().checkpoint(&state(0)).unwrap();
        assert_eq!(EarlierRun::find(directory.path()).unwrap().is_mesh_alone, is_mesh_alone, "{field}");
    }
}

#[test]
fn a_truncated_file_is_reported_as_damaged() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 2, 2);
    let path = directory.path().join(RESULT_FILE);
    let whole = fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(whole.len() / 60).chain([whole.len() - 1]) {
        fs::write(&path, &whole[..length]).unwrap();
        let error = read_checkpoint(&path).unwrap_err();
        assert!(matches!(error, OutputError::Damaged { .. }), "{length} bytes: {error:?}");
        assert!(error.to_string().contains(RESULT_FILE) && !error.to_string().contains("resum"), "{error}");
    }
}

#[test]
fn every_damaged_byte_is_reported() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 0, 2, 2);
    let path = directory.path().join(RESULT_FILE);
    let whole = fs::read(&path).unwrap();
    for position in (0..whole.len()).step_by(whole.len() / 200) {
        let mut damaged = whole.clone();
        damaged[position] ^= 0x5a;
        fs::write(&path, &damaged).unwrap();
        let error = read_checkpoint(&path).unwrap_err();
        assert!(matches!(error, OutputError::Damaged { .. }), "byte {position}: {error:?}");
    }
}

#[test]
fn a_file_of_another_kind_is_reported_even_with_a_seal() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(RESULT_FILE);
    fs::write(&path, "# a text, long enough to hold a seal at its end\n").unwrap();
    assert!(matches!(read_checkpoint(&path), Err(OutputError::NotHdf5 { .. })));
    seal(&path);
    assert!(matches!(read_checkpoint(&path), Err(OutputError::Damaged { .. })));
    hdf5::File::create(&path).unwrap().close().unwrap();
    seal(&path);
    assert!(matches!(read_checkpoint(&path), Err(OutputError::Damaged { .. })));
}

/// A resumed run had all arrays in memory at once.
#[test]
fn long_arrays_stay_in_the_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    common::run(path, 0, 1, 1);
    let (_, whole) = read_checkpoint(&path.join(RESULT_FILE)).unwrap();
    let held = RunDirectory::open(path).unwrap();
    let (_, mut found) = ResultFile::resume(&held, &metadata(), &["flow", "absent"], |_, _| Ok(())).unwrap();
    let flow = &whole.arrays["flow"];
    assert!(flow.len() > 2 && !found.state.arrays.contains_key("flow"));
    assert_eq!([found.len_of("flow"), found.len_of("absent")], [Some(flow.len()), None]);
    // NaN is not equal to itself.
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&found.part("flow", 1..flow.len()).unwrap()), bits(&flow[1..]));
    assert!(found.part("flow", 1..1).unwrap().is_empty());
    let again = found.whole().unwrap();
    assert_eq!((bits(&again.arrays["flow"]), again.arrays.len()), (bits(flow), whole.arrays.len()));
    found.retain_arrays(|name| name != "flow");
    assert_eq!(found.len_of("flow"), None);
}

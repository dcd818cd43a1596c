//! The deformation cases of the paper: the largest motion of a mesh, and the quality of its cells.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{column, number, on_case, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// The summary of `stsolve motion` on a shipped case, and its output; it must end with `code`.
fn motion(directory: &Path, name: &str, set: &[&str], code: i32) -> (serde_json::Value, String) {
    let outcome = on_case(directory, "motion", name, set, name, &["--force"]);
    outcome.expect(code, &[]);
    (summary(&directory.join(name)), outcome.stderr)
}

/// N, and the angle up to which the mesh is valid at 2N Gauss points and at 4N Gauss-Lobatto points, by equation (5) and
/// with constant stiffness. From Diosady & Murman, AIAA 2018-0919, section III.C, and an independent program.
const ANGLES: [(usize, [[f64; 2]; 2]); 3] =
    [(2, [[62.9, 60.7], [34.6, 32.7]]), (4, [[48.7, 44.4], [25.0, 21.7]]), (8, [[40.3, 35.3], [19.9, 16.4]])];

#[test]
fn the_box_turns_as_far_as_in_the_paper() {
    let directory = TempDir::new().unwrap();
    println!(
        "rotating box, valid up to (degrees)\n  N  stiffness   2N Gauss points    expected      proved    4N Gauss-Lobatto"
    );
    for (order, expected) in ANGLES {
        for (name, [at_gauss, at_lobatto]) in ["equation 5", "constant"].into_iter().zip(expected) {
            // Slabs of 5 degrees, up to the one in which the limit lies.
            let slabs = (at_gauss / 5.0_f64).ceil();
            let mut set = vec![
                format!("mesh.order={order}"),
                format!("mesh.generate.rotating_box.cells_per_side={}", 80 / order),
                format!("time.end={}", 5.0 * slabs),
                format!("time.slabs={slabs}"),
                "time.order=2".into(),
            ];
            if name == "constant" {
                set.push("motion.elasticity.stiffness=constant".into());
            }
            let set: Vec<&str> = set.iter().map(String::as_str).collect();
            let (summary, report) = motion(directory.path(), "rotating_box", &set, 1);
            let sampled = number(&summary, "mesh_quality.first_invalid_time_sampled");
            let proved = number(&summary, "mesh_quality.first_invalid_time");
            println!("  {order}  {name}  {sampled:15.2}  {at_gauss:10.1}  {proved:10.2}  {at_lobatto:18.1}");
            assert!((sampled - at_gauss).abs() < 0.3, "N = {order}, {name}: {sampled} against {at_gauss}");
            // The proof must not exceed any sampling.
            assert!(proved < at_lobatto + 0.05 && proved > at_lobatto - 0.5, "N = {order}, {name}: {proved}");
            assert!(report.contains("by proof, at 2N Gauss points per direction from t = "), "{report}");
        }
    }
}

#[test]
fn rough_channels_keep_good_cells_at_a_third_of_the_nyquist_frequency() {
    let directory = TempDir::new().unwrap();
    let (plane, _) = motion(directory.path(), "channel_roughness", &[], 0);
    let shape = [
        "mesh.generate.channel.extent=[3, 2, 0.5]",
        "mesh.generate.channel.cells=[6, 2, 1]",
        "constants.width=0.5",
        "constants.waves_across=1",
        "time.slabs=1",
    ];
    let (space, _) = motion(directory.path(), "channel_roughness_3d", &shape, 0);
    for (name, summary) in [("plane", plane), ("in space", space)] {
        let scaled = number(&summary, "mesh_quality.scaled_jacobian_min");
        let bound = number(&summary, "mesh_quality.det_j_lower_bound");
        println!("rough channel, {name}: scaled Jacobian {scaled:.3}, det J / det J_0 >= {bound:.3}");
        assert!(scaled > 0.6 && bound > 0.4, "{name}: {scaled} {bound}");
    }
    // Larger depth gives lower quality, step by step.
    let depths = column(&directory.path().join("channel_roughness"), "scaled_jacobian");
    assert!(depths.len() == 4 && depths.windows(2).all(|pair| pair[1] < pair[0]), "{depths:?}");
}

#[test]
fn a_rough_blade_has_a_valid_mesh() {
    let directory = TempDir::new().unwrap();
    let coarse = [
        "mesh.order=6",
        "mesh.generate.turbine_blade.cells={side=14,end=4,normal=2,gap=2,before=4,after=6}",
        "constants.waves=20",
        "time.slabs=1",
    ];
    let (plane, _) = motion(directory.path(), "turbine_blade_roughness", &coarse, 0);
    let thin = [
        "mesh.order=3",
        "mesh.generate.turbine_blade.cells={side=14,end=4,normal=2,gap=2,before=4,after=6}",
        "time.slabs=1",
    ];
    let (space, _) = motion(directory.path(), "turbine_blade_roughness_3d", &thin, 0);
    for (name, summary) in [("plane", plane), ("in space", space)] {
        let bound = number(&summary, "mesh_quality.det_j_lower_bound");
        let sampled = number(&summary, "mesh_quality.det_j_sampled_min");
        println!("rough blade, {name}: det J / det J_0 >= {bound:.3} proved, {sampled:.3} sampled");
        assert!(bound > 0.3 && sampled < 0.98, "{name}: {bound} {sampled}");
    }
}

#[test]
fn an_airfoil_moves_far_if_small_cells_are_stiff_and_not_if_all_are_alike() {
    let directory = TempDir::new().unwrap();
    // The mesh is symmetric in time about t = 0.5, where pitch is largest.
    let half = ["time.end=0.5", "time.slabs=5"];
    let (valid, _) = motion(directory.path(), "airfoil_motion", &half, 0);
    let bound = number(&valid, "mesh_quality.det_j_lower_bound");
    assert!(bound > 0.7, "{bound}");
    let constant = ["time.end=0.2", "time.slabs=2", "motion.elasticity.stiffness=constant"];
    let (invalid, report) = motion(directory.path(), "airfoil_motion", &constant, 1);
    let [proved, sampled] = ["first_invalid_time", "first_invalid_time_sampled"]
        .map(|key| number(&invalid, &format!("mesh_quality.{key}")));
    println!(
        "airfoil: det J / det J_0 >= {bound:.3}; constant stiffness invalid from t = {proved:.3}, sampled {sampled:.3}"
    );
    assert!(proved > 0.1 && proved <= sampled && sampled < 0.15, "{proved} {sampled}");
    let named = report.split("cell ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!(named.parse::<usize>().is_ok_and(|cell| cell < 880), "{report}");
    assert!(report.contains(" is inverted or nearly so from t = 0.12"), "{report}");
}

/// A mesh file in the directory of its case: 3 x 2 cells on [0, 3] x [0, 2], in the format of Gmsh.
fn write_mesh_file(directory: &Path) {
    let node = |k: usize| format!("{} {} {} 0\n", k + 1, k % 4, k / 4);
    let line = |(number, (group, from, to)): (usize, (usize, usize, usize))| {
        format!("{} 1 2 {group} {group} {} {}\n", number + 1, from + 1, to + 1)
    };
    let sides = (0..3).flat_map(|i| [(3, i, i + 1), (4, 8 + i, 9 + i)]);
    let ends = (0..2).flat_map(|j| [(1, 4 * j, 4 * j + 4), (2, 4 * j + 3, 4 * j + 7)]);
    let corner = |k: usize| 4 * (k / 3) + k % 3 + 1;
    let cell = |k: usize| {
        let c = corner(k);
        format!("{} 3 2 9 1 {c} {} {} {}\n", 11 + k, c + 1, c + 5, c + 4)
    };
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n1 1 \"left\"\n1 2 \"right\"\n1 3 \"bottom\"\n1 4 \"top\"\n\
         $EndPhysicalNames\n$Nodes\n12\n{}$EndNodes\n$Elements\n16\n{}{}$EndElements\n",
        (0..12).map(node).collect::<String>(),
        sides.chain(ends).enumerate().map(line).collect::<String>(),
        (0..6).map(cell).collect::<String>(),
    );
    std::fs::write(directory.join("plate.msh"), text).unwrap();
}

const PLATE: &str = "title = \"A plate from a file\"\n[mesh]\nfile = \"plate.msh\"\norder = 4\nperiodic = [[\"left\", \"right\"]]\n\
                     [motion.boundary]\nbottom = \"fixed\"\ntop = { normal = \"0.1*t*sin(2*pi*x/3)\" }\n\
                     [time]\norder = 2\nend = 1\nslabs = 2\n";

#[test]
fn a_mesh_file_is_told_about_and_moved() {
    let directory = TempDir::new().unwrap();
    write_mesh_file(directory.path());
    let info = stsolve(directory.path(), &["info", "--json", "plate.msh"]);
    info.expect(0, &[]);
    let info: serde_json::Value = serde_json::from_str(&info.stdout).unwrap();
    let shape = &info["mesh"];
    assert_eq!((&shape["cells"], &shape["order"], &shape["volume"]), (&6.into(), &2.into(), &6.0.into()));
    assert_eq!((&shape["largest aspect ratio"], &shape["valid"]), (&1.0.into(), &true.into()));
    assert_eq!((&info["boundaries"]["left"], &info["boundaries"]["top"]), (&2.into(), &3.into()));
    let joined = serde_json::json!({ "boundaries": ["left", "right"], "translation": [3.0, 0.0] });
    assert_eq!((&info["file"], &info["translated boundaries"][0]), (&"plate.msh".into(), &joined));

    std::fs::write(directory.path().join("plate.toml"), PLATE).unwrap();
    for command in ["motion", "run"] {
        let outcome = stsolve(directory.path(), &[command, "plate.toml", "--output", command]);
        outcome.expect(0, &["valid until t = 1"]);
        let summary = summary(&directory.path().join(command));
        assert_eq!((&summary["mesh"]["cells"], &summary["mesh"]["order"]), (&6.into(), &4.into()));
        // 13 x 6 interior nodes but for the joined ones: (3 * 3) x (2 * 3 - 1).
        assert_eq!(summary["unknowns"]["mesh"], 2 * 2 * 9 * 5);
    }
    // Another mesh in the same file is another case.
    let text = std::fs::read_to_string(directory.path().join("plate.msh")).unwrap();
    std::fs::write(directory.path().join("plate.msh"), text.replace("6 1 1 0\n", "6 1.1 1 0\n")).unwrap();
    let resumed =
        stsolve(directory.path(), &["motion", "plate.toml", "--output", "motion", "--resume", "--set", "time.end=2"]);
    resumed.expect(2, &["another case"]);
    std::fs::write(directory.path().join("plate.msh"), text.replace("\"top\"", "\"to\tp\"")).unwrap();
    stsolve(directory.path(), &["motion", "plate.toml"])
        .expect(2, &["the name of a physical group, marker or boundary condition, \"to\\tp\","]);
    for (spoilt, expected) in [("6 x 1 0\n", "plate.msh: line 18: expected"), ("6 3 1 0\n", "plate.msh: element ")] {
        std::fs::write(directory.path().join("plate.msh"), text.replace("6 1 1 0\n", spoilt)).unwrap();
        for arguments in [&["info", "plate.msh"][..], &["motion", "plate.toml"]] {
            stsolve(directory.path(), arguments).expect(2, &[expected]);
        }
    }
}

//! `[parallel]`

use super::*;

#[test]
fn stages_are_a_number_or_exact() {
    assert_eq!((plane(BASE, &[]).blocks, plane(BASE, &[]).stages), (1, 1));
    let stages = |value: &str| plane(BASE, &["parallel.blocks=4", &format!("parallel.stages={value}")]).stages;
    assert_eq!((stages("3"), stages("\"exact\"")), (3, usize::MAX));
    // Eight cells: small blocks keep the exact order by default.
    assert_eq!(plane(BASE, &["parallel.blocks=4"]).stages, usize::MAX);
    assert_eq!(plane(BASE, &["parallel.blocks=4", "mesh.generate.box.cells=[20,8]"]).stages, 1);
}

#[test]
fn other_stages_are_refused() {
    for value in ["0", "-1", "1.5", "\"all\"", "[1]"] {
        let error = check_text(BASE, &[&format!("parallel.stages={value}")]).unwrap_err().to_string();
        assert!(error.contains("parallel.stages") && error.contains("a whole number"), "{value}: {error}");
    }
}

/// BDDC on one block is the factor of that block.
#[test]
fn a_solver_on_blocks_needs_blocks() {
    let wing = |set: &[&str]| check_text(AIRFOIL, &[&["motion.elasticity.solver=bddc"], set].concat());
    let error = wing(&[]).unwrap_err().to_string();
    assert!(error.contains("motion.elasticity.solver") && error.contains("parallel.blocks = 2 or more"), "{error}");
    assert!(wing(&["parallel.blocks=4"]).is_ok());
}

const AIRFOIL: &str = include_str!("../../../../cases/naca0012_heave.toml");

//! The proof for a whole mesh.

use crate::{BoxMesh, Curving, Mesh, MotionCheck, NodeNumbering, Validity};

fn unit_box<const D: usize>(cells: usize, order: usize) -> (Mesh<D>, NodeNumbering) {
    let (lower, upper, curving) = ([0.0; D], [1.0; D], Curving::Smooth { amplitude: 0.03 });
    let mesh = BoxMesh { lower, upper, cells: [cells; D], order, curving, periodic: [false; D] }.build().unwrap();
    let numbering = NodeNumbering::new(&mesh, order);
    (mesh, numbering)
}

/// Displacements of all nodes at all times.
fn displacements<const D: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    times: &[f64],
    d: impl Fn(&[f64], f64) -> [f64; D],
) -> Vec<f64> {
    let length = numbering.count * D;
    let mut out = vec![0.0; length * times.len()];
    for (s, out) in times.iter().zip(out.chunks_exact_mut(length)) {
        for cell in 0..mesh.n_cells() {
            for (node, x) in numbering.cell(cell).iter().zip(mesh.cell_coordinates(cell).chunks_exact(D)) {
                out[node * D..][..D].copy_from_slice(&d(x, *s));
            }
        }
    }
    out
}

fn smallest<const D: usize>(answers: &[Validity<D>]) -> f64 {
    answers.iter().map(|answer| answer.bound().lower).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_mesh_at_rest_and_an_affine_motion_are_bounded_to_round_off() {
    for order in [2, 3, 5, 8] {
        let (mesh, numbering) = unit_box::<2>(3, order);
        let times = [0.0, 0.5, 1.0];
        let check = MotionCheck::new(&mesh, &numbering, &times);
        let at_rest = smallest(&check.decide(&displacements(&mesh, &numbering, &times, |_, _| [0.0; 2])));
        assert!(at_rest <= 1.0 && at_rest > 1.0 - 1e-3, "order {order}: {at_rest}");
        let shrinking = |x: &[f64], s: f64| [-0.3 * s * x[0], 100.0 - 0.2 * s * x[1]];
        let answers = check.decide(&displacements(&mesh, &numbering, &times, shrinking));
        let lower = smallest(&answers);
        assert!(lower <= 0.56 && lower > 0.55, "order {order}: {lower}");
        assert!(answers.iter().all(|answer| (answer.bound().sampled_min - 0.56).abs() < 1e-12));
        assert!(answers.iter().all(|answer| answer.bound().at.s == 1.0));
    }
}

#[test]
fn the_cell_that_folds_is_named_and_no_other() {
    let (mesh, numbering) = unit_box::<3>(2, 4);
    let times = [0.0, 1.0];
    let check = MotionCheck::new(&mesh, &numbering, &times);
    // dx/dX = 1 - 2.2 s (X - Y)^+ ... is negative only where X is near 1 and Y near 0, at late times.
    let folding = |x: &[f64], s: f64| [-0.55 * s * x[0] * x[0] * (1.0 - x[1]) * (1.0 - x[2]), 0.0, 0.0];
    let answers = check.decide(&displacements(&mesh, &numbering, &times, folding));
    for (cell, answer) in answers.iter().enumerate() {
        assert_eq!(matches!(answer, Validity::Invalid(_)), cell == 1, "cell {cell}: {answer:?}");
        assert_eq!(answer.is_valid(), cell != 1);
    }
    assert!(answers[1].bound().at.s > 0.9);
}

#[test]
fn the_number_of_threads_leaves_the_bounds_alone() {
    let (mesh, numbering) = unit_box::<2>(5, 6);
    let times = [0.0, 0.4, 1.0];
    let check = MotionCheck::new(&mesh, &numbering, &times);
    let wave = |x: &[f64], s: f64| [0.1 * s * (5.0 * x[1]).sin(), 0.1 * s * (4.0 * x[0]).cos()];
    let d = displacements(&mesh, &numbering, &times, wave);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| check.decide(&d))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_displacement_that_is_not_a_number_is_not_valid() {
    let (mesh, numbering) = unit_box::<2>(3, 3);
    let check = MotionCheck::new(&mesh, &numbering, &[0.0]);
    let mut d = vec![0.0; numbering.count * 2];
    d[numbering.cell(4)[4] * 2] = f64::NAN;
    let answers = check.decide(&d);
    assert!((0..9).all(|cell| answers[cell].is_valid() == (cell != 4)));
}

#![allow(clippy::unwrap_used)]
use crate::testing::{assembled, clamped, clamped_with, distance, largest, material, nodal, noise, unit_box};
use crate::{ElasticMesh, Solver, Stiffness};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use tensor::dot;

const GRADED: Stiffness<'_, 2> = Stiffness::InverseJacobian { power: 1.0 };

fn product<const D: usize>(elastic: &ElasticMesh<D>, d: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; d.len()];
    elastic.apply(d, &mut out);
    out
}

fn dot_vectors(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// K d and diag K against the assembled matrix. 11 cells in the plane do not fill two packs.
fn agrees_with_assembled<const D: usize>(mesh: &Mesh<D>, order: usize, stiffness: Stiffness<'_, D>) {
    let elastic = clamped(mesh, order, stiffness);
    let k = assembled(mesh, order, material().lame(), stiffness);
    let d = noise(elastic.length());
    let expected: Vec<f64> = (0..d.len()).map(|i| (0..d.len()).map(|j| k[(i, j)] * d[j]).sum()).collect();
    let scale = largest(&expected);
    assert!(distance(&product(&elastic, &d), &expected) < 1e-13 * scale, "K d, D = {D}, N = {order}");
    let diagonal: Vec<f64> = (0..d.len()).map(|i| k[(i, i)]).collect();
    assert!(distance(elastic.diagonal(), &diagonal) < 1e-13 * scale, "diag K, D = {D}, N = {order}");
}

#[test]
fn matrix_free_is_assembled_in_2d() {
    for order in [2, 3, 5] {
        agrees_with_assembled(&unit_box([11, 1], order, 0.03), order, GRADED);
        agrees_with_assembled(&unit_box([3, 2], order, 0.03), order, Stiffness::Function(&|x| 1.0 + x[0] * x[1]));
    }
}

#[test]
fn matrix_free_is_assembled_in_3d() {
    for order in [2, 3, 4] {
        agrees_with_assembled(&unit_box([3, 2, 2], order, 0.03), order, Stiffness::InverseJacobian { power: 2.0 });
    }
}

/// Orders of geometry and displacement may differ, and periodic nodes are one node with two positions.
#[test]
fn matrix_free_is_assembled_on_periodic_meshes_and_other_geometry() {
    let curving = Curving::Wavy { amplitude: 0.03 };
    let periodic =
        BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [3, 3], order: 4, curving, periodic: [true, false] };
    agrees_with_assembled(&periodic.build().unwrap(), 3, GRADED);
    agrees_with_assembled(&unit_box([2, 2], 3, 0.03), 5, GRADED);
}

#[test]
fn rigid_motions_cost_nothing() {
    for order in [2, 4, 8, 16] {
        let elastic = clamped(&unit_box([3, 2], order, 0.03), order, GRADED);
        for d in [nodal(&elastic, |_| [1.0, 0.0]), nodal(&elastic, |x| [-x[1], x[0]])] {
            assert!(largest(&product(&elastic, &d)) < 1e-12 * largest(elastic.diagonal()), "N = {order}");
        }
    }
    for order in [2, 4, 7] {
        let elastic = clamped(&unit_box([2, 2, 1], order, 0.03), order, Stiffness::InverseJacobian { power: 1.0 });
        for d in [nodal(&elastic, |_| [0.3, 1.0, -0.5]), nodal(&elastic, |x| [x[1] - x[2], x[2] - x[0], x[0] - x[1]])] {
            assert!(largest(&product(&elastic, &d)) < 1e-12 * largest(elastic.diagonal()), "N = {order}");
        }
    }
}

#[test]
fn symmetric_and_definite() {
    let elastic = clamped(&unit_box([3, 3], 5, 0.03), 5, GRADED);
    let random = noise(2 * elastic.length());
    let (a, b) = random.split_at(elastic.length());
    let (ka, kb) = (product(&elastic, a), product(&elastic, b));
    assert!((dot_vectors(a, &kb) - dot_vectors(b, &ka)).abs() < 1e-13 * dot_vectors(a, &ka));
    let mut free = a.to_vec();
    elastic.at_constrained(&mut free, |_| 0.0);
    let mut k_free = vec![0.0; free.len()];
    elastic.apply_free(&free, &mut k_free);
    assert!(dot_vectors(&free, &k_free) > 0.0);
    assert!(elastic.constrained().iter().zip(&k_free).all(|(c, k)| !c || *k == 0.0));
}

/// The energy of a homogeneous strain: d . K d / 2 = sigma : eps |domain| / 2, on a domain of volume 1.
#[test]
fn energy_of_a_homogeneous_strain() {
    let gradient = [[0.3, 0.1, 0.0], [-0.2, 0.4, 0.5], [0.0, 0.7, -0.6]];
    let elastic = clamped(&unit_box([2, 2, 2], 4, 0.0), 4, Stiffness::Constant);
    let d = nodal(&elastic, |x| gradient.map(|row| dot(&row, x)));
    let sigma = material().lame().stress(&gradient);
    let expected: f64 = sigma.as_flattened().iter().zip(gradient.as_flattened()).map(|(s, h)| s * h).sum();
    assert!((dot_vectors(&d, &product(&elastic, &d)) - expected).abs() < 1e-13);
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let mesh = unit_box([9, 7], 4, 0.03);
    let d = noise(2 * NodeNumbering::new(&mesh, 4).count);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let solve = |solver| {
                let elastic = clamped_with(&mesh, 4, GRADED, solver);
                let mut solutions = [d.clone(), d.clone()].concat();
                let reports = elastic.solve_all(&solutions.clone(), &mut solutions, 1e-10).unwrap();
                (product(&elastic, &d), elastic.diagonal().to_vec(), solutions, reports)
            };
            [Solver::Direct, Solver::ConjugateGradients, Solver::Multigrid].map(solve)
        })
    };
    let one = run(1);
    assert!([2, 3, 5].map(run).iter().all(|other| *other == one));
}

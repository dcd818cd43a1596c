#![allow(clippy::unwrap_used, clippy::print_stdout)]
use super::*;
use crate::testing::{between_sliding_walls, boundary_nodes, distance, largest, material, nodal, noise, unit_box};
use crate::{ElasticMesh, Law, SlabMotion, Solver, Stiffness};
use basis::RadauTime;
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};

/// Stiffness 1 + |x|^2.
fn clamped_with<const D: usize>(mesh: &Mesh<D>, order: usize, law: Law, solver: Solver) -> ElasticMesh<D> {
    let numbering = NodeNumbering::new(mesh, order);
    let constrained = boundary_nodes(mesh, &numbering);
    let modulus = |x: &[f64; D]| 1.0 + tensor::dot(x, x);
    let material = material().with_law(law);
    ElasticMesh::with_solver(mesh, &numbering, material, Stiffness::Function(&modulus), &constrained, solver).unwrap()
}

fn clamped<const D: usize>(mesh: &Mesh<D>, order: usize, law: Law) -> ElasticMesh<D> {
    clamped_with(mesh, order, law, Solver::Automatic)
}

/// A smooth displacement of the given size that bends every cell.
fn bend<const D: usize>(elastic: &ElasticMesh<D>, size: f64) -> Vec<f64> {
    nodal(elastic, |x| std::array::from_fn(|i| size * (2.0 * x[(i + 1) % D] + i as f64).sin() * (1.0 + x[i])))
}

fn forces<const D: usize>(elastic: &ElasticMesh<D>, d: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; d.len()];
    elastic.forces(d, &mut out).unwrap();
    out
}

fn tangent<const D: usize>(elastic: &ElasticMesh<D>, d: &[f64], w: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; d.len()];
    elastic.product_at(d, w, &mut out);
    out
}

/// a + factor b
fn plus(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}

/// The tangent against central differences of the forces, and its symmetry.
fn tangent_is_the_difference_of_forces<const D: usize>(mesh: &Mesh<D>, order: usize) {
    let elastic = clamped(mesh, order, Law::NeoHookean);
    let d = bend(&elastic, 0.15);
    let (w, e) = (bend(&elastic, 1.0), nodal(&elastic, |x| std::array::from_fn(|i| (3.0 * x[i]).cos())));
    let h = 1e-5;
    let [above, below] = [h, -h].map(|h| forces(&elastic, &plus(&d, h, &w)));
    let difference: Vec<f64> = above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * h)).collect();
    let product = tangent(&elastic, &d, &w);
    let error = distance(&product, &difference) / largest(&product);
    assert!(error < 1e-8, "D = {D}, N = {order}: {error:e}");
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (one, other) = (dot(&e, &product), dot(&w, &tangent(&elastic, &d, &e)));
    assert!((one - other).abs() < 1e-12 * one.abs().max(dot(&w, &product)), "D = {D}, N = {order}: not symmetric");
}

#[test]
fn tangent_is_the_difference_of_forces_for_every_order() {
    for order in [2, 3, 4, 5, 8, 9, 16] {
        tangent_is_the_difference_of_forces(&unit_box([3, 2], order, 0.03), order);
    }
    for order in [2, 3, 4, 6] {
        tangent_is_the_difference_of_forces(&unit_box([3, 1, 2], order, 0.03), order);
    }
}

/// At rest the tangent is the K of linear elasticity if both integrals are exact: on cells that are not curved.
#[test]
fn tangent_at_rest_is_linear() {
    let mesh = unit_box([3, 3], 5, 0.0);
    let elastic = |law| {
        let numbering = NodeNumbering::new(&mesh, 5);
        let constrained = boundary_nodes(&mesh, &numbering);
        ElasticMesh::new(&mesh, &numbering, material().with_law(law), Stiffness::Constant, &constrained).unwrap()
    };
    let (linear, nonlinear) = (elastic(Law::Linear), elastic(Law::NeoHookean));
    let w = noise(linear.length());
    let expected = forces(&linear, &w);
    assert!(distance(&tangent(&nonlinear, &vec![0.0; w.len()], &w), &expected) < 1e-12 * largest(&expected));
    let difference = |size: f64| {
        let d = bend(&linear, size);
        distance(&forces(&nonlinear, &d), &forces(&linear, &d))
    };
    let order = (difference(1e-3) / difference(5e-4)).log2();
    assert!((order - 2.0).abs() < 0.02, "order {order}");
}

/// The whole mesh turned by 100 degrees is free of stress: R = 0, and K is the turned K of the mesh at rest.
#[test]
fn rotations_cost_nothing() {
    let elastic = clamped(&unit_box([3, 2], 4, 0.03), 4, Law::NeoHookean);
    let (sin, cos) = 100_f64.to_radians().sin_cos();
    let rotation = nodal(&elastic, |x| [cos * x[0] - sin * x[1] - x[0], sin * x[0] + cos * x[1] - x[1]]);
    assert!(largest(&forces(&elastic, &rotation)) < 1e-13 * largest(elastic.diagonal()));
    let turn = |v: &[f64]| -> Vec<f64> {
        v.chunks_exact(2).flat_map(|v| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]]).collect()
    };
    let w = noise(elastic.length());
    let expected = turn(&tangent(&elastic, &vec![0.0; w.len()], &w));
    assert!(distance(&tangent(&elastic, &rotation, &turn(&w)), &expected) < 1e-12 * largest(&expected));
}

#[test]
fn an_inverted_cell_is_named() {
    let elastic = clamped(&unit_box([11, 1], 3, 0.0), 3, Law::NeoHookean);
    // x = X + d folds between the nodes of X = 0.8, in the ninth cell.
    let fold = nodal(&elastic, |x| [if x[0] > 0.8 { -2.0 * (x[0] - 0.8).min(0.02) } else { 0.0 }, 0.0]);
    let error = elastic.forces(&fold, &mut vec![0.0; fold.len()]).unwrap_err();
    assert_eq!(error.cell, 8, "{error}");
    assert!(error.volume_ratio < 0.0 && error.to_string().contains("cell 8"), "{error}");
    let nan = vec![f64::NAN; fold.len()];
    assert!(elastic.forces(&nan, &mut vec![0.0; fold.len()]).is_err());
}

/// Forces and tangent about a moved mesh equal those of linear elasticity on a mesh that was built there. The stiffness is taken at the
/// initial position, to which `back` leads.
fn increments_are_linear<const D: usize>(
    mesh: &Mesh<D>,
    moved: &Mesh<D>,
    stiffness: impl Fn(&[f64; D]) -> f64 + Sync,
    back: impl Fn(&[f64; D]) -> [f64; D] + Sync,
) {
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let constrained = boundary_nodes(mesh, &numbering);
    let build = |mesh: &Mesh<D>, law, stiffness| {
        ElasticMesh::new(mesh, &numbering, material().with_law(law), stiffness, &constrained).unwrap()
    };
    let mut elastic = build(mesh, Law::Incremental, Stiffness::Function(&stiffness));
    let expected = build(moved, Law::Linear, Stiffness::Function(&|x| stiffness(&back(x))));
    let bottom = plus(expected.coordinates().as_flattened(), -1.0, elastic.coordinates().as_flattened());
    elastic.begin_slab(&bottom).unwrap();
    let w = noise(bottom.len());
    let reference = forces(&expected, &w);
    let at = plus(&bottom, 1.0, &w);
    assert!(distance(&forces(&elastic, &at), &reference) < 1e-11 * largest(&reference), "D = {D}: forces");
    assert!(distance(&tangent(&elastic, &at, &w), &reference) < 1e-11 * largest(&reference), "D = {D}: tangent");
}

#[test]
fn increments_are_linear_about_the_bottom() {
    increments_are_linear(&unit_box([3, 2], 4, 0.0), &unit_box([3, 2], 4, 0.04), |_| 1.0, |x| *x);
    increments_are_linear(&unit_box([2, 1, 2], 3, 0.02), &unit_box([2, 1, 2], 3, -0.03), |_| 1.0, |x| *x);
    let stretched = BoxMesh { upper: [2.0, 0.5], ..square(3) };
    let modulus = |x: &[f64; 2]| 1.0 + tensor::dot(x, x);
    let back = |x: &[f64; 2]| [0.5 * x[0], 2.0 * x[1]];
    increments_are_linear(&square(3).build().unwrap(), &stretched.build().unwrap(), modulus, back);
}

/// The unit square in four cells of the given order.
fn square(order: usize) -> BoxMesh<2> {
    let (lower, upper, cells, curving) = ([0.0; 2], [1.0; 2], [2; 2], Curving::None);
    BoxMesh { lower, upper, cells, order, curving, periodic: [false; 2] }
}

/// A stiffness by det J refers to the mesh at the bottom: cells that have shrunk to a half are twice as stiff.
#[test]
fn stiffness_by_the_jacobian_follows_the_mesh() {
    let mesh = unit_box([3, 3], 3, 0.0);
    let numbering = NodeNumbering::new(&mesh, 3);
    let constrained = boundary_nodes(&mesh, &numbering);
    let after = |power: f64| {
        let material = material().with_law(Law::Incremental);
        let stiffness = Stiffness::InverseJacobian { power };
        let mut elastic = ElasticMesh::new(&mesh, &numbering, material, stiffness, &constrained).unwrap();
        let half = nodal(&elastic, |x| [-0.5 * x[0], 0.0]);
        elastic.begin_slab(&half).unwrap();
        tangent(&elastic, &half, &noise(half.len()))
    };
    let (frozen, following) = (after(0.0), after(1.0));
    assert!(distance(&following, &plus(&frozen, 1.0, &frozen)) < 1e-13 * largest(&following));
    let mut elastic =
        ElasticMesh::new(&mesh, &numbering, material().with_law(Law::Incremental), Stiffness::Constant, &constrained)
            .unwrap();
    let folded = nodal(&elastic, |x| [-1.5 * x[0], 0.0]);
    assert!(matches!(elastic.begin_slab(&folded), Err(ElasticityError::Inverted(_))));
}

/// The boundary bent by sin(t), in a slab from `bottom`: velocities and work.
fn solve<const D: usize>(elastic: &mut ElasticMesh<D>, bottom: &[f64], size: f64, position: f64) -> (Vec<f64>, Work) {
    let (motion, dt) = (SlabMotion::new(RadauTime::new(2)), 0.1);
    elastic.begin_slab(bottom).unwrap();
    let slab = ElasticSlab { mesh: elastic, motion: &motion, dt };
    let nodes = motion.time().nodes();
    let g: Vec<f64> = nodes.iter().flat_map(|s| plus(bottom, *s, &bend(elastic, size))).collect();
    let mut v = vec![0.0; g.len()];
    let accuracy = Accuracy { solve: 1e-3, position };
    let work = slab.equilibrium(bottom, &g, &mut v, accuracy, &|_| Ok(())).unwrap();
    let mut r = vec![0.0; v.len()];
    slab.residual(bottom, &g, &v, &mut r).unwrap();
    let norm = Weighted::new(elastic.position_weights(2)).norm(&r);
    assert!(norm <= position.max(1e-11), "|R| = {norm:e}");
    (v, work)
}

#[test]
fn equilibrium_is_found_in_few_steps() {
    let mut plane = clamped(&unit_box([4, 4], 4, 0.03), 4, Law::NeoHookean);
    let rest = vec![0.0; plane.length()];
    assert_eq!(solve(&mut plane, &rest, 0.02, 1e-2).1.steps, 1);
    assert!(solve(&mut plane, &rest, 0.15, 1e-11).1.steps <= 6);
    let mut space = clamped(&unit_box([2, 2, 2], 3, 0.03), 3, Law::NeoHookean);
    let rest = vec![0.0; space.length()];
    assert!(solve(&mut space, &rest, 0.1, 1e-10).1.steps <= 5);
}

/// A column between sliding walls is compressed evenly by every law: that is free of shear, and its stress is the same everywhere.
#[test]
fn a_column_between_sliding_walls_is_compressed_evenly() {
    let curving = Curving::Smooth { amplitude: 0.03 };
    let mesh = BoxMesh { curving, cells: [3, 2], ..square(4) }.build().unwrap();
    let numbering = NodeNumbering::new(&mesh, 4);
    let constrained = between_sliding_walls(&mesh, &numbering);
    for (law, accuracy) in [(Law::Linear, 1e-12), (Law::Incremental, 1e-12), (Law::NeoHookean, 1e-10)] {
        for solver in [Solver::Direct, Solver::ConjugateGradients, Solver::Multigrid] {
            let material = material().with_law(law);
            let mut elastic =
                ElasticMesh::with_solver(&mesh, &numbering, material, Stiffness::Constant, &constrained, solver)
                    .unwrap();
            let moved = nodal(&elastic, |x| [0.3 * (1.0 - x[0]), 0.0]);
            let (motion, bottom) = (SlabMotion::new(RadauTime::new(2)), plus(&moved, -0.5, &moved));
            elastic.begin_slab(&bottom).unwrap();
            let slab = ElasticSlab { mesh: &elastic, motion: &motion, dt: 1.0 };
            let g: Vec<f64> = motion.time().nodes().iter().flat_map(|s| plus(&bottom, 0.5 * s, &moved)).collect();
            let mut v = vec![0.0; g.len()];
            let solve = if law.is_linear() { 1e-14 } else { 1e-3 };
            slab.equilibrium(&bottom, &g, &mut v, Accuracy { solve, position: 1e-12 }, &|_| Ok(())).unwrap();
            let expected = plus(&vec![0.0; moved.len()], 0.5, &moved).repeat(2);
            assert!(distance(&v, &expected) < accuracy, "{law:?}, {solver:?}: {:e}", distance(&v, &expected));
        }
    }
}

/// Solvers differ in the last digits only.
#[test]
fn direct_and_iterative_agree() {
    let mesh = unit_box([3, 2, 2], 3, 0.03);
    let [direct, iterative] = [Solver::Direct, Solver::ConjugateGradients].map(|solver| {
        let mut elastic = clamped_with(&mesh, 3, Law::NeoHookean, solver);
        let rest = vec![0.0; elastic.length()];
        solve(&mut elastic, &rest, 0.1, 1e-11).0
    });
    assert!(distance(&direct, &iterative) < 1e-9 * largest(&direct));
}

/// CG iterations with the tangent of a bar twisted by 90 degrees: the preconditioner moves with the mesh.
#[test]
fn the_low_order_refinement_moves_with_the_mesh() {
    let mesh = unit_box([2, 2, 3], 4, 0.0);
    let mut elastic = clamped_with(&mesh, 4, Law::NeoHookean, Solver::ConjugateGradients);
    let twist = nodal(&elastic, |x| {
        let (sin, cos) = (90_f64.to_radians() * x[2]).sin_cos();
        let y = [x[0] - 0.5, x[1] - 0.5];
        [cos * y[0] - sin * y[1] - y[0], sin * y[0] + cos * y[1] - y[1], 0.0]
    });
    let f = noise(twist.len());
    let iterations = |elastic: &ElasticMesh<3>| elastic.solve(&f, &mut vec![0.0; f.len()], 1e-8).unwrap().iterations;
    let at_rest = iterations(&elastic);
    elastic.begin_slab(&twist).unwrap();
    let twisted = iterations(&elastic);
    println!("CG iterations to 1e-8, N = 4 in 3-D: {at_rest} at rest, {twisted} twisted by 90 degrees");
    assert!(twisted <= 32, "{at_rest} at rest, {twisted} twisted");
}

#[test]
fn an_equilibrium_out_of_reach_is_an_error() {
    let mut elastic = clamped(&unit_box([3, 3], 3, 0.0), 3, Law::NeoHookean);
    let motion = SlabMotion::new(RadauTime::new(1));
    let rest = vec![0.0; elastic.length()];
    elastic.begin_slab(&rest).unwrap();
    let slab = ElasticSlab { mesh: &elastic, motion: &motion, dt: 1.0 };
    let mirrored = nodal(&elastic, |x| [-2.0 * x[0], 0.0]);
    let accuracy = Accuracy { solve: 1e-3, position: 1e-3 };
    let error = slab.equilibrium(&rest, &mirrored, &mut rest.clone(), accuracy, &|_| Ok(())).unwrap_err();
    assert!(matches!(error, ElasticityError::Newton { .. }), "{error}");
}

#[test]
fn same_bits_for_any_number_of_threads_and_whatever_was_before() {
    let mesh = unit_box([9, 7], 4, 0.03);
    for law in [Law::NeoHookean, Law::Incremental] {
        let run = |threads: usize, detour: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut elastic = clamped(&mesh, 4, law);
                let bottom = bend(&elastic, 0.05);
                if detour {
                    let elsewhere = bend(&elastic, -0.05);
                    elastic.begin_slab(&elsewhere).unwrap();
                }
                let v = solve(&mut elastic, &bottom, 0.05, if law.is_linear() { f64::MAX } else { 1e-3 }).0;
                (v, tangent(&elastic, &bottom, &bottom))
            })
        };
        let one = run(1, false);
        assert!(run(2, false) == one && run(3, true) == one, "{law:?}");
    }
}

/// A defect that was: at rest, CG took as many iterations as in motion, to reduce a residual that was round-off.
#[test]
fn a_mesh_whose_boundary_rests_stays_and_costs_nothing() {
    let elastic = clamped_with(&unit_box([3, 2, 2], 4, 0.03), 4, Law::Linear, Solver::Multigrid);
    let (motion, dt) = (SlabMotion::new(RadauTime::new(2)), 0.1);
    let slab = ElasticSlab { mesh: &elastic, motion: &motion, dt };
    let (g, accuracy) = (bend(&elastic, 0.1).repeat(2), Accuracy { solve: 1e-10, position: 1e-10 });
    let (bottom, mut v) = (vec![0.0; elastic.length()], vec![0.0; 2 * elastic.length()]);
    let moved = slab.equilibrium(&bottom, &g, &mut v, accuracy, &|_| Ok(())).unwrap();
    let mut top = bottom.clone();
    motion.displacement(dt, &bottom, &v, 1.0, &mut top);
    let rested = slab.equilibrium(&top, &g, &mut v, accuracy, &|_| Ok(())).unwrap();
    assert!(moved.iterations > 10 && rested == Work::default(), "{moved:?}, {rested:?}");
    assert!(v.iter().all(|v| *v == 0.0));
}

#![allow(clippy::unwrap_used)]
use crate::testing::{
    assembled, between_sliding_walls, boundary_nodes, clamped, clamped_with, distance, largest, material, nodal, noise,
    solve_densely, unit_box,
};
use crate::{ElasticMesh, ElasticityError, Solver, Stiffness};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use tensor::dot;

const SOLVERS: [Solver; 3] = [Solver::Direct, Solver::ConjugateGradients, Solver::Multigrid];

/// An affine displacement of the boundary must give the same affine displacement inside, if E is constant.
fn patch_test<const D: usize>(cells: [usize; D], order: usize) {
    let elastic = clamped(&unit_box(cells, order, 0.05), order, Stiffness::Constant);
    let gradient: [[f64; D]; D] =
        std::array::from_fn(|i| std::array::from_fn(|j| 0.2 + 0.1 * i as f64 - 0.3 * j as f64));
    let exact = nodal(&elastic, |x| gradient.map(|row| 0.5 + dot(&row, x)));
    let mut d = vec![0.0; exact.len()];
    elastic.at_constrained(&mut d, |i| exact[i]);
    elastic.extend(&mut d, 1e-14).unwrap();
    assert!(distance(&d, &exact) < 1e-11, "D = {D}, N = {order}: {:e}", distance(&d, &exact));
}

#[test]
fn patch_test_on_curved_meshes_in_2d() {
    for (cells, order) in [([5, 4], 2), ([4, 4], 3), ([3, 4], 4), ([3, 3], 8), ([2, 2], 16)] {
        patch_test(cells, order);
    }
}

#[test]
fn patch_test_on_curved_meshes_in_3d() {
    for (cells, order) in [([3, 3, 4], 2), ([3, 2, 2], 3), ([2, 2, 3], 4), ([1, 2, 1], 7)] {
        patch_test(cells, order);
    }
}

/// Every solver against a dense factorisation of the matrix assembled point by point.
fn agrees_with_dense<const D: usize>(mesh: &Mesh<D>, order: usize) {
    let stiffness = Stiffness::InverseJacobian { power: 1.0 };
    let k = assembled(mesh, order, material().lame(), stiffness);
    for solver in SOLVERS {
        let elastic = clamped_with(mesh, order, stiffness, solver);
        let random = noise(2 * elastic.length());
        let (forces, given) = random.split_at(elastic.length());
        let (mut expected, mut found) = (given.to_vec(), given.to_vec());
        solve_densely(&k, elastic.constrained(), forces, &mut expected);
        let report = elastic.solve(forces, &mut found, 1e-12).unwrap();
        assert!(distance(&found, &expected) < 1e-9 * largest(&expected), "D = {D}, N = {order}, {solver:?}");
        assert_eq!(report.iterations == 0, solver == Solver::Direct);
    }
}

#[test]
fn every_solver_agrees_with_a_dense_factorisation() {
    for order in [2, 3, 5, 8] {
        agrees_with_dense(&unit_box([4, 3], order, 0.03), order);
    }
    for order in [2, 3, 4] {
        agrees_with_dense(&unit_box([3, 2, 2], order, 0.03), order);
    }
}

/// All free nodes of a single cell are inside it: the skeleton is empty.
#[test]
fn every_solver_agrees_with_a_dense_factorisation_on_a_single_cell() {
    agrees_with_dense(&unit_box([1, 1], 4, 0.0), 4);
    agrees_with_dense(&unit_box([1, 1, 1], 4, 0.0), 4);
}

/// Nodes of one cell on both sides of a periodic boundary are one node.
#[test]
fn every_solver_agrees_with_a_dense_factorisation_on_a_periodic_strip_one_cell_long() {
    let (curving, periodic) = (Curving::None, [true, false]);
    let strip = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [1, 3], order: 4, curving, periodic };
    agrees_with_dense(&strip.build().unwrap(), 4);
}

/// A free boundary, and nodes inside cells and on their surfaces that are constrained in both components or in one.
#[test]
fn every_solver_agrees_with_a_dense_factorisation_where_other_nodes_are_constrained() {
    let (mesh, order) = (unit_box([3, 3], 5, 0.03), 5);
    let numbering = NodeNumbering::new(&mesh, order);
    let constrained: Vec<[bool; 2]> = (0..numbering.count).map(|node| [node % 13 == 0, node % 7 == 0]).collect();
    let k = assembled(&mesh, order, material().lame(), Stiffness::Constant);
    for solver in SOLVERS {
        let elastic =
            ElasticMesh::with_solver(&mesh, &numbering, material(), Stiffness::Constant, &constrained, solver).unwrap();
        let random = noise(2 * elastic.length());
        let (forces, given) = random.split_at(elastic.length());
        let (mut expected, mut found) = (given.to_vec(), given.to_vec());
        solve_densely(&k, elastic.constrained(), forces, &mut expected);
        elastic.solve(forces, &mut found, 1e-12).unwrap();
        assert!(distance(&found, &expected) < 1e-9 * largest(&expected), "{solver:?}");
    }
}

#[test]
fn right_hand_sides_together_are_those_one_by_one() {
    let mesh = unit_box([5, 4], 4, 0.03);
    for solver in SOLVERS {
        let elastic = clamped_with(&mesh, 4, Stiffness::Constant, solver);
        let (f, mut together) = (noise(3 * elastic.length()), noise(3 * elastic.length()));
        let mut single = together.clone();
        elastic.solve_all(&f, &mut together, 1e-12).unwrap();
        for (f, d) in f.chunks_exact(elastic.length()).zip(single.chunks_exact_mut(elastic.length())) {
            elastic.solve(f, d, 1e-12).unwrap();
        }
        assert!(distance(&together, &single) < 1e-12 * largest(&single), "{solver:?}");
    }
}

/// CG iterations to 1e-10 for random forces on a clamped mesh.
fn iterations<const D: usize>(mesh: &Mesh<D>, order: usize) -> usize {
    let elastic = clamped_with(mesh, order, Stiffness::Constant, Solver::ConjugateGradients);
    let mut d = vec![0.0; elastic.length()];
    elastic.solve(&noise(d.len()), &mut d, 1e-10).unwrap().iterations
}

fn assert_iterations(counts: &[(usize, usize)], found: impl Fn(usize) -> usize) {
    for &(order, expected) in counts {
        let found = found(order);
        assert!(found.abs_diff(expected) <= 1, "N = {order}: {found} iterations, expected {expected}");
    }
}

#[test]
fn iterations_do_not_grow_with_the_order_in_2d() {
    let cells = |order| if order == 4 { 40 } else { 136 / order };
    assert_iterations(&[(4, 23), (8, 27), (16, 29)], |order| {
        iterations(&unit_box([cells(order); 2], order, 0.0), order)
    });
}

#[test]
fn iterations_do_not_grow_with_the_order_in_3d() {
    let cells = |order| 24 / order;
    assert_iterations(&[(3, 42), (4, 42), (8, 43)], |order| {
        iterations(&unit_box([cells(order); 3], order, 0.0), order)
    });
}

fn straight<const D: usize>(upper: [f64; D], cells: usize, order: usize) -> BoxMesh<D> {
    BoxMesh { lower: [0.0; D], upper, cells: [cells; D], order, curving: Curving::None, periodic: [false; D] }
}

#[test]
fn iterations_do_not_grow_with_the_aspect_ratio() {
    for extent in [1.0, 100.0, 1000.0] {
        let found = iterations(&straight([extent, 1.0], 12, 8).build().unwrap(), 8);
        assert!(found <= 30, "aspect ratio {extent}: {found} iterations");
    }
    let found = iterations(&straight([100.0, 1.0, 1.0], 6, 4).build().unwrap(), 4);
    assert!(found <= 46, "aspect ratio 100 in space: {found} iterations");
}

/// A boundary layer: cells grow by 1000 from the wall, E falls as 1 / det J, and the wall moves.
#[test]
fn iterations_in_a_boundary_layer() {
    for order in [4, 8] {
        let mesh = straight([1.0, 1.0], 64 / order, order).build_graded([1.0, 1000.0]).unwrap();
        let stiffness = Stiffness::InverseJacobian { power: 1.0 };
        let elastic = clamped_with(&mesh, order, stiffness, Solver::ConjugateGradients);
        let mut d = vec![0.0; elastic.length()];
        let wall = nodal(&elastic, |x| if x[1] == 0.0 { [0.0, 0.01 * (6.0 * x[0]).sin()] } else { [0.0, 0.0] });
        elastic.at_constrained(&mut d, |i| wall[i]);
        let found = elastic.extend(&mut d, 1e-10).unwrap().iterations;
        assert!(found <= 30, "N = {order}: {found} iterations");
    }
}

#[test]
fn a_good_guess_saves_iterations_and_no_boundary_motion_needs_none() {
    let elastic = clamped_with(&unit_box([4, 4], 4, 0.0), 4, Stiffness::Constant, Solver::ConjugateGradients);
    let boundary = nodal(&elastic, |x| [x[0] * x[1], x[0] * x[0]]);
    let mut d = boundary.clone();
    let cold = elastic.extend(&mut d, 1e-10).unwrap().iterations;
    d.iter_mut().zip(&boundary).for_each(|(d, b)| *d += 1e-6 * b);
    assert!(elastic.extend(&mut d, 1e-10).unwrap().iterations < cold);
    elastic.at_constrained(&mut d, |_| 0.0);
    assert_eq!(elastic.extend(&mut d, 1e-10).unwrap().iterations, 0);
    assert_eq!(largest(&d), 0.0);
}

#[test]
fn periodic_meshes_move_periodically() {
    let curving = Curving::Wavy { amplitude: 0.03 };
    let mesh = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [4, 3], order: 4, curving, periodic: [true, false] }
        .build()
        .unwrap();
    let elastic = clamped(&mesh, 4, Stiffness::Constant);
    // A shear along the periodic axis, of the strip between bottom and top. It is linear in y alone where the strip is
    // straight.
    let mut d = vec![0.0; elastic.length()];
    let exact = nodal(&elastic, |x| [x[1], 0.0]);
    elastic.at_constrained(&mut d, |i| exact[i]);
    elastic.extend(&mut d, 1e-14).unwrap();
    assert!(distance(&d, &exact) < 1e-11);
}

/// A box whose left wall moves by 0.3, whose right wall rests, and whose other walls slide in their planes, is compressed evenly.
fn slides_linearly<const D: usize>(mesh: &Mesh<D>, order: usize, solver: Solver) {
    let numbering = NodeNumbering::new(mesh, order);
    let constrained = between_sliding_walls(mesh, &numbering);
    let elastic =
        ElasticMesh::with_solver(mesh, &numbering, material(), Stiffness::Constant, &constrained, solver).unwrap();
    let exact = nodal(&elastic, |x| std::array::from_fn(|i| if i == 0 { 0.3 * (1.0 - x[0]) } else { 0.0 }));
    let mut d = vec![0.0; exact.len()];
    elastic.at_constrained(&mut d, |i| exact[i]);
    elastic.extend(&mut d, 1e-14).unwrap();
    // Poisson's ratio does not bend it: the walls hold what would move along their normals.
    assert!(distance(&d, &exact) < 1e-12, "D = {D}, N = {order}, {solver:?}: {:e}", distance(&d, &exact));
}

#[test]
fn a_box_between_sliding_walls_deforms_linearly() {
    let curving = Curving::Smooth { amplitude: 0.04 };
    for solver in SOLVERS {
        for (cells, order) in [([4, 3], 2), ([3, 4], 4), ([2, 2], 9)] {
            let periodic = [false; 2];
            let mesh = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells, order, curving, periodic }.build().unwrap();
            slides_linearly(&mesh, order, solver);
        }
        let (cells, periodic) = ([3, 2, 2], [false; 3]);
        let mesh = BoxMesh { lower: [0.0; 3], upper: [1.0; 3], cells, order: 3, curving, periodic }.build().unwrap();
        slides_linearly(&mesh, 3, solver);
    }
}

/// CG on a column between sliding walls takes no more iterations than on one that is clamped.
#[test]
fn sliding_walls_do_not_slow_down_iterations() {
    let mesh = straight([4.0, 1.0], 16, 4).build().unwrap();
    let numbering = NodeNumbering::new(&mesh, 4);
    let constrained = between_sliding_walls(&mesh, &numbering);
    for (solver, most) in [(Solver::ConjugateGradients, 30), (Solver::Multigrid, 40)] {
        let elastic =
            ElasticMesh::with_solver(&mesh, &numbering, material(), Stiffness::Constant, &constrained, solver).unwrap();
        let found =
            elastic.solve(&noise(elastic.length()), &mut vec![0.0; elastic.length()], 1e-10).unwrap().iterations;
        assert!(found <= most, "{solver:?}: {found} iterations");
    }
}

fn refused(stiffness: Stiffness<'_, 2>, constrained: impl Fn(Vec<[bool; 2]>) -> Vec<[bool; 2]>) -> ElasticityError {
    let mesh = unit_box([2, 2], 3, 0.0);
    let numbering = NodeNumbering::new(&mesh, 3);
    let constrained = constrained(boundary_nodes(&mesh, &numbering));
    ElasticMesh::new(&mesh, &numbering, material(), stiffness, &constrained).err().unwrap()
}

#[test]
fn impossible_meshes_are_refused() {
    let none = |c: Vec<[bool; 2]>| vec![[false; 2]; c.len()];
    assert_eq!(refused(Stiffness::Constant, none), ElasticityError::Unconstrained { axis: 0 });
    let all_along_x = |c: Vec<[bool; 2]>| vec![[true, false]; c.len()];
    assert_eq!(refused(Stiffness::Constant, all_along_x), ElasticityError::Unconstrained { axis: 1 });
    let one = |c: Vec<[bool; 2]>| (0..c.len()).map(|i| [i == 0; 2]).collect();
    assert!(matches!(refused(Stiffness::Constant, one), ElasticityError::NotDefinite { .. }));
    let short = |_| vec![[true; 2]];
    assert!(matches!(refused(Stiffness::Constant, short), ElasticityError::Length { found: 1, expected: 25, .. }));
    let soft = refused(Stiffness::Function(&|x| x[0] - 0.5), |c| c);
    assert!(matches!(soft, ElasticityError::Stiffness { cell: 0, value, .. } if value < 0.0));
}

/// With one cell of order 2 there is nothing to solve for.
#[test]
fn a_mesh_without_free_nodes_is_solved_at_once() {
    let elastic = clamped(&unit_box([1, 1], 2, 0.0), 2, Stiffness::Constant);
    let mut d = noise(elastic.length());
    assert_eq!(elastic.extend(&mut d, 1e-10).unwrap().iterations, 0);
    assert_eq!(d, noise(elastic.length()));
}

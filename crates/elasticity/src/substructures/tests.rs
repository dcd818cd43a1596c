//! The solvers on blocks: exact solutions, iterations, bits on several ranks.
#![allow(clippy::unwrap_used)]

use crate::solver::{Plan, Prepared};
use crate::substructures::Substructures;
use crate::testing::{
    assembled, between_sliding_walls, boundary_nodes, distance, largest, material, noise, solve_densely, unit_box,
};
use crate::{ElasticMesh, ElasticityError, Partition, Solver, SolverOnBlocks, Stiffness};
use fem::NodalBatches;
use mesh::generate::{AirfoilMesh, Extrusion};
use mesh::{Mesh, NodeNumbering};
use ranks::{Alone, Communicator, Sums, Threads};
use std::sync::Arc;
use tensor::{Pack, WIDTH};

const BOTH: [Solver; 2] = [Solver::Direct, Solver::Bddc];

/// `solver` on `count` blocks, of which this rank owns a part.
fn on_blocks<const D: usize>(
    mesh: &Mesh<D>,
    solver: Solver,
    count: usize,
    communicator: Arc<dyn Communicator>,
) -> SolverOnBlocks {
    let block_of_cell = mesh::blocks(mesh, count).unwrap();
    SolverOnBlocks { solver, partition: Partition { block_of_cell, sums: Arc::new(Sums::new(communicator, count)) } }
}

fn clamped<const D: usize>(mesh: &Mesh<D>, solver: SolverOnBlocks) -> ElasticMesh<D> {
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let constrained = boundary_nodes(mesh, &numbering);
    let stiffness = Stiffness::InverseJacobian { power: 1.0 };
    ElasticMesh::with_solver(mesh, &numbering, material(), stiffness, &constrained, solver).unwrap()
}

fn agrees_with_dense<const D: usize>(mesh: &Mesh<D>, counts: &[usize]) {
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let stiffness = Stiffness::InverseJacobian { power: 1.0 };
    let k = assembled(mesh, mesh.order(), material().lame(), stiffness);
    for constrained in [boundary_nodes(mesh, &numbering), between_sliding_walls(mesh, &numbering)] {
        for (solver, &count) in BOTH.iter().flat_map(|solver| counts.iter().map(move |count| (*solver, count))) {
            let blocks = on_blocks(mesh, solver, count, Arc::new(Alone));
            let elastic =
                ElasticMesh::with_solver(mesh, &numbering, material(), stiffness, &constrained, blocks).unwrap();
            let random = noise(2 * elastic.length());
            let (forces, given) = random.split_at(elastic.length());
            let (mut expected, mut found) = (given.to_vec(), given.to_vec());
            solve_densely(&k, elastic.constrained(), forces, &mut expected);
            let report = elastic.solve(forces, &mut found, 1e-12).unwrap();
            let error = distance(&found, &expected) / largest(&expected);
            assert!(error < 1e-9, "D = {D}, order {}, {solver:?}, {count} blocks: {error:e}", mesh.order());
            assert_eq!(report.iterations == 0, solver == Solver::Direct);
        }
    }
}

#[test]
fn every_number_of_blocks_agrees_with_a_dense_factorisation() {
    for order in [2, 3, 5] {
        agrees_with_dense(&unit_box([5, 4], order, 0.03), &[1, 2, 3, 7, 20]);
    }
    for order in [2, 3, 4] {
        agrees_with_dense(&unit_box([3, 2, 3], order, 0.03), &[1, 2, 5, 18]);
    }
}

/// Without blocks BDDC is the direct solver of the one block.
#[test]
fn bddc_without_a_partition_is_the_factor_of_the_mesh() {
    let elastic = clamped(&unit_box([4, 3], 3, 0.03), Solver::Bddc.into());
    let mut d = vec![0.0; elastic.length()];
    assert!(elastic.solve(&noise(elastic.length()), &mut d, 1e-10).unwrap().iterations <= 2);
}

/// An airfoil with cells of aspect ratio 1,000 at its wall, of some 25,000 unknowns.
fn airfoil(order: usize) -> Mesh<2> {
    let normal_cells = if order < 8 { 28 } else { 12 };
    AirfoilMesh { first_cell: 1e-4, normal_cells, ..AirfoilMesh::naca0012(order) }.build().unwrap()
}

/// CG iterations to 1e-10 for a turn of the inner boundary.
fn iterations<const D: usize>(mesh: &Mesh<D>, count: usize) -> usize {
    let elastic = clamped(mesh, on_blocks(mesh, Solver::Bddc, count, Arc::new(Alone)));
    let turn = |x: &[f64; D]| if x[0].hypot(x[1]) < 3.0 { [-0.3 * x[1], 0.3 * x[0] + 0.3] } else { [0.0; 2] };
    let turned = elastic.coordinates().iter().flat_map(|x| {
        let [a, b] = turn(x);
        std::array::from_fn::<f64, D, _>(|i| [a, b, 0.0][i])
    });
    let mut d: Vec<f64> = turned.zip(elastic.constrained()).map(|(d, held)| if *held { d } else { 0.0 }).collect();
    elastic.extend(&mut d, 1e-10).unwrap().iterations
}

/// Iterations do not grow with the number of blocks, nor with the order, in cells of aspect ratio 1,000.
#[test]
fn bddc_takes_few_iterations_on_any_number_of_blocks() {
    for order in [4, 8] {
        let mesh = airfoil(order);
        let counts = [4, 16, 64].map(|count| iterations(&mesh, count));

        assert!(counts.iter().all(|count| *count <= 25), "order {order}: {counts:?}");
    }
    let plane = AirfoilMesh { first_cell: 1e-3, normal_cells: 12, ..AirfoilMesh::naca0012(3) }.build().unwrap();
    let wing = plane.extruded(&Extrusion { lower: 0.0, depth: 0.5, layers: 3, periodic: false }).unwrap();
    let counts = [8, 16].map(|count| iterations(&wing, count));

    assert!(counts.iter().all(|count| *count <= 25), "extruded: {counts:?}");
}

/// The bits of a solution on every one of `size` ranks.
fn bits<const D: usize>(mesh: &Mesh<D>, solver: Solver, size: usize) -> Vec<Vec<u64>> {
    Threads::run(size, |ranks| {
        let elastic = clamped(mesh, on_blocks(mesh, solver, 8, ranks));
        let (forces, mut d) = (noise(2 * elastic.length()), vec![0.0; 2 * elastic.length()]);
        elastic.solve_all(&forces, &mut d, 1e-10).unwrap();
        d.iter().map(|d| d.to_bits()).collect()
    })
}

#[test]
fn any_number_of_ranks_finds_the_same_bits() {
    for solver in BOTH {
        let (plane, space) = (unit_box([8, 7], 4, 0.03), unit_box([4, 3, 3], 3, 0.03));
        let [of_plane, of_space] = [bits(&plane, solver, 1), bits(&space, solver, 1)].map(|mut all| all.remove(0));
        for size in [2, 3, 4, 8] {
            assert!(bits(&plane, solver, size).iter().all(|d| *d == of_plane), "{solver:?}, {size} ranks");
            assert!(bits(&space, solver, size).iter().all(|d| *d == of_space), "{solver:?}, {size} ranks");
        }
    }
}

/// Every rank holds the factors of its own blocks alone.
#[test]
fn ranks_share_the_memory() {
    let mesh = unit_box([12, 12], 4, 0.0);
    let bytes = |size| {
        let of_rank = |ranks| clamped(&mesh, on_blocks(&mesh, Solver::Bddc, 8, ranks)).solver_bytes();
        Threads::run(size, of_rank).into_iter().max().unwrap() as f64
    };
    let share = bytes(8) / bytes(1);
    assert!(share < 0.25, "{share}");
}

/// A block that is not definite is an error on all ranks, and none waits for another.
#[test]
fn an_unstable_block_is_an_error_of_all_ranks() {
    let mesh = unit_box([6, 6], 3, 0.0);
    let numbering = NodeNumbering::new(&mesh, 3);
    let constrained = boundary_nodes(&mesh, &numbering);
    let batches = NodalBatches::new(&numbering);
    for solver in BOTH {
        let errors = Threads::run(3, |ranks| {
            let blocks = on_blocks(&mesh, solver, 4, ranks);
            let (_, prepared) = Plan::prepare(&mesh, &numbering, &batches, &constrained, &blocks);
            let Prepared::Cuts(cuts) = prepared else { panic!("{solver:?} works on blocks") };
            let unstable = |_| vec![Pack([-1.0; WIDTH]); batches.cell_length().pow(2)];
            Substructures::new(cuts, solver == Solver::Direct, &unstable).err()
        });
        assert!(errors.iter().all(|error| matches!(error, Some(ElasticityError::NotDefinite { .. }))), "{errors:?}");
    }
}

//! Structures in equilibrium, against exact solutions: plane stress, and constants that vary from point to point.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::{body_force, box_mesh, displacement, structure};
use elasticity::{ElasticityError, Law, Loads, Material, MaterialProperty, Plane, Solid, Statics, Structure, Traction};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use std::sync::Arc;
use tensor::Transcendental;

/// The largest |d - exact| at the nodes.
fn error_at_nodes<const D: usize>(structure: &Structure<D>, d: &[f64], exact: impl Fn(&[f64; D]) -> [f64; D]) -> f64 {
    let exact = structure.coordinates().iter().flat_map(exact);
    d.iter().zip(exact).map(|(d, exact)| (d - exact).abs()).fold(0.0, f64::max)
}

/// The equilibrium under `loads` with fixed entries at `g`.
fn equilibrium<const D: usize>(
    structure: Structure<D>,
    loads: Loads<D>,
    g: impl Fn(&[f64; D]) -> [f64; D],
) -> (Statics<D>, Vec<f64>) {
    let mut d: Vec<f64> = structure.coordinates().iter().flat_map(g).collect();
    d.iter_mut().zip(structure.fixed()).for_each(|(d, fixed)| *d = if *fixed { *d } else { 0.0 });
    let statics = Statics::new(structure, loads, 1).unwrap();
    statics.equilibrium(0.0, &mut d).unwrap();
    (statics, d)
}

/// Boundary number of `name`, and a traction on it.
fn traction<const D: usize>(mesh: &Mesh<D>, name: &str, q: Traction<D>) -> (usize, Traction<D>) {
    (mesh.boundary_names().iter().position(|known| known == name).unwrap(), q)
}

/// A stretched sheet contracts by nu; a slice of a long body by nu / (1 - nu), and it is stiffer.
#[test]
fn a_sheet_that_is_pulled_contracts_by_poissons_ratio() {
    let (young, nu, pull) = (3.0, 0.3, 0.02);
    for (plane, along, across) in [
        (Plane::Stress, pull / young, -nu * pull / young),
        (Plane::Strain, (1.0 - nu * nu) * pull / young, -nu * (1.0 + nu) * pull / young),
    ] {
        let mesh = box_mesh([2.0, 1.0], [3, 2], 4, 0.04);
        let pulled = traction(&mesh, "right", Box::new(move |_, _| [pull, 0.0]));
        let material = Material::new(young, nu).unwrap().in_plane(plane);
        let body = structure(mesh, material, 1.0, |name| [name == "left", name == "bottom"]);
        let loads = Loads { body_force: None, tractions: vec![pulled], ..Default::default() };
        let (statics, d) = equilibrium(body, loads, |_| [0.0; 2]);
        let error = error_at_nodes(statics.structure(), &d, |x| [along * x[0], across * x[1]]);
        assert!(error < 1e-14, "{plane:?}: {error:e}");
    }
}

/// Timoshenko's cantilever of length L and height H in plane stress, with a parabolic shear stress on its end. The solution is cubic, so
/// order 4 is exact to round-off.
#[test]
fn timoshenkos_cantilever_is_exact() {
    let (young, nu, length, height, load) = (200.0, 0.3, 4.0, 1.0, 0.5);
    let inertia = height * height * height / 12.0;
    let scale = load / (6.0 * young * inertia);
    let exact = move |x: &[f64; 2]| {
        let (rest, square) = (length - x[0], 0.25 * height * height);
        [
            scale * x[1] * ((6.0 * length - 3.0 * x[0]) * x[0] + (2.0 + nu) * (x[1] * x[1] - square)),
            -scale
                * (3.0 * nu * x[1] * x[1] * rest
                    + (4.0 + 5.0 * nu) * square * x[0]
                    + (3.0 * length - x[0]) * x[0] * x[0]),
        ]
    };
    let lower = [0.0, -0.5 * height];
    let upper = [length, 0.5 * height];
    let mesh = BoxMesh { lower, upper, cells: [4, 2], order: 4, curving: Curving::None, periodic: [false; 2] };
    let mesh = mesh.build().unwrap();
    let shear = move |y: f64| -load / (2.0 * inertia) * (0.25 * height * height - y * y);
    let end = traction(&mesh, "right", Box::new(move |point, _| [0.0, shear(point.position[1])]));
    let material = Material::new(young, nu).unwrap().in_plane(Plane::Stress);
    let body = structure(mesh, material, 1.0, |name| [name == "left"; 2]);
    let (statics, d) = equilibrium(body, Loads { body_force: None, tractions: vec![end], ..Default::default() }, exact);
    let (error, tip) = (error_at_nodes(statics.structure(), &d, exact), exact(&[length, 0.0])[1]);
    println!("Timoshenko's cantilever: tip {tip:.6}, error {error:.1e}");
    assert!(error < 1e-11 * tip.abs(), "{error:e} of {tip}");
}

/// E(x) and nu(x), from -0.1 to 0.4.
fn constants<T: Transcendental, const D: usize>(x: &[T; D]) -> [T; 2] {
    [(x[0] - x[D - 1] * 0.5).sin() * 0.5 + 2.0, (x[0] * 2.0 + x[1]).cos() * 0.25 + 0.15]
}

/// The stress at `x`, by the formulas of a textbook.
fn stress<T: Transcendental, const D: usize>(x: &[T; D], gradient: &[[T; D]; D], plane: Plane) -> [[T; D]; D] {
    let [e, nu] = constants(x);
    let one = nu * 0.0 + 1.0;
    let mu = e * 0.5 / (one + nu);
    let factor = if plane == Plane::Stress { 1.0 } else { 2.0 };
    let lambda = mu * nu * 2.0 / (one - nu * factor);
    let mut trace = gradient[0][0];
    (1..D).for_each(|i| trace += gradient[i][i]);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let shear = (gradient[i][j] + gradient[j][i]) * mu;
            if i == j { shear + trace * lambda } else { shear }
        })
    })
}

/// The error at the nodes with `cells` cells per direction of order `order`.
fn solution_error<const D: usize>(cells: usize, order: usize, plane: Plane) -> f64 {
    let curving = Curving::Wavy { amplitude: 0.02 };
    let mesh = BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [cells; D], order, curving, periodic: [false; D] };
    let mesh = mesh.build().unwrap();
    let young = MaterialProperty::Field(Arc::new(|x: &[f64; D]| constants(x)[0]));
    let poisson = MaterialProperty::Field(Arc::new(|x: &[f64; D]| constants(x)[1]));
    let numbering = NodeNumbering::new(&mesh, order);
    let mut fixed = vec![[false; D]; numbering.count];
    (0..2 * D).flat_map(|boundary| numbering.on_boundary(&mesh, boundary)).for_each(|node| fixed[node] = [true; D]);
    let body = Structure::new(mesh, numbering, Solid { young, poisson, plane, law: Law::Linear }, 1.0, fixed).unwrap();
    let loads = Loads {
        body_force: Some(Box::new(move |x, _| body_force(x, |x, gradient| stress(x, gradient, plane)))),
        tractions: Vec::new(),
        ..Default::default()
    };
    let (statics, d) = equilibrium(body, loads, displacement);
    error_at_nodes(statics.structure(), &d, displacement)
}

fn assert_order<const D: usize>(order: usize, cells: [usize; 2], plane: Plane) {
    let [coarse, fine] = cells.map(|cells| solution_error::<D>(cells, order, plane));
    let found = (coarse / fine).ln() / (cells[1] as f64 / cells[0] as f64).ln();
    println!("D = {D}, {plane:?}, N = {order}: errors {coarse:.1e}, {fine:.1e}, order {found:.2}");
    assert!(found >= order as f64 - 0.2, "D = {D}, {plane:?}, N = {order}: order {found:.2}");
}

/// Poisson's ratio and Young's modulus vary: the error falls like h^N.
#[test]
fn varying_constants_converge_with_order_n() {
    for plane in [Plane::Strain, Plane::Stress] {
        for (order, cells) in [(2, [12, 24]), (3, [8, 16]), (4, [6, 12]), (5, [4, 8])] {
            assert_order::<2>(order, cells, plane);
        }
    }
    for (order, cells) in [(2, [6, 12]), (3, [4, 8]), (4, [3, 5])] {
        assert_order::<3>(order, cells, Plane::Strain);
    }
}

/// The work of a growing load equals the strain energy; so does the work of a moving support.
#[test]
fn works_of_load_steps_are_the_strain_energy() {
    let mesh = box_mesh([2.0, 1.0], [3, 2], 3, 0.03);
    let pulled = traction(&mesh, "right", Box::new(|_, t| [0.1 * t * t, 0.02 * t]));
    let body = structure(mesh, Material::new(3.0, 0.3).unwrap(), 1.0, |name| [name == "left"; 2]);
    let statics =
        Statics::new(body, Loads { body_force: None, tractions: vec![pulled], ..Default::default() }, 3).unwrap();
    let (length, dt) = (statics.structure().length(), 0.5);
    let mut d = vec![0.0; length];
    let mut balance = 0.0;
    for slab in 0..4 {
        let mut v = d.repeat(3);
        for (a, node) in v.chunks_exact_mut(length).enumerate() {
            let t = dt * (slab as f64 + statics.motion().time().nodes()[a]);
            let entries = node.iter_mut().zip(statics.structure().fixed()).enumerate();
            entries
                .filter(|(_, (_, fixed))| **fixed)
                .for_each(|(i, (d, _))| *d = if i % 2 == 0 { -0.01 * t } else { 0.0 });
        }
        let bottom = d.clone();
        let report = statics.solve(slab as f64 * dt, dt, &bottom, &mut v).unwrap();
        statics.motion().displacement(dt, &bottom, &v, 1.0, &mut d);
        assert!(report.work.support != 0.0 && report.work.load > 0.0);
        balance += report.work.load + report.work.support - report.work.dissipation;
    }
    let energy = statics.structure().strain_energy(&d);
    assert!((balance / energy - 1.0).abs() < 1e-11, "{balance:e} of {energy:e}");
}

/// The same material as constants and as formulas: the same forces to round-off.
#[test]
fn formulas_of_constants_are_the_constants() {
    let field = |value: f64| MaterialProperty::<2>::Field(Arc::new(move |_| value));
    let uniform = Solid::from(Material::new(7.0, 0.3).unwrap());
    let formulas = Solid { young: field(7.0), poisson: field(0.3), plane: Plane::Strain, law: Law::Linear };
    let forces = |solid: Solid<2>| {
        let mesh = box_mesh([2.0, 1.0], [3, 2], 4, 0.04);
        let numbering = NodeNumbering::new(&mesh, 4);
        let fixed = vec![[false; 2]; numbering.count];
        let body = Structure::new(mesh, numbering, solid, 1.0, fixed).unwrap();
        let d: Vec<f64> = body.coordinates().iter().flat_map(displacement).collect();
        let mut forces = vec![0.0; d.len()];
        body.apply_stiffness(&d, &mut forces);
        forces
    };
    let (one, other) = (forces(uniform), forces(formulas));
    let largest = one.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    assert!(one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-13 * largest));
}

/// A body that its supports let move was told of a pivot of its stiffness.
#[test]
fn a_body_that_can_move_is_told_so() {
    let free = |fixed: [bool; 2]| {
        let body = structure(box_mesh([1.0, 0.1], [4, 1], 4, 0.0), Material::new(1000.0, 0.3).unwrap(), 1.0, |_| fixed);
        Statics::new(body, Loads::default(), 1).err()
    };
    assert_eq!(free([false; 2]), Some(ElasticityError::RigidMotion));
    assert_eq!(free([true, false]), Some(ElasticityError::RigidMotion));
    assert_eq!(free([true; 2]), None);
}

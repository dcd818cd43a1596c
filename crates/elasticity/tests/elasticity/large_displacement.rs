//! Bodies that are bent, turned and blown up far: St. Venant-Kirchhoff and neo-Hookean laws, follower pressure, damping.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::{Run, box_mesh, structure};
use elasticity::{Damping, Law, Loads, Material, SlabBottom, SlabMotion, Statics, Structure, StructureSlab};

const LAWS: [Law; 2] = [Law::StVenantKirchhoff, Law::NeoHookean];

fn material(law: Law) -> Material {
    Material::new(2.0, 0.3).unwrap().with_law(law)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// A displacement that is smooth, large and admissible.
fn bent(x: &[f64; 2]) -> [f64; 2] {
    [0.2 * (2.0 * x[1]).sin() + 0.1 * x[0] * x[0], 0.3 * x[0] - 0.2 * x[0] * x[1]]
}

fn nodal<const D: usize>(structure: &Structure<D>, field: impl Fn(&[f64; D]) -> [f64; D]) -> Vec<f64> {
    structure.coordinates().iter().flat_map(field).collect()
}

/// Something uneven at every entry.
fn uneven(length: usize, phase: f64) -> Vec<f64> {
    (0..length).map(|i| (1.7 * i as f64 + phase).sin()).collect()
}

/// A pressure on the last side of a box, and nothing else.
fn blown(structure: &Structure<2>) -> Loads<2> {
    let top = structure.mesh().boundary_names().iter().position(|name| name == "top").unwrap();
    Loads { pressures: vec![(top, Box::new(|x, t| 0.3 + 0.1 * x[0] + t))], ..Default::default() }
}

/// The derivative of forces, pressure and damping is that of the residual of a slab, the derivative of the energy the forces.
#[test]
fn stiffness_is_the_derivative_of_forces_and_forces_that_of_the_energy() {
    for law in LAWS {
        let damping = Damping { mass: 0.4, stiffness: 0.1 };
        let body = structure(box_mesh([1.0, 0.5], [3, 2], 4, 0.02), material(law), 1.3, |name| [name == "left"; 2]);
        let body = body.with_damping(damping);
        let (loads, motion) = (blown(&body), SlabMotion::new(basis::RadauTime::new(2)));
        let (displacement, velocity) = (nodal(&body, bent), nodal(&body, |x| [x[1], -x[0]]));
        let bottom = SlabBottom { time: 0.0, displacement: &displacement, velocity: &velocity };
        let slab = StructureSlab {
            structure: &body,
            loads: &loads,
            motion: &motion,
            bottom,
            dt: 0.1,
            clock: fem::Clock::running(0.0, 0.1),
        };
        let forces = slab.forces().unwrap();
        let (v, w) = (uneven(2 * body.length(), 0.3), uneven(2 * body.length(), 1.0));
        let v: Vec<f64> = v.iter().map(|v| 0.02 * v).collect();
        let at = |a: f64| {
            let (moved, mut r) = (v.iter().zip(&w).map(|(v, w)| v + a * w).collect::<Vec<_>>(), vec![0.0; v.len()]);
            slab.residual(&forces, &moved, &mut r).unwrap();
            r
        };
        let difference: Vec<f64> = at(1e-5).iter().zip(at(-1e-5)).map(|(plus, minus)| (plus - minus) / 2e-5).collect();
        let mut product = vec![0.0; v.len()];
        slab.product(&v, &w, &mut product);
        let error = distance(&product, &difference) / largest(&product);
        assert!(error < 1e-7, "{law:?}: {error:e}");

        let (w, mut forces) = (&w[..body.length()], vec![0.0; body.length()]);
        body.internal_forces(&displacement, &mut forces).unwrap();
        let energy = |a: f64| {
            let moved: Vec<f64> = displacement.iter().zip(w).map(|(d, w)| d + a * w).collect();
            body.strain_energy(&moved)
        };
        let power: f64 = forces.iter().zip(w).map(|(f, w)| f * w).sum();
        let error = ((energy(1e-6) - energy(-1e-6)) / 2e-6 - power).abs() / power.abs();
        assert!(error < 1e-7, "{law:?}: {error:e}");
    }
}

/// A body that is stretched and turned as a whole is in equilibrium inside; turned by 90 degrees alone it has no stress.
#[test]
fn patch_test_and_rotation() {
    for law in LAWS {
        let body = structure(box_mesh([1.0, 0.5], [3, 2], 4, 0.02), material(law), 1.0, |_| [true; 2]);
        let inside = |d: &[f64]| {
            let mut forces = vec![0.0; d.len()];
            body.internal_forces(d, &mut forces).unwrap();
            let on_boundary = body.fixed();
            let largest_of = |fixed: bool| {
                let entries = forces.iter().zip(on_boundary).filter(|(_, on)| **on == fixed);
                entries.fold(0.0, |m: f64, (f, _)| m.max(f.abs()))
            };
            [largest_of(false), largest_of(true)]
        };
        let affine = nodal(&body, |x| [0.3 * x[0] - 0.7 * x[1], 0.9 * x[0] + 0.4 * x[1]]);
        let [within, around] = inside(&affine);
        assert!(around > 0.01 && within < 1e-13, "{law:?}: {within:e}, {around:e}");
        let turned = nodal(&body, |x| [-x[1] - x[0] + 3.0, x[0] - x[1] - 2.0]);
        let [within, around] = inside(&turned);
        assert!(within.max(around) < 1e-13, "{law:?}: {within:e}, {around:e}");
        assert!(body.strain_energy(&turned).abs() < 1e-15);
    }
}

/// The tip of the flag of Turek and Hron under gravity along -y, clamped at its left end: 0.35 x 0.02, rho_s = 1000, nu = 0.4, plane
/// strain, g = 2. Its load grows in `steps`. Returns the displacement of the middle of the right end, in millimetres.
fn flag(young: f64, cells: [usize; 2], order: usize, steps: usize) -> [f64; 2] {
    let material = Material::new(young, 0.4).unwrap().with_law(Law::StVenantKirchhoff);
    let body = structure(box_mesh([0.35, 0.02], cells, order, 0.0), material, 1000.0, |name| [name == "left"; 2]);
    let tip = body.coordinates().iter().position(|x| (x[0] - 0.35).hypot(x[1] - 0.01) < 1e-9).unwrap();
    let loads = Loads { body_force: Some(Box::new(|_, t| [0.0, -2000.0 * t])), ..Default::default() };
    let mut d = vec![0.0; body.length()];
    let statics = Statics::new(body, loads, 1).unwrap();
    for step in 1..=steps {
        let iterations = statics.equilibrium(step as f64 / steps as f64, &mut d).unwrap();
        println!("step {step}: {iterations} iterations, {:.4} {:.4}", d[2 * tip] * 1e3, d[2 * tip + 1] * 1e3);
    }
    [d[2 * tip] * 1e3, d[2 * tip + 1] * 1e3]
}

/// CSM1 and CSM2 of Turek and Hron: -7.188, -66.10 mm and -0.4690, -16.974 mm for the flag behind the cylinder, whose clamped end is an
/// arc; the box is clamped at a straight end.
#[test]
#[ignore = "these meshes differ by 5e-3: the corners of the clamp converge slowly"]
fn a_flag_under_gravity() {
    for (young, steps, published) in [(1.4e6, 4, [-7.188, -66.10]), (5.6e6, 1, [-0.4690, -16.974])] {
        let [coarse, fine] = [flag(young, [20, 2], 4, steps), flag(young, [40, 3], 5, steps)];
        println!("E = {young:e}: {coarse:?}, {fine:?}, published {published:?}");
        for i in 0..2 {
            assert!((coarse[i] / fine[i] - 1.0).abs() < 2e-3, "{coarse:?}, {fine:?}");
            assert!((fine[i] / published[i] - 1.0).abs() < 2e-2, "{fine:?}, {published:?}");
        }
    }
}

/// A support that moved by just the length of a cell was "done" far from equilibrium. The guess moves the support alone: the volume vanishes there,
/// and forces of 1e17 were the measure of the residual. A bar without lateral contraction is stretched evenly.
#[test]
fn a_support_that_moves_by_a_cell_finds_the_equilibrium() {
    for moved in [0.499, 0.5, 0.51, 1.0] {
        let material = Material::new(1000.0, 0.0).unwrap().with_law(Law::NeoHookean);
        let held = |name: &str| [["left", "right"].contains(&name); 2];
        let body = structure(box_mesh([2.0, 0.5], [4, 1], 3, 0.0), material, 1.0, held);
        let right = |x: &[f64; 2]| if x[0] > 2.0 - 1e-9 { [moved, 0.0] } else { [0.0; 2] };
        let mut d = nodal(&body, right);
        let exact = nodal(&body, |x| [0.5 * moved * x[0], 0.0]);
        let statics = Statics::new(body, Loads::default(), 1).unwrap();
        statics.equilibrium(0.0, &mut d).unwrap();
        assert!(distance(&d, &exact) < 1e-9, "{moved}: {:e}", distance(&d, &exact));
        let stretch: f64 = 1.0 + 0.5 * moved;
        let energy = 250.0 * (stretch * stretch - 1.0 - 2.0 * stretch.ln());
        assert!((statics.structure().strain_energy(&d) - energy).abs() < 1e-9 * energy, "{moved}");
    }
}

/// A rubber block that spins, stretched, and is damped or not: the book of the energy closes in every slab, and what the jumps take
/// vanishes with the order of the method.
#[test]
fn energy_of_a_spinning_block() {
    for law in LAWS {
        for damping in [Damping::default(), Damping { mass: 0.1, stiffness: 0.05 }] {
            let taken = |dt: f64, slabs: usize| {
                let body = structure(box_mesh([1.0, 0.5], [2, 1], 4, 0.0), material(law), 1.0, |_| [false; 2]);
                let spin = |x: &[f64; 2]| [-1.5 * (x[1] - 0.25) + 0.1 * x[0], 1.5 * (x[0] - 0.5)];
                let mut run = Run::new(body.with_damping(damping), Loads::default(), 2, dt).start(|_| [0.0; 2], spin);
                let (start, mut sum) = (run.energy(), 0.0);
                for _ in 0..slabs {
                    let before = run.energy();
                    let work = run.advance(dt, |_, _| [0.0; 2]).work;
                    let error = (run.energy() - before + work.damped + work.dissipation).abs();
                    assert!(error < 1e-12 * start, "{law:?}, {damping:?}: {error:e} of {start:e}");
                    assert!(work.damped >= 0.0);
                    sum += work.dissipation;
                }
                sum / start
            };
            let (coarse, fine) = (taken(0.05, 16), taken(0.025, 32));
            let order = (coarse / fine).log2();
            println!("{law:?}, {damping:?}: {coarse:.2e}, {fine:.2e} of the energy, order {order:.2}");
            assert!(fine > 0.0 && order > 2.6, "{law:?}: {coarse:e}, {fine:e}");
        }
    }
}

/// A ring segment blown up by a follower pressure in steps keeps in balance with it: the work of the pressure is the strain energy but for
/// what steps of load leave.
#[test]
fn a_follower_pressure_inflates() {
    let body = structure(box_mesh([1.0, 0.2], [4, 1], 4, 0.0), material(Law::NeoHookean), 1.0, |name| {
        [name == "left" || name == "right"; 2]
    });
    let bottom = body.mesh().boundary_names().iter().position(|name| name == "bottom").unwrap();
    let loads = Loads { pressures: vec![(bottom, Box::new(|_, t| 0.2 * t))], ..Default::default() };
    let middle = body.coordinates().iter().position(|x| (x[0] - 0.5).hypot(x[1]) < 1e-9).unwrap();
    let statics = Statics::new(body, loads, 3).unwrap();
    let (mut d, mut book, slabs) = (vec![0.0; statics.structure().length()], 0.0, 4);
    let dt = 1.0 / slabs as f64;
    for slab in 0..slabs {
        let mut v = d.repeat(3);
        let report = statics.solve(slab as f64 * dt, dt, &d, &mut v).unwrap();
        let bottom = d.clone();
        statics.motion().displacement_at_node(dt, &bottom, &v, 2, &mut d);
        book += report.work.load - report.work.dissipation;
    }
    let energy = statics.structure().strain_energy(&d);
    println!("the middle rises by {:.4}, energy {energy:.6e}, book {:.1e}", d[2 * middle + 1], book / energy - 1.0);
    assert!(d[2 * middle + 1] > 0.1);
    assert!((book / energy - 1.0).abs() < 1e-9);
}

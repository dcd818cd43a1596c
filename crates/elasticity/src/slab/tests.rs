#![allow(clippy::unwrap_used)]
use super::*;
use crate::Stiffness;
use crate::testing::{clamped, distance, largest, nodal, noise, unit_box};

fn elastic() -> ElasticMesh<2> {
    clamped(&unit_box([4, 3], 4, 0.03), 4, Stiffness::InverseJacobian { power: 1.0 })
}

/// The boundary is stretched and sheared by g(t) = sin(t) shape.
fn prescribed(elastic: &ElasticMesh<2>, times: &[f64]) -> Vec<f64> {
    let shape = nodal(elastic, |x| [0.1 * x[0] * x[1], 0.1 * x[1].sin()]);
    times.iter().flat_map(|t| shape.iter().map(|g| t.sin() * g).collect::<Vec<_>>()).collect()
}

fn motion(order: usize) -> SlabMotion {
    SlabMotion::new(RadauTime::new(order))
}

#[test]
fn velocities_and_displacements_are_inverse() {
    let (length, dt) = (7, 0.3);
    let bottom = noise(length);
    for order in 1..=5 {
        let motion = motion(order);
        let displacements = noise(order * length);
        let mut v = displacements.clone();
        motion.velocities(dt, &bottom, &mut v);
        let mut d = vec![0.0; length];
        for (a, expected) in displacements.chunks_exact(length).enumerate() {
            motion.displacement_at_node(dt, &bottom, &v, a, &mut d);
            assert!(distance(&d, expected) < 1e-13);
            motion.displacement(dt, &bottom, &v, motion.time().nodes()[a], &mut d);
            assert!(distance(&d, expected) < 1e-13);
        }
        motion.displacement(dt, &bottom, &v, 0.0, &mut d);
        assert_eq!(d, bottom);
    }
}

/// A displacement of degree N_t in time is exact, and its velocity is its derivative.
#[test]
fn polynomial_motion_is_exact() {
    let (t_n, dt, order) = (0.4, 0.25, 3);
    let (position, velocity) = (|t: f64| t.powi(3) - 2.0 * t, |t: f64| 3.0 * t * t - 2.0);
    let motion = motion(order);
    let time = |s: f64| t_n + s * dt;
    let mut v: Vec<f64> = motion.time().nodes().iter().map(|&s| position(time(s))).collect();
    motion.velocities(dt, &[position(t_n)], &mut v);
    for (v, s) in v.iter().zip(motion.time().nodes()) {
        assert!((v - velocity(time(*s))).abs() < 1e-13);
    }
    for s in [0.1, 0.5, 0.9] {
        let mut d = [0.0];
        motion.displacement(dt, &[position(t_n)], &v, s, &mut d);
        assert!((d[0] - position(time(s))).abs() < 1e-13);
    }
}

/// Inside the slab the displacement has order N_t + 1; at its top it is exact.
#[test]
fn motion_has_order_one_more_than_its_nodes() {
    let error = |order: usize, dt: f64| {
        let motion = motion(order);
        let mut v: Vec<f64> = motion.time().nodes().iter().map(|s| (1.0 + s * dt).sin()).collect();
        motion.velocities(dt, &[1_f64.sin()], &mut v);
        let mut d = [0.0];
        motion.displacement(dt, &[1_f64.sin()], &v, 1.0, &mut d);
        assert!((d[0] - (1.0 + dt).sin()).abs() < 1e-15);
        let at = |s: f64| {
            let mut d = [0.0];
            motion.displacement(dt, &[1_f64.sin()], &v, s, &mut d);
            (d[0] - (1.0 + s * dt).sin()).abs()
        };
        (1..40).map(|i| at(i as f64 / 40.0)).fold(0.0, f64::max)
    };
    for order in 1..=4 {
        let found = (error(order, 0.1) / error(order, 0.05)).log2();
        assert!(found > order as f64 + 0.8, "N_t = {order}: order {found}");
    }
}

/// R is affine in V, so one exact solve from any V gives R = 0. The boundary is at its prescribed position at every node,
/// including the top.
#[test]
fn one_solve_reaches_equilibrium_at_every_node() {
    let elastic = elastic();
    for order in [1, 2, 3] {
        let motion = motion(order);
        let slab = ElasticSlab { mesh: &elastic, motion: &motion, dt: 0.2 };
        let times: Vec<f64> = motion.time().nodes().iter().map(|s| 1.0 + 0.2 * s).collect();
        let (g, bottom) = (prescribed(&elastic, &times), noise(elastic.length()));
        let mut v = noise(order * elastic.length());
        let (mut r, mut dv) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        slab.residual(&bottom, &g, &v, &mut r).unwrap();
        let start = largest(&r);
        slab.solve(&r, &mut dv, 1e-13).unwrap();
        v.iter_mut().zip(&dv).for_each(|(v, dv)| *v -= dv);
        slab.residual(&bottom, &g, &v, &mut r).unwrap();
        assert!(largest(&r) < 1e-11 * start, "N_t = {order}: {:e}", largest(&r) / start);
        let (mut top, mut extended) = (vec![0.0; elastic.length()], g[(order - 1) * elastic.length()..].to_vec());
        slab.motion.displacement(slab.dt, &bottom, &v, 1.0, &mut top);
        elastic.extend(&mut extended, 1e-13).unwrap();
        assert!(distance(&top, &extended) < 1e-11);
    }
}

#[test]
fn jacobian_is_the_difference_of_residuals() {
    let elastic = elastic();
    let motion = motion(3);
    let slab = ElasticSlab { mesh: &elastic, motion: &motion, dt: 0.1 };
    let (g, bottom) = (prescribed(&elastic, &[0.1, 0.2, 0.3]), noise(elastic.length()));
    let v = noise(g.len());
    let w: Vec<f64> = v.iter().map(|v| v * v).collect();
    let both: Vec<f64> = v.iter().zip(&w).map(|(v, w)| v + w).collect();
    let (mut at_v, mut at_both, mut product) = (vec![0.0; v.len()], vec![0.0; v.len()], vec![0.0; v.len()]);
    slab.residual(&bottom, &g, &v, &mut at_v).unwrap();
    slab.residual(&bottom, &g, &both, &mut at_both).unwrap();
    slab.jacobian_product(&bottom, &v, &w, &mut product);
    let difference: Vec<f64> = at_both.iter().zip(&at_v).map(|(a, b)| a - b).collect();
    assert!(distance(&product, &difference) < 1e-13 * largest(&at_both));
    let mut back = vec![0.0; v.len()];
    slab.solve(&product, &mut back, 1e-13).unwrap();
    assert!(distance(&back, &w) < 1e-9 * largest(&w));
}

/// With every slab solved to 1e-4 only, the distance of the top from equilibrium does not grow over 100 slabs.
#[test]
fn errors_of_a_loose_solver_do_not_accumulate() {
    let elastic = elastic();
    let motion = motion(2);
    let slab = ElasticSlab { mesh: &elastic, motion: &motion, dt: 0.1 };
    let mut bottom = vec![0.0; elastic.length()];
    let (mut v, mut r, mut dv) =
        (vec![0.0; 2 * bottom.len()], vec![0.0; 2 * bottom.len()], vec![0.0; 2 * bottom.len()]);
    let mut errors = Vec::new();
    for n in 0..100 {
        let times: Vec<f64> = motion.time().nodes().iter().map(|s| (n as f64 + s) * slab.dt).collect();
        let g = prescribed(&elastic, &times);
        slab.residual(&bottom, &g, &v, &mut r).unwrap();
        slab.solve(&r, &mut dv, 1e-4).unwrap();
        v.iter_mut().zip(&dv).for_each(|(v, dv)| *v -= dv);
        let mut top = vec![0.0; bottom.len()];
        motion.displacement(slab.dt, &bottom, &v, 1.0, &mut top);
        let mut exact = g[bottom.len()..].to_vec();
        elastic.extend(&mut exact, 1e-12).unwrap();
        errors.push(distance(&top, &exact));
        bottom = top;
    }
    let worst = |errors: &[f64]| errors.iter().fold(0.0, |m: f64, e| m.max(*e));
    assert!(worst(&errors[50..]) < 2.0 * worst(&errors[..50]), "{errors:?}");
    assert!(worst(&errors) < 1e-4);
}

/// The velocities and the displacement at the top of `motion` in a slab from `t` that follows g.
fn followed(motion: &SlabMotion, t: f64, dt: f64, g: impl Fn(f64) -> f64) -> (Vec<f64>, f64) {
    let positions = motion.times_of_prescribed().iter().map(|s| g(t + s * dt)).collect();
    let v = motion.prescribed(dt, &[g(t)], positions);
    let mut top = [0.0];
    motion.displacement(dt, &[g(t)], &v, 1.0, &mut top);
    (v, top[0])
}

/// The velocity at the top has order N_t + 1, the displacement there no error.
#[test]
fn prescribed_velocities_have_one_order_more_at_the_top() {
    for order in 1..=6 {
        let motion = motion(order);
        let error = |dt: f64| {
            let (v, top) = followed(&motion, 1.0, dt, f64::sin);
            assert!((top - (1.0 + dt).sin()).abs() < 1e-15);
            (v[order - 1] - (1.0 + dt).cos()).abs()
        };
        let found = (error(0.8) / error(0.4)).log2();
        let least = if order == 1 { 1.0 } else { order as f64 + 1.0 };
        assert!(found > least - 0.3, "N_t = {order}: order {found}");
    }
}

/// Rates of g itself would be infinite or very large at a node.
#[test]
fn a_prescribed_displacement_may_be_steep_or_bend() {
    for order in 1..=6 {
        let (motion, bound) = (motion(order), ((order + 2) * (order + 2)) as f64);
        for steep in [1e2, 1e6] {
            for place in motion.time().nodes() {
                let (v, top) = followed(&motion, 0.0, 1.0, |t| (steep * (t - place)).tanh());
                assert!((top - (steep * (1.0 - place)).tanh()).abs() < 1e-13);
                let most = v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                assert!(most < bound, "N_t = {order}: {most} at {place}");
            }
        }
        let (v, _) = followed(&motion, 0.0, 1.0, |t| -(1.0 - t).sqrt());
        assert!(v.iter().all(|v| v.abs() < bound), "{v:?}");
        // A bend at the end of a slab belongs to the next one, also if rounding moves it.
        let (v, _) = followed(&motion, 0.0, 1.0, |t| (t - 1.0 + 1e-9).max(0.0));
        assert!(v.iter().all(|v| v.abs() < 1e-7), "{v:?}");
    }
}

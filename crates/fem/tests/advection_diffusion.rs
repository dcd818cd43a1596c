//! A scalar law as a user of the framework: the order of its solutions, its balance, and its Jacobian on a curved mesh that moves.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod scalar;

use fem::{Bottom, PointFamily, Quadrature, SlabEnd, StateField, left_during_slab, squared_errors};
use newton_krylov::fgmres;
use newton_krylov::inner_product::Euclidean;
use newton_krylov::operator::{Identity, LinearOperator, Preconditioned};
use scalar::{DecayingWave, Operator, interpolated, operator, set_motion};

/// The rules that conserve.
const RULES: [Quadrature; 3] =
    [Quadrature::Conserving, Quadrature::Collocated(PointFamily::Gauss), Quadrature::Collocated(PointFamily::Lobatto)];

/// A in R(u) = R(0) + A u.
struct Jacobian<'a>(&'a mut Operator);

impl LinearOperator for Jacobian<'_> {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.0.product(x, y);
    }
}

/// The solution of R(u) = 0: the law is linear, so one linear solve finds it.
fn solve(operator: &mut Operator) -> Vec<f64> {
    let mut u = vec![0.0; operator.layout.len()];
    let mut residual = u.clone();
    operator.residual(&u, &mut residual).unwrap();
    residual.iter_mut().for_each(|r| *r = -*r);
    let settings = fgmres::Settings {
        relative_tolerance: 1e-11,
        restart: 400,
        max_iterations: 1200,
        ..fgmres::Settings::default()
    };
    let (jacobian, preconditioner, inner_product) = (&mut Jacobian(operator), &mut Identity, &Euclidean);
    let mut system = Preconditioned { operator: jacobian, preconditioner, inner_product };
    fgmres::solve(&mut system, &residual, &mut u, &settings, &mut fgmres::Workspace::default()).unwrap();
    u
}

/// The L2 error after a few slabs on `cells` x `cells` cells.
fn error(order: usize, cells: usize, quadrature: Quadrature) -> f64 {
    const DT: f64 = 0.02;
    let mut operator = operator(order, cells, quadrature);
    let mut bottom = interpolated(&operator, 0.0);
    let (mut displacement, mut determinants) = (vec![0.0; operator.mesh.field_len()], Vec::new());
    for slab in 0..3 {
        operator.begin_slab(
            slab as f64 * DT,
            DT,
            Bottom { state: &bottom, displacement: &displacement, determinants: &determinants },
        );
        displacement = set_motion(&mut operator, &displacement);
        let u = solve(&mut operator);
        bottom = scalar::at_top(&operator, &u);
        determinants = operator.determinants_at_top().to_vec();
    }
    squared_errors(&operator, &bottom, operator.top_row().row(0), &DecayingWave, 3.0 * DT)[0].sqrt()
}

#[test]
fn the_error_falls_with_the_order_of_the_space() {
    for (order, quadrature) in (2..=4).flat_map(|order| RULES.map(|rule| (order, rule))) {
        let [coarse, fine] = [6, 12].map(|cells| error(order, cells, quadrature));
        let measured = (coarse / fine).log2();
        println!("{quadrature:?}, N_s = {order}: errors {coarse:.2e}, {fine:.2e}, order {measured:.2}");
        // Gauss-Lobatto points do not integrate the mass matrix.
        let missing = if quadrature == Quadrature::Collocated(PointFamily::Lobatto) { 0.4 } else { 0.2 };
        assert!(
            measured >= order as f64 - missing,
            "N_s = {order}: errors {coarse:.2e}, {fine:.2e}, order {measured:.2}"
        );
    }
}

/// A slab with a state that solves nothing.
fn perturbed_slab(order: usize, quadrature: Quadrature) -> (Operator, Vec<f64>) {
    let mut operator = operator(order, 3, quadrature);
    let bottom = interpolated(&operator, 0.3);
    let at_rest = vec![0.0; operator.mesh.field_len()];
    operator.begin_slab(0.3, 0.1, Bottom::new(&bottom, &at_rest));
    set_motion(&mut operator, &at_rest);
    let n = operator.layout.len();
    (operator, scalar::waves(n, 0.4).iter().map(|w| 2.0 + 0.1 * w).collect())
}

/// Test functions sum to one: all residuals together are what there is more at the top than at the bottom, and what has left.
#[test]
fn what_the_residuals_sum_to_is_the_balance() {
    for (order, quadrature) in (2..=4).flat_map(|order| RULES.map(|rule| (order, rule))) {
        let (mut operator, u) = perturbed_slab(order, quadrature);
        let mut residual = vec![0.0; u.len()];
        operator.residual(&u, &mut residual).unwrap();
        let bottom = scalar::total(&operator, &interpolated(&operator, 0.3), SlabEnd::Bottom);
        let top = scalar::total(&operator, &scalar::at_top(&operator, &u), SlabEnd::Top);
        let [left] = left_during_slab(&operator.boundary_fluxes(None));
        let error = (residual.iter().sum::<f64>() - (top - bottom + left)).abs() / bottom;
        assert!(
            left.abs() > 1e-3 && error < 1e-13,
            "{quadrature:?}, N_s = {order}: {left:.1e} left, error {error:.1e}"
        );
    }
}

/// Along a direction of the state, and along one of state and mesh, against central differences.
#[test]
fn products_with_the_jacobian_are_differences_of_the_residual() {
    RULES.into_iter().for_each(assert_products);
}

fn assert_products(quadrature: Quadrature) {
    const STEP: f64 = 1e-5;
    let (mut operator, u) = perturbed_slab(3, quadrature);
    let velocities = scalar::velocities(&operator);
    let (along_u, along_v) = (scalar::waves(u.len(), 0.9), scalar::waves(velocities.len(), 0.2));
    for moving in [0.0, 1.0] {
        let mut residual_at = |step: f64| {
            let moved = |x: &[f64], along: &[f64], step: f64| -> Vec<f64> {
                x.iter().zip(along).map(|(x, along)| x + step * along).collect()
            };
            let mut residual = vec![0.0; u.len()];
            operator.set_mesh(&moved(&velocities, &along_v, moving * step));
            operator.residual(&moved(&u, &along_u, step), &mut residual).unwrap();
            residual
        };
        let (ahead, behind) = (residual_at(STEP), residual_at(-STEP));
        residual_at(0.0);
        let mut product = vec![0.0; u.len()];
        let direction: Vec<f64> = along_v.iter().map(|v| moving * v).collect();
        operator.product_with_mesh(&along_u, &direction, &mut product);
        let difference = |i: usize| (ahead[i] - behind[i]) / (2.0 * STEP) - product[i];
        let largest = product.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
        let error = (0..u.len()).fold(0.0, |m: f64, i| m.max(difference(i).abs())) / largest;
        assert!(error < 1e-7, "{quadrature:?}, mesh direction times {moving}: {error:.1e}");
        let mut on_fixed_mesh = product.clone();
        operator.product(&along_u, &mut on_fixed_mesh);
        let same = on_fixed_mesh.iter().zip(&product).all(|(a, b)| (a - b).abs() < 1e-13 * largest);
        assert_eq!(same, moving == 0.0, "the mesh direction is {moving} times a wave");
    }
}

/// Data of the boundary are those of the exact solution, which varies there.
#[test]
fn the_exact_solution_is_a_field_with_derivatives() {
    let (x, h) = ([0.3, 0.8], 1e-6);
    let dual = DecayingWave.dual(&[tensor::Dual::new(x[0], 1.0), tensor::Dual::new(x[1], 0.0)], 0.2)[0];
    let difference =
        (DecayingWave.value(&[x[0] + h, x[1]], 0.2)[0] - DecayingWave.value(&[x[0] - h, x[1]], 0.2)[0]) / (2.0 * h);
    assert!((dual.derivative - difference).abs() < 1e-8, "{} {difference}", dual.derivative);
}

use super::*;
use crate::testing::material;
use tensor::Dual;

fn neo_hookean() -> NeoHookean {
    NeoHookean(material().lame())
}

fn st_venant_kirchhoff() -> StVenantKirchhoff {
    StVenantKirchhoff(material().lame())
}

fn stress<const D: usize>(gradient: &[[f64; D]; D]) -> [[f64; D]; D] {
    neo_hookean().stress(gradient, gradient).piola
}

fn largest_difference<const D: usize>(a: &[[f64; D]; D], b: &[[f64; D]; D]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

const PLANE: [[f64; 2]; 2] = [[0.3, -0.7], [0.9, 0.4]];
const SPACE: [[f64; 3]; 3] = [[0.3, -0.7, 0.2], [0.9, 0.4, -0.1], [-0.3, 0.5, -0.2]];

fn is_derivative_of_energy<const D: usize>(law: impl Hyperelastic, gradient: &[[f64; D]; D]) {
    let piola = law.stress(gradient, gradient).piola;
    for i in 0..D {
        for j in 0..D {
            let mut dual = gradient.map(|row| row.map(|h| Dual::new(h, 0.0)));
            dual[i][j].derivative = 1.0;
            assert!((piola[i][j] - law.energy(&dual).derivative).abs() < 1e-14, "dual, {i}, {j}");
            let at = |h: f64| {
                let mut moved = *gradient;
                moved[i][j] += h;
                law.energy(&moved)
            };
            let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((piola[i][j] - difference).abs() < 1e-8, "difference, {i}, {j}");
        }
    }
}

#[test]
fn stress_is_the_derivative_of_the_energy() {
    is_derivative_of_energy(neo_hookean(), &PLANE);
    is_derivative_of_energy(neo_hookean(), &SPACE);
    is_derivative_of_energy(st_venant_kirchhoff(), &PLANE);
    is_derivative_of_energy(st_venant_kirchhoff(), &SPACE);
    is_derivative_of_energy(material().lame(), &SPACE);
}

/// W(Q F) = W(F) and P(Q F) = Q P(F): a rotation of any angle costs no energy.
fn does_not_notice_rotations(law: impl Hyperelastic) {
    let rotate = |f: &[[f64; 2]; 2]| -> [[f64; 2]; 2] {
        let (sin, cos) = 2.4_f64.sin_cos();
        let q = [[cos, -sin], [sin, cos]];
        std::array::from_fn(|i| std::array::from_fn(|j| (0..2).map(|k| q[i][k] * f[k][j]).sum()))
    };
    let minus_identity = |mut f: [[f64; 2]; 2]| {
        (0..2).for_each(|i| f[i][i] -= 1.0);
        f
    };
    let stress = |gradient: &[[f64; 2]; 2]| law.stress(gradient, gradient).piola;
    let rotated = minus_identity(rotate(&plus_identity(&PLANE)));
    assert!((law.energy(&rotated) - law.energy(&PLANE)).abs() < 1e-14);
    assert!(largest_difference(&stress(&rotated), &rotate(&stress(&PLANE))) < 1e-14);
    let pure = minus_identity(rotate(&plus_identity(&[[0.0; 2]; 2])));
    assert!(largest_difference(&stress(&pure), &[[0.0; 2]; 2]) < 1e-15);
}

#[test]
fn energy_does_not_notice_rotations() {
    does_not_notice_rotations(neo_hookean());
    does_not_notice_rotations(st_venant_kirchhoff());
}

/// The difference to the linear law falls with the square of the strain.
fn small_strains_are_linear_in(law: impl PointLaw) {
    let difference = |size: f64| {
        let gradient = SPACE.map(|row| row.map(|h| h * size));
        largest_difference(&law.stress(&gradient, &gradient).piola, &Lame::stress(&material().lame(), &gradient))
    };
    let order = (difference(1e-3) / difference(5e-4)).log2();
    assert!((order - 2.0).abs() < 0.01, "order {order}");
}

#[test]
fn small_strains_are_linear() {
    small_strains_are_linear_in(neo_hookean());
    small_strains_are_linear_in(st_venant_kirchhoff());
}

/// A body that spins, H' = W F with a skew W, has no viscous stress, however it is deformed; any other motion loses energy.
#[test]
fn viscous_stress_does_not_notice_spin() {
    let (law, f) = (Viscous(material().lame()), plus_identity(&PLANE));
    let spin = [[-f[1][0], -f[1][1]], f[0]];
    let none = law.stress(&PLANE, &spin).piola;
    assert!(largest_difference(&none, &[[0.0; 2]; 2]) < 1e-15);
    let rate = [[0.4, -0.3], [0.8, 0.1]];
    assert!(contraction(&law.stress(&PLANE, &rate).piola, &rate) > 0.1);
    let at_rest = law.stress(&[[0.0; 2]; 2], &rate).piola;
    assert!(largest_difference(&at_rest, &Lame::stress(&material().lame(), &rate)) < 1e-15);
}

#[test]
fn plane_strain_is_the_law_in_space_without_motion_along_the_third_axis() {
    let space = stress(&[[0.3, -0.7, 0.0], [0.9, 0.4, 0.0], [0.0; 3]]);
    let plane = stress(&PLANE);
    assert!((0..2).all(|i| (0..2).all(|j| (plane[i][j] - space[i][j]).abs() < 1e-15)));
}

#[test]
fn volume_ratio_tells_an_inverted_point() {
    let law = neo_hookean();
    let ratio = |law: NeoHookean, h: [[f64; 2]; 2]| law.stress(&h, &h).volume_ratio;
    assert!((ratio(law, [[1.0, 0.0], [0.0, 0.5]]) - 3.0).abs() < 1e-15);
    assert!(ratio(law, [[-1.5, 0.0], [0.0, 0.5]]) < 0.0);
    let inverted = [[-1.5, 0.0], [0.0, 0.5]];
    assert_eq!(PointLaw::stress(material().lame(), &inverted, &inverted).volume_ratio, 1.0);
}

//! Entropy variables of the gas.
//!
//! ```text
//! S = - rho s / (gamma - 1),   s = ln p - gamma ln rho,   beta = rho / p
//! v = [ gamma / (gamma - 1) + ln rho + ln beta / (gamma - 1) - beta |w|^2 / 2 ; beta w ; -beta ]                 (entropy variables)
//! ```
//!
//! With them v . u - S = rho and v . F_c - F_S = rho w. After Harten, J. Comput. Phys. 49 (1983), and Hughes, Franca & Mallet, Comput. Methods
//! Appl. Mech. Eng. 54 (1986).

use crate::gas::Gas;
use crate::state::{Conserved, Primitive, scaled};
use tensor::{Real, dot};

/// (entropy variables)
#[inline(always)]
pub(crate) fn variables<T: Real, const D: usize, const M: usize>(gas: &Gas, u: &[T; M]) -> [T; M] {
    let Primitive { density, velocity: w, pressure } = Primitive::<T, D>::unpack(gas, u);
    let (beta, internal) = (density / pressure, 1.0 / (gas.gamma() - 1.0));
    let logarithms = density.ln() + beta.ln() * internal + gas.gamma() * internal;
    Conserved { density: logarithms - beta * dot(&w, &w) * 0.5, momentum: scaled(&w, beta), energy: -beta }.pack()
}

/// The gradient of the conserved variables whose entropy variables have the gradient `of_variables`, from the differential of (entropy
/// variables): d beta and dw from the last components, d rho from the first.
#[inline(always)]
pub(crate) fn gradient_of_state<T: Real, const D: usize, const M: usize>(
    gas: &Gas,
    u: &[T; M],
    of_variables: &[[T; M]; D],
) -> [[T; M]; D] {
    let Primitive { density, velocity: w, pressure } = Primitive::<T, D>::unpack(gas, u);
    let (temperature, internal) = (pressure / density, 1.0 / (gas.gamma() - 1.0));
    let (kinetic, mut gradient) = (dot(&w, &w) * 0.5, *of_variables);
    for k in 0..D {
        let of_beta = -of_variables[k][M - 1];
        let mut of_w = w;
        for i in 0..D {
            of_w[i] = (of_variables[k][1 + i] - w[i] * of_beta) * temperature;
        }
        // w . dw
        let work = dot(&w, &of_w);
        let relative = of_beta * temperature;
        let of_density = (of_variables[k][0] - relative * internal + kinetic * of_beta + work / temperature) * density;
        let of_pressure = of_density * temperature - pressure * relative;
        gradient[k][0] = of_density;
        for i in 0..D {
            gradient[k][1 + i] = w[i] * of_density + of_w[i] * density;
        }
        gradient[k][M - 1] = of_pressure * internal + kinetic * of_density + work * density;
    }
    gradient
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::gas::Viscosity;

    fn gas() -> Gas {
        Gas::new(1.4, 0.7, 0.72, Viscosity::Inviscid).unwrap()
    }

    fn entropy(u: &[f64; 5]) -> f64 {
        let Primitive { density, pressure, .. } = Primitive::<f64, 3>::unpack(&gas(), u);
        -density * (pressure.ln() - 1.4 * density.ln()) / 0.4
    }

    fn state() -> [f64; 5] {
        Primitive { density: 1.3, velocity: [0.4, -0.7, 0.2], pressure: 0.9 }.pack(&gas())
    }

    /// Central differences of the entropy and of the variables.
    #[test]
    fn they_are_derivatives_of_the_entropy_and_have_its_inverse_hessian() {
        let (u, h) = (state(), 1e-5);
        let v = variables::<f64, 3, 5>(&gas(), &u);
        for m in 0..5 {
            let moved = |sign: f64| std::array::from_fn(|c| u[c] + if c == m { sign * h } else { 0.0 });
            let slope = (entropy(&moved(1.0)) - entropy(&moved(-1.0))) / (2.0 * h);
            assert!((slope - v[m]).abs() < 1e-8, "{m}: {slope} {}", v[m]);
            let [after, before] = [1.0, -1.0].map(|sign| variables::<f64, 3, 5>(&gas(), &moved(sign)));
            let of_variables = std::array::from_fn(|c| (after[c] - before[c]) / (2.0 * h));
            let found = gradient_of_state(&gas(), &u, &[of_variables; 3]);
            for c in 0..5 {
                let exact = f64::from(c == m);
                assert!((found[1][c] - exact).abs() < 1e-8, "{m}, {c}: {}", found[1][c]);
            }
        }
    }

    #[test]
    fn the_potential_is_density_and_momentum() {
        let u = state();
        let v = variables::<f64, 3, 5>(&gas(), &u);
        let potential = dot(&v, &u) - entropy(&u);
        assert!((potential - u[0]).abs() < 1e-14, "{potential}");
        let flux = crate::flux::inviscid(&gas(), &u, &[0.0; 3]);
        for k in 0..3 {
            let of_entropy = entropy(&u) * u[1 + k] / u[0];
            let potential = dot(&v, &flux[k]) - of_entropy;
            assert!((potential - u[1 + k]).abs() < 1e-13, "{k}: {potential}");
        }
    }
}

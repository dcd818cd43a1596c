//! Invariance under a change of the observer.

use super::*;

/// The state, or the flux, as seen by an observer whom the first observer passes at velocity `boost`:
/// rho, rho w + rho V, rho E + V . rho w + rho |V|^2 / 2.
fn boosted<const D: usize, const M: usize>(u: &[f64; M], boost: &[f64; D]) -> [f64; M] {
    let mut seen = *u;
    seen[M - 1] += 0.5 * u[0] * dot(boost, boost);
    for i in 0..D {
        seen[1 + i] += u[0] * boost[i];
        seen[M - 1] += u[1 + i] * boost[i];
    }
    seen
}

/// Fluxes relative to a moving facet do not depend on a common velocity. (Some conditions do, see [`Conditions::OF_AN_OBSERVER`].)
fn galilean<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let boost: [f64; D] = random.vector(2.0);
        let seen = Point {
            minus: boosted(&p.minus, &boost),
            plus: boosted(&p.plus, &boost),
            gradient: p.gradient.map(|g| boosted(&g, &boost)),
            n: p.n,
            v: std::array::from_fn(|i| p.v[i] + boost[i]),
            data: boosted(&p.data, &boost),
            values: std::array::from_fn(|c| p.values[c] + if (1..=D).contains(&c) { boost[c - 1] } else { 0.0 }),
        };
        let conditions = Conditions::sample();
        let free_stream = std::array::from_fn(|i| conditions.free_stream[i] + boost[i]);
        let moving = Conditions { free_stream, ..conditions }.list();
        let still = Conditions::sample().list();
        let invariant = still.len() - Conditions::<D>::OF_AN_OBSERVER;
        let expected = evaluate(&still[..invariant], &p);
        for ((name, value), (_, expected)) in evaluate(&moving[..invariant], &seen).into_iter().zip(expected) {
            let error = difference(&value, &boosted(&expected, &boost));
            assert!(error <= 1e-13, "{name}: {error:e}");
        }
    }
}

/// A rotation: two reflections.
struct Rotation<const D: usize>([[f64; D]; 2]);

impl<const D: usize> Rotation<D> {
    fn vector(&self, a: &[f64; D]) -> [f64; D] {
        let reflected = |a: [f64; D], m: &[f64; D]| std::array::from_fn(|i| a[i] - 2.0 * dot(&a, m) * m[i]);
        reflected(reflected(*a, &self.0[0]), &self.0[1])
    }
    fn state<const M: usize>(&self, u: &[f64; M]) -> [f64; M] {
        let u = Conserved::<f64, D>::unpack(u);
        Conserved { momentum: self.vector(&u.momentum), ..u }.pack()
    }
    /// Rotates the direction and, in each, the components.
    fn gradient<const M: usize>(&self, g: &[[f64; M]; D]) -> [[f64; M]; D] {
        let mut turned = g.map(|g| self.state(&g));
        for c in 0..M {
            let column = self.vector(&turned.map(|g| g[c]));
            for i in 0..D {
                turned[i][c] = column[i];
            }
        }
        turned
    }
}

fn rotation<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let turn = Rotation([random.unit(), random.unit()]);
        let turned = Point {
            minus: turn.state(&p.minus),
            plus: turn.state(&p.plus),
            gradient: turn.gradient(&p.gradient),
            n: turn.vector(&p.n),
            v: turn.vector(&p.v),
            data: turn.state(&p.data),
            values: turn.state(&p.values),
        };
        let c = Conditions::sample();
        let conditions = Conditions {
            free_stream: turn.vector(&c.free_stream),
            slide: turn.vector(&c.slide),
            direction: turn.vector(&c.direction),
        };
        let expected = evaluate(&c.list(), &p);
        for ((name, value), (_, expected)) in evaluate(&conditions.list(), &turned).into_iter().zip(expected) {
            let error = difference(&value, &turn.state(&expected));
            assert!(error <= 1e-13, "{name}: {error:e}");
        }
    }
}

in_both_dimensions!(galilean, rotation);

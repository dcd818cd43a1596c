//! Conditions whose values are data of points.

use super::*;

/// Data with the values of a uniform condition give its fluxes, states and velocities. A direction may have any length.
fn equal_uniform_values<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let [pressure, temperature] = [0.8, 1.7].map(|mean| mean * random.between(0.8, 1.2));
        let (slide, direction): ([f64; D], [f64; D]) = (random.vector(1.0), random.unit());
        let pairs = [
            (
                Boundary::Inflow(Inflow::new(pressure, temperature, direction).unwrap()),
                Boundary::Inflow(Inflow::at_points()),
                direction.map(|d| 3.0 * d),
            ),
            (
                Boundary::Outflow(Outflow::new(pressure, temperature).unwrap()),
                Boundary::Outflow(Outflow::at_points()),
                slide,
            ),
            (
                Boundary::AdiabaticWall(AdiabaticWall::new(slide).unwrap()),
                Boundary::AdiabaticWall(AdiabaticWall::at_points()),
                slide,
            ),
            (
                Boundary::IsothermalWall(IsothermalWall::new(temperature, slide).unwrap()),
                Boundary::IsothermalWall(IsothermalWall::at_points()),
                slide,
            ),
        ];
        for (uniform, at_points, vector) in pairs {
            assert!(!uniform.takes_data() && at_points.takes_data());
            let given = Point { values: values(pressure, vector, temperature), ..p };
            for ((name, found), (_, expected)) in
                evaluate(&[at_points], &given).into_iter().zip(evaluate(&[uniform], &p))
            {
                let error = difference(&found, &expected);
                assert!(error <= 1e-13, "{name}: {error:e}");
            }
            let law = law::<D>(Riemann::Roe);
            let [of_points, expected] = [at_points, uniform].map(|condition| {
                ConservationLaw::<D, M>::boundary_velocity(&law, condition, at(&p.n, &p.v, &given.values))
            });
            assert!((0..D).all(|i| (of_points[i] - expected[i]).abs() <= 1e-15), "{at_points:?}");
        }
    }
}

/// A wall whose data say so has another temperature and slides otherwise.
fn walls_follow_their_data<const D: usize, const M: usize>() {
    let (gas, law) = (gas(), law::<D>(Riemann::Roe));
    for seed in 0..20 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let wall = Boundary::IsothermalWall(IsothermalWall::at_points());
        let state = law.impose(wall, &p.minus, at(&p.n, &p.v, &p.values)).state;
        let state = Primitive::<f64, D>::unpack(&gas, &state);
        assert!((gas.temperature(state.density, state.pressure) - p.values[M - 1]).abs() <= 1e-13);
        let along = |i: usize| p.values[1 + i] - (0..D).map(|j| p.values[1 + j] * p.n[j]).sum::<f64>() * p.n[i];
        assert!((0..D).all(|i| (state.velocity[i] - p.v[i] - along(i)).abs() <= 1e-13));
    }
}

in_both_dimensions!(equal_uniform_values, walls_follow_their_data);

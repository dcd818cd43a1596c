//! The quantities that are summed, and the averages that follow from the sums.
//!
//! An average is a sum of products of means and covariances. Those of the kinetic energy of fluctuations, k = <w_i' w_i'> / 2, are
//!
//! ```text
//! production          = -<w_i' w_j'> d_j <w_i>                                                                     (budget)
//! dissipation         = ( <tau_ij d_j w_i> - <tau_ij> <d_j w_i> ) / <rho>
//! pressure_dilatation = <p' (div w)'> / <rho>
//! turbulent_flux_j    = <w_i' w_i' w_j'> / 2
//! pressure_flux_j     = <p' w_j'> / <rho>
//! viscous_flux_j      = -<tau_ij' w_i'> / <rho>
//! ```
//!
//! In time d_j <w_i> = <d_j w_i>. An average along an axis does not depend on the place there: its derivative along that axis is zero, whereas
//! <d_j w_i> is the difference of both ends by their distance, see [`Moments::along`].
//!
//! With a uniform density `d_t k + <w> . grad k` = production + pressure_dilatation - dissipation - the divergence of the three fluxes.
//! S. B. Pope, Turbulent Flows (2000), equation 5.164, has it for an incompressible fluid.

use AveragedQuantity::{
    Density, DissipatedPower, Divergence, EnergyFlux, Gradient, Momentum, Pressure, Stress, Temperature, Velocity,
};
use case::Average;
use navier_stokes::{Gas, Primitive, viscous_stress};
use tensor::AXES;

/// A quantity of the gas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AveragedQuantity {
    /// The density.
    Density,
    /// The pressure.
    Pressure,
    /// The temperature.
    Temperature,
    /// A component of the velocity.
    Velocity(usize),
    /// A component of the momentum per volume.
    Momentum(usize),
    /// d_j w_i, by j and i.
    Gradient(usize, usize),
    /// div v
    Divergence,
    /// tau_ij
    Stress(usize, usize),
    /// tau_ij d_j w_i
    DissipatedPower,
    /// |v|^2 w_j / 2
    EnergyFlux(usize),
}

impl AveragedQuantity {
    /// Whether it needs the gradient of the velocity.
    fn needs_gradient(self) -> bool {
        matches!(self, Gradient(..) | Divergence | Stress(..) | DissipatedPower)
    }

    /// Its value in a state with the gradient `gradient[j][i]` = d_j w_i.
    pub fn of<const D: usize>(self, gas: &Gas, state: &Primitive<f64, D>, gradient: &[[f64; D]; D]) -> f64 {
        let stress = || viscous_stress(gas, state, gradient);
        match self {
            Density => state.density,
            Pressure => state.pressure,
            Temperature => gas.temperature(state.density, state.pressure),
            Velocity(axis) => state.velocity[axis],
            Momentum(axis) => state.density * state.velocity[axis],
            Gradient(j, i) => gradient[j][i],
            Divergence => (0..D).map(|i| gradient[i][i]).sum(),
            Stress(i, j) => stress()[i][j],
            DissipatedPower => {
                let power = |(tau, gradient): (&[f64; D], &[f64; D])| tensor::dot(tau, gradient);
                stress().iter().zip(gradient).map(power).sum()
            }
            EnergyFlux(axis) => 0.5 * tensor::dot(&state.velocity, &state.velocity) * state.velocity[axis],
        }
    }
}

/// A factor of an average, by the numbers of sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Factor {
    /// <q>
    Mean(usize),
    /// <q' r'>: the quantities and their product.
    Covariance([usize; 2], usize),
}

/// A coefficient, and the factors that it multiplies.
type Product = (f64, Vec<Factor>);

/// A component of an average.
#[derive(Clone, Debug, PartialEq)]
struct Term {
    /// Products, which are added.
    products: Vec<Product>,
    /// The quantity whose mean divides the sum.
    divisor: Option<usize>,
    /// Whether the square root is taken.
    is_root: bool,
}

impl Term {
    fn one(factor: Factor) -> Self {
        Term::sum(vec![(1.0, vec![factor])])
    }

    fn sum(products: Vec<Product>) -> Self {
        Term { products, divisor: None, is_root: false }
    }

    fn over(self, quantity: usize) -> Self {
        Term { divisor: Some(quantity), ..self }
    }

    /// Its value, from those of factors.
    fn value(&self, of: impl Fn(Factor) -> f64) -> f64 {
        let product = |(coefficient, factors): &Product| {
            factors.iter().fold(*coefficient, |product, factor| product * of(*factor))
        };
        let sum: f64 = self.products.iter().map(product).sum();
        let value = self.divisor.map_or(sum, |quantity| sum / of(Factor::Mean(quantity)));
        // Round-off may make the mean square of nothing negative. Not a number stays that.
        let square = if value < 0.0 { 0.0 } else { value };
        if self.is_root { square.sqrt() } else { value }
    }
}

/// An average with a name of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Averaged {
    /// Its name, in the result file.
    pub name: String,
    terms: Vec<Term>,
}

impl Averaged {
    /// The number of its components: one, or one for each axis.
    pub fn components(&self) -> usize {
        self.terms.len()
    }
}

/// The sums of a run: first those of the quantities, then those of products of two.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moments {
    /// The quantities.
    pub quantities: Vec<AveragedQuantity>,
    /// Pairs of quantities.
    products: Vec<[usize; 2]>,
    /// The averages that the case asks for.
    pub averages: Vec<Averaged>,
}

const PRODUCTION: &str = "production";

impl Moments {
    /// Those of the averages `wanted`, in `D` dimensions.
    pub fn new<const D: usize>(wanted: &[Average]) -> Self {
        let mut moments = Moments::default();
        wanted.iter().for_each(|average| moments.add_average::<D>(*average));
        moments
    }

    /// The same sums for averages along `axes`, too: without the derivatives of means along these, which are zero.
    pub fn along(mut self, axes: &[usize]) -> Self {
        let quantities = &self.quantities;
        let is_along = |factor: &Factor| match factor {
            Factor::Mean(number) => matches!(quantities[*number], Gradient(j, _) if axes.contains(&j)),
            Factor::Covariance(..) => false,
        };
        let production = self.averages.iter_mut().filter(|average| average.name == PRODUCTION);
        production.flat_map(|average| &mut average.terms).for_each(|term| {
            term.products.retain(|(_, factors)| !factors.iter().any(is_along));
        });
        self
    }

    /// The number of sums.
    pub fn len(&self) -> usize {
        self.quantities.len() + self.products.len()
    }

    fn add_average<const D: usize>(&mut self, average: Average) {
        match average {
            Average::Density => self.add_mean("density", &[Density]),
            Average::Pressure => self.add_mean("pressure", &[Pressure]),
            Average::Temperature => self.add_mean("temperature", &[Temperature]),
            Average::Velocity => self.add_mean("velocity", &std::array::from_fn::<_, D, _>(Velocity)),
            Average::Momentum => self.add_mean("momentum", &std::array::from_fn::<_, D, _>(Momentum)),
            Average::RmsDensity => self.add_rms("density", Density),
            Average::RmsPressure => self.add_rms("pressure", Pressure),
            Average::RmsTemperature => self.add_rms("temperature", Temperature),
            Average::ReynoldsStress => (0..D).for_each(|i| (i..D).for_each(|j| self.add_stress(i, j))),
            Average::KineticEnergyBudget => self.add_budget::<D>(),
        }
    }

    fn add_mean(&mut self, name: &str, quantities: &[AveragedQuantity]) {
        let terms = quantities.iter().map(|quantity| Term::one(self.mean(*quantity))).collect();
        self.averages.push(Averaged { name: format!("mean_{name}"), terms });
    }

    fn add_rms(&mut self, name: &str, quantity: AveragedQuantity) {
        let variance = self.covariance([quantity; 2]);
        let terms = vec![Term { is_root: true, ..Term::one(variance) }];
        self.averages.push(Averaged { name: format!("rms_{name}"), terms });
    }

    fn add_stress(&mut self, i: usize, j: usize) {
        let terms = vec![Term::one(self.covariance([i, j].map(Velocity)))];
        self.averages.push(Averaged { name: format!("reynolds_stress_{}{}", AXES[i], AXES[j]), terms });
    }

    /// (budget)
    fn add_budget<const D: usize>(&mut self) {
        let density = position_or_push(&mut self.quantities, Density);
        let one = |name: &str, terms: Vec<Term>| Averaged { name: name.to_owned(), terms };
        let production = Term::sum(pairs::<D>().map(|[i, j]| self.produced(i, j)).collect());
        let dissipation = Term::sum(self.dissipated::<D>()).over(density);
        let dilatation = Term::one(self.covariance([Pressure, Divergence])).over(density);
        let turbulent = (0..D).map(|j| Term::sum(self.carried::<D>(j))).collect();
        let pressure = (0..D).map(|j| Term::one(self.covariance([Pressure, Velocity(j)])).over(density)).collect();
        let viscous = (0..D).map(|j| Term::sum(self.diffused::<D>(j)).over(density)).collect();
        self.averages.extend([
            one(PRODUCTION, vec![production]),
            one("dissipation", vec![dissipation]),
            one("pressure_dilatation", vec![dilatation]),
            one("turbulent_flux", turbulent),
            one("pressure_flux", pressure),
            one("viscous_flux", viscous),
        ]);
    }

    /// -<w_i' w_j'> d_j <w_i>
    fn produced(&mut self, i: usize, j: usize) -> Product {
        (-1.0, vec![self.covariance([Velocity(i), Velocity(j)]), self.mean(Gradient(j, i))])
    }

    /// <tau_ij d_j w_i> - <tau_ij> <d_j w_i>
    fn dissipated<const D: usize>(&mut self) -> Vec<Product> {
        let all = (1.0, vec![self.mean(DissipatedPower)]);
        let of_mean = |[i, j]: [usize; 2]| (-1.0, vec![self.mean(stress(i, j)), self.mean(Gradient(j, i))]);
        std::iter::once(all).chain(pairs::<D>().map(of_mean)).collect()
    }

    /// <w_i' w_i' w_j'> / 2 = <|v|^2 w_j> / 2 - <w_i> <w_i' w_j'> - <w_j> ( <w_i' w_i'> + <w_i> <w_i> ) / 2
    fn carried<const D: usize>(&mut self, j: usize) -> Vec<Product> {
        let mut products = vec![(1.0, vec![self.mean(EnergyFlux(j))])];
        for i in 0..D {
            let [mean_i, mean_j] = [i, j].map(|axis| self.mean(Velocity(axis)));
            products.push((-1.0, vec![mean_i, self.covariance([Velocity(i), Velocity(j)])]));
            products.push((-0.5, vec![mean_j, self.covariance([Velocity(i); 2])]));
            products.push((-0.5, vec![mean_j, mean_i, mean_i]));
        }
        products
    }

    /// -<tau_ij' w_i'>
    fn diffused<const D: usize>(&mut self, j: usize) -> Vec<Product> {
        (0..D).map(|i| (-1.0, vec![self.covariance([stress(i, j), Velocity(i)])])).collect()
    }

    /// The mean of a quantity, which is added if it is new.
    fn mean(&mut self, quantity: AveragedQuantity) -> Factor {
        Factor::Mean(position_or_push(&mut self.quantities, quantity))
    }

    /// The covariance of two quantities.
    fn covariance(&mut self, quantities: [AveragedQuantity; 2]) -> Factor {
        let mut pair = quantities.map(|quantity| position_or_push(&mut self.quantities, quantity));
        pair.sort_unstable();
        Factor::Covariance(pair, position_or_push(&mut self.products, pair))
    }

    /// Adds `weight` times the quantities `values`, `[quantity][node]`, and their products to `sums`, `[sum][node]`.
    pub fn add(&self, values: &[f64], weight: f64, sums: &mut [f64]) {
        let nodes = values.len() / self.quantities.len();
        let (means, products) = sums.split_at_mut(values.len());
        means.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        for ([i, j], sums) in self.products.iter().zip(products.chunks_exact_mut(nodes)) {
            let pairs = values[i * nodes..].iter().zip(&values[j * nodes..]);
            sums.iter_mut().zip(pairs).for_each(|(sum, (q, r))| *sum += weight * q * r);
        }
    }

    /// The average at the nodes of a cell, `[component][node]`, from the `sums` over the time `duration`, `[sum][node]`, of quantities
    /// less `offsets`, `[quantity][node]`. NaN if no time has passed.
    pub fn average(&self, average: &Averaged, duration: f64, offsets: &[f64], sums: &[f64]) -> Vec<f64> {
        let nodes = offsets.len() / self.quantities.len();
        let mean = |sum: usize, node: usize| sums[sum * nodes + node] / duration;
        let product = |number: usize, node: usize| mean(self.quantities.len() + number, node);
        let factor = |factor: Factor, node: usize| match factor {
            Factor::Mean(q) => offsets[q * nodes + node] + mean(q, node),
            Factor::Covariance([q, r], number) => product(number, node) - mean(q, node) * mean(r, node),
        };
        let at = |term: &Term, node: usize| term.value(|of| factor(of, node));
        average.terms.iter().flat_map(|term| (0..nodes).map(move |node| at(term, node))).collect()
    }

    /// Whether a quantity needs the gradient of the velocity.
    pub fn need_gradient(&self) -> bool {
        self.quantities.iter().any(|quantity| quantity.needs_gradient())
    }

    /// The means of quantities less `others` and of their products, from the `means` of quantities less `offsets`: (q - o')(r - o'_r) with
    /// q - o' = (q - o) + (o - o').
    pub fn about(&self, others: &[f64], offsets: &[f64], means: &[f64]) -> Vec<f64> {
        let (firsts, products) = means.split_at(self.quantities.len());
        let shift = |q: usize| offsets[q] - others[q];
        let product = |([q, r], mean): (&[usize; 2], &f64)| {
            mean + shift(*q) * firsts[*r] + shift(*r) * firsts[*q] + shift(*q) * shift(*r)
        };
        let firsts = firsts.iter().enumerate().map(|(q, mean)| mean + shift(q));
        firsts.chain(self.products.iter().zip(products).map(product)).collect()
    }
}

/// All pairs of axes.
fn pairs<const D: usize>() -> impl Iterator<Item = [usize; 2]> {
    (0..D * D).map(|k| [k / D, k % D])
}

/// tau_ij, which is symmetric.
fn stress(i: usize, j: usize) -> AveragedQuantity {
    Stress(i.min(j), i.max(j))
}

fn position_or_push<T: PartialEq>(list: &mut Vec<T>, entry: T) -> usize {
    list.iter().position(|other| *other == entry).unwrap_or_else(|| {
        list.push(entry);
        list.len() - 1
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn fluctuations_of_a_large_mean_keep_their_digits() {
        let moments = Moments::new::<2>(&[Average::RmsPressure, Average::Pressure]);
        let (offset, amplitude) = (1e6, 1e-4);
        let mut sums = vec![0.0; 2];
        for sign in [-1.0, 1.0] {
            moments.add(&[sign * amplitude], 0.5, &mut sums);
        }
        let of = |k: usize| moments.average(&moments.averages[k], 1.0, &[offset], &sums);
        assert!((of(0)[0] / amplitude - 1.0).abs() < 1e-14);
        assert_eq!(of(1), [offset]);
    }

    #[test]
    fn shared_quantities_are_summed_once() {
        let moments = Moments::new::<3>(&[Average::Velocity, Average::ReynoldsStress]);
        assert_eq!((moments.quantities.len(), moments.len()), (3, 9));
        let names: Vec<&str> = moments.averages.iter().map(|average| &average.name[..]).collect();
        assert_eq!(names[..3], ["mean_velocity", "reynolds_stress_xx", "reynolds_stress_xy"]);
        assert_eq!(moments.averages[0].components(), 3);
    }

    /// Along an axis that is not periodic the difference of the mean velocities at both ends counted as a gradient of the mean.
    #[test]
    fn a_mean_along_an_axis_has_no_derivative_along_it() {
        let moments = Moments::new::<2>(&[Average::KineticEnergyBudget]);
        let along = moments.clone().along(&[0]);
        assert_eq!((&along.quantities, along.len()), (&moments.quantities, moments.len()));
        let [all, rest] = [&moments, &along].map(|moments| &moments.averages[0].terms[0].products);
        assert_eq!([all.len(), rest.len()], [4, 2]);
        let place = |j, i| Factor::Mean(moments.quantities.iter().position(|q| *q == Gradient(j, i)).unwrap());
        assert!(rest.iter().zip([place(1, 0), place(1, 1)]).all(|((_, factors), mean)| factors.contains(&mean)));
        assert_eq!(moments.averages[1..], along.averages[1..], "only the production has such a derivative");
    }

    /// A formula with such a name is refused.
    #[test]
    fn all_names_of_averages_are_known() {
        let all = [
            Average::Density,
            Average::Velocity,
            Average::Pressure,
            Average::Temperature,
            Average::Momentum,
            Average::ReynoldsStress,
            Average::RmsDensity,
            Average::RmsPressure,
            Average::RmsTemperature,
            Average::KineticEnergyBudget,
        ];
        for average in Moments::new::<3>(&all).averages {
            assert!(case::is_name_of_average(&average.name), "{}", average.name);
        }
    }

    #[test]
    fn no_time_has_no_average() {
        let moments = Moments::new::<2>(&[Average::Density]);
        assert!(moments.average(&moments.averages[0], 0.0, &[1.0], &[0.0])[0].is_nan());
    }
}

//! The quantities that are summed, and the averages that follow from the sums.

use case::Average;
use navier_stokes::{Gas, Primitive};

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
}

impl AveragedQuantity {
    /// Its value in a state.
    pub fn of<const D: usize>(self, gas: &Gas, state: &Primitive<f64, D>) -> f64 {
        match self {
            AveragedQuantity::Density => state.density,
            AveragedQuantity::Pressure => state.pressure,
            AveragedQuantity::Temperature => gas.temperature(state.density, state.pressure),
            AveragedQuantity::Velocity(axis) => state.velocity[axis],
            AveragedQuantity::Momentum(axis) => state.density * state.velocity[axis],
        }
    }
}

/// A component of an average, by the numbers of sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Term {
    /// <q>
    Mean(usize),
    /// <q' r'>: the quantities and their product.
    Covariance([usize; 2], usize),
    /// <q' q'>^1/2
    Rms(usize, usize),
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

const AXES: [&str; 3] = ["x", "y", "z"];

impl Moments {
    /// Those of the averages `wanted`, in `D` dimensions.
    pub fn new<const D: usize>(wanted: &[Average]) -> Self {
        let mut moments = Moments::default();
        wanted.iter().for_each(|average| moments.add_average::<D>(*average));
        moments
    }

    /// The number of sums.
    pub fn len(&self) -> usize {
        self.quantities.len() + self.products.len()
    }

    fn add_average<const D: usize>(&mut self, average: Average) {
        match average {
            Average::Density => self.add_mean("density", &[AveragedQuantity::Density]),
            Average::Pressure => self.add_mean("pressure", &[AveragedQuantity::Pressure]),
            Average::Temperature => self.add_mean("temperature", &[AveragedQuantity::Temperature]),
            Average::Velocity => self.add_mean("velocity", &std::array::from_fn::<_, D, _>(AveragedQuantity::Velocity)),
            Average::Momentum => self.add_mean("momentum", &std::array::from_fn::<_, D, _>(AveragedQuantity::Momentum)),
            Average::RmsDensity => self.add_rms("density", AveragedQuantity::Density),
            Average::RmsPressure => self.add_rms("pressure", AveragedQuantity::Pressure),
            Average::RmsTemperature => self.add_rms("temperature", AveragedQuantity::Temperature),
            Average::ReynoldsStress => (0..D).for_each(|i| (i..D).for_each(|j| self.add_stress(i, j))),
        }
    }

    fn add_mean(&mut self, name: &str, quantities: &[AveragedQuantity]) {
        let terms = quantities.iter().map(|quantity| Term::Mean(self.quantity(*quantity))).collect();
        self.averages.push(Averaged { name: format!("mean_{name}"), terms });
    }

    fn add_rms(&mut self, name: &str, quantity: AveragedQuantity) {
        let number = self.quantity(quantity);
        let terms = vec![Term::Rms(number, self.product([number, number]))];
        self.averages.push(Averaged { name: format!("rms_{name}"), terms });
    }

    fn add_stress(&mut self, i: usize, j: usize) {
        let pair = [i, j].map(|axis| self.quantity(AveragedQuantity::Velocity(axis)));
        let terms = vec![Term::Covariance(pair, self.product(pair))];
        self.averages.push(Averaged { name: format!("reynolds_stress_{}{}", AXES[i], AXES[j]), terms });
    }

    /// The number of a quantity, which is added if it is new.
    fn quantity(&mut self, quantity: AveragedQuantity) -> usize {
        position_or_push(&mut self.quantities, quantity)
    }

    fn product(&mut self, pair: [usize; 2]) -> usize {
        position_or_push(&mut self.products, pair)
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
        let at = |term: &Term, node: usize| match *term {
            Term::Mean(q) => offsets[q * nodes + node] + mean(q, node),
            Term::Covariance([q, r], number) => product(number, node) - mean(q, node) * mean(r, node),
            // Round-off may make the mean square of nothing negative.
            Term::Rms(q, number) => (product(number, node) - mean(q, node).powi(2)).max(0.0).sqrt(),
        };
        average.terms.iter().flat_map(|term| (0..nodes).map(move |node| at(term, node))).collect()
    }
}

fn position_or_push<T: PartialEq>(list: &mut Vec<T>, entry: T) -> usize {
    list.iter().position(|other| *other == entry).unwrap_or_else(|| {
        list.push(entry);
        list.len() - 1
    })
}

#[cfg(test)]
mod tests {
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

    #[test]
    fn no_time_has_no_average() {
        let moments = Moments::new::<2>(&[Average::Density]);
        assert!(moments.average(&moments.averages[0], 0.0, &[1.0], &[0.0])[0].is_nan());
    }
}

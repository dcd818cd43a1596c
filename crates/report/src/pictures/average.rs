//! Averages over time in the pictures: numbers at the nodes of the flow, made of arrays of the result file.

/// A displayed average.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Average {
    /// Its name in the page.
    pub label: &'static str,
    /// The arrays that it is made of; it exists if the first does.
    pub arrays: &'static [&'static str],
    made_as: Made,
}

/// How a number is made of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Made {
    /// The number itself.
    Value,
    /// The magnitude of a vector.
    Magnitude,
    /// Half of the sum.
    HalfSum,
}

/// All averages that are displayed, in their order in the page.
const ALL: [Average; 11] = [
    Average { label: "Mean velocity, magnitude", arrays: &["mean_velocity"], made_as: Made::Magnitude },
    Average { label: "Mean pressure", arrays: &["mean_pressure"], made_as: Made::Value },
    Average { label: "Mean density", arrays: &["mean_density"], made_as: Made::Value },
    Average { label: "Mean temperature", arrays: &["mean_temperature"], made_as: Made::Value },
    Average {
        label: "Kinetic energy of fluctuations",
        arrays: &["reynolds_stress_xx", "reynolds_stress_yy", "reynolds_stress_zz"],
        made_as: Made::HalfSum,
    },
    Average { label: "Reynolds stress xy", arrays: &["reynolds_stress_xy"], made_as: Made::Value },
    Average { label: "Production of kinetic energy", arrays: &["production"], made_as: Made::Value },
    Average { label: "Dissipation of fluctuations", arrays: &["dissipation"], made_as: Made::Value },
    Average { label: "Pressure, r.m.s.", arrays: &["rms_pressure"], made_as: Made::Value },
    Average { label: "Density, r.m.s.", arrays: &["rms_density"], made_as: Made::Value },
    Average { label: "Temperature, r.m.s.", arrays: &["rms_temperature"], made_as: Made::Value },
];

/// The averages that a file with these `arrays` holds.
pub fn present(arrays: &[&str]) -> impl Iterator<Item = Average> {
    ALL.into_iter().filter(|average| arrays.contains(&average.arrays[0]))
}

impl Average {
    /// Its name: that of its array, or `turbulent_kinetic_energy`.
    pub fn name(&self) -> &'static str {
        if self.made_as == Made::HalfSum { "turbulent_kinetic_energy" } else { self.arrays[0] }
    }

    /// Its values at the nodes of a cell, from the coefficients of the cell in each of its arrays, `[component][node]`.
    pub fn at_nodes(&self, coefficients: &[&[f64]], nodes: usize) -> Vec<f64> {
        let at = |node: usize| {
            let components = coefficients.iter().flat_map(|array| array.iter().skip(node).step_by(nodes));
            match self.made_as {
                Made::Value => coefficients[0][node],
                Made::Magnitude => components.map(|v| v * v).sum::<f64>().sqrt(),
                Made::HalfSum => 0.5 * components.sum::<f64>(),
            }
        };
        (0..nodes).map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averages_are_made_of_their_arrays() {
        let of = |label: &str| ALL.into_iter().find(|average| average.label == label);
        let speed = of("Mean velocity, magnitude").map(|average| average.at_nodes(&[&[3.0, 0.0, 4.0, 1.0]], 2));
        assert_eq!(speed, Some(vec![5.0, 1.0]));
        let energy =
            of("Kinetic energy of fluctuations").map(|average| average.at_nodes(&[&[1.0, 2.0], &[3.0, 4.0]], 2));
        assert_eq!(energy, Some(vec![2.0, 3.0]));
    }

    #[test]
    fn only_averages_in_the_file_are_shown() {
        let labels: Vec<_> = present(&["flow", "rms_pressure", "mean_pressure"]).map(|average| average.label).collect();
        assert_eq!(labels, ["Mean pressure", "Pressure, r.m.s."]);
    }
}

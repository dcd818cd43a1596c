//! The quantities of the pictures, and their colours.

use super::average::{self, Average};
use super::colour::{Colour, ColourMap};
use case::Field;

/// A displayed quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureQuantity {
    /// A field of the flow.
    Flow(Field),
    /// det J / det J_0.
    Jacobian,
    /// min / max of det J / det J_0 over each cell.
    ScaledJacobian,
    /// The magnitude of the displacement from the mesh at rest.
    Displacement,
    /// An average over time.
    Average(Average),
    /// A field by the formula of this number in the case.
    Formula(usize),
}

/// The quantities displayed with a flow; without a flow those of the mesh, and the displacement.
const ALL: [PictureQuantity; 6] = [
    PictureQuantity::Flow(Field::Mach),
    PictureQuantity::Flow(Field::Vorticity),
    PictureQuantity::Flow(Field::Pressure),
    PictureQuantity::Flow(Field::Density),
    PictureQuantity::Jacobian,
    PictureQuantity::ScaledJacobian,
];

/// The values at the ends of a colour map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// At the low end.
    pub lower: f64,
    /// At the high end.
    pub upper: f64,
}

impl Range {
    /// The range between two numbers; `None` if there is nothing between them.
    pub fn new(lower: f64, upper: f64) -> Option<Self> {
        (lower < upper && (upper - lower).is_finite()).then_some(Range { lower, upper })
    }
}

impl PictureQuantity {
    /// The quantities displayed for a run with the arrays of coefficients `arrays`.
    pub fn of(has_flow: bool, arrays: &[&str]) -> Vec<PictureQuantity> {
        let present = ALL.into_iter().filter(|quantity| has_flow || !matches!(quantity, PictureQuantity::Flow(_)));
        let present = present.chain((!has_flow).then_some(PictureQuantity::Displacement));
        present.chain(average::present(arrays).map(PictureQuantity::Average)).collect()
    }

    /// The quantities of the page: also fields that the case writes, if they need no more than the state.
    pub fn of_page(has_flow: bool, arrays: &[&str], written: &[&str]) -> Vec<PictureQuantity> {
        let on_request = [Field::QCriterion, Field::Entropy, Field::TotalPressure].map(PictureQuantity::Flow);
        let requested = on_request.into_iter().filter(|quantity| written.contains(&quantity.name()));
        PictureQuantity::of(has_flow, arrays).into_iter().chain(requested).collect()
    }

    /// The quantities of movies: those of the page, and fields that take too much of its room.
    pub fn of_movies(has_flow: bool, arrays: &[&str]) -> Vec<PictureQuantity> {
        let more = [
            Field::QCriterion,
            Field::Entropy,
            Field::TotalPressure,
            Field::TotalTemperature,
            Field::PressureCoefficient,
            Field::Temperature,
            Field::Velocity,
        ];
        let more = more.map(PictureQuantity::Flow);
        PictureQuantity::of(has_flow, arrays).into_iter().chain(more.into_iter().filter(|_| has_flow)).collect()
    }

    /// Whether it depends on more of the gas than the ratio of specific heats, or on a formula of the case.
    pub fn needs_case(self) -> bool {
        matches!(
            self,
            PictureQuantity::Formula(_)
                | PictureQuantity::Flow(Field::TotalTemperature | Field::PressureCoefficient | Field::Temperature)
        )
    }

    /// Its name on the command line: that of the field in a case or of the average in the result file. The case has the names of formulas.
    pub fn name(self) -> &'static str {
        match self {
            PictureQuantity::Flow(Field::Velocity) => "velocity",
            PictureQuantity::Formula(_) => "formula",
            PictureQuantity::Flow(field) => field.components(2)[0],
            PictureQuantity::Jacobian => "jacobian",
            PictureQuantity::ScaledJacobian => "scaled_jacobian",
            PictureQuantity::Displacement => "displacement",
            PictureQuantity::Average(average) => average.name(),
        }
    }

    /// Its name in the page.
    pub fn label(self, dimension: usize) -> &'static str {
        match self {
            PictureQuantity::Flow(Field::Mach) => "Mach number",
            PictureQuantity::Flow(Field::Vorticity) if dimension == 3 => "Vorticity, z",
            PictureQuantity::Flow(Field::Vorticity) => "Vorticity",
            PictureQuantity::Flow(Field::Pressure) => "Pressure",
            PictureQuantity::Flow(Field::Density) => "Density",
            PictureQuantity::Flow(Field::PressureCoefficient) => "Pressure coefficient",
            PictureQuantity::Flow(Field::TotalPressure) => "Total pressure",
            PictureQuantity::Flow(Field::TotalTemperature) => "Total temperature",
            PictureQuantity::Flow(Field::Entropy) => "Entropy",
            PictureQuantity::Flow(Field::QCriterion) => "Q criterion",
            PictureQuantity::Flow(Field::Velocity) => "Velocity, magnitude",
            PictureQuantity::Flow(Field::Temperature) => "Temperature",
            PictureQuantity::Flow(Field::MeshVelocity) => "Mesh velocity",
            PictureQuantity::Flow(Field::Displacement) => "Displacement",
            PictureQuantity::Flow(Field::VonMises) => "Von Mises stress",
            PictureQuantity::Flow(Field::PrincipalStress) => "Principal stress",
            PictureQuantity::Flow(Field::Jacobian) | PictureQuantity::Jacobian => "Mesh: det J / det J\u{2080}",
            PictureQuantity::ScaledJacobian => "Mesh: scaled Jacobian",
            PictureQuantity::Displacement => "Displacement, magnitude",
            PictureQuantity::Average(average) => average.label,
            PictureQuantity::Formula(_) => "Formula",
        }
    }

    /// Its colours.
    pub fn colours(self) -> ColourMap {
        match self {
            PictureQuantity::Flow(Field::Vorticity) | PictureQuantity::Jacobian => ColourMap::Diverging,
            _ => ColourMap::Sequential,
        }
    }

    /// The colour behind its picture, if the page's own looks like a colour of the picture.
    pub fn ground(self) -> Option<Colour> {
        (self.colours() == ColourMap::Diverging).then_some([0xa9, 0xb1, 0xb8])
    }

    /// The size that it usually has; 0 if it is known by its values alone.
    fn natural_size(self, scales: Scales) -> f64 {
        match self {
            PictureQuantity::Flow(Field::Mach) => 1.0,
            PictureQuantity::Flow(Field::Velocity | Field::MeshVelocity) => scales.speed,
            PictureQuantity::Displacement | PictureQuantity::Flow(Field::Displacement) => scales.length,
            _ => 0.0,
        }
    }

    /// The range of colours for the values in the pictures. A few values at the ends are left out, so that one corner does
    /// not take all the colours. The range is wide enough not to show round-off as a field, by the natural size of the quantity.
    pub fn range(self, mut values: Vec<f32>, scales: Scales) -> Range {
        values.retain(|value| value.is_finite());
        values.sort_unstable_by(f32::total_cmp);
        let at = |part: f64| values.get((part * values.len() as f64) as usize).map_or(0.0, |value| f64::from(*value));
        let (lower, upper) = (at(0.002), at(0.998));
        match self {
            PictureQuantity::Flow(Field::Vorticity) => {
                around(0.0, lower, upper, positive(1e-6 * scales.speed / scales.length, 1e-6))
            }
            PictureQuantity::Jacobian => around(1.0, lower, upper, 0.01),
            PictureQuantity::ScaledJacobian => Range { lower: lower.min(0.99), upper: 1.0 },
            _ => {
                let largest = lower.abs().max(upper.abs()).max(1e-5 * self.natural_size(scales));
                let least = positive(1e-5 * largest, 1e-10);
                let missing = (least - 0.5 * (upper - lower)).max(0.0);
                Range { lower: lower - missing, upper: upper + missing }
            }
        }
    }
}

/// Sizes of a mesh and its flow, in the units of the case.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// The longest edge of the box around the mesh.
    pub length: f64,
    /// The fastest wave; 0 without a flow.
    pub speed: f64,
}

/// `x`, or `otherwise` if it is not positive.
fn positive(x: f64, otherwise: f64) -> f64 {
    if x > 0.0 { x } else { otherwise }
}

/// The range centred at `middle` that contains both ends, and extends at least `least` to both sides.
fn around(middle: f64, lower: f64, upper: f64, least: f64) -> Range {
    let half = (middle - lower).max(upper - middle).max(least);
    Range { lower: middle - half, upper: middle + half }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: Scales = Scales { length: 10.0, speed: 2.0 };

    #[test]
    fn the_page_shows_fields_that_the_case_asks_for() {
        let names = |written: &[&str]| -> Vec<&str> {
            PictureQuantity::of_page(true, &[], written).into_iter().map(PictureQuantity::name).collect()
        };
        assert_eq!(names(&["velocity", "pressure"]), names(&[]));
        assert_eq!(names(&["entropy", "q_criterion"])[names(&[]).len()..], ["q_criterion", "entropy"]);
    }

    #[test]
    fn a_single_peak_does_not_take_all_colours() {
        let mut values: Vec<f32> = (0..1000).map(|i| i as f32 * 1e-3).collect();
        values.extend([500.0, f32::NAN]);
        let Range { lower, upper } = PictureQuantity::Flow(Field::Mach).range(values, SCALES);
        assert!((lower - 0.002).abs() < 1e-3 && (upper - 0.999).abs() < 2e-3, "{lower} {upper}");
    }

    #[test]
    fn signed_quantities_are_white_in_the_middle() {
        let Range { lower, upper } = PictureQuantity::Flow(Field::Vorticity).range(vec![-3.0, 1.0, 0.0], SCALES);
        assert_eq!((lower, upper), (-3.0, 3.0));
        assert_eq!(PictureQuantity::Jacobian.range(vec![1.0, 1.0], SCALES), Range { lower: 0.99, upper: 1.01 });
    }

    #[test]
    fn round_off_is_not_drawn_as_a_field() {
        let Range { lower, upper } = PictureQuantity::Flow(Field::Pressure).range(vec![2.0, 2.0 + 1e-6], SCALES);
        assert!(upper - lower > 3.9e-5, "{lower} {upper}");
        let Range { lower, upper } = PictureQuantity::Flow(Field::Mach).range(vec![], SCALES);
        assert!((lower + 1e-10).abs() < 1e-20 && (upper - 1e-10).abs() < 1e-20, "{lower} {upper}");
    }

    /// A defect that was: the density of a gas in tonnes and millimetres was one colour.
    #[test]
    fn a_range_does_not_depend_on_units() {
        let density = |unit: f64| {
            let values = [1.0, 1.2].map(|x| (x * unit) as f32).to_vec();
            let Range { lower, upper } = PictureQuantity::Flow(Field::Density).range(values, SCALES);
            [lower / unit, upper / unit]
        };
        let ([one, other], [lower, upper]) = (density(1.0), density(1e-12));
        assert!((one - lower).abs() < 1e-6 && (other - upper).abs() < 1e-6, "{lower} {upper}");
    }

    #[test]
    fn a_range_goes_from_low_to_high() {
        assert_eq!(Range::new(-1.0, 2.0), Some(Range { lower: -1.0, upper: 2.0 }));
        let wrong = [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]];
        assert!(wrong.iter().all(|[lower, upper]| Range::new(*lower, *upper).is_none()));
    }

    #[test]
    fn names_on_the_command_line_are_distinct() {
        let arrays = ["mean_velocity", "reynolds_stress_xx", "reynolds_stress_xy", "rms_pressure"];
        let mut names: Vec<&str> =
            PictureQuantity::of_movies(true, &arrays).into_iter().map(PictureQuantity::name).collect();
        let count = names.len();
        assert!(
            names.contains(&"mach")
                && names.contains(&"velocity")
                && names.contains(&"q_criterion")
                && names.contains(&"mean_velocity")
        );
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count, "{names:?}");
        let of_mesh: Vec<&str> =
            PictureQuantity::of_movies(false, &[]).into_iter().map(PictureQuantity::name).collect();
        assert_eq!(of_mesh, ["jacobian", "scaled_jacobian", "displacement"]);
    }
}

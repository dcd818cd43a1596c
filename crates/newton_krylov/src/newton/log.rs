//! Records of the steps for the log: every value is a number under a name of its own.

use super::StepReport;
use crate::problem::Field;

/// Writes an accepted step with its `number`.
pub fn accepted(number: usize, fields: &[Field], step: &StepReport) {
    let residual = |name| largest(fields, &step.field_norms, name);
    let damping = |name| largest(fields, &step.inverse_pseudo_time, name);
    tracing::debug!(
        step = number,
        residual = step.residual_norm,
        residual_body = residual("body"),
        residual_structure = residual("structure"),
        residual_mesh = residual("mesh"),
        residual_flow = residual("flow"),
        forcing = step.forcing,
        linear_residual = step.linear_residual,
        krylov = step.krylov_iterations,
        step_length = step.step_length,
        inverse_pseudo_time_body = damping("body"),
        inverse_pseudo_time_structure = damping("structure"),
        inverse_pseudo_time_mesh = damping("mesh"),
        inverse_pseudo_time_flow = damping("flow"),
        rejections = step.rejections,
        "Newton step"
    );
}

/// Writes that the step with this `number` is repeated with more damping.
pub fn rejected(number: usize, fields: &[Field], inverse_pseudo_time: &[f64]) {
    let damping = |name| largest(fields, inverse_pseudo_time, name);
    tracing::debug!(
        step = number,
        inverse_pseudo_time_body = damping("body"),
        inverse_pseudo_time_structure = damping("structure"),
        inverse_pseudo_time_mesh = damping("mesh"),
        inverse_pseudo_time_flow = damping("flow"),
        "Newton step rejected"
    );
}

/// The largest number of the fields called `name`; a record leaves out what is `None`. A record has names that are known in advance, so
/// it tells fields of other names in the total only.
fn largest(fields: &[Field], numbers: &[f64], name: &str) -> Option<f64> {
    let of_name = fields.iter().zip(numbers).filter(|(field, _)| field.name == name);
    of_name.map(|(_, number)| *number).reduce(|a, b| if b > a || b.is_nan() { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_share_a_number_and_a_missing_field_has_none() {
        let field = |name| Field { name, range: 0..1 };
        let (fields, numbers) = ([field("body"), field("body"), field("flow")], [1.0, 3.0, 2.0]);
        assert_eq!(largest(&fields, &numbers, "body"), Some(3.0));
        assert_eq!(largest(&fields, &numbers, "flow"), Some(2.0));
        assert_eq!(largest(&fields, &numbers, "mesh"), None);
        assert!(largest(&fields, &[1.0, f64::NAN, 2.0], "body").is_some_and(f64::is_nan));
    }
}

//! Formulas.

use super::{Checked, Checker};
use crate::cause::Cause;
use crate::error::{CaseError, collected};
use crate::expression::{ExpressionError, Names, Problem, Program};
use crate::key::Key;
use crate::raw::{Field, Formula};
use crate::vector::Vector;

/// Where formulas may contain controls.
const CONTROLLED: [&str; 2] = ["flow.source", "flow.boundary"];

impl Checker<'_> {
    /// A formula in the position.
    pub(crate) fn formula_of_position<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_coordinates(D))
    }

    /// A formula in position and time.
    pub(crate) fn formula<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_coordinates(D).with_time())
    }

    /// A formula in what a control measures, its value and the time.
    pub(crate) fn formula_of_control(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_fields(["measured", "value"].into_iter()).with_time())
    }

    /// A formula in time.
    pub(crate) fn formula_of_time(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_time())
    }

    /// A formula in position, time and the arc length s.
    pub(crate) fn formula_on_boundary<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_coordinates(D).with_time().with_arc_length())
    }

    /// A formula in position, time and the fields of a flow.
    pub(crate) fn formula_of_fields<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        let names = self.names.with_coordinates(D).with_time().with_fields(Field::components_of_flow(D));
        self.program(key, formula, &names)
    }

    /// A formula in position and time for each axis.
    pub(crate) fn formulas<const D: usize>(&self, key: &Key, formulas: &[Formula]) -> Checked<Vector<D>> {
        self.programs(key, formulas, &self.names.with_coordinates(D).with_time())
    }

    /// A formula in the position for each axis.
    pub(crate) fn formulas_of_position<const D: usize>(&self, key: &Key, formulas: &[Formula]) -> Checked<Vector<D>> {
        self.programs(key, formulas, &self.names.with_coordinates(D))
    }

    /// A formula in time for each axis.
    pub(crate) fn formulas_of_time<const D: usize>(&self, key: &Key, formulas: &[Formula]) -> Checked<Vector<D>> {
        self.programs(key, formulas, &self.names.with_time())
    }

    /// The value of a formula of constants.
    pub(crate) fn number(&self, key: &Key, formula: &Formula) -> Checked<f64> {
        Ok(self.program(key, formula, &self.names)?.evaluate(&[], 0.0))
    }

    fn programs<const D: usize>(&self, key: &Key, formulas: &[Formula], names: &Names) -> Checked<Vector<D>> {
        let formulas: [Formula; D] = self.vector(key, formulas)?;
        let program = |(axis, formula): (usize, &Formula)| self.program(&key.entry(axis), formula, names);
        let programs = collected(formulas.iter().enumerate().map(program))?;
        Ok(Vector::new(self.vector(key, &programs)?))
    }

    pub(super) fn program(&self, key: &Key, formula: &Formula, names: &Names) -> Checked<Program> {
        match formula {
            Formula::Number(value) => Ok(Program::constant(*value)),
            Formula::Text(text) => {
                let may_be_controlled = CONTROLLED.iter().any(|section| key.to_string().starts_with(section));
                let controls = self.controls.iter().filter(|_| may_be_controlled);
                let names = names.with_controls(controls.map(|control| (control.name.clone(), control.value.clone())));
                let program = Program::compile(text, &names).map_err(|error| self.wrong_formula(key, error))?;
                let used = self.controls.iter().filter(|control| program.is_controlled_by(&control.value));
                self.used_controls.borrow_mut().extend(used.map(|control| control.name.clone()));
                // Where a formula has no value, the place where one is needed is told.
                let constant = program.as_constant().filter(|value| value.is_finite());
                self.computable(key, "the formula", constant.unwrap_or(0.0))?;
                Ok(program)
            }
        }
    }

    /// The error of a name that the case defines, but not for the formula at `key`.
    fn name_out_of_place(&self, key: &Key, name: &str) -> Option<Box<CaseError>> {
        let is_in = |section: &str| self.document.position(&Key::new(section).child(name)).is_some();
        let (problem, accepted) = if is_in("constants") {
            (format!("constants need each other: `{name}` needs this one"), "no circle of constants")
        } else if is_in("tables") {
            (
                format!("`{name}` is a table, and numbers are computed before tables"),
                "a formula of numbers and constants",
            )
        } else if is_in("controls") {
            let problem = format!("`{name}` is a control, and this formula is not one that a control may change");
            (problem, "controls in formulas of `flow.source` and `flow.boundary`")
        } else {
            return None;
        };
        Some(self.combination(key, &problem, accepted))
    }

    /// The error of a formula. A name whose definition has an error is not an error of the formula.
    fn wrong_formula(&self, key: &Key, error: ExpressionError) -> Box<CaseError> {
        match &error.problem {
            Problem::UnknownName { name, .. } if self.damage.hides_name(name) => self.follows(key),
            Problem::UnknownName { name, .. } => {
                self.name_out_of_place(key, name).unwrap_or_else(|| self.error(key, Cause::Expression(error)))
            }
            _ => self.error(key, Cause::Expression(error)),
        }
    }
}

//! The gas and the formulas of the case in a result file.

use super::error::PictureError;
use crate::fields::Medium;
use case::{AnyCase, Case, Document, FieldFormula};
use navier_stokes::{Gas, Viscosity};
use output::ResultReader;
use std::path::Path;

/// What the fields of a picture are made with, besides the coefficients.
pub struct PictureMedium {
    /// The gas and its reference state.
    pub medium: Medium,
    /// The formulas of `output.formulas`.
    pub formulas: Vec<FieldFormula>,
}

impl PictureMedium {
    /// The ratio of specific heats alone, which is all that the fields of the page need; without a flow any gas will do.
    ///
    /// # Errors
    /// A case that has no such number.
    pub fn simple(reader: &ResultReader) -> Result<Self, PictureError> {
        let gamma = case::ratio_of_specific_heats_of(&reader.metadata.case_text).map_err(|_| PictureError::Gas)?;
        let gas = Gas::new(gamma.unwrap_or(1.4), 1.0, 1.0, Viscosity::Inviscid).map_err(|_| PictureError::Gas)?;
        Ok(PictureMedium { medium: Medium::gas(gas), formulas: Vec::new() })
    }

    /// All of the gas, and the formulas: the case is checked again.
    ///
    /// # Errors
    /// A case that cannot be read any more, for instance because the file of its mesh is gone.
    pub fn full(reader: &ResultReader) -> Result<Self, PictureError> {
        let text = reader.metadata.case_text.clone();
        let document = Document::parse(Path::new("case"), text, &[]).map_err(|error| unreadable(&error))?;
        match AnyCase::check(&document).map_err(|error| unreadable(&error))? {
            AnyCase::Plane(case) => of_case(reader, &case),
            AnyCase::Space(case) => of_case(reader, &case),
        }
    }
}

fn of_case<const D: usize>(reader: &ResultReader, case: &Case<D>) -> Result<PictureMedium, PictureError> {
    let Some(flow) = &case.flow else { return PictureMedium::simple(reader) };
    Ok(PictureMedium { medium: Medium::of(flow), formulas: case.observed.formulas.clone() })
}

fn unreadable(error: &impl ToString) -> PictureError {
    PictureError::Case(error.to_string())
}

//! Where the flow is observed: points, lines and planes; and fields by formulas.

use super::mesh_crate::Mesh;
use crate::checker::{Checked, Checker};
use crate::error::{Errors, collected};
use crate::expression::is_variable;
use crate::fields::FieldFormula;
use crate::key::Key;
use crate::raw::{self, Field};
use std::collections::BTreeMap;

/// A point at which the flow is observed.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe<const D: usize> {
    /// Its name.
    pub name: String,
    /// Its position, that at rest if the mesh carries it.
    pub at: [f64; D],
    /// Whether it moves with the mesh.
    pub carried: bool,
    /// Its fields.
    pub fields: Vec<Field>,
}

/// A straight line along which the flow is observed.
#[derive(Clone, Debug, PartialEq)]
pub struct Line<const D: usize> {
    /// Its name.
    pub name: String,
    /// Its points, at rest if the mesh carries them.
    pub points: Vec<[f64; D]>,
    /// Slabs between outputs.
    pub every: usize,
    /// Whether the points move with the mesh.
    pub carried: bool,
    /// Its fields.
    pub fields: Vec<Field>,
}

impl<const D: usize> Line<D> {
    /// Whether some of its points lie in `mesh`.
    pub fn meets(&self, mesh: &Mesh<D>) -> bool {
        self.points.iter().any(|x| mesh.locate(x).is_some())
    }
}

/// A plane through a three-dimensional mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice<const D: usize> {
    /// Its name.
    pub name: String,
    /// A point of it.
    pub point: [f64; D],
    /// Its unit normal.
    pub normal: [f64; D],
    /// Slabs between outputs.
    pub every: usize,
    /// Parts into which each edge of a cell is divided.
    pub parts: usize,
    /// Whether a table is written too.
    pub csv: bool,
    /// Its fields.
    pub fields: Vec<Field>,
}

impl<const D: usize> Slice<D> {
    /// Whether the nodes of `mesh` lie on both sides of it, or on it.
    pub fn meets(&self, mesh: &Mesh<D>) -> bool {
        let height = |x: &[f64]| -> f64 { (0..D).map(|i| self.normal[i] * (x[i] - self.point[i])).sum() };
        let heights = || mesh.coordinates().chunks_exact(D).map(height);
        heights().any(|height| height <= 0.0) && heights().any(|height| height >= 0.0)
    }
}

/// Where the flow of a case is observed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observed<const D: usize> {
    /// Fields by formulas, which are added to the fields of all others.
    pub formulas: Vec<FieldFormula>,
    /// Points.
    pub probes: Vec<Probe<D>>,
    /// Lines.
    pub lines: Vec<Line<D>>,
    /// Planes.
    pub slices: Vec<Slice<D>>,
}

/// Checks `[output.formulas]`, `[output.probes]`, `[output.lines]` and `[output.slices]` of a case with a flow of `order`, if it has one.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Output,
    mesh: &Mesh<D>,
    order: Option<usize>,
) -> Checked<Observed<D>> {
    let sections = [raw.probes.is_empty(), raw.lines.is_empty(), raw.slices.is_empty(), raw.formulas.is_empty()];
    let names = ["probes", "lines", "slices", "formulas"];
    let given = names.iter().zip(sections).find(|(_, is_empty)| !is_empty).map(|(name, _)| name);
    let key = Key::new("output");
    let (order, given) = match (order, given) {
        (None, Some(name)) => {
            let accepted = "this section together with [flow]; `structure.points` observe a structure";
            let problem = "without a flow there is nothing to observe";
            return Err(checker.combination(&key.child(name), problem, accepted));
        }
        (order, given) => (order.unwrap_or(0), given),
    };
    if given.is_none() {
        return Ok(Observed::default());
    }
    let mut errors = Errors::default();
    let observed = Observed {
        formulas: errors.list(each(checker, &key.child("formulas"), &raw.formulas, formula::<D>)),
        probes: errors.list(each(checker, &key.child("probes"), &raw.probes, |checker, at| probe(checker, at, mesh))),
        lines: errors.list(each(checker, &key.child("lines"), &raw.lines, |checker, at| line(checker, at, mesh))),
        slices: errors.list(each(checker, &key.child("slices"), &raw.slices, |checker, at| slice(checker, at, order))),
    };
    errors.all().map(|()| observed)
}

/// An entry of a table of named things.
struct Named<'a, T> {
    key: Key,
    name: &'a str,
    raw: &'a T,
}

fn each<'a, T, O>(
    checker: &Checker<'_>,
    key: &Key,
    table: &'a BTreeMap<String, T>,
    check: impl Fn(&Checker<'_>, Named<'a, T>) -> Checked<O>,
) -> Checked<Vec<O>> {
    let entry = |(name, raw): (&'a String, &'a T)| {
        let key = key.child(name);
        check_name(checker, &key, name)?;
        check(checker, Named { key, name, raw })
    };
    collected(table.iter().map(entry))
}

fn formula<const D: usize>(checker: &Checker<'_>, at: Named<'_, raw::Formula>) -> Checked<FieldFormula> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let is_name = at.name.chars().all(plain) && !at.name.starts_with(|c: char| c.is_ascii_digit());
    let known: Vec<String> =
        Field::ALL.iter().filter_map(|field| Some(serde_json::to_value(field).ok()?.as_str()?.to_owned())).collect();
    let is_free = !known.iter().any(|name| name == at.name) && Field::components_of_flow(D).all(|name| name != at.name);
    let accepted = "a name of letters, digits and _ that no field has, nor an average; not t, s, x, y or z";
    let is_free = is_free && !is_variable(at.name) && !is_name_of_average(at.name);
    if !(is_name && is_free) {
        let problem = if is_name { "this name has another meaning" } else { "this is no name of a formula" };
        return Err(checker.combination(&at.key, problem, accepted));
    }
    let program = checker.formula_of_fields::<D>(&at.key, at.raw)?;
    checker.require_finite_somewhere(&at.key, "the value of the formula", &program)?;
    Ok(FieldFormula { name: at.name.to_owned(), program })
}

/// Whether `output.averages` may write a field of this name.
pub fn is_name_of_average(name: &str) -> bool {
    let of_budget =
        ["production", "dissipation", "pressure_dilatation", "turbulent_flux", "pressure_flux", "viscous_flux"];
    of_budget.contains(&name) || ["mean_", "rms_", "reynolds_stress_"].iter().any(|prefix| name.starts_with(prefix))
}

fn probe<const D: usize>(
    checker: &Checker<'_>,
    Named { key, name, raw }: Named<'_, raw::Probe>,
    mesh: &Mesh<D>,
) -> Checked<Probe<D>> {
    let at: [f64; D] = checker.finite_vector(&key.child("at"), "the coordinate", &raw.at)?;
    let accepted = "a point inside the flow (its mesh at rest), or on its boundary";
    checker.require(&key.child("at"), "the point", mesh.locate(&at).is_some(), accepted)?;
    let fields = fields(checker, &key, &raw.fields)?;
    Ok(Probe { name: name.to_owned(), at, carried: raw.carried, fields })
}

fn line<const D: usize>(
    checker: &Checker<'_>,
    Named { key, name, raw }: Named<'_, raw::Line>,
    mesh: &Mesh<D>,
) -> Checked<Line<D>> {
    file_name(checker, &key, name)?;
    let line = Line {
        name: name.to_owned(),
        points: points_of_line(checker, &key, raw)?,
        every: checker.at_least_one(&key.child("every"), "the number of slabs", raw.every)?,
        carried: raw.carried,
        fields: fields(checker, &key, &raw.fields)?,
    };
    if line.carried && !line.meets(mesh) {
        let problem = "the mesh carries this line, and no point of it lies in the mesh of the flow at rest";
        return Err(checker.combination(
            &key,
            problem,
            "`from` and `to` inside the flow (its mesh at rest), or on its boundary",
        ));
    }
    Ok(line)
}

/// Equidistant points from one end to the other.
fn points_of_line<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Line) -> Checked<Vec<[f64; D]>> {
    let from: [f64; D] = checker.finite_vector(&key.child("from"), "the coordinate", &raw.from)?;
    let to: [f64; D] = checker.finite_vector(&key.child("to"), "the coordinate", &raw.to)?;
    checker.require(&key.child("to"), "the end of the line", from != to, "a point other than the start")?;
    let count = (2..=100_000).contains(&raw.points);
    checker.require(&key.child("points"), "the number of points", count, "2 to 100000 points")?;
    let last = (raw.points - 1) as f64;
    let at = |k: usize| {
        let part = k as f64 / last;
        std::array::from_fn(|i| (1.0 - part) * from[i] + part * to[i])
    };
    Ok((0..raw.points).map(at).collect())
}

fn slice<const D: usize>(
    checker: &Checker<'_>,
    Named { key, name, raw }: Named<'_, raw::Slice>,
    order: usize,
) -> Checked<Slice<D>> {
    if D == 2 {
        let problem = "a plane through a two-dimensional mesh is the mesh itself";
        return Err(checker.dimension(&key, problem, "`output.lines`, or a mesh of three dimensions"));
    }
    file_name(checker, &key, name)?;
    let normal: [f64; D] = checker.finite_vector(&key.child("normal"), "the component", &raw.normal)?;
    let length = tensor::norm(&normal);
    let accepted = "a vector that is not zero, nor of infinite length";
    checker.require(&key.child("normal"), "the normal", length > 0.0 && length.is_finite(), accepted)?;
    let parts = raw.parts.unwrap_or(order.saturating_sub(1).max(1));
    checker.require(&key.child("parts"), "the number of parts", (1..=32).contains(&parts), "1 to 32 parts")?;
    Ok(Slice {
        name: name.to_owned(),
        point: checker.finite_vector(&key.child("point"), "the coordinate", &raw.point)?,
        normal: normal.map(|n| n / length),
        every: checker.at_least_one(&key.child("every"), "the number of slabs", raw.every)?,
        parts,
        csv: raw.csv,
        fields: fields(checker, &key, &raw.fields)?,
    })
}

/// The fields of a point, line or plane: those of the flow and of its mesh.
fn fields(checker: &Checker<'_>, key: &Key, fields: &[Field]) -> Checked<Vec<Field>> {
    let key = key.child("fields");
    checker.require(&key, "the list", !fields.is_empty(), "at least one field, or no key for the usual ones")?;
    for (index, field) in checker.distinct(&key, "field", fields)?.iter().enumerate() {
        let is_of_flow = !field.is_of_structure();
        checker.require(&key.entry(index), "the field of a structure", is_of_flow, "a field of the flow")?;
    }
    Ok(fields.to_vec())
}

/// A name becomes a part of the first line of history.csv.
pub(super) fn check_name(checker: &Checker<'_>, key: &Key, name: &str) -> Checked<()> {
    let is_printable = !name.is_empty() && !name.contains(char::is_control);
    checker.require(key, "the name of the point", is_printable, "a name of printable characters, on one line")
}

/// A name that becomes a part of the name of a file.
fn file_name(checker: &Checker<'_>, key: &Key, name: &str) -> Checked<()> {
    let plain = |c: char| c.is_alphanumeric() || "_-".contains(c);
    let is_plain = name.chars().all(plain) && name.len() <= 100;
    checker.require(key, "the name", is_plain, "letters, digits, _ and -: it becomes a part of the name of a file")
}

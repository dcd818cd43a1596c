//! Errors that may only follow from other errors.
//!
//! A case with errors is checked as far as it can be read. What was removed or replaced on the way is the damage. An error that the
//! damage may have caused is not reported.

use super::cause::Cause;
use super::error::CaseError;
use super::key::{Key, Step};

/// Sections on which no other section depends.
const INDEPENDENT: [&str; 3] = ["output", "parallel", "solver"];

/// Sections that only define names for formulas, or nothing at all. The checker knows which names are lost.
const NAMES: [&str; 4] = ["constants", "tables", "controls", "title"];

/// Keys whose ranges depend on the geometry of the mesh.
const BY_GEOMETRY: [&str; 15] = [
    "flow.quadrature",
    "flow.boundary",
    "flow.initial",
    "flow.exact",
    "flow.source",
    "flow.sponge",
    "motion.boundary",
    "motion.displacement",
    "motion.elasticity.stiffness",
    "structure",
    "bodies",
    "output.probes",
    "output.lines",
    "output.slices",
    "parallel",
];

/// The parts of a case that are not as the user meant them.
#[derive(Clone, Debug, Default)]
pub(super) struct Damage {
    keys: Vec<Key>,
    /// Whether another mesh with the same boundaries stands for the given one.
    pub(super) of_geometry: bool,
}

impl Damage {
    /// The value at `key` was removed or replaced.
    pub(super) fn add(&mut self, key: Key) {
        self.keys.push(key);
    }

    /// The damaged keys.
    pub(super) fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// Whether the section `name` is damaged.
    pub(super) fn has(&self, name: &str) -> bool {
        self.keys.iter().any(|key| section(&key.to_string()) == name)
    }

    /// Whether the boundaries and the dimension of the mesh may not be those that the user meant.
    pub(super) fn hides_boundaries(&self) -> bool {
        let order = Key::new("mesh.order");
        self.keys.iter().any(|key| section(&key.to_string()) == "mesh" && *key != order)
    }

    /// Whether the conditions of the flow may not be those that the user meant.
    pub(super) fn hides_conditions(&self) -> bool {
        let conditions = "flow.boundary";
        self.keys.iter().map(Key::to_string).any(|key| within(&key, conditions) || within(conditions, &key))
    }

    /// Whether a name of formulas is lost: its definition in `[constants]`, `[tables]` or `[controls]` is damaged.
    pub(super) fn hides_name(&self, name: &str) -> bool {
        self.keys.iter().any(|key| match &key.0[..] {
            [Step::Name(section)] => NAMES[..3].contains(&section.as_str()),
            [Step::Name(section), Step::Name(lost), ..] => NAMES[..3].contains(&section.as_str()) && lost == name,
            _ => false,
        })
    }

    /// Whether `error` may only follow from the damage.
    pub(super) fn explains(&self, error: &CaseError) -> bool {
        self.of_geometry && by_geometry(error) || self.keys.iter().any(|key| explains(&key.to_string(), error))
    }
}

/// Whether the error at its key may follow from another geometry of the mesh.
fn by_geometry(error: &CaseError) -> bool {
    !is_local(&error.cause) && BY_GEOMETRY.iter().any(|key| within(&error.key, key))
}

/// Whether damage at the key `damaged` may have caused `error`.
fn explains(damaged: &str, error: &CaseError) -> bool {
    let (of_damage, of_error) = (section(damaged), section(&error.key));
    if within(damaged, &error.key) || within(&error.key, damaged) {
        return true;
    }
    if is_local(&error.cause) || NAMES.contains(&of_damage) {
        return false;
    }
    let table = damaged.rsplit_once('.').map_or("", |(table, _)| table);
    match error.cause {
        Cause::OutOfRange { .. } => of_damage == of_error && is_related(damaged, table, &error.key),
        // What is written at one place says nothing about what is written at another.
        _ if of_damage == "output" => table != of_damage && within(&error.key, table),
        _ => of_damage == of_error || !INDEPENDENT.contains(&of_damage),
    }
}

/// Whether the range of the number at `key` may depend on the value of `damaged`, a key of `table`.
fn is_related(damaged: &str, table: &str, key: &str) -> bool {
    let of_flow = ["flow.order", "flow.gas", "flow.initial", "flow.exact", "flow.reference"];
    // A section is not a table whose numbers limit each other, except for the time.
    let in_table = (table.contains('.') || table == "time") && within(key, table);
    // The numbers of the gas depend only on each other.
    in_table || !within(key, "flow.gas") && of_flow.iter().any(|part| within(damaged, part))
}

/// Whether the cause lies in the value alone, or in names.
fn is_local(cause: &Cause) -> bool {
    matches!(
        cause,
        Cause::Expression(_)
            | Cause::Unknown { .. }
            | Cause::NoCondition { .. }
            | Cause::Length { .. }
            | Cause::Entries { .. }
            | Cause::Twice { .. }
            | Cause::NotPositive { .. }
            | Cause::Dimension { .. }
    )
}

/// The first name of a key.
fn section(key: &str) -> &str {
    key.split(['.', '[']).next().unwrap_or_default()
}

/// Whether the key `inner` is `outer` or lies in it. Everything lies in the whole document.
fn within(inner: &str, outer: &str) -> bool {
    let rest = inner.strip_prefix(outer);
    outer.is_empty() || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    fn error(key: &str, cause: Cause) -> CaseError {
        let place = Place::Option(String::new());
        CaseError { place, key: key.to_owned(), value: None, cause, also: Vec::new() }
    }

    #[test]
    fn errors_that_may_follow_are_told_from_others() {
        let range = || Cause::OutOfRange { quantity: String::new(), accepted: String::new() };
        let conflict = || Cause::Combination { problem: String::new(), accepted: String::new() };
        let positive = || Cause::NotPositive { quantity: String::new() };
        let dimension = || Cause::Dimension { problem: String::new(), accepted: String::new() };
        let length = || Cause::Length { found: 1, dimension: 2 };
        for (damaged, key, cause, follows) in [
            ("flow.riemann", "flow", conflict(), true),
            ("flow.riemann", "flow.gas.gamma", range(), false),
            ("flow.order", "flow.quadrature.points", range(), true),
            ("time.start", "time.end", range(), true),
            ("flow.initial.uniform.mach", "flow.initial.uniform.velocity", range(), true),
            ("flow.initial.uniform.mach", "flow.boundary.left.adiabatic_wall.slide", length(), false),
            ("output.fields", "flow", conflict(), false),
            ("output.fields", "output.surfaces.walls", conflict(), false),
            ("output.lines.a.to", "output.lines.a", conflict(), true),
            ("flow.gas", "flow.boundary.left.far_field.mach", positive(), false),
            ("flow.gas", "output.slices.a", dimension(), false),
            ("flow", "", conflict(), true),
            ("motion.elasticity", "output.probes.a.at", length(), false),
        ] {
            let mut damage = Damage::default();
            damage.add(Key::new(damaged));
            assert_eq!(damage.explains(&error(key, cause)), follows, "{damaged} {key}");
        }
    }

    #[test]
    fn names_are_lost_with_their_definitions() {
        let mut damage = Damage::default();
        damage.add(Key::new("constants.a"));
        assert!(damage.hides_name("a") && !damage.hides_name("b"));
        damage.add(Key::new("tables"));
        assert!(damage.hides_name("b") && !damage.hides_boundaries());
    }
}

//! The meaning of names in formulas.

use super::control::ControlValue;
use super::lexer;
use super::table::Table;
use std::collections::BTreeMap;
use std::sync::Arc;
use tensor::AXES;

/// A variable of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    /// An entry of the position: the coordinates x, y, z, and after them the arc length s, if there is one.
    Coordinate(usize),
    /// The time t.
    Time,
}

/// Variables, constants and tables of a formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Names {
    /// The names of the entries of the position.
    position: Vec<&'static str>,
    time: bool,
    constants: BTreeMap<String, f64>,
    tables: BTreeMap<String, Arc<Table>>,
    controls: BTreeMap<String, ControlValue>,
}

/// Functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Abs,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Tanh,
    Sinh,
    Cosh,
    Deg,
    Floor,
}

/// Names that are called like functions.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Callable {
    Unary(Function),
    Min,
    Max,
    Atan2,
    If,
    Table(Arc<Table>),
}

/// The meaning of a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meaning {
    Variable(Variable),
    Constant(f64),
    Control(ControlValue),
    Callable(Callable),
}

const ARC_LENGTH: &str = "s";

const TIME: &str = "t";

/// Whether some formula has a variable of this name: a coordinate, the arc length or the time.
pub fn is_variable(name: &str) -> bool {
    name == TIME || name == ARC_LENGTH || AXES.contains(&name)
}

static CALLABLES: [(&str, Callable); 19] = [
    ("if", Callable::If),
    ("min", Callable::Min),
    ("max", Callable::Max),
    ("abs", Callable::Unary(Function::Abs)),
    ("sqrt", Callable::Unary(Function::Sqrt)),
    ("exp", Callable::Unary(Function::Exp)),
    ("log", Callable::Unary(Function::Log)),
    ("sin", Callable::Unary(Function::Sin)),
    ("cos", Callable::Unary(Function::Cos)),
    ("tan", Callable::Unary(Function::Tan)),
    ("asin", Callable::Unary(Function::Asin)),
    ("acos", Callable::Unary(Function::Acos)),
    ("atan2", Callable::Atan2),
    ("atan", Callable::Unary(Function::Atan)),
    ("tanh", Callable::Unary(Function::Tanh)),
    ("sinh", Callable::Unary(Function::Sinh)),
    ("cosh", Callable::Unary(Function::Cosh)),
    ("deg", Callable::Unary(Function::Deg)),
    ("floor", Callable::Unary(Function::Floor)),
];

impl Callable {
    /// The number of arguments.
    pub(super) fn arguments(&self) -> usize {
        match self {
            Callable::Unary(_) | Callable::Table(_) => 1,
            Callable::Min | Callable::Max | Callable::Atan2 => 2,
            Callable::If => 3,
        }
    }
}

impl Names {
    /// The names of a formula without variables: functions and pi.
    pub fn constants_only() -> Self {
        Names {
            position: Vec::new(),
            time: false,
            constants: BTreeMap::from([("pi".to_owned(), std::f64::consts::PI)]),
            tables: BTreeMap::new(),
            controls: BTreeMap::new(),
        }
    }

    /// These constants, and the coordinates for the given dimension.
    pub fn with_coordinates(&self, dimension: usize) -> Self {
        Names { position: AXES[..dimension].to_vec(), ..self.clone() }
    }

    /// These names, and s, the arc length along a curve, as the entry of the position after the coordinates.
    pub fn with_arc_length(&self) -> Self {
        let position = self.position.iter().copied().chain([ARC_LENGTH]).collect();
        Names { position, ..self.clone() }
    }

    /// These names, and those of `fields` as the entries of the position after its present ones. They hide constants.
    pub fn with_fields(&self, fields: impl Iterator<Item = &'static str>) -> Self {
        let position = self.position.iter().copied().chain(fields).collect();
        Names { position, ..self.clone() }
    }

    /// These names and the time t.
    pub fn with_time(&self) -> Self {
        Names { time: true, ..self.clone() }
    }

    /// Defines a constant; false if `name` is not a valid name, or already has a meaning in this or another formula.
    pub fn define(&mut self, name: &str, value: f64) -> bool {
        let free = self.is_free(name);
        if free {
            self.constants.insert(name.to_owned(), value);
        }
        free
    }

    /// The constants that were defined, with their values.
    pub fn constants(&self) -> impl Iterator<Item = (&str, f64)> {
        let defined = self.constants.iter().filter(|(name, _)| *name != "pi");
        defined.map(|(name, value)| (name.as_str(), *value))
    }

    /// Defines a function of one argument by its `table`; false as for [`Names::define`].
    pub fn define_table(&mut self, name: &str, table: Table) -> bool {
        let free = self.is_free(name);
        if free {
            self.tables.insert(name.to_owned(), Arc::new(table));
        }
        free
    }

    /// These names and those of `controls`.
    pub fn with_controls(&self, controls: impl Iterator<Item = (String, ControlValue)>) -> Self {
        Names { controls: controls.collect(), ..self.clone() }
    }

    /// The tables, by name.
    pub fn tables(&self) -> impl Iterator<Item = (&str, &Table)> {
        self.tables.iter().map(|(name, table)| (name.as_str(), table.as_ref()))
    }

    /// Whether `name` is a valid name, and has no meaning in this or another formula.
    pub fn is_free(&self, name: &str) -> bool {
        !is_variable(name) && self.meaning(name).is_none() && lexer::is_name(name)
    }

    pub(super) fn meaning(&self, name: &str) -> Option<Meaning> {
        if let Some(entry) = self.position.iter().position(|entry| *entry == name) {
            return Some(Meaning::Variable(Variable::Coordinate(entry)));
        }
        if self.time && name == TIME {
            return Some(Meaning::Variable(Variable::Time));
        }
        if let Some(value) = self.constants.get(name) {
            return Some(Meaning::Constant(*value));
        }
        if let Some(value) = self.controls.get(name) {
            return Some(Meaning::Control(value.clone()));
        }
        if let Some(table) = self.tables.get(name) {
            return Some(Meaning::Callable(Callable::Table(table.clone())));
        }
        CALLABLES.iter().find(|(known, _)| *known == name).map(|(_, callable)| Meaning::Callable(callable.clone()))
    }

    /// Every name, variables first, then constants and tables.
    pub(super) fn known(&self) -> Vec<String> {
        let variables = self.position.iter().copied().chain(self.time.then_some(TIME));
        let constants = self.constants.keys().chain(self.controls.keys()).chain(self.tables.keys()).map(String::as_str);
        let callables = CALLABLES.iter().map(|(name, _)| *name);
        variables.chain(constants).chain(callables).map(str::to_owned).collect()
    }
}

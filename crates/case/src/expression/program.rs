//! The compiled formula: instructions of a stack machine, run on any number type.

use super::control::ControlValue;
use super::names::{Function, Variable};
use super::table::Table;
use std::f64::consts::PI;
use std::sync::Arc;
use tensor::Transcendental;

/// The largest number of values on the stack; a formula that needs more is refused when it is compiled.
pub(super) const STACK: usize = 32;

/// A comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comparison {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

/// One instruction: it takes its arguments from the stack and puts its result there.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Instruction {
    Constant(f64),
    Variable(Variable),
    Control(ControlValue),
    Negate,
    Apply(Function),
    /// The function of a table.
    Interpolate(Arc<Table>),
    /// An integer power, by multiplication, for any base.
    IntegerPower(i32),
    /// A constant real power, for a base that is not negative.
    RealPower(f64),
    Add,
    Subtract,
    Multiply,
    Divide,
    /// A variable power, exp(b log a), for a positive base.
    Power,
    Min,
    Max,
    /// (y, x): the angle of the point (x, y) from the x axis, from -pi to pi.
    Atan2,
    Compare(Comparison),
    /// (condition, a, b): a if the condition is not zero, otherwise b.
    Select,
}

impl Instruction {
    /// The number of values that it takes from the stack; it puts one there.
    pub(super) fn arguments(&self) -> usize {
        use Instruction::*;
        match self {
            Constant(_) | Variable(_) | Control(_) => 0,
            Negate | Apply(_) | Interpolate(_) | IntegerPower(_) | RealPower(_) => 1,
            Add | Subtract | Multiply | Divide | Power | Min | Max | Atan2 | Compare(_) => 2,
            Select => 3,
        }
    }
}

/// A compiled formula. Evaluation neither allocates nor fails: outside the domain of a function the result is NaN.
///
/// On duals the result carries exact derivatives; those of `if`, `min`, `max` and `abs` are of the branch taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub(super) instructions: Vec<Instruction>,
}

impl Program {
    /// A formula that is a plain number.
    pub fn constant(value: f64) -> Self {
        Program { instructions: vec![Instruction::Constant(value)] }
    }

    /// The product of `factor` and a number that the run changes.
    pub(crate) fn multiple(factor: f64, value: &ControlValue) -> Self {
        use Instruction::{Constant, Control, Multiply};
        Program { instructions: vec![Control(value.clone()), Constant(factor), Multiply] }
    }

    /// The formula + factor (value - start), with a number that the run changes.
    pub(crate) fn plus_change(mut self, factor: f64, value: &ControlValue, start: f64) -> Self {
        use Instruction::{Add, Constant, Control, Multiply, Subtract};
        self.instructions.extend([Control(value.clone()), Constant(start), Subtract, Constant(factor), Multiply, Add]);
        self
    }

    /// Whether the formula contains this number that the run changes.
    pub(crate) fn is_controlled_by(&self, value: &ControlValue) -> bool {
        self.instructions
            .iter()
            .any(|instruction| matches!(instruction, Instruction::Control(other) if other.is(value)))
    }

    /// Whether the formula contains a number that the run changes.
    pub(crate) fn is_controlled(&self) -> bool {
        self.instructions.iter().any(|instruction| matches!(instruction, Instruction::Control(_)))
    }

    /// The formula + slopes . (x - centre).
    pub(crate) fn plus_linear(mut self, slopes: &[f64], centre: &[f64]) -> Self {
        use Instruction::{Add, Constant, Multiply, Subtract};
        for (axis, (slope, centre)) in slopes.iter().zip(centre).enumerate().filter(|(_, (slope, _))| **slope != 0.0) {
            let x = Instruction::Variable(Variable::Coordinate(axis));
            self.instructions.extend([x, Constant(*centre), Subtract, Constant(*slope), Multiply, Add]);
        }
        self
    }

    /// The number of operations of an evaluation.
    pub fn operations(&self) -> usize {
        self.instructions.len()
    }

    /// The value of a formula without variables.
    pub fn as_constant(&self) -> Option<f64> {
        let varies =
            |instruction: &Instruction| matches!(instruction, Instruction::Variable(_) | Instruction::Control(_));
        let varies = self.instructions.iter().any(varies);
        (!varies).then(|| self.evaluate(&[], 0.0))
    }

    /// Whether the value depends on `variable`.
    pub fn contains(&self, variable: Variable) -> bool {
        self.instructions.contains(&Instruction::Variable(variable))
    }

    /// Whether the value depends on time, or on a number that the run changes.
    pub fn changes_in_time(&self) -> bool {
        self.contains(Variable::Time) || self.is_controlled()
    }

    /// Whether the value depends on a coordinate.
    pub fn depends_on_position(&self) -> bool {
        let is_coordinate =
            |instruction: &Instruction| matches!(instruction, Instruction::Variable(Variable::Coordinate(_)));
        self.instructions.iter().any(is_coordinate)
    }

    /// The value at the point `x` and time `t`. Entries beyond the length of `x` are zero.
    pub fn evaluate<T: Transcendental>(&self, x: &[T], t: T) -> T {
        let mut stack = [T::from(0.0); STACK];
        let mut top = 0;
        for instruction in &self.instructions {
            let base = top - instruction.arguments();
            stack[base] = step(instruction, &stack[base..top], x, t);
            top = base + 1;
        }
        stack[0]
    }
}

/// The result of one instruction.
pub(super) fn step<T: Transcendental>(instruction: &Instruction, a: &[T], x: &[T], t: T) -> T {
    match instruction {
        Instruction::Constant(value) => T::from(*value),
        Instruction::Variable(Variable::Coordinate(axis)) => x.get(*axis).copied().unwrap_or(T::from(0.0)),
        Instruction::Variable(Variable::Time) => t,
        Instruction::Control(value) => T::from(value.get()),
        Instruction::Negate => -a[0],
        Instruction::Apply(function) => apply(*function, a[0]),
        Instruction::Interpolate(table) => table.evaluate(a[0]),
        Instruction::IntegerPower(n) => integer_power(a[0], *n),
        Instruction::RealPower(exponent) => real_power(a[0], *exponent),
        Instruction::Add => a[0] + a[1],
        Instruction::Subtract => a[0] - a[1],
        Instruction::Multiply => a[0] * a[1],
        Instruction::Divide => a[0] / a[1],
        Instruction::Power => power(a[0], a[1]),
        Instruction::Min => without_value(a).unwrap_or_else(|| a[0].min(a[1])),
        Instruction::Max => without_value(a).unwrap_or_else(|| a[0].max(a[1])),
        Instruction::Atan2 => angle(a[0], a[1]),
        Instruction::Compare(comparison) => without_value(a)
            .unwrap_or_else(|| T::from(f64::from(u8::from(compare(*comparison, a[0].value(), a[1].value()))))),
        Instruction::Select => without_value(&a[..1]).unwrap_or(if a[0].value() != 0.0 { a[1] } else { a[2] }),
    }
}

/// The argument that is not a number, if there is one: a choice or a comparison must not hide that a table has ended.
fn without_value<T: Transcendental>(arguments: &[T]) -> Option<T> {
    arguments.iter().copied().find(|argument| argument.value().is_nan())
}

fn apply<T: Transcendental>(function: Function, a: T) -> T {
    match function {
        Function::Abs => a.abs(),
        Function::Sqrt => real_power(a, 0.5),
        Function::Exp => a.exp(),
        Function::Log => a.ln(),
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tan => a.sin() / a.cos(),
        // sqrt(1 - a^2) by factors keeps its digits where a is near 1.
        Function::Asin => angle(a, real_power((-a + 1.0) * (a + 1.0), 0.5)),
        Function::Acos => angle(real_power((-a + 1.0) * (a + 1.0), 0.5), a),
        Function::Atan => a.atan(),
        Function::Tanh => a.tanh(),
        Function::Sinh => sinh(a),
        // (e^a + e^-a) / 2
        Function::Cosh => (a.exp() + (-a).exp()) * 0.5,
        Function::Deg => a * (PI / 180.0),
        Function::Floor => T::from(a.value().floor()),
    }
}

fn compare(comparison: Comparison, a: f64, b: f64) -> bool {
    match comparison {
        Comparison::Less => a < b,
        Comparison::LessEqual => a <= b,
        Comparison::Greater => a > b,
        Comparison::GreaterEqual => a >= b,
        Comparison::Equal => a == b,
        Comparison::NotEqual => a != b,
    }
}

/// The angle of the point (x, y) from the x axis, from -pi to pi; 0 at the origin.
fn angle<T: Transcendental>(y: T, x: T) -> T {
    let half_turn = if y.value() < 0.0 { -PI } else { PI };
    if x.value() == 0.0 && y.value() == 0.0 {
        T::from(0.0)
    } else if x.value().abs() < y.value().abs() {
        -(x / y).atan() + half_turn / 2.0
    } else {
        (y / x).atan() + if x.value() < 0.0 { half_turn } else { 0.0 }
    }
}

/// a^n by repeated squaring.
fn integer_power<T: Transcendental>(a: T, n: i32) -> T {
    let (mut result, mut square, mut rest) = (T::from(1.0), a, n.unsigned_abs());
    while rest > 0 {
        if rest & 1 == 1 {
            result = result * square;
        }
        rest >>= 1;
        if rest > 0 {
            square = square * square;
        }
    }
    if n < 0 { result.recip() } else { result }
}

/// sinh a. Where a is small, e^a - e^-a would lose digits; 2 t / (1 - t^2) with t = tanh(a / 2) does not.
fn sinh<T: Transcendental>(a: T) -> T {
    if a.value().abs() < 1.0 {
        let t = (a * 0.5).tanh();
        return t * 2.0 / (-(t * t) + 1.0);
    }
    (a.exp() - (-a).exp()) * 0.5
}

/// a^exponent, at a = 0 by [`power_of_zero`].
fn real_power<T: Transcendental>(a: T, exponent: f64) -> T {
    match exponent {
        _ if a.value() == 0.0 && exponent > 0.0 => power_of_zero(a, exponent),
        0.5 => a.sqrt(),
        _ => a.powf(exponent),
    }
}

/// a^b = e^(b ln a), at a = 0 by [`power_of_zero`].
fn power<T: Transcendental>(a: T, b: T) -> T {
    if a.value() == 0.0 && b.value() > 0.0 { power_of_zero(a, b.value()) } else { (b * a.ln()).exp() }
}

/// a^exponent where a = 0, for a positive exponent: the general formulas give the slope 0 / 0. It is 0 for an exponent above 1, and infinite for
/// one below 1. If a does not vary, neither does the power, so that its derivative is 0 and not infinity times 0.
fn power_of_zero<T: Transcendental>(a: T, exponent: f64) -> T {
    match exponent {
        _ if exponent > 1.0 => a * 0.0,
        1.0 => a,
        _ => a * f64::MAX * f64::MAX,
    }
}

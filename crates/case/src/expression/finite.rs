//! Formulas that have a finite value nowhere.

use super::program::{Instruction, Program, step};

impl Program {
    /// Whether the formula has a finite value nowhere, for it takes up a part without one, such as 1/0.
    pub(crate) fn is_finite_nowhere(&self) -> bool {
        let mut stack = Vec::new();
        for instruction in &self.instructions {
            let arguments = stack.split_off(stack.len() - instruction.arguments());
            stack.push(Known::of(instruction, &arguments));
        }
        stack.last().is_some_and(Known::is_not_finite)
    }
}

/// What is known of a value without its variables.
#[derive(Clone, Copy)]
enum Known {
    Number(f64),
    /// No finite number, whatever the variables are.
    NotFinite,
    Nothing,
}

impl Known {
    fn of(instruction: &Instruction, arguments: &[Known]) -> Self {
        use Instruction::{Add, Divide, Multiply, Negate, Subtract};
        let number = |known: &Known| if let Known::Number(number) = known { Some(*number) } else { None };
        let varies = matches!(instruction, Instruction::Variable(_) | Instruction::Control(_));
        match arguments.iter().map(number).collect::<Option<Vec<f64>>>() {
            Some(numbers) if !varies => return Known::Number(step(instruction, &numbers, &[], 0.0)),
            _ => {}
        }
        // A finite number over an infinite one is zero.
        let keeping = match instruction {
            Negate | Add | Subtract | Multiply => arguments,
            Divide => &arguments[..1],
            _ => &[],
        };
        if keeping.iter().any(Known::is_not_finite) { Known::NotFinite } else { Known::Nothing }
    }

    fn is_not_finite(&self) -> bool {
        match self {
            Known::Number(number) => !number.is_finite(),
            Known::NotFinite => true,
            Known::Nothing => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Names;
    use super::Program;

    #[test]
    fn a_part_that_is_never_finite_makes_the_formula_so() {
        let names = Names::constants_only().with_coordinates(2).with_time();
        let nowhere = |text: &str| Program::compile(text, &names).is_ok_and(|program| program.is_finite_nowhere());
        for text in ["1/0", "1/0*x", "x - log(-1)", "-(t/(0*1)) + sqrt(-2)", "(0/0)/x"] {
            assert!(nowhere(text), "{text}");
        }
        for text in ["x", "1/x", "x/(1/0)", "atan(1/0)*x", "if(x > 0, 1/0, 2)", "min(x, 1/0)", "log(x)"] {
            assert!(!nowhere(text), "{text}");
        }
    }
}

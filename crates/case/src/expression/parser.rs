//! Tokens to a program, by recursive descent; the grammar is in the module above.

use super::error::{ExpressionError, Problem};
use super::lexer::{Kind, Token, tokens};
use super::names::{Callable, Meaning, Names};
use super::program::{Comparison, Instruction, Program, STACK};
use crate::nearest::nearest;

/// The largest number of levels of recursion.
const DEPTH: usize = 64;

/// The largest number of operations of a formula. It is evaluated at every node and time, so a longer one would dominate
/// the run.
pub(super) const LONGEST: usize = 50_000;

/// Exponents up to this size are computed by multiplication.
const LARGEST_INTEGER_POWER: f64 = 1024.0;

struct Parser<'a> {
    text: &'a str,
    names: &'a Names,
    tokens: Vec<Token>,
    next: usize,
    depth: usize,
    /// The number of values on the stack after the instructions so far.
    height: usize,
    instructions: Vec<Instruction>,
}

type Parsed<T = ()> = Result<T, ExpressionError>;

/// Compiles `text`.
pub(super) fn parse(text: &str, names: &Names) -> Parsed<Program> {
    let tokens = tokens(text)?;
    let mut parser = Parser { text, names, tokens, next: 0, depth: 0, height: 0, instructions: Vec::new() };
    parser.comparison()?;
    if parser.token().kind != Kind::End {
        return Err(parser.unexpected("an operator such as `*`, or the end of the expression"));
    }
    Ok(Program { instructions: parser.instructions })
}

impl Parser<'_> {
    fn comparison(&mut self) -> Parsed {
        self.enter()?;
        self.sum()?;
        let comparison = match self.token().kind {
            Kind::Symbol("<") => Some(Comparison::Less),
            Kind::Symbol("<=") => Some(Comparison::LessEqual),
            Kind::Symbol(">") => Some(Comparison::Greater),
            Kind::Symbol(">=") => Some(Comparison::GreaterEqual),
            Kind::Symbol("==") => Some(Comparison::Equal),
            Kind::Symbol("!=") => Some(Comparison::NotEqual),
            _ => None,
        };
        if let Some(comparison) = comparison {
            self.next += 1;
            self.sum()?;
            self.emit(Instruction::Compare(comparison))?;
        }
        self.depth -= 1;
        Ok(())
    }

    fn sum(&mut self) -> Parsed {
        self.product()?;
        loop {
            let instruction = match self.token().kind {
                Kind::Symbol("+") => Instruction::Add,
                Kind::Symbol("-") => Instruction::Subtract,
                _ => return Ok(()),
            };
            self.next += 1;
            self.product()?;
            self.emit(instruction)?;
        }
    }

    fn product(&mut self) -> Parsed {
        self.signed()?;
        loop {
            let instruction = match self.token().kind {
                Kind::Symbol("*") => Instruction::Multiply,
                Kind::Symbol("/") => Instruction::Divide,
                _ => return Ok(()),
            };
            self.next += 1;
            self.signed()?;
            self.emit(instruction)?;
        }
    }

    fn signed(&mut self) -> Parsed {
        let mut negative = false;
        loop {
            match self.token().kind {
                Kind::Symbol("-") => negative = !negative,
                Kind::Symbol("+") => {}
                _ => break,
            }
            self.next += 1;
        }
        self.power()?;
        if negative { self.emit(Instruction::Negate) } else { Ok(()) }
    }

    fn power(&mut self) -> Parsed {
        self.atom()?;
        if !self.accept("^") {
            return Ok(());
        }
        self.enter()?;
        self.signed()?;
        self.depth -= 1;
        self.emit_power()
    }

    fn atom(&mut self) -> Parsed {
        match self.token().kind.clone() {
            Kind::Number(value) => {
                self.next += 1;
                self.emit(Instruction::Constant(value))
            }
            Kind::Name(name) => self.name(&name),
            Kind::Symbol("(") => {
                self.next += 1;
                self.comparison()?;
                self.expect(")", "`)` or an operator such as `*`")
            }
            _ => Err(self.unexpected("a number, a name or `(`")),
        }
    }

    fn name(&mut self, name: &str) -> Parsed {
        let meaning = self.names.meaning(name).ok_or_else(|| self.unknown(name))?;
        let called = self.tokens[self.next + 1].kind == Kind::Symbol("(");
        match meaning {
            Meaning::Callable(callable) if called => self.call(name, callable),
            Meaning::Callable(callable) => Err(self.misused(name, &callable)),
            _ if called => {
                let write = format!("`{name} * (...)`");
                Err(self.error(Problem::Misused { name: name.to_owned(), is: "number, not a function", write }))
            }
            Meaning::Variable(variable) => {
                self.next += 1;
                self.emit(Instruction::Variable(variable))
            }
            Meaning::Constant(value) => {
                self.next += 1;
                self.emit(Instruction::Constant(value))
            }
            Meaning::Control(value) => {
                self.next += 1;
                self.emit(Instruction::Control(value))
            }
        }
    }

    fn call(&mut self, name: &str, callable: Callable) -> Parsed {
        let start = self.next;
        self.next += 2;
        let mut found = 0;
        if self.token().kind != Kind::Symbol(")") {
            loop {
                self.comparison()?;
                found += 1;
                if !self.accept(",") {
                    break;
                }
            }
        }
        self.expect(")", "`,`, `)` or an operator such as `*`")?;
        let takes = callable.arguments();
        if found != takes {
            self.next = start;
            return Err(self.error(Problem::Arguments { name: name.to_owned(), takes, found }));
        }
        self.emit(match callable {
            Callable::Unary(function) => Instruction::Apply(function),
            Callable::Min => Instruction::Min,
            Callable::Max => Instruction::Max,
            Callable::Atan2 => Instruction::Atan2,
            Callable::If => Instruction::Select,
            Callable::Table(table) => Instruction::Interpolate(table),
        })
    }

    /// Appends an instruction. If all its arguments are constants, it is evaluated at once.
    fn emit(&mut self, instruction: Instruction) -> Parsed {
        let arguments = instruction.arguments();
        self.height = self.height + 1 - arguments;
        if self.height > STACK {
            return Err(self.error(Problem::TooDeep(STACK)));
        }
        if self.instructions.len() == LONGEST {
            return Err(self.error(Problem::TooLong(LONGEST)));
        }
        self.instructions.push(instruction);
        let start = self.instructions.len() - 1 - arguments;
        let constant = |i: &Instruction| matches!(i, Instruction::Constant(_));
        if arguments > 0 && self.instructions[start..].iter().filter(|i| constant(i)).count() == arguments {
            let instructions = self.instructions.split_off(start);
            let value = Program { instructions }.evaluate(&[], 0.0);
            self.instructions.push(Instruction::Constant(value));
        }
        Ok(())
    }

    /// Appends the power instruction that suits the exponent, which has just been emitted.
    fn emit_power(&mut self) -> Parsed {
        let Some(Instruction::Constant(exponent)) = self.instructions.last().cloned() else {
            return self.emit(Instruction::Power);
        };
        self.instructions.pop();
        self.height -= 1;
        let integer = exponent.fract() == 0.0 && exponent.abs() <= LARGEST_INTEGER_POWER;
        self.emit(if integer { Instruction::IntegerPower(exponent as i32) } else { Instruction::RealPower(exponent) })
    }

    fn token(&self) -> &Token {
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    fn accept(&mut self, symbol: &'static str) -> bool {
        let found = self.token().kind == Kind::Symbol(symbol);
        self.next += usize::from(found);
        found
    }

    fn expect(&mut self, symbol: &'static str, expected: &'static str) -> Parsed {
        if self.accept(symbol) { Ok(()) } else { Err(self.unexpected(expected)) }
    }

    fn enter(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEPTH { Err(self.error(Problem::TooDeep(DEPTH))) } else { Ok(()) }
    }

    /// The problem, at the current token.
    fn error(&self, problem: Problem) -> ExpressionError {
        let Token { position, length, .. } = *self.token();
        ExpressionError { text: self.text.to_owned(), position, length, problem }
    }

    fn unexpected(&self, expected: &'static str) -> ExpressionError {
        let found = match &self.token().kind {
            Kind::Number(value) => format!("the number {value}"),
            Kind::Name(name) => format!("`{name}`"),
            Kind::Symbol(symbol) => format!("`{symbol}`"),
            Kind::End => "the end of the expression".to_owned(),
        };
        self.error(Problem::Unexpected { expected, found })
    }

    fn unknown(&self, name: &str) -> ExpressionError {
        let known = self.names.known();
        let nearest = nearest(name, known.iter().map(String::as_str)).map(str::to_owned);
        self.error(Problem::UnknownName { name: name.to_owned(), nearest, known })
    }

    fn misused(&self, name: &str, callable: &Callable) -> ExpressionError {
        let arguments = ["x", "a, b", "condition, a, b"][callable.arguments() - 1];
        let (is, arguments) = if let Callable::Table(_) = callable { ("table", "t") } else { ("function", arguments) };
        self.error(Problem::Misused { name: name.to_owned(), is, write: format!("`{name}({arguments})`") })
    }
}

//! Values: numbers, parameters, functions, and expressions in brackets.
//!
//! ```text
//!   value      = number | ("+" | "-") value | "[" expression "]" | "#" parameter
//!              | "ATAN" "[" expression "]" "/" "[" expression "]"
//!              | "EXISTS" "[" "#" parameter "]" | function "[" expression "]"
//!   parameter  = "<" name ">" | value
//!   expression = value { operator value }        operators by strength, equals to the left
//! ```
//!
//! Recursive descent with the depth handed down, so that no line can exhaust the stack.

use crate::MAX_NESTING;
use crate::expression::{Expr, Function, Operator, Parameter, Value};
use crate::fanuc::Grammar;
use crate::line::{Line, Read};
use crate::problem::Problem;

impl Line<'_, '_> {
    /// The value of a word, parameter setting or argument.
    pub(crate) fn whole_value(&mut self) -> Read<Value> {
        self.nodes_before = self.block.nodes.len();
        self.value(0)
    }

    /// What a setting sets: Fanuc needs no brackets around `#1=#1+1`.
    pub(crate) fn setting_value(&mut self) -> Read<Value> {
        match self.grammar {
            Grammar::Rs274 | Grammar::Grbl => self.whole_value(),
            Grammar::Fanuc => {
                self.nodes_before = self.block.nodes.len();
                self.expression(1, 0)
            }
        }
    }

    /// A value, `depth` levels below the word it belongs to.
    pub(crate) fn value(&mut self, depth: u32) -> Read<Value> {
        let from = self.start();
        if depth > MAX_NESTING {
            return self.fault_here(Problem::TooDeep);
        }
        match self.peek() {
            b'0'..=b'9' | b'.' => Ok(Value::Number(self.number()?)),
            sign @ (b'+' | b'-') => self.signed(sign, from, depth),
            b'[' => self.bracket(depth),
            b'#' => {
                let parameter = self.parameter(depth)?;
                self.keep(Expr::Parameter(parameter), from)
            }
            b'A'..=b'Z' => self.function(from, depth),
            _ => self.fault_here(Problem::ValueExpected),
        }
    }

    fn signed(&mut self, sign: u8, from: usize, depth: u32) -> Read<Value> {
        self.take();
        if matches!(self.peek(), b'0'..=b'9' | b'.') {
            self.at = from;
            return Ok(Value::Number(self.number()?));
        }
        let operand = self.value(depth + 1)?;
        if sign == b'+' { Ok(operand) } else { self.keep(Expr::Negate(operand), from) }
    }

    /// `[expression]`: the `[` comes next.
    pub(crate) fn bracket(&mut self, depth: u32) -> Read<Value> {
        self.take();
        let value = self.expression(1, depth + 1)?;
        if !self.take_if(b']') {
            return self.fault_here(Problem::OperatorExpected);
        }
        Ok(value)
    }

    /// `#...`: the `#` comes next.
    pub(crate) fn parameter(&mut self, depth: u32) -> Read<Parameter> {
        self.take();
        if self.peek() == b'<' {
            return Ok(Parameter::Named(self.name()?));
        }
        Ok(Parameter::Numbered(self.value(depth + 1)?))
    }

    /// Values and operators at least as strong as `weakest`.
    fn expression(&mut self, weakest: u8, depth: u32) -> Read<Value> {
        let from = self.start();
        let mut left = self.value(depth)?;
        loop {
            let before = (self.at, self.end);
            let Some(operator) = self.operator()? else { return Ok(left) };
            let strength = self.grammar.strength(operator);
            if strength < weakest {
                (self.at, self.end) = before;
                return Ok(left);
            }
            let right = self.expression(strength + 1, depth)?;
            left = self.keep(Expr::Binary { operator, left, right }, from)?;
        }
    }

    /// The operator that comes next; `None` before `]`.
    fn operator(&mut self) -> Read<Option<Operator>> {
        let from = self.start();
        let simple = match self.peek() {
            b']' => return Ok(None),
            0 | b'(' | b',' if self.grammar == Grammar::Fanuc => return Ok(None), // `#1=#1+1`
            b'+' => Operator::Plus,
            b'-' => Operator::Minus,
            b'/' => Operator::Divide,
            b'*' => {
                self.take();
                let power = self.grammar != Grammar::Fanuc && self.take_if(b'*');
                return Ok(Some(if power { Operator::Power } else { Operator::Times }));
            }
            b'A'..=b'Z' => return self.operator_name(from),
            _ => return self.fault_here(Problem::OperatorExpected),
        };
        self.take();
        Ok(Some(simple))
    }

    fn operator_name(&mut self, from: usize) -> Read<Option<Operator>> {
        const NAMES: [Operator; 10] = [
            Operator::Modulo,
            Operator::Equal,
            Operator::NotEqual,
            Operator::Greater,
            Operator::GreaterOrEqual,
            Operator::Less,
            Operator::LessOrEqual,
            Operator::And,
            Operator::Or,
            Operator::Xor,
        ];
        // a function may follow without a blank, as in `2 MOD ABS[#1]`: take no more than the name
        for operator in NAMES {
            if operator.text().bytes().all(|letter| self.take_if(letter)) {
                return Ok(Some(operator));
            }
            self.at = from;
        }
        self.at = from;
        self.fault_here(Problem::OperatorExpected)
    }

    fn function(&mut self, from: usize, depth: u32) -> Read<Value> {
        let mut buffer = [0; 16];
        let count = self.letters(&mut buffer);
        match &buffer[..count] {
            b"ATAN" => self.atan(from, depth),
            b"AT" | b"ATA" | b"ATN" if self.grammar == Grammar::Fanuc => self.atan(from, depth),
            b"POW" if self.grammar == Grammar::Fanuc => self.power(from, depth),
            b"EXISTS" if self.grammar != Grammar::Fanuc => {
                self.open("EXISTS")?;
                if self.peek() != b'#' {
                    return self.fault_here(Problem::ExistsNeedsParameter);
                }
                let parameter = self.parameter(depth + 1)?;
                if !self.take_if(b']') {
                    return self.fault_here(Problem::ExistsNeedsParameter);
                }
                self.keep(Expr::Exists(parameter), from)
            }
            name => {
                let more: &[_] = match self.grammar {
                    Grammar::Rs274 | Grammar::Grbl => &[],
                    Grammar::Fanuc => &Function::FANUC,
                };
                let short = self.grammar == Grammar::Fanuc && name.len() >= 2;
                let known = Function::ALL.iter().chain(more).find(|(text, _)| {
                    text.as_bytes() == name || short && text.as_bytes().starts_with(name)
                });
                let Some(&(text, function)) = known else {
                    return self.fault_since(Problem::UnknownFunction(self.grammar), from);
                };
                let argument = self.argument(text, depth)?;
                self.keep(Expr::Function { function, argument }, from)
            }
        }
    }

    fn atan(&mut self, from: usize, depth: u32) -> Read<Value> {
        let (y, second) = self.arguments("ATAN", depth)?;
        if let Some(x) = second {
            return self.keep(Expr::Atan { y, x }, from);
        }
        let before = (self.at, self.end);
        if !self.take_if(b'/') || self.peek() != b'[' {
            if self.grammar == Grammar::Fanuc {
                // of one argument
                (self.at, self.end) = before;
                return self.keep(Expr::Function { function: Function::Atan, argument: y }, from);
            }
            return self.fault_here(Problem::AtanNeedsTwo);
        }
        let x = self.bracket(depth)?;
        self.keep(Expr::Atan { y, x }, from)
    }

    fn power(&mut self, from: usize, depth: u32) -> Read<Value> {
        match self.arguments("POW", depth)? {
            (base, Some(exponent)) => self.keep(Expr::Pow { base, exponent }, from),
            (_, None) => self.fault_since(Problem::PowNeedsTwo, from),
        }
    }

    /// `[value]`, and of Fanuc's `[value,value]`.
    fn arguments(&mut self, function: &'static str, depth: u32) -> Read<(Value, Option<Value>)> {
        if self.grammar != Grammar::Fanuc {
            return Ok((self.argument(function, depth)?, None));
        }
        self.open(function)?;
        let first = self.expression(1, depth + 1)?;
        let second = if self.take_if(b',') { Some(self.expression(1, depth + 1)?) } else { None };
        if !self.take_if(b']') {
            return self.fault_here(Problem::OperatorExpected);
        }
        Ok((first, second))
    }

    fn argument(&mut self, function: &'static str, depth: u32) -> Read<Value> {
        if self.peek() != b'[' {
            return self.fault_here(Problem::BracketAfter(function));
        }
        self.bracket(depth)
    }

    fn open(&mut self, function: &'static str) -> Read<()> {
        if self.take_if(b'[') { Ok(()) } else { self.fault_here(Problem::BracketAfter(function)) }
    }
}

//! Expressions to numbers: parameters, operators, functions.
//!
//! Angles are in degrees. Two numbers are equal if they differ by less than 0.0001, as in LinuxCNC,
//! so that a loop that counts in steps of 0.1 ends. A result that is not finite is a diagnostic.
//!
//! Source: LinuxCNC 2.9 manual, "G-code overview", sections "Parameters" and "Expressions".
use crate::{
    codes::{number::near_whole, spelling::short},
    fault::{Outcome, error, refuse},
    modes::Modes,
    words::names::{self, Store},
};
use diag::Span;
use gcode::{Block, Expr, Function, Operator, Parameter, Value};

/// Numbers nearer than this are EQ.
const EQUAL: f64 = 1e-4;

/// Everything an expression may read.
pub(crate) struct Values<'a> {
    pub(crate) store: &'a Store,
    pub(crate) modes: &'a Modes,
}

impl Values<'_> {
    /// The number of a value that stands at `span`.
    pub(crate) fn evaluate(&self, block: &Block, value: Value, span: Span) -> Outcome<f64> {
        match value {
            Value::Number(number) => Ok(number),
            Value::Expression(id) => {
                let here = block.expr_span(id);
                let span = if here.end > here.start { here } else { span };
                let result = self.expression(block, block.expr(id), span)?;
                if result.is_finite() {
                    Ok(result)
                } else {
                    refuse("I0201", span, "this has no finite value")
                }
            }
        }
    }

    fn expression(&self, block: &Block, expr: Expr, span: Span) -> Outcome<f64> {
        let value = |v| self.evaluate(block, v, span);
        match expr {
            Expr::Parameter(parameter) => self.parameter(block, parameter, span),
            Expr::Negate(inner) => Ok(-value(inner)?),
            Expr::Binary { operator, left, right } => {
                binary(operator, value(left)?, value(right)?, span)
            }
            Expr::Function { function, argument } => apply(function, value(argument)?, span),
            Expr::Atan { y, x } => Ok(value(y)?.atan2(value(x)?).to_degrees()),
            Expr::Pow { base, exponent } => {
                binary(Operator::Power, value(base)?, value(exponent)?, span)
            }
            Expr::Exists(parameter) => match parameter {
                Parameter::Named(name) => {
                    let name = block.text(name);
                    let there = self.store.named(name).is_some()
                        || names::system(self.modes, name).is_some();
                    Ok(f64::from(u8::from(there)))
                }
                Parameter::Numbered(number) => {
                    let number = value(number)?;
                    let there = near_whole(number).is_some_and(names::exists);
                    Ok(f64::from(u8::from(there)))
                }
            },
        }
    }

    fn parameter(&self, block: &Block, parameter: Parameter, span: Span) -> Outcome<f64> {
        match parameter {
            Parameter::Numbered(number) => {
                let number = names::number(self.evaluate(block, number, span)?, span)?;
                Ok(names::numbered(self.modes, self.store, number))
            }
            Parameter::Named(name) => {
                let name = block.text(name);
                match self.store.named(name).or_else(|| names::system(self.modes, name)) {
                    Some(value) => Ok(value),
                    None => Err(Box::new(names::unknown(self.store, name, span))),
                }
            }
        }
    }
}

pub(crate) fn binary(operator: Operator, left: f64, right: f64, span: Span) -> Outcome<f64> {
    let truth = |b: bool| Ok(f64::from(u8::from(b)));
    let equal = (left - right).abs() < EQUAL;
    match operator {
        Operator::Power if left < 0.0 && right.fract() != 0.0 => {
            let (left, right) = (short(left), short(right));
            refuse("I0202", span, format!("{left} cannot be raised to the broken power {right}"))
        }
        Operator::Power => Ok(left.powf(right)),
        Operator::Times => Ok(left * right),
        Operator::Divide | Operator::Modulo if right == 0.0 => {
            refuse("I0203", span, format!("{} is divided by zero here", short(left)))
        }
        Operator::Divide => Ok(left / right),
        Operator::Modulo => Ok(left.rem_euclid(right)),
        Operator::Plus => Ok(left + right),
        Operator::Minus => Ok(left - right),
        Operator::Equal => truth(equal),
        Operator::NotEqual => truth(!equal),
        Operator::Greater => truth(left > right),
        Operator::GreaterOrEqual => truth(left >= right),
        Operator::Less => truth(left < right),
        Operator::LessOrEqual => truth(left <= right),
        Operator::And => truth(left != 0.0 && right != 0.0),
        Operator::Or => truth(left != 0.0 || right != 0.0),
        Operator::Xor => truth((left != 0.0) != (right != 0.0)),
    }
}

pub(crate) fn apply(function: Function, x: f64, span: Span) -> Outcome<f64> {
    let outside = |name: &str, range: &str| {
        refuse("I0204", span, format!("{name} takes {range}, found {}", short(x)))
    };
    match function {
        Function::Abs => Ok(x.abs()),
        Function::Acos if x.abs() > 1.0 => outside("ACOS", "a number from -1 to 1"),
        Function::Acos => Ok(x.acos().to_degrees()),
        Function::Asin if x.abs() > 1.0 => outside("ASIN", "a number from -1 to 1"),
        Function::Asin => Ok(x.asin().to_degrees()),
        Function::Cos => Ok(x.to_radians().cos()),
        Function::Exp => Ok(x.exp()),
        Function::Fix => Ok(x.floor()),
        Function::Fup => Ok(x.ceil()),
        Function::Ln if x <= 0.0 => outside("LN", "a number above 0"),
        Function::Ln => Ok(x.ln()),
        Function::Round => Ok(x.round()),
        Function::Sin => Ok(x.to_radians().sin()),
        Function::Sqrt if x < 0.0 => outside("SQRT", "0 or more"),
        Function::Sqrt => Ok(x.sqrt()),
        Function::Tan => Ok(x.to_radians().tan()),
        Function::Atan => Ok(x.atan().to_degrees()),
        Function::Bin | Function::Bcd => binary_coded(function, x, span),
    }
}

/// BIN and BCD: decimal digits, four bits each.
fn binary_coded(function: Function, x: f64, span: Span) -> Outcome<f64> {
    let whole = near_whole(x).and_then(|n| u32::try_from(n).ok()).filter(|n| *n <= 0x9999_9999);
    let (from, to) = if function == Function::Bcd { (10, 16) } else { (16, 10) };
    let (mut rest, mut value, mut place) = (whole.unwrap_or(u32::MAX), 0_u64, 1_u64);
    let mut good = whole.is_some() && !(function == Function::Bcd && rest > 99_999_999);
    while rest > 0 && good {
        let digit = rest % from;
        good = digit <= 9;
        value += u64::from(digit) * place;
        place *= to;
        rest /= from;
    }
    if good {
        return Ok(value as f64);
    }
    let fault = error(
        "I1015",
        span,
        format!("{} takes up to eight decimal digits, found {x}", function.text()),
    );
    Err(fault.into())
}

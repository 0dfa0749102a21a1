//! Variables and expressions of a custom macro.
//!
//! | variables | are |
//! |---|---|
//! | #0 | always without a value |
//! | #1 – #33 | the macro's own, its arguments first |
//! | #100 – #199 | common to all programs |
//! | #500 – #999 | the same, and kept in the parameter file |
//! | others | [`system`] |
//!
//! A variable without a value counts as 0 in arithmetic and differs from 0 in EQ and NE alone. AND,
//! OR and XOR work on the bits of whole numbers. Angles are in degrees; ATAN of two arguments gives
//! 0 to 360. In a word that moves something, ROUND goes to the least input increment, and so does
//! whatever a variable has in that word; elsewhere ROUND goes to whole numbers.
use crate::{
    call::{Sink, out::Out},
    codes::number::near_whole,
    fault::{Outcome, refuse},
    front_end::fanuc::{
        state::{Fanuc, Variables},
        variables::{
            MacroValues,
            system::{self, set_system},
        },
    },
    program::Program,
    state::executor::Executor,
    words::eval,
};
use diag::Span;
use gcode::{Block, Expr, Function, Operator, Parameter, Value};
use std::collections::BTreeMap;

/// From here on common variables are kept.
const FIRST_KEPT: usize = 500;

impl Default for Variables {
    fn default() -> Self {
        Self {
            local: [None; crate::front_end::fanuc::state::LOCALS],
            common: vec![None; 900],
            more: BTreeMap::new(),
        }
    }
}

/// To the nearest of so many steps per unit, halves away from zero.
pub(crate) fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}

impl Variables {
    /// Those that the parameter file kept.
    pub(crate) fn kept(parameters: &crate::Parameters) -> Self {
        let mut new = Self::default();
        for (number, value) in parameters.iter().filter(|(n, _)| (FIRST_KEPT..1000).contains(n)) {
            new.common[number - 100] = Some(value);
        }
        new
    }
}

pub(crate) const fn values<'a>(fanuc: &'a Fanuc, executor: &'a Executor) -> MacroValues<'a> {
    MacroValues { fanuc, executor, per_unit: 1.0 }
}

/// The same for a word with so many least input increments in one.
pub(crate) const fn values_in<'a>(
    fanuc: &'a Fanuc,
    executor: &'a Executor,
    per_unit: f64,
) -> MacroValues<'a> {
    MacroValues { fanuc, executor, per_unit }
}

/// What a variable has, for people.
pub(crate) fn variable_now(fanuc: &Fanuc, executor: &Executor, number: usize) -> Option<f64> {
    values(fanuc, executor).variable(number, Span::default()).ok().flatten()
}

/// Set the block's variables; each sees those set before it.
pub(crate) fn assign<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    out: &mut Out<'_, S>,
) -> Outcome {
    for i in 0..it.block.assignments.len() {
        let assignment = it.block.assignments[i];
        let span = assignment.span;
        let Parameter::Numbered(number) = assignment.target else {
            return refuse(
                "I1011",
                span,
                "variables have numbers here: #100 to #199, #500 to #999",
            );
        };
        let values = values(fanuc, &it.executor);
        let number = variable(values.value(&it.block, number, span)?, span)?;
        let value = values.value(&it.block, assignment.value, span)?;
        match number {
            1..=33 => fanuc.variables.local[number - 1] = value,
            100..=199 | 500..=999 => set_common(fanuc, it, number, value),
            _ if (fanuc.kind.variant().has_more_variables)(number) => {
                _ = match value {
                    Some(value) => fanuc.variables.more.insert(number, value),
                    None => fanuc.variables.more.remove(&number),
                }
            }
            _ => set_system(fanuc, it, number, value, out)?,
        }
    }
    Ok(())
}

/// A common variable; those that are kept go into the parameters, too.
fn set_common(fanuc: &mut Fanuc, it: &mut Program<'_>, number: usize, value: Option<f64>) {
    fanuc.variables.common[number - 100] = value;
    if number >= FIRST_KEPT {
        it.executor.store.numbered.keep(number, value);
    }
}

impl MacroValues<'_> {
    /// What a value is worth; nothing for a variable without one.
    pub(crate) fn value(&self, block: &Block, value: Value, span: Span) -> Outcome<Option<f64>> {
        let Value::Expression(id) = value else {
            let Value::Number(number) = value else { return Ok(None) };
            return Ok(Some(number));
        };
        let here = block.expr_span(id);
        let span = if here.end > here.start { here } else { span };
        let result = self.expression(block, block.expr(id), span)?;
        if result.is_none_or(f64::is_finite) {
            Ok(result)
        } else {
            refuse("I0201", span, "this has no finite value")
        }
    }

    fn expression(&self, block: &Block, expr: Expr, span: Span) -> Outcome<Option<f64>> {
        let value = |v| self.value(block, v, span);
        let number = |v| value(v).map(|v| v.unwrap_or(0.0));
        match expr {
            Expr::Parameter(Parameter::Numbered(which)) => {
                self.variable(variable(value(which)?, span)?, span)
            }
            Expr::Parameter(Parameter::Named(_)) | Expr::Exists(_) => refuse(
                "I1011",
                span,
                "variables have numbers here: #1 to #33, #100 to #199, #500 to #999",
            ),
            Expr::Negate(inner) => Ok(Some(-number(inner)?)),
            Expr::Binary { operator, left, right } => {
                binary(operator, value(left)?, value(right)?, span).map(Some)
            }
            Expr::Function { function, argument } => {
                let x = number(argument)?;
                match function {
                    Function::Round => Ok(Some(rounded(x, self.per_unit))),
                    Function::Fix => Ok(Some(x.trunc())),
                    Function::Fup => Ok(Some(x.abs().ceil().copysign(x))),
                    _ => eval::apply(function, x, span).map(Some),
                }
            }
            Expr::Pow { base, exponent } => {
                eval::binary(Operator::Power, number(base)?, number(exponent)?, span).map(Some)
            }
            Expr::Atan { y, x } => {
                Ok(Some(number(y)?.atan2(number(x)?).to_degrees().rem_euclid(360.0)))
            }
        }
    }

    fn variable(&self, number: usize, span: Span) -> Outcome<Option<f64>> {
        Ok(match number {
            0 => None,
            1..=33 => self.fanuc.variables.local[number - 1],
            100..=199 | 500..=999 => self.fanuc.variables.common[number - 100],
            _ if (self.fanuc.kind.variant().has_more_variables)(number) => {
                self.fanuc.variables.more.get(&number).copied()
            }
            _ => return system::system(self, number, span),
        })
    }
}

/// Which variable is meant.
fn variable(value: Option<f64>, span: Span) -> Outcome<usize> {
    match value.and_then(near_whole).map(usize::try_from) {
        Some(Ok(number)) => Ok(number),
        _ => refuse("I0205", span, "expected the number of a variable after #"),
    }
}

fn binary(operator: Operator, left: Option<f64>, right: Option<f64>, span: Span) -> Outcome<f64> {
    let (a, b) = (left.unwrap_or(0.0), right.unwrap_or(0.0));
    let equal =
        left.is_some() == right.is_some() && (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0);
    let bits = |number: f64| match near_whole(number).map(i32::try_from) {
        Some(Ok(bits)) => Ok(bits),
        _ => refuse(
            "I1014",
            span,
            format!("{} takes whole numbers, found {number}", operator.text()),
        ),
    };
    match operator {
        Operator::Equal => Ok(f64::from(u8::from(equal))),
        Operator::NotEqual => Ok(f64::from(u8::from(!equal))),
        Operator::And => Ok(f64::from(bits(a)? & bits(b)?)),
        Operator::Or => Ok(f64::from(bits(a)? | bits(b)?)),
        Operator::Xor => Ok(f64::from(bits(a)? ^ bits(b)?)),
        Operator::Modulo if b != 0.0 => Ok(a % b),
        _ => eval::binary(operator, a, b, span),
    }
}

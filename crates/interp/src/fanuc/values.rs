//! Variables and expressions of a custom macro.
//!
//! | variables | are |
//! |---|---|
//! | #0 | always without a value |
//! | #1 – #33 | the macro's own, its arguments first |
//! | #100 – #199, #500 – #999 | common to all programs |
//! | #2001 – #2200 | tool offsets |
//! | #3000, #3006 | set: alarm; stop with a message |
//! | #4001 …, #4109, #4119, #4120 | modal codes, F, S, T |
//! | #5001 …, #5021 …, #5041 … | end of the block before, machine position, work position |
//! | #5221 – #5328 | work offsets G54 – G59 |
//!
//! A variable without a value counts as 0 in arithmetic and differs from 0 in EQ and NE alone.
//! AND, OR and XOR work on the bits of whole numbers. Angles are in degrees; ATAN of two arguments
//! gives 0 to 360.
use super::Fanuc;
use crate::{
    call::{Call, Sink},
    eval,
    execute::Executor,
    fault::{Outcome, error, refuse},
    interpreter::Interpreter,
    state::FeedMode,
    words::near_whole,
};
use diag::Span;
use gcode::{Block, Expr, Function, Operator, Parameter, Value};

/// Variables of a macro of its own.
pub(super) const LOCALS: usize = 33;
/// #1 to #33.
pub(super) type Locals = [Option<f64>; LOCALS];
/// Axes by their number in system variables.
const MILL_AXES: [usize; 3] = [0, 1, 2];
const LATHE_AXES: [usize; 2] = [0, 2];

/// What programs set.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variables {
    pub(super) local: Locals,
    /// #100 to #999, of which #200 to #499 do not exist.
    common: Vec<Option<f64>>,
}

impl Default for Variables {
    fn default() -> Self {
        Self { local: [None; LOCALS], common: vec![None; 900] }
    }
}

/// Everything an expression may read.
pub(super) struct Values<'a> {
    fanuc: &'a Fanuc,
    executor: &'a Executor,
}

impl Fanuc {
    pub(super) const fn values<'a>(&'a self, executor: &'a Executor) -> Values<'a> {
        Values { fanuc: self, executor }
    }

    /// Set the block's variables; each sees those set before it.
    pub(super) fn assign<S: Sink>(&mut self, it: &mut Interpreter<'_>, sink: &mut S) -> Outcome {
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
            let values = self.values(&it.executor);
            let number = variable(values.value(&it.block, number, span)?, span)?;
            let value = values.value(&it.block, assignment.value, span)?;
            match number {
                1..=33 => self.variables.local[number - 1] = value,
                100..=199 | 500..=999 => self.variables.common[number - 100] = value,
                3000 => return self.alarm(it, value),
                3006 => {
                    let text = comment(&it.block);
                    it.executor.say(sink, &Call::Message(&text));
                    it.executor.say(sink, &Call::Stop);
                }
                5221..=5328 => self.set_work_offset(it, number, value, sink)?,
                _ => {
                    let text = format!(
                        "#{number} cannot be set: programs set #1 to #33, #100 to #199 and #500 to #999"
                    );
                    return refuse("I1012", span, text);
                }
            }
        }
        Ok(())
    }

    fn alarm(&self, it: &mut Interpreter<'_>, value: Option<f64>) -> Outcome {
        it.ended = true;
        let number = 3000.0 + value.unwrap_or(0.0);
        let text = format!("the program stops itself with alarm {number}: {}", comment(&it.block));
        refuse("I0316", it.block.span, text)
    }

    fn set_work_offset<S: Sink>(
        &self,
        it: &mut Interpreter<'_>,
        number: usize,
        value: Option<f64>,
        sink: &mut S,
    ) -> Outcome {
        let (system, axis) = ((number - 5201) / 20, (number - 5201) % 20);
        let Some(axis) = self.axis(axis + 1) else {
            return refuse(
                "I1012",
                it.block.span,
                format!("#{number} belongs to no axis of this machine"),
            );
        };
        let mm = value.unwrap_or(0.0) * it.executor.state.units.in_mm();
        it.executor.store.numbered.set(5201 + 20 * system + axis, self.radius(axis, mm));
        if usize::from(it.executor.state.system) == system {
            it.executor.select_system(system as u8);
            let origin = it.executor.state.frame.origin;
            it.executor.say(sink, &Call::WorkOffset(system as u8, origin));
        }
        Ok(())
    }

    /// The axis that system variables count as this one, from 1.
    fn axis(&self, count: usize) -> Option<usize> {
        let axes: &[usize] = if self.is_lathe() { &LATHE_AXES } else { &MILL_AXES };
        axes.get(count.checked_sub(1)?).copied()
    }

    /// X of a lathe is a diameter.
    fn radius(&self, axis: usize, value: f64) -> f64 {
        if axis == 0 && self.is_lathe() { value / 2.0 } else { value }
    }

    fn shown(&self, axis: usize, value: f64) -> f64 {
        if axis == 0 && self.is_lathe() { value * 2.0 } else { value }
    }
}

impl Values<'_> {
    /// What a value is worth; nothing for a variable without one.
    pub(super) fn value(&self, block: &Block, value: Value, span: Span) -> Outcome<Option<f64>> {
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
                    Function::Fix => Ok(Some(x.trunc())),
                    Function::Fup => Ok(Some(x.abs().ceil().copysign(x))),
                    _ => eval::apply(function, x, span).map(Some),
                }
            }
            Expr::Atan { y, x } => {
                Ok(Some(number(y)?.atan2(number(x)?).to_degrees().rem_euclid(360.0)))
            }
        }
    }

    fn variable(&self, number: usize, span: Span) -> Outcome<Option<f64>> {
        let state = &self.executor.state;
        let machine = || state.frame.to_machine(&state.at);
        Ok(match number {
            0 => None,
            1..=33 => self.fanuc.variables.local[number - 1],
            100..=199 | 500..=999 => self.fanuc.variables.common[number - 100],
            2001..=2200 => {
                let tool = self.executor.tools.get(number as u32 - 2000);
                Some(tool.map_or(0.0, |t| t.length.value()) / state.units.in_mm())
            }
            4001..=4120 => self.modal(number, span)?,
            5001..=5009 => Some(self.coordinate(number - 5000, &state.at, span)?),
            5021..=5029 => Some(self.coordinate(number - 5020, &machine(), span)?),
            5041..=5049 => Some(self.coordinate(number - 5040, &state.at, span)?),
            5081..=5089 => Some(self.coordinate(number - 5080, &state.frame.tool, span)?),
            5221..=5328 => {
                let mut point =
                    self.executor.store.numbered.point(5201 + (number - 5201) / 20 * 20);
                crate::frame::scale(&mut point, 1.0 / state.units.in_mm());
                Some(self.coordinate((number - 5201) % 20 + 1, &point, span)?)
            }
            _ => {
                let text = format!("#{number} is not known to Leadscrew");
                return refuse("I1013", span, text);
            }
        })
    }

    fn coordinate(&self, count: usize, point: &crate::Point, span: Span) -> Outcome<f64> {
        match self.fanuc.axis(count) {
            Some(axis) => Ok(self.fanuc.shown(axis, point[axis])),
            None => refuse("I1013", span, format!("this machine has no axis {count}")),
        }
    }

    fn modal(&self, number: usize, span: Span) -> Outcome<Option<f64>> {
        let state = &self.executor.state;
        let pick = |first, second, is_first| Some(if is_first { first } else { second });
        Ok(match number {
            4001 => Some(if state.motion.code() >= 730 {
                0.0
            } else {
                f64::from(state.motion.code()) / 10.0
            }),
            4002 => Some(match state.plane {
                canon::Plane::XY => 17.0,
                canon::Plane::ZX => 18.0,
                canon::Plane::YZ => 19.0,
            }),
            4003 => pick(91.0, 90.0, state.incremental),
            4005 => pick(95.0, 94.0, state.feed_mode == FeedMode::PerRevolution),
            4006 => pick(20.0, 21.0, state.units == crate::Units::Inch),
            4009 => Some(if state.motion.code() >= 730 {
                f64::from(state.motion.code()) / 10.0
            } else {
                80.0
            }),
            4010 => pick(98.0, 99.0, state.retract_to_initial),
            4014 => Some(53.0 + f64::from(state.system)),
            4109 => Some(state.feed),
            4115 => self.fanuc.program.map(f64::from),
            4119 => Some(state.spindle.speed),
            4120 => Some(f64::from(state.selected_tool)),
            _ => return refuse("I1013", span, format!("#{number} is not known to Leadscrew")),
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

fn comment(block: &Block) -> String {
    block.comments.last().map_or_else(String::new, |c| block.text(c.text).trim().to_owned())
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

/// BIN and BCD: decimal digits, four bits each.
pub(crate) fn binary_coded(function: Function, x: f64, span: Span) -> Outcome<f64> {
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

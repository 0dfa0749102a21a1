//! Orders that move no axis: spindle, tools, coolant, overrides, stops, messages.
//!
//! What the program says again without a change is not ordered again: `M3 S500` in every block is one
//! order. The kernel restores a turning spindle after a tap by itself.
use crate::{
    auxiliary::switch::NO_SPEED_LIMIT,
    call::{Call, CycleHole, Sense, Units},
    resolve::Resolver,
};
use canon::{Await, Feed, InputWait, OpKind, Probe, SpindleOrder, UserCode};
use diag::{Diagnostic, Span};
use units::{Angle, MM_PER_INCH, Speed, Spin};

/// Millimetres in a foot, the unit of surface speed with G20.
const MM_PER_FOOT: f64 = 12.0 * MM_PER_INCH;

impl Resolver {
    /// Calls that are neither moves nor waits.
    pub(crate) fn order_or_mode(&mut self, call: &Call<'_>, span: Span) {
        match call {
            Call::SpindleSpeed(speed) => {
                self.spindle.speed = *speed;
                if self.spindle.sense.is_some() {
                    self.say_spindle(span);
                }
            }
            Call::SpindleMode(limit) => {
                self.spindle.surface = match *limit {
                    0.0 => None,
                    limit if limit >= NO_SPEED_LIMIT => Some(f64::INFINITY),
                    limit => Some(limit),
                };
            }
            Call::SpindleTurn(sense) => {
                self.spindle.sense = Some(*sense);
                self.say_spindle(span);
            }
            Call::SpindleStop => {
                self.spindle.sense = None;
                self.say_spindle(span);
            }
            Call::SpindleOrient { angle, .. } => {
                self.spindle.sense = None;
                self.order(SpindleOrder::Orient(Angle::deg(*angle)), span);
            }
            Call::SelectTool(number) => self.push(span, OpKind::SelectTool { number: *number }),
            Call::ChangeTool(number) => self.change_tool(*number, span),
            Call::ToolNumber(number) => {
                let text = "M61 says what the spindle holds; here the tool is changed as by M6";
                self.report(Diagnostic::warning("I0707", span, text));
                self.change_tool(*number, span);
            }
            Call::Mist(on) => self.say_coolant((*on, self.coolant.1), span),
            Call::Flood(on) => self.say_coolant((self.coolant.0, *on), span),
            Call::FeedOverride(on) => self.say_overrides((*on, self.overrides.1), span),
            Call::SpeedOverride(on) => self.say_overrides((self.overrides.0, *on), span),
            Call::Stop => self.push(span, OpKind::Pause { optional: false }),
            Call::OptionalStop => self.push(span, OpKind::Pause { optional: true }),
            Call::Message(text) | Call::Print(text) => {
                self.push(span, OpKind::Message((*text).into()));
            }
            Call::Output(output) if output.with_motion => self.with_motion.push((span, *output)),
            Call::Output(output) => self.push(span, OpKind::Output(*output)),
            Call::Input(wait) => self.input(*wait, span),
            Call::User { number, name, p, q } => {
                let code = UserCode { number: *number, name: (*name).into(), p: *p, q: *q };
                self.push(span, OpKind::UserCode(code.into()));
            }
            Call::End | Call::Finish => {
                self.forget_outputs();
                self.push(span, OpKind::End);
            }
            other => self.mode(other),
        }
    }

    fn input(&mut self, wait: InputWait, span: Span) {
        let kind = if wait.digital { "input" } else { "analogue input" };
        let number = wait.number;
        let text = match wait.until {
            Await::Nothing => format!(
                "what {kind} {number} reads is known when the program runs: here it is taken to be 0"
            ),
            Await::Rise | Await::Fall | Await::On | Await::Off => format!(
                "when {kind} {number} comes is known when the program runs: here it is taken to come at once"
            ),
        };
        self.report(Diagnostic::note("I0714", span, text));
        self.push(span, OpKind::Input(wait));
    }

    /// G38: along a line, however far.
    pub(crate) fn probe(
        &mut self,
        program: &crate::Point,
        (until_contact, required): (bool, bool),
        span: Span,
    ) {
        let to = self.machine(program);
        let from = self.at;
        if !self.arrives(&to, span) {
            return;
        }
        self.check_stroke(&from, &to, span);
        let text = "where the probe touches is known when the program runs: here it is taken to touch at the programmed end point";
        self.report(Diagnostic::note("I0713", span, text));
        let Feed::PerTime(feed) = self.feed(&from, &to, span) else {
            let text = "probing needs a way along X, Y or Z: a turn of a rotary axis alone cannot be probed";
            return self.report(Diagnostic::error("I0573", span, text));
        };
        let to = crate::resolve::position(&to);
        self.push(span, OpKind::Probe(Probe { to, feed, until_contact, required }));
    }

    /// Outputs that were to change with a move that never came.
    fn forget_outputs(&mut self) {
        for (span, _) in core::mem::take(&mut self.with_motion) {
            let text = "this output never changes: it waits for the next move, and none follows";
            let finding = Diagnostic::warning("I0715", span, text);
            self.report(finding.with_help("M64, M65 and M68 change it at once"));
        }
    }

    /// From R on, on the rapid out of a drilled hole; the program's speed is in force again afterwards.
    pub(crate) fn throw_chips_after_drilling(&mut self, hole: &CycleHole, span: Span) {
        let sign = self.sign();
        self.throw_chips(hole, sign, Spin::rpm(sign * self.spindle.speed), span);
    }

    /// Sense of the spindle in force: +1 clockwise, −1 counter-clockwise, 0 still.
    fn sign(&self) -> f64 {
        match self.spindle.sense {
            None => 0.0,
            Some(Sense::Clockwise) => 1.0,
            Some(Sense::Counterclockwise) => -1.0,
        }
    }

    /// The spindle's order, where it has changed.
    fn say_spindle(&mut self, span: Span) {
        let sign = self.sign();
        let order = match self.spindle.surface {
            _ if sign == 0.0 => SpindleOrder::Stop,
            None => SpindleOrder::Turn(Spin::rpm(sign * self.spindle.speed)),
            Some(limit) => {
                let unit = if self.units == Units::Inch { MM_PER_FOOT } else { 1000.0 };
                let speed = Speed::mm_per_min(sign * self.spindle.speed * unit);
                let limit = limit.is_finite().then(|| Spin::rpm(limit));
                SpindleOrder::ConstantSurfaceSpeed { speed, limit }
            }
        };
        self.order(order, span);
    }

    fn order(&mut self, order: SpindleOrder, span: Span) {
        if self.spindle.said != Some(order) {
            self.spindle.said = Some(order);
            self.push(span, OpKind::Spindle { spindle: 0, order });
        }
    }

    fn say_overrides(&mut self, overrides: (bool, bool), span: Span) {
        if self.overrides != overrides {
            self.overrides = overrides;
            self.push(span, OpKind::Overrides { feed: overrides.0, spindle: overrides.1 });
        }
    }

    fn say_coolant(&mut self, coolant: (bool, bool), span: Span) {
        if self.coolant != coolant {
            self.coolant = coolant;
            self.push(span, OpKind::Coolant { mist: coolant.0, flood: coolant.1 });
        }
    }

    fn change_tool(&mut self, number: u32, span: Span) {
        self.tool = number;
        self.push(span, OpKind::ChangeTool { number });
    }
}

//! Orders that move no axis: spindle, tools, coolant, overrides, stops, messages.
//!
//! What the program says again without a change is not ordered again: `M3 S500` in every block is
//! one order. The kernel restores a turning spindle after a tap by itself.
use crate::{
    auxiliary::switch::NO_SPEED_LIMIT,
    call::{Call, Units},
    resolve::Resolver,
};
use canon::{Await, InputWait, OpKind, SpindleOrder, UserCode};
use diag::{Diagnostic, Span};
use units::{Angle, MM_PER_INCH, Orientation, Speed, Spin, Time};

/// Millimetres in a foot, the unit of surface speed with G20.
const MM_PER_FOOT: f64 = 12.0 * MM_PER_INCH;

/// Calls that are neither moves nor waits.
pub(crate) fn order_or_mode(resolver: &mut Resolver, call: &Call<'_>, span: Span) {
    match call {
        Call::SpindleSpeed(speed) => {
            resolver.spindle.speed = *speed;
            if resolver.spindle.sense.is_some() {
                say_spindle(resolver, span);
            }
        }
        Call::SpindleMode(limit) => {
            resolver.spindle.surface = match *limit {
                0.0 => None,
                limit if limit >= NO_SPEED_LIMIT => Some(f64::INFINITY),
                limit => Some(limit),
            };
        }
        Call::SpindleTurn(sense) => {
            resolver.spindle.sense = Some(*sense);
            say_spindle(resolver, span);
        }
        Call::SpindleStop => {
            resolver.spindle.sense = None;
            say_spindle(resolver, span);
        }
        Call::SpindleOrient { angle, direction, longest, .. } => {
            resolver.spindle.sense = None;
            let to = Orientation { angle: Angle::deg(*angle), direction: *direction };
            let longest = longest.map(Time::s);
            order_spindle(resolver, SpindleOrder::Orient { to, longest }, span);
        }
        Call::SelectTool(_) if resolver.tools_by_hand => {}
        Call::SelectTool(number) => resolver.push(span, OpKind::SelectTool { number: *number }),
        Call::ChangeTool(number) => change_tool(resolver, *number, span),
        Call::ToolNumber(number) => {
            let text = "M61 says what the spindle holds; here the tool is changed as by M6";
            resolver.report(Diagnostic::warning("I0707", span, text));
            change_tool(resolver, *number, span);
        }
        Call::Mist(on) => say_coolant(resolver, (*on, resolver.coolant.1), span),
        Call::Flood(on) => say_coolant(resolver, (resolver.coolant.0, *on), span),
        Call::FeedOverride(on) => say_overrides(resolver, (*on, resolver.overrides.1), span),
        Call::SpeedOverride(on) => say_overrides(resolver, (resolver.overrides.0, *on), span),
        Call::Stop => resolver.push(span, OpKind::Pause { optional: false }),
        Call::OptionalStop => resolver.push(span, OpKind::Pause { optional: true }),
        Call::Message(text) | Call::Print(text) => {
            resolver.push(span, OpKind::Message((*text).into()));
        }
        Call::Output(output) if output.with_motion => resolver.with_motion.push((span, *output)),
        Call::Output(output) => resolver.push(span, OpKind::Output(*output)),
        Call::Input(wait) => input(resolver, *wait, span),
        Call::User { number, name, p, q } => {
            let code = UserCode { number: *number, name: (*name).into(), p: *p, q: *q };
            resolver.push(span, OpKind::UserCode(code.into()));
        }
        Call::End | Call::Finish => {
            forget_outputs(resolver);
            resolver.push(span, OpKind::End);
        }
        other => resolver.mode(other),
    }
}

fn input(resolver: &mut Resolver, wait: InputWait, span: Span) {
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
    resolver.report(Diagnostic::note("I0714", span, text));
    resolver.push(span, OpKind::Input(wait));
}

/// Outputs that were to change with a move that never came.
fn forget_outputs(resolver: &mut Resolver) {
    for (span, _) in core::mem::take(&mut resolver.with_motion) {
        let text = "this output never changes: it waits for the next move, and none follows";
        let finding = Diagnostic::warning("I0715", span, text);
        resolver.report(finding.with_help("M64, M65 and M68 change it at once"));
    }
}

/// The spindle's order, where it has changed.
fn say_spindle(resolver: &mut Resolver, span: Span) {
    let sign = resolver.spindle_sign();
    let order = match resolver.spindle.surface {
        _ if sign == 0.0 => SpindleOrder::Stop,
        None => SpindleOrder::Turn(Spin::rpm(sign * resolver.spindle.speed)),
        Some(limit) => {
            let unit = if resolver.units == Units::Inch { MM_PER_FOOT } else { 1000.0 };
            let speed = Speed::mm_per_min(sign * resolver.spindle.speed * unit);
            let limit = limit.is_finite().then(|| Spin::rpm(limit));
            SpindleOrder::ConstantSurfaceSpeed { speed, limit }
        }
    };
    order_spindle(resolver, order, span);
}

fn order_spindle(resolver: &mut Resolver, order: SpindleOrder, span: Span) {
    if resolver.spindle.said != Some(order) {
        resolver.spindle.said = Some(order);
        resolver.push(span, OpKind::Spindle { spindle: 0, order });
    }
}

fn say_overrides(resolver: &mut Resolver, overrides: (bool, bool), span: Span) {
    if resolver.overrides != overrides {
        resolver.overrides = overrides;
        resolver.push(span, OpKind::Overrides { feed: overrides.0, spindle: overrides.1 });
    }
}

fn say_coolant(resolver: &mut Resolver, coolant: (bool, bool), span: Span) {
    if resolver.coolant != coolant {
        resolver.coolant = coolant;
        resolver.push(span, OpKind::Coolant { mist: coolant.0, flood: coolant.1 });
    }
}

fn change_tool(resolver: &mut Resolver, number: u32, span: Span) {
    resolver.tool = number;
    resolver.push(span, OpKind::ChangeTool { number });
}

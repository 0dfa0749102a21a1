//! Moves that follow the spindle: G33, G33.1, and what all turned threads share.
use crate::{
    call::{Call, GrowingThread, Sense, Sink, out::Out},
    coordinates::target,
    fault::{Outcome, error, refuse},
    geometry::frame::Point,
    modes::Modes,
    resolve::{Resolver, lead::meant_lead, position},
    state::executor::Settings,
    words::Words,
};
use canon::{Axis, OpKind, ReturnAcceleration, Tap};
use diag::{Diagnostic, Span};
use units::{Angle, Lead, Length, Spin, Time};

/// G33: a straight move of K per revolution.
pub(crate) fn thread<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    out: &mut Out<'_, S>,
) -> Outcome {
    let names_axes = words.any(crate::codes::AXES);
    if names_axes
        && words.get(b'K') == Some(0.0)
        && target::destination(words, modes, false)? == modes.at
    {
        return Ok(()); // a link of no length, as loops begin with
    }
    let (lead, _) = synchronised(words, modes, "G33")?;
    if words.any(crate::codes::set("ABC")) {
        return refuse("I0420", words.place.span, "G33 moves linear axes: A, B and C have no lead");
    }
    let to = target::destination(words, modes, false)?;
    let lead = if settings.rules.lead_along_axis { along_path(lead, &modes.at, &to) } else { lead };
    out.say(&Call::SyncStart(lead));
    modes.at = to;
    out.say(&Call::Line(to));
    out.say(&Call::SyncStop);
    Ok(())
}

/// G33.1: in to the words' point and back to where it stood, of K per revolution.
pub(crate) fn rigid_tap<S: Sink>(words: &Words, modes: &Modes, out: &mut Out<'_, S>) -> Outcome {
    let (lead, sense) = synchronised(words, modes, "G33.1")?;
    let to = target::destination(words, modes, false)?;
    let return_factor = words.get(b'I').unwrap_or(1.0);
    if return_factor <= 0.0 {
        let text = format!("I multiplies the speed of the way out: above 0, found {return_factor}");
        return refuse("I0421", words.span(b'I'), text);
    }
    let moved: Vec<usize> = (0..9).filter(|i| to[*i] != modes.at[*i]).collect();
    if let [_, stray, ..] = moved[..] {
        let letter = b"XYZABCUVW"[moved[0].min(stray)];
        let text = format!("a tap moves along its own axis only, but {} moves too", letter as char);
        let help = "move there with G0 before the tap";
        out.remarks.push(Diagnostic::warning("I0422", words.span(letter), text).with_help(help));
    }
    out.say(&Call::RigidTap { to, lead, return_factor, sense });
    Ok(())
}

/// What G33 and G33.1 have in common: K, a turning spindle, no F.
fn synchronised(words: &Words, modes: &Modes, code: &str) -> Outcome<(f64, Sense)> {
    let span = words.place.span;
    if !words.any(crate::codes::AXES) {
        return refuse("I0423", span, format!("{code} needs an axis word: where to"));
    }
    if words.get(b'F').is_some() {
        let fault = error(
            "I0424",
            words.span(b'F'),
            format!("{code} takes its feed from K and the spindle, not from F"),
        );
        return Err(fault.with_help("leave F out").into());
    }
    let Some(lead) = words.get(b'K') else {
        return refuse("I0425", span, format!("{code} needs K, the advance per revolution"));
    };
    if lead <= 0.0 {
        let text = format!("K is the advance per revolution, above 0, found {lead}");
        return refuse("I0426", words.span(b'K'), text);
    }
    match modes.spindle.turning {
        Some(sense) => Ok((lead, sense)),
        None => refuse(
            "I0427",
            span,
            format!("{code} needs a turning spindle: write M3 or M4, and S, before it"),
        ),
    }
}

/// A lead of the axis that goes farthest, as Fanuc's F, as one of the path.
pub(crate) fn along_path(lead: f64, from: &Point, to: &Point) -> f64 {
    let ways = [0, 1, 2].map(|i| (to[i] - from[i]).abs());
    let far = ways.into_iter().fold(0.0, f64::max);
    if far > 0.0 { lead * (way(from, to) / far) } else { lead }
}

/// Length of a straight way.
fn way(from: &Point, to: &Point) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|i| to[i] - from[i]);
    x.hypot(y).hypot(z)
}

impl GrowingThread {
    /// Turns that it takes: `way = lead·n + growth·n²/2`; not finite where the lead is used up
    /// before its end.
    pub(crate) fn count(&self) -> f64 {
        let way = way(&self.from, &self.to);
        let squared = self.lead * self.lead + 2.0 * self.growth * way;
        if squared > 0.0 { 2.0 * way / (self.lead + squared.sqrt()) } else { f64::INFINITY }
    }

    /// Turn by turn: the mean lead of each, and where it ends.
    pub(crate) fn turns(self) -> impl Iterator<Item = (f64, Point)> {
        let (way, count) = (way(&self.from, &self.to), self.count());
        let whole = if count.is_finite() { count.ceil() as u32 } else { 0 };
        (1..=whole).map(f64::from).map(move |turn| {
            let mean = self.lead + (turn - 0.5) * self.growth;
            if turn >= count {
                return (mean, self.to);
            }
            let share = (self.lead * turn + self.growth * turn * turn / 2.0) / way;
            let at = |i: usize| self.from[i] + share * (self.to[i] - self.from[i]);
            (mean, core::array::from_fn(at))
        })
    }
}

pub(crate) fn tap_operation(
    resolver: &mut Resolver,
    to: &Point,
    lead: f64,
    return_factor: f64,
    sense: Sense,
    span: Span,
) {
    let (start, end) = (resolver.at, resolver.machine(to));
    let moved: Vec<usize> = (0..9).filter(|i| (end[*i] - start[*i]).abs() > 1e-9).collect();
    let axis = match moved[..] {
        [i @ (0..=2 | 6..=8)] => Axis::ALL[i],
        [] => {
            resolver.report(Diagnostic::error(
                "I0709",
                span,
                "this tap has no depth: it ends where it starts",
            ));
            return;
        }
        _ => return crooked(resolver, &moved, span),
    };
    if resolver.spindle.speed <= 0.0 || resolver.spindle.surface.is_some() {
        let text = "a tap needs a spindle speed in revolutions per minute: write G97 and S above 0 before it";
        resolver.report(Diagnostic::error("I0703", span, text));
        return;
    }
    let i = axis.index();
    let inwards_negative = end[i] < start[i];
    let right_hand = (sense == Sense::Clockwise) == inwards_negative;
    let mm = resolver.mm();
    let lead = meant_lead(resolver, lead * mm, ('K', 1.0 / mm), span);
    let lead = Lead::mm_per_rev(if right_hand { lead } else { -lead });
    let program = resolver.frame.to_program(&start)[i];
    let zero = program + Resolver::surface(program, to[i] * resolver.mm()) - program;
    let surface = start[i] + (zero - program);
    let spin = Spin::rpm(resolver.spindle.speed);
    resolver.check_stroke(&start, &end, span);
    resolver.say_path(span);
    resolver.push(
        span,
        OpKind::Tap(Tap {
            axis,
            start: position(&start),
            bottom: Length::mm(end[i]),
            surface: Length::mm(surface),
            zero: Length::mm(start[i] - program),
            own_zero: resolver.own_zero().map(|at| at.along(axis).of_linear()),
            lead,
            spin,
            return_spin: spin * return_factor,
            return_acceleration: ReturnAcceleration::AsSet,
            dwell: Time::ZERO,
            start_angle: Some(Angle::ZERO),
            peck: None,
        }),
    );
}

fn crooked(resolver: &mut Resolver, moved: &[usize], span: Span) {
    let names: Vec<_> = moved.iter().map(|i| Axis::ALL[*i].letter().to_string()).collect();
    let text =
        format!("a tap moves along one axis, but this one would move {}", names.join(" and "));
    let help = "move to the hole with G0 first, then tap with the axis word alone";
    resolver.report(Diagnostic::error("I0705", span, text).with_help(help));
}

//! One hole of a cycle: in, what is done at the bottom, and out again.
use crate::{
    call::{Call, CycleHole, CycleTap, Sink, Units, out::Out},
    cycles::holes::boring,
    geometry::frame::Point,
    modes::{
        Cycle, Modes,
        tapping::{Shift, TapWords},
    },
    resolve::{Resolver, position},
    state::executor::Settings,
    words::Words,
};
use canon::{Hole, OpKind};
use diag::Span;
use units::Length;

/// How far above the last depth the rapid back into the hole ends, and how far G73 backs off: 0.010 inch.
const CLEARANCE_INCH: f64 = 0.010;
/// Cycles that begin where the bore ends.
pub(crate) const fn bores_upwards(cycle: Cycle) -> bool {
    matches!(cycle, Cycle::BoreUpwards)
}

/// One hole, at the place where the plane's two axes are to stand.
pub(crate) fn hole<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    pattern: &Pattern,
    throw_rpm: Option<f64>,
    out: &mut Out<'_, S>,
) {
    let [_, _, n] = modes.plane_axes();
    let mut at = modes.at;
    at[n] = pattern.r;
    let hole = CycleHole {
        plane: modes.plane,
        at,
        bottom: pattern.bottom,
        clear: pattern.clear,
        throw_rpm,
    };
    let tap = pattern.cycle.tap_sense();
    let upwards = bores_upwards(pattern.cycle);
    if tap.is_none() && pattern.shift.is_none() && !upwards {
        out.say(&Call::Hole(hole));
    }
    out.say(&Call::Rapid(modes.at));
    if modes.at[n] != pattern.r {
        out.say(&Call::Rapid(at));
    }
    if upwards {
        let levels = [pattern.bottom, pattern.counterbore];
        boring::bore_upwards(modes, settings, &at, levels, (pattern.peck, pattern.dwell), out);
    } else if let Some(shift) = pattern.shift {
        let levels = [pattern.bottom, pattern.counterbore, pattern.clear];
        boring::back_bore(modes, &at, levels, shift, out);
    } else if let Some(sense) = tap {
        let overrides = (modes.feed_override, modes.speed_override);
        let call = pattern.tap.call(hole, sense, pattern.dwell, overrides);
        let feed_stated = words.get(b'F').is_some();
        out.say(&Call::Tap(CycleTap { feed_stated, ..call }));
    } else {
        down_and_out(modes, settings, pattern, &hole, n, out);
    }
    modes.at[n] = pattern.clear;
}

fn down_and_out<S: Sink>(
    modes: &Modes,
    settings: &Settings,
    pattern: &Pattern,
    hole: &CycleHole,
    n: usize,
    out: &mut Out<'_, S>,
) {
    let level = |value: f64| -> Point {
        let mut point = hole.at;
        point[n] = value;
        point
    };
    if matches!(pattern.cycle, Cycle::ChipBreak | Cycle::Peck) {
        peck(modes, pattern, level, out);
    }
    out.say(&Call::Line(level(pattern.bottom)));
    let clear = level(pattern.clear);
    match pattern.cycle {
        Cycle::Drill | Cycle::DrillDwell => {
            if pattern.cycle == Cycle::DrillDwell || pattern.dwell > 0.0 {
                out.say(&Call::Dwell(pattern.dwell));
            }
            if hole.throw_rpm.is_some() {
                out.say(&Call::ThrowChips(*hole));
            }
            out.say(&Call::Rapid(clear));
        }
        Cycle::BoreFeedOut => {
            out.say(&Call::Line(level(pattern.r)));
            out.say(&Call::Rapid(clear));
        }
        Cycle::BoreDwellFeedOut => {
            out.say(&Call::Dwell(pattern.dwell));
            out.say(&Call::Line(clear));
        }
        Cycle::BoreStopOut => {
            out.say(&Call::Dwell(pattern.dwell));
            out.say(&Call::SpindleStop);
            out.say(&Call::Rapid(clear));
            boring::turn_again(modes, out);
        }
        Cycle::FineBore => {
            if pattern.dwell > 0.0 {
                out.say(&Call::Dwell(pattern.dwell));
            }
            boring::fine_bore_out(
                modes,
                settings,
                &level(pattern.bottom),
                &clear,
                pattern.peck,
                out,
            );
        }
        Cycle::BoreManualOut => {
            out.say(&Call::Dwell(pattern.dwell));
            out.say(&Call::SpindleStop);
            out.say(&Call::Stop);
            out.say(&Call::OutByHand(clear));
            boring::turn_again(modes, out);
        }
        Cycle::ChipBreak
        | Cycle::Peck
        | Cycle::BackBore
        | Cycle::BoreUpwards
        | Cycle::TapLeft
        | Cycle::TapRight
        | Cycle::RigidLeft
        | Cycle::RigidRight
        | Cycle::SynchroLeft
        | Cycle::SynchroRight => out.say(&Call::Rapid(clear)),
    }
}

/// All pecks but the last.
fn peck<S: Sink>(
    modes: &Modes,
    pattern: &Pattern,
    level: impl Fn(f64) -> Point,
    out: &mut Out<'_, S>,
) {
    let clearance = match modes.units {
        Units::Inch => CLEARANCE_INCH,
        Units::Millimetre => CLEARANCE_INCH * units::MM_PER_INCH,
    };
    let mut depth = pattern.r - pattern.peck;
    while depth > pattern.bottom {
        out.say(&Call::Line(level(depth)));
        if pattern.cycle == Cycle::Peck {
            out.say(&Call::Rapid(level(pattern.r)));
        }
        out.say(&Call::Rapid(level(depth + clearance)));
        depth -= pattern.peck;
    }
}

/// A cycle with its words read and checked.
pub(crate) struct Pattern {
    pub(crate) cycle: Cycle,
    pub(crate) r: f64,
    pub(crate) bottom: f64,
    pub(crate) clear: f64,
    pub(crate) dwell: f64,
    pub(crate) peck: f64,
    pub(crate) tap: TapWords,
    pub(crate) shift: Option<Shift>,
    pub(crate) counterbore: f64,
}

/// Where it is drilled or bored, for those who judge the part.
pub(crate) fn operation(resolver: &mut Resolver, hole: &CycleHole, span: Span) {
    if !resolver.plane_is_straight(hole.plane, span) {
        return;
    }
    let axis = hole.plane.normal();
    let surface = Resolver::surface(hole.at[axis.index()], hole.bottom);
    resolver.say_path(span);
    resolver.push(
        span,
        OpKind::Hole(Hole {
            axis,
            at: position(&resolver.machine(&hole.at)),
            bottom: Length::mm(resolver.level(hole, hole.bottom)),
            surface: Length::mm(resolver.level(hole, surface)),
            zero: Length::mm(resolver.level(hole, 0.0)),
            own_zero: resolver.own_zero().map(|at| at.along(axis).of_linear()),
        }),
    );
}

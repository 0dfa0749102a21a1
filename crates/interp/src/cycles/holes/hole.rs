//! One hole of a cycle: in, what is done at the bottom, and out again.
use crate::{
    call::{Call, CycleHole, CycleTap, Sink, out::Out},
    cycles::holes::{
        back_bore, bore, drill, fine_bore,
        pattern::{Pattern, at_level},
        peck,
    },
    modes::{Cycle, Modes},
    resolve::{Resolver, position},
    state::executor::Settings,
    words::Words,
};
use canon::{Hole, OpKind};
use diag::Span;
use units::Length;

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
    let upwards = fine_bore::bores_upwards(pattern.cycle);
    if tap.is_none() && pattern.shift.is_none() && !upwards {
        out.say(&Call::Hole(hole));
    }
    out.say(&Call::Rapid(modes.at));
    if modes.at[n] != pattern.r {
        out.say(&Call::Rapid(at));
    }
    if upwards {
        let levels = [pattern.bottom, pattern.counterbore];
        fine_bore::bore_upwards(modes, settings, &at, levels, (pattern.peck, pattern.dwell), out);
    } else if let Some(shift) = pattern.shift {
        let levels = [pattern.bottom, pattern.counterbore, pattern.clear];
        back_bore::back_bore(modes, &at, levels, shift, out);
    } else if let Some(sense) = tap {
        let overrides = (modes.feed_override, modes.speed_override);
        let call = pattern.tap.call(hole, sense, pattern.dwell, overrides);
        let feed_stated = words.get(b'F').is_some();
        out.say(&Call::Tap(CycleTap { feed_stated, ..call }));
    } else {
        down_and_out(modes, settings, pattern, &hole, out);
    }
    modes.at[n] = pattern.clear;
}

fn down_and_out<S: Sink>(
    modes: &Modes,
    settings: &Settings,
    pattern: &Pattern,
    hole: &CycleHole,
    out: &mut Out<'_, S>,
) {
    if matches!(pattern.cycle, Cycle::ChipBreak | Cycle::Peck) {
        peck::in_pecks(modes, pattern, hole, out);
    }
    let [bottom, clear] = [pattern.bottom, pattern.clear].map(|level| at_level(hole, level));
    out.say(&Call::Line(bottom));
    match pattern.cycle {
        Cycle::Drill | Cycle::DrillDwell => drill::out(pattern, hole, out),
        Cycle::BoreFeedOut => bore::feed_out(pattern, hole, out),
        Cycle::BoreDwellFeedOut => bore::wait_and_feed_out(pattern, hole, out),
        Cycle::BoreStopOut => bore::stop_and_out(modes, pattern, hole, out),
        Cycle::BoreManualOut => bore::out_by_hand(modes, pattern, hole, out),
        Cycle::FineBore => {
            if pattern.dwell > 0.0 {
                out.say(&Call::Dwell(pattern.dwell));
            }
            fine_bore::out(modes, settings, &bottom, &clear, pattern.peck, out);
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

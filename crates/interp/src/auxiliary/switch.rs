//! What a block switches: feed and spindle modes, tools, coolant, overrides, dwell.
use crate::{
    call::{Call, Corners, Sense, Sink, Units, out::Out},
    codes::{GGroup, MGroup},
    fault::{Outcome, refuse},
    geometry::frame,
    modes::{FeedMode, Modes},
    state::executor::Settings,
    words::Words,
};
use diag::Diagnostic;
use units::TurnDirection;

/// G96 without D: no limit. LinuxCNC says it with this number.
pub(crate) const NO_SPEED_LIMIT: f64 = 1e30;

/// G93, G94, G95 and F.
pub(crate) fn feed_mode<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    if let Some(code) = words.g(GGroup::FeedMode) {
        let mode = match code {
            930 => FeedMode::InverseTime,
            950 => FeedMode::PerRevolution,
            _ => FeedMode::PerMinute,
        };
        set_feed_mode(modes, mode, out);
    }
    let Some(feed) = words.get(b'F') else { return Ok(()) };
    if feed < 0.0 {
        return refuse("I0402", words.span(b'F'), format!("F must not be negative, found {feed}"));
    }
    if modes.feed_mode != FeedMode::InverseTime {
        out.say(&Call::FeedRate { rate: feed, duration_s: None });
        let changed = match words.g(GGroup::Units) {
            Some(200) => modes.units != Units::Inch,
            Some(210) => modes.units != Units::Millimetre,
            _ => false,
        };
        if changed {
            let text = format!(
                "F{feed} is still read in the units before this block: F comes before G20/G21"
            );
            let help = "write G20 or G21 in a block before";
            out.remarks.push(Diagnostic::warning("I0403", words.span(b'F'), text).with_help(help));
        }
    }
    modes.feed = feed;
    Ok(())
}

pub(crate) fn set_feed_mode<S: Sink>(modes: &mut Modes, mode: FeedMode, out: &mut Out<'_, S>) {
    modes.feed_mode = mode;
    let note = match mode {
        FeedMode::InverseTime => "feed mode set to inverse time",
        FeedMode::PerMinute => "feed mode set to units per minute",
        FeedMode::PerRevolution => "feed mode set to units per revolution",
    };
    out.say(&Call::Note(note));
    out.say(&Call::FeedMode { per_revolution: mode == FeedMode::PerRevolution });
    if mode != FeedMode::InverseTime {
        out.say(&Call::FeedRate { rate: 0.0, duration_s: None });
        modes.feed = 0.0; // a number per minute means nothing per revolution
    }
}

/// G96, G97 and S.
pub(crate) fn spindle_speed<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    out: &mut Out<'_, S>,
) -> Outcome {
    spindle_number(words)?;
    let mut speed = words.get(b'S');
    let was_surface = modes.spindle.constant_surface_speed;
    if was_surface {
        modes.spindle.surface_speed = modes.spindle.speed;
    }
    let keeps = settings.rules.keeps_speed;
    match words.g(GGroup::SpindleMode) {
        Some(960) => {
            if keeps && modes.spindle.surface_speed > 0.0 {
                speed = speed.or(Some(modes.spindle.surface_speed));
            }
            if speed.is_none() {
                return refuse("I0601", words.place.span, "G96 needs S, the surface speed");
            }
            let limit = words.get(b'D').unwrap_or(NO_SPEED_LIMIT);
            out.say(&Call::SpindleMode(limit.abs()));
            modes.spindle.constant_surface_speed = true;
            modes.spindle.limit = limit.abs();
        }
        Some(_) => {
            out.say(&Call::SpindleMode(0.0));
            modes.spindle.constant_surface_speed = false;
            if keeps && was_surface {
                speed = speed.or_else(|| Some(turned_speed(modes, settings.fastest_rpm)));
            }
        }
        None => {}
    }
    let Some(speed) = speed else { return Ok(()) };
    if speed < 0.0 {
        let text = format!("S must not be negative, found {speed}; M4 turns the other way");
        return refuse("I0602", words.span(b'S'), text);
    }
    modes.spindle.speed = speed;
    out.say(&Call::SpindleSpeed(speed));
    Ok(())
}

/// The revolutions per minute that constant surface speed orders where X stands: at most its limit,
/// and what the spindle can.
fn turned_speed(modes: &Modes, fastest: f64) -> f64 {
    const MM_PER_M: f64 = 1000.0;
    const INCHES_PER_FOOT: f64 = 12.0;
    let unit = if modes.units == Units::Inch { INCHES_PER_FOOT } else { MM_PER_M };
    let round = core::f64::consts::TAU * modes.at[0].abs();
    let speed = if round > 0.0 { modes.spindle.speed * unit / round } else { f64::INFINITY };
    speed.min(modes.spindle.limit).min(fastest)
}

/// `$`: the only spindle is 0, and −1 means all.
fn spindle_number(words: &Words) -> Outcome {
    match words.get(b'$') {
        None | Some(0.0 | -1.0) => Ok(()),
        Some(other) => {
            let text = format!("expected spindle $0, the only one, found ${other}");
            refuse("I0603", words.span(b'$'), text)
        }
    }
}

/// M7, M8, M9.
pub(crate) fn coolant<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    match words.m(MGroup::Coolant) {
        Some(7) => mist(modes, true, out),
        Some(8) => flood(modes, true, out),
        Some(_) => {
            mist(modes, false, out);
            flood(modes, false, out);
        }
        None => {}
    }
}

fn mist<S: Sink>(modes: &mut Modes, on: bool, out: &mut Out<'_, S>) {
    modes.mist = on;
    out.say(&Call::Mist(on));
}

fn flood<S: Sink>(modes: &mut Modes, on: bool, out: &mut Out<'_, S>) {
    modes.flood = on;
    out.say(&Call::Flood(on));
}

pub(crate) fn spindle<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) -> Outcome {
    let sense = match words.m(MGroup::Spindle) {
        None => return Ok(()),
        Some(3) => Sense::Clockwise,
        Some(4) => Sense::Counterclockwise,
        Some(19) => return orient(words, modes, out),
        Some(_) => {
            modes.spindle.turning = None;
            out.say(&Call::SpindleStop);
            return Ok(());
        }
    };
    modes.spindle.turning = Some(sense);
    out.say(&Call::SpindleTurn(sense));
    Ok(())
}

fn orient<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) -> Outcome {
    let span = words.place.span;
    let Some(angle) = words.get(b'R') else {
        return refuse("I0605", span, "M19 needs R, the angle in degrees");
    };
    if !(0.0..=360.0).contains(&angle) {
        let text = format!("M19 takes R from 0 to 360 degrees, found {angle}");
        return refuse("I0606", words.span(b'R'), text);
    }
    let mode = words.whole(b'P', 2)?.unwrap_or(0) as u8;
    let longest = words.get(b'Q');
    if let Some(longest) = longest.filter(|longest| *longest <= 0.0) {
        let text = format!("M19 waits Q seconds at most: more than 0, found {longest}");
        return refuse("I0607", words.span(b'Q'), text);
    }
    let direction = match mode {
        1 => TurnDirection::Forward,
        2 => TurnDirection::Backward,
        _ => TurnDirection::Shortest,
    };
    modes.spindle.turning = None;
    out.say(&Call::SpindleOrient { angle, direction, mode, longest });
    Ok(())
}

pub(crate) fn overrides<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    let on = words.get(b'P').is_none_or(|p| p != 0.0);
    match words.m(MGroup::Overrides) {
        Some(code @ (48 | 49)) => {
            modes.feed_override = code == 48;
            modes.speed_override = code == 48;
            out.say(&Call::FeedOverride(code == 48));
            out.say(&Call::SpeedOverride(code == 48));
        }
        Some(50) => {
            modes.feed_override = on;
            out.say(&Call::FeedOverride(on));
        }
        Some(51) => {
            modes.speed_override = on;
            out.say(&Call::SpeedOverride(on));
        }
        Some(52) => {
            modes.adaptive_feed = on;
            out.say(&Call::AdaptiveFeed(on));
        }
        Some(_) => {
            modes.feed_hold = on;
            out.say(&Call::FeedHold(on));
        }
        None => {}
    }
}

pub(crate) fn dwell<S: Sink>(words: &Words, out: &mut Out<'_, S>) -> Outcome {
    if words.g(GGroup::NonModal) != Some(40) {
        return Ok(());
    }
    match words.get(b'P') {
        Some(seconds) if seconds >= 0.0 => {
            out.say(&Call::Dwell(seconds));
            Ok(())
        }
        Some(seconds) => refuse(
            "I0608",
            words.span(b'P'),
            format!("G4 waits P seconds, 0 or more, found {seconds}"),
        ),
        None => refuse("I0609", words.place.span, "G4 needs P, the seconds to wait"),
    }
}

/// G20, G21.
pub(crate) fn units<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    let Some(code) = words.g(GGroup::Units) else { return };
    set_units(modes, if code == 200 { Units::Inch } else { Units::Millimetre }, out);
}

pub(crate) fn set_units<S: Sink>(modes: &mut Modes, units: Units, out: &mut Out<'_, S>) {
    if units != modes.units {
        let factor = match units {
            Units::Inch => 1.0 / units::MM_PER_INCH,
            Units::Millimetre => units::MM_PER_INCH,
        };
        modes.frame.scale(factor);
        frame::scale(&mut modes.at, factor);
        if let Some(beside) = &mut modes.left_beside {
            frame::scale(beside, factor);
        }
        if let Some(compensation) = &mut modes.compensation {
            compensation.scale(factor);
        }
        out.scale(factor);
        modes.units = units;
    }
    out.say(&Call::UseUnits(units));
}

/// G61, G61.1, G64.
pub(crate) fn path_control<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    let Some(code) = words.g(GGroup::PathControl) else { return Ok(()) };
    let mut merge = None;
    modes.corners = match code {
        610 => Corners::ExactPath,
        611 => Corners::ExactStop,
        _ => {
            for letter in [b'P', b'Q'] {
                if let Some(value) = words.get(letter).filter(|v| *v < 0.0) {
                    let text = format!(
                        "a tolerance must not be negative, found {}{value}",
                        letter as char
                    );
                    return refuse("I0404", words.span(letter), text);
                }
            }
            let tolerance = words.get(b'P').unwrap_or(0.0);
            merge = Some(words.get(b'Q').unwrap_or(tolerance));
            Corners::Continuous(tolerance)
        }
    };
    modes.merge = merge.unwrap_or(modes.merge);
    out.say(&Call::PathControl { corners: modes.corners, merge });
    Ok(())
}

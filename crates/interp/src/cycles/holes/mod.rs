//! The drilling, tapping and boring cycles, written once for the three planes.
//!
//! What they have in common is here: where the holes are, how often, at which levels. [`hole`]
//! makes one hole of a [`Pattern`], and each cycle has its own file.
//!
//! ```text
//!   initial ┬ · · · ·●━━━━━━━━━━━┓ · · · · G98 returns here
//!           │ rapid              ┃
//!         R ┼ · · · · · · · · · ·┃ · · · · G99 returns here
//!           │        │ feed      ↑
//!    bottom ┴        ↓━━━━━━━━━━━┛
//!
//!   G81 out fast        G82 wait, out fast       G85 feed out
//!   G73 back 0.254 mm after each Q               G86 wait, stop, out fast
//!   G83 out to R after each Q                    G89 wait, feed out
//!   G84, G74, G84.2, G84.3 tap: one call, because it is one motion with the spindle
//! ```
//!
//! R and Z are kept as written for the blocks that repeat the cycle; L repeats it in place (G90) or
//! step by step (G91, where R counts from the initial level and Z from R or, as the machine is set,
//! from the initial level too). A tap without P waits as long as the last cycle that had one,
//! whichever it was.
//!
//! Source: NISTIR 6556, section 3.5.16; LinuxCNC 2.9 manual, "Canned cycles".
pub(crate) mod back_bore;
pub(crate) mod bore;
pub(crate) mod chip_removal;
pub(crate) mod drill;
pub(crate) mod fine_bore;
pub(crate) mod hole;
pub(crate) mod pattern;
pub(crate) mod peck;
pub(crate) mod rigid;
pub(crate) mod synchro_tap;
pub(crate) mod tap;

use crate::{
    call::{Call, Corners, Sink, out::Out},
    codes::{
        AXES, GGroup, POLAR,
        spelling::{Written, short},
    },
    coordinates::target,
    cycles::holes::pattern::Pattern,
    dialect::DepthFrom,
    fault::{Outcome, error, refuse},
    modes::{Cycle, Modes, Sticky, tapping::TapWords},
    motion,
    state::{executor::Settings, tools::Tools},
    words::Words,
};
use diag::Diagnostic;

pub(crate) fn cycle<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    tools: &Tools,
    settings: &Settings,
    cycle: Cycle,
    out: &mut Out<'_, S>,
) -> Outcome {
    let code = crate::codes::spelling::written(cycle.code());
    let [a, b, n] = modes.plane_axes();
    if !words.any(AXES | POLAR) {
        return refuse(
            "I0516",
            words.place.span,
            format!("G{code} needs an axis word: where to drill"),
        );
    }
    if !tap::lead_is_the_taps(modes, tools, cycle) && !cycle.is_synchro() {
        motion::check_cycle_feed(words, modes, code)?;
    }
    let repeats = repeats(words, modes, settings, cycle, out)?;
    let mut sticky = sticky(words, modes, settings, cycle, code)?;
    sticky.chips = chip_removal::chips(words, modes, settings, cycle, code, sticky.chips, out)?;
    if repeats == 0 {
        // Fanuc's K0: the words are kept for the blocks that follow
        modes.sticky = Some(sticky);
        return Ok(());
    }
    let initial = *modes.initial.get_or_insert(modes.at[n]);
    let pattern = pattern(words, modes, settings, cycle, code, &sticky, initial)?;
    peck::check_block(words, settings, repeats, &pattern)?;
    check_spindle(words, modes, settings, cycle, code)?;
    if modes.sticky.is_none() || words.g(GGroup::Motion).is_some() {
        modes.repetition = 0;
    }
    modes.sticky = Some(sticky);
    modes.last_dwell = sticky.dwell.or(modes.last_dwell);

    if initial < pattern.r {
        modes.at[n] = pattern.r;
        out.say(&Call::Rapid(modes.at));
    }
    if modes.at[n] <= pattern.r {
        // To the next hole at the level where this one ends, which is not lower.
        modes.at[n] = pattern.clear;
    }
    let exact = modes.corners == Corners::ExactPath;
    if !exact {
        out.say(&Call::PathControl { corners: Corners::ExactPath, merge: None });
    }
    for step in 0..repeats {
        step_in_plane(words, modes, [a, b], step)?;
        let throw_rpm = chip_removal::throw_after_this(modes, sticky.chips);
        hole::hole(words, modes, settings, &pattern, throw_rpm, out);
    }
    if !exact {
        out.say(&Call::PathControl { corners: modes.corners, merge: Some(modes.merge) });
    }
    Ok(())
}

/// Where the next hole is, along the plane's two axes; so many were made by this block.
fn step_in_plane(words: &Words, modes: &mut Modes, axes: [usize; 2], made: u32) -> Outcome {
    if words.any(POLAR) {
        [modes.at[0], modes.at[1]] = target::polar(words, modes)?;
        return Ok(());
    }
    if modes.incremental && words.step_turns_deg != 0.0 {
        // on a circle: each step is the one before, turned
        let [x, y] = axes.map(|axis| target::axis_word(words, modes, axis).unwrap_or(0.0));
        let (sin, cos) = (words.step_turns_deg * f64::from(made)).to_radians().sin_cos();
        modes.at[axes[0]] += x * cos - y * sin;
        modes.at[axes[1]] += x * sin + y * cos;
        return Ok(());
    }
    for axis in axes {
        if let Some(value) = target::axis_word(words, modes, axis) {
            modes.at[axis] = if modes.incremental { modes.at[axis] + value } else { value };
        }
    }
    Ok(())
}

/// How often: L, or the dialect's letter.
fn repeats<S: Sink>(
    words: &Words,
    modes: &Modes,
    settings: &Settings,
    cycle: Cycle,
    out: &mut Out<'_, S>,
) -> Outcome<u32> {
    let letter = settings.rules.repeats;
    let name = letter as char;
    if letter != b'L' && words.get(b'L').is_some() && !cycle.is_synchro() {
        let text = format!("L has no effect here: in this dialect {name} counts repetitions");
        return refuse("I0517", words.span(b'L'), text);
    }
    let repeats = words.whole(letter, 100_000)?.unwrap_or(1);
    let span = words.span(letter);
    if repeats == 0 && !settings.rules.no_repetition {
        let text = format!("{name}0 makes no hole: {name} counts repetitions, 1 or more");
        return refuse("I0502", span, text);
    }
    if repeats > 1 && !modes.incremental {
        let text = format!("{name}{repeats} with G90 makes the same hole {repeats} times");
        out.remarks.push(
            Diagnostic::warning("I0503", span, text).with_help("G91 steps from hole to hole"),
        );
    }
    Ok(repeats)
}

/// R, Z, P, Q of this block, or those that the cycle kept.
fn sticky(
    words: &Words,
    modes: &Modes,
    settings: &Settings,
    cycle: Cycle,
    code: Written,
) -> Outcome<Sticky> {
    let [_, _, n] = modes.plane_axes();
    let axis = b"XYZ"[n] as char;
    let kept = modes.sticky.filter(|kept| kept.plane == modes.plane);
    let span = words.place.span;
    let Some(r) = words.get(b'R').or(kept.map(|k| k.r)) else {
        let text = format!("G{code} needs R, the level just above the work");
        return refuse("I0504", span, text);
    };
    let written = [words.get(b'R').is_some(), target::axis_word(words, modes, n).is_some()];
    let meant = kept.map(|k| k.by_way).filter(|_| settings.rules.keeps_levels);
    let by_way = core::array::from_fn(|i| match meant {
        Some(meant) if !written[i] => meant[i],
        _ => modes.incremental,
    });
    let Some(bottom) = target::axis_word(words, modes, n).or(kept.map(|k| k.bottom)) else {
        let text = format!("G{code} needs {axis}, the depth");
        return refuse("I0505", span, text);
    };
    let tapping = cycle.tap_sense().is_some() && settings.rules.taps_keep_dwell;
    let before = if tapping { modes.last_dwell } else { None };
    let dwell = words.get(b'P').or(kept.and_then(|k| k.dwell)).or(before);
    let peck = words.get(b'Q').or(kept.and_then(|k| k.peck));
    if let Some(seconds) = dwell.filter(|p| *p < 0.0) {
        return refuse(
            "I0506",
            words.span(b'P'),
            format!("P is a time in seconds, 0 or more, found {seconds}"),
        );
    }
    let waits = matches!(
        cycle,
        Cycle::DrillDwell | Cycle::BoreStopOut | Cycle::BoreManualOut | Cycle::BoreDwellFeedOut
    );
    if waits && dwell.is_none() {
        return refuse(
            "I0507",
            span,
            format!("G{code} needs P, the seconds to wait at the bottom"),
        );
    }
    if matches!(cycle, Cycle::ChipBreak | Cycle::Peck) {
        peck::check_word(words, code, peck)?;
    }
    if matches!(cycle, Cycle::FineBore | Cycle::BoreUpwards) {
        fine_bore::check_fine_boring(words, modes, cycle, peck)?;
    }
    let tap = match cycle.tap_sense() {
        Some(_) if cycle.is_synchro() => {
            synchro_tap::synchro_words(words, modes, cycle, kept.map(|k| k.tap))?
        }
        Some(_) => tap::tap_words(words, kept.map(|k| k.tap))?,
        None => TapWords::default(),
    };
    let chips = kept.and_then(|k| k.chips);
    let shift = back_bore::shift_words(words, cycle, kept.and_then(|k| k.shift))?;
    Ok(Sticky { r, bottom, by_way, dwell, peck, tap, shift, chips, plane: modes.plane })
}

fn pattern(
    words: &Words,
    modes: &Modes,
    settings: &Settings,
    cycle: Cycle,
    code: Written,
    sticky: &Sticky,
    initial: f64,
) -> Outcome<Pattern> {
    if fine_bore::bores_upwards(cycle) {
        let [bottom, counterbore] =
            fine_bore::upward_levels(words, modes, sticky.r, sticky.bottom, initial)?;
        let (dwell, peck) = (sticky.dwell.unwrap_or(0.0), sticky.peck.unwrap_or(0.0));
        let (tap, shift) = (sticky.tap, None);
        let (r, clear) = (initial, initial);
        return Ok(Pattern { cycle, r, bottom, clear, dwell, peck, tap, shift, counterbore });
    }
    let [r_by_way, bottom_by_way] = sticky.by_way;
    let r = if r_by_way { initial + sticky.r } else { sticky.r };
    let bottom = match settings.cycles.depth_from {
        _ if !bottom_by_way => sticky.bottom,
        DepthFrom::RPlane => r + sticky.bottom,
        DepthFrom::InitialLevel => initial + sticky.bottom,
    };
    if r < bottom {
        return Err(upside_down(words, modes, settings, code, r, bottom).into());
    }
    let peck = sticky.peck.unwrap_or(f64::INFINITY);
    if matches!(cycle, Cycle::ChipBreak | Cycle::Peck) {
        peck::check_depth(words, peck, r - bottom)?;
    }
    tap::check_pecks(words, &sticky.tap, r - bottom)?;
    let clear = if modes.retract_to_initial { initial.max(r) } else { r };
    let dwell = sticky.dwell.unwrap_or(0.0);
    let counterbore = back_bore::counterbore(words, modes, sticky.shift, bottom)?;
    let (tap, shift) = (sticky.tap, sticky.shift);
    Ok(Pattern { cycle, r, bottom, clear, dwell, peck, tap, shift, counterbore })
}

fn upside_down(
    words: &Words,
    modes: &Modes,
    settings: &Settings,
    code: Written,
    r: f64,
    bottom: f64,
) -> Diagnostic {
    let [_, _, n] = modes.plane_axes();
    let axis = b"XYZ"[n] as char;
    let (r, bottom) = (short(r), short(bottom));
    let text = format!("G{code} would end above where it begins: R is {r}, {axis} is {bottom}");
    error("I0510", words.place.span, text).with_help(
        match (modes.incremental, settings.cycles.depth_from) {
            (false, _) => {
                format!("R must be at or above {axis}; both count from the work's zero (G90)")
            }
            (true, DepthFrom::RPlane) => {
                format!(
                    "R counts from the initial level, {axis} from R (G91): {axis} must be negative"
                )
            }
            (true, DepthFrom::InitialLevel) => format!(
                "R and {axis} both count from the initial level (G91): {axis} must be below R"
            ),
        },
    )
}

fn check_spindle(
    words: &Words,
    modes: &Modes,
    settings: &Settings,
    cycle: Cycle,
    code: Written,
) -> Outcome {
    let turning = modes.spindle.turning;
    let span = words.place.span;
    if let Some(sense) = cycle.tap_sense() {
        return tap::check_spindle(words, modes, settings, (cycle, sense), code);
    }
    match (cycle, turning) {
        (
            Cycle::BoreStopOut
            | Cycle::BackBore
            | Cycle::BoreManualOut
            | Cycle::FineBore
            | Cycle::BoreUpwards,
            None,
        ) => {
            let text = format!(
                "G{code} stops the spindle and starts it again: it must turn before, write M3 or M4"
            );
            refuse("I0515", span, text)
        }
        _ => Ok(()),
    }
}

//! A profile taken down from its blocks instead of being moved along.
//!
//! The first straight move leads to the profile's begin. `A` rounds the corner at a move's end, `C`
//! cuts it off; `U` and `W` are increments of X and Z. What else a block says has no effect, as on
//! LinuxCNC, and a warning says so.
use crate::{
    call::{Sink, out::Out},
    codes::{GGroup, set},
    coordinates::target,
    fault::{Outcome, error, refuse},
    geometry::{
        frame::Point,
        offset_curve::{Flat, Way},
    },
    modes::{Modes, Motion},
    motion::arcs,
    profile::{
        corner::Corner,
        recording::{MAX_MOVES, Recording},
        shape::Unfit,
    },
    state::executor::Executor,
    words::Words,
};
use diag::Diagnostic;

/// Take down the block whose words were read.
pub(crate) fn record<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    let Some(mut recording) = ex.recording.take() else { return Ok(()) };
    let result = take_down(&mut ex.words, &mut ex.modes, &mut recording, out);
    ex.recording = Some(recording);
    result
}

fn take_down<S: Sink>(
    words: &mut Words,
    modes: &mut Modes,
    recording: &mut Recording,
    out: &mut Out<'_, S>,
) -> Outcome {
    if let Some(code) = words.g(GGroup::Compensation) {
        recording.side(code);
    }
    let motion = match words.g(GGroup::Motion) {
        Some(code @ 0..=30) => {
            recording.motion = Motion::from_code(code);
            Some(recording.motion)
        }
        Some(_) => None,
        None => Some(recording.motion),
    };
    let Some(motion) = motion.filter(|_| words.any(set("XZUW"))) else {
        warn_of_idle_words(words, recording, u32::MAX, out);
        return Ok(());
    };
    let corner = match (words.take(b'A'), words.take(b'C')) {
        (None, None) => Corner::Sharp,
        (Some(radius), None) if radius > 0.0 => Corner::Fillet(radius),
        (None, Some(size)) if size > 0.0 => Corner::Chamfer(size),
        _ => {
            let text = "a corner of a profile is rounded (A) or cut off (C), by a length above 0";
            return refuse("I0586", words.place.span, text);
        }
    };
    let to = profile_point(words, modes)?;
    warn_of_idle_words(words, recording, !set("XZIKRGF"), out);
    let way = profile_way(words, modes, motion, &to)?;
    if let Some(feed) = words.get(b'F').filter(|feed| *feed > 0.0) {
        recording.feeds.push((recording.moves.len(), feed));
    }
    recording.go(way, corner);
    modes.at = to;
    if recording.moves.len() > MAX_MOVES {
        let text = format!("a profile has {MAX_MOVES} moves at most");
        return refuse("I0584", words.place.span, text);
    }
    Ok(())
}

/// Where X, Z, U, W lead.
fn profile_point(words: &mut Words, modes: &Modes) -> Outcome<Point> {
    let span = words.place.span;
    let steps = [(b'U', b'X'), (b'W', b'Z')].map(|(step, letter)| {
        let twice = words.get(letter).is_some();
        words.take(step).map(|value| (value, twice, letter))
    });
    let mut to = target::destination(words, modes, false)?;
    for (axis, step) in [0, 2].into_iter().zip(steps) {
        let Some((value, twice, letter)) = step else { continue };
        if twice {
            let text =
                format!("{} is given twice, as a coordinate and as an increment", letter as char);
            return refuse("I0101", span, text);
        }
        let halved = axis == 0 && modes.diameter;
        to[axis] = modes.at[axis] + if halved { value / 2.0 } else { value };
    }
    Ok(to)
}

fn profile_way(words: &Words, modes: &Modes, motion: Motion, to: &Point) -> Outcome<Way> {
    let flat = |point: &Point| -> Flat { [point[2], point[0]] };
    let (from, to) = (flat(&modes.at), flat(to));
    let turns = match motion {
        Motion::ArcClockwise => -1,
        Motion::ArcCounterclockwise => 1,
        _ => return Ok(Way { from, to, circle: None }),
    };
    let centre = arcs::centre(words, modes, from, to, turns < 0, true)?;
    Ok(Way { from, to, circle: Some((centre, turns)) })
}

/// Once for each profile: words that it does not take.
fn warn_of_idle_words<S: Sink>(
    words: &Words,
    recording: &mut Recording,
    idle: u32,
    out: &mut Out<'_, S>,
) {
    let stray = words.has_m() || words.any(idle & !set("GF"));
    if recording.warned || !stray {
        return;
    }
    recording.warned = true;
    let text = "only G0 to G3 with X, Z, U, W, I, K, R, A and C have an effect in a profile";
    out.remarks.push(
        Diagnostic::warning("I0589", words.place.span, text).with_help(
            "write the other words before or after the cycle. Said once for each profile",
        ),
    );
}

/// The sentence for a profile that cannot be cut.
pub(crate) fn unfit(words: &Words, modes: &Modes, why: &Unfit) -> Diagnostic {
    let span = words.place.span;
    let at = |[z, x]: Flat| {
        let (letter, x) = if modes.diameter { ("diameter ", 2.0 * x) } else { ("X", x) };
        format!("{letter}{x:.4} Z{z:.4}")
    };
    match *why {
        Unfit::Back(point) => {
            let text = format!("the profile runs back at {}", at(point));
            error("I0585", span, text).with_help(
                "from its begin to its end it must go one way only: along Z for G71 and G73, along X for G72",
            )
        }
        Unfit::Corner(size, point) => {
            let text = format!(
                "a corner of {} does not fit at {}",
                crate::codes::spelling::short(size),
                at(point)
            );
            error("I0586", span, text).with_help("the moves before and after it must be longer")
        }
        Unfit::Parallel(distance, point) => {
            let distance = crate::codes::spelling::short(distance);
            let text = format!("there is no room for a distance of {distance} at {}", at(point));
            error("I0587", span, text)
                .with_help("leave less material, or make the groove there wider")
        }
    }
}

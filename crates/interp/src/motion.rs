//! Straight moves: G0, G1, with G53, G90 or G91, and what F means for them.
//!
//! In G17 the place of X and Y can be taken by a distance from the origin (`@`) and an angle (`^`,
//! degrees): with G90 the one that is missing stays, with G91 both are added to those of the place
//! where the move begins.
use crate::{
    call::{Call, Sink},
    codes::{self, POLAR},
    compensation,
    executor::Settings,
    fault::{Outcome, error, refuse},
    frame::Point,
    modes::{FeedMode, Modes, Motion},
    offsets,
    out::Out,
    words::Words,
};
use canon::Plane;
use core::fmt::Display;

/// Where the block's axis words lead.
#[inline]
pub(crate) fn destination(
    words: &Words,
    modes: &Modes,
    machine_coordinates: bool,
) -> Outcome<Point> {
    if machine_coordinates {
        if words.any(POLAR) {
            return refuse("I0430", words.place.span, "@ and ^ cannot be used with G53");
        }
        if modes.incremental {
            let fault = error(
                "I0406",
                words.place.span,
                "G53 takes machine coordinates, but G91 is in force",
            );
            return Err(fault.with_help("write G90 before it").into());
        }
        let machine = offsets::with_words(words, modes, modes.frame.to_machine(&modes.at));
        return Ok(modes.frame.to_program(&machine));
    }
    let mut to = modes.at;
    for (axis, slot) in to.iter_mut().enumerate() {
        if let Some(value) = offsets::axis_word(words, modes, axis) {
            *slot = if modes.incremental { *slot + value } else { value };
        }
    }
    if words.any(POLAR) {
        [to[0], to[1]] = polar(words, modes)?;
    }
    Ok(to)
}

/// X and Y by distance and angle.
pub(crate) fn polar(words: &Words, modes: &Modes) -> Outcome<[f64; 2]> {
    let span = words.place.span;
    if modes.plane != Plane::XY {
        return refuse("I0431", span, "@ and ^ stand for X and Y: they need G17");
    }
    if words.any(codes::set("XY")) {
        return refuse("I0432", span, "a point is given by X and Y or by @ and ^, not by both");
    }
    let [x, y] = [modes.at[0], modes.at[1]];
    let (radius, angle) = (x.hypot(y), y.atan2(x).to_degrees());
    let [distance, turn] = [b'@', b'^'].map(|letter| words.get(letter));
    if radius == 0.0 && (modes.incremental || turn.is_none()) {
        let fault = error("I0433", span, "the move begins at the origin, which has no angle");
        return Err(fault.with_help("write @ and ^ with G90").into());
    }
    let (radius, angle) = if modes.incremental {
        (radius + distance.unwrap_or(0.0), angle + turn.unwrap_or(0.0))
    } else {
        (distance.unwrap_or(radius), turn.unwrap_or(angle))
    };
    let (sin, cos) = angle.to_radians().sin_cos();
    Ok([radius * cos, radius * sin])
}

pub(crate) fn straight<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    motion: Motion,
    machine_coordinates: bool,
    out: &mut Out<'_, S>,
) -> Outcome {
    let to = destination(words, modes, machine_coordinates)?;
    if modes.compensating() {
        if motion == Motion::Feed {
            say_feed(words, modes, "G1", || distance(&modes.at, &to), out)?;
        }
        compensation::straight_beside(words, modes, settings, motion == Motion::Rapid, &to, out)?;
        modes.at = to;
        return Ok(());
    }
    if motion == Motion::Rapid {
        modes.at = to;
        out.say(&Call::Rapid(to));
        return Ok(());
    }
    say_feed(words, modes, "G1", || distance(&modes.at, &to), out)?;
    modes.at = to;
    out.say(&Call::Line(to));
    Ok(())
}

/// Check that there is a feed; with G93, say what it comes to on a path of this length.
pub(crate) fn say_feed<S: Sink>(
    words: &Words,
    modes: &Modes,
    code: impl Display,
    length: impl Fn() -> f64,
    out: &mut Out<'_, S>,
) -> Outcome {
    check_feed(words, modes, code)?;
    if modes.feed_mode == FeedMode::InverseTime
        && let Some(feed) = words.get(b'F')
    {
        // LinuxCNC never says less than 0.1.
        let rate = (feed * length()).max(0.1);
        out.say(&Call::FeedRate { rate, duration_s: Some(60.0 / feed) });
    }
    Ok(())
}

/// Check that there is a feed.
pub(crate) fn check_feed(words: &Words, modes: &Modes, code: impl Display) -> Outcome {
    let feed = modes.feed;
    match modes.feed_mode {
        FeedMode::InverseTime => {
            if words.get(b'F').is_some_and(|f| f > 0.0) {
                return Ok(());
            }
            let text =
                format!("{code} with G93 needs an F above 0 in its own block: moves per minute");
            refuse("I0407", words.place.span, text)
        }
        FeedMode::PerRevolution if feed > 0.0 && modes.spindle.speed == 0.0 => {
            let text =
                format!("{code} would never move: with G95 it follows the spindle, and S is 0");
            refuse("I0434", words.place.span, text)
        }
        _ if feed > 0.0 => Ok(()),
        mode => {
            let unit = if mode == FeedMode::PerMinute { "minute" } else { "revolution" };
            let text = format!("{code} has no feed: write F above 0, units per {unit}");
            let fault = error("I0408", words.place.span, text);
            let help = "G94 and G95 clear the feed, also when they were in force already: write F after them";
            Err(fault.with_help(help).into())
        }
    }
}

/// What F counts on a straight way: the path of X, Y, Z; of U, V, W if those stand still; else the degrees.
pub(crate) fn distance(from: &Point, to: &Point) -> f64 {
    let along =
        |first: usize| (first..first + 3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
    [0, 6, 3].into_iter().map(along).find(|d| *d > 0.0).unwrap_or(0.0)
}

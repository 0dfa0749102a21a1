//! Straight moves: G0, G1, with G53, G90 or G91, and what F means for them.
//!
//! In G17 the place of X and Y can be taken by a distance from the origin (`@`) and an angle (`^`,
//! degrees): with G90 the one that is missing stays, with G91 both are added to those of the place
//! where the move begins.
//!
//! ```text
//!   arcs            G2, G3
//!   splines         G5 to G5.3, as they are written
//!   spline_pieces   a spline as pieces of the fifth degree
//!   threads         G33, G33.1
//!   probe           G38
//! ```
pub(crate) mod arcs;
pub(crate) mod probe;
pub(crate) mod spline_pieces;
pub(crate) mod splines;
pub(crate) mod threads;

use crate::{
    call::{Call, Sink, out::Out},
    compensation::beside,
    coordinates::target,
    fault::{Outcome, error, refuse},
    geometry::frame::Point,
    modes::{FeedMode, Modes, Motion},
    state::executor::Settings,
    words::Words,
};
use core::fmt::Display;

#[inline]
pub(crate) fn straight<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    motion: Motion,
    machine_coordinates: bool,
    out: &mut Out<'_, S>,
) -> Outcome {
    let to = target::destination(words, modes, machine_coordinates)?;
    if modes.compensating() {
        if motion == Motion::Feed {
            say_feed(words, modes, "G1", || distance(&modes.at, &to), out)?;
        }
        beside::straight_beside(words, modes, settings, motion == Motion::Rapid, &to, out)?;
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
#[inline]
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
#[inline]
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
            let help = "write F here, or in a block before it and after G94 and G95, which clear it also where they were in force already; feed_mm_per_min under [control.programs] of the machine's file is for programs that leave it to the machine";
            Err(fault.with_help(help).into())
        }
    }
}

/// What F counts on a straight way: the path of X, Y, Z; of U, V, W if those stand still; else the
/// degrees.
pub(crate) fn distance(from: &Point, to: &Point) -> f64 {
    let along =
        |first: usize| (first..first + 3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
    [0, 6, 3].into_iter().map(along).find(|d| *d > 0.0).unwrap_or(0.0)
}

/// What F must be for a cycle.
pub(crate) fn check_cycle_feed(words: &Words, modes: &Modes, code: impl Display) -> Outcome {
    if modes.feed_mode == FeedMode::InverseTime {
        return refuse(
            "I0501",
            words.place.span,
            format!("G{code} needs G94 or G95: G93 is in force"),
        );
    }
    check_feed(words, modes, format_args!("G{code}"))
}

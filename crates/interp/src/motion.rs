//! Straight moves: G0, G1, with G53, G90 or G91, and what F means for them.
//!
//! In G17 the place of X and Y can be taken by a distance from the origin (`@`) and an angle (`^`,
//! degrees): with G90 the one that is missing stays, with G91 both are added to those of the place
//! where the move begins.
use crate::{
    call::{Call, Sink},
    codes::{self, POLAR},
    execute::Executor,
    fault::{Outcome, error, refuse},
    frame::Point,
    state::{FeedMode, Motion},
};
use canon::Plane;
use core::fmt::Display;

impl Executor {
    /// Where the block's axis words lead.
    #[inline]
    pub(crate) fn destination(&self, machine_coordinates: bool) -> Outcome<Point> {
        if machine_coordinates {
            if self.words.any(POLAR) {
                return refuse("I0430", self.words.place.span, "@ and ^ cannot be used with G53");
            }
            if self.state.incremental {
                let fault = error(
                    "I0406",
                    self.words.place.span,
                    "G53 takes machine coordinates, but G91 is in force",
                );
                return Err(fault.with_help("write G90 before it").into());
            }
            let machine = self.with_words(self.state.frame.to_machine(&self.state.at));
            return Ok(self.state.frame.to_program(&machine));
        }
        let mut to = self.state.at;
        for (axis, slot) in to.iter_mut().enumerate() {
            if let Some(value) = self.axis_word(axis) {
                *slot = if self.state.incremental { *slot + value } else { value };
            }
        }
        if self.words.any(POLAR) {
            [to[0], to[1]] = self.polar()?;
        }
        Ok(to)
    }

    /// X and Y by distance and angle.
    pub(crate) fn polar(&self) -> Outcome<[f64; 2]> {
        let span = self.words.place.span;
        if self.state.plane != Plane::XY {
            return refuse("I0431", span, "@ and ^ stand for X and Y: they need G17");
        }
        if self.words.any(codes::set("XY")) {
            return refuse("I0432", span, "a point is given by X and Y or by @ and ^, not by both");
        }
        let [x, y] = [self.state.at[0], self.state.at[1]];
        let (radius, angle) = (x.hypot(y), y.atan2(x).to_degrees());
        let [distance, turn] = [b'@', b'^'].map(|letter| self.words.get(letter));
        if radius == 0.0 && (self.state.incremental || turn.is_none()) {
            let fault = error("I0433", span, "the move begins at the origin, which has no angle");
            return Err(fault.with_help("write @ and ^ with G90").into());
        }
        let (radius, angle) = if self.state.incremental {
            (radius + distance.unwrap_or(0.0), angle + turn.unwrap_or(0.0))
        } else {
            (distance.unwrap_or(radius), turn.unwrap_or(angle))
        };
        let (sin, cos) = angle.to_radians().sin_cos();
        Ok([radius * cos, radius * sin])
    }

    pub(crate) fn straight<S: Sink>(
        &mut self,
        motion: Motion,
        machine_coordinates: bool,
        sink: &mut S,
    ) -> Outcome {
        let to = self.destination(machine_coordinates)?;
        if self.compensating {
            if motion == Motion::Feed {
                self.say_feed("G1", || distance(&self.state.at, &to), sink)?;
            }
            self.straight_beside(motion == Motion::Rapid, &to, sink)?;
            self.state.at = to;
            return Ok(());
        }
        if motion == Motion::Rapid {
            self.state.at = to;
            self.say(sink, &Call::Rapid(to));
            return Ok(());
        }
        self.say_feed("G1", || distance(&self.state.at, &to), sink)?;
        self.state.at = to;
        self.say(sink, &Call::Line(to));
        Ok(())
    }

    /// Check that there is a feed; with G93, say what it comes to on a path of this length.
    pub(crate) fn say_feed<S: Sink>(
        &self,
        code: impl Display,
        length: impl Fn() -> f64,
        sink: &mut S,
    ) -> Outcome {
        let feed = self.state.feed;
        match self.state.feed_mode {
            FeedMode::InverseTime => {
                let Some(feed) = self.words.get(b'F').filter(|f| *f > 0.0) else {
                    let text = format!(
                        "{code} with G93 needs an F above 0 in its own block: moves per minute"
                    );
                    return refuse("I0407", self.words.place.span, text);
                };
                // LinuxCNC never says less than 0.1.
                let rate = (feed * length()).max(0.1);
                self.say(sink, &Call::FeedRate { rate, duration_s: Some(60.0 / feed) });
                Ok(())
            }
            FeedMode::PerRevolution if feed > 0.0 && self.state.spindle.speed == 0.0 => {
                let text =
                    format!("{code} would never move: with G95 it follows the spindle, and S is 0");
                refuse("I0434", self.words.place.span, text)
            }
            _ if feed > 0.0 => Ok(()),
            mode => {
                let unit = if mode == FeedMode::PerMinute { "minute" } else { "revolution" };
                let text = format!("{code} has no feed: write F above 0, units per {unit}");
                let fault = error("I0408", self.words.place.span, text);
                let help = "G94 and G95 clear the feed, also when they were in force already: write F after them";
                Err(fault.with_help(help).into())
            }
        }
    }
}

/// What F counts on a straight way: the path of X, Y, Z; of U, V, W if those stand still; else the degrees.
pub(crate) fn distance(from: &Point, to: &Point) -> f64 {
    let along =
        |first: usize| (first..first + 3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
    [0, 6, 3].into_iter().map(along).find(|d| *d > 0.0).unwrap_or(0.0)
}

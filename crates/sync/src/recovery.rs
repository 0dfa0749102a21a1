//! Finding the way back onto a coupling after a stop, and which axis takes it.
//!
//! ```text
//!    z │ PS
//!      ●──╮ d = +1 inwards             PS, PE  start and end of what was coupled
//!      │   ╲                           Pb      where spindle and feed came to rest
//!      │    ╲    (1) the feed goes back       d·(uZ − uS) > 0: the feed overran
//!      │  Pc ●······○ Pb                      d·(uZ − uS) < 0: the spindle overran
//!      │      ╲     :
//!      │       ╲    : (2) the spindle goes back
//!      │        ╲ ··● Pc
//!      │    PE ●
//!      └────────────────────► θ        then both together along the coupling, back to PS
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | uS, uZ | progress of spindle and feed: 0 at PS, 1 at PE |
//! | d | sense of travel when the stop *began*: +1 inward, −1 outward; standing at the bottom counts as inward |
//! | Sb, Zb | where they came to rest; the angle is multi-turn |
//!
//! On a line uS = (Sb−SS)/(SE−SS) and uZ = (Zb−ZS)/(ZE−ZS), and
//!
//! - (1) Sc = Sb, Zc = ZS + uS·(ZE−ZS);
//! - (2) Zc = Zb, Sc = SS + uZ·(SE−SS).
//!
//! The axis that overran goes back, so that the way back retraces what the stop has already cut. On
//! a coupling that is no line, ZS + uS·(ZE−ZS) is g(Sb), and SS + uZ·(SE−SS) the angle near Sb at
//! which g is Zb: where there is none (beyond a cam's lift), the feed goes back whichever overran.
//!
//! A tap that is held stiffly is better unloaded first: the feed goes to where holder and flanks
//! press no more (|e| ≤ half the play), and only then is the axis chosen.
//!
//! After a loss of power a single-turn encoder knows θ modulo one turn only. z gives the turn, n =
//! round(g⁻¹(z) − φ), if the distance from the coupling is *shown* to be less than H/2; if it is
//! not, that is refused.
//!
//! Source: JPH0773810B2, figure 2 and claims 1–3; its formulas are lost in the text, the rule of
//! signs is deduced from the figure.
use core::fmt;
use units::{Angle, Lead, Length};

use crate::Coupling;

/// A point of the (θ, z) plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Point {
    /// Where the master is, unwrapped.
    pub angle: Angle,
    /// Where the follower is.
    pub place: Length,
}

/// The sense of travel when a stop began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Direction {
    /// From PS to PE; standing at PE too.
    Inward,
    /// From PE to PS.
    Outward,
}

impl Direction {
    /// +1 inward, −1 outward.
    pub const fn sign(self) -> f64 {
        match self {
            Self::Inward => 1.0,
            Self::Outward => -1.0,
        }
    }
}

/// Who moves to get back onto the coupling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mover {
    /// The follower, while the master stands: equation (1).
    Feed,
    /// The master, while the follower stands: equation (2).
    Spindle,
}

/// How far a stop got: 0 at the start, 1 at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// uS.
    pub spindle: f64,
    /// uZ; `None` where start and end are at the same height.
    pub feed: Option<f64>,
}

/// How a tap is held along its axis, as far as unloading needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Seat {
    /// Play between the tap's flanks and the thread, both sides together.
    pub play: Length,
    /// The holder is stiff enough for a distance from the coupling to press the tap hard.
    pub is_stiff: bool,
}

/// Which way back is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Way {
    /// The axis that overran goes back onto the coupling, at once.
    Direct,
    /// First the feed goes to zero axial force, if the holder is stiff; then the axis that overran
    /// goes back as far as is left.
    UnloadFirst(Seat),
    /// The follower alone, to PS: the tap is in no thread ([`crate::leaving`]).
    Straight,
}

/// The way back onto the coupling: at most two moves of one axis each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Where it begins.
    pub from: Point,
    /// Where no axial force is left; `from` where nothing is unloaded.
    pub unloaded: Point,
    /// Who moves from there; `None`: it is on the coupling.
    pub mover: Option<Mover>,
    /// Pc, on the coupling.
    pub to: Point,
}

/// What is stored of a coupled motion: where it began, where it was to end, and its sense at the
/// stop.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stored {
    coupling: Coupling,
    start: Angle,
    end: Angle,
    direction: Direction,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// A number is infinite or none at all.
    NotFinite,
    /// Start and end are the same angle: no line leads through them.
    NoTravel,
    /// The line has no lead: z says nothing about the turn.
    Level,
    /// The distance from the coupling may be half a lead or more, so several turns would fit.
    SeveralTurns {
        /// What is known about the distance: it is at most this.
        bound: Length,
        /// It has to be less than this.
        limit: Length,
    },
    /// The follower is further off than a whole tap can be.
    BeyondTap {
        /// How far it is.
        error: Length,
        /// At this its core tears.
        bears: Length,
    },
    /// No turn brings the readings within the bound: they contradict what was stored.
    NoTurn {
        /// The least distance that any turn gives.
        distance: Length,
        /// What it should not exceed.
        bound: Length,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => f.write_str("a stored or measured value is not a number"),
            Self::NoTravel => f.write_str(
                "start and end are the same spindle angle: there is no line through them",
            ),
            Self::Level => f.write_str(
                "the coupling has no lead, so the axis says nothing about the spindle's turn",
            ),
            Self::SeveralTurns { bound, limit } => write!(
                f,
                "the axis may be up to {:.3} mm from its coupling, but a single-turn encoder tells turns apart only below half a lead, {:.3} mm",
                bound.value(),
                limit.value(),
            ),
            Self::BeyondTap { error, bears } => write!(
                f,
                "the axis stands {:.3} mm off its thread, and a tap in this holder tears at {:.3} mm: it is broken, or the record is not of this tap",
                error.value(),
                bears.value(),
            ),
            Self::NoTurn { distance, bound } => write!(
                f,
                "no turn of the spindle fits: the nearest leaves the axis {:.3} mm from its coupling, and it cannot be further than {:.3} mm",
                distance.value(),
                bound.value(),
            ),
        }
    }
}

impl core::error::Error for Refusal {}

impl Stored {
    /// A line from PS to PE.
    ///
    /// # Errors
    /// The points do not make a line.
    pub fn line(start: Point, end: Point, direction: Direction) -> Result<Self, Refusal> {
        let turned = end.angle - start.angle;
        let travel = end.place - start.place;
        if !(turned.is_finite()
            && travel.is_finite()
            && start.angle.is_finite()
            && start.place.is_finite())
        {
            return Err(Refusal::NotFinite);
        }
        if turned == Angle::ZERO {
            return Err(Refusal::NoTravel);
        }
        let coupling = Coupling::line(travel / turned, start.angle, start.place);
        Ok(Self { coupling, start: start.angle, end: end.angle, direction })
    }

    /// Any coupling, between two angles of its master.
    pub const fn on(coupling: Coupling, start: Angle, end: Angle, direction: Direction) -> Self {
        Self { coupling, start, end, direction }
    }

    /// The coupling.
    pub const fn coupling(&self) -> &Coupling {
        &self.coupling
    }

    /// PS.
    pub fn start(&self) -> Point {
        self.point(self.start)
    }

    /// PE.
    pub fn end(&self) -> Point {
        self.point(self.end)
    }

    /// The sense when the stop began.
    pub const fn direction(&self) -> Direction {
        self.direction
    }

    /// Travel per turn, from PS to PE.
    pub fn lead(&self) -> Lead {
        (self.end().place - self.start().place) / (self.end - self.start)
    }

    /// uS and uZ of a point.
    pub fn progress(&self, at: Point) -> Progress {
        let spindle = (at.angle - self.start) / (self.end - self.start);
        let height = self.end().place - self.start().place;
        let feed = (height != Length::ZERO).then(|| (at.place - self.start().place) / height);
        Progress { spindle, feed }
    }

    /// Distance from the coupling along the follower.
    pub fn error(&self, at: Point) -> Length {
        self.coupling.error(at.angle, at.place)
    }

    /// The same as an angle: by how much the follower is ahead of the master.
    pub fn phase_difference(&self, at: Point) -> Angle {
        self.coupling.phase_difference(at.angle, at.place)
    }

    /// Who overran, by the rule of signs: d·(uZ − uS), where uZ − uS is the error over ZE − ZS.
    /// `None`: neither.
    pub fn overran(&self, at: Point) -> Option<Mover> {
        let inward = (self.end().place - self.start().place).value();
        // a coupling that ends at the height at which it began has no inward but its slope's
        let slope = self.coupling.slope(at.angle).value() * (self.end - self.start).value();
        let sense = if inward == 0.0 { slope } else { inward };
        let ahead = self.direction.sign() * self.error(at).value() * sense;
        if ahead > 0.0 {
            Some(Mover::Feed)
        } else if ahead < 0.0 {
            Some(Mover::Spindle)
        } else {
            None
        }
    }

    /// Pc: the point on the coupling, and the way to it.
    pub fn project(&self, at: Point, way: Way) -> Projection {
        let unloaded = match way {
            Way::Direct => at,
            Way::UnloadFirst(seat) => self.unloaded(at, seat),
            Way::Straight => {
                let to = Point { place: self.start().place, ..at };
                return Projection { from: at, unloaded: at, mover: Some(Mover::Feed), to };
            }
        };
        let Some(overran) = self.overran(unloaded) else {
            return Projection { from: at, unloaded, mover: None, to: unloaded };
        };
        let by_spindle = match overran {
            Mover::Spindle => self.angle_at(unloaded),
            Mover::Feed => None,
        };
        let (mover, to) = match by_spindle {
            Some(angle) => (Mover::Spindle, Point { angle, ..unloaded }),
            None => (Mover::Feed, self.point(unloaded.angle)),
        };
        Projection { from: at, unloaded, mover: Some(mover), to }
    }

    /// Where a stiffly held tap is pressed no more, reached by the feed alone: within half the play
    /// of the coupling. Deeper than PE and than where it stands nothing is unloaded: there the hole
    /// may end.
    fn unloaded(&self, at: Point, seat: Seat) -> Point {
        let error = self.error(at);
        let free = seat.play / 2.0;
        if !seat.is_stiff || error.abs() <= free {
            return at;
        }
        let left = if error < Length::ZERO { -free } else { free };
        let place = self.coupling.position(at.angle) + left;
        let deeper = |than: Length| (place - than).value() * self.inward() > 0.0;
        if deeper(self.end().place) && deeper(at.place) { at } else { Point { place, ..at } }
    }

    /// The angle near a point at which the coupling has the point's height, within one lead's turn
    /// of it if the coupling bends. Newton's steps; on a line the first is exact.
    fn angle_at(&self, at: Point) -> Option<Angle> {
        const STEPS: usize = 32;
        const NEAR_MM: f64 = 1e-12;
        let mut angle = at.angle;
        for _ in 0..STEPS {
            let slope = self.coupling.slope(angle);
            if slope == Lead::ZERO {
                return None;
            }
            let error = self.coupling.error(angle, at.place);
            angle += error / slope;
            if error.value().abs() <= NEAR_MM.max(1e-15 * at.place.value().abs()) {
                break;
            }
        }
        let left = self.coupling.error(angle, at.place).value().abs();
        (angle.is_finite() && left < 1e-9).then_some(angle)
    }

    /// +1 where inward is the follower's positive sense, else −1.
    pub(crate) fn inward(&self) -> f64 {
        (self.end().place - self.start().place).value().signum()
    }

    fn point(&self, angle: Angle) -> Point {
        Point { angle, place: self.coupling.position(angle) }
    }

    /// The unwrapped angle of a master whose encoder knows it within a turn only: φ + n with the
    /// turn n that lies nearest the coupling. `bound` is what the distance from the coupling is
    /// shown not to exceed, the encoders' own uncertainty included. `reading` may be any angle:
    /// only its part within a turn counts.
    ///
    /// # Errors
    /// The bound does not tell turns apart, or contradicts the readings.
    pub fn turn(&self, reading: Angle, place: Length, bound: Length) -> Result<Angle, Refusal> {
        if !(reading.is_finite() && place.is_finite() && bound.is_finite()) {
            return Err(Refusal::NotFinite);
        }
        let lead = self.lead();
        if lead == Lead::ZERO {
            return Err(Refusal::Level);
        }
        let limit = (lead * Angle::rev(0.5)).abs();
        if bound >= limit {
            return Err(Refusal::SeveralTurns { bound, limit });
        }
        // where the coupling would have the master; on a line exactly, else as a first guess
        let guess = self.start + (place - self.start().place) / lead;
        let middle = self.angle_at(Point { angle: guess, place }).unwrap_or(guess);
        let turns = (middle - reading).value();
        let angle = reading + Angle::rev(libm::round(turns));
        let distance = self.error(Point { angle, place }).abs();
        if distance > bound {
            return Err(Refusal::NoTurn { distance, bound });
        }
        Ok(angle)
    }
}

#[cfg(test)]
#[path = "recovery_tests.rs"]
mod tests;

//! How an axis is homed, and what stands at the ends of its travel.
//!
//! ```text
//!     hard stop      limit switch                            home switch   reference  limit switch  hard stop
//!        ▌               │                                        ┌────────────┼──────────│────────────▐
//!        ▌───────────────│────────────────────────────────────────┘            │          │            ▐
//!        ◄─ hard_stops ─►◄── travel_from          …          travel_to ──►     ◄─ beyond the travel ─►
//! ```
//!
//! A file that does not say how an axis is homed means what builders do most: a home switch at the
//! end of travel that is nearer to machine zero, the next index mark of the encoder behind it, the
//! approach speed to the switch and a tenth of it to the mark; vertical axes first, then the other
//! linear ones, then rotary ones.
use super::axis::{Approach, Axis, FARTHEST_MM, Friction, PositionFrom, Travel};
use super::setup::percent;
use crate::keys::Keys;
use canon::Axis as Letter;
use units::{Coordinate, CoordinateSpeed, Force};

/// Index mark and switch keep this share of the distance between marks from one another.
const APART: f64 = 0.05;
/// A turn of a rotary axis, °.
const TURN: f64 = 360.0;
/// What is assumed where nothing is said, mm or °: limit switches and hard stops beyond the travel.
const BEYOND: (f64, f64) = (3.0, 6.0);
/// Where nothing is said: the reference beyond the end of travel, and marks of a scale apart.
const REFERENCE: f64 = 1.0;
const SCALE_MARKS: f64 = 20.0;
/// Width of the cam on a rotary axis without an end, °.
const CAM: f64 = 10.0;

/// What tells where an axis is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingMethod {
    /// The encoder's next index mark behind the edge of the home switch.
    SwitchAndIndex,
    /// The edge of the home switch.
    Switch,
    /// The encoder's next index mark.
    Index,
    /// A mechanical stop, with little force.
    HardStop,
    /// The encoder knows.
    Absolute,
    /// The operator says where it is.
    Given,
}

impl HomingMethod {
    /// Their names in machine files.
    pub const NAMES: [(&str, Self); 6] = [
        ("switch-and-index", Self::SwitchAndIndex),
        ("switch", Self::Switch),
        ("index", Self::Index),
        ("hard-stop", Self::HardStop),
        ("absolute", Self::Absolute),
        ("given", Self::Given),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(_, method)| *method == self).map_or("", |(name, _)| name)
    }

    const fn moves(self) -> bool {
        !matches!(self, Self::Absolute | Self::Given)
    }
}

/// `[axes.x.homing]`, or of a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homing {
    /// What tells.
    pub method: HomingMethod,
    /// Axes of lower numbers are homed first, those of equal numbers together.
    pub order: u32,
    /// The reference is approached towards plus.
    pub positive: bool,
    /// The switch's edge is where it is let go of, and the mark the next one from there, back into
    /// the travel.
    pub off_switch: bool,
    /// Speed to the switch.
    pub fast: CoordinateSpeed,
    /// Speed to the switch's edge, the mark or the stop.
    pub slow: CoordinateSpeed,
    /// Position of the mark, the switch's edge or the stop.
    pub reference: Coordinate,
    /// Position of the switch's edge, where it is not the reference.
    pub switch: Coordinate,
    /// From one index mark to the next.
    pub index_every: Coordinate,
    /// How far the axis goes back from the reference.
    pub pull_off: Coordinate,
    /// Share of the drive's peak force against the stop.
    pub force_share: f64,
}

/// `[axes.x.ends]`: how far beyond the travel, at either end; `None`: the axis has no ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Limit switches are actuated.
    pub limit_switches: Coordinate,
    /// Hard stops hold the axis.
    pub hard_stops: Coordinate,
}

/// The keys of a linear and of a rotary axis.
struct Names {
    fast: &'static str,
    slow: &'static str,
    reference: &'static str,
    switch: &'static str,
    every: &'static str,
    pull_off: &'static str,
    limits: &'static str,
    stops: &'static str,
    unit: &'static str,
    force: &'static str,
}

const LINEAR: Names = Names {
    fast: "fast_mm_per_min",
    slow: "slow_mm_per_min",
    reference: "reference_mm",
    switch: "switch_mm",
    every: "index_every_mm",
    pull_off: "pull_off_mm",
    limits: "limit_switches_mm",
    stops: "hard_stops_mm",
    unit: "mm",
    force: "force_percent",
};

const ROTARY: Names = Names {
    fast: "fast_deg_per_min",
    slow: "slow_deg_per_min",
    reference: "reference_deg",
    switch: "switch_deg",
    every: "index_every_deg",
    pull_off: "pull_off_deg",
    limits: "limit_switches_deg",
    stops: "hard_stops_deg",
    unit: "°",
    force: "torque_percent",
};

const fn names(letter: Letter) -> &'static Names {
    match letter {
        Letter::A | Letter::B | Letter::C => &ROTARY,
        Letter::X | Letter::Y | Letter::Z | Letter::U | Letter::V | Letter::W => &LINEAR,
    }
}

/// A rotary axis that turns on and on has no ends.
fn is_endless(letter: Letter, travel: &Travel) -> bool {
    names(letter).unit == ROTARY.unit && (travel.to - travel.from).value() > TURN
}

impl Ends {
    /// Of `[axes.x]`.
    pub(super) fn read(letter: Letter, travel: &Travel, keys: &mut Keys<'_>) -> Option<Self> {
        let names = names(letter);
        let stated = keys.optional_section("ends", |keys| {
            let mut beyond = |key| Coordinate::new(keys.number(key, 0.0..=1000.0));
            let ends = Self {
                limit_switches: beyond(names.limits),
                hard_stops: beyond(names.stops),
            };
            if ends.hard_stops <= ends.limit_switches && keys.has(names.stops) {
                let (stops, limits, unit) =
                    (ends.hard_stops.value(), ends.limit_switches.value(), names.unit);
                let (key, other) = (names.stops, names.limits);
                keys.conflict(
                    names.stops,
                    format!("`{key}` {stops} is not beyond `{other}`: expected more than {limits} {unit}"),
                );
            }
            ends
        });
        let (limit_switches, hard_stops) = (Coordinate::new(BEYOND.0), Coordinate::new(BEYOND.1));
        let usual = (!is_endless(letter, travel)).then_some(Self { limit_switches, hard_stops });
        stated.or(usual)
    }
}

/// What homing has to do with: the rest of its axis.
pub(super) struct Of<'a> {
    pub(super) letter: Letter,
    pub(super) travel: &'a Travel,
    pub(super) approach: &'a Approach,
    pub(super) position_from: &'a PositionFrom,
    /// Travel a turn of the motor; `None`: a linear motor.
    pub(super) lead: Option<Coordinate>,
    pub(super) ends: Option<&'a Ends>,
    pub(super) peak: Force,
    /// What the drive has to hold.
    pub(super) weight: Force,
    pub(super) friction: &'a Friction,
}

impl Of<'_> {
    /// Marks of the encoder: once a turn of the motor, or of the table; a scale has its own.
    fn marks(&self) -> Option<Coordinate> {
        match self.position_from {
            PositionFrom::Motor { .. } => self.lead,
            PositionFrom::Scale { .. } if names(self.letter).unit == ROTARY.unit => {
                Some(Coordinate::new(TURN))
            }
            PositionFrom::Scale { .. } => None,
        }
    }
}

impl Homing {
    /// Before it is read.
    pub(super) const UNREAD: Self = Self {
        method: HomingMethod::Given,
        order: 1,
        positive: true,
        off_switch: false,
        fast: CoordinateSpeed::ZERO,
        slow: CoordinateSpeed::ZERO,
        reference: Coordinate::ZERO,
        switch: Coordinate::ZERO,
        index_every: Coordinate::ZERO,
        pull_off: Coordinate::ZERO,
        force_share: 1.0,
    };

    /// Of `[axes.x]`.
    pub(super) fn read(of: &Of<'_>, keys: &mut Keys<'_>) -> Self {
        let stated = keys.optional_section("homing", |keys| Self::stated(of, keys));
        stated.unwrap_or_else(|| Self::usual(of))
    }

    /// What is meant where nothing is said.
    fn usual(of: &Of<'_>) -> Self {
        let positive = of.travel.to.abs() <= of.travel.from.abs();
        let sense = if positive { 1.0 } else { -1.0 };
        let end = if positive { of.travel.to } else { of.travel.from };
        let endless = is_endless(of.letter, of.travel);
        let beyond = if endless { 0.0 } else { REFERENCE };
        let reference = Coordinate::new(if endless { 0.0 } else { end.value() } + sense * beyond);
        let index_every = of.marks().unwrap_or(Coordinate::new(SCALE_MARKS));
        Self {
            method: HomingMethod::SwitchAndIndex,
            order: match of.letter {
                Letter::Z | Letter::W => 1,
                Letter::X | Letter::Y | Letter::U | Letter::V => 2,
                Letter::A | Letter::B | Letter::C => 3,
            },
            positive,
            off_switch: false,
            fast: of.approach.speed,
            slow: of.approach.speed / 10.0,
            reference,
            switch: reference - index_every * (sense / 2.0),
            index_every,
            pull_off: Coordinate::new(beyond),
            force_share: 1.0,
        }
    }

    fn stated(of: &Of<'_>, keys: &mut Keys<'_>) -> Self {
        let (names, usual) = (names(of.letter), Self::usual(of));
        let method = keys.choice("method", &HomingMethod::NAMES);
        let order = keys.whole("order", 1..=9);
        let at = -FARTHEST_MM..=FARTHEST_MM;
        if !method.moves() {
            // the operator's word needs none
            let absolute = method == HomingMethod::Absolute;
            let reference = if absolute { keys.optional(names.reference, at) } else { None };
            let reference = Coordinate::new(reference.unwrap_or(0.0));
            return Self { method, order, reference, ..usual };
        }
        let positive = keys.choice("direction", &[("+", true), ("-", false)]);
        let off_switch = match method {
            HomingMethod::SwitchAndIndex | HomingMethod::Switch => {
                keys.optional_choice("edge", &[("onto", false), ("off", true)]).unwrap_or(false)
            }
            _ => false,
        };
        let mut speed = |key| CoordinateSpeed::per_min(keys.number(key, 0.1..=1e6));
        let (fast, slow) = match method {
            HomingMethod::SwitchAndIndex | HomingMethod::Switch => {
                (speed(names.fast), speed(names.slow))
            }
            _ => (speed(names.slow), speed(names.slow)),
        };
        let reference = Coordinate::new(keys.number(names.reference, at.clone()));
        let switch = match method {
            HomingMethod::SwitchAndIndex => Coordinate::new(keys.number(names.switch, at)),
            _ => reference,
        };
        let pull_off = Coordinate::new(keys.number(names.pull_off, 0.0..=1000.0));
        let force_share = match method {
            HomingMethod::HardStop => percent(keys, names.force, 0.1..=100.0),
            _ => 1.0,
        };
        let index_every = match method {
            HomingMethod::SwitchAndIndex | HomingMethod::Index => marks(of, keys),
            _ => usual.index_every,
        };
        let homing = Self {
            method,
            order,
            positive,
            off_switch,
            fast,
            slow,
            reference,
            switch,
            index_every,
            pull_off,
            force_share,
        };
        homing.refuse(of, keys);
        homing
    }

    const fn sense(&self) -> f64 {
        if self.positive { 1.0 } else { -1.0 }
    }

    /// What cannot be meant.
    fn refuse(&self, of: &Of<'_>, keys: &Keys<'_>) {
        let names = names(of.letter);
        let unit = names.unit;
        if self.slow > self.fast {
            let (key, other, most) = (names.slow, names.fast, self.fast.value() * 60.0);
            keys.conflict(key, format!("`{key}` is above `{other}`: expected {most:.0} at most"));
        }
        let (from, to) = (of.travel.from.value(), of.travel.to.value());
        let ends_at = self.reference - self.pull_off * self.sense();
        if keys.has(names.pull_off) && from < to && !of.travel.contains(ends_at) {
            let least = if self.positive {
                self.reference.value() - to
            } else {
                from - self.reference.value()
            };
            let (key, least) = (names.pull_off, least.max(0.0));
            let at = ends_at.value();
            keys.conflict(
                key,
                format!("after homing the axis stands at {at} {unit}, outside its travel of {from} to {to} {unit}: expected `{key}` of {least} at least, or another `{}`", names.reference),
            );
        }
        match self.method {
            HomingMethod::SwitchAndIndex => self.refuse_switch(names, keys),
            HomingMethod::Index if self.index_every.value() < to - from => {
                let every = self.index_every.value();
                keys.conflict("method", format!("an index mark every {every} {unit} on a travel of {} {unit} does not tell where the axis is: expected \"switch-and-index\"", to - from));
            }
            HomingMethod::HardStop => self.refuse_stop(of, names, keys),
            HomingMethod::Switch
            | HomingMethod::Index
            | HomingMethod::Absolute
            | HomingMethod::Given => {}
        }
        let switched = matches!(self.method, HomingMethod::Switch | HomingMethod::SwitchAndIndex);
        if let Some(ends) = of.ends.filter(|_| switched) {
            let room = (ends.hard_stops - ends.limit_switches).value();
            let (speed, accel) = (self.fast.value(), of.approach.acceleration.value());
            let braking = speed * speed / (2.0 * accel);
            if braking > room && keys.has(names.fast) {
                let (key, most) = (names.fast, (2.0 * accel * room).sqrt() * 60.0);
                keys.conflict(key, format!("from `{key}` the axis needs {braking:.1} {unit} to stop, and between limit switch and hard stop are {room:.1}: expected {most:.0} at most"));
            }
        }
    }

    fn refuse_switch(&self, names: &Names, keys: &Keys<'_>) {
        let every = self.index_every.value();
        // in the sense in which the axis goes from the edge to the mark
        let sense = if self.off_switch { -self.sense() } else { self.sense() };
        let apart = (self.reference - self.switch).value() * sense;
        let fine = apart >= APART * every && apart <= (1.0 - APART) * every;
        if !fine && keys.has(names.switch) && keys.has(names.reference) {
            let (key, other, unit) = (names.switch, names.reference, names.unit);
            let works = self.reference.value() - sense * every / 2.0;
            keys.conflict(key, format!("`{key}` is {apart} {unit} before `{other}`, and index marks are {every} {unit} apart: another mark would be found, expected {works}"));
        }
    }

    fn refuse_stop(&self, of: &Of<'_>, names: &Names, keys: &Keys<'_>) {
        /// The force holds the weight, and what friction may be at most, with as much to spare.
        const TO_SPARE: f64 = 2.0;
        let unit = names.unit;
        let Some(ends) = of.ends else {
            return keys.conflict(
                "method",
                "the axis turns on and on, it has no hard stop: expected \"switch-and-index\"",
            );
        };
        let stop = if self.positive {
            of.travel.to + ends.hard_stops
        } else {
            of.travel.from - ends.hard_stops
        };
        if keys.has(names.reference) && (stop - self.reference).abs() > Coordinate::new(1e-3) {
            let (key, stop) = (names.reference, stop.value());
            keys.conflict(
                key,
                format!("the hard stop stands at {stop} {unit}: expected `{key}` = {stop}"),
            );
        }
        let least = of.weight.value().abs() + TO_SPARE * of.friction.static_force.value();
        let share = least / of.peak.value();
        if keys.has(names.force) && self.force_share < share {
            let key = names.force;
            let works = (share * 100.0).ceil();
            keys.conflict(key, format!("`{key}` does not move the axis against its weight and friction: expected {works} at least"));
        }
    }

    /// Where the home switch is actuated, and after how far its cam comes again: from its edge to
    /// the end of travel and beyond.
    pub fn cam(
        &self,
        letter: Letter,
        travel: &Travel,
    ) -> (Coordinate, Coordinate, Option<Coordinate>) {
        if is_endless(letter, travel) {
            let end = self.switch + Coordinate::new(CAM * self.sense());
            return (self.switch.min(end), self.switch.max(end), Some(Coordinate::new(TURN)));
        }
        let far = Coordinate::new(FARTHEST_MM);
        if self.positive { (self.switch, far, None) } else { (-far, self.switch, None) }
    }

    /// Longest way to the switch or the stop, a little more than the whole of it.
    pub fn search(&self, letter: Letter, travel: &Travel, ends: Option<&Ends>) -> Coordinate {
        /// Over the whole way.
        const MORE: f64 = 1.02;
        if is_endless(letter, travel) {
            return Coordinate::new(TURN * MORE);
        }
        let stops = ends.map_or(Coordinate::ZERO, |ends| ends.hard_stops);
        (travel.to - travel.from + stops * 2.0) * MORE
    }
}

/// How far index marks are apart.
fn marks(of: &Of<'_>, keys: &mut Keys<'_>) -> Coordinate {
    let names = names(of.letter);
    let stated = keys.optional(names.every, 0.01..=FARTHEST_MM);
    match (of.marks(), stated) {
        (Some(own), None) => own,
        (None, Some(stated)) => Coordinate::new(stated),
        (Some(own), Some(stated)) => {
            if (own.value() - stated).abs() > 1e-9 {
                let (key, own) = (names.every, own.value());
                keys.conflict(key, format!("the encoder has an index mark a revolution: expected `{key}` = {own}, or none"));
            }
            own
        }
        (None, None) => {
            let key = names.every;
            keys.conflict("method", format!("homing by the index marks of a scale needs `{key}`"));
            Coordinate::new(SCALE_MARKS)
        }
    }
}

impl Axis {
    /// A rotary axis that turns on and on, without ends.
    pub fn is_endless(&self) -> bool {
        is_endless(self.letter, &self.travel)
    }
}

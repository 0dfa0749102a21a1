//! What stands along the travel of an axis: switches, hard stops, index marks; and where its
//! encoder counts from.
//!
//! ```text
//!   stop   limit switch                              home switch  limit switch   stop
//!    ▌        ┌───                                       ┌──────────┐  ───┐        ▐
//!    ▌────────┘                                          │          │     └────────▐
//!    └──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┴──┘  index marks
//! ```
//!
//! A hard stop is a stiff spring with a dashpot that only pushes: F = max(0, k·d + c·ḋ), c =
//! 2ζ·√(k·m), d how deep the table is in it. At ζ = 0.3 it gives 14 % of the energy back. Switches
//! and marks are seen once a period; a mark's position is latched by the encoder's counter, to a
//! count.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | k, ζ | stiffness of the stop, damping ratio of the table in it | N/m, 1 |
//! | d, m | depth, mass of the table | m, kg |
use crate::encoder::{index_between, quantise};
use crate::rng::Rng;
use units::{Coordinate, Stiffness};

/// ζ (estimate: a block of polyurethane or steel).
const DAMPING_RATIO: f64 = 0.3;
/// The stream of what is so when the machine is switched on.
const OF_POWER_ON: u64 = 0x504F_5745_525F_4F4E;
/// An axis without stops stands within this of its zero when it is switched on: half a turn, °.
const HALF_TURN: f64 = 180.0;

/// What stands along an axis, in machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// Where the table meets a hard stop at the negative and at the positive end, and how stiff
    /// these are.
    pub stops: Option<(Coordinate, Coordinate, Stiffness)>,
    /// From where on outwards the limit switches at the two ends are actuated.
    pub limit_switches: Option<(Coordinate, Coordinate)>,
    /// The home switch.
    pub home_switch: Option<HomeSwitch>,
    /// Index marks of the encoder that the position is read from.
    pub index: Option<IndexMarks>,
    /// The encoder knows its position when it is switched on.
    pub absolute: bool,
}

/// A cam that actuates a switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomeSwitch {
    /// Where it is actuated …
    pub from: Coordinate,
    /// … to.
    pub to: Coordinate,
    /// On a rotary axis the cam comes again after so far.
    pub every: Option<Coordinate>,
    /// It is let go of so much later than it is actuated.
    pub hysteresis: Coordinate,
}

/// Marks of an encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IndexMarks {
    /// Where one is.
    pub at: Coordinate,
    /// From one to the next.
    pub every: Coordinate,
}

/// What is so when a machine is switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerOn {
    /// Axes stand at their start, and their encoders read the position.
    Known,
    /// Axes stand somewhere between their stops, by the seed; encoders that are not absolute count
    /// from there.
    Unknown,
}

impl Travel {
    /// Nothing stands along it.
    pub const FREE: Self =
        Self { stops: None, limit_switches: None, home_switch: None, index: None, absolute: false };

    /// Where the axis stands when it is switched on, if that is not known.
    pub(crate) fn draw(&self, axis: usize, seed: u64) -> Coordinate {
        let mut rng = Rng::new(seed ^ OF_POWER_ON ^ (axis as u64) << 32);
        let (from, to) =
            self.stops.map_or((-HALF_TURN, HALF_TURN), |(from, to, _)| (from.value(), to.value()));
        Coordinate::new(from + (to - from) * rng.branch().unit())
    }

    /// Everything that no machine can have.
    pub(crate) fn problems(&self, of: &str, found: &mut Vec<String>) {
        let mut refuse = |holds: bool, needed: &str| {
            if !holds {
                found.push(format!("{of}: {needed}"));
            }
        };
        if let Some((from, to, stiffness)) = self.stops {
            refuse(from < to, "the hard stop at the negative end must stand below the other one");
            let fine = stiffness.value() > 0.0 && stiffness.value().is_finite();
            refuse(fine, "the stiffness of the hard stops must be a number above 0");
        }
        if let Some((from, to)) = self.limit_switches {
            refuse(
                from < to,
                "the limit switch at the negative end must stand below the other one",
            );
        }
        if let Some(cam) = self.home_switch {
            let hysteresis = cam.hysteresis.value();
            refuse(cam.from < cam.to, "the home switch must be actuated over a distance above 0");
            refuse(hysteresis >= 0.0, "the hysteresis of the home switch must be 0 or more");
            let length = (cam.to - cam.from + cam.hysteresis * 2.0).value();
            let apart = cam.every.is_none_or(|every| every.value() > length);
            refuse(apart, "the home switch must be let go of before its cam comes again");
        }
        if let Some(marks) = self.index {
            let fine = marks.every.value() > 0.0 && marks.at.is_finite();
            refuse(fine, "index marks must lie a distance above 0 apart");
        }
    }
}

impl HomeSwitch {
    /// Whether it is actuated at this place, mm, if it was before or not.
    fn next(&self, was: bool, at: f64) -> bool {
        let middle = (self.from + self.to).value() / 2.0;
        let half = (self.to - self.from).value() / 2.0;
        let away = match self.every {
            Some(every) => {
                let every = every.value();
                (at - middle) - ((at - middle) / every).round() * every
            }
            None => at - middle,
        };
        away.abs() <= half + if was { self.hysteresis.value() } else { 0.0 }
    }
}

/// What an axis' surroundings say of it: made ready, with their state.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    travel: Travel,
    /// Stops, m, and their spring and dashpot, N/m and N·s/m.
    stops: (f64, f64),
    spring: (f64, f64),
    /// What the encoder reads less than the position, mm: it counts from where it was switched on.
    zero: f64,
    home: bool,
    /// Where the encoder stood at the last period, mm, without its zero.
    seen: f64,
    index: Option<f64>,
}

impl Surroundings {
    /// Of an axis with this mass, kg, whose encoder stands at `seen`, mm, with this count;
    /// `unknown`: it counts from there, unless it is absolute.
    pub(crate) fn new(travel: &Travel, mass: f64, seen: f64, count: f64, unknown: bool) -> Self {
        let (stops, spring) = match travel.stops {
            Some((from, to, stiffness)) => {
                let k = stiffness.value() * 1e3;
                let ends = (from.value() * 1e-3, to.value() * 1e-3);
                (ends, (k, 2.0 * DAMPING_RATIO * (k * mass).sqrt()))
            }
            None => ((f64::NEG_INFINITY, f64::INFINITY), (0.0, 0.0)),
        };
        let counts_from_here = unknown && !travel.absolute;
        let zero = if counts_from_here { quantise(seen, count) } else { 0.0 };
        Self { travel: *travel, stops, spring, zero, home: false, seen, index: None }
    }

    /// Beyond one of the stops, m.
    #[inline]
    pub(crate) const fn is_beyond(&self, x: f64) -> bool {
        x < self.stops.0 || x > self.stops.1
    }

    /// The stop pushes back a table that is in it, m and m/s, N.
    pub(crate) fn push(&self, x: f64, v: f64) -> f64 {
        let (k, c) = self.spring;
        if x > self.stops.1 {
            -(k * (x - self.stops.1) + c * v).max(0.0)
        } else {
            (k * (self.stops.0 - x) - c * v).max(0.0)
        }
    }

    /// A period is over: the table stands at `table`, mm, the encoder at `seen`.
    pub(crate) fn observe(&mut self, table: f64, seen: f64, count: f64) {
        let Travel { home_switch, index, .. } = self.travel;
        self.home = home_switch.is_some_and(|cam| cam.next(self.home, table));
        self.index = index.and_then(|marks| {
            let (at, every) = (marks.at.value(), marks.every.value());
            let mark = index_between((self.seen - at) / every, (seen - at) / every)?;
            Some(quantise(at + mark * every, count))
        });
        self.seen = seen;
    }

    /// A reading as the encoder says it.
    pub(crate) fn reading(&self, position: Coordinate) -> Coordinate {
        position - Coordinate::new(self.zero)
    }

    /// What switches and marks say of an axis.
    pub(crate) fn fill(&self, table: f64, feedback: &mut bus::AxisFeedback) {
        feedback.home_switch = self.home;
        feedback.limit_switches = self
            .travel
            .limit_switches
            .map_or([false; 2], |(from, to)| [table <= from.value(), table >= to.value()]);
        feedback.index = self.index.map(|at| self.reading(Coordinate::new(at)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_switch_is_let_go_of_later_than_it_is_actuated() {
        let cam = HomeSwitch {
            from: Coordinate::new(-10.0),
            to: Coordinate::new(5.0),
            every: None,
            hysteresis: Coordinate::new(0.1),
        };
        assert!(!cam.next(false, -10.05) && cam.next(true, -10.05) && !cam.next(true, -10.11));
        assert!(cam.next(false, 4.99) && !cam.next(false, 5.05) && cam.next(true, 5.05));
    }

    #[test]
    fn the_cam_of_a_rotary_axis_comes_once_a_turn() {
        let cam = HomeSwitch {
            from: Coordinate::new(-5.0),
            to: Coordinate::new(5.0),
            every: Some(Coordinate::new(360.0)),
            hysteresis: Coordinate::ZERO,
        };
        for (at, on) in [(0.0, true), (180.0, false), (357.0, true), (-718.0, true), (366.0, false)]
        {
            assert_eq!(cam.next(false, at), on, "{at}°");
        }
    }
}

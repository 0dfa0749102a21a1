//! The check of a spindle's encoder: a slow turn before the spindle is used for the first time.
//!
//! ```text
//!   first order to turn ─► slow speed, in the ordered sense ─► ramp is over ─► two turns are measured ─► at rest ─► the order
//!                                                                                  │
//!                                  counts nothing, against the sense, by another scale, no index mark: alarm
//! ```
//!
//! It is made of spindles whose drive is told a speed: nothing but the encoder says there how they
//! turn, and a tap follows it. Without an index mark the scale is known as well as the drive keeps
//! its speed; with one, to a count. A drive that is told an angle keeps that, and the scale is
//! known to its window.
use crate::fault::FaultKind;
use crate::spindle::SpindleLoop;
use units::{Angle, Spin};

/// Beside the drive's own ramp it may take so long to come to the slow speed, s.
const SETTLES_S: f64 = 0.2;
/// Turns over which the speed is measured.
const TURNS: f64 = 2.0;
/// Turns within which two index marks must have come.
const INDEX_TURNS: f64 = 3.5;
/// Both halves of a measurement are as long within this share, or it still speeds up and is
/// measured again …
const STEADY: f64 = 0.05;
/// … so often.
const TRIES: u8 = 10;
/// A reading that has turned less than this share of what was ordered counts nothing.
const STILL: f64 = 0.02;
/// An encoder with two tracks counts a multiple of this a turn.
const QUADRATURE: f64 = 4.0;
/// Between two index marks a turn is counted within so many counts.
const INDEX_COUNTS: f64 = 4.0;

/// What is known of one spindle's encoder.
#[derive(Clone, Copy, Debug, Default)]
enum CheckStage {
    /// It is not checked.
    #[default]
    Off,
    /// It is to be checked before the spindle turns.
    Due,
    /// The slow turn is under way.
    Turning(Measurement),
    /// The check is passed, and the spindle comes to rest.
    Stopping,
    /// The check is passed.
    Passed,
}

/// A slow turn.
#[derive(Clone, Copy, Debug)]
struct Measurement {
    /// Its speed, rev/s, with its sense.
    spin: f64,
    /// Time since it was ordered, and when the measurement begins, s.
    at_s: f64,
    from_s: f64,
    /// The reading then, and in the middle.
    from: Option<Angle>,
    middle: Option<Angle>,
    tries: u8,
    /// The last index mark, and the way between two of them, rev.
    index: Option<Angle>,
    way: Option<f64>,
}

/// See the module's header.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EncoderCheck {
    state: CheckStage,
}

/// What is wrong, the counts a turn that were measured, and those of the configuration.
pub(crate) type EncoderFinding = (FaultKind, f64, f64);

impl EncoderCheck {
    pub(crate) const fn new(on: bool) -> Self {
        Self { state: if on { CheckStage::Due } else { CheckStage::Off } }
    }

    /// Nothing may be done with the spindle before it is over.
    pub(crate) const fn is_due(&self) -> bool {
        !matches!(self.state, CheckStage::Off | CheckStage::Passed)
    }

    /// The spindle turns for it.
    pub(crate) const fn is_under_way(&self) -> bool {
        matches!(self.state, CheckStage::Turning(_) | CheckStage::Stopping)
    }

    /// What stops the machine breaks it off: it is made anew.
    pub(crate) const fn break_off(&mut self) {
        if self.is_due() {
            self.state = CheckStage::Due;
        }
    }

    /// A period of it. `sense`: in which the spindle is about to turn. `index`: the mark that has
    /// passed.
    ///
    /// # Errors
    /// What is wrong with the encoder.
    pub(crate) fn advance(
        &mut self,
        spindle: &mut SpindleLoop,
        (sense, dt): (f64, f64),
        index: Option<Angle>,
    ) -> Result<(), EncoderFinding> {
        match &mut self.state {
            CheckStage::Off | CheckStage::Passed => {}
            CheckStage::Due if !spindle.at_rest() => spindle.stop(),
            CheckStage::Due => self.state = CheckStage::Turning(Measurement::new(spindle, sense)),
            CheckStage::Turning(measurement) => {
                spindle.slew_to(Spin::rev_per_s(measurement.spin));
                match measurement.advance(spindle, dt, index) {
                    None => {}
                    Some(found) => {
                        spindle.stop();
                        let is_good = found.is_ok();
                        self.state = if is_good { CheckStage::Stopping } else { CheckStage::Due };
                        return found;
                    }
                }
            }
            CheckStage::Stopping if spindle.at_rest() => self.state = CheckStage::Passed,
            CheckStage::Stopping => spindle.stop(),
        }
        Ok(())
    }
}

impl Measurement {
    fn new(spindle: &SpindleLoop, sense: f64) -> Self {
        let slow = spindle.control.orient.0.min(spindle.control.highest).value();
        let ramp = spindle.control.own_ramps.map_or_else(
            || slow / spindle.unplanned_accel(),
            |own| own.delay.value() + slow / own.decel.value() * (1.0 + own.uncertainty),
        );
        Self {
            spin: slow * sense.signum(),
            at_s: 0.0,
            from_s: ramp + SETTLES_S,
            from: None,
            middle: None,
            tries: 0,
            index: None,
            way: None,
        }
    }

    /// A period; what is found, once it is.
    fn advance(
        &mut self,
        spindle: &SpindleLoop,
        dt: f64,
        index: Option<Angle>,
    ) -> Option<Result<(), EncoderFinding>> {
        self.at_s += dt;
        if self.at_s < self.from_s {
            return None;
        }
        let reading = spindle.reading();
        if let Some(mark) = index {
            self.way = self.index.map(|before| (mark - before).value()).or(self.way);
            self.index = Some(mark);
        }
        let Some(from) = self.from else {
            (self.from, self.from_s) = (Some(reading), self.at_s);
            return None;
        };
        let ordered = self.spin * (self.at_s - self.from_s);
        if ordered.abs() >= TURNS / 2.0 {
            self.middle.get_or_insert(reading);
        }
        if ordered.abs() < TURNS {
            return None;
        }
        let middle = self.middle.unwrap_or(reading);
        let ratio = (reading - from).value() / ordered;
        let halves = [(middle - from).value(), (reading - middle).value()];
        let uneven = (halves[1] - halves[0]).abs() > STEADY * (reading - from).value().abs();
        if uneven && ratio.abs() > STILL && self.tries < TRIES {
            // the index mark that has come counts on
            (self.from_s, self.from, self.middle) = (self.at_s, None, None);
            self.tries += 1;
            return None;
        }
        let has_index = spindle.control.encoder_check.is_some_and(|check| check.index);
        if has_index && ratio.abs() > STILL && self.way.is_none() && ordered.abs() < INDEX_TURNS {
            return None;
        }
        Some(self.judge(spindle, ratio, has_index))
    }

    fn judge(
        &self,
        spindle: &SpindleLoop,
        ratio: f64,
        has_index: bool,
    ) -> Result<(), EncoderFinding> {
        let count = spindle.control.encoder_count.value();
        let stated = 1.0 / count;
        let windows = &spindle.control.windows;
        // one that keeps its angle is within its window at either end of the measurement
        let window = if spindle.control.closes_position {
            2.0 * windows.oriented.value() / TURNS
        } else {
            windows.at_speed
        };
        let counts = ratio * stated;
        if ratio.abs() <= STILL {
            return Err((FaultKind::EncoderStandsStill, counts, stated));
        }
        // between two marks there is one turn, however fast it was
        let exact = self.way.filter(|_| has_index);
        let would_fit = match exact {
            Some(way) => libm::round(way.abs().copysign(ratio) * stated),
            None => libm::round(counts / QUADRATURE) * QUADRATURE,
        };
        if ratio < 0.0 {
            return Err((FaultKind::EncoderReversed, would_fit, stated));
        }
        let is_off = match exact {
            Some(way) => (way.abs() - 1.0).abs() > INDEX_COUNTS * count,
            None => (ratio - 1.0).abs() > window,
        };
        if is_off {
            return Err((FaultKind::EncoderScale, would_fit, stated));
        }
        if has_index && exact.is_none() {
            return Err((FaultKind::SpindleIndexMissing, 0.0, 1.0));
        }
        Ok(())
    }
}

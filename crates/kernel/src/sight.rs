//! What a loop does while its encoder gives nothing that can be used.
//!
//! ```text
//!   Closed ──── no usable reading ──┬─ tied in a thread ─► Carried ── CARRIED_S ──┐
//!      ▲                            └─ everything else ──► Free ───── FREE_S ─────┤
//!      │                                  │                                       ▼
//!      └──────── it reads again ──────────┴───────────────────────────────────── Off
//! ```
//!
//! *Free*: the drive bears the weight that hangs on the axis, and nothing else; then its outputs go
//! off, and its brake and the drive's own stop take over. An axis or spindle that reads again
//! before that is taken over as it moves, and braked by its closed loop.
//!
//! *Carried*: feed and spindle of a thread that is being cut. Neither may stop alone, so the model
//! goes on ordering what the stop needs, and the thread guides what the model has wrong. Without a
//! reading the error grows as half of the model's error in acceleration, times the square of the
//! time: 0.2 µm in 5 ms and 100 µm in 100 ms of an axis of 300 kg whose friction is off by 6 N.
//!
//! *Off* is never left before the control is switched on again.

/// For so long a drive without feedback bears the weight on it, s.
pub(crate) const FREE_S: f64 = 0.01;
/// For so long the model orders the stop of feed and spindle in a thread, s.
pub(crate) const CARRIED_S: f64 = 1.0;

/// What a loop knows of where its axis or spindle is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Sight {
    /// Its encoder is read, and the loop is closed.
    #[default]
    Closed,
    /// No usable reading since a while, s: the model orders the stop.
    Carried(f64),
    /// No usable reading since a while, s: nothing is ordered but what bears the weight.
    Free(f64),
    /// Outputs off.
    Off,
}

/// What becomes of a loop that has lost its readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Without {
    /// The model orders the stop: it is tied in a thread.
    Model,
    /// Nothing is ordered.
    Nothing,
}

impl Sight {
    /// Readings are used.
    pub(crate) const fn is_closed(self) -> bool {
        matches!(self, Self::Closed)
    }

    /// Its outputs are off.
    pub(crate) const fn is_off(self) -> bool {
        matches!(self, Self::Off)
    }

    /// The readings are lost from now on.
    pub(crate) fn lose(&mut self, without: Without) {
        if *self == Self::Closed {
            *self = match without {
                Without::Model => Self::Carried(0.0),
                Without::Nothing => Self::Free(0.0),
            };
        }
    }

    /// The readings are usable again; false if its outputs are off already.
    pub(crate) fn regain(&mut self) -> bool {
        if self.is_off() {
            return false;
        }
        *self = Self::Closed;
        true
    }

    /// A period later.
    pub(crate) fn advance(&mut self, period_s: f64) {
        *self = match *self {
            Self::Carried(since) if since < CARRIED_S => Self::Carried(since + period_s),
            Self::Free(since) if since < FREE_S => Self::Free(since + period_s),
            Self::Carried(_) | Self::Free(_) | Self::Off => Self::Off,
            Self::Closed => Self::Closed,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Periods until its outputs are off.
    fn periods(without: Without) -> u32 {
        let mut sight = Sight::Closed;
        sight.lose(without);
        let mut periods = 0;
        while !sight.is_off() {
            sight.advance(250e-6);
            periods += 1;
        }
        periods
    }

    #[test]
    fn a_loop_without_readings_is_off_after_its_time() {
        assert!((40..=42).contains(&periods(Without::Nothing)));
        assert!((4000..=4002).contains(&periods(Without::Model)));
    }

    #[test]
    fn readings_that_come_back_close_the_loop_unless_it_is_off() {
        let mut sight = Sight::Free(0.001);
        assert!(sight.regain() && sight.is_closed());
        let mut off = Sight::Off;
        assert!(!off.regain() && off.is_off());
    }
}

//! The count of a spindle's encoder, which goes on where the encoder is set back at its index mark.
//!
//! ```text
//!   index-enable   ____/‾‾‾‾‾‾‾‾\____     set by the component, taken back by the encoder when it counts from the mark
//!   revs           4.81 4.90 4.98 0.06     the mark lies at 4.98 + 0.09 − 0.06 = 5.01: the way of a period before is made again
//! ```
use units::Angle;

/// What was read of an encoder, as one count.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Unwrapped {
    /// The encoder's zero in this count, rev.
    zero: f64,
    /// The last reading of the encoder, and the way of the period before it.
    reading: f64,
    way: f64,
    is_read: bool,
    /// The mark is looked for.
    looks: bool,
}

impl Unwrapped {
    /// A reading, with the pin that asks for the mark: the angle, and where the mark lies if it has
    /// passed.
    pub(crate) fn read(&mut self, revs: f64, is_set: bool) -> (Angle, Option<Angle>) {
        let passed = self.looks && !is_set && self.is_read;
        let mut mark = None;
        if passed {
            let expected = self.zero + self.reading + self.way;
            self.zero = expected - revs;
            (self.looks, mark) = (false, Some(Angle::rev(self.zero)));
        } else if self.is_read {
            self.way = revs - self.reading;
        }
        (self.reading, self.is_read) = (revs, true);
        (Angle::rev(self.zero + revs), mark)
    }

    /// Whether the mark is looked for from now on: what the pin shall be.
    pub(crate) const fn look(&mut self, on: bool) -> bool {
        self.looks = on;
        on
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An encoder that turns by `way` a period, and counts from its mark when it is asked to; marks
    /// that were found.
    fn marks(way: f64, counts: f64, periods: usize) -> Vec<f64> {
        let (mut turned, mut from, mut is_set) = (0.3, 0.0, false);
        let (mut unwrapped, mut found) = (Unwrapped::default(), Vec::new());
        for _ in 0..periods {
            let before: f64 = turned;
            turned += way;
            if is_set && (before.floor() < turned.floor() || before.ceil() > turned.ceil()) {
                (from, is_set) = (if way > 0.0 { turned.floor() } else { turned.ceil() }, false);
            }
            let revs = ((turned - from) * counts).floor() / counts;
            let (angle, mark) = unwrapped.read(revs, is_set);
            // each mark is known to a count or so
            let known = (4.0 + found.len() as f64) / counts;
            assert!((angle.value() - turned).abs() < known, "{angle} {turned}");
            found.extend(mark.map(Angle::value));
            is_set = unwrapped.look(true);
        }
        found
    }

    #[test]
    fn marks_are_a_turn_apart_and_the_count_goes_on() {
        for way in [0.0017, -0.0017, 0.013] {
            let found = marks(way, 4096.0, 3000);
            assert!(found.len() > 3, "{found:?}");
            for pair in found.windows(2) {
                assert!(((pair[1] - pair[0]).abs() - 1.0).abs() < 4.0 / 4096.0, "{found:?}");
            }
        }
    }

    #[test]
    fn nothing_is_found_where_nothing_is_asked_for() {
        let mut unwrapped = Unwrapped::default();
        for revs in [0.1, 0.2, 0.3] {
            assert_eq!(unwrapped.read(revs, false), (Angle::rev(revs), None));
        }
    }
}

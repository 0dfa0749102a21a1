//! The count of an encoder, of a spindle or of an axis, which goes on where the encoder is set back
//! at its index mark.
//!
//! ```text
//!   index-enable   ____/‾‾‾‾‾‾‾‾\____     set by the component, taken back by the encoder when it counts from the mark
//!   revs           4.81 4.90 4.98 0.06     the mark lies at 4.98 + 0.09 − 0.06 = 5.01: the way of a period before is made again
//!   revs           4.81 4.90 4.98 5.07     an encoder that counts on: the mark lies where it was read
//! ```

/// What was read of an encoder, as one count: revolutions, mm or degrees.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Unwrapped {
    /// The encoder's zero in this count.
    zero: f64,
    /// The last reading of the encoder, and the way of the period before it.
    reading: f64,
    way: f64,
    is_read: bool,
    /// The mark is looked for.
    looks: bool,
}

impl Unwrapped {
    /// A reading, with the pin that asks for the mark: the count, and where the mark lies if it has
    /// passed.
    pub(crate) fn read(&mut self, reading: f64, is_set: bool) -> (f64, Option<f64>) {
        let passed = self.looks && !is_set && self.is_read;
        let mut mark = None;
        if passed {
            let expected = self.reading + self.way;
            // one that is set back has come no further since than in the period before
            let is_near = reading.abs() <= 1.5 * self.way.abs();
            let counts_on = !is_near && (reading - expected).abs() < reading.abs();
            if !counts_on {
                self.zero += expected - reading;
            }
            mark = Some(if counts_on { self.zero + reading } else { self.zero });
            self.looks = false;
        } else if self.is_read {
            self.way = reading - self.reading;
        }
        (self.reading, self.is_read) = (reading, true);
        (self.zero + reading, mark)
    }

    /// What the encoder reads at this count.
    pub(crate) const fn reading_at(&self, count: f64) -> f64 {
        count - self.zero
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
            assert!((angle - turned).abs() < known, "{angle} {turned}");
            assert!((unwrapped.reading_at(angle) - revs).abs() < 1e-9);
            found.extend(mark);
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
            assert_eq!(unwrapped.read(revs, false), (revs, None));
        }
    }

    #[test]
    fn the_mark_of_an_encoder_that_counts_on_lies_where_it_was_read() {
        let mut unwrapped = Unwrapped::default();
        for reading in [4.81, 4.90, 4.98] {
            unwrapped.read(reading, true);
            unwrapped.look(true);
        }
        assert_eq!(unwrapped.read(5.07, false), (5.07, Some(5.07)));
        assert_eq!(unwrapped.read(5.16, false), (5.16, None));
    }
}

//! When the next frame goes out: a phase-locked loop from the reference clock to the master's own.
//!
//! ```text
//!   reference   │←── cycle ──→│  SYNC0 at whole cycles, the frame `lead` before
//!   error       phase of the frame at the reference − (cycle − lead), from −cycle/2 to cycle/2
//!   next        last + cycle − error/8 − trim        trim += error/64
//! ```
//!
//! The reference clock is never moved: the bus is the master of time.

/// Phase-locked loop on the reference clock.
#[derive(Clone, Debug)]
pub struct Pacer {
    cycle_ns: i64,
    lead_ns: i64,
    /// 1/64 ns per cycle.
    trim: i64,
    next_ns: u64,
}

impl Pacer {
    /// Starts at a time of the master's clock.
    pub fn new(cycle_ns: u32, lead_ns: u32, start_ns: u64) -> Self {
        Self {
            cycle_ns: i64::from(cycle_ns),
            lead_ns: i64::from(lead_ns),
            trim: 0,
            next_ns: start_ns,
        }
    }

    /// When the next frame goes out, by the master's clock.
    pub fn next_ns(&self) -> u64 {
        self.next_ns
    }

    /// Takes note of what the reference clock said as the frame passed it: returns the phase error,
    /// ns; positive if the frame was late.
    pub fn answered(&mut self, reference_ns: u64) -> i64 {
        let phase = (reference_ns % self.cycle_ns.unsigned_abs()).cast_signed();
        let mut error = phase - (self.cycle_ns - self.lead_ns);
        if error > self.cycle_ns / 2 {
            error -= self.cycle_ns;
        } else if error < -self.cycle_ns / 2 {
            error += self.cycle_ns;
        }
        // the crystals differ by 200 ppm at most
        let most = self.cycle_ns * 64 / 5_000;
        self.trim = (self.trim + error).clamp(-most, most);
        self.step(error / 8);
        error
    }

    /// Goes on without an answer.
    pub fn missed(&mut self) {
        self.step(0);
    }

    fn step(&mut self, correction: i64) {
        let ahead = self.cycle_ns - correction - self.trim / 64;
        self.next_ns = self.next_ns.saturating_add_signed(ahead.max(self.cycle_ns / 2));
    }

    /// Leaves out what is past.
    pub fn catch_up(&mut self, now_ns: u64) {
        while self.next_ns < now_ns {
            self.next_ns += self.cycle_ns.unsigned_abs();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest phase error of the second half of two seconds, ns.
    fn worst_error(drift_ppm: i64, offset_ns: u64, lost_every: u64) -> i64 {
        let mut pacer = Pacer::new(1_000_000, 250_000, 5_000_000);
        let mut worst = 0;
        for cycle in 0..2_000 {
            let sent = pacer.next_ns();
            let reference =
                offset_ns + sent.saturating_add_signed(sent.cast_signed() / 1_000_000 * drift_ppm);
            if lost_every > 0 && cycle % lost_every == 0 {
                pacer.missed();
                continue;
            }
            let error = pacer.answered(reference);
            if cycle > 1_000 {
                worst = worst.max(error.abs());
            }
        }
        worst
    }

    #[test]
    fn the_frame_stays_where_it_is_meant_whatever_the_crystals_do() {
        for drift in [-100, -20, 0, 50, 100] {
            for offset in [0, 123_456_789, 499_999] {
                let worst = worst_error(drift, offset, 0);
                assert!(worst < 100, "{drift} ppm, {offset} ns: {worst} ns");
            }
        }
    }

    #[test]
    fn lost_answers_do_not_let_it_run_away() {
        let worst = worst_error(50, 77_000, 7);
        assert!(worst < 200, "{worst} ns");
    }
}

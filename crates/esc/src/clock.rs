//! The distributed clock of a device: a local time that runs too fast or too slow, and the system
//! time that a control loop makes of it.
//!
//! ```text
//!   local(t)  = start + t·(1 + drift + trim)          drift: the crystal, trim: the control loop
//!   system(t) = local(t) + offset                     offset: register 0920
//!   error     = received + delay − system             at each write of 0910 (FRMW from the reference)
//!   trim     += error/Δt · 1/64,  phase += error/8    the phase by Δt/10 at most, as the hardware does
//! ```

/// Largest trim of the control loop, parts per billion.
const MOST_TRIM_PPB: i64 = 200_000;
/// Parts per billion of the whole.
const BILLION: i64 = 1_000_000_000;

/// The clock of a device.
#[derive(Clone, Debug)]
pub(crate) struct LocalClock {
    drift_ppb: i64,
    trim_ppb: i64,
    /// Local time at `since_ns`.
    local_ns: u64,
    since_ns: u64,
    /// When the last comparison was.
    compared_ns: Option<u64>,
    /// Mean difference: positive if the reference is ahead.
    mean_error_ns: i64,
    /// When the next SYNC0 is due, by the system time; `None` if none comes.
    next_sync_ns: Option<u64>,
    /// A SYNC0 has come since it was started.
    has_synced: bool,
}

impl LocalClock {
    /// Makes a clock that says `start_ns` at time 0 and gains `drift_ppb` nanoseconds a second.
    pub(crate) fn new(start_ns: u64, drift_ppb: i64) -> Self {
        Self {
            drift_ppb,
            trim_ppb: 0,
            local_ns: start_ns,
            since_ns: 0,
            compared_ns: None,
            mean_error_ns: 0,
            next_sync_ns: None,
            has_synced: false,
        }
    }

    /// Local time.
    pub(crate) fn local(&self, now_ns: u64) -> u64 {
        let passed = i128::from(now_ns.saturating_sub(self.since_ns));
        let gained = passed * i128::from(self.drift_ppb + self.trim_ppb) / i128::from(BILLION);
        self.local_ns.wrapping_add((passed + gained) as u64)
    }

    /// Compares the system time with that of the reference clock, and trims.
    pub(crate) fn compare(&mut self, system_ns: u64, received_ns: u64, delay_ns: u32, now_ns: u64) {
        let expected = received_ns.wrapping_add(u64::from(delay_ns));
        let error = expected.wrapping_sub(system_ns).cast_signed();
        let passed = self.compared_ns.map_or(0, |before| now_ns.saturating_sub(before));
        let passed = i64::try_from(passed).unwrap_or(i64::MAX).clamp(1, BILLION);
        self.compared_ns = Some(now_ns);
        self.mean_error_ns = error;
        let local = self.local(now_ns);
        let most = passed / 10 + 1;
        let slew = (error / 8).clamp(-most, most);
        let rate = i128::from(error) * i128::from(BILLION) / i128::from(passed) / 64;
        let most = i128::from(MOST_TRIM_PPB);
        let trim = i128::from(self.trim_ppb) + rate.clamp(-most, most);
        self.trim_ppb = trim.clamp(-most, most) as i64;
        self.local_ns = local.wrapping_add_signed(slew);
        self.since_ns = now_ns;
    }

    /// Starts at 0, as a device does that is turned on.
    pub(crate) fn restart(&mut self, now_ns: u64) {
        *self = Self { since_ns: now_ns, ..Self::new(0, self.drift_ppb) };
    }

    /// Forgets what the control loop has learnt.
    pub(crate) fn reset_loop(&mut self, now_ns: u64) {
        self.local_ns = self.local(now_ns);
        self.since_ns = now_ns;
        self.trim_ppb = 0;
        self.mean_error_ns = 0;
        self.compared_ns = None;
    }

    /// Register 092C.
    pub(crate) fn difference(&self) -> u32 {
        let size =
            u32::try_from(self.mean_error_ns.unsigned_abs()).unwrap_or(u32::MAX) & 0x7FFF_FFFF;
        size | u32::from(self.mean_error_ns < 0) << 31
    }

    /// Starts SYNC0 at a system time. One that has passed never comes.
    pub(crate) fn start_sync(&mut self, start_ns: u64, system_ns: u64) {
        self.next_sync_ns = (start_ns > system_ns).then_some(start_ns);
        self.has_synced = false;
    }

    pub(crate) fn stop_sync(&mut self) {
        self.next_sync_ns = None;
    }

    /// SYNC0 is coming.
    pub(crate) fn is_synchronised(&self) -> bool {
        self.next_sync_ns.is_some()
    }

    /// SYNC0 has begun to come.
    pub(crate) fn has_synced(&self) -> bool {
        self.has_synced
    }

    /// Takes the next SYNC0 that is due: true if there was one.
    pub(crate) fn take_sync(&mut self, system_ns: u64, period_ns: u32) -> bool {
        match self.next_sync_ns {
            Some(next) if next <= system_ns && period_ns > 0 => {
                self.next_sync_ns = next.checked_add(u64::from(period_ns));
                self.has_synced = true;
                true
            }
            _ => false,
        }
    }

    /// Skips the pulses that came too early to be executed; returns their number.
    pub(crate) fn skip_syncs(&mut self, system_ns: u64, period_ns: u32, most: u64) -> u64 {
        let Some(next) = self.next_sync_ns else { return 0 };
        if period_ns == 0 || next > system_ns {
            return 0;
        }
        let due = (system_ns - next) / u64::from(period_ns);
        let skipped = due.saturating_sub(most);
        self.next_sync_ns = Some(next + skipped * u64::from(period_ns));
        skipped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_gains_100_ppm_is_100_microseconds_ahead_after_a_second() {
        let clock = LocalClock::new(5_000, 100_000);
        assert_eq!(clock.local(1_000_000_000), 1_000_000_000 + 5_000 + 100_000);
    }

    #[test]
    fn the_control_loop_takes_out_drift_and_offset() {
        for drift in [-100_000, -3, 0, 40, 100_000] {
            let (mut clock, offset) = (LocalClock::new(0, drift), 4_000);
            let mut worst = 0;
            for cycle in 1..5_000_u64 {
                let now = cycle * 1_000_000;
                let system = clock.local(now) + offset;
                if cycle > 2_000 {
                    worst = worst.max(system.abs_diff(now));
                }
                clock.compare(system, now - 700, 700, now);
            }
            assert!(worst <= 64, "drift {drift} ppb: {worst} ns away after two seconds");
        }
    }

    #[test]
    fn a_pulse_that_has_passed_never_comes() {
        let mut clock = LocalClock::new(0, 0);
        clock.start_sync(1_000, 2_000);
        assert!(!clock.take_sync(u64::MAX, 1_000));
        clock.start_sync(3_000, 2_000);
        assert!(!clock.take_sync(2_999, 1_000));
        assert!(clock.take_sync(3_000, 1_000) && !clock.take_sync(3_999, 1_000));
        assert_eq!(clock.skip_syncs(1_000_000_000, 1_000, 10), 999_986);
    }
}

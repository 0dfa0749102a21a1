//! Spindles that do not turn as they were ordered to, outside synchronised cuts: runaway and stall.
//!
//! ```text
//!   speed │   ordered ┌───────────┐            a reading above the band: runs away
//!         │ ┄┄┄┄┄┄┄┄┄┄│┄┄┄┄┄┄┄┄┄┄┄│┄┄╲┄┄┄      band: from where it turned to where it shall, closing behind it
//!         │      ╱────┘           └──╲╲──      a reading that has left the order it once had: stalls
//!         └─────────────────────────────► time
//! ```
//!
//! On the way to another speed a spindle may turn as fast as it did, or as it shall, and anything
//! slower; what it has come through is behind it. So one that speeds up while it should slow down
//! is seen. Beyond the band by its window for cuts ([`SpindleWindows`](crate::SpindleWindows)),
//! which is by how much a load may drive it, and by [`OVERSHOOT`] of its highest speed, it does not
//! obey. A spindle that has had its speed stalls when it is below it by more than that window.
//!
//! Where its angle is controlled, or a tap or a thread goes by it, the following error and the sync
//! error say more; only the highest speed is watched there. So it is of a drive that makes its own
//! ramps and obeys late: a reversal that is taken back within its delay goes on towards an order
//! that holds no more.
use crate::config::Subject;
use crate::drives::Finding;
use crate::fault::FaultKind;
use crate::spindle::SpindleLoop;
use bus::SPINDLES;

/// Share of the highest speed by which a speed loop may swing over, or a reading may be noisy at
/// rest.
const OVERSHOOT: f64 = 0.02;
/// A spindle that turns faster than its highest speed by this share is stopped in any case.
const HIGHEST_SHARE: f64 = 1.15;

/// How one spindle may turn, rev/s.
#[derive(Clone, Copy, Debug, Default)]
struct Band {
    low: f64,
    high: f64,
    /// The speed that it was ordered to have, and has had.
    had: Option<f64>,
}

/// All spindles.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SpindleMonitor {
    bands: [Band; SPINDLES],
}

impl SpindleMonitor {
    /// Whether a spindle obeys; `tied`: something goes by its angle. `stopping`: an alarm has
    /// stopped the machine.
    pub(crate) fn check(
        &mut self,
        index: usize,
        spindle: &SpindleLoop,
        (tied, stopping): (bool, bool),
    ) -> Result<(), Finding> {
        let band = &mut self.bands[index];
        let of = Subject::Spindle(index as u8);
        let ordered = spindle.ordered().spin.value();
        let turns = spindle.now().spin.value() - spindle.swing.0.rate;
        let (highest, windows) = (spindle.control.highest.value(), &spindle.control.windows);
        let most = HIGHEST_SHARE * highest.max(ordered.abs());
        if turns.abs() > most {
            return Err((FaultKind::SpindleRunsAway, of, turns, most));
        }
        let late = spindle.control.own_ramps.is_some() || !spindle.control.follows_orders;
        if tied || late || spindle.position_controlled() || !spindle.sight.is_closed() {
            *band = Band { low: ordered.min(turns), high: ordered.max(turns), had: None };
            return Ok(());
        }
        let window = |spin: f64| windows.in_cut * spin.abs() + OVERSHOOT * highest;
        (band.low, band.high) =
            (ordered.min(band.low.max(turns)), ordered.max(band.high.min(turns)));
        // slower than it shall is none of this: it stalls
        let (low, high) = (band.low.min(0.0), band.high.max(0.0));
        let bound = if turns > 0.0 { high + window(high) } else { low - window(low) };
        if turns.abs() > bound.abs() {
            return Err((FaultKind::SpindleRunsAway, of, turns, bound));
        }
        band.had = band.had.filter(|had| *had == ordered && !stopping);
        if let Some(to) = spindle.at_speed().filter(|to| to.value() == ordered && ordered != 0.0) {
            band.had = Some(to.value());
        }
        let short = |had: f64| (had - turns) * had.signum() > window(had);
        match band.had {
            Some(had) if short(had) => {
                let least = had - window(had) * had.signum();
                Err((FaultKind::SpindleStalls, of, turns, least))
            }
            Some(_) | None => Ok(()),
        }
    }
}

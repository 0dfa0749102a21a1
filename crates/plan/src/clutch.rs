//! How long a tap in a clutch holder must be given: the window of its dwell.
//!
//! ```text
//!   R ─┬── feed ──┐                           ┌── feed back ──► R
//!      │          │  dwell e      dwell e     │
//!   clr│          ├────────────┬──────────────┤          feed stands; the tap pulls itself in by D,
//!      ▼          │   ╲ s → D  │ s ╲           │          splines part, spindle is reversed, the pawl
//!   surface       │     ╲______│_____╲ s_exit  │          turns the tap back by what e leaves
//!                              reversal ordered
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | n, H | spindle speed, lead | rev/s, mm/rev |
//! | D, β | length of the splines, backlash of the pawl | mm, rev |
//! | clr | from the R plane to the work's surface | mm |
//! | `t_d` | D/(n·H): the splines have parted | s |
//! | `t_r` | what a reversal costs: turned back after e is n·(e − `t_r`) | s |
//! | a | how far a feed that starts or stops lags behind one that does so at once | mm |
//!
//! ```text
//!   slide left at the exit      s_exit = D − H·[n(e − t_r) − β] − a
//!   0 ≤ s_exit                  or the holder is driven against its home
//!   s_exit ≤ clr                or the rapid back pulls the tap through its thread
//!   e ≥ t_d                     or the spindle's coasting goes into the depth
//! ```
//!
//! With straight ramps `t_r` is 1.5 times the stopping time: as long to stop, and half as much
//! again to run up. Here it comes from the ramp that is really ordered, or from what was measured
//! of a spindle with a drive of its own.
//!
//! Source: JPS6020134B2 (cycle and holder); the window is deduced, the source does not have it.
use units::{Angle, Lead, Length, Spin, Time};

/// What decides the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClutchCycle {
    /// D.
    pub spline_length: Length,
    /// β.
    pub pawl_backlash: Angle,
    /// |H|.
    pub lead: Lead,
    /// n, without sign.
    pub spin: Spin,
    /// clr; not negative.
    pub clearance: Length,
    /// `t_r`.
    pub reversal: Time,
    /// a.
    pub feed_lag: Length,
}

/// The dwells that work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DwellWindow {
    /// The shortest.
    pub least: Time,
    /// The longest; below `least` if none works.
    pub most: Time,
}

impl ClutchCycle {
    /// The equations of the module's header, solved for e.
    pub fn window(&self) -> DwellWindow {
        let feed = self.lead.abs() * self.spin;
        let parted: Time = self.spline_length / feed;
        let home = parted + self.reversal + self.pawl_backlash / self.spin - self.feed_lag / feed;
        DwellWindow { least: parted.max(home - self.clearance / feed), most: home }
    }

    /// Slide that is left when the tap comes out after this dwell.
    pub fn slide_left(&self, dwell: Time) -> Length {
        let back = self.spin * (dwell - self.reversal) - self.pawl_backlash;
        self.spline_length - self.lead.abs() * back - self.feed_lag
    }
}

impl DwellWindow {
    /// Whether a dwell works.
    pub fn holds(&self, dwell: Time) -> bool {
        dwell >= self.least && dwell <= self.most
    }

    /// The one that is farthest from both ends.
    pub fn middle(&self) -> Time {
        (self.least + self.most) * 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// D 5 mm, S3000, M6: `t_d` 0.1 s; stopping in 0.08 s along a straight ramp; a tenth of a turn
    /// of backlash.
    fn m6(clearance_mm: f64) -> ClutchCycle {
        ClutchCycle {
            spline_length: Length::mm(5.0),
            pawl_backlash: Angle::rev(0.1),
            lead: Lead::mm_per_rev(1.0),
            spin: Spin::rpm(3000.0),
            clearance: Length::mm(clearance_mm),
            reversal: Time::s(1.5 * 0.08),
            feed_lag: Length::ZERO,
        }
    }

    #[test]
    fn the_window_is_that_of_the_closed_form() {
        // t_d + 1.5·t_stop + β/n = 0.1 + 0.12 + 0.002; 60·clr/(S·H) = 0.04
        let window = m6(2.0).window();
        assert!((window.most.value() - 0.222).abs() < 1e-12, "{window:?}");
        assert!((window.least.value() - 0.182).abs() < 1e-12, "{window:?}");
    }

    #[test]
    fn with_much_clearance_the_splines_alone_say_the_least() {
        assert!((m6(50.0).window().least.value() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn at_the_ends_of_the_window_the_slide_is_the_clearance_and_nothing() {
        let (cycle, window) = (m6(2.0), m6(2.0).window());
        assert!((cycle.slide_left(window.least).value() - 2.0).abs() < 1e-9);
        assert!(cycle.slide_left(window.most).value().abs() < 1e-9);
        assert!(window.holds(window.middle()) && !window.holds(window.most + Time::s(1e-6)));
    }
}

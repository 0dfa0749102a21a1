//! Periods that a control in real time has missed, because its computer had something else to do.
//!
//! ```text
//!   feedback  ●     ●     ╎     ╎     ●        the drives went on with the last command; the control hears of it late
//!             k     k+1   k+2   k+3   k+4      and lives through k+2 and k+3 with readings in between, at once
//! ```
//!
//! So setpoints stay with the time, and no reading looks as if it had jumped. What the kernel would
//! have commanded in between is lost. A control that is late by more than the drives'
//! watchdog has been taken for dead before. Periods in which it was not late, and frames of the
//! machine were lost, it has lived through: they are not counted again.
use bus::Feedback;
use units::Time;

/// More are not lived through: the drives' watchdog has long acted.
const MOST: f64 = 4000.0;

/// The readings between two that were heard, one for each missed period.
pub(crate) fn missed<'a>(
    before: &'a Feedback,
    now: &'a Feedback,
    period: Time,
) -> impl Iterator<Item = Feedback> + use<'a> {
    let periods = ((now.time - before.time) / period).round().min(MOST);
    (1..).map(f64::from).take_while(move |at| *at < periods).map(move |at| {
        let share = at / periods;
        let mut between = *now;
        between.time = before.time + (now.time - before.time) * share;
        for ((axis, from), to) in between.axes.iter_mut().zip(&before.axes).zip(&now.axes) {
            axis.position = from.position + (to.position - from.position) * share;
        }
        for ((spindle, from), to) in
            between.spindles.iter_mut().zip(&before.spindles).zip(&now.spindles)
        {
            spindle.angle = from.angle + (to.angle - from.angle) * share;
            spindle.index = None;
        }
        between
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::Angle;
    use units::Coordinate;

    #[test]
    fn each_missed_period_has_a_reading_on_the_line_between_those_that_were_heard() {
        let period = Time::s(250e-6);
        let mut before = Feedback { time: Time::s(1.0), ..Feedback::default() };
        before.axes[2].position = Coordinate::new(-3.0);
        let mut now = Feedback { time: before.time + period * 4.0, ..before };
        now.axes[2].position = Coordinate::new(-5.0);
        now.spindles[0].angle = Angle::rev(0.4);
        let found: Vec<_> = missed(&before, &now, period).collect();
        let at = |f: &Feedback| (f.axes[2].position.value(), f.spindles[0].angle.value());
        let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() + (a.1 - b.1).abs() < 1e-12;
        assert_eq!(found.len(), 3);
        assert!(near(at(&found[0]), (-3.5, 0.1)) && near(at(&found[2]), (-4.5, 0.3)));
        let next = Feedback { time: before.time + period, ..before };
        assert_eq!(missed(&before, &next, period).count(), 0);
        assert_eq!(missed(&next, &before, period).count(), 0);
    }
}

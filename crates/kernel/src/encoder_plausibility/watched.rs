//! What is known of one encoder: its readings, or what they would be, and when they may be used.
//!
//! ```text
//!   sound ── a jump, none, stuck ─► lost: the model's steps are taken
//!     ▲                               │ steps that the drive can make, some in a row
//!     └── where the encoder says ─────┤
//!         or counted on from there ◄──┘ it has slipped
//! ```

/// Steps may differ by what the drive's most acceleration does in a period, times this: cut and
/// springs add to it.
const BEYOND_DRIVE: f64 = 3.0;
/// And by the encoder's noise, in counts.
const NOISE_COUNTS: f64 = 8.0;
/// A drive pushes for so many periods before a reading that stays is stuck.
const PUSHED: u32 = 40;
/// What goes on by no more counts than this while an encoder is looked at stands.
const STILL_COUNTS: f64 = 2.0;
/// So many steps in a row that the drive can make, and an encoder is read again.
pub(super) const GOOD_STEPS: u32 = 3;
/// An encoder that is lost for this many times stays so.
pub(super) const LOSSES: u8 = 4;
/// Share of the drive's most acceleration by which a model may be off for long.
const MODEL_SHARE: f64 = 0.25;

/// What is known of one encoder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    last: f64,
    /// `None`: only one reading is known.
    step: Option<f64>,
    /// How far the setpoint has gone since the reading last changed.
    unmoved: f64,
    /// Force of the drive when the reading last changed, and periods in which it has pushed since.
    force: f64,
    pushed: u32,
    /// Frames missed since the last reading.
    missed: f64,
    /// What is added to its readings: it has slipped.
    offset: f64,
    losses: u8,
    lost: Option<Lost>,
}

/// What is known while readings are not used.
#[derive(Clone, Copy, Debug)]
struct Lost {
    /// It has jumped, and was not missing.
    jumped: bool,
    /// Periods since then.
    periods: f64,
    /// The model's last step, once there is one.
    model: Option<f64>,
    /// The last reading, its step, and how many steps in a row could be.
    reading: f64,
    step: f64,
    good: u32,
    /// The reading at the first of them.
    from: f64,
    unmoved: f64,
    /// Its drive has pushed and it has not moved: where it is stuck, until it moves.
    stuck_at: Option<f64>,
}

/// What an encoder can show.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Way of the most acceleration in a period: a·h².
    pub(super) accel_way: f64,
    /// One count.
    pub(super) count: f64,
    /// Most way of the setpoint without a step.
    pub(super) stuck: f64,
    /// Following error, force of the drive beyond the weight, and how far that may grow without a
    /// step.
    pub(super) error: f64,
    pub(super) force: f64,
    pub(super) push: f64,
    /// Its drive has pushed by what moves it, and the reading stays.
    pub(super) is_stuck: bool,
    /// The reading is not new.
    pub(super) frame_lost: bool,
}

impl Bounds {
    /// Nothing is looked at.
    pub(super) const NONE: Self = Self {
        accel_way: f64::INFINITY,
        count: 0.0,
        stuck: f64::INFINITY,
        error: 0.0,
        force: 0.0,
        push: f64::INFINITY,
        is_stuck: false,
        frame_lost: false,
    };

    /// Most change of a step, after so many frames that were missed.
    fn jump(&self, missed: f64) -> f64 {
        let periods = missed + 1.0;
        BEYOND_DRIVE * self.accel_way * periods * periods + self.noise()
    }

    /// The drive pushes with more and more, towards a setpoint that the reading does not come to.
    fn winds_up(&self, before: f64) -> bool {
        let sense = self.error.signum();
        self.error.abs() > STILL_COUNTS * self.count
            && self.force * sense > self.push
            && (self.force - before) * sense > self.push
    }

    fn noise(&self) -> f64 {
        NOISE_COUNTS * self.count
    }

    /// By how much the model may be off after so many periods.
    fn of_model(&self, periods: f64) -> f64 {
        MODEL_SHARE * self.accel_way * periods * periods / 2.0 + self.noise()
    }
}

/// What has become of an encoder in a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// Nothing.
    None,
    /// Nothing, and its readings are used with an offset.
    Slipped,
    /// Its readings are not used from now on.
    Lost,
    /// Its readings are used again; the step that it makes in a period.
    Regained(f64),
}

impl Watched {
    pub(super) const fn new(reading: f64, step: f64) -> Self {
        Self { step: Some(step), ..Self::first(reading) }
    }

    /// Nothing is known of how it moves.
    pub(super) const fn first(reading: f64) -> Self {
        Self {
            last: reading,
            step: None,
            unmoved: 0.0,
            force: f64::NAN,
            pushed: 0,
            missed: 0.0,
            offset: 0.0,
            losses: 0,
            lost: None,
        }
    }

    /// It is read, and has not slipped.
    pub(super) const fn is_sound(&self) -> bool {
        self.lost.is_none() && self.offset == 0.0
    }

    /// The step that the model made last, while readings are not used.
    pub(super) fn model_step(&self) -> Option<f64> {
        self.lost.and_then(|lost| lost.model)
    }

    /// Its readings are missing from now on.
    pub(super) const fn lose(&mut self) {
        if self.lost.is_none() {
            self.lost = Some(Lost::new(f64::NAN, false, 0.0));
        }
    }

    /// What is to be taken for a reading; whether that has just changed.
    pub(super) fn judge(&mut self, reading: f64, expected: f64, bounds: Bounds) -> (f64, Change) {
        if bounds.frame_lost {
            // it is as old as the one before: as if it had gone on
            self.last += expected;
            self.missed += 1.0;
            if let Some(lost) = &mut self.lost {
                (lost.model, lost.periods, lost.good) = (Some(expected), lost.periods + 1.0, 0);
            }
            return (self.last, Change::None);
        }
        if self.lost.is_some() {
            return self.judge_lost(reading, expected, bounds);
        }
        let step = reading + self.offset - self.last;
        self.unmoved = if step == 0.0 { self.unmoved + expected.abs() } else { 0.0 };
        let jump = self.step.map_or(0.0, |before| step - before);
        if step != 0.0 || expected != 0.0 || self.force.is_nan() {
            (self.force, self.pushed) = (bounds.force, 0);
        } else {
            self.pushed = if bounds.winds_up(self.force) { self.pushed + 1 } else { 0 };
        }
        if self.pushed > PUSHED {
            self.unmoved = f64::INFINITY;
        }
        let is_stuck = self.unmoved > bounds.stuck || bounds.is_stuck;
        if jump.abs() <= bounds.jump(self.missed) && !is_stuck {
            // what the model had wrong meanwhile is no step
            let stepped = if self.missed > 0.0 { expected } else { step };
            (self.last, self.step, self.missed) = (self.last + step, Some(stepped), 0.0);
            let change = if self.offset == 0.0 { Change::None } else { Change::Slipped };
            return (self.last, change);
        }
        let mut lost = Lost::new(reading, step.is_finite() && !is_stuck, self.unmoved);
        lost.model = Some(expected);
        lost.stuck_at = bounds.is_stuck.then_some(reading);
        self.lost = Some(lost);
        self.losses = self.losses.saturating_add(1);
        self.last += expected;
        (self.last, Change::Lost)
    }

    /// The same while readings are not used.
    fn judge_lost(&mut self, reading: f64, expected: f64, bounds: Bounds) -> (f64, Change) {
        self.last += expected;
        let Some(lost) = &mut self.lost else { return (self.last, Change::None) };
        lost.go_on(reading, expected, bounds);
        if lost.good < GOOD_STEPS || self.losses >= LOSSES {
            return (self.last, Change::None);
        }
        let off = reading + self.offset - self.last;
        let may_be = if lost.jumped { bounds.noise() } else { bounds.of_model(lost.periods) };
        // what a count or two make is no motion
        let way = reading - lost.from;
        let step =
            if way.abs() <= STILL_COUNTS * bounds.count { 0.0 } else { way / f64::from(lost.good) };
        if off.abs() <= may_be {
            self.last += off;
        } else {
            self.offset -= off;
        }
        (self.step, self.unmoved, self.missed, self.lost) = (Some(step), 0.0, 0.0, None);
        (self.force, self.pushed) = (bounds.force, 0);
        (self.last, Change::Regained(step))
    }
}

impl Lost {
    const fn new(reading: f64, jumped: bool, unmoved: f64) -> Self {
        Self {
            jumped,
            periods: 1.0,
            model: None,
            reading,
            step: f64::NAN,
            good: 0,
            from: reading,
            unmoved,
            stuck_at: None,
        }
    }

    /// A period later.
    fn go_on(&mut self, reading: f64, expected: f64, bounds: Bounds) {
        let step = reading - self.reading;
        self.unmoved = if step == 0.0 { self.unmoved + expected.abs() } else { 0.0 };
        let moves = |at: f64| (reading - at).abs() > NOISE_COUNTS * bounds.count;
        self.stuck_at = self.stuck_at.filter(|at| !moves(*at));
        let is_stuck = self.unmoved > bounds.stuck || self.stuck_at.is_some();
        let can_be = (step - self.step).abs() <= bounds.jump(0.0) && !is_stuck;
        if can_be {
            self.good += 1;
        } else {
            (self.good, self.from) = (0, reading);
        }
        (self.reading, self.step) = (reading, step);
        (self.model, self.periods) = (Some(expected), self.periods + 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const BOUNDS: Bounds = Bounds { accel_way: 0.002, count: 1e-5, stuck: 0.005, ..Bounds::NONE };
    const STEP: f64 = 0.004;

    /// Readings of an axis that goes 4 µm a period, spoilt; what is taken, and in which periods its
    /// encoder was lost and regained. The first `missed` frames after the tenth are lost.
    fn taken(missed: usize, spoil: impl Fn(usize, f64) -> f64) -> (Vec<f64>, Vec<(usize, Change)>) {
        let mut watched = Watched::new(-STEP, STEP);
        let (mut all, mut changes) = (Vec::new(), Vec::new());
        for i in 0..30 {
            let bounds = Bounds { frame_lost: (10..10 + missed).contains(&i), ..BOUNDS };
            let (place, change) = watched.judge(spoil(i, i as f64 * STEP), STEP, bounds);
            all.push(place);
            if matches!(change, Change::Lost | Change::Regained(_)) {
                changes.push((i, change));
            }
        }
        (all, changes)
    }

    #[track_caller]
    fn goes_on(taken: &[f64]) {
        for (i, x) in taken.iter().enumerate() {
            assert!((x - i as f64 * STEP).abs() < 1e-3, "period {i}: {x}");
        }
    }

    fn at(changes: &[(usize, Change)]) -> Vec<usize> {
        changes.iter().map(|(i, _)| *i).collect()
    }

    #[test]
    fn a_reading_that_can_be_is_taken_as_it_is() {
        let swing = |i: usize, x: f64| x + 0.001 * (i as f64).sin();
        let (all, changes) = taken(0, swing);
        assert_eq!(changes, []);
        assert_eq!(all[7], swing(7, 7.0 * STEP));
    }

    #[test]
    fn an_encoder_that_slips_is_noticed_in_its_period_and_counted_on_from_where_the_model_is() {
        let (all, changes) = taken(0, |i, x| if i < 10 { x } else { x + 0.05 });
        assert_eq!(at(&changes), [10, 14]);
        goes_on(&all);
    }

    #[test]
    fn readings_that_were_no_numbers_are_read_again_when_they_are() {
        let (all, changes) =
            taken(0, |i, x| if (10..16).contains(&i) { f64::NAN } else { x + 1e-4 });
        assert_eq!(at(&changes), [10, 20]);
        goes_on(&all);
        assert_eq!(all[25], 25.0 * STEP + 1e-4); // where the encoder says, not where the model was
    }

    #[test]
    fn an_encoder_that_is_stuck_is_noticed_when_the_setpoint_has_gone_on_and_not_read_again() {
        let (all, changes) = taken(0, |_, x| x.min(0.036));
        assert_eq!(at(&changes), [11]);
        assert!((all[29] - 0.036 - 19.0 * STEP).abs() < 1e-9, "{}", all[29]);
    }

    #[test]
    fn an_encoder_that_fails_again_and_again_is_not_read_any_more() {
        let (_, changes) = taken(0, |i, x| if i % 6 == 0 { x + 0.05 } else { x });
        let lost = changes.iter().filter(|(_, change)| *change == Change::Lost).count();
        assert!(lost <= 4 && changes.len() < 2 * usize::from(LOSSES), "{changes:?}");
    }

    #[test]
    fn two_frames_that_were_missed_are_no_jump_though_the_model_was_off() {
        let (_, changes) = taken(2, |i, x| if i < 12 { x } else { x + 0.02 });
        assert_eq!(changes, []);
        let (_, changes) = taken(0, |i, x| if i < 12 { x } else { x + 0.02 });
        assert_eq!(at(&changes)[0], 12);
    }
    #[test]
    fn frames_that_were_lost_for_long_are_read_again_after_some_steps() {
        let mut watched = Watched::new(-STEP, STEP);
        let mut at = None;
        for i in 0..60 {
            let lost = (10..30).contains(&i);
            if i == 13 {
                watched.lose();
            }
            let bounds = Bounds { frame_lost: lost, ..BOUNDS };
            let (_, change) = watched.judge(f64::from(i) * STEP, STEP, bounds);
            if let Change::Regained(_) = change {
                at = Some(i);
            }
        }
        assert_eq!(at, Some(34));
    }

    #[test]
    fn an_encoder_that_stays_while_its_drive_pushes_is_stuck_though_the_setpoint_stands() {
        let mut watched = Watched::new(1.0, 0.0);
        let lost = (0..200).position(|i| {
            let force = f64::from(i) * 6.6;
            let bounds = Bounds { error: 0.006, force, push: 450.0, ..BOUNDS };
            watched.judge(1.0, 0.0, bounds).1 == Change::Lost
        });
        assert_eq!(lost, Some(109)); // 450 N, and ten milliseconds
    }
}

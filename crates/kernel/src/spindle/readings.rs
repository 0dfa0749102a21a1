//! A spindle's readings: taken for the first time, in each period, and again after they were lost.
use super::stuck::{Resting, Unanswered};
use super::{SpindleLoop, Task, rotation};
use crate::sight::Sight;
use bus::SpindleFeedback;
use sync::{Rotation, Swing};
use units::SpinAccel;

impl SpindleLoop {
    /// Take the reading as the present place: the drive has just come up, or is off.
    pub(crate) fn adopt(&mut self, feedback: &SpindleFeedback) {
        self.reading = feedback.angle.value();
        self.reading_before = self.reading;
        self.observers = self.observers.anew(&self.control, feedback.angle);
        let still = Rotation { angle: feedback.angle, ..Rotation::default() };
        (self.ordered, self.before, self.ahead) = (still, still, still);
        self.order = Task::Slew(0.0);
        self.release();
        self.pace = None;
        self.swing = (Swing::default(), Swing::default());
        (self.error, self.torque) = (0.0, 0.0);
        (self.unanswered, self.resting) = (Unanswered::NONE, Resting::NONE);
        (self.sight, self.regained) = (Sight::Closed, false);
        self.encoder_check.break_off();
        self.servo.reset();
    }

    /// Take a reading.
    pub(crate) fn read(&mut self, feedback: &SpindleFeedback) {
        self.reading_before = self.reading;
        self.reading = feedback.angle.value();
        self.saturated = feedback.saturated;
        let swung = SpinAccel::rev_per_s2(self.swing.0.accel);
        self.observers.read(feedback.angle, self.ordered.accel + swung);
        self.hear_drive(feedback);
    }

    /// Its readings are usable again; it turns at this speed, rev/s, and has come to this angle.
    pub(crate) fn regain(&mut self, angle: f64, spin: f64) {
        let was_free = matches!(self.sight, Sight::Free(_));
        if !self.sight.regain() {
            return;
        }
        self.regained = true;
        if was_free {
            self.ordered = rotation(angle - spin * self.period_s, spin, 0.0);
            (self.before, self.ahead) = (self.ordered, self.ordered);
            self.servo.reset();
        }
    }
}

//! What the closed loops make of an oscillation: from what is ordered to where the tool side, or
//! the tool spindle, is.
//!
//! ```text
//!   xc ──► lead by the believed stretch ──►(−)─ C'·(Kp + s) ─►(+)─► L ─► motor ──► screw, play, guide ──► xt
//!    │                                      ▲ xm               ▲          │
//!    │                                      └──────────────────┼──────────┘
//!    └──► forces that the motion will take, d + τ + h/2 ahead ──┘
//!
//!   L  = e^{−s·(d + h/2)}/(1 + τ·s)                      command's delay d, held for a period h, lag τ of the drive
//!   C' = C/(1 + C·(1 − L)/(M·s)),  C = M·2πfb·(1 + 2πfb/4s)       what is ordered already and on its way is not ordered again
//!   Z  = mm·s² + (mt·s² + N)·H,    H = K/(mt·s² + N + K)          of the motor with what hangs on its screw
//!
//!   G = H·(A·(M·s² + N) + L·C'·(φ·s + Kp)·(1 + S))/(Z + L·C'·(Kp + s))      S = (mt·s² + Nb)/Kb, the stretch as it is believed
//! ```
//!
//! K, N: of the screw behind its play, and of the guide ([`super::slide`]); with index b as the
//! control believes them. A: L with the force taken ahead; for a slide by what its jerk says of the
//! moment ahead, for a spindle by its table. A spindle is a motor alone: H = 1, Z = J·s².
//!
//! Source: the loop is the one that `kernel::servo` and `kernel::axis` describe; here it is linear
//! and continuous.
use super::slide::Slide;
use std::f64::consts::TAU;
use store::machine::{Axis, Control, Loops, Spindle};
use sync::Complex;

/// A drive and its loops: kg and s, or kg·m² and s.
#[derive(Clone, Copy, Debug)]
pub struct Servo {
    loops: Loops,
    /// M.
    inertia: f64,
    /// d + h/2, and τ.
    delay_s: f64,
    lag_s: f64,
    /// mm.
    motor: f64,
}

impl Servo {
    /// Of an axis.
    pub fn of_axis(axis: &Axis, control: &Control) -> Self {
        let motor = axis.drive.motor_mass().value();
        Self {
            loops: axis.loops,
            inertia: motor + axis.moving_mass.value(),
            motor,
            ..Self::delayed(control, axis.drive.force_lag.value(), axis.loops)
        }
    }

    /// Of a spindle.
    pub fn of_spindle(spindle: &Spindle, control: &Control) -> Self {
        let inertia = spindle.inertia.value();
        let lag_s = spindle.torque_lag.value();
        Self { inertia, motor: inertia, ..Self::delayed(control, lag_s, spindle.loops) }
    }

    fn delayed(control: &Control, lag_s: f64, loops: Loops) -> Self {
        let delay_s = control.period.value() * (f64::from(control.command_delay_periods) + 0.5);
        Self { loops, inertia: 0.0, delay_s, lag_s, motor: 0.0 }
    }

    /// L.
    fn drive(&self, s: Complex) -> Complex {
        Complex::polar(1.0, -s.im * self.delay_s / TAU) / (Complex::ONE + s * self.lag_s)
    }

    /// L·C'.
    fn speed_loop(&self, s: Complex) -> Complex {
        let (kv, drive) = (TAU * self.loops.velocity_bandwidth_hz, self.drive(s));
        let pi = (Complex::ONE + real(kv / 4.0) / s) * (kv * self.inertia);
        let on_its_way = pi * (Complex::ONE - drive) / (s * self.inertia);
        drive * pi / (Complex::ONE + on_its_way)
    }

    /// What comes of an order at a frequency in Hz, of a spindle.
    pub fn turning(&self, frequency: f64) -> Complex {
        let s = Complex { re: 0.0, im: TAU * frequency };
        let ahead = Complex::polar(1.0, frequency * (self.delay_s + self.lag_s));
        let known = self.drive(s) * ahead * (s * s) * self.inertia;
        let (ordered, measured, speed) = self.by_feedback(s);
        let forward = known * self.loops.acceleration_feed_forward_share;
        (forward + speed * ordered) / (s * s * self.inertia + speed * measured)
    }

    /// What comes of an order at a frequency in Hz at the tool side of a slide, which the control
    /// believes to be another one.
    pub fn sliding(&self, frequency: f64, slide: &Slide, believed: &Slide) -> Complex {
        let s = Complex { re: 0.0, im: TAU * frequency };
        let stretch = believed.stretch(frequency);
        let jerk_says = Complex::ONE + s * (self.delay_s + self.lag_s);
        let known = self.drive(s) * jerk_says * self.forces(s, believed, frequency);
        let (ordered, measured, speed) = self.by_feedback(s);
        let top = known + speed * ordered * (Complex::ONE + stretch);
        let hanging = slide.held(frequency) * slide.answer(frequency);
        let motor = s * s * self.motor + hanging;
        slide.answer(frequency) * top / (motor + speed * measured)
    }

    /// Share of a stretch by which the motor does not get ahead in time, at a frequency in Hz.
    pub fn lead_lost(&self, frequency: f64, slide: &Slide) -> Complex {
        let s = Complex { re: 0.0, im: TAU * frequency };
        let jerk_says = Complex::ONE + s * (self.delay_s + self.lag_s);
        let share = self.loops.friction_feed_forward_share;
        let known = self.drive(s) * jerk_says * (s * s) * (self.motor * share);
        let hanging = s * s * self.motor + slide.held(frequency) * slide.answer(frequency);
        (hanging - known) * self.gives(frequency, slide)
    }

    /// How far the motor gives way to a force of one at a frequency in Hz, m/N.
    pub fn gives(&self, frequency: f64, slide: &Slide) -> Complex {
        let s = Complex { re: 0.0, im: TAU * frequency };
        let (_, measured, speed) = self.by_feedback(s);
        let hanging = s * s * self.motor + slide.held(frequency) * slide.answer(frequency);
        Complex::ONE / (hanging + speed * measured)
    }

    /// The forces that the control knows a motion to take, of one unit.
    fn forces(&self, s: Complex, believed: &Slide, frequency: f64) -> Complex {
        let shares = &self.loops;
        let mass = s * s * (self.inertia * shares.acceleration_feed_forward_share);
        let guide = believed.guide(frequency);
        // the motor gets ahead of the tool side where friction changes
        let stretching = s * s * guide * (self.motor / believed.stiffness());
        mass + (guide + stretching) * shares.friction_feed_forward_share
    }

    /// φ·s + Kp, s + Kp, and the speed loop between error and force.
    fn by_feedback(&self, s: Complex) -> (Complex, Complex, Complex) {
        let gain = real(self.loops.position_gain_per_s);
        let ordered = s * self.loops.velocity_feed_forward_share + gain;
        (ordered, s + gain, self.speed_loop(s))
    }
}

const fn real(re: f64) -> Complex {
    Complex { re, im: 0.0 }
}

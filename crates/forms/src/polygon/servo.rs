//! What a position loop makes of an oscillation.
//!
//! ```text
//!   θc ─┬─ s ────────────────────┐
//!       └──►○── Kp ──►(+)──►○── C(s) ──►(+)── e^{−sT}/(1+τs) ──► 1/(J·s² + b·s) ──┬─► θ
//!           ▲−              ▲−           ▲ J·s²·θc                                │
//!           └───────────────┴── s·θ ◄────┴────────────────────────────────────────┘
//!
//!   θ/θc = L·(C·(Kp + s) + J·s²) / (J·s² + b·s + L·C·(Kp + s))      C = kv + ki/s, kv = J·2π·fb, ki = kv·2π·fb/4
//! ```
//!
//! The elasticity of a slide is not in it: an air cut measures what is left.
use std::f64::consts::{PI, TAU};

/// A loop with full feed-forward. All of it relates to an inertia of one: only ratios matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Kp, 1/s.
    pub position_gain: f64,
    /// fb, Hz.
    pub velocity_bandwidth: f64,
    /// b/J, 1/s.
    pub damping: f64,
    /// τ of the torque, s.
    pub torque_lag: f64,
    /// T, from reading to torque, less what the control compensates, s.
    pub delay: f64,
}

impl Loop {
    /// Real and imaginary part at a frequency in Hz.
    pub fn at(&self, frequency: f64) -> [f64; 2] {
        let s = [0.0, TAU * frequency];
        let kv = TAU * self.velocity_bandwidth;
        let ki = kv * TAU * self.velocity_bandwidth / 4.0;
        let pi = add([kv, 0.0], divide([ki, 0.0], s));
        let turn = -s[1] * self.delay;
        let lag = divide([turn.cos(), turn.sin()], [1.0, s[1] * self.torque_lag]);
        let ss = times(s, s);
        let drive = times(pi, add([self.position_gain, 0.0], s));
        let top = times(lag, add(drive, ss));
        let bottom = add(add(ss, times([self.damping, 0.0], s)), times(lag, drive));
        divide(top, bottom)
    }

    /// Gain and phase (degrees) at a frequency in Hz.
    pub fn gain_and_phase(&self, frequency: f64) -> [f64; 2] {
        let [re, im] = self.at(frequency);
        [re.hypot(im), im.atan2(re) * 180.0 / PI]
    }
}

fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn divide(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let size = b[0] * b[0] + b[1] * b[1];
    [(a[0] * b[0] + a[1] * b[1]) / size, (a[1] * b[0] - a[0] * b[1]) / size]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOOP: Loop = Loop {
        position_gain: 50.0,
        velocity_bandwidth: 120.0,
        damping: 0.0,
        torque_lag: 0.0,
        delay: 0.0,
    };

    #[test]
    fn with_feed_forward_and_no_lag_the_loop_is_exact() {
        let [gain, phase] = LOOP.gain_and_phase(50.0);
        assert!((gain - 1.0).abs() < 1e-12 && phase.abs() < 1e-9);
    }

    #[test]
    fn a_torque_that_lags_is_answered_by_the_loops_with_too_much() {
        // by hand at 50 Hz: (81 + 214j)/(81 + 189j)·10³
        let [gain, phase] = Loop { torque_lag: 0.8e-3, ..LOOP }.gain_and_phase(50.0);
        assert!((gain - 1.11).abs() < 0.01 && (phase - 2.45).abs() < 0.05, "{gain} {phase}");
    }
}

//! One servo loop: position P, speed PI, feed-forward. The same for an axis and for a spindle.
//!
//! ```text
//!            vref
//!   x̂c ─►(−)─►Kp─►(+)─►(−)─►[ kv + ki∫ ]─►(+)─► |limit| ─► u
//!         ▲        ▲    ▲                   ▲
//!         x       φ·vc  v              feed-forward
//!
//!   kv = J·2π·fb     ki = kv·2π·fb/4     ε = Kp·e + ė − (1 − φ)·vc,   e = xc − x
//! ```
//!
//! | symbol | meaning | unit of an axis | unit of a spindle |
//! |---|---|---|---|
//! | x, xc | position, its setpoint | mm | rev |
//! | v, vc | speed, its setpoint | mm/s | rev/s |
//! | e, ε | following error, speed error | mm, mm/s | rev, rev/s |
//! | φ | share of the speed feed-forward | — | — |
//! | J | effort per acceleration | N per mm/s² | N·m per rev/s² |
//! | u | effort | N | N·m |
//! | fb, h | bandwidth, period | Hz, s | Hz, s |
//!
//! The speed error is formed from the *difference of the following error*, not from that of the encoder:
//! what moves along with its setpoint then makes no quantisation ripple of its own speed, and a planned
//! motion is free of the differentiator's half period of lag. A pole at eight times the bandwidth
//! smooths what is left.
//!
//! With φ = 0 the loop settles, at constant speed, where ε = 0: e = vc/Kp, the classic lag. While the
//! output is at its limit the integral does not grow further into it (conditional anti-windup).
use core::f64::consts::TAU;

/// The smoothing pole lies so many times above the speed loop's bandwidth.
const SMOOTHING: f64 = 8.0;

/// What a loop is made from, in the units of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gains {
    pub(crate) position_gain: f64,
    pub(crate) bandwidth_hz: f64,
    pub(crate) inertia: f64,
    pub(crate) period_s: f64,
}

/// One loop's gains and state.
#[derive(Clone, Debug)]
pub(crate) struct Servo {
    kp: f64,
    kv: f64,
    ki_h: f64,
    smoothing: f64,
    rate: f64,
    integral: f64,
}

/// What the loop is given each period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Input {
    /// Following error e; zero while only the speed is controlled.
    pub(crate) error: f64,
    /// Its raw rate ė.
    pub(crate) error_rate: f64,
    /// (1 − φ)·vc.
    pub(crate) speed_withheld: f64,
    /// Effort that is known to be needed.
    pub(crate) feed_forward: f64,
    /// Most effort the drive can give.
    pub(crate) limit: f64,
}

impl Servo {
    pub(crate) fn new(gains: Gains) -> Self {
        let kv = gains.inertia * TAU * gains.bandwidth_hz;
        let ki = kv * TAU * gains.bandwidth_hz / 4.0;
        let pole = TAU * gains.bandwidth_hz * SMOOTHING * gains.period_s;
        Self {
            kp: gains.position_gain,
            kv,
            ki_h: ki * gains.period_s,
            smoothing: 1.0 - libm::exp(-pole),
            rate: 0.0,
            integral: 0.0,
        }
    }

    /// One period: the effort, within the limit.
    pub(crate) fn update(&mut self, input: Input) -> f64 {
        self.rate += self.smoothing * (input.error_rate - self.rate);
        let speed_error = self.kp * input.error + self.rate - input.speed_withheld;
        let integral = self.integral + self.ki_h * speed_error;
        let wanted = input.feed_forward + self.kv * speed_error + integral;
        let effort = wanted.clamp(-input.limit, input.limit);
        if effort == wanted || wanted * speed_error < 0.0 {
            self.integral = integral.clamp(-input.limit, input.limit);
        }
        effort
    }

    /// Forget what has been learnt: the drive was off.
    pub(crate) const fn reset(&mut self) {
        self.rate = 0.0;
        self.integral = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 250e-6;
    const GAINS: Gains =
        Gains { position_gain: 80.0, bandwidth_hz: 70.0, inertia: 1.2, period_s: H };

    /// Following error of a pure mass after `t` seconds of a ramp at `speed`, under a constant load.
    fn follow(share: f64, speed: f64, load: f64, t: f64) -> f64 {
        let mut servo = Servo::new(GAINS);
        let (mut x, mut v, mut before) = (0.0, 0.0, 0.0);
        for k in 0..(t / H) as u32 {
            let error = f64::from(k) * H * speed - x;
            let u = servo.update(Input {
                error,
                error_rate: (error - before) / H,
                speed_withheld: (1.0 - share) * speed,
                feed_forward: 0.0,
                limit: 1e6,
            });
            before = error;
            let a = (u - load) / GAINS.inertia;
            x += v * H + a * H * H / 2.0;
            v += a * H;
        }
        before
    }

    #[test]
    fn a_position_loop_alone_lags_by_speed_over_gain() {
        let lag = follow(0.0, 100.0, 0.0, 1.0);
        assert!((lag - 100.0 / 80.0).abs() < 1e-6, "{lag} mm");
    }

    #[test]
    fn with_speed_feed_forward_the_lag_vanishes() {
        assert!(follow(1.0, 100.0, 0.0, 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_constant_load_is_borne_by_the_integral() {
        assert!(follow(1.0, 0.0, 1000.0, 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_saturated_output_does_not_wind_up() {
        let mut servo = Servo::new(GAINS);
        for _ in 0..10_000 {
            let u = servo.update(Input {
                error: 10.0,
                error_rate: 0.0,
                speed_withheld: 0.0,
                feed_forward: 0.0,
                limit: 100.0,
            });
            assert_eq!(u, 100.0);
        }
        assert!(servo.integral.abs() <= 100.0);
        let back = Input {
            error: -1.0,
            error_rate: 0.0,
            speed_withheld: 0.0,
            feed_forward: 0.0,
            limit: 100.0,
        };
        assert_eq!(servo.update(back), -100.0, "it turns round at once");
    }
}

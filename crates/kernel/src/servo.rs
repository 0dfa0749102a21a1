//! One servo loop: position P, speed PI, feed-forward. The same for an axis and for a spindle.
//!
//! ```text
//!            vref
//!   xc ─►(−)─►Kp─►(+)─►(−)─►[ kv + ki∫ ]─►(+)─► |limit| ─► u ─► delay, lag ─► mass
//!         ▲        ▲    ▲                   ▲                │
//!         x       φ·vc  v ◄─ tracker ◄──────┼────────────────┘
//!                                      feed-forward
//!
//!   kv = J·2π·fb     ki = kv·2π·fb/4     ε = Kp·e + φ·vc − v − p,   e = xc − x
//! ```
//!
//! | symbol | meaning | unit of an axis | unit of a spindle |
//! |---|---|---|---|
//! | x, xc | position, its setpoint | mm | rev |
//! | v, vc | speed, its setpoint | mm/s | rev/s |
//! | e, ε | following error, speed error | mm, mm/s | rev, rev/s |
//! | p | speed that is ordered already and on its way | mm/s | rev/s |
//! | φ | share of the speed feed-forward | — | — |
//! | J | effort per acceleration | N per mm/s² | N·m per rev/s² |
//! | u | effort | N | N·m |
//! | fb, h | bandwidth, period | Hz, s | Hz, s |
//!
//! **The speed error** is not the difference of two readings, whose quantisation a good loop would
//! make into noise, but the estimate of a tracker ([`sync::Tracker`]) of the *following error*, of
//! which only the share φ of the setpoint's way is taken: without feed-forward it follows the
//! reading alone. It knows the feedback effort and the mass, so that it needs little from the
//! encoder: its bandwidth is the highest at which the encoder's counts leave a fiftieth of the
//! drive's effort as noise, and four times fb at most; behind a spring (a scale on the table) a
//! fraction of the resonance.
//!
//! **The speed on its way.** An effort u that was ordered but waits for the command's delay (h·Σu)
//! or the lag τ of the drive (τ·y, y what the drive gives at present) will still change the speed
//! by p = (h·Σu + τ·y)/J. Since d/dt(v + τ·y/J) = u/J exactly, subtracting p removes delay and lag
//! from the speed loop, which keeps the margin of a loop without them.
//!
//! With φ = 0 the loop settles, at constant speed, where ε = 0: e = vc/Kp, the classic lag. While
//! the output is at its limit the integral does not grow further into it (conditional anti-windup).
use core::f64::consts::TAU;
use sync::Tracker;

/// The tracker's bandwidth over the speed loop's, at most.
const TRACKER_RATIO: f64 = 8.0;
/// Share of the drive's peak effort that quantisation may cost as noise.
const NOISE_SHARE: f64 = 0.02;
/// Share of the servo rate above which a tracker is no filter any more.
const FASTEST_TRACKER: f64 = 0.2;
/// Longest command delay that is compensated, in periods.
pub(crate) const MAX_DELAY: usize = 16;

/// What a loop is made from, in the units of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gains {
    pub(crate) position_gain: f64,
    pub(crate) bandwidth_hz: f64,
    pub(crate) inertia: f64,
    pub(crate) period_s: f64,
    /// From reading to effect, and time constant of the drive.
    pub(crate) delay_s: f64,
    pub(crate) lag_s: f64,
    /// One count of the encoder.
    pub(crate) count: f64,
    /// Most effort of the drive.
    pub(crate) peak: f64,
    /// Where the encoder sits behind a spring: the highest bandwidth of the tracker.
    pub(crate) tracker_most_hz: f64,
}

/// One loop's gains and state.
#[derive(Clone, Debug)]
pub(crate) struct Servo {
    kp: f64,
    kv: f64,
    ki_h: f64,
    period_s: f64,
    tracker: Tracker,
    bandwidth_hz: f64,
    drive: Drive,
    /// The sum of φ·xc − x by its increments: it does not jump when the kind of control changes.
    way: f64,
    integral: f64,
}

/// What the loop is given each period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Input {
    /// Following error e; zero while only the speed is controlled.
    pub(crate) error: f64,
    /// Way of the setpoint since the last period, the share φ of it, less that of the reading.
    pub(crate) growth: f64,
    /// Effort that is known to be needed.
    pub(crate) feed_forward: f64,
    /// Least and most effort that the drive may give.
    pub(crate) limits: (f64, f64),
    /// The position loop is closed.
    pub(crate) position: bool,
}

impl Servo {
    pub(crate) fn new(gains: Gains) -> Self {
        let kv = gains.inertia * TAU * gains.bandwidth_hz;
        let ki = kv * TAU * gains.bandwidth_hz / 4.0;
        let h = gains.period_s;
        let quiet = Tracker::bandwidth_for(h, gains.count, NOISE_SHARE * gains.peak / kv);
        let bandwidth_hz = quiet
            .min(TRACKER_RATIO * gains.bandwidth_hz)
            .min(FASTEST_TRACKER / h)
            .min(gains.tracker_most_hz);
        Self {
            kp: gains.position_gain,
            kv,
            ki_h: ki * h,
            period_s: h,
            tracker: Tracker::new(h, bandwidth_hz, 0.0),
            bandwidth_hz,
            drive: Drive::new(&gains),
            way: 0.0,
            integral: 0.0,
        }
    }

    /// One period: the effort, within the limit.
    pub(crate) fn update(&mut self, input: Input) -> f64 {
        self.way += input.growth;
        self.tracker.read(self.way);
        self.drive.advance();
        let smooth = self.tracker.place() - self.way;
        let error = if input.position { self.kp * (input.error + smooth) } else { 0.0 };
        let on_its_way = self.drive.on_its_way(self.integral);
        let speed_error = error + self.tracker.rate() + on_its_way;
        let integral = self.integral + self.ki_h * speed_error;
        let wanted = input.feed_forward + self.kv * speed_error + integral;
        let (least, most) = input.limits;
        let effort = wanted.clamp(least, most);
        if effort == wanted || (wanted - effort) * speed_error < 0.0 {
            let limit = most.max(-least);
            self.integral = integral.clamp(-limit, limit);
        }
        // an effort beyond what the setpoint needs lessens the following error
        self.drive.order(input.feed_forward - effort);
        self.tracker.order(self.drive.acceleration());
        effort
    }

    /// One period without a reading: the integral goes on bearing the load while the setpoint
    /// moves.
    pub(crate) fn blind(&self, feed_forward: f64, limit: f64, moves: bool) -> f64 {
        let borne = if moves { self.integral } else { 0.0 };
        (feed_forward + borne).clamp(-limit, limit)
    }

    /// There are readings again: what the loop knew of the load is still so, and what has been
    /// ordered meanwhile is on its way.
    pub(crate) fn resume(&mut self) {
        self.way = self.tracker.place();
        self.drive.settle(-self.integral);
    }

    /// There are readings again, of something that moves by itself: `rate` is how fast the
    /// following error grows.
    pub(crate) fn take_over(&mut self, rate: f64) {
        self.reset();
        self.tracker = Tracker::moving(self.period_s, self.bandwidth_hz, rate);
    }

    /// Forget what has been learnt: the drive was off.
    pub(crate) fn reset(&mut self) {
        self.tracker = Tracker::new(self.period_s, self.bandwidth_hz, 0.0);
        self.drive.reset();
        self.way = 0.0;
        self.integral = 0.0;
    }
}

/// The loop's own efforts on their way to the mass: whole periods of delay, then a first-order lag.
#[derive(Clone, Debug)]
struct Drive {
    queue: [f64; MAX_DELAY + 1],
    delay: usize,
    /// e^(−h/τ), and the mean of such a decay over a period.
    decay: f64,
    mean_decay: f64,
    lag_s: f64,
    period_s: f64,
    per_inertia: f64,
    /// What arrives at the drive, and what it gives at the beginning of this period.
    arriving: f64,
    given: f64,
}

impl Drive {
    fn new(gains: &Gains) -> Self {
        let (h, lag_s) = (gains.period_s, gains.lag_s);
        let decay = if lag_s > 0.0 { libm::exp(-h / lag_s) } else { 0.0 };
        Self {
            queue: [0.0; MAX_DELAY + 1],
            delay: (libm::round(gains.delay_s / h) as usize).min(MAX_DELAY),
            decay,
            mean_decay: lag_s / h * (1.0 - decay),
            lag_s,
            period_s: h,
            per_inertia: 1.0 / gains.inertia,
            arriving: 0.0,
            given: 0.0,
        }
    }

    /// A period later.
    fn advance(&mut self) {
        self.given = self.arriving + (self.given - self.arriving) * self.decay;
    }

    /// Send an effort on its way.
    fn order(&mut self, effort: f64) {
        self.queue.copy_within(..self.delay, 1);
        self.queue[0] = effort;
        self.arriving = self.queue[self.delay];
    }

    /// Mean acceleration during the period that begins now.
    fn acceleration(&self) -> f64 {
        (self.arriving + (self.given - self.arriving) * self.mean_decay) * self.per_inertia
    }

    /// Speed that is ordered already but has not come about. What the integral orders bears a
    /// constant load and makes no speed.
    fn on_its_way(&self, integral: f64) -> f64 {
        let waiting: f64 = self.queue[..self.delay].iter().sum();
        let delay_s = self.delay as f64 * self.period_s;
        (waiting * self.period_s + self.given * self.lag_s + integral * (delay_s + self.lag_s))
            * self.per_inertia
    }

    const fn reset(&mut self) {
        self.settle(0.0);
    }

    /// As if this effort had been ordered for long.
    const fn settle(&mut self, effort: f64) {
        self.queue = [effort; MAX_DELAY + 1];
        self.arriving = effort;
        self.given = effort;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{vec, vec::Vec};

    const H: f64 = 250e-6;
    const GAINS: Gains = Gains {
        position_gain: 80.0,
        bandwidth_hz: 70.0,
        inertia: 1.2,
        period_s: H,
        delay_s: 0.0,
        lag_s: 0.0,
        count: 1e-6,
        peak: 20_000.0,
        tracker_most_hz: f64::INFINITY,
    };

    /// A pure mass behind a delay and a lag, seen through an encoder.
    struct Plant {
        gains: Gains,
        queue: std::collections::VecDeque<f64>,
        given: f64,
        x: f64,
        v: f64,
    }

    impl Plant {
        fn new(gains: Gains) -> Self {
            let delay = (gains.delay_s / H).round() as usize;
            Self { gains, queue: vec![0.0; delay].into(), given: 0.0, x: 0.0, v: 0.0 }
        }
        fn step(&mut self, effort: f64, load: f64) {
            self.queue.push_back(effort);
            let arriving = self.queue.pop_front().unwrap();
            for _ in 0..100 {
                let h = H / 100.0;
                if self.gains.lag_s > 0.0 {
                    self.given += (arriving - self.given) * h / self.gains.lag_s;
                } else {
                    self.given = arriving;
                }
                self.v += h * (self.given - load) / self.gains.inertia;
                self.x += h * self.v;
            }
        }
        fn read(&self) -> f64 {
            (self.x / self.gains.count).floor() * self.gains.count
        }
    }

    /// Following error and effort after each period of a ramp at `speed`, under a load from the
    /// start.
    fn follow(gains: Gains, share: f64, speed: f64, load: f64, periods: u32) -> Vec<(f64, f64)> {
        let (mut servo, mut plant) = (Servo::new(gains), Plant::new(gains));
        let mut before = 0.0;
        (0..periods)
            .map(|k| {
                let error = f64::from(k) * H * speed - plant.read();
                let input = Input {
                    error,
                    growth: error - before - (1.0 - share) * speed * H,
                    feed_forward: 0.0,
                    limits: (-1e6, 1e6),
                    position: true,
                };
                before = error;
                let effort = servo.update(input);
                plant.step(effort, load);
                (error, effort)
            })
            .collect()
    }

    fn last(run: &[(f64, f64)]) -> f64 {
        run[run.len() - 1].0
    }

    #[test]
    fn a_position_loop_alone_lags_by_speed_over_gain() {
        let lag = last(&follow(GAINS, 0.0, 100.0, 0.0, 4000));
        assert!((lag - 100.0 / 80.0).abs() < 1e-4, "{lag} mm");
    }

    #[test]
    fn with_speed_feed_forward_the_lag_vanishes() {
        assert!(last(&follow(GAINS, 1.0, 100.0, 0.0, 4000)).abs() < 1e-5);
    }

    #[test]
    fn a_constant_load_is_borne_by_the_integral() {
        for (delay_s, lag_s) in [(0.0, 0.0), (0.0, 0.8e-3), (2.0 * H, 0.8e-3)] {
            let error = last(&follow(Gains { delay_s, lag_s, ..GAINS }, 1.0, 0.0, 1000.0, 4000));
            assert!(error.abs() < 1e-5, "{error} mm with delay {delay_s} s, lag {lag_s} s");
        }
    }

    #[test]
    fn delay_and_lag_do_not_make_the_loop_ring() {
        // a spindle's loop: 120 Hz behind 0.8 ms of lag and a period of delay; a load step is
        // answered without changing its sign by more than a tenth of its peak
        let gains = Gains { bandwidth_hz: 120.0, delay_s: H, lag_s: 0.8e-3, ..GAINS };
        let run = follow(gains, 1.0, 0.0, 1000.0, 800);
        let peak = run.iter().map(|(e, _)| *e).fold(0.0, f64::max);
        let back = run.iter().map(|(e, _)| *e).fold(0.0, f64::min);
        assert!(peak > 0.0 && back > -0.1 * peak, "peak {peak} mm, back {back} mm");
    }

    #[test]
    fn a_coarse_encoder_costs_no_more_noise_than_a_fiftieth_of_the_drive() {
        let gains = Gains { count: 5e-3, ..GAINS };
        let run = follow(gains, 1.0, 31.7, 0.0, 8000);
        let settled = &run[4000..];
        let mean = settled.iter().map(|(_, u)| u).sum::<f64>() / settled.len() as f64;
        let square = settled.iter().map(|(_, u)| (u - mean).powi(2)).sum::<f64>();
        let noise = (square / settled.len() as f64).sqrt();
        assert!(noise < 1.5 * NOISE_SHARE * gains.peak, "{noise} N");
    }

    #[test]
    fn a_saturated_output_does_not_wind_up() {
        let mut servo = Servo::new(GAINS);
        let input = Input {
            error: 10.0,
            growth: 0.0,
            feed_forward: 0.0,
            limits: (-100.0, 100.0),
            position: true,
        };
        for _ in 0..10_000 {
            assert_eq!(servo.update(input), 100.0);
        }
        assert!(servo.integral.abs() <= 100.0);
        assert_eq!(servo.update(Input { error: -10.0, growth: -20.0, ..input }), -100.0);
    }

    /// Without feed-forward a setpoint's ripple far above the loops is not followed, however slow
    /// the tracker is.
    #[test]
    fn a_ripple_beyond_the_loops_is_not_followed_without_feed_forward() {
        let gains = Gains { tracker_most_hz: 60.0, ..GAINS };
        let (mut servo, mut plant) = (Servo::new(gains), Plant::new(gains));
        let (hz, amplitude) = (150.0, 1e-3);
        let (mut before, mut most) = (0.0, 0.0_f64);
        for k in 0..8000 {
            let xc = amplitude * (TAU * hz * f64::from(k) * H).sin();
            let read = plant.read();
            let place = -read; // φ = 0: nothing of the setpoint's way
            let input = Input {
                error: xc - read,
                growth: place - before,
                feed_forward: 0.0,
                limits: (-1e6, 1e6),
                position: true,
            };
            before = place;
            let effort = servo.update(input);
            plant.step(effort, 0.0);
            if k > 4000 {
                most = most.max(plant.x.abs());
            }
        }
        // C·K/(s² + C(s + K)) with C = ω + ω²/4s, ω = 2π·70, K = 80 at 150 Hz: 0.038
        assert!(most < 0.06 * amplitude, "{most} of {amplitude}");
    }
}

//! Learning on plants whose answer is known, quiet and disturbed.
use super::*;
use crate::{Pair, fold};
use core::f64::consts::TAU;
use units::Angle;

const NODES: usize = 180;

/// A machine: a lag of first order, a resonance, reversal friction, an uneven encoder and a noisy
/// sensor.
#[derive(Clone, Debug)]
struct Plant {
    lag_hz: f64,
    resonance_hz: f64,
    delay_s: f64,
    friction: f64,
    eccentricity: f64,
    noise: f64,
    seed: u64,
}

impl Plant {
    fn quiet() -> Self {
        Self {
            lag_hz: 19.0,
            resonance_hz: 90.0,
            delay_s: 4e-4,
            friction: 0.0,
            eccentricity: 0.0,
            noise: 0.0,
            seed: 7,
        }
    }

    fn random(&mut self) -> f64 {
        self.seed = self
            .seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.seed >> 11) as f64 / (1u64 << 53) as f64
    }

    fn answer(&self, hz: f64) -> Complex {
        let lag = Complex::ONE / Complex { re: 1.0, im: hz / self.lag_hz };
        let r = hz / self.resonance_hz;
        let mass = Complex::ONE / Complex { re: 1.0 - r * r, im: 1.2 * r };
        lag * mass * Complex::polar(1.0, -hz * self.delay_s)
    }

    /// What comes out at the nodes when a table is sent, as it is, and as the encoders say.
    fn turn(&mut self, table: &[f64], spin: Spin) -> (Vec<f64>, Vec<f64>) {
        let nodes = table.len();
        let sent = Spectrum::of(table, usize::MAX);
        let came = |(k, c): (usize, &Complex)| *c * self.answer(k as f64 * spin.value());
        let real = Spectrum { harmonics: sent.harmonics.iter().enumerate().map(came).collect() };
        let mut real = real.values(nodes);
        // friction pulls back against the direction of travel
        let before = real.clone();
        for i in 0..nodes {
            let speed = before[(i + 1) % nodes] - before[(i + nodes - 1) % nodes];
            real[i] -= self.friction * (speed / 0.01).tanh();
        }
        let seen = (0..nodes).map(|i| {
            // the reading is ahead of the angle, so at a reading the angle lags
            let place =
                i as f64 - self.eccentricity * nodes as f64 * (TAU * i as f64 / nodes as f64).sin();
            let whole = place.floor();
            let at = |k: f64| real[k.rem_euclid(nodes as f64) as usize];
            at(whole) + (place - whole) * (at(whole + 1.0) - at(whole))
        });
        let seen: Vec<f64> = seen.collect();
        let seen = seen
            .iter()
            .map(|x| x + self.noise * (self.random() + self.random() + self.random() - 1.5) * 2.0);
        (seen.collect(), real)
    }
}

fn lift(turn: f64) -> f64 {
    let u = (turn - 0.5) * 360.0 / 75.0;
    if u.abs() < 1.0 { 9.0 * (1.0 - u * u).powi(3) } else { 0.0 }
}

fn profile(which: u64) -> Vec<f64> {
    profile_of(which, NODES)
}

fn profile_of(which: u64, nodes: usize) -> Vec<f64> {
    let at = |i: usize| {
        let t = i as f64 / nodes as f64;
        match which % 4 {
            0 => 4.0 * (TAU * t).cos(),
            1 => 1.5 * (3.0 * TAU * (t - 0.05)).cos(),
            2 => 3.0 * (TAU * t).cos() + 0.7 * (2.0 * TAU * t).sin(),
            _ => lift(t),
        }
    };
    (0..nodes).map(at).collect()
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

const HOW: RepetitionOptions = RepetitionOptions { highest_hz: 60.0, floor: Length::um(0.01) };

#[test]
fn eight_turns_take_an_automotive_lift_at_60_rpm_to_the_floor() {
    let (ideal, mut plant, spin) = (profile_of(3, 720), Plant::quiet(), Spin::rpm(60.0));
    let how = RepetitionOptions { highest_hz: 85.0, ..HOW };
    let mut learning = Repetition::new(&ideal, spin, how, None);
    let mut errors = Vec::new();
    for _ in 0..8 {
        let (seen, real) = plant.turn(&learning.table(), spin);
        errors.push(worst(&real, &ideal));
        learning.learn(&seen);
    }
    let left = worst(&plant.turn(&learning.table(), spin).1, &ideal);
    assert!(errors[0] > 0.3, "{errors:?}");
    assert!(left < 5e-4, "{left} {errors:?}");
}

#[test]
fn what_was_learnt_at_one_speed_begins_well_at_another() {
    let (ideal, mut plant) = (profile(3), Plant::quiet());
    let mut learning = Repetition::new(&ideal, Spin::rpm(60.0), HOW, None);
    for _ in 0..8 {
        let (seen, _) = plant.turn(&learning.table(), Spin::rpm(60.0));
        learning.learn(&seen);
    }
    let slower = Spin::rpm(40.0);
    let next = Repetition::new(&ideal, slower, HOW, Some(&learning.response()));
    let raw = worst(&plant.turn(&ideal, slower).1, &ideal);
    let first = worst(&plant.turn(&next.table(), slower).1, &ideal);
    assert!(first < 0.05 * raw, "{first} of {raw}");
}

#[test]
fn a_harmonic_that_answers_the_other_way_round_all_of_a_sudden_is_left_alone() {
    let ideal = profile(2);
    let mut learning = Repetition::new(&ideal, Spin::rpm(60.0), HOW, None);
    let mut sign = 1.0;
    let first: Vec<f64> = ideal.iter().map(|d| 0.9 * d).collect();
    let mut worst_seen: f64 = 0.0;
    for turn in 0..30 {
        let table = learning.table();
        // from the second turn on the second harmonic pushes the wrong way
        let mut sent = Spectrum::of(&table, 20);
        sent.harmonics[2] = sent.harmonics[2] * sign;
        let came: Vec<f64> = sent.values(NODES).iter().map(|x| 0.9 * x).collect();
        worst_seen = worst_seen.max(rms(&came, &ideal));
        learning.learn(&came);
        if turn == 0 {
            sign = -1.0;
        }
    }
    assert!(worst_seen < 4.0 * rms(&first, &ideal).max(1.0), "{worst_seen}");
    assert!(learning.progress.is_over());
}

#[test]
fn five_hundred_disturbed_machines_are_never_worse_than_without_learning() {
    let mut gained = 0;
    for case in 0..500u64 {
        let mut dice = Plant { seed: case * 7919 + 1, ..Plant::quiet() };
        let mut plant = Plant {
            lag_hz: 8.0 + 60.0 * dice.random(),
            resonance_hz: 60.0 + 80.0 * dice.random(),
            delay_s: 1e-3 * dice.random(),
            friction: 0.003 * dice.random(),
            eccentricity: if case % 3 == 0 { 1e-5 * dice.random() } else { 0.0 },
            noise: 0.002 * dice.random() * dice.random(),
            seed: case + 99,
        };
        let ideal = profile(case);
        let mut spin = Spin::rpm(10.0 + 90.0 * dice.random());
        let mut learning = Repetition::new(&ideal, spin, HOW, None);
        if case % 2 == 0 {
            // what is assumed of the drive is right for one machine in the middle of them all
            learning = learning.assuming(assumed());
        }
        for turn in 0..10 {
            if turn == 4 && case % 5 == 0 {
                // a step of the speed: what is known of the frequencies goes with it
                spin = spin * (0.7 + 0.6 * dice.random());
                learning = Repetition::new(&ideal, spin, HOW, Some(&learning.response()));
            }
            if turn == 5 && case % 4 == 0 {
                plant.friction *= 2.0 * dice.random(); // oil
                plant.lag_hz *= 0.9 + 0.2 * dice.random();
            }
            let without = rms(&plant.clone().turn(&ideal, spin).1, &ideal);
            let (seen, real) = plant.turn(&learning.table(), spin);
            let with = rms(&real, &ideal);
            assert!(
                with <= without + 2.0 * plant.noise,
                "case {case}, turn {turn}: {with} while {without} without; {plant:?}"
            );
            learning.learn(&seen);
        }
        let without = rms(&plant.turn(&ideal, spin).1, &ideal);
        let with = rms(&plant.turn(&learning.table(), spin).1, &ideal);
        assert!(
            with <= without + 2.0 * plant.noise,
            "case {case}: {with} after {without}; {plant:?}"
        );
        gained += u32::from(with < 0.2 * without);
    }
    assert!(gained > 400, "only {gained} of 500 got five times better");
}

/// The answer of the quiet plant: a lag of 19 Hz.
fn assumed() -> Response {
    let plant = Plant::quiet();
    Response::from_points((1..=200).map(|i| {
        let (hz, h) = (f64::from(i) / 2.0, plant.answer(f64::from(i) / 2.0));
        (hz, h.size(), -h.turn())
    }))
}

#[test]
fn friction_of_an_eccentric_is_learnt_where_the_command_says_nothing() {
    let (ideal, spin) = (profile_of(0, 720), Spin::rpm(60.0));
    let left = |assumed: Response| {
        let mut plant = Plant { friction: 0.002, lag_hz: 25.0, ..Plant::quiet() };
        let mut learning = Repetition::new(&ideal, spin, HOW, None).assuming(assumed);
        for _ in 0..12 {
            let (seen, _) = plant.turn(&learning.table(), spin);
            learning.learn(&seen);
        }
        rms(&plant.turn(&learning.table(), spin).1, &ideal)
    };
    let (without, with) = (left(Response::default()), left(assumed()));
    assert!(without > 1e-4 && with < 0.5 * without, "{with} mm rms, {without} without");
}

#[test]
fn learning_takes_what_was_sampled() {
    let ideal = profile(0);
    let pairs: Vec<Pair> = (0..8000)
        .map(|i| f64::from(i) * 250e-6)
        .map(|t| Pair {
            angle: Angle::rev(t),
            position: Length::mm(4.0 * (TAU * (t - 0.01)).cos()),
        })
        .collect();
    let mut learning = Repetition::new(&ideal, Spin::rpm(60.0), HOW, None);
    assert_eq!(learning.learn(&fold(&pairs, NODES).unwrap()), Taught::Updated);
    let sent = Spectrum::of(&learning.table(), 3);
    assert!((sent.harmonics[1].turn() - 0.01).abs() < 1e-6, "{:?}", sent.harmonics[1].turn());
}

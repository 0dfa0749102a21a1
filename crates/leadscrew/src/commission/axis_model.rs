//! An axis as its drive sees it: two masses, a spring with play, friction, weight.
//!
//! ```text
//!     F(t − d)                 k, c, play b
//!   ─────────►┌─────────┐                    ┌─────────┐
//!             │ m₁  x₁  ├──╱╲╱╲╱──┤ ├────────┤ m₂  x₂  │◄── C·sgn v₂ + B·v₂ + W
//!             └─────────┘                    └─────────┘
//!   F = m₁·a₁ + f     m₂·a₂ = f − C·sgn v₂ − B·v₂ − W     f = k·deadzone(x₁ − x₂, b) + c·(v₁ − v₂)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x₁, v₁, a₁, m₁ | motor and screw by their encoder, as a mass along the axis | m, m/s, m/s², kg |
//! | x₂, v₂, a₂, m₂ | table, which no encoder sees | m, m/s, m/s², kg |
//! | F, d | measured force, and how late it is | N, s |
//! | C, B, W | Coulomb and viscous friction, weight | N, N·s/m, N |
//!
//! The encoder's motion is put in, the table's follows by integration, the force comes out and is
//! compared with what the drive measured: errors of the force are all there is, and white noise of
//! it leaves no bias. Second differences of an encoder are rough; means of them over
//! blocks of some periods are not, and measured force and model are averaged alike.
//!
//! Only stretches in which the slide glides in one sense are looked at: below the Stribeck speed
//! and at reversals friction is another one.
//!
//! Source: two masses, e.g. Altintas, *Manufacturing Automation*, 2nd ed. 2012, ch. 5; output error
//! models: Ljung, *System Identification*, 2nd ed. 1999, ch. 4.
use super::least_squares::{Fit, MOST_STEPS, Residuals, fit};
use std::ops::Range;

/// Periods that are averaged.
const BLOCK: usize = 6;
/// Time that a stretch is given until what it began with has died out, s.
const SETTLES_S: f64 = 0.12;
/// Stretches that are shorter than this say nothing, s.
const SHORTEST_S: f64 = 0.2;
/// Time over which what is left may be correlated, s.
const MEMORY_S: f64 = 0.1;
/// Time over which the speed is taken to find stretches, s.
const SPEED_OVER_S: f64 = 4e-3;
/// A force may be so much later than twice what the file says, s.
const LATER_S: f64 = 3e-3;
/// Physics steps a period.
const STEPS: usize = 2;
/// Shares of the believed stiffness that are tried.
const STIFFNESSES: [f64; 5] = [1.0, 0.65, 0.8, 1.25, 1.55];
/// Steps with which each is tried.
const TRIED_STEPS: usize = 2;
/// What is found with any of them: masses, friction, weight, delay.
const RIGID: [bool; 9] = [true, true, false, false, false, true, true, true, true];
/// Play that the samples cannot show within this is not judged, m.
const PLAY_SHOWN_M: f64 = 2e-6;

/// What was recorded of an axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct AxisSamples {
    /// Servo period, s.
    pub(crate) period_s: f64,
    /// Position by the motor's encoder, m.
    pub(crate) position: Vec<f64>,
    /// Measured force, N.
    pub(crate) force: Vec<f64>,
}

/// Parameters of the model, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisParameters {
    pub(crate) motor_mass: f64,
    pub(crate) table_mass: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) play: f64,
    pub(crate) coulomb: f64,
    pub(crate) viscous: f64,
    pub(crate) weight: f64,
    pub(crate) delay: f64,
}

/// Index of each parameter in a fit.
pub(crate) mod place {
    pub(crate) const MOTOR: usize = 0;
    pub(crate) const TABLE: usize = 1;
    pub(crate) const STIFFNESS: usize = 2;
    pub(crate) const DAMPING: usize = 3;
    pub(crate) const PLAY: usize = 4;
    pub(crate) const COULOMB: usize = 5;
    pub(crate) const VISCOUS: usize = 6;
    pub(crate) const WEIGHT: usize = 7;
    pub(crate) const DELAY: usize = 8;
}

impl AxisParameters {
    const fn list(&self) -> [f64; 9] {
        [
            self.motor_mass,
            self.table_mass,
            self.stiffness,
            self.damping,
            self.play,
            self.coulomb,
            self.viscous,
            self.weight,
            self.delay,
        ]
    }

    /// What a solver tried, kept where it means something.
    fn of(list: &[f64]) -> Self {
        let at_least = |i: usize, least: f64| list[i].abs().max(least);
        Self {
            motor_mass: list[place::MOTOR],
            table_mass: at_least(place::TABLE, 1e-3),
            stiffness: at_least(place::STIFFNESS, 1e3),
            damping: at_least(place::DAMPING, 0.0),
            play: at_least(place::PLAY, 0.0),
            coulomb: list[place::COULOMB],
            viscous: list[place::VISCOUS],
            weight: list[place::WEIGHT],
            delay: list[place::DELAY].clamp(0.0, 0.1),
        }
    }

    /// Frequency at which the table swings against a motor that stands, Hz.
    #[cfg(test)]
    pub(crate) fn antiresonance_hz(&self) -> f64 {
        (self.stiffness / self.table_mass).sqrt() / std::f64::consts::TAU
    }
}

/// What was found of an axis.
#[derive(Clone, Debug)]
pub(crate) struct AxisFit {
    pub(crate) fit: Fit,
    pub(crate) parameters: AxisParameters,
    /// The play shows in the samples: the slide has changed its flank.
    pub(crate) play_shows: bool,
}

/// Fits the model to what was recorded; `None`: there is too little motion in it.
pub(crate) fn fit_axis(
    samples: &AxisSamples,
    begin: &AxisParameters,
    least_speed: f64,
) -> Option<AxisFit> {
    let all = stretches(samples, least_speed);
    if all.is_empty() {
        return None;
    }
    let speed = speeds(samples);
    let latest = ((2.0 * begin.delay + LATER_S) / samples.period_s) as usize;
    let residuals_of = |stretches: &[Range<usize>], list: &[f64]| {
        residuals(samples, &speed, stretches, &AxisParameters::of(list), latest)
    };
    // both senses, slow and fast ones
    let some: Vec<_> = all.iter().enumerate().filter(|(i, _)| i % 6 < 2).collect();
    let some: Vec<Range<usize>> = some.into_iter().map(|(_, stretch)| stretch.clone()).collect();
    let of_some = |list: &[f64]| residuals_of(&some, list);
    let of_all = |list: &[f64]| residuals_of(&all, list);
    let scales = [1.0, 1.0, 1e5, 10.0, 1e-7, 0.1, 1.0, 0.1, 1e-6];
    let starts = STIFFNESSES.map(|factor| {
        let begin = AxisParameters { stiffness: begin.stiffness * factor, ..*begin };
        fit(&begin.list(), &RIGID, &scales, &of_some, TRIED_STEPS)
    });
    let starts = starts.into_iter().flatten();
    let best = starts.min_by(|a, b| a.rms.total_cmp(&b.rms))?;
    let mut without_play = [true; 9];
    without_play[place::PLAY] = false;
    let elastic = fit(&best.values, &without_play, &scales, &of_some, MOST_STEPS)?;
    let begin = fit(&elastic.values, &[true; 9], &scales, &of_some, MOST_STEPS);
    let begin = begin.map_or(elastic.values, |found| found.values);
    let mut found = fit(&begin, &[true; 9], &scales, &of_all, MOST_STEPS);
    let play_half = found.as_ref().map_or(f64::MAX, |found| found.of(|p| p[place::PLAY]).half);
    let play_shows = play_half < PLAY_SHOWN_M;
    if !play_shows {
        found = fit(&begin, &without_play, &scales, &of_all, MOST_STEPS);
    }
    let mut found = found?;
    for i in [place::TABLE, place::STIFFNESS, place::DAMPING, place::PLAY] {
        found.values[i] = found.values[i].abs();
    }
    let parameters = AxisParameters::of(&found.values);
    Some(AxisFit { fit: found, parameters, play_shows })
}

/// Speed of the motor at each period, m/s.
fn speeds(samples: &AxisSamples) -> Vec<f64> {
    let x = &samples.position;
    let over = 2.0 * samples.period_s;
    let inside = 1..x.len().saturating_sub(1);
    let speed = |n: usize| (x[n + 1] - x[n - 1]) / over;
    (0..x.len()).map(|n| if inside.contains(&n) { speed(n) } else { 0.0 }).collect()
}

/// Where the slide glides in one sense, faster than this.
pub(crate) fn stretches(samples: &AxisSamples, least_speed: f64) -> Vec<Range<usize>> {
    let x = &samples.position;
    let half = ((SPEED_OVER_S / samples.period_s / 2.0).round() as usize).max(1);
    let shortest = (SHORTEST_S / samples.period_s) as usize;
    let speed = |n: usize| (x[n + half] - x[n - half]) / (2 * half) as f64 / samples.period_s;
    let mut found = Vec::new();
    let mut begun: Option<(usize, f64)> = None;
    for n in half..x.len().saturating_sub(half) {
        let v = speed(n);
        let glides = v.abs() > least_speed;
        match begun {
            Some((from, sense)) if !glides || v * sense < 0.0 => {
                if n - from > shortest {
                    found.push(from..n);
                }
                begun = glides.then_some((n, v.signum()));
            }
            None if glides => begun = Some((n, v.signum())),
            _ => {}
        }
    }
    found
}

/// Mean measured force less mean modelled force, block by block.
fn residuals(
    samples: &AxisSamples,
    speed: &[f64],
    stretches: &[Range<usize>],
    model: &AxisParameters,
    latest: usize,
) -> Residuals {
    let settle = (SETTLES_S / samples.period_s) as usize;
    let memory = ((MEMORY_S / samples.period_s) as usize / BLOCK).max(1);
    let late = (model.delay / samples.period_s).min(latest as f64);
    let (whole, part) = (late.floor() as usize, late.fract());
    let mut values = Vec::new();
    let mut blocks = Vec::new();
    let mut sums = Vec::new();
    for stretch in stretches {
        modelled(samples, speed, stretch, model, &mut sums);
        let first = values.len();
        let mut n = stretch.start + settle + latest + 3;
        while n + BLOCK + 2 < stretch.end {
            // a reading is the force that was held over the period before it, and a second
            // difference of positions is the mean of two such
            let f = &samples.force[n..=n + BLOCK];
            let ends = f64::midpoint(f[0], f[BLOCK]);
            let measured = (ends + f[1..BLOCK].iter().sum::<f64>()) / BLOCK as f64;
            let from = n - stretch.start - whole;
            let sum = at(&sums, from + BLOCK, part) - at(&sums, from, part);
            values.push(measured - sum / BLOCK as f64);
            n += BLOCK;
        }
        let mut from = first;
        while from < values.len() {
            let to = (from + memory).min(values.len());
            blocks.push(from..to);
            from = to;
        }
    }
    Residuals { values, blocks }
}

/// Running sum at n − part: by Catmull and Rom's cubic.
fn at(sums: &[f64], n: usize, part: f64) -> f64 {
    let (p0, p1, p2, p3) = (sums[n + 1], sums[n], sums[n - 1], sums[n - 2]);
    let t = part;
    let cubic = p3 - p0 + 3.0 * (p1 - p2);
    let square = 2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3;
    p1 + 0.5 * t * (p2 - p0 + t * (square + t * cubic))
}

/// Running sums of the modelled force over a stretch, from 0 on; each next one adds a period's.
fn modelled(
    samples: &AxisSamples,
    speed: &[f64],
    stretch: &Range<usize>,
    model: &AxisParameters,
    sums: &mut Vec<f64>,
) {
    sums.clear();
    sums.push(0.0);
    let (x, t) = (&samples.position, samples.period_s);
    let h = t / STEPS as f64;
    let start = stretch.start;
    let sense = speed[start + 2].signum();
    let half = model.play / 2.0;
    let constant = model.coulomb * sense + model.weight;
    let pace = 8.min(stretch.end - start - 1);
    let accel = (speed[start + pace] - speed[start]) / (pace as f64 * t);
    let carried = constant + model.viscous * speed[start] + model.table_mass * accel;
    let side = if carried < 0.0 { -half } else { half };
    let (mut table, mut v) = (x[start] - side - carried / model.stiffness, speed[start]);
    let rate = h / model.table_mass;
    let origin = x[start]; // positions of metres lose what a spring feels
    table -= origin;
    let (mut sum, mut before_it) = (0.0, carried / 2.0);
    for n in start..stretch.end.min(x.len() - 3) {
        let (x0, x1) = (x[n] - origin, x[n + 1] - origin);
        let (v0, v1) = (speed[n], speed[n + 1]);
        let spring = |ahead: f64, opening: f64| {
            let beyond = ahead - ahead.clamp(-half, half);
            model.stiffness * beyond + model.damping * opening
        };
        // the spring's force, weighed as a second difference weighs: by a triangle over two periods
        let (mut falls, mut rises) = (0.0, 0.0);
        // Hermite's cubic through both readings with their speeds
        let (run, bend) = (x1 - x0, t * (v0 + v1) - 2.0 * (x1 - x0));
        for step in 0..STEPS {
            let share = (step as f64 + 0.5) / STEPS as f64;
            let middle = table + h / 2.0 * v;
            let cubic = share * (1.0 - share) * (t * v0 - run - share * bend);
            let motor = x0 + share * run + cubic;
            let force = spring(motor - middle, v0 + share * (v1 - v0) - v);
            falls += force * (1.0 - share) / STEPS as f64;
            rises += force * share / STEPS as f64;
            let pushed = force - constant - model.viscous * v;
            let before = v;
            v += rate * pushed;
            table += h / 2.0 * (before + v);
        }
        let accel = (x[n + 1] - 2.0 * x[n] + x[n - 1]) / (t * t);
        sum += model.motor_mass * accel + before_it + falls;
        before_it = rises;
        sums.push(sum);
    }
}

#[cfg(test)]
mod tests;

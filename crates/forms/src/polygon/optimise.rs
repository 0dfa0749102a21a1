//! The flattest facet that the axes can follow: a convex problem.
//!
//! The tip's distance from the flat is linear in the harmonics of dx and dy, and nearly so in those of the tool's
//! phase (two corrections make it exact):
//!
//! ```text
//!   minimise t      subject to   |e(u) − offset| ≤ t                      wherever a tip touches a facet
//!                                |x|, |ẋ|, |ẍ|, |x⃛|, |m·ẍ + c·ẋ| ≤ limit   over a whole period, each actuator
//!   e(u) = l·cos u − r·cos(qu) − (l−r)  +  dx·cos u + dy·sin u + r·sin(qu)·ε        q = R − 1
//!   dx = Σ G(m)·(a·cos mφ + b·sin mφ)       G: answer of the closed loop; 1 where it is compensated
//! ```
//!
//! A first solution finds the least t; a second one, of all that are as flat, the one that asks least of the drives.
//! Limits between two samples: a trigonometric polynomial of degree H sampled n times exceeds its samples by no more
//! than 1/cos(πH/n), which is taken off the limits beforehand; what rounding still leaves over one makes all of it so
//! much smaller, so the result never exceeds a limit.
use super::form::Form;
use super::lp::{Lp, Row};
use super::profile::contact;
use super::series::{Actuator, Series, Swings, Term};
use std::f64::consts::{PI, TAU};
use units::{Angle, Length, Spin};

/// Places along a facet at which it shall be flat.
const CONTACTS: usize = 61;
/// Samples of a period for each harmonic, and one of how many does not wait.
const SAMPLES: usize = 40;
const AT_ONCE: usize = 10;
/// Corrections of what is not linear.
const CORRECTIONS: usize = 3;
/// Of all that are flatter by no more than this the one that asks least is taken: a share, and mm.
pub(super) const AS_FLAT: (f64, f64) = (1.0002, 1e-6);
/// A limit that is used to this share binds.
const BINDING: f64 = 0.95;

/// What one actuator can do: mm and s, or rev and s; N, or N·m.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Farthest from the middle.
    pub travel: f64,
    /// Speed.
    pub speed: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Jerk.
    pub jerk: f64,
    /// What its drive needs and has, if that is known.
    pub effort: Option<Effort>,
}

/// Force or torque = `per_acceleration`·ẍ + `per_speed`·ẋ + `constant`, within ±most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Mass or inertia, in the units of the amplitude.
    pub per_acceleration: f64,
    /// Viscous friction.
    pub per_speed: f64,
    /// Coulomb friction and what turning takes.
    pub constant: f64,
    /// What the drive gives.
    pub most: f64,
}

/// An actuator that may swing.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Which.
    pub actuator: Actuator,
    /// What it can do.
    pub limits: Limits,
    /// What its closed loop makes of each harmonic, real and imaginary part; empty: 1, it is compensated.
    pub response: Vec<[f64; 2]>,
}

/// A problem.
#[derive(Clone, Debug)]
pub struct Problem<'f> {
    /// What is wanted.
    pub form: &'f Form,
    /// Speed of the work.
    pub spin: Spin,
    /// Who may swing.
    pub drives: Vec<Drive>,
    /// Harmonics of the form's base.
    pub harmonics: usize,
}

/// An answer.
#[derive(Clone, Debug)]
pub struct Solution {
    /// What to command.
    pub command: Swings,
    /// What the loops make of it.
    pub actual: Swings,
    /// Flatness of the worst facet that comes of it.
    pub flatness: Length,
    /// The facets lie so much farther out: take it off the distance of the axes.
    pub offset: Length,
    /// Largest travel, speed, acceleration, jerk, effort of each drive.
    pub peaks: Vec<[f64; 5]>,
    /// The limit that is used up, if one is: "acceleration of X".
    pub binding: Option<String>,
}

impl Problem<'_> {
    /// Solve it. `None` if the solver fails, which a feasible problem (nothing swings) does not make it do.
    pub fn solve(&self) -> Option<Solution> {
        let n = self.unknowns();
        let mut actual = Swings::default();
        let mut x = Vec::new();
        for round in 1..=CORRECTIONS {
            let mut lp = self.linear(&actual);
            if round < CORRECTIONS {
                x = lp.solve(n)?;
            } else {
                x = lp.minimise(n)?;
                let most = x[n].max(0.0) * AS_FLAT.0 + AS_FLAT.1;
                lp.within.push(Row { weights: vec![(n, 1.0)], bound: most });
                x = lp.minimise(n + 2).unwrap_or(x);
            }
            actual = self.swings(&x, true);
        }
        Some(self.solution(self.swings(&x, false), actual, x[n + 1]))
    }

    /// A command and what comes of it, made smaller where a peak is over its limit.
    pub(super) fn solution(
        &self,
        mut command: Swings,
        mut actual: Swings,
        offset_mm: f64,
    ) -> Solution {
        let mut peaks = self.peaks(&command);
        let used = self.used(&peaks).map_or(0.0, |(used, _)| used);
        if used > 1.0 {
            let used = used * (1.0 + 1e-9);
            for series in command.0.iter_mut().chain(&mut actual.0) {
                for term in &mut series.terms {
                    (term.cosine, term.sine) = (term.cosine / used, term.sine / used);
                }
            }
            peaks = self.peaks(&command);
        }
        let binding = self.used(&peaks).filter(|(used, _)| *used > BINDING).map(|(_, name)| name);
        let flatness = self.form.flatness(&actual);
        Solution { command, actual, flatness, offset: Length::mm(offset_mm), peaks, binding }
    }

    /// Coefficients: cosine and sine of each harmonic of each drive.
    fn unknowns(&self) -> usize {
        2 * self.harmonics * self.drives.len()
    }

    fn swings(&self, x: &[f64], actual: bool) -> Swings {
        let series = self.drives.iter().enumerate().map(|(k, drive)| {
            let terms = (0..self.harmonics).map(|h| {
                let i = 2 * (k * self.harmonics + h);
                let (a, b) = (x[i], x[i + 1]);
                let [re, im] = if actual { drive.at(h) } else { [1.0, 0.0] };
                // Re[(a − jb)·G·e^{jmφ}]
                Term {
                    per_turn: self.form.base() * (h + 1) as f64,
                    cosine: a * re + b * im,
                    sine: b * re - a * im,
                }
            });
            Series { actuator: drive.actuator, terms: terms.collect() }
        });
        Swings(series.collect())
    }

    /// Solve it with a few harmonics; where a limit binds, as finely as it takes.
    pub fn solve_well(&self) -> Option<Solution> {
        Some(self.refined(self.solve()?))
    }

    /// A solution with a few harmonics, or a finer one where a limit binds and it is flatter.
    pub fn refined(&self, few: Solution) -> Solution {
        if few.binding.is_none() || self.spin == Spin::ZERO {
            return few;
        }
        self.solve_finely(&few).filter(|fine| fine.flatness < few.flatness).unwrap_or(few)
    }

    /// Largest of everything, finely sampled.
    pub(super) fn peaks(&self, command: &Swings) -> Vec<[f64; 5]> {
        let omega = self.spin.in_rad_per_s();
        let largest = |(drive, series): (&Drive, &Series)| {
            let mut peak = [0.0_f64; 5];
            let highest = series.terms.iter().map(|t| t.per_turn).fold(0.0, f64::max);
            // the highest harmonics of a spline are too small to need as many as a few large ones
            let harmonics = highest / self.form.base();
            let count = (200.0 * harmonics).min(6_400.0).max(20.0 * harmonics).ceil() as usize;
            for d in series.over_a_period(self.form.base(), count) {
                let by_time = [d[0], d[1] * omega, d[2] * omega.powi(2), d[3] * omega.powi(3)];
                for (peak, now) in peak.iter_mut().zip(by_time) {
                    *peak = peak.max(now.abs());
                }
                if let Some(e) = drive.limits.effort {
                    let effort = e.per_acceleration * by_time[2] + e.per_speed * by_time[1];
                    peak[4] = peak[4].max(effort.abs() + e.constant);
                }
            }
            peak
        };
        self.drives.iter().zip(&command.0).map(largest).collect()
    }

    /// The largest share of a limit that is used, and its name.
    fn used(&self, peaks: &[[f64; 5]]) -> Option<(f64, String)> {
        const NAMES: [&str; 5] = ["travel", "speed", "acceleration", "jerk", "torque"];
        let shares = self.drives.iter().zip(peaks).flat_map(|(drive, peak)| {
            let shares = drive.limits.shares(peak).into_iter().zip(NAMES);
            shares.map(|(share, name)| (share, format!("{name} of {}", drive.actuator.name())))
        });
        shares.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// |e − offset| ≤ t at places along every facet; `at` says with which weights a drive's unknowns move it at an angle
    /// of the work, t and offset are the two unknowns after all of those.
    pub(super) fn flat_rows(
        &self,
        before: &Swings,
        count: usize,
        unknowns: usize,
        mut at: impl FnMut(usize, Angle, f64) -> Vec<(usize, f64)>,
    ) -> Vec<Row> {
        let cutter = self.form.cutter();
        let mut rows = Vec::new();
        for facet in self.form.kinds() {
            let ends = [facet.to, facet.from].map(|s| contact(&cutter, &facet, before, s));
            for i in 0..count {
                // denser towards the corners, where the best curve touches its limits
                let part = 0.5 - 0.5 * (PI * i as f64 / (count - 1) as f64).cos();
                let u = Angle::rev(ends[0] + (ends[1] - ends[0]) * part);
                let work = facet.centre + u;
                let now = before.at(work);
                let mut constant = (cutter.tip_at_facet(u, now).x - cutter.flat()).value();
                let mut weights = Vec::new();
                for (k, drive) in self.drives.iter().enumerate() {
                    let slope = cutter.slope(u, now, drive.actuator);
                    constant -= slope * drive.actuator.of(now);
                    weights.extend(at(k, work, slope));
                }
                for sign in [1.0, -1.0] {
                    let mut signed: Vec<_> = weights.iter().map(|(c, a)| (*c, a * sign)).collect();
                    signed.extend([(unknowns, -1.0), (unknowns + 1, -sign)]);
                    rows.push(Row { weights: signed, bound: -constant * sign });
                }
            }
        }
        rows
    }

    /// The linear problem about a swing. Unknowns: coefficients, t, offset, and s, the share of the limits that is used.
    fn linear(&self, before: &Swings) -> Lp {
        let n = self.unknowns();
        let unit = |column: usize| {
            let (drive, term) = (column / (2 * self.harmonics), column % (2 * self.harmonics));
            self.drives[drive].actuator.unit() / (term / 2 + 1) as f64
        };
        let within = self.flat_rows(before, CONTACTS, n, |k, work, slope| {
            let weights = (0..self.harmonics).flat_map(|h| {
                let column = 2 * (k * self.harmonics + h);
                let m = self.form.base() * (h + 1) as f64;
                let (sine, cosine) = (TAU * (m * work.value()).fract()).sin_cos();
                let [re, im] = self.drives[k].at(h);
                let even = slope * (re * cosine - im * sine);
                [(column, even), (column + 1, slope * (im * cosine + re * sine))]
            });
            weights.collect()
        });
        let scale = (0..n).map(unit).chain([1e-3, 1e-2, 1.0]).collect();
        let mut lp = Lp { scale, within, ..Lp::default() };
        for (k, drive) in self.drives.iter().enumerate() {
            self.limits(k, drive, &mut lp);
        }
        lp.within.push(Row { weights: vec![(n + 2, 1.0)], bound: 1.0 });
        lp
    }

    /// Every limit of a drive, as a share s ≤ 1 of it.
    fn limits(&self, k: usize, drive: &Drive, lp: &mut Lp) {
        let share = self.unknowns() + 2;
        let count = SAMPLES * self.harmonics;
        let between = (PI / SAMPLES as f64).cos();
        let omega = self.spin.in_rad_per_s();
        let l = &drive.limits;
        let mut wanted: Vec<([f64; 4], f64)> = vec![
            ([1.0, 0.0, 0.0, 0.0], l.travel),
            ([0.0, omega, 0.0, 0.0], l.speed),
            ([0.0, 0.0, omega.powi(2), 0.0], l.acceleration),
            ([0.0, 0.0, 0.0, omega.powi(3)], l.jerk),
        ];
        if let Some(e) = l.effort {
            let weights = [0.0, e.per_speed * omega, e.per_acceleration * omega * omega, 0.0];
            wanted.push((weights, (e.most - e.constant).max(0.0)));
        }
        for (weights, most) in wanted.into_iter().filter(|(_, most)| most.is_finite()) {
            let room = (most * between).max(1e-12);
            let row = |i: usize, sign: f64| {
                let phase = TAU * i as f64 / count as f64;
                let both = (0..self.harmonics).flat_map(|h| {
                    let column = 2 * (k * self.harmonics + h);
                    let m = self.form.base() * (h + 1) as f64;
                    let (s, c) = (phase * (h + 1) as f64).sin_cos();
                    let [w0, w1, w2, w3] = weights.map(|w| w * sign / room);
                    let even = w0 * c - w1 * m * s - w2 * m * m * c + w3 * m.powi(3) * s;
                    let odd = w0 * s + w1 * m * c - w2 * m * m * s - w3 * m.powi(3) * c;
                    [(column, even), (column + 1, odd)]
                });
                Row { weights: both.chain([(share, -1.0)]).collect(), bound: 0.0 }
            };
            for sign in [1.0, -1.0] {
                lp.within.extend((0..count).step_by(AT_ONCE).map(|i| row(i, sign)));
                lp.waiting.push((0..count).map(|i| row(i, sign)).collect());
            }
        }
    }
}

impl Limits {
    /// The share of each that peaks use.
    pub(super) fn shares(&self, peaks: &[f64; 5]) -> [f64; 5] {
        let effort = self.effort.map_or(f64::INFINITY, |e| e.most);
        let most = [self.travel, self.speed, self.acceleration, self.jerk, effort];
        [0, 1, 2, 3, 4].map(|n| peaks[n] / most[n])
    }
}

impl Drive {
    pub(super) fn at(&self, harmonic: usize) -> [f64; 2] {
        self.response.get(harmonic).copied().unwrap_or([1.0, 0.0])
    }
}

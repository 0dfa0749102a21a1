//! The flattest facet that the axes can follow: a convex problem.
//!
//! The tip's distance from the flat is linear in the harmonics of dx and dy, and nearly so in those
//! of the tool's phase (a few corrections make it exact):
//!
//! ```text
//!   minimise t      subject to   |e(u)| ≤ t                               wherever a tip touches a facet
//!                                |x|, |ẋ|, |ẍ|, |x⃛|, |m·ẍ + c·ẋ| ≤ limit   over a whole period, each actuator
//!   e(u) = l·cos u − r·cos(qu) − (l−r)  +  (dx + x₀)·cos u + dy·sin u + r·sin(qu)·ε        q = R − 1
//!   dx = Σ G(m)·(a·cos mφ + b·sin mφ)       G: answer of the closed loop; 1 where it is compensated
//! ```
//!
//! The size is part of the problem: what swings has no mean, and x₀, by which the axes stand
//! nearer, is an unknown. It moves the facet by x₀·cos u, not by x₀: a facet that is flat somewhere
//! else is not flat here.
//!
//! A first solution finds the least t; a second one, of all that are as flat, the one that asks
//! least of the drives. Limits between two samples: a trigonometric polynomial of degree H sampled
//! n times exceeds its samples by no more than 1/cos(πH/n), which is taken off the limits
//! beforehand; what rounding still leaves over one makes all of it so much smaller, so the result
//! never exceeds a limit.
use super::drive::Drive;
use super::form::Form;
use super::lp::{Constraint, Lp};
use super::profile::contact;
use super::series::{Actuator, Series, Swings, Term};
use std::f64::consts::{PI, TAU};
use units::{Angle, Length, Spin};

/// Places along a facet at which it shall be flat.
const CONTACTS: usize = 61;
/// Samples of a period for each harmonic, and one of how many does not wait.
const SAMPLES: usize = 40;
const AT_ONCE: usize = 10;
/// Corrections of what is not linear: without regard to what is asked of the drives (where a phase
/// swings, where only slides do), and at most in all.
const PLAIN_CORRECTIONS: [usize; 2] = [2, 1];
const CORRECTIONS: usize = 12;
/// Shares of the way to what asks least of the drives.
const STEPS: [f64; 4] = [1.0, 0.5, 0.2, 0.0];
/// A facet is as flat as the linear problem promises within this share, and mm.
const AS_PROMISED: (f64, f64) = (1.02, 1e-5);
/// Of all that are flatter by no more than this the one that asks least is taken: a share, and mm.
const AS_FLAT: (f64, f64) = (1.0002, 1e-6);
/// A limit that is used to this share binds.
const BINDING: f64 = 0.95;

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

/// How finely a limit is made use of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// As it is to be cut.
    Full,
    /// To be drawn: within a few percent, in a fraction of the time.
    Drawn,
}

/// An answer.
#[derive(Clone, Debug)]
pub struct Solution {
    /// What to command about the distance of the axes that the size asks for, the constant part of
    /// X included.
    pub command: Swings,
    /// What the loops make of it.
    pub actual: Swings,
    /// Flatness of the worst facet that comes of it, at the size that is wanted.
    pub flatness: Length,
    /// Largest travel, speed, acceleration, jerk, effort of each drive.
    pub peaks: Vec<[f64; 5]>,
    /// The limit that is used up, if one is: "acceleration of X".
    pub binding: Option<String>,
}

impl Problem<'_> {
    /// Solve it. `None` if the solver fails, which a feasible problem (nothing swings) does not
    /// make it do.
    pub fn solve(&self) -> Option<Solution> {
        self.solve_few(Detail::Full)
    }

    /// The same; what is to be drawn may ask more of the drives than it must.
    fn solve_few(&self, detail: Detail) -> Option<Solution> {
        let n = self.unknowns();
        let straight = self.drives.iter().all(|drive| drive.actuator != Actuator::ToolPhase);
        let plain = PLAIN_CORRECTIONS[usize::from(straight)];
        let (mut actual, mut x) = (Swings::default(), Vec::new());
        let mut best = Best::default();
        for round in 1..=CORRECTIONS {
            let mut lp = self.linear(&actual);
            if round > plain + 1 {
                lp.near.clone_from(&x);
            }
            if round <= plain {
                let found = lp.solve(n).or_else(|| {
                    lp.near = vec![0.0; n + 3]; // a shorter way is easier to find
                    lp.solve(n)
                });
                actual = self.swings(&found?, true);
                continue;
            }
            let Some(flattest) = lp.minimise(n) else { break };
            let least = match detail {
                Detail::Full => lp.least_effort(n, &flattest),
                Detail::Drawn => flattest.clone(),
            };
            // as far towards what asks least as the straight lines hold
            let done = STEPS.into_iter().find(|share| {
                x = between(&flattest, &least, *share);
                actual = self.swings(&x, true);
                best.is_as_promised(self.form.flatness(&actual), &x, n)
            });
            if done == Some(1.0) {
                break;
            }
        }
        let x = best.0?.1;
        Some(self.solution(self.swings(&x, false), self.swings(&x, true)))
    }

    /// A command and what comes of it, made smaller where a peak is over its limit.
    pub(super) fn solution(&self, mut command: Swings, mut actual: Swings) -> Solution {
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
        Solution { command, actual, flatness, peaks, binding }
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
        Swings(series.collect()).standing(Length::mm(x[self.unknowns() + 1]))
    }

    /// Solve it with a few harmonics; where a limit binds, as finely as it takes.
    pub fn solve_well(&self, detail: Detail) -> Option<Solution> {
        Some(self.refined(self.solve_few(detail)?, detail))
    }

    /// A solution with a few harmonics, or a finer one where a limit binds and it is flatter.
    pub fn refined(&self, few: Solution, detail: Detail) -> Solution {
        if few.binding.is_none() || self.spin == Spin::ZERO {
            return few;
        }
        self.solve_finely(&few, detail).filter(|fine| fine.flatness < few.flatness).unwrap_or(few)
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

    /// e at places along every facet, as the weights of the unknowns that move it and a constant;
    /// `at` says with which weights a drive's unknowns do so at an angle of the work, the unknown
    /// `standing` is x₀.
    pub(super) fn errors(
        &self,
        before: &Swings,
        count: usize,
        standing: usize,
        mut at: impl FnMut(usize, Angle, f64) -> Vec<(usize, f64)>,
    ) -> Vec<(Vec<(usize, f64)>, f64)> {
        let cutter = self.form.cutter();
        let mut all = Vec::new();
        for facet in self.form.kinds() {
            let ends = [facet.to, facet.from].map(|s| contact(&cutter, &facet, before, s));
            for i in 0..count {
                // denser towards the corners, where the best curve touches its limits
                let part = 0.5 - 0.5 * (PI * i as f64 / (count - 1) as f64).cos();
                let u = Angle::rev(ends[0] + (ends[1] - ends[0]) * part);
                let work = facet.centre + u;
                let now = before.at(work);
                let mut constant = (cutter.tip_at_facet(u, now).x - cutter.flat()).value();
                let mut weights = vec![(standing, cutter.slope(u, now, Actuator::CentreLine))];
                // whatever is there: X stands somewhere even where it does not swing
                for actuator in Actuator::ALL {
                    constant -= cutter.slope(u, now, actuator) * actuator.of(now);
                }
                for (k, drive) in self.drives.iter().enumerate() {
                    weights.extend(at(k, work, cutter.slope(u, now, drive.actuator)));
                }
                all.push((weights, constant));
            }
        }
        all
    }

    /// The linear problem about a swing. Unknowns: coefficients, t, x₀, and s, the share of the
    /// limits that is used.
    fn linear(&self, before: &Swings) -> Lp {
        let n = self.unknowns();
        let unit = |column: usize| {
            let (drive, term) = (column / (2 * self.harmonics), column % (2 * self.harmonics));
            self.drives[drive].actuator.unit() / (term / 2 + 1) as f64
        };
        let errors = self.errors(before, CONTACTS, n + 1, |k, work, slope| {
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
        let within = errors.into_iter().flat_map(|(weights, constant)| flat(&weights, constant, n));
        let within = within.collect();
        let scale = (0..n).map(unit).chain([1e-3, 0.1, 1.0]).collect();
        let mut lp = Lp { scale, within, ..Lp::default() };
        for (k, drive) in self.drives.iter().enumerate() {
            self.limits(k, drive, &mut lp);
        }
        lp.within.push(Constraint { weights: vec![(n + 2, 1.0)], bound: 1.0 });
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
                Constraint { weights: both.chain([(share, -1.0)]).collect(), bound: 0.0 }
            };
            for sign in [1.0, -1.0] {
                lp.within.extend((0..count).step_by(AT_ONCE).map(|i| row(i, sign)));
                lp.waiting.push((0..count).map(|i| row(i, sign)).collect());
            }
        }
    }
}

/// |e| ≤ t, where t is the unknown n.
pub(super) fn flat(e: &[(usize, f64)], constant: f64, n: usize) -> [Constraint; 2] {
    [1.0, -1.0].map(|sign| {
        let mut signed: Vec<_> = e.iter().map(|(column, a)| (*column, a * sign)).collect();
        signed.push((n, -1.0));
        Constraint { weights: signed, bound: -constant * sign }
    })
}

fn between(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect()
}

/// The flattest of what linear problems gave, and how flat it really is.
#[derive(Default)]
pub(super) struct Best(pub(super) Option<(Length, Vec<f64>)>);

impl Best {
    /// Keep a solution if it is flatter; whether it is as flat as promised by its unknown n, half
    /// the flatness in mm.
    pub(super) fn is_as_promised(&mut self, flatness: Length, x: &[f64], n: usize) -> bool {
        let promised = 2.0 * x[n] * AS_PROMISED.0 + AS_PROMISED.1;
        if self.0.as_ref().is_none_or(|(least, _)| flatness < *least) {
            self.0 = Some((flatness, x.to_vec()));
        }
        flatness.value() <= promised
    }
}

impl Lp {
    /// Of all that are as flat as a solution, half its flatness being the unknown n, the one that
    /// asks least of the drives.
    pub(super) fn least_effort(&mut self, n: usize, flattest: &[f64]) -> Vec<f64> {
        let bound = flattest[n].max(0.0) * AS_FLAT.0 + AS_FLAT.1;
        self.within.push(Constraint { weights: vec![(n, 1.0)], bound });
        self.minimise(n + 2).unwrap_or_else(|| flattest.to_vec())
    }
}

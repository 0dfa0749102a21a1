//! Oscillations as harmonic series of the work's angle.
//!
//! ```text
//!   dx, dy (mm), ε (rev)  =  Σ a·cos(2π·m·θ) + b·sin(2π·m·θ)        θ work's angle, rev
//! ```
use super::form::Form;
use super::kinematics::Swing;
use std::f64::consts::TAU;
use units::{Angle, Length};

/// What can swing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Actuator {
    /// X, along the line of centres; amplitudes in mm.
    CentreLine,
    /// Y, across it; amplitudes in mm.
    Across,
    /// The tool spindle's phase; amplitudes in rev.
    ToolPhase,
}

impl Actuator {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::CentreLine, Self::Across, Self::ToolPhase];

    /// Its part of a swing, mm or rev.
    pub const fn of(self, swing: Swing) -> f64 {
        match self {
            Self::CentreLine => swing.dx.value(),
            Self::Across => swing.dy.value(),
            Self::ToolPhase => swing.phase.value(),
        }
    }

    /// An amplitude that is about usual.
    pub(super) const fn unit(self) -> f64 {
        match self {
            Self::CentreLine | Self::Across => 0.1,
            Self::ToolPhase => 1e-3,
        }
    }

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CentreLine => "X",
            Self::Across => "Y",
            Self::ToolPhase => "tool phase",
        }
    }
}

/// One harmonic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Periods per turn of the work.
    pub per_turn: f64,
    /// Of the cosine.
    pub cosine: f64,
    /// Of the sine.
    pub sine: f64,
}

/// What one actuator does.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Which.
    pub actuator: Actuator,
    /// Its harmonics.
    pub terms: Vec<Term>,
}

impl Series {
    /// Whether it is more than a constant.
    pub fn swings(&self) -> bool {
        self.terms.iter().any(|term| term.per_turn > 0.0)
    }

    /// Value, and its first three derivatives by the work's angle in radians, at an angle.
    pub fn at(&self, work: Angle) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for term in &self.terms {
            let (sine, cosine) = (TAU * (term.per_turn * work.value()).fract()).sin_cos();
            let m = term.per_turn;
            let (value, quarter) =
                (term.cosine * cosine + term.sine * sine, term.sine * cosine - term.cosine * sine);
            sum[0] += value;
            sum[1] += m * quarter;
            sum[2] -= m * m * value;
            sum[3] -= m * m * m * quarter;
        }
        sum
    }

    /// The same at `count` equal steps of the work's angle over a period, which is repeated `base`
    /// times a turn.
    pub fn over_a_period(&self, base: f64, count: usize) -> Vec<[f64; 4]> {
        /// Steps after which rounding is not carried on.
        const FRESH: usize = 256;
        let mut sums = vec![[0.0; 4]; count];
        for term in &self.terms {
            let m = term.per_turn;
            let per_step = m / base / count as f64;
            let (sine_1, cosine_1) = (TAU * per_step).sin_cos();
            let (mut sine, mut cosine) = (0.0, 1.0);
            for (i, sum) in sums.iter_mut().enumerate() {
                if i % FRESH == 0 {
                    (sine, cosine) = (TAU * (per_step * i as f64).fract()).sin_cos();
                }
                let value = term.cosine * cosine + term.sine * sine;
                let quarter = term.sine * cosine - term.cosine * sine;
                sum[0] += value;
                sum[1] += m * quarter;
                sum[2] -= m * m * value;
                sum[3] -= m * m * m * quarter;
                (sine, cosine) =
                    (sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1);
            }
        }
        sums
    }
}

/// What all actuators do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Swings(pub Vec<Series>);

impl Swings {
    /// At an angle of the work.
    pub fn at(&self, work: Angle) -> Swing {
        let mut swing = Swing::default();
        for series in &self.0 {
            let value = series.at(work)[0];
            match series.actuator {
                Actuator::CentreLine => swing.dx += Length::mm(value),
                Actuator::Across => swing.dy += Length::mm(value),
                Actuator::ToolPhase => swing.phase += Angle::rev(value),
            }
        }
        swing
    }

    /// The same with X standing so much farther from the work.
    #[must_use]
    pub fn standing(mut self, farther: Length) -> Self {
        let constant = Term { per_turn: 0.0, cosine: farther.value(), sine: 0.0 };
        match self.0.iter_mut().find(|series| series.actuator == Actuator::CentreLine) {
            Some(x) => x.terms.push(constant),
            None => {
                self.0.push(Series { actuator: Actuator::CentreLine, terms: vec![constant] });
            }
        }
        self
    }

    /// The document's oscillation along the line of centres: dx = a·l·(1 − cos Mφ).
    pub fn along_centres(form: &Form, a: f64) -> Self {
        let (l, m) = (form.centres().value(), form.base());
        let terms = vec![
            Term { per_turn: 0.0, cosine: a * l, sine: 0.0 },
            Term { per_turn: m, cosine: -a * l, sine: 0.0 },
        ];
        Self(vec![Series { actuator: Actuator::CentreLine, terms }])
    }

    /// The document's oscillation across: dy = a·l·sin Mφ.
    pub fn across(form: &Form, a: f64) -> Self {
        let term = Term { per_turn: form.base(), cosine: 0.0, sine: a * form.centres().value() };
        Self(vec![Series { actuator: Actuator::Across, terms: vec![term] }])
    }
}

impl Form {
    /// Largest a of the oscillation along the centres that leaves no facet concave: the bulge's
    /// curvature in the middle is just taken away, aX* = (l−r)/(l·M²) at R = 2; generally from
    /// d²x/du² = 0.
    pub fn largest_convex_along(&self) -> f64 {
        let cutter = self.cutter();
        let (l, r, q) = (cutter.centres.value(), cutter.radius.value(), cutter.ratio - 1.0);
        (l - r * q * q) / (l * self.base().powi(2))
    }

    /// Likewise of the one across: aY* = (l−r)/(2·l·M) at R = 2.
    pub fn largest_convex_across(&self) -> f64 {
        let cutter = self.cutter();
        let (l, r, q) = (cutter.centres.value(), cutter.radius.value(), cutter.ratio - 1.0);
        (l - r * q * q) / (2.0 * l * self.base())
    }

    /// The a that is flattest, by golden section between nothing and four times the largest convex
    /// one, and how flat it is.
    pub fn flattest(&self, swings: impl Fn(&Self, f64) -> Swings, convex: f64) -> (f64, Length) {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let flat = |a: f64| self.flatness(&swings(self, a));
        let (mut low, mut high) = (0.0, 4.0 * convex);
        for _ in 0..60 {
            let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
            if flat(a) < flat(b) { high = b } else { low = a }
        }
        let a = f64::midpoint(low, high);
        (a, flat(a))
    }
}

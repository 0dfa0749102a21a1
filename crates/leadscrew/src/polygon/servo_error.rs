//! What the drives may leave of a facet that is flat by its numbers: the servo error, stated beside
//! every claim.
//!
//! ```text
//!   ordered ─► G as the machine's file says ─► expected                       flatness, size
//!        │
//!        ├─► G by half as far from 1 again, in each direction ─► worst ─┐
//!        ├─► X stands at either end of its friction and play ► worst ─┤
//!        ├─► screw's and encoder's errors: where X stands, slope ► worst ─┤
//!        ├─► screw 15 % softer or stiffer ───────────────────► worst ─┤     each less what is expected, summed:
//!        ├─► friction and play 20 % more or less ─────────────► worst ─┼──►  the cut differs by no more
//!        └─► what reversals leave: lead that comes late,              │
//!            stretch and force that are not as believed ──────► worst ─┘
//! ```
//!
//! At a reversal friction and play change sides. The motor has to get ahead by w(t) = F(t)/k ± b/2;
//! F(t) by the bristles of LuGre along the ordered motion, harmonic by harmonic through the loops
//! ([`super::servo`]). Sums of what each cause can do alone, all at their worst together: a bound,
//! several times what is usual.
use control::polygon::Servo;
use control::polygon::Slide;
use control::polygon::drives::{self, Answer, FRICTION, STIFFNESS};
use forms::polygon::{Actuator, Cut, Form, Series, Swings, Term};
use std::f64::consts::{FRAC_PI_2, TAU};
use store::machine::{Axis, MachineFile, Motor, PositionFrom, eccentric};
use sync::{Complex, Spectrum};
use units::{Length, Spin};

/// How well a loop's answer is known, as a share of what it differs from one: by the machine's
/// file, and measured.
const BY_FILE: f64 = 0.5;
const MEASURED: f64 = 0.1;
/// Play changes sides over this share of the friction.
const PLAY_CROSSING: f64 = 0.25;
/// Steps of a period, and harmonics, in which a reversal is looked at.
const STEPS: usize = 1024;
const HARMONICS: usize = 96;
/// Periods until friction has forgotten where it began.
const PERIODS: usize = 3;

/// By how much a cut may differ from what is claimed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoError {
    /// Flatness.
    pub flatness: Length,
    /// Across flats, either way.
    pub across_flats: Length,
}

/// A block's swings on a machine.
pub(super) struct Swung<'a> {
    pub(super) machine: &'a MachineFile,
    pub(super) form: &'a Form,
    pub(super) work: Spin,
    pub(super) ordered: &'a Swings,
    /// What air cuts have shown of each series' loop, harmonic by harmonic.
    pub(super) measured: Vec<Vec<[f64; 2]>>,
}

/// Errors of position of an axis: once per turn of its screw (amplitude, mm), growing with the way,
/// and the steepest of both.
struct Pitch {
    wobble: f64,
    cumulative: f64,
    slope: f64,
}

/// The ways in which one cause may change a motion; one of them comes about.
type Ways = Vec<Swings>;

impl Swung<'_> {
    /// What is expected to come of it; `None`: the machine lacks what swings.
    pub(super) fn expected(&self) -> Option<Swings> {
        self.through(None, &|_, g, _| g)
    }

    /// By how much the cut may differ from what is expected; `None`: some facet is not cut at all
    /// then.
    pub(super) fn error(&self) -> Option<ServoError> {
        let expected = self.expected()?;
        let nominal = self.form.cut(&expected)?;
        let mut sum = (self.counts(), 2.0 * self.misplaced());
        for ways in self.causes(&expected)? {
            let cuts: Option<Vec<Cut>> = ways.iter().map(|way| self.form.cut(way)).collect();
            let worst = |of: fn(&Cut, &Cut) -> f64| {
                cuts.iter().flatten().map(|cut| of(cut, &nominal)).fold(0.0, f64::max)
            };
            sum.0 += worst(|cut, nominal| (cut.flatness - nominal.flatness).value());
            sum.1 += worst(|cut, nominal| (cut.across_flats - nominal.across_flats).value().abs());
            cuts.as_ref()?;
        }
        Some(ServoError { flatness: Length::mm(sum.0), across_flats: Length::mm(sum.1) })
    }

    /// Every cause of a difference.
    fn causes(&self, expected: &Swings) -> Option<Vec<Ways>> {
        let stands = |sign: f64| {
            let term = Term { per_turn: 0.0, cosine: sign * self.standing(), sine: 0.0 };
            with(expected, Actuator::CentreLine, &[term], 1.0)
        };
        let mut all = vec![vec![stands(1.0), stands(-1.0)]];
        for (k, series) in self.ordered.0.iter().enumerate().filter(|(_, s)| s.swings()) {
            let known = if self.measured[k].is_empty() { BY_FILE } else { MEASURED };
            let ways = (0..4).map(|quarter| {
                let by = Complex::polar(known, f64::from(quarter) / 4.0);
                self.through(Some(k), &|_, g, _| g + (Complex::ONE - g) * by)
            });
            all.push(ways.collect::<Option<Ways>>()?);
            let Some(axis) = self.axis(series.actuator) else { continue };
            let Answer::Sliding(servo, believed) = self.answer(series.actuator)? else { continue };
            let plants = [
                [1.0 - STIFFNESS, 1.0, 1.0],
                [1.0 + STIFFNESS, 1.0, 1.0],
                [1.0, 1.0 - FRICTION, 1.0 - FRICTION],
                [1.0, 1.0 + FRICTION, 1.0 + FRICTION],
            ];
            let ways = plants.map(|factors| {
                let slide = believed.with(factors);
                self.through(Some(k), &|_, g, hz| {
                    g * servo.sliding(hz, &slide, &believed)
                        / servo.sliding(hz, &believed, &believed)
                })
            });
            let slope = self.pitch(axis).slope;
            let ways_of_pitch =
                [1.0 - slope, 1.0 + slope].map(|by| self.through(Some(k), &|_, g, _| g * by));
            all.push(ways_of_pitch.into_iter().collect::<Option<Ways>>()?);
            let [softer, stiffer, less, more] = ways;
            all.push(vec![softer?, stiffer?]);
            all.push(vec![less?, more?]);
            for left in self.reversals(series, axis, &servo, &believed) {
                all.push(
                    [1.0, -1.0].map(|sign| with(expected, series.actuator, &left, sign)).into(),
                );
            }
        }
        Some(all)
    }

    /// What is ordered through the loops; the series `changed` through other ones.
    fn through(
        &self,
        changed: Option<usize>,
        other: &dyn Fn(&Term, Complex, f64) -> Complex,
    ) -> Option<Swings> {
        let through = |(k, series): (usize, &Series)| {
            let answer = self.answer(series.actuator)?;
            let term = |term: &Term| {
                if term.per_turn == 0.0 {
                    return *term;
                }
                let hz = term.per_turn * self.work.abs().value();
                let number = (term.per_turn / self.form.base()).round() as usize;
                let known = self.measured[k].get(number.saturating_sub(1));
                let known = known.map(|[re, im]| Complex { re: *re, im: *im });
                let g = answer.at(hz, known);
                let g = if changed == Some(k) { other(term, g, hz) } else { g };
                let came = Complex { re: term.cosine, im: -term.sine } * g;
                Term { cosine: came.re, sine: -came.im, ..*term }
            };
            let terms = series.terms.iter().map(term).collect();
            Some(Series { actuator: series.actuator, terms })
        };
        self.ordered.0.iter().enumerate().map(through).collect::<Option<Vec<_>>>().map(Swings)
    }

    fn answer(&self, actuator: Actuator) -> Option<Answer> {
        Answer::new(self.machine, actuator, self.form, self.work)
    }

    fn axis(&self, actuator: Actuator) -> Option<&Axis> {
        let canon::Oscillating::Axis(letter) = drives::on(actuator) else { return None };
        self.machine.axes.iter().flatten().find(|axis| axis.letter == letter)
    }

    /// What reversals of a slide leave: of the lead that comes late, of a stretch that is not as
    /// believed, of a force that is not.
    fn reversals(
        &self,
        series: &Series,
        axis: &Axis,
        servo: &Servo,
        slide: &Slide,
    ) -> [Vec<Term>; 3] {
        let base = self.form.base();
        let [force, play] = along(series, axis, base, self.work);
        let stiffness = axis.structure.stiffness.value();
        let harmonics = |nodes: &[f64]| Spectrum::of(nodes, HARMONICS).harmonics;
        let (force, play) = (harmonics(&force), harmonics(&play));
        let terms = |of: &dyn Fn(Complex, Complex, f64) -> Complex| {
            let pairs = force.iter().zip(&play).enumerate().skip(1);
            let term = |(m, (force, play)): (usize, (&Complex, &Complex))| {
                let per_turn = base * m as f64;
                let c = of(*force, *play, per_turn * self.work.abs().value()) * 2.0;
                Term { per_turn, cosine: c.re, sine: -c.im }
            };
            pairs.map(term).collect::<Vec<Term>>()
        };
        let stretch = |force: Complex, play: Complex| force * (1.0 / stiffness) + play;
        [
            terms(&|force, play, hz| stretch(force, play) * servo.lead_lost(hz, slide)),
            terms(&|force, play, _| stretch(force * (STIFFNESS + FRICTION), play * FRICTION)),
            terms(&|force, _, hz| force * servo.gives(hz, slide) * (FRICTION * 1e3)),
        ]
    }

    /// What encoders do not tell apart, mm on a facet.
    fn counts(&self) -> f64 {
        let count = |series: &Series| match self.axis(series.actuator).map(|a| a.position_from) {
            Some(
                PositionFrom::Motor { resolution, .. } | PositionFrom::Scale { resolution, .. },
            ) => resolution.value(),
            None => self.machine.spindles.get(1).map_or(0.0, |spindle| {
                let turn = TAU * self.form.tip_radius.value();
                turn / f64::from(spindle.encoder_counts_per_rev) * self.widest()
            }),
        };
        self.ordered.0.iter().map(count).sum()
    }

    /// Sine of the angle that the tool turns from the middle of a facet to its corner.
    fn widest(&self) -> f64 {
        let facets = self.form.kinds();
        let half = facets.iter().map(|f| f.to.value().max(-f.from.value())).fold(0.0, f64::max);
        (half / self.form.tip_radius.value()).min(FRAC_PI_2).sin()
    }

    /// How far X may stand from where its encoder says, by its screw or scale, mm; its zero was
    /// touched off as much off.
    fn misplaced(&self) -> f64 {
        self.axis(Actuator::CentreLine).map_or(0.0, |axis| {
            let distance = self.form.across_flats.value() / 2.0 + self.form.tip_radius.value();
            let pitch = self.pitch(axis);
            2.0 * pitch.wobble + pitch.cumulative * distance
        })
    }

    /// Errors of an axis' screw and encoder, as far as machines of this kind have them.
    fn pitch(&self, axis: &Axis) -> Pitch {
        let plant = &self.machine.scatter;
        let off = Length::mm(plant.encoder_eccentricity.by);
        match (axis.position_from, axis.drive.motor) {
            (PositionFrom::Motor { .. }, Motor::BallScrew { lead, .. }) => {
                let reading = eccentric(off, self.machine.simulation.graduations.motor);
                let wobble = plant.screw_wobble.by + (lead * reading).value();
                let cumulative = plant.screw_lead.by;
                Pitch { wobble, cumulative, slope: TAU * wobble / lead.value() + cumulative }
            }
            _ => {
                Pitch { wobble: 0.0, cumulative: plant.scale_error.by, slope: plant.scale_error.by }
            }
        }
    }

    /// How far from where it is believed X may stand, between the ends of its friction and play,
    /// mm.
    fn standing(&self) -> f64 {
        self.axis(Actuator::CentreLine).map_or(0.0, |axis| {
            let held = axis.friction.static_force.value() / axis.structure.stiffness.value();
            held + axis.structure.backlash.value() / 2.0
        })
    }
}

/// A motion with something on top of it.
fn with(motion: &Swings, actuator: Actuator, terms: &[Term], sign: f64) -> Swings {
    let signed = |t: &Term| Term { cosine: sign * t.cosine, sine: sign * t.sine, ..*t };
    let top = Series { actuator, terms: terms.iter().map(signed).collect() };
    Swings(motion.0.iter().cloned().chain([top]).collect())
}

/// Friction (N), and which way half the play is taken up (mm), over a period of the ordered motion.
fn along(series: &Series, axis: &Axis, base: f64, work: Spin) -> [Vec<f64>; 2] {
    let friction = &axis.friction;
    let (coulomb, bristles) = (friction.coulomb.value(), friction.bristle_stiffness.value());
    let excess = (friction.static_force.value() - coulomb).max(0.0);
    let half_play = axis.structure.backlash.value() / 2.0;
    let w = work.in_rad_per_s();
    let motion = series.over_a_period(base, STEPS);
    let mut bent = 0.0;
    let (mut forces, mut plays) = (Vec::new(), Vec::new());
    for _ in 0..PERIODS {
        (forces, plays) = (Vec::with_capacity(STEPS), Vec::with_capacity(STEPS));
        for (i, now) in motion.iter().enumerate() {
            let way = now[0] - motion[(i + STEPS - 1) % STEPS][0];
            let slow = (now[1] * w / friction.stribeck_speed.value()).powi(2);
            let slip = (coulomb + excess * (-slow).exp()).max(1e-9);
            let end = slip * way.signum();
            bent = end + (bent - end) * (-bristles * way.abs() / slip).exp();
            let pull = bent + axis.moving_mass.value() * 1e-3 * now[2] * w * w;
            forces.push(bent);
            let side = pull / (PLAY_CROSSING * coulomb.max(1.0));
            plays.push(half_play * side.clamp(-1.0, 1.0));
        }
    }
    [forces, plays]
}

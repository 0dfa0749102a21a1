//! Ground cams: the contour that came out, from where the wheel's edge came nearest to the work's axis.
//!
//! ```text
//!   e(θ) = X(θ) + deflection − (centre + D(θ − phase))      D: the profile that was asked
//!
//!   contour error   max |e|, rms e      along X, the wheel's edge against the profile
//!   phase error     Δ = −Σ e·D′ / Σ D′²  over equal steps of θ: by how much all of it is late
//!   run-out         spread of e where the profile is at its lowest (the base circle)
//!   speed error     max |de/dθ|          what a follower on this cam would feel, µm for each degree
//!   waviness        largest amplitude of e at 30 to 180 waves a turn: where chatter is
//! ```
//!
//! What is ground off stays off, so of all turns the nearest place counts at each angle; the wheel's edge is the axis and
//! what the work presses it back. A wheel's wear is not known here: it shows as material that is left.
use crate::Config;
use crate::feature::{Feature, FeatureKind, Verdict};
use bus::Sample;
use canon::{CamOrder, CamProfile};
use std::collections::VecDeque;
use std::f64::consts::TAU;
use units::{Angle, Length, Spin, Time};

/// Steps of a turn at which the contour is looked at.
pub(crate) const STEPS: usize = 720;
/// How near to its lowest point the profile is on the base circle, mm.
const BASE: f64 = 0.5e-3;
/// Waves a turn in which chatter shows.
const CHATTER: std::ops::RangeInclusive<usize> = 30..=180;

/// A ground cam, measured.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundCam {
    /// Number of the profile.
    pub profile: u32,
    /// Its name.
    pub name: String,
    /// Speed of the work.
    pub spin: Spin,
    /// Turns since the wheel came.
    pub turns: Angle,
    /// By how much the contour is late.
    pub phase_error: Angle,
    /// Largest contour error, magnitude.
    pub contour_error_max: Length,
    /// Its root mean square.
    pub contour_error_rms: Length,
    /// Spread of the error on the base circle; `None`: the profile has none.
    pub run_out: Option<Length>,
    /// Largest change of the error for each degree.
    pub speed_error_per_deg: Length,
    /// Largest amplitude of a wave in the band of chatter, and how many of it a turn.
    pub waviness: (Length, usize),
    /// The error at equal steps of the profile's angle; empty if the last turn was not whole.
    pub errors: Vec<Length>,
    /// The profile at the same steps, above its lowest point.
    pub lift: Vec<Length>,
}

/// What the program orders of one cam.
#[derive(Clone, Debug)]
pub(crate) struct Ordered {
    profile: u32,
    phase: Angle,
    centre: Length,
    spin: Spin,
}

/// The profile in force while ops come in.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Selected(Option<(u32, Angle, Length)>);

impl Selected {
    /// What an order makes of it; a grinding one begins a feature.
    pub(crate) fn see(&mut self, order: &CamOrder) -> Option<Ordered> {
        match *order {
            CamOrder::Select { profile, phase, centre } => self.0 = Some((profile, phase, centre)),
            CamOrder::Deselect => self.0 = None,
            CamOrder::Grind { spin, .. } => {
                let (profile, phase, centre) = self.0?;
                return Some(Ordered { profile, phase, centre, spin });
            }
            CamOrder::Compensate
            | CamOrder::ResetSampling
            | CamOrder::StartSampling
            | CamOrder::StorePhase
            | CamOrder::SparkOut { .. } => {}
        }
        None
    }
}

/// Where the wheel's edge came nearest to the work's axis, at each step of the turn.
#[derive(Clone, Debug)]
pub(crate) struct CamTrack {
    phase: f64,
    began: Option<(Time, Angle)>,
    last: Angle,
    /// The last four samples: angle of the work and place of the wheel's edge.
    recent: VecDeque<(f64, f64)>,
    nearest: Vec<f64>,
}

impl CamTrack {
    pub(crate) fn new(ordered: &Ordered) -> Self {
        Self {
            phase: ordered.phase.value(),
            began: None,
            last: Angle::ZERO,
            recent: VecDeque::with_capacity(5),
            nearest: vec![f64::INFINITY; STEPS],
        }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        let angle = sample.spindle(0);
        let deflection = sample.truth.as_ref().map_or(Length::ZERO, |t| t.tool_deflection);
        self.began.get_or_insert((sample.feedback.time, angle));
        self.last = angle;
        let turn = angle.value() - self.phase;
        self.recent.push_back((turn, (sample.axis(0) + deflection).value()));
        if self.recent.len() < 4 {
            return;
        }
        let (here, next) = (self.recent[1].0, self.recent[2].0);
        let steps = STEPS as f64;
        let (low, high) = (here.min(next) * steps, here.max(next) * steps);
        let mut step = low.ceil();
        // a leap of more than a turn in a period is no motion of a machine
        while step < high && high - low < steps {
            let f = (step / steps - here) / (next - here);
            let place = lagrange([0, 1, 2, 3].map(|k| self.recent[k].1), f);
            let index = step.rem_euclid(steps) as usize % STEPS;
            self.nearest[index] = self.nearest[index].min(place);
            step += 1.0;
        }
        self.recent.pop_front();
    }

    pub(crate) fn finish(
        self,
        op: u32,
        line: u32,
        ordered: &Ordered,
        config: &Config,
        now: Time,
    ) -> Feature {
        let (time, from) = self.began.unwrap_or((now, Angle::ZERO));
        let mut cam = GroundCam {
            profile: ordered.profile,
            name: format!("P{}", ordered.profile),
            spin: ordered.spin,
            turns: (self.last - from).abs(),
            phase_error: Angle::ZERO,
            contour_error_max: Length::mm(f64::NAN),
            contour_error_rms: Length::mm(f64::NAN),
            run_out: None,
            speed_error_per_deg: Length::mm(f64::NAN),
            waviness: (Length::ZERO, 0),
            errors: Vec::new(),
            lift: Vec::new(),
        };
        let mut findings = Vec::new();
        let whole = self.nearest.iter().all(|x| x.is_finite());
        match config.cams.get(ordered.profile) {
            None => {
                findings.push(format!("profile P{} is not known to the judge", ordered.profile));
            }
            Some(_) if !whole => {
                findings.push("the work did not turn once while the wheel was in".to_owned());
            }
            Some(profile) => measure(&mut cam, profile, &self.nearest, ordered.centre),
        }
        let limit = config.tolerances.cam_contour;
        if cam.contour_error_max > limit {
            findings.push(format!(
                "the contour is off by {:.1} µm, {:.1} µm are allowed",
                cam.contour_error_max.in_um(),
                limit.in_um()
            ));
        }
        Feature {
            op,
            line,
            tool: None,
            time,
            duration: now - time,
            verdict: Verdict::from_findings(&findings),
            kind: FeatureKind::Cam(Box::new(cam)),
        }
    }
}

/// The cubic through four values at −1, 0, 1, 2.
fn lagrange([a, b, c, d]: [f64; 4], f: f64) -> f64 {
    -f * (f - 1.0) * (f - 2.0) / 6.0 * a + (f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0 * b
        - (f + 1.0) * f * (f - 2.0) / 2.0 * c
        + (f + 1.0) * f * (f - 1.0) / 6.0 * d
}

/// A profile's value at a step, whatever its own number of nodes.
fn asked(profile: &CamProfile, step: usize) -> f64 {
    let n = profile.nodes.len();
    let place = step as f64 / STEPS as f64 * n as f64;
    let (whole, f) = (place as usize, place.fract());
    let at = |k: usize| profile.nodes[(whole + n + k - 1) % n];
    lagrange([at(0), at(1), at(2), at(3)], f)
}

fn measure(cam: &mut GroundCam, profile: &CamProfile, places: &[f64], centre: Length) {
    let ideal: Vec<f64> = (0..STEPS).map(|step| asked(profile, step)).collect();
    let errors: Vec<f64> = places.iter().zip(&ideal).map(|(x, d)| x - centre.value() - d).collect();
    let n = STEPS as f64;
    let around = |v: &[f64], i: usize| (v[(i + 1) % STEPS] - v[(i + STEPS - 1) % STEPS]) / 2.0;
    let mean = errors.iter().sum::<f64>() / n;
    let (mut lag, mut steep) = (0.0, 0.0);
    let mut speed: f64 = 0.0;
    for i in 0..STEPS {
        let slope = around(&ideal, i) * n;
        lag -= (errors[i] - mean) * slope;
        steep += slope * slope;
        speed = speed.max(around(&errors, i).abs() * n / 360.0);
    }
    let lowest = ideal.iter().copied().fold(f64::INFINITY, f64::min);
    let base: Vec<f64> =
        errors.iter().zip(&ideal).filter(|(_, d)| **d < lowest + BASE).map(|(e, _)| *e).collect();
    cam.name.clone_from(&profile.name);
    cam.phase_error = Angle::rev(if steep > 0.0 { lag / steep } else { 0.0 });
    cam.contour_error_max = Length::mm(errors.iter().fold(0.0, |a: f64, e| a.max(e.abs())));
    cam.contour_error_rms = Length::mm((errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt());
    // a base circle is a stretch of at least an eighth of a turn; a lobe has none
    cam.run_out = (base.len() >= STEPS / 8).then(|| {
        let (low, high) = base
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| (a.min(*e), b.max(*e)));
        Length::mm(high - low)
    });
    cam.speed_error_per_deg = Length::mm(speed);
    let waves = CHATTER.map(|k| (amplitude(&errors, k), k));
    let (size, k) = waves.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0));
    cam.waviness = (Length::mm(size), k);
    cam.errors = errors.into_iter().map(Length::mm).collect();
    cam.lift = ideal.into_iter().map(|d| Length::mm(d - lowest)).collect();
}

/// Amplitude of the wave with k periods a turn.
fn amplitude(values: &[f64], k: usize) -> f64 {
    let n = values.len() as f64;
    let (re, im) = values.iter().enumerate().fold((0.0, 0.0), |(re, im), (i, v)| {
        let (sin, cos) = (TAU * (k * i) as f64 / n).sin_cos();
        (re + v * cos, im + v * sin)
    });
    2.0 * re.hypot(im) / n
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::{CamLibrary, ToolLibrary};

    const CENTRE: Length = Length::mm(-250.0);

    fn lift(turn: f64) -> f64 {
        220.0 + 4.0 * (TAU * turn).cos()
    }

    /// A cam whose wheel ran where `x` says, at 60 rpm and 250 µs, judged.
    fn judged(x: impl Fn(f64) -> f64) -> (Feature, GroundCam) {
        let nodes = (0..STEPS).map(|i| lift(i as f64 / STEPS as f64)).collect();
        let profile = CamProfile { number: 7, name: "eccentric".into(), nodes };
        let config =
            Config { cams: CamLibrary::new([profile]), ..Config::new(ToolLibrary::default()) };
        let ordered =
            Ordered { profile: 7, phase: Angle::deg(30.0), centre: CENTRE, spin: Spin::rpm(60.0) };
        let mut track = CamTrack::new(&ordered);
        for i in 0..12_000 {
            let turn = f64::from(i) * 250e-6 + 0.1;
            let mut sample = Sample::default();
            sample.feedback.spindles[0].angle = Angle::rev(turn);
            sample.feedback.axes[0].position = CENTRE + Length::mm(x(turn));
            track.sample(&sample);
        }
        let ordered =
            Ordered { profile: 7, phase: Angle::deg(30.0), centre: CENTRE, spin: Spin::rpm(60.0) };
        let feature = track.finish(3, 4, &ordered, &config, Time::s(3.0));
        let FeatureKind::Cam(cam) = feature.kind.clone() else { panic!("a cam") };
        (feature, *cam)
    }

    fn ideal(turn: f64) -> f64 {
        lift(turn - 30.0 / 360.0)
    }

    #[test]
    fn a_wheel_on_the_profile_makes_a_perfect_cam() {
        let (feature, cam) = judged(ideal);
        assert!(feature.verdict.is_pass());
        assert!(cam.contour_error_max.in_um() < 1e-3, "{cam:?}");
        assert!((cam.turns.value() - 3.0).abs() < 0.01);
    }

    #[test]
    fn a_lag_is_a_phase_error_and_a_contour_error_of_slope_times_lag() {
        let lag = 0.2;
        let (feature, cam) = judged(|turn| ideal(turn - lag / 360.0));
        assert!((cam.phase_error.in_deg() - lag).abs() < 1e-4, "{}", cam.phase_error.in_deg());
        let expected = 4.0 * TAU * lag / 360.0;
        assert!((cam.contour_error_max.value() - expected).abs() < 1e-5);
        let per_degree = expected * TAU / 360.0;
        assert!((cam.speed_error_per_deg.value() - per_degree).abs() < 1e-6);
        assert!(!feature.verdict.is_pass());
    }

    #[test]
    fn chatter_is_found_with_its_waves_a_turn() {
        let (_, cam) = judged(|turn| ideal(turn) + 0.002 * (TAU * 83.0 * turn).sin());
        assert_eq!(cam.waviness.1, 83);
        assert!((cam.waviness.0.in_um() - 2.0).abs() < 0.02);
    }
}

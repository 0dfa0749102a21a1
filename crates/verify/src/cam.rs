//! Ground cams: the contour that came out, from where the wheel's edge came nearest to the work's
//! axis.
//!
//! ```text
//!   e(θ) = X(θ) + deflection − (centre + D(θ − phase))      D: the profile that was asked
//!
//!   contour error   max |e|, rms e      along X, the wheel's edge against the profile
//!   phase error     Δ = −Σ e·D′ / Σ D′²  over equal steps of θ: by how much all of it is late
//!   run-out         spread of e where the profile is at its lowest (the base circle)
//!   speed error     max |de/dθ|          what a follower on this cam would feel, µm for each degree
//!   waviness        largest amplitude of e at 30 to 180 waves a turn: where chatter is
//!   removal rate    (ds/dθ)·ω, the contact's speed along the contour, its peak over its mean in the last turn
//! ```
//!
//! The contour is the parallel curve of the wheel centre's path p: ds/dθ = |p′| − R·α′, with α the
//! direction of p′.
//!
//! What is ground off stays off, so of all turns the nearest place counts at each angle; the
//! wheel's edge is the axis and what the work presses it back. A wheel's wear is not known here: it
//! shows as material that is left.
mod again;
mod contour;

pub(crate) use again::Cams;

use crate::Config;
use crate::contact::{Contact, shifted, unknown};
use crate::feature::Feature;
use crate::judged::Judged;
use crate::undone::Undone;
use crate::verdict::Verdict;
use again::CutCam;
use bus::Sample;
use canon::CamOrder;
use contour::{Contour, lagrange};
use std::collections::VecDeque;
use units::{Angle, Force, Length, Spin, Time, Torque};

/// Steps of a turn at which the contour is looked at.
pub(crate) const STEPS: usize = 720;

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
    /// Greatest removal rate over its mean, in the last turn; 1 is even.
    pub removal_peak: f64,
    /// The same if the work had turned evenly.
    pub removal_peak_even: f64,
    /// The error at equal steps of the profile's angle; empty if the last turn was not whole.
    pub errors: Vec<Length>,
    /// The profile at the same steps, above its lowest point.
    pub lift: Vec<Length>,
}

/// What the program orders of one cam.
#[derive(Clone, Debug)]
pub(crate) struct OrderedCam {
    profile: u32,
    phase: Angle,
    centre: Length,
    zero: Length,
    /// What is taken off, along X on the radius.
    stock: Length,
    spin: Spin,
}

/// The profile in force while ops come in.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Selected(Option<(u32, Angle, [Length; 2])>);

impl OrderedCam {
    pub(crate) const fn phase(&self) -> f64 {
        self.phase.value()
    }
}

impl Selected {
    /// The profile in force, turned at a speed.
    pub(crate) fn turned(&self, spin: Spin) -> Option<OrderedCam> {
        let (profile, phase, [centre, zero]) = self.0?;
        Some(OrderedCam { profile, phase, centre, zero, stock: Length::ZERO, spin })
    }

    /// What an order makes of it; a grinding one begins a feature.
    pub(crate) fn see(&mut self, order: &CamOrder) -> Option<OrderedCam> {
        match *order {
            CamOrder::Select { profile, phase, centre, zero } => {
                self.0 = Some((profile, phase, [centre, zero]));
            }
            CamOrder::Deselect => self.0 = None,
            CamOrder::Grind { spin, stock, .. } => {
                return self.turned(spin).map(|ordered| OrderedCam { stock, ..ordered });
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
    /// Where the wheel stood along the work, mm.
    z: f64,
    began: Option<(Time, Angle)>,
    last: Angle,
    /// The last four samples.
    recent: VecDeque<Seen>,
    nearest: Vec<f64>,
    /// Speed of the work when each step was passed last, rev/s.
    spins: Vec<f64>,
    torque_max: Option<Torque>,
    force_max: Option<Force>,
}

/// One sample: when, the turn of the profile, the place of the wheel's edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) time: f64,
    pub(crate) turn: f64,
    pub(crate) edge: f64,
}

impl Seen {
    /// Of a profile that begins at an angle of the work.
    pub(crate) fn of(sample: &Sample, phase: f64) -> Self {
        let deflection = sample.truth.as_ref().map_or(Length::ZERO, |t| t.tool_deflection);
        Self {
            time: sample.feedback.time.value(),
            turn: sample.spindle(0).value() - phase,
            edge: (sample.axis(0).of_linear() + deflection).value(),
        }
    }
}

impl CamTrack {
    pub(crate) fn new(ordered: &OrderedCam) -> Self {
        Self {
            phase: ordered.phase.value(),
            z: 0.0,
            began: None,
            last: Angle::ZERO,
            recent: VecDeque::with_capacity(5),
            nearest: vec![f64::INFINITY; STEPS],
            spins: vec![0.0; STEPS],
            torque_max: None,
            force_max: None,
        }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        let angle = sample.spindle(0);
        self.began.get_or_insert((sample.feedback.time, angle));
        self.z = sample.axis(2).value();
        self.last = angle;
        if let Some(truth) = &sample.truth {
            let (torque, force) = (truth.cutting_torque.abs(), truth.cutting_force.abs());
            self.torque_max = Some(self.torque_max.map_or(torque, |most| most.max(torque)));
            self.force_max = Some(self.force_max.map_or(force, |most| most.max(force)));
        }
        self.see(Seen::of(sample, self.phase));
    }

    pub(crate) fn see(&mut self, seen: Seen) {
        self.recent.push_back(seen);
        if self.recent.len() < 4 {
            return;
        }
        let (here, next) = (self.recent[1].turn, self.recent[2].turn);
        let (first, last) = (self.recent[0], self.recent[3]);
        let spin = (last.turn - first.turn) / (last.time - first.time);
        let steps = STEPS as f64;
        let (low, high) = (here.min(next) * steps, here.max(next) * steps);
        let mut step = low.ceil();
        // a leap of more than a turn in a period is no motion of a machine
        while step < high && high - low < steps {
            let f = (step / steps - here) / (next - here);
            let place = lagrange([0, 1, 2, 3].map(|k| self.recent[k].edge), f);
            let index = step.rem_euclid(steps) as usize % STEPS;
            self.nearest[index] = self.nearest[index].min(place);
            self.spins[index] = spin;
            step += 1.0;
        }
        self.recent.pop_front();
    }

    /// What the last turn would have ground, of a wheel that stood clear of its profile's top at
    /// `stands`.
    pub(crate) fn idle(&self, ordered: &OrderedCam, config: &Config, stands: Length) -> GroundCam {
        let mut cam = blank(ordered, Angle::rev(1.0));
        let whole = self.nearest.iter().all(|x| x.is_finite());
        if let Some(profile) = config.cams.get(ordered.profile).filter(|_| whole) {
            self.contour().measure(&mut cam, profile, stands - profile.top());
        }
        cam
    }

    /// Judges a cam, which stands from now on among the others; with what it does to those that are
    /// no longer among the features.
    pub(crate) fn finish(
        mut self,
        (op, line): (u32, u32),
        ordered: &OrderedCam,
        config: &Config,
        (cams, features): (&mut Cams, &mut [Feature]),
        now: Time,
    ) -> (Judged<GroundCam>, Vec<Undone>) {
        // the shaft turns about the axis that the set-up states, wherever the program has it
        let centre = config.stock.map_or(ordered.centre, |stock| stock.zero[0]);
        let profile = config.cams.get(ordered.profile);
        let by =
            (config.wheel_width.map_or(0.0, Length::value), config.tolerances.cam_contour.value());
        let asked = profile.map(|profile| contour::asked_over(profile, centre, self.shift()));
        let own = self.nearest.clone();
        let goes_on = asked.as_ref().is_some_and(|asked| cams.go_on(&mut self, asked, by));
        let nearest = self.over_the_work(&own);
        let is_whole = self.nearest.iter().all(|x| x.is_finite());
        let z = self.z;
        let mut found = self.judge((op, line), ordered, config, (goes_on, &own), now);
        let (Some(asked), true) = (asked, is_whole) else { return (found, Vec::new()) };
        let name = found.kind.name.clone();
        let new = CutCam { op: Some(op), line, name, z, asked, nearest, spoilt: None };
        let undone = cams.add(&mut found, new, features, by);
        (found, undone)
    }

    fn judge(
        self,
        (op, line): (u32, u32),
        ordered: &OrderedCam,
        config: &Config,
        (goes_on, own): (bool, &[f64]),
        now: Time,
    ) -> Judged<GroundCam> {
        let (time, from) = self.began.unwrap_or((now, Angle::ZERO));
        let mut cam = blank(ordered, (self.last - from).abs());
        let mut findings = Vec::new();
        let whole = own.iter().all(|x| x.is_finite());
        let centre = config.stock.map_or(ordered.centre, |stock| stock.zero[0]);
        if let Some(stock) = &config.stock {
            let zero = [ordered.centre, stock.zero[1], ordered.zero];
            findings.extend(shifted(zero, stock, config.tolerances.position));
        }
        match config.cams.get(ordered.profile) {
            None => {
                findings.push(format!("profile P{} is not known to the judge", ordered.profile));
            }
            Some(_) if !whole => {
                findings.push("the work did not turn once while the wheel was in".to_owned());
            }
            Some(profile) => self.contour().measure(&mut cam, profile, centre),
        }
        let contact = self.contact(&cam, ordered, config);
        findings.extend(not_cut(&contact).filter(|_| !goes_on));
        let limit = config.tolerances.cam_contour;
        if cam.contour_error_max > limit {
            findings.push(format!(
                "the contour is off by {:.1} µm, {:.1} µm are allowed",
                cam.contour_error_max.in_um(),
                limit.in_um()
            ));
        }
        Judged {
            op,
            line,
            tool: None,
            time,
            duration: now - time,
            verdict: Verdict::unless(&findings, unknown(config.stock.as_ref())),
            contact,
            kind: cam,
        }
    }

    /// Steps between the profile's beginning and the work's zero.
    fn shift(&self) -> usize {
        (self.phase * STEPS as f64).round().rem_euclid(STEPS as f64) as usize % STEPS
    }

    /// The nearest places by steps of the work's turn.
    fn over_the_work(&self, own: &[f64]) -> Vec<f64> {
        let shift = self.shift();
        let nearest = |k: usize| {
            let step = (k + STEPS - shift) % STEPS;
            self.nearest[step].min(own[step])
        };
        (0..STEPS).map(nearest).collect()
    }
}

/// The wheel passed the work without touching it.
fn not_cut(contact: &Contact) -> Option<String> {
    let reach = contact.reach?;
    if reach <= Length::ZERO {
        return Some(format!(
            "not cut: the wheel came no nearer than {:.3} mm to the blank",
            -reach.value()
        ));
    }
    contact.unresisted()
}

/// A cam of which nothing is known yet.
fn blank(ordered: &OrderedCam, turns: Angle) -> GroundCam {
    GroundCam {
        profile: ordered.profile,
        name: format!("P{}", ordered.profile),
        spin: ordered.spin,
        turns,
        phase_error: Angle::ZERO,
        contour_error_max: Length::mm(f64::NAN),
        contour_error_rms: Length::mm(f64::NAN),
        run_out: None,
        speed_error_per_deg: Length::mm(f64::NAN),
        waviness: (Length::ZERO, 0),
        removal_peak: f64::NAN,
        removal_peak_even: f64::NAN,
        errors: Vec::new(),
        lift: Vec::new(),
    }
}

impl CamTrack {
    fn contour(&self) -> Contour<'_> {
        Contour { nearest: &self.nearest, spins: &self.spins }
    }

    /// How far the wheel's edge went into the blank, and what resisted it.
    fn contact(&self, cam: &GroundCam, ordered: &OrderedCam, config: &Config) -> Contact {
        let least = cam.errors.iter().map(|e| e.value()).fold(f64::INFINITY, f64::min);
        let reach =
            if least.is_finite() { ordered.stock - Length::mm(least) } else { Length::ZERO };
        Contact {
            reach: config.stock.map(|_| reach),
            torque: self.torque_max,
            force: self.force_max,
            torque_expected: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stock;
    use canon::{CamLibrary, CamProfile, ToolLibrary};
    use std::f64::consts::TAU;
    use units::Coordinate;

    const CENTRE: Length = Length::mm(-250.0);

    fn lift(turn: f64) -> f64 {
        220.0 + 4.0 * (TAU * turn).cos()
    }

    /// A shaft about the axis at `CENTRE`.
    fn stock() -> Stock {
        let mm = |v: [f64; 3]| v.map(Length::mm);
        Stock {
            from: mm([-300.0, -50.0, -100.0]),
            to: mm([-200.0, 50.0, 0.0]),
            zero: [CENTRE, Length::ZERO, Length::ZERO],
        }
    }

    fn ordered() -> OrderedCam {
        OrderedCam {
            profile: 7,
            phase: Angle::deg(30.0),
            centre: CENTRE,
            zero: Length::ZERO,
            stock: Length::mm(0.1),
            spin: Spin::rpm(60.0),
        }
    }

    /// A cam whose wheel ran where `x` says, at 60 rpm and 250 µs, judged.
    fn judged(x: impl Fn(f64) -> f64) -> (Judged<GroundCam>, GroundCam) {
        let nodes = (0..STEPS).map(|i| lift(i as f64 / STEPS as f64)).collect();
        let wheel = Length::mm(195.0);
        let profile =
            CamProfile { number: 7, name: "eccentric".into(), nodes, wheel, steepest: [0.0; 3] };
        let config = Config {
            cams: CamLibrary::new([profile]),
            stock: Some(stock()),
            ..Config::new(ToolLibrary::default())
        };
        let ordered = ordered();
        let mut track = CamTrack::new(&ordered);
        for i in 0..12_000 {
            let turn = f64::from(i) * 250e-6 + 0.1;
            let mut sample = Sample::default();
            sample.feedback.time = Time::s(f64::from(i) * 250e-6);
            sample.feedback.spindles[0].angle = Angle::rev(turn);
            sample.feedback.axes[0].position = Coordinate::linear(CENTRE + Length::mm(x(turn)));
            track.sample(&sample);
        }
        let works = (&mut Cams::default(), &mut [][..]);
        let (feature, _) = track.finish((3, 4), &ordered, &config, works, Time::s(3.0));
        let cam = feature.kind.clone();
        (feature, cam)
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
    fn a_wheel_that_stays_clear_of_its_blank_has_ground_nothing() {
        let (feature, _) = judged(|turn| ideal(turn) + 5.0);
        let reason = feature.verdict.reason().unwrap_or_default();
        assert!(reason.contains("not cut: the wheel came no nearer than 4.900 mm"), "{reason}");
        assert!(!feature.contact.is_cut());
        // 0.1 mm is taken off a blank, to the micrometre
        let (feature, _) = judged(ideal);
        assert!((feature.contact.reach.map_or(0.0, units::Length::value) - 0.1).abs() < 1e-6);
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

    /// What a judge of one work says of cams ground one after the other, each with its lift, its
    /// angle and where the wheel stands along the work; and then of a wheel at a radius.
    fn one_after_the_other(
        cuts: &[(f64, f64, f64)],
        then: Option<[f64; 2]>,
    ) -> Vec<Judged<GroundCam>> {
        let profile = |number: u32, rise: f64| {
            let at = |i: usize| 220.0 + rise * (TAU * i as f64 / STEPS as f64).cos();
            let (nodes, wheel) = ((0..STEPS).map(at).collect(), Length::mm(195.0));
            CamProfile { number, name: format!("cam {number}"), nodes, wheel, steepest: [0.0; 3] }
        };
        let numbers = 1..;
        let config = Config {
            cams: CamLibrary::new(numbers.zip(cuts).map(|(n, (rise, ..))| profile(n, *rise))),
            stock: Some(stock()),
            wheel_width: Some(Length::mm(10.0)),
            ..Config::new(ToolLibrary::default())
        };
        let (mut cams, mut features) = (Cams::default(), Vec::<Feature>::new());
        let see = |turn: f64, x: f64, z: f64| {
            let mut sample = Sample::default();
            sample.feedback.time = Time::s(turn);
            sample.feedback.spindles[0].angle = Angle::rev(turn);
            sample.feedback.axes[0].position = Coordinate::linear(CENTRE + Length::mm(x));
            sample.feedback.axes[2].position = Coordinate::new(z);
            sample.report.line = 90;
            sample
        };
        for (op, (rise, deg, z)) in (1..).zip(cuts) {
            let (profile, phase) = (op, Angle::deg(*deg));
            let ordered = OrderedCam { profile, phase, ..ordered() };
            let mut track = CamTrack::new(&ordered);
            for i in 0..6000 {
                let turn = f64::from(i) / 2000.0;
                let x = 220.0 + rise * (TAU * (turn - deg / 360.0)).cos();
                track.sample(&see(turn, x, *z));
            }
            let works = (&mut cams, &mut features[..]);
            let (found, _) = track.finish((op, op), &ordered, &config, works, Time::s(3.0));
            features.push(found.map(Box::new).map(crate::FeatureKind::Cam));
        }
        if let Some([x, z]) = then {
            for i in 0..2000 {
                let allowed = config.tolerances.cam_contour;
                cams.sample(&see(f64::from(i) / 1000.0, x, z), config.wheel_width, allowed);
            }
        }
        for undone in cams.settle() {
            let feature = features.iter_mut().find(|f| f.op == undone.op).unwrap();
            feature.destroyed(undone.line, &undone.how);
        }
        let of = |f: Feature| {
            f.map(|kind| match kind {
                crate::FeatureKind::Cam(cam) => *cam,
                other => panic!("{other:?}"),
            })
        };
        features.into_iter().map(of).collect()
    }

    #[test]
    fn a_cam_that_is_ground_over_another_one_takes_its_verdict_back() {
        let (first, quarter) = ((4.0, 0.0, -20.0), (4.0, 90.0, -20.0));
        let reason = |f: &Judged<GroundCam>| f.verdict.reason().unwrap_or_default().to_owned();
        for (name, cuts) in [
            ("turned by 90°", [first, quarter]),
            ("turned by a degree", [first, (4.0, 1.0, -20.0)]),
            ("a lower lift", [first, (2.0, 0.0, -20.0)]),
            ("a higher lift", [first, (6.0, 0.0, -20.0)]),
            ("the wheel half over it", [first, (4.0, 90.0, -25.0)]),
        ] {
            let found = one_after_the_other(&cuts, None);
            let said = reason(&found[0]);
            assert!(
                said.contains("good when cut, destroyed in line 2: cam 2 was ground over it"),
                "{name}: {said}"
            );
            assert!(
                reason(&found[1]).contains("line 1 has ground cam 1 there before"),
                "{name}: {}",
                reason(&found[1])
            );
        }
        let fed = one_after_the_other(&[first], Some([221.0, -20.0]));
        assert!(
            reason(&fed[0]).contains("destroyed in line 90: the wheel went into it: 3.000 mm"),
            "{}",
            reason(&fed[0])
        );
    }

    #[test]
    fn cams_beside_one_another_and_the_same_cam_again_stay_good() {
        let first = (4.0, 0.0, -20.0);
        for (name, cuts, then) in [
            ("one", vec![first], None),
            ("the same again", vec![first, first], None),
            ("the next on the shaft", vec![first, (4.0, 90.0, -60.0)], None),
            ("just beside", vec![first, (6.0, 90.0, -30.0)], None),
            ("the wheel at its top", vec![first], Some([224.01, -20.0])),
            ("the wheel beside it", vec![first], Some([215.0, -40.0])),
        ] {
            for found in one_after_the_other(&cuts, then) {
                assert!(found.verdict.is_pass(), "{name}: {:?}", found.verdict);
            }
        }
    }
}

//! Cam grinding: the order of turning up, following, cutting in, sparking out and going back.
//!
//! ```text
//!   S reached ─► superpose D(θ) − top ─► X to centre + top + stock ─► infeed ─► spark-out ─┐
//!   follow nothing ◄─ X back to where it stood ◄──────────────────────────── next move ◄───┘
//! ```
//!
//! The table is superposed less its top, so that fading it in only moves the wheel away from the
//! top, and a wheel that stands clear of the top stays clear. Idle turns are made where the wheel
//! stands.
use super::{Job, Planner};
use crate::StepKind;
use crate::cams::{TURN_ENDED, turned};
use crate::coupled::Table;
use crate::findings::number;
use crate::tap_check::whole_rpm;
use crate::way_out::along_x;
use alloc::{format, vec::Vec};
use canon::{Axis, CamOrder};
use diag::Diagnostic;
use motion::{Move, Path, Superpose, Superposed, TiedCut};
use units::{Angle, Coordinate, Lead, Length, Spin};

/// The spindle that turns the work.
const WORK: u8 = 0;
/// Turns over which the profile fades in and out.
const FADE: Angle = Angle::rev(1.0);
/// Turns after a change that pass before samples are taken: what was begun has settled.
const SETTLING: Angle = Angle::rev(0.5);

/// Shares of X's speed and acceleration for going in and back while it follows.
const BESIDE: (f64, f64) = (0.1, 0.3);

/// What is superposed while a cam is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Superposition {
    /// Nothing yet.
    None,
    /// Its table, on X.
    Table,
    /// Its table, and on the work the swing about its even turn.
    TableAndSwing,
}

/// The cam being ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cam {
    profile: u32,
    phase: Angle,
    centre: Length,
    compensated: bool,
    sampling: bool,
    /// The speed at which it is followed, once it is.
    follows: Option<Spin>,
    /// What is superposed.
    superposed: Superposition,
    /// Where the wheel stood before it went in.
    retreat: Option<Length>,
    /// Speed of the turns that were sampled.
    sampled: Option<Spin>,
    /// Stock that has been ground off it.
    ground: Length,
}

impl Planner {
    pub(super) fn cam(&mut self, job: &mut Job, order: &CamOrder) {
        match *order {
            CamOrder::Select { profile, phase, centre, .. } => {
                self.cam_end(job);
                if self.cams.library.get(profile).is_none() {
                    let text = format!("profile P{profile} is not in the cam library");
                    let help = "name the library with --cams; `leadscrew cam` makes profiles from lift tables";
                    self.findings.add(Diagnostic::error("M0411", job.span, text).with_help(help));
                    return;
                }
                self.cam = Some(Cam {
                    profile,
                    phase,
                    centre,
                    compensated: false,
                    sampling: false,
                    follows: None,
                    superposed: Superposition::None,
                    retreat: None,
                    sampled: None,
                    ground: Length::ZERO,
                });
            }
            CamOrder::Deselect => {
                self.cam_end(job);
                self.cam = None;
            }
            CamOrder::Compensate => {
                if let Some(cam) = &mut self.cam {
                    cam.compensated = true;
                    cam.follows = None; // another table from the next turn on
                }
            }
            CamOrder::ResetSampling | CamOrder::StartSampling => {
                if let Some(cam) = &mut self.cam {
                    cam.sampling = *order == CamOrder::StartSampling;
                    cam.sampled = None;
                }
            }
            CamOrder::StorePhase => self.store_phase(job),
            CamOrder::Grind { stock, per_turn, rate, spin } => {
                self.grind(job, stock, per_turn, rate, spin);
            }
            CamOrder::SparkOut { spin, turns } => self.spark_out(job, spin, turns),
        }
    }

    /// The wheel goes back and follows nothing. The profile stays selected.
    pub(super) fn cam_end(&mut self, job: &mut Job) {
        let Some(mut cam) = self.cam else { return };
        if cam.superposed == Superposition::None {
            return;
        }
        if let Some(x) = cam.retreat.take() {
            self.wheel_to(job, x);
            self.hand_on(job, StepKind::WayOut(None));
        }
        let order = Superpose {
            on: Superposed::Axis(Axis::X),
            master: WORK,
            table: None,
            turns: 1.0,
            over: FADE,
        };
        self.hand_on(job, StepKind::Superpose(order));
        if cam.superposed == Superposition::TableAndSwing {
            let on = Superposed::Spindle(WORK);
            self.hand_on(job, StepKind::Superpose(Superpose { on, ..order }));
        }
        self.hand_on(job, StepKind::AwaitFades);
        (cam.follows, cam.superposed) = (None, Superposition::None);
        self.cam = Some(cam);
        if let Some(state) = self.spindles.get_mut(usize::from(WORK)) {
            state.order(Spin::ZERO);
        }
        self.tell_spindles(job);
    }

    /// Move the wheel's base to a machine coordinate, beside what is superposed: a share of what
    /// the axis can is left to the profile, and it never stands still to be in position.
    fn wheel_to(&mut self, job: &mut Job, x: Length) {
        let from = self.position();
        let to = from.with(Axis::X, Coordinate::linear(x));
        self.programmed = self.programmed.with(Axis::X, Coordinate::linear(x));
        let path = Path::Line { from, to };
        if self.is_refused(job, &[path]) {
            return;
        }
        let Some(mut bound) = self.bound(job, &path, true, f64::INFINITY) else { return };
        (bound.speed, bound.accel) = (bound.speed * BESIDE.0, bound.accel * BESIDE.1);
        let profile = bound.profile(path.length(), bound.speed);
        let step = Move {
            path,
            profile,
            rapid: true,
            per_revolution: false,
            exact_stop: false,
            floats: false,
            programmed: None,
        };
        self.hand_on(job, StepKind::Move(step.into()));
    }

    fn store_phase(&mut self, job: &mut Job) {
        let Some(cam) = self.cam else { return };
        let Some(spin) = cam.sampled else {
            let text = "nothing was sampled: write idle turns (G04 S P) between the start of sampling and this block";
            return self.findings.add(Diagnostic::error("M0412", job.span, text));
        };
        self.hand_on(job, StepKind::Consult(TURN_ENDED));
        self.will_measure.push((cam.profile, spin));
        if let Some(cam) = &mut self.cam {
            cam.sampling = false;
        }
    }

    /// Whether the program measures a profile at this speed, or at a slower and a faster one.
    fn will_know(&self, profile: u32, spin: Spin) -> bool {
        let speeds = || self.will_measure.iter().filter(|m| m.0 == profile).map(|m| m.1);
        speeds().any(|s| s <= spin) && speeds().any(|s| s >= spin)
    }

    /// What is sent at this speed, less its top; `None`: refused.
    fn table(&mut self, job: &Job, cam: &Cam, spin: Spin) -> Option<Vec<f64>> {
        let profile = self.cams.library.get(cam.profile)?;
        let top = profile.top().value();
        let nodes = match self.cams.command(cam.profile, spin).filter(|_| cam.compensated) {
            Some(command) => &command.nodes,
            None if cam.compensated && !self.will_know(cam.profile, spin) => {
                let text = format!(
                    "the phase error of profile P{} at S{} has not been measured",
                    cam.profile,
                    number(spin.in_rpm())
                );
                let help = "measure it first (G51 P, G52, G53, G04 S P2, G55), at this speed or at a slower and a faster one";
                self.findings.add(Diagnostic::error("M0413", job.span, text).with_help(help));
                return None;
            }
            None => {
                self.cams.course(cam.profile, spin).map_or(&profile.nodes, |course| &course.nodes)
            }
        };
        let less_top: Vec<f64> = nodes.iter().map(|x| x - top).collect();
        Some(turned(&less_top, cam.phase.value()))
    }

    /// Turn the work and let the wheel follow; `None`: refused.
    fn follow(&mut self, job: &mut Job, spin: Spin) -> Option<Cam> {
        let cam = self.cam?;
        if self.cam_is_refused(job, &cam, spin) {
            return None;
        }
        if cam.follows == Some(spin) {
            return Some(cam);
        }
        let nodes = self.table(job, &cam, spin)?;
        if let Some(state) = self.spindles.get_mut(usize::from(WORK)) {
            state.order(spin);
        }
        self.tell_spindles(job);
        self.await_spindles(job);
        self.superpose(job, Superposed::Axis(Axis::X), Some(nodes));
        let lead = self.cams.course(cam.profile, spin).and_then(|course| course.lead.as_ref());
        let lead = lead.map(|lead| turned(lead, cam.phase.value()));
        let superposed =
            if lead.is_some() { Superposition::TableAndSwing } else { Superposition::Table };
        if superposed != Superposition::Table || cam.superposed == Superposition::TableAndSwing {
            self.superpose(job, Superposed::Spindle(WORK), lead);
        }
        self.hand_on(job, StepKind::AwaitFades);
        let follows = Cam { follows: Some(spin), superposed, ..cam };
        self.cam = Some(follows);
        Some(follows)
    }

    /// Fade a function of the work's turn in, or what is superposed out.
    fn superpose(&mut self, job: &mut Job, on: Superposed, nodes: Option<Vec<f64>>) {
        let table = nodes.map(|nodes| {
            let id = self.next_table();
            self.tables.push(Table { id, nodes });
            id
        });
        let order = Superpose { on, master: WORK, table, turns: 1.0, over: FADE };
        self.hand_on(job, StepKind::Superpose(order));
    }

    fn grind(&mut self, job: &mut Job, stock: Length, per_turn: Length, rate: Lead, spin: Spin) {
        let Some(mut cam) = self.follow(job, spin) else { return };
        let Some(profile) = self.cams.library.get(cam.profile) else { return };
        let fresh = (stock - cam.ground).max(Length::ZERO);
        let wears = self.cams.wear.map_or(Length::ZERO, |wear| wear.of(profile, fresh));
        cam.ground = cam.ground.max(stock);
        // a wheel of a smaller radius must go farther, and loses some more on the way
        self.worn += wears;
        let finished = cam.centre + profile.top() - self.worn;
        // in as many turns as without wear
        let per_turn = per_turn * (1.0 + wears / stock.max(Length::um(1.0)));
        let stock = stock + wears;
        if cam.retreat.is_none() {
            let clear = self.position().linear[0];
            cam.retreat = Some(clear);
            self.hand_on(job, StepKind::WayOut(Some(along_x(TiedCut::Cam, WORK, clear))));
        }
        self.cam = Some(cam);
        self.wheel_to(job, finished + stock);
        let mut left = stock;
        while left.value() > 1e-9 {
            let bite = if rate.value() > per_turn.value() * (1.0 + 1e-9) {
                per_turn.min(left)
            } else {
                left
            };
            left -= bite;
            self.infeed(job, bite, rate, spin);
            let rest = 1.0 - bite.value() / rate.value();
            if rate.value() > per_turn.value() * (1.0 + 1e-9) && left.value() > 1e-9 {
                self.hand_on(job, StepKind::Revolve { spindle: WORK, turns: Angle::rev(rest) });
            }
        }
    }

    /// Cut in by so much, at a rate for each turn.
    fn infeed(&mut self, job: &mut Job, bite: Length, rate: Lead, spin: Spin) {
        let from = self.position();
        let to = from.with(Axis::X, Coordinate::linear(from.linear[0] - bite));
        self.programmed = self.programmed.with(Axis::X, Coordinate::linear(to.linear[0]));
        let path = Path::Line { from, to };
        if self.is_refused(job, &[path]) {
            return;
        }
        let wanted = rate.value() * spin.abs().value();
        let Some(bound) = self.bound(job, &path, false, wanted) else { return };
        let profile =
            bound.profile_over_revolutions(path.length(), rate.value(), spin.abs().value());
        let infeed = Move {
            path,
            profile,
            rapid: false,
            per_revolution: true,
            exact_stop: false,
            floats: false,
            programmed: None,
        };
        self.hand_on(job, StepKind::Move(infeed.into()));
    }

    fn spark_out(&mut self, job: &mut Job, spin: Spin, turns: u32) {
        let Some(cam) = self.follow(job, spin) else { return };
        if !cam.sampling {
            let turns = Angle::rev(f64::from(turns));
            return self.hand_on(job, StepKind::Revolve { spindle: WORK, turns });
        }
        self.hand_on(job, StepKind::Revolve { spindle: WORK, turns: SETTLING });
        for _ in 0..turns {
            self.hand_on(job, StepKind::Revolve { spindle: WORK, turns: Angle::rev(1.0) });
            self.hand_on(job, StepKind::Consult(TURN_ENDED));
        }
        if let Some(cam) = &mut self.cam {
            cam.sampled = Some(spin);
        }
    }

    /// Whether the machine cannot follow, or an idle turn would cut.
    fn cam_is_refused(&mut self, job: &Job, cam: &Cam, spin: Spin) -> bool {
        let before = self.findings.len();
        let (Some(profile), Some(x)) = (self.cams.library.get(cam.profile), self.limits.axes[0])
        else {
            return true;
        };
        let highest =
            self.limits.spindles.first().map_or(Spin::ZERO, |s| s.reachable(units::Torque::ZERO));
        // a speed that varies was planned within the limits; what its mean asks of X is checked as
        // of any other
        let [slope, bend, jolt] = profile.steepest;
        let mut bounds = Vec::from([
            (highest.value(), "the work spindle's highest speed"),
            (x.rapid_speed.value() / slope, "the speed of X"),
            (libm::sqrt(x.accel.value() / bend), "the acceleration of X"),
        ]);
        if x.feed_jerk.value().is_finite() {
            bounds.push((libm::cbrt(x.feed_jerk.value() / jolt), "the jerk of X"));
        }
        let lowest = bounds.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((most, what)) =
            lowest.filter(|(most, _)| spin.abs().value() > most * (1.0 + 1e-9))
        {
            let text = format!(
                "S{} is too fast for profile P{}: {what} allows S{}",
                number(spin.abs().in_rpm()),
                cam.profile,
                number(whole_rpm(Spin::rev_per_s(most))),
            );
            self.findings.add(Diagnostic::error("M0414", job.span, text));
        }
        let clear = cam.centre + profile.top();
        let stands = self.position().linear[0];
        if cam.retreat.is_none() && stands < clear {
            let text = format!(
                "the wheel stands at X{} and would cut while the profile is taken up: X{} is clear of it",
                number((stands - cam.centre).value()),
                number((clear - cam.centre).value() + 1.0),
            );
            self.findings.add(Diagnostic::error("M0415", job.span, text));
        }
        self.findings.len() > before
    }
}

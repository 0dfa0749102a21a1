//! A thread, from the path of the tap's edges and the spindle's angle while its op was in force.
//!
//! ```text
//!   samples ─► edges, θ ─► groove (extremes of e by depth) ─► w, |ΔPn| ─► gauges ─► class, margin
//!                                                              D2_tap ──┘
//!                                       the hole drilled before ─► D1 ──┘
//! ```
//!
//! The helix that counts is the *tap's own*: a block with another lead does not make another
//! thread, it tears this one. `docs/judging.md` derives the equations and says what the method
//! cannot see.
use crate::class::ThreadClass;
use crate::groove::Groove;
use crate::hole::times;
use crate::inspection::Inspection;
use crate::judged::Judged;
use crate::milling::Milling;
use crate::stroke::{Stroke, Visit};
use crate::tapped::{KnownHole, Thread};
use crate::tolerance::Limits;
use crate::verdict::Verdict;
use crate::workpiece::{TappedPlace, Under, Workpiece};
use crate::{Config, Contact};
use bus::{Sample, State};
use canon::{Hand, Holder, Tap, TapTool, ThreadSize, Tool, ToolKind};
use units::{Force, Length, Time, Torque};

/// The spindle that turns the tap.
const SPINDLE: usize = 0;

/// Why a thread is not judged whose hole was not drilled where the program drills others.
pub(crate) const UNSEEN: &str = "no hole was drilled here before it was tapped, and the program drills others: drill it \
     first, or state (PRE-DRILLED) in the program";

/// Follows one thread.
#[derive(Clone, Debug)]
pub(crate) struct ThreadTrack {
    pub(crate) tap: Tap,
    tool_number: Option<u32>,
    pub(crate) tool: Option<Tool>,
    pub(crate) size: ThreadSize,
    /// What was wrong before the first cut: no tap, wrong hand, wrong lead.
    pub(crate) findings: Vec<String>,
    pub(crate) stroke: Stroke,
    pub(crate) visit: Visit,
    /// Of the tap's edges: what they cut.
    pub(crate) edges: Groove,
    /// Of the axis, before the holder gives way: how well the machine kept step.
    pub(crate) axis: Groove,
    before: Option<(f64, f64)>,
    pub(crate) spin_max_rev_per_s: f64,
    pub(crate) torque_max: Option<Torque>,
    pub(crate) torque_in: Option<Torque>,
    pub(crate) torque_out: Option<Torque>,
    /// Farthest turn inwards, rev.
    farthest_rev: f64,
    pub(crate) force_max: Option<Force>,
    pub(crate) faulted: bool,
}

impl ThreadTrack {
    pub(crate) fn new(
        tap: &Tap,
        tool_number: Option<u32>,
        tool: Option<&Tool>,
        stroke: Stroke,
    ) -> Self {
        let (size, findings) = what_is_cut(tap, tool_number, tool);
        let pitch_mm = size.pitch.value();
        let groove =
            Groove::new(pitch_mm, pitch_mm * size.hand.sign(), stroke.deepest_ordered_mm());
        Self {
            tap: *tap,
            tool_number,
            tool: tool.cloned(),
            size,
            findings,
            stroke,
            visit: Visit::new(),
            axis: groove.clone(),
            edges: groove,
            before: None,
            spin_max_rev_per_s: 0.0,
            torque_max: None,
            torque_in: None,
            torque_out: None,
            farthest_rev: f64::NEG_INFINITY,
            force_max: None,
            faulted: false,
        }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        let depth_mm = self.stroke.depth_mm(self.stroke.edge_mm(sample));
        // a clutch holder has no step to keep: what counts is the tap on its own helix
        let axis_depth_mm = if self.is_in_clutch() {
            depth_mm
        } else {
            self.stroke.depth_mm(self.stroke.axis_mm(sample))
        };
        let theta_rev = tap_rev(sample);
        let now_s = sample.feedback.time.value();
        if !(theta_rev.is_finite() && axis_depth_mm.is_finite()) {
            self.visit.spoil();
            return;
        }
        if self.visit.sample(&self.stroke, sample, depth_mm) {
            self.edges.sample(depth_mm, theta_rev);
            self.axis.sample(axis_depth_mm, theta_rev);
            self.measure_effort(sample, theta_rev, now_s);
            self.faulted |= matches!(sample.report.state, State::Faulted | State::Recovering);
        } else {
            self.edges.leave();
            self.axis.leave();
        }
        self.before = Some((now_s, theta_rev));
    }

    /// Speed, torque, force. Without the truth, speed is what the encoder's angle says.
    fn measure_effort(&mut self, sample: &Sample, theta_rev: f64, now_s: f64) {
        if let Some(truth) = &sample.truth {
            let torque = truth.cutting_torque.abs();
            let force = truth.cutting_force.abs();
            self.torque_max = Some(self.torque_max.map_or(torque, |most| most.max(torque)));
            self.measure_ways(torque, theta_rev);
            self.force_max = Some(self.force_max.map_or(force, |most| most.max(force)));
            let spin = truth.spins[SPINDLE].abs().value();
            self.spin_max_rev_per_s = self.spin_max_rev_per_s.max(spin);
        } else if let Some((then_s, then_rev)) = self.before
            && now_s > then_s
        {
            let spin = ((theta_rev - then_rev) / (now_s - then_s)).abs();
            self.spin_max_rev_per_s = self.spin_max_rev_per_s.max(spin);
        }
    }

    /// Torque in and out apart. Behind the farthest turn the thread is cut already; the first half
    /// turn back shears the chip's root and is neither.
    fn measure_ways(&mut self, torque: Torque, theta_rev: f64) {
        const CHIP_ROOT_REV: f64 = 0.5;
        let inward = theta_rev * self.size.hand.sign();
        let way = if inward >= self.farthest_rev {
            &mut self.torque_in
        } else if inward < self.farthest_rev - CHIP_ROOT_REV {
            &mut self.torque_out
        } else {
            return;
        };
        *way = Some(way.map_or(torque, |most| most.max(torque)));
        self.farthest_rev = self.farthest_rev.max(inward);
    }

    /// It was tapped with a tool that the table lacks: of such a one nothing is known.
    fn is_assumed(&self) -> bool {
        self.tool.as_ref().is_some_and(|tool| tool.stand_in)
    }

    fn verdict(
        &self,
        inspection: &Inspection<'_>,
        (milled, unseen): (Vec<String>, Option<String>),
    ) -> Verdict {
        if let Some(number) = self.tool_number.filter(|_| self.is_assumed()) {
            return Verdict::NotJudged {
                reason: format!(
                    "T{number} is not in the tool table: what it taps is not judged; add it to the table"
                ),
            };
        }
        let mut findings = inspection.findings();
        findings.extend(milled);
        Verdict::unless(&findings, self.stroke.not_judged().or(unseen))
    }

    /// The hole that was milled before it: what is wrong with its diameter; `None`: none was.
    fn milled_hole(&self, milling: &Milling, class: ThreadClass) -> Option<Vec<String>> {
        let tip_mm = self.stroke.coordinate_mm(self.visit.deepest_mm)
            - self.tool.as_ref()?.worn_length().value();
        let at = self.visit.position(&self.stroke).map(Length::value);
        let most = self.size.nominal.value();
        let [radius, off] = milling.bored(at, most, tip_mm)?;
        let limits = Limits::of(&self.size, class.in_family(self.size.family));
        let low = limits.minor_diameter.value();
        let high = low + limits.minor_tolerance.value();
        let (bore, off) = (2.0 * radius, 1.5 * off);
        let is_in = bore >= low - off && bore <= high + off;
        let wrong = format!(
            "the bore was milled to ⌀{bore:.2} mm ± {off:.2}, {low:.3} to {high:.3} mm asked"
        );
        Some(if is_in { Vec::new() } else { vec![wrong] })
    }

    /// Where it is in the work; `None`: nothing was cut that could be destroyed.
    pub(crate) fn place(
        &self,
        (op, line): (u32, u32),
        thread: &Thread,
        class: ThreadClass,
    ) -> Option<TappedPlace> {
        self.visit.times_s?;
        if !self.stroke.is_in_stock() || thread.depth <= Length::ZERO {
            return None;
        }
        let length_mm = self.tool.as_ref()?.worn_length().value();
        let top_mm = self.stroke.coordinate_mm(0.0) - length_mm;
        let at_zero = self.edges.theta_rev_at(self.stroke.depth_mm(length_mm));
        let pitch_mm = self.size.pitch.value();
        Some(TappedPlace {
            at: [thread.x.value(), thread.y.value()],
            ring: ring(&self.size, class),
            pitch_mm,
            advance_mm: pitch_mm * self.size.hand.sign(),
            top_mm,
            bottom_mm: top_mm - thread.depth.value(),
            zero_mm: self.stroke.work_zero_mm().unwrap_or(top_mm),
            phase_mm: at_zero.map(|rev| rev * pitch_mm * self.size.hand.sign()),
            play_mm: thread.no_go_margin.value().max(0.0) / 3.0_f64.sqrt(),
            ops: vec![op],
            line,
            ..TappedPlace::default()
        })
    }

    /// Measure, gauge, judge.
    pub(crate) fn finish(
        &self,
        (op, line): (u32, u32),
        now: Time,
        config: &Config,
        (work, milling): (&Workpiece, &Milling),
    ) -> Judged<Thread> {
        let inspection = Inspection::new(self, config, work);
        let [time, duration] = times(&self.visit, now);
        let mut thread = inspection.thread();
        let mut milled = Vec::new();
        if thread.hole == KnownHole::Assumed
            && let Some(wrong) = self.milled_hole(milling, config.class)
        {
            thread.hole = KnownHole::Seen;
            if self.visit.times_s.is_some() {
                milled = wrong;
            }
        }
        let is_unseen = thread.hole == KnownHole::Assumed && work.is_drilled();
        Judged {
            op,
            line,
            tool: self.tool_number,
            time,
            duration,
            verdict: self.verdict(&inspection, (milled, is_unseen.then(|| UNSEEN.to_owned()))),
            contact: if self.is_assumed() { Contact::default() } else { inspection.contact() },
            kind: thread,
        }
    }

    /// The tap in the spindle, if it is one.
    pub(crate) fn tap_tool(&self) -> Option<&TapTool> {
        match &self.tool.as_ref()?.kind {
            ToolKind::Tap(tap) => Some(tap),
            _ => None,
        }
    }

    /// The tap is in a clutch holder: nothing is synchronised, and it is not asked where the thread
    /// starts.
    pub(crate) fn is_in_clutch(&self) -> bool {
        self.tap_tool().is_some_and(|tap| matches!(tap.holder, Holder::Clutch { .. }))
    }

    /// Spindle angle at which the fitted helix passes the start plane.
    pub(crate) fn start_rev(&self) -> Option<f64> {
        self.edges.theta_rev_at(self.stroke.start_depth_mm())
    }
}

/// Size of the thread by the tap in the spindle; by op and tool diameter where that is no known
/// tap.
fn what_is_cut(tap: &Tap, number: Option<u32>, tool: Option<&Tool>) -> (ThreadSize, Vec<String>) {
    let ordered_hand = if tap.lead.value() < 0.0 { Hand::Left } else { Hand::Right };
    let stand_in = |diameter: Length| {
        let pitch_mm = tap.lead.value().abs().max(1e-3);
        ThreadSize::metric(diameter, Length::mm(pitch_mm), ordered_hand)
    };
    let Some(tool) = tool else {
        let finding = match number {
            Some(number) => format!("T{number} is not in the tool table"),
            None => "there was no tool in the spindle".into(),
        };
        return (stand_in(Length::ZERO), vec![finding]);
    };
    if tool.stand_in && !matches!(tool.kind, ToolKind::Tap(_)) {
        let lead = stand_in(Length::ZERO);
        let designation = format!("thread {:.3}", lead.pitch.value());
        return (ThreadSize { designation, ..lead }, Vec::new());
    }
    let ToolKind::Tap(form) = &tool.kind else {
        return (stand_in(tool.diameter), vec![format!("T{} is not a tap", tool.number)]);
    };
    match form.designation.parse::<ThreadSize>() {
        Err(error) => (stand_in(tool.diameter), vec![format!("T{}: {error}", tool.number)]),
        Ok(mut size) => {
            size.hand = if form.lead.value() < 0.0 { Hand::Left } else { size.hand };
            let findings = mismatch(tap, tool.number, &size, ordered_hand);
            size.hand = ordered_hand; // the motion is followed in the sense it had
            (size, findings)
        }
    }
}

/// What the block orders that this tap cannot do.
fn mismatch(tap: &Tap, number: u32, size: &ThreadSize, ordered: Hand) -> Vec<String> {
    let mut findings = Vec::new();
    if size.hand != ordered {
        findings.push(format!(
            "T{number} is a {}-hand tap, the block turns it for a {}-hand thread",
            size.hand.name(),
            ordered.name()
        ));
    }
    let (asked_mm, own_mm) = (tap.lead.value().abs(), size.pitch.value());
    if (asked_mm / own_mm - 1.0).abs() > 0.01 {
        findings.push(format!(
            "the block's lead is {asked_mm:.4} mm, that of T{number} is {own_mm:.4} mm"
        ));
    }
    findings
}

/// Angle of the tap: [`Sample::spindle`] without copying the whole truth, and what a clutch has let
/// it slip.
fn tap_rev(sample: &Sample) -> f64 {
    let encoder = sample.feedback.spindles[SPINDLE].angle;
    sample.truth.as_ref().map_or(encoder, |t| t.spindles[SPINDLE] + t.tool_turn).value()
}

/// Radii between which the flanks of a thread are: of its largest bore, and of its size.
fn ring(size: &ThreadSize, class: ThreadClass) -> [f64; 2] {
    let limits = Limits::of(size, class.in_family(size.family));
    let bore = limits.minor_diameter + limits.minor_tolerance;
    [bore.value() / 2.0, size.nominal.value() / 2.0]
}

/// What comes down on the work.
pub(crate) fn under(tap: &Tap, tool: &Tool, class: ThreadClass) -> Under {
    let (size, _) = what_is_cut(tap, Some(tool.number), Some(tool));
    Under::Tap {
        ring: ring(&size, class),
        pitch_mm: size.pitch.value(),
        bottom_mm: (tap.bottom - tool.worn_length()).value(),
    }
}

//! A thread, from the path of the tap's edges and the spindle's angle while its op was in force.
//!
//! ```text
//!   samples ─► edges, θ ─► groove (extremes of e by depth) ─► w, |ΔPn| ─► gauges ─► class, margin
//!                                                              D2_tap ──┘
//!                                       the hole drilled before ─► D1 ──┘
//! ```
//!
//! The helix that counts is the *tap's own*: a block with another lead does not make another thread, it
//! tears this one. `docs/judging.md` derives the equations and says what the method cannot see.
use crate::Config;
use crate::class::ThreadClass;
use crate::feature::{Feature, FeatureKind, Gauge, Hand, ProfilePoint, Thread, Verdict};
use crate::gauge::{CutThread, Gauged};
use crate::groove::{Groove, Measured, Slice, TapForm};
use crate::hole::{Drilled, times};
use crate::size::ThreadSize;
use crate::stroke::{Stroke, Visit};
use bus::{Sample, State};
use canon::{Tap, TapTool, Tool, ToolKind};
use units::{Angle, Force, Length, Spin, Time, Torque};

/// The spindle that turns the tap.
const SPINDLE: usize = 0;
/// A tap may stand this much deeper than the hole's full diameter: it is the drill's own tolerance.
const HOLE_BOTTOM_MM: f64 = 0.05;

/// Follows one thread.
#[derive(Clone, Debug)]
pub(crate) struct ThreadTrack {
    tap: Tap,
    tool_number: Option<u32>,
    tool: Option<Tool>,
    size: ThreadSize,
    /// What was wrong before the first cut: no tap, wrong hand, wrong lead.
    findings: Vec<String>,
    stroke: Stroke,
    visit: Visit,
    groove: Groove,
    before: Option<(f64, f64)>,
    spin_max_rev_per_s: f64,
    torque_max: Option<Torque>,
    force_max: Option<Force>,
    faulted: bool,
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
            Groove::new(pitch_mm, pitch_mm * size.hand.sign(), stroke.programmed_mm.max(0.0));
        Self {
            tap: *tap,
            tool_number,
            tool: tool.cloned(),
            size,
            findings,
            stroke,
            visit: Visit::new(),
            groove,
            before: None,
            spin_max_rev_per_s: 0.0,
            torque_max: None,
            force_max: None,
            faulted: false,
        }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        let depth_mm = self.stroke.depth_mm(self.stroke.edge_mm(sample));
        let theta_rev = spindle_rev(sample);
        let now_s = sample.feedback.time.value();
        if self.visit.sample(&self.stroke, sample, depth_mm) {
            self.groove.sample(depth_mm, theta_rev);
            self.measure_effort(sample, theta_rev, now_s);
            self.faulted |= sample.report.state == State::Faulted;
        } else {
            self.groove.leave();
        }
        self.before = Some((now_s, theta_rev));
    }

    /// Speed, torque, force. Without the truth, speed is what the encoder's angle says.
    fn measure_effort(&mut self, sample: &Sample, theta_rev: f64, now_s: f64) {
        if let Some(truth) = &sample.truth {
            let torque = truth.cutting_torque.abs();
            let force = truth.cutting_force.abs();
            self.torque_max = Some(self.torque_max.map_or(torque, |most| most.max(torque)));
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

    /// Measure, gauge, judge.
    pub(crate) fn finish(
        self,
        op: u32,
        line: u32,
        now: Time,
        config: &Config,
        holes: &[Drilled],
    ) -> Feature {
        let tap = self.tap_tool();
        let tip_mm = self.visit.deepest_mm.max(0.0);
        let chamfer_mm = tap.map_or(0.0, |t| t.chamfer_pitches.max(0.0)) * self.size.pitch.value();
        let full_mm = (tip_mm - chamfer_mm).max(0.0);
        let form = TapForm {
            chamfer_mm,
            clearance_mm: config.flank_clearance.value().max(0.0),
            engagement_mm: self.size.normal_engagement().value().min(full_mm),
        };
        let measured = self.groove.measure(&form, full_mm);
        let hole = self.hole_below(holes, tip_mm);
        let limits_basic = crate::Limits::of(&self.size, config.class).pitch_diameter;
        let cut = CutThread {
            tap_pitch_diameter: limits_basic + tap.map_or(Length::ZERO, |t| t.oversize),
            widening: Length::mm(measured.widening_mm),
            lead_error: Length::mm(measured.lead_error_mm),
            flank_angle_allowance: config.flank_angle_allowance,
            minor_diameter: hole.map_or(self.size.tap_drill(), |h| h.diameter),
        };
        let class_asked = config.class.in_family(self.size.family);
        let gauged = Gauged::new(&self.size, class_asked, &cut);
        let is_cut = self.visit.times_s.is_some();
        let findings =
            self.all_findings(&measured, &gauged, hole, [tip_mm, full_mm], class_asked, config);
        let thread =
            self.thread(&measured, &gauged, &cut, [tip_mm, full_mm], hole.is_some(), config);
        let class = if is_cut { Gauged::finest_class(&self.size, &cut) } else { None };
        let thread = Thread { class, class_asked, ..thread };
        let [time, duration] = times(&self.visit, now);
        Feature {
            op,
            line,
            tool: self.tool_number,
            time,
            duration,
            verdict: Verdict::from_findings(&findings),
            kind: FeatureKind::Thread(Box::new(thread)),
        }
    }

    fn tap_tool(&self) -> Option<&TapTool> {
        match &self.tool.as_ref()?.kind {
            ToolKind::Tap(tap) => Some(tap),
            _ => None,
        }
    }

    /// The widest hole drilled here that is deep enough, else the deepest; a counterbore wider than
    /// the thread is none.
    fn hole_below(&self, holes: &[Drilled], tip_mm: f64) -> Option<Drilled> {
        let [x, y] = self.visit.position(&self.stroke);
        let near = self.size.nominal * 0.25;
        let below = |hole: &Drilled| self.deeper_than(hole, tip_mm);
        let here = holes.iter().filter(|hole| {
            (hole.at[0] - x).abs() < near
                && (hole.at[1] - y).abs() < near
                && hole.diameter < self.size.nominal
        });
        here.copied().reduce(|best, hole| {
            let deep_enough = |h: &Drilled| below(h) <= HOLE_BOTTOM_MM;
            let better = match (deep_enough(&best), deep_enough(&hole)) {
                (true, true) => hole.diameter >= best.diameter,
                (false, false) => below(&hole) <= below(&best),
                (best_is, _) => !best_is,
            };
            if better { hole } else { best }
        })
    }

    /// How far the tap's tip at this depth stands below a hole's full diameter.
    fn deeper_than(&self, hole: &Drilled, tip_mm: f64) -> f64 {
        let length = self.tool.as_ref().map_or(0.0, |t| t.length.value());
        self.stroke.sense * (self.stroke.coordinate_mm(tip_mm) - length - hole.bottom_mm)
    }

    /// Everything measured; classes are filled in by the caller.
    fn thread(
        &self,
        measured: &Measured,
        gauged: &Gauged,
        cut: &CutThread,
        [tip_mm, full_mm]: [f64; 2],
        drilled: bool,
        config: &Config,
    ) -> Thread {
        let [x, y] = self.visit.position(&self.stroke);
        let is_cut = self.visit.times_s.is_some();
        let (margin, limiting_gauge) =
            if is_cut { gauged.margin() } else { (Length::ZERO, Gauge::Go) };
        let if_cut = |value: Length| if is_cut { value } else { Length::ZERO };
        let flute = self.tap_tool().map(|tap| tap.flute);
        let start = self.groove.theta_rev_at(self.stroke.start_depth_mm());
        Thread {
            x,
            y,
            position_error: self.visit.position_error(),
            size: self.size.designation.clone(),
            hand: self.size.hand,
            lead: self.size.lead(),
            depth: Length::mm(full_mm),
            tip_depth: Length::mm(tip_mm),
            depth_error: Length::mm(tip_mm - self.stroke.programmed_mm),
            spin_max: Spin::rev_per_s(self.spin_max_rev_per_s),
            sync_error_max: Length::mm(measured.sync_error_max_mm),
            sync_error_rms: Length::mm(measured.sync_error_rms_mm),
            sync_error_depth: Length::mm(measured.sync_error_depth_mm),
            lead_error: Length::mm(measured.lead_error_mm),
            groove_widening: Length::mm(measured.widening_mm),
            widest_depth: Length::mm(measured.widest_depth_mm),
            pitch_diameter: if_cut(gauged.pitch_diameter),
            virtual_pitch_diameter: if_cut(gauged.virtual_pitch_diameter),
            minor_diameter: cut.minor_diameter,
            drilled,
            class: None,
            class_asked: ThreadClass::H6,
            margin,
            limiting_gauge,
            go_margin: if_cut(gauged.go_margin),
            no_go_margin: if_cut(gauged.no_go_margin),
            minor_margin: gauged.minor_margin,
            pitch_diameter_tolerance: gauged.limits.pitch_tolerance,
            torque_max: self.torque_max,
            torque_expected: config.material.zip(flute).map(|(material, flute)| {
                material.tapping_torque(self.size.nominal, cut.minor_diameter, flute)
            }),
            axial_force_max: self.force_max,
            start_angle: start.map_or(Angle::ZERO, |rev| Angle::rev(rev.rem_euclid(1.0))),
            chip_removal: false, // no op orders one yet
            recovered: self.faulted && !self.stroke.cuts(self.visit.last_mm),
            profile: measured.profile.iter().map(profile_point).collect(),
        }
    }

    /// Everything that is wrong, gravest first.
    fn all_findings(
        &self,
        measured: &Measured,
        gauged: &Gauged,
        hole: Option<Drilled>,
        [tip_mm, full_mm]: [f64; 2],
        class: ThreadClass,
        config: &Config,
    ) -> Vec<String> {
        let mut findings = self.findings.clone();
        findings.extend(self.visit.findings(&self.stroke, config.tolerances.position));
        if self.visit.times_s.is_some() {
            findings.extend(gauge_findings(measured, gauged, class));
            findings.extend(self.depth_findings(hole, tip_mm, full_mm, config));
            findings.extend(self.sync_findings(measured, config));
        }
        findings
    }

    fn depth_findings(
        &self,
        hole: Option<Drilled>,
        tip_mm: f64,
        full_mm: f64,
        config: &Config,
    ) -> Vec<String> {
        let mut findings = Vec::new();
        let over_um = (tip_mm - self.stroke.programmed_mm) * 1e3;
        let over_allowed =
            config.tolerances.thread_overrun.min(config.tolerances.thread_depth).in_um();
        let under_allowed = config.tolerances.thread_depth.in_um();
        if over_um > over_allowed {
            findings.push(format!(
                "the tap ran {over_um:.0} µm beyond its bottom at {:.3} mm, {over_allowed:.0} µm allowed",
                self.stroke.programmed_mm
            ));
        } else if over_um < -under_allowed {
            findings.push(format!(
                "the thread is {:.0} µm too shallow: the tip reached {tip_mm:.3} mm instead of {:.3} mm, {under_allowed:.0} µm allowed",
                -over_um, self.stroke.programmed_mm
            ));
        }
        if full_mm <= 0.0 {
            findings.push(format!(
                "no full thread: the tip's {tip_mm:.2} mm are less than its chamfer"
            ));
        }
        if let Some(below_mm) = hole.map(|hole| self.deeper_than(&hole, tip_mm))
            && below_mm > HOLE_BOTTOM_MM
        {
            findings.push(format!(
                "the tap went {below_mm:.2} mm deeper than the hole's full diameter"
            ));
        }
        if let Some(longest) = self.tap_tool().map(|tap| tap.thread_length.value())
            && longest > 0.0
            && tip_mm > longest
        {
            findings.push(format!(
                "{tip_mm:.2} mm deep with a tap whose thread is {longest:.2} mm long"
            ));
        }
        findings
    }

    fn sync_findings(&self, measured: &Measured, config: &Config) -> Vec<String> {
        let mut findings = Vec::new();
        if let Some(limit) = config.tolerances.sync_error
            && Length::mm(measured.sync_error_max_mm) > limit
        {
            findings.push(format!(
                "the sync error reached {:.1} µm at {:.2} mm, {:.1} µm allowed",
                measured.sync_error_max_mm * 1e3,
                measured.sync_error_depth_mm,
                limit.in_um()
            ));
        }
        if let (Some(asked), Some(rev)) =
            (self.tap.start_angle, self.groove.theta_rev_at(self.stroke.start_depth_mm()))
        {
            let off = rev - asked.value();
            let off_deg = (off - off.round()) * 360.0;
            if off_deg.abs() > config.tolerances.start_angle.in_deg() {
                findings.push(format!(
                    "the thread starts {off_deg:.1}° from the {:.1}° asked, {:.1}° allowed",
                    asked.in_deg(),
                    config.tolerances.start_angle.in_deg()
                ));
            }
        }
        findings
    }
}

/// What the gauges find, in their words.
fn gauge_findings(measured: &Measured, gauged: &Gauged, class: ThreadClass) -> Vec<String> {
    let mut findings = Vec::new();
    if !gauged.no_go() {
        findings.push(format!(
            "the No-go gauge of {class} enters: pitch diameter {:.3} mm is {:.0} µm over its limit, the groove is {:.0} µm wider than the tap at {:.2} mm",
            gauged.pitch_diameter.value(),
            -gauged.no_go_margin.in_um(),
            measured.widening_mm * 1e3,
            measured.widest_depth_mm
        ));
    }
    if !gauged.go() {
        findings.push(format!(
            "the Go gauge of {class} does not enter: virtual pitch diameter {:.3} mm is {:.0} µm under its limit, with {:.0} µm of lead error",
            gauged.virtual_pitch_diameter.value(),
            -gauged.go_margin.in_um(),
            measured.lead_error_mm * 1e3
        ));
    }
    if !gauged.minor() {
        let low = gauged.limits.minor_diameter.value();
        findings.push(format!(
            "the bore is {:.0} µm outside the minor diameter of {class}, {low:.3} to {:.3} mm",
            -gauged.minor_margin.in_um(),
            low + gauged.limits.minor_tolerance.value()
        ));
    }
    findings
}

/// Size of the thread by the tap in the spindle; by op and tool diameter where that is no known tap.
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
    let (asked_mm, own_mm) = (tap.lead.value().abs(), size.lead().value());
    if (asked_mm / own_mm - 1.0).abs() > 0.01 {
        findings.push(format!(
            "the block's lead is {asked_mm:.4} mm, that of T{number} is {own_mm:.4} mm"
        ));
    }
    findings
}

/// [`Sample::spindle`] without copying the whole truth.
fn spindle_rev(sample: &Sample) -> f64 {
    let encoder = sample.feedback.spindles[SPINDLE].angle;
    sample.truth.as_ref().map_or(encoder, |t| t.spindles[SPINDLE]).value()
}

fn profile_point(slice: &Slice) -> ProfilePoint {
    let lengths = |pair: [f64; 2]| pair.map(Length::mm);
    ProfilePoint {
        tip_depth: Length::mm(slice.depth_mm),
        inward: slice.inward_mm.map(lengths),
        outward: slice.outward_mm.map(lengths),
        widening: slice.widening_mm.map(Length::mm),
    }
}

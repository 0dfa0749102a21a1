//! Measuring and judging a thread whose tap has been followed to its end.
//!
//! ```text
//!   axis  ─► distance from its helix ─► sync error: how well the machine kept step
//!   edges ─► groove: w, |ΔPn| ─┐
//!   tap   ─► D2_tap, chamfer ──┼─► gauges ─► class, margin ─┐
//!   holes ─► bore ─────────────┘                            ├─► findings, gravest first
//!   tip   ─► depth, overrun, hole bottom ───────────────────┘
//! ```
//!
//! Axis and edges differ by the holder's deflection: a soft holder lets the tap follow its thread
//! where the machine does not. The sync error is the machine's, the thread is the edges'.
use crate::class::ThreadClass;
use crate::config::tapping_torque;
use crate::gauge::{CutThread, Gauge, Gauged};
use crate::groove::{GrooveCut, OffHelix, TapForm};
use crate::stroke::Visit;
use crate::tapped::{KnownHole, ProfilePoint, Thread};
use crate::thread::ThreadTrack;
use crate::tolerance::{Limits, normal_engagement};
use crate::workpiece::{Bore, Workpiece};
use crate::{Config, Contact};
use units::{Angle, Length, Spin, Torque};

/// A tap may stand this much deeper than the hole's full diameter: it is the drill's own tolerance.
const HOLE_BOTTOM_MM: f64 = 0.05;
/// A hole is the tap's own if its axis is as near as this share of the nominal diameter.
const NEAR_SHARE: f64 = 0.05;
/// A thread that begins below the stock's top keeps at least this share of what was ordered ...
const LEAST_SHARE: f64 = 0.5;
/// ... and the height of a nut, as a share of its nominal diameter.
const NUT_HEIGHT: f64 = 0.8;

/// All that is known of one thread.
pub(crate) struct Inspection<'a> {
    track: &'a ThreadTrack,
    config: &'a Config,
    class: ThreadClass,
    tip_mm: f64,
    full_mm: f64,
    sync: OffHelix,
    cut: GrooveCut,
    /// The hole drilled before.
    hole: Option<Bore>,
    flanks: CutThread,
    gauged: Gauged,
}

impl<'a> Inspection<'a> {
    pub(crate) fn new(track: &'a ThreadTrack, config: &'a Config, work: &Workpiece) -> Self {
        let (tap, size) = (track.tap_tool(), &track.size);
        let tip_mm = track.visit.deepest_mm.max(0.0);
        let chamfer_mm = tap.map_or(0.0, |t| t.chamfer_pitches.max(0.0)) * size.pitch.value();
        let full_mm = track.stroke.within_mm(tip_mm - chamfer_mm);
        let form = TapForm {
            chamfer_mm,
            clearance_mm: config.flank_clearance.value().max(0.0),
            engagement_mm: normal_engagement(size).value().min(full_mm),
        };
        let cut = track.edges.cut(&form, full_mm);
        let hole = hole_below(track, work, tip_mm);
        let class = config.class.in_family(size.family);
        let basic = Limits::of(size, class).pitch_diameter;
        let flanks = CutThread {
            tap_pitch_diameter: basic + tap.map_or(Length::ZERO, |t| t.oversize),
            widening: Length::mm(cut.widening_mm),
            lead_error: Length::mm(cut.lead_error_mm),
            flank_angle_allowance: config.flank_angle_allowance,
            minor_diameter: hole.map_or(size.tap_drill(), |h| h.diameter),
        };
        let gauged = Gauged::new(size, class, &flanks);
        let sync = track.axis.off_helix();
        Self { track, config, class, tip_mm, full_mm, sync, cut, hole, flanks, gauged }
    }

    fn is_cut(&self) -> bool {
        self.track.visit.times_s.is_some()
    }

    /// There is a length of full thread that a gauge could be tried on.
    fn is_thread(&self) -> bool {
        self.is_cut() && self.track.visit.broken_at_mm.is_none() && self.full_mm > 0.0
    }

    /// Everything measured. Of a thread that was never cut, nothing is.
    pub(crate) fn thread(&self) -> Thread {
        let Self { track, gauged, flanks, .. } = self;
        let [x, y] = track.visit.position(&track.stroke);
        let (margin, limiting_gauge) =
            if self.is_thread() { gauged.margin() } else { (Length::ZERO, Gauge::Go) };
        let if_cut = |value: Length| if self.is_thread() { value } else { Length::ZERO };
        let class = self.is_thread().then(|| Gauged::finest_class(&track.size, flanks)).flatten();
        Thread {
            x,
            y,
            position_error: track.visit.position_error(),
            size: track.size.designation.clone(),
            hand: track.size.hand,
            lead: track.size.lead().abs(),
            depth: Length::mm(self.full_mm),
            tip_depth: Length::mm(self.tip_mm),
            depth_error: Length::mm(self.tip_mm - track.stroke.programmed_mm),
            spin_max: Spin::rev_per_s(track.spin_max_rev_per_s),
            sync_error_max: Length::mm(self.sync.largest_mm),
            sync_error_rms: Length::mm(self.sync.rms_mm),
            sync_error_depth: Length::mm(self.sync.depth_mm),
            lead_error: Length::mm(self.cut.lead_error_mm),
            groove_widening: Length::mm(self.cut.widening_mm),
            widest_depth: Length::mm(self.cut.widest_depth_mm),
            pitch_diameter: if_cut(gauged.pitch_diameter),
            virtual_pitch_diameter: if_cut(gauged.virtual_pitch_diameter),
            minor_diameter: flanks.minor_diameter,
            hole: match (self.hole.is_some(), self.config.pre_drilled) {
                (true, _) => KnownHole::Seen,
                (false, true) => KnownHole::Stated,
                (false, false) => KnownHole::Assumed,
            },
            class,
            class_asked: self.class,
            margin,
            limiting_gauge,
            go_margin: if_cut(gauged.go_margin),
            no_go_margin: if_cut(gauged.no_go_margin),
            minor_margin: gauged.minor_margin,
            pitch_diameter_tolerance: gauged.limits.pitch_tolerance,
            torque_max: track.torque_max,
            torque_in: track.torque_in,
            torque_out: track.torque_out,
            torque_expected: self.torque_expected(),
            axial_force_max: track.force_max,
            start_angle: track.start_rev().map(|rev| Angle::rev(rev.rem_euclid(1.0))),
            chip_removal: false, // the judge sees that later
            recovered: track.faulted && !track.stroke.cuts(track.visit.last_mm),
            profile: self.profile(),
        }
    }

    /// What a sharp tap would take, if the material is known.
    fn torque_expected(&self) -> Option<Torque> {
        let flute = self.track.tap_tool()?.flute;
        let material = self.config.material?;
        Some(tapping_torque(material, self.track.size.nominal, self.flanks.minor_diameter, flute))
    }

    /// The evidence of contact.
    pub(crate) fn contact(&self) -> Contact {
        let torque_expected = self.torque_expected();
        Contact { torque_expected, ..self.track.visit.contact(&self.track.stroke) }
    }

    fn profile(&self) -> Vec<ProfilePoint> {
        let lengths = |pair: [f64; 2]| pair.map(Length::mm);
        let point = |(bin, slice): (usize, crate::groove::Slice)| ProfilePoint {
            tip_depth: Length::mm(slice.depth_mm),
            inward: slice.inward_mm.map(lengths),
            outward: slice.outward_mm.map(lengths),
            widening: self.cut.widenings_mm.get(bin).copied().map(Length::mm),
        };
        self.track.axis.profile().enumerate().map(point).collect()
    }

    /// Everything that is wrong, gravest first.
    pub(crate) fn findings(&self) -> Vec<String> {
        let mut findings = self.track.findings.clone();
        let position = self.config.tolerances.position;
        findings.extend(self.track.visit.findings(&self.track.stroke, position));
        if self.is_cut() {
            findings.extend(self.gauge_findings());
            findings.extend(self.depth_finding());
            findings.extend(self.bottom_findings());
            findings.extend(self.sync_finding());
            findings.extend(self.start_finding());
            findings.extend(self.contact().unresisted());
        }
        Visit::causes(&self.track.stroke, findings)
    }

    /// What the gauges find.
    fn gauge_findings(&self) -> Vec<String> {
        let Self { gauged, cut, class, .. } = self;
        let mut findings = Vec::new();
        if !gauged.no_go() {
            findings.push(format!(
                "the No-go gauge of {class} enters: pitch diameter {:.3} mm is {:.0} µm over its limit, \
                 the groove is {:.0} µm wider than the tap at {:.2} mm",
                gauged.pitch_diameter.value(),
                -gauged.no_go_margin.in_um(),
                cut.widening_mm * 1e3,
                cut.widest_depth_mm
            ));
        }
        if !gauged.go() {
            findings.push(format!(
                "the Go gauge of {class} does not enter: virtual pitch diameter {:.3} mm is {:.0} µm \
                 under its limit, with {:.0} µm of lead error",
                gauged.virtual_pitch_diameter.value(),
                -gauged.go_margin.in_um(),
                cut.lead_error_mm * 1e3
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

    fn depth_finding(&self) -> Option<String> {
        let tolerances = &self.config.tolerances;
        let (tip, programmed) = (self.tip_mm, self.track.stroke.programmed_mm);
        let over_um = (tip - programmed) * 1e3;
        let over_allowed = tolerances.thread_overrun.min(tolerances.thread_depth).in_um();
        let under_allowed = tolerances.thread_depth.in_um();
        if over_um > over_allowed {
            Some(format!(
                "the tap ran {over_um:.0} µm beyond its bottom at {programmed:.3} mm, \
                 {over_allowed:.0} µm allowed"
            ))
        } else if over_um < -under_allowed {
            Some(format!(
                "the thread is {:.0} µm too shallow: the tip reached {tip:.3} mm instead of \
                 {programmed:.3} mm, {under_allowed:.0} µm allowed",
                -over_um
            ))
        } else {
            None
        }
    }

    /// What the hole's and the tap's own lengths forbid.
    fn bottom_findings(&self) -> Vec<String> {
        let mut findings = Vec::new();
        let tip = self.tip_mm;
        if self.full_mm <= 0.0 {
            findings
                .push(format!("no full thread: the tip's {tip:.2} mm are less than its chamfer"));
        }
        findings.extend(self.air_finding());
        if let Some(hole) = &self.hole {
            let below = deeper_than(self.track, hole, tip);
            if below > HOLE_BOTTOM_MM {
                findings.push(format!(
                    "the tap went {below:.2} mm deeper than the hole's full diameter"
                ));
            }
        }
        let longest = self.track.tap_tool().map_or(0.0, |tap| tap.thread_length.value());
        let deepest = longest + self.config.tolerances.thread_overrun.value();
        if longest > 0.0 && tip > deepest {
            findings
                .push(format!("{tip:.2} mm deep with a tap whose thread is {longest:.2} mm long"));
        }
        findings
    }

    /// Material that a tap from above the stock's top was to find is not there.
    fn air_finding(&self) -> Option<String> {
        let stroke = &self.track.stroke;
        let surface = stroke.surface()?;
        let ordered = self.full_mm + surface.lowered_mm;
        let least = (ordered * LEAST_SHARE).max(NUT_HEIGHT * self.track.size.nominal.value());
        let starts_within = stroke.start_depth_mm() > -surface.lowered_mm;
        (self.full_mm < least.min(ordered) && !starts_within).then(|| {
            let by = surface.line.map_or("milled".to_owned(), |line| format!("bored in line {line}"));
            format!(
                "{:.2} mm of it are in the air, where the material was {by} away: {:.2} mm of full thread are left, \
                 {:.2} mm needed",
                surface.lowered_mm, self.full_mm, least.min(ordered)
            )
        })
    }

    fn sync_finding(&self) -> Option<String> {
        let limit = self.config.tolerances.sync_error?;
        let OffHelix { largest_mm, depth_mm, .. } = self.sync;
        (Length::mm(largest_mm) > limit).then(|| {
            format!(
                "the sync error reached {:.1} µm at {depth_mm:.2} mm, {:.1} µm allowed",
                largest_mm * 1e3,
                limit.in_um()
            )
        })
    }

    fn start_finding(&self) -> Option<String> {
        if self.track.is_in_clutch() || !self.config.synchronised {
            return None;
        }
        let asked = self.track.tap.start_angle?;
        let off = self.track.start_rev()? - asked.value();
        let off_deg = (off - off.round()) * 360.0;
        let allowed = self.config.tolerances.start_angle.in_deg();
        (off_deg.abs() > allowed).then(|| {
            format!(
                "the thread starts {off_deg:.1}° from the {:.1}° asked, {allowed:.1}° allowed",
                asked.in_deg()
            )
        })
    }
}

/// The widest hole drilled here that is deep enough, else the deepest; a counterbore wider than the
/// thread is none.
fn hole_below(track: &ThreadTrack, work: &Workpiece, tip_mm: f64) -> Option<Bore> {
    let [x, y] = track.visit.position(&track.stroke);
    let (nominal, near) = (track.size.nominal, track.size.nominal * NEAR_SHARE);
    let below = |hole: &Bore| deeper_than(track, hole, tip_mm);
    let here = work.holes().filter(|hole| {
        (hole.at[0] - x).abs() < near && (hole.at[1] - y).abs() < near && hole.diameter < nominal
    });
    here.copied().reduce(|best, hole| {
        let deep_enough = |h: &Bore| below(h) <= HOLE_BOTTOM_MM;
        let better = match (deep_enough(&best), deep_enough(&hole)) {
            (true, true) => hole.diameter >= best.diameter,
            (false, false) => below(&hole) <= below(&best),
            (best_is, _) => !best_is,
        };
        if better { hole } else { best }
    })
}

/// How far the tap's tip at this depth stands below a hole's full diameter.
fn deeper_than(track: &ThreadTrack, hole: &Bore, tip_mm: f64) -> f64 {
    let length = track.tool.as_ref().map_or(0.0, |t| t.worn_length().value());
    track.stroke.sense * (track.stroke.coordinate_mm(tip_mm) - length - hole.bottom_mm)
}

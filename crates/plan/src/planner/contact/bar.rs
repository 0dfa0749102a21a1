//! Inserts against the bar of a lathe: rapids through what has not been turned away.
//!
//! ```text
//!   feed ──────────► the outline of the bar shrinks to the tip
//!   thread ────────► it keeps its crests, and has a root below them
//!   rapid ─────────► nothing deeper in the outline than scraping, or it is said with the X that is clear of it
//! ```
//!
//! The tip lies where the program has it across the axis, with the tool's offset in X; along Z the
//! real length of the tool counts, as with every tool. Tools of which it is not known what they
//! leave end what is known of the bar.
use super::{DRILL_SIDEWAYS, Job, Planner, SCRAPES, SLIDES, Sweep, places};
use crate::bar::Met;
use crate::edges::EdgePolygon;
use crate::findings::Cause;
use crate::words::{Rounding, advice, length, place, word};
use alloc::{format, string::String, vec::Vec};
use canon::{Axis, Insert, ToolKind};
use diag::{Diagnostic, Span};
use motion::Path;
use units::Spin;

/// So far off the bar a rapid is clear of it, mm.
const CLEAR: f64 = 2.0;

impl Planner {
    /// A tool along a path, on a lathe; whether that is all there is to judge.
    pub(in crate::planner) fn sweep_bar(&mut self, job: &Job, path: &Path, run: Sweep) -> bool {
        if self.tools.get(self.tool).is_some_and(|tool| matches!(tool.kind, ToolKind::Insert(_))) {
            self.sweep_shank(job, path);
        }
        let Some(tool) = self.tools.get(self.tool) else { return false };
        let is_known = !tool.stand_in && tool.number != 0;
        let (tool_length, radius) = (tool.worn_length().value(), tool.diameter.value() / 2.0);
        let kind = &tool.kind;
        let Some(contact) = &mut self.contact else { return false };
        let Some(outline) = &mut contact.outline else { return false };
        let across = self.frame.tool.linear[0].value();
        let ends = [path.from(), path.to()];
        let (edges, points_inwards) = match (kind, run) {
            _ if ends.iter().any(|at| (0..2).any(|i| at.rotary[i] != contact.rotary[i])) => {
                contact.outline = None;
                return false;
            }
            (ToolKind::Insert(insert), _) if is_known => {
                (EdgePolygon::of(insert), points_inwards(insert))
            }
            (_, Sweep::Rapid) => return false,
            (ToolKind::Drill { .. } | ToolKind::SpotDrill { .. } | ToolKind::Tap(_), _)
                if is_known =>
            {
                let tip = |at: &canon::Position| {
                    let [x, y, z] = at.linear.map(units::Length::value);
                    [x - across, y, z - tool_length]
                };
                let ends = ends.map(tip);
                let off = outline.off_axis(ends[1]);
                if off <= DRILL_SIDEWAYS * 2.0 * radius {
                    outline.bored(ends, radius);
                } else if let Some(met) = outline.met(ends, SLIDES).filter(|_| self.turns_now()) {
                    self.say_beside_axis(job.span, &met, off);
                }
                return false;
            }
            _ => {
                contact.outline = None;
                return false;
            }
        };
        let mut before = None;
        let mut met: Option<Met> = None;
        let mut gap: Option<f64> = None;
        places(path, tool_length, |[x, y, z]| {
            let at = [x - across, y, z];
            let Some(before) = before.replace(at) else { return };
            if run == Sweep::Rapid {
                met = outline.met([before, at], SCRAPES).or(met);
                if met.is_none() && points_inwards {
                    met = outline.met_beside([before, at], &edges, SCRAPES);
                }
            }
            match run {
                Sweep::Thread(_) => {
                    gap = [gap, outline.gap([before, at])].into_iter().flatten().reduce(f64::min);
                    outline.threaded([before, at], &edges);
                }
                Sweep::Rapid if met.is_none() => {}
                Sweep::Rapid | Sweep::Feed(_) => outline.cut([before, at], &edges), // what was met is said once
            }
        });
        if let Some(met) = met {
            self.say_bar(job.span, &met, across);
        }
        if let Sweep::Thread(_) = run {
            self.turned_stretch(gap);
        }
        true
    }

    /// The bar is machined by a process whose form is not followed here.
    pub(in crate::planner) fn forget_bar(&mut self) {
        if let Some(contact) = &mut self.contact {
            contact.outline = None;
        }
    }

    /// The bar turns.
    fn turns_now(&self) -> bool {
        self.turns_work
            && self.spindles.first().is_some_and(|spindle| spindle.ordered != Spin::ZERO)
    }

    /// A tool that cuts on its axis goes into a turning bar beside the bar's.
    fn say_beside_axis(&mut self, span: Span, met: &Met, off: f64) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let frame = &self.frame;
        let said = [
            format!(
                "{} goes {} deep into the turning bar, {} beside the bar's axis, and cuts on that axis only",
                tool.name(),
                length(frame, met.depth),
                length(frame, off),
            ),
            ": X0 works for it; a turned surface or thread needs an insert".into(),
        ];
        let severity = Self::sure(contact.doubtful);
        let cause = Cause { code: "M0361", which: [contact.mounted, severity as u32, 1] };
        self.findings.merge(cause, met.depth, || {
            let mut finding = Diagnostic::error("M0361", span, "").with_help(INSERTS);
            finding.severity = severity;
            (finding, said)
        });
    }

    fn say_bar(&mut self, span: Span, met: &Met, across: f64) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let Some(outline) = &contact.outline else { return };
        let frame = &self.frame;
        let centre = outline.axis[0];
        let outward = if met.at[0] < centre { -1.0 } else { 1.0 };
        let at_radius = |r: f64| word(frame, Axis::X, centre + across + outward * r);
        let here: Vec<String> = [
            place(frame, Axis::X, met.at[0] + across),
            place(frame, Axis::Z, met.at[2] + tool.worn_length().value()),
        ]
        .into();
        let (more, rounding) =
            if outward < 0.0 { ("or less", Rounding::Down) } else { ("or more", Rounding::Up) };
        let clear = CLEAR.max(0.1 * frame.unit.in_mm());
        let clear = centre + across + outward * (met.clear + clear);
        let works = advice(frame, Axis::X, clear, rounding);
        let said = [
            format!(
                "the rapid takes {} {} deep into the bar, which it enters at {}{}: the bar is there up to {}",
                tool.name(),
                length(frame, met.depth),
                here.join(" and "),
                met.edge.map_or_else(String::new, |z| {
                    let edge = place(frame, Axis::Z, z + tool.worn_length().value());
                    format!(", with its edge beside the point at {edge}")
                }),
                at_radius(met.surface),
            ),
            format!(
                ": {works} {more} is clear of it on this way, or a feed (G1) where the rapid goes in",
            ),
        ];
        let severity = Self::sure(contact.doubtful);
        let cause = Cause { code: "M0360", which: [contact.mounted, severity as u32, 1] };
        let help = self.offset_cause().unwrap_or_else(|| SMALLER_BAR.into());
        self.findings.merge(cause, met.depth, || {
            let mut finding = Diagnostic::error("M0360", span, "").with_help(help);
            finding.severity = severity;
            (finding, said)
        });
    }
}

/// It turns a bar from outside: its point lies towards the axis from its nose.
fn points_inwards(insert: &Insert) -> bool {
    insert.orientation.is_none_or(|orientation| matches!(orientation.number(), 3 | 4 | 8))
}

/// Of a tool that cannot turn.
const INSERTS: &str =
    "--tools FILE names the shop's own tools; their table says which one is an insert";
/// Of a rapid into the bar.
const SMALLER_BAR: &str = "[setup.stock] in the machine's file says how large the bar is: if the real one is smaller or turned before, write its size there";

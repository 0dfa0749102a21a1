//! A hob against its gear and its blank, before anything moves: whether it is the one that the
//! program orders, whether it reaches the blank, and how deep it goes.
//!
//! ```text
//!   X of the axes = work's axis + d/2 + x·m + (r_hob − addendum)        thickness of the teeth: 2·tan α a mm of depth
//! ```
//!
//! Teeth that are hobbed in several blocks are looked at when the last of them is over: the first
//! ones rough them.
use super::Contact;
use crate::findings::Cause;
use crate::planner::{Job, Planner};
use crate::words::{WrittenFrame, length, place, word};
use alloc::{format, string::String, vec::Vec};
use canon::{Axis, Hob, HobTool, OpKind, Tool, ToolKind, number};
use diag::{Diagnostic, Span};
use units::Spin;

/// Thickness of the teeth and diameter over their tips, each way, mm: as the judge allows them.
const THICKNESS: f64 = 0.06;
const TIP: f64 = 0.22;
/// Share by which module and pressure angle of hob and gear may differ.
const SAME: f64 = 1e-4;

/// Teeth that are being hobbed, or were last.
#[derive(Clone, Debug)]
pub(super) struct Hobbed {
    span: Span,
    hob: Hob,
    tool: Tool,
    kind: HobTool,
    /// It is not over.
    is_open: bool,
    /// It was fed, anywhere.
    was_fed: bool,
    /// X of the axes where it went deepest between the blank's faces, and the words there.
    deepest: Option<(f64, WrittenFrame)>,
    frame: WrittenFrame,
}

impl Hobbed {
    fn radius(&self) -> f64 {
        self.tool.diameter.value() / 2.0 + self.tool.wear.radius.value()
    }

    /// Distance of the axes that makes the teeth as thick as the drawing has them.
    fn distance(&self) -> f64 {
        let (asked, m) = (self.hob.asked, self.hob.module.value());
        let sine = libm::sin(asked.pressure_angle().in_rad());
        let middle = asked.span.map_or(0.0, |[upper, lower]| (upper + lower).value() / 2.0);
        let datum = self.radius() - self.kind.addendum.value();
        let half = self.hob.pitch_diameter().value() / 2.0;
        datum + half + asked.shift * m + middle / (2.0 * sine)
    }

    /// How far that may be off.
    fn allowed(&self) -> f64 {
        let angle = self.hob.asked.pressure_angle().in_rad();
        let of_span = |[upper, lower]: [units::Length; 2]| (upper - lower).value() / 2.0;
        let usual = THICKNESS * libm::cos(angle);
        self.hob.asked.span.map_or(usual, of_span) / (2.0 * libm::sin(angle))
    }

    fn tip_diameter(&self) -> f64 {
        let (asked, m) = (self.hob.asked, self.hob.module.value());
        let usual = self.hob.pitch_diameter().value() + 2.0 * m * (1.0 + asked.shift);
        asked.tip_diameter.map_or(usual, units::Length::value)
    }

    fn has_teeth_of(&self, hob: &Hob) -> bool {
        let other = &self.hob;
        (other.teeth, other.starts) == (hob.teeth, hob.starts)
            && (other.module, other.helix) == (hob.module, hob.helix)
    }
}

impl Contact {
    /// X of the work's axis, and radius of the blank about it.
    fn blank(&self) -> (f64, f64) {
        let [from, to] = [self.stock.from[0].value(), self.stock.to[0].value()];
        (f64::midpoint(from, to), (to - from) / 2.0)
    }
}

impl Planner {
    /// The work is geared to the hob in the spindle.
    pub(in crate::planner) fn hob_begins(&mut self, job: &Job, hob: &Hob, turning: Spin) {
        let Some(tool) = self.tools.get(self.tool) else { return };
        let ToolKind::Hob(kind) = tool.kind else { return };
        if self.contact.is_none() {
            return;
        }
        let tool = tool.clone();
        let goes_on = self
            .contact
            .as_ref()
            .and_then(|c| c.hobbed.as_ref())
            .is_some_and(|h| h.has_teeth_of(hob));
        if goes_on {
            if let Some(hobbed) = self.contact.as_mut().and_then(|c| c.hobbed.as_mut()) {
                hobbed.is_open = true;
            }
            return;
        }
        self.judge_hobbed();
        for (wrong, works) in differs(&kind, hob, turning) {
            let text = format!("{} {wrong}: {works}", tool.name());
            self.findings.add(Diagnostic::warning("M0435", job.span, text));
        }
        let frame = self.frame;
        if let Some(contact) = &mut self.contact {
            contact.hobbed = Some(Hobbed {
                span: job.span,
                hob: *hob,
                tool,
                kind,
                is_open: true,
                was_fed: false,
                deepest: None,
                frame,
            });
        }
    }

    /// The work is geared to it no longer.
    pub(in crate::planner) const fn hob_ends(&mut self) {
        if let Some(contact) = &mut self.contact
            && let Some(hobbed) = &mut contact.hobbed
        {
            hobbed.is_open = false;
        }
    }

    /// The axes have moved from there to where the program has them now.
    pub(in crate::planner) fn follow_hob(&mut self, kind: &OpKind, from: &[units::Length; 3]) {
        if !matches!(kind, OpKind::Line { .. } | OpKind::Arc { .. } | OpKind::Spline { .. }) {
            return;
        }
        let (to, frame) = (self.programmed, self.frame);
        let Some(contact) = &mut self.contact else { return };
        let faces = [contact.stock.from[2].value(), contact.stock.to[2].value()];
        let Some(hobbed) = contact.hobbed.as_mut().filter(|hobbed| hobbed.is_open) else { return };
        hobbed.was_fed = true;
        let up = hobbed.tool.worn_length().value();
        let at = |p: &[units::Length; 3]| [p[0].value(), p[2].value() - up];
        if let Some(x) = nearest(at(from), at(&to.linear), faces) {
            let best = hobbed.deepest.filter(|(deepest, _)| *deepest <= x);
            hobbed.deepest = best.or(Some((x, frame)));
        }
    }

    /// No further block hobs these teeth.
    pub(in crate::planner) fn judge_hobbed(&mut self) {
        let Some(contact) = &mut self.contact else { return };
        let (axis, blank) = contact.blank();
        let face = contact.stock.to[2];
        let which = [contact.mounted, 4, 0];
        let Some(hobbed) = contact.hobbed.take().filter(|hobbed| hobbed.was_fed) else { return };
        let (tool, wanted) = (hobbed.tool.name(), axis + hobbed.distance());
        let frame = hobbed.deepest.map_or(hobbed.frame, |(_, frame)| frame);
        let works = format!(": {} works", word(&frame, Axis::X, wanted));
        let Some((x, _)) = hobbed.deepest else {
            let up = hobbed.tool.worn_length();
            let face = place(&frame, Axis::Z, (face + up).value());
            let said = [
                format!("{tool} stays beside the blank, whose face is at {face}"),
                ": nothing is cut here".into(),
            ];
            return self.findings.merge(Cause { code: "M0366", which }, 0.0, || {
                (Diagnostic::warning("M0366", hobbed.span, "").with_help(BLANK), said)
            });
        };
        let gap = x - axis - hobbed.radius() - blank;
        if gap >= 0.0 {
            let touches = place(&frame, Axis::X, axis + hobbed.radius() + blank);
            let off = length(&frame, gap);
            let said = [
                format!("{tool} passes the blank, which it touches from {touches}, {off} off it"),
                format!(": nothing is cut here,{}", works.trim_start_matches(':')),
            ];
            return self.findings.merge(Cause { code: "M0366", which }, gap, || {
                (Diagnostic::warning("M0366", hobbed.span, "").with_help(BLANK), said)
            });
        }
        self.hobbed_depth(&hobbed, x - wanted, &frame, &works);
        let (tip, found) = (hobbed.tip_diameter(), 2.0 * blank);
        if (found - tip).abs() > TIP {
            let [found, tip] = [found, tip].map(|value| length(&frame, value));
            let text = format!(
                "the blank is {found} in diameter, and the tips of {} are at {tip}: a hob does not cut them",
                teeth(&hobbed.hob)
            );
            let finding = Diagnostic::warning("M0436", hobbed.span, text).with_help(BLANK);
            self.findings.add(finding);
        }
    }

    fn hobbed_depth(&mut self, hobbed: &Hobbed, off: f64, frame: &WrittenFrame, works: &str) {
        if off.abs() <= hobbed.allowed() {
            return;
        }
        let way = if off < 0.0 { ("deep", "thin") } else { ("shallow", "thick") };
        let angle = hobbed.hob.asked.pressure_angle().in_rad();
        let thickness = 2.0 * off.abs() * libm::tan(angle);
        let text = format!(
            "{} goes {} too {} for {}, whose teeth become {} too {}{works}",
            hobbed.tool.name(),
            length(frame, off.abs()),
            way.0,
            teeth(&hobbed.hob),
            length(frame, thickness),
            way.1,
        );
        let help = "X is the distance of the axes: half the pitch circle, the profile shift of (GEAR SHIFT …), and half the hob less its addendum (tool table)";
        self.findings.add(Diagnostic::warning("M0434", hobbed.span, text).with_help(help));
    }
}

const BLANK: &str = "(STOCK X… Y… Z… X… Y… Z…) in the program, or [setup.stock] in the machine's file, says how large the blank is";

/// Such as "40 teeth of module 2".
fn teeth(hob: &Hob) -> String {
    format!("{} teeth of module {}", hob.teeth, number(hob.module.value()))
}

/// Least X of a straight way between two heights; ends are X and Z.
fn nearest(from: [f64; 2], to: [f64; 2], [low, high]: [f64; 2]) -> Option<f64> {
    let rise = to[1] - from[1];
    let share = |z: f64| if rise == 0.0 { 0.0 } else { (z - from[1]) / rise };
    let (a, b) = (share(low), share(high));
    let (first, last) = if rise == 0.0 {
        (low..=high).contains(&from[1]).then_some((0.0, 1.0))?
    } else {
        (a.min(b).max(0.0), a.max(b).min(1.0))
    };
    let x = |share: f64| from[0] + share * (to[0] - from[0]);
    (first <= last).then(|| x(first).min(x(last)))
}

/// What the hob has that the block does not order, and what works.
fn differs(kind: &HobTool, hob: &Hob, turning: Spin) -> Vec<(String, String)> {
    let mut wrong = Vec::new();
    let off = |found: f64, asked: f64| (found / asked - 1.0).abs() > SAME;
    let (found, asked) = (kind.module.value(), hob.module.value());
    if off(found, asked) {
        let [found, asked] = [found, asked].map(number);
        wrong.push((
            format!("has module {found}, and module {asked} is ordered"),
            format!("Q{found} works (G20: its diametral pitch), or a hob of module {asked}"),
        ));
    }
    let (found, asked) = (kind.pressure_angle.in_deg(), hob.asked.pressure_angle().in_deg());
    if off(found, asked) {
        let [found, asked] = [found, asked].map(number);
        wrong.push((
            format!("has a pressure angle of {found}°, and the gear has {asked}°"),
            format!("(GEAR ANGLE {found}) works, or a hob of {asked}°"),
        ));
    }
    let starts = kind.signed_starts();
    if starts != i64::from(hob.starts) {
        let hand = if starts < 0 { "left" } else { "right" };
        wrong.push((
            format!("has {} {hand}-hand start(s), and L{} is ordered", starts.abs(), hob.starts),
            format!("L{starts} works"),
        ));
    }
    let backwards = turning < Spin::ZERO;
    if turning != Spin::ZERO && backwards != kind.cuts_backwards {
        let (found, works) = if backwards { ("M4", "M3") } else { ("M3", "M4") };
        wrong.push((
            format!("turns with the backs of its teeth ahead ({found})"),
            format!("{works} works"),
        ));
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_place_of_a_slanting_way_is_looked_for_between_the_faces_alone() {
        let faces = [-30.0, 0.0];
        assert_eq!(nearest([75.0, 5.0], [75.0, -25.0], faces), Some(75.0));
        assert_eq!(nearest([70.0, 10.0], [90.0, -10.0], faces), Some(80.0));
        assert_eq!(nearest([90.0, -10.0], [70.0, 10.0], faces), Some(80.0));
        assert_eq!(nearest([70.0, 10.0], [70.0, 5.0], faces), None);
        assert_eq!(nearest([90.0, -5.0], [70.0, -5.0], faces), Some(70.0));
    }
}

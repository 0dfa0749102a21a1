//! A deep hole that is drilled in one stroke: its chips do not come out.
//!
//! ```text
//!   Hole ─► remembered ─► the feed that follows it in its block ─┬─ to the bottom at once, deeper than 4·D: a remark
//!                                                               └─ a part of the way (G73, G83): in pecks
//! ```
//!
//! Handbooks ask for pecks from three to five diameters on. `depth_without_pecks_mm` in the tool
//! table states another depth: a drill with cooling channels bears more. A hole that another drill
//! has opened as deep before is not meant.
use super::Planner;
use super::refuse::wild;
use crate::words::length;
use alloc::format;
use canon::{Axis, Hole, Position, Tool, ToolKind};
use diag::{Diagnostic, Span};
use units::Length;

/// Depth that a drill makes without pecks, over its diameter.
const WITHOUT_PECKS: f64 = 4.0;
/// What is nearer than this is the same height, mm.
const SAME: f64 = 1e-6;
/// A program's numbers are rounded to so much, mm: in inches 20 mm is 0.7874.
const ROUNDED: f64 = 0.002;

/// A hole whose first feed has not come yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnpeckedHole {
    bottom: Length,
    depth: Length,
    most: Length,
    span: Span,
}

/// Depth that a drill may make in one stroke; `None`: it is no drill.
fn most(tool: &Tool) -> Option<Length> {
    let usual = tool.diameter * WITHOUT_PECKS;
    matches!(tool.kind, ToolKind::Drill { .. })
        .then(|| tool.body.depth_without_pecks.unwrap_or(usual))
}

impl Planner {
    /// A hole begins.
    pub(super) fn hole_begins(&mut self, hole: &Hole, span: Span) {
        let tool = self.tools.get(self.tool).filter(|_| wild(&hole.at).is_none());
        self.stroke = tool.and_then(|tool| {
            let depth = (hole.surface - hole.bottom).abs();
            let most = most(tool).filter(|most| (depth - *most).value() > ROUNDED)?;
            let is_open = self.holes.at(&hole.at, hole.bottom - tool.worn_length());
            let is_new = is_open
                .is_none_or(|open| open.full_bottom > hole.bottom - tool.worn_length() + most);
            (hole.axis == Axis::Z && is_new).then_some(UnpeckedHole {
                bottom: hole.bottom,
                depth,
                most,
                span,
            })
        });
    }

    /// The feed that follows: all the way, or a part of it.
    pub(super) fn hole_is_fed(&mut self, to: &Position) {
        let Some(stroke) = self.stroke.take() else { return };
        let end = to.along(Axis::Z).of_linear();
        if (end - stroke.bottom).abs().value() > SAME {
            return;
        }
        let text = format!(
            "a hole of {} is drilled in one stroke, and this drill clears its chips down to {}: \
             drill it in pecks (G83, G73)",
            length(&self.frame, stroke.depth.value()),
            length(&self.frame, stroke.most.value()),
        );
        let finding = Diagnostic::note("M0374", stroke.span, text)
            .with_help("state depth_without_pecks_mm in the tool table if the drill bears more");
        self.findings.add_once(finding);
    }
}
